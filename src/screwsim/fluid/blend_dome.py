"""A blend whose two phases are in equilibrium, with its composition as a whole: kernels and wet states, from its table.

Everything follows from one function f(T, v), so that Maxwell's relations hold exactly whatever the table's error (M351,
M352; a subscript is a derivative):
    p = −f_v,  s = −f_T,  h = f − T f_T − v f_v,  c_v = −T f_TT,  T p_T = −T f_Tv,  w² = v² (f_vv + T f_Tv²/c_v).

`BlendWet` has the states at a pressure: by enthalpy or entropy from the table, by quality from a flash.
"""

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.codegen.modules import load
from screwsim.fluid.blend_border import blend_border
from screwsim.fluid.blend_flash import W_EDGES, Flashes, dome
from screwsim.fluid.description import describe
from screwsim.fluid.dome import EQUILIBRIUM, PHASE, dome_kernels
from screwsim.fluid.helmholtz import entropy_kernel, phased_state_text
from screwsim.fluid.nozzle import choking, critical_power
from screwsim.fluid.saturation import saturation
from screwsim.inputs.faults import UsageError
from screwsim.numerics.kept_text import flat_module
from screwsim.numerics.kernel import Kernel, written
from screwsim.numerics.roots import brentq
from screwsim.outputs.customary import in_bar, in_celsius

COUNTED = 1e-7  # lower bound of 1/k, for states beyond the border that iterations pass through
CLOSE = 1e-15  # relative accuracy of a root

INSIDE = '''def inside(T, rho):
    """Return whether T [K], rho [kg/m3] lies between {name}'s dew and bubble points, where its table reaches."""
    if T >= {warm!r} or T < {cold!r}:
        return False
    theta = math.sqrt(1.0 - T * {per_T_c!r})
    fine = math.sqrt(theta)
    y = math.log(rho)
    return log_density(-theta, fine) < y < log_density(theta, fine)
'''

SURFACE = '''def surface(T, v):
    """Return (f [J/kg], f_T, f_v, f_TT, f_Tv, f_vv) of two phases of {name} at T [K], v [m3/kg]."""
    i = 0
    while i < {last_T} and T >= EDGES[i + 1]:
        i += 1
    scale = 2.0 / (EDGES[i + 1] - EDGES[i])
    s = (T - EDGES[i]) * scale - 1.0
    b, b_1, b_2 = 0.0, 0.0, 0.0
    d, d_1, d_2 = 0.0, 0.0, 0.0
    for k in range({top_T}, -1, -1):
        b_2, b_1, b = b_2 * s + b_1, b_1 * s + b, b * s + BORDER[i, 0, k]
        d_2, d_1, d = d_2 * s + d_1, d_1 * s + d, d * s + BORDER[i, 1, k]
    b_1, b_2, d_1, d_2 = b_1 * scale, 2.0 * b_2 * scale * scale, d_1 * scale, 2.0 * d_2 * scale * scale
    w = (v - b) / d
    w_T = -(b_1 + w * d_1) / d
    w_TT = -(b_2 + w * d_2 + 2.0 * w_T * d_1) / d
    j = 0
    while j < {last_w} and w >= W[j + 1]:
        j += 1
    narrow = 2.0 / (W[j + 1] - W[j])
    r = (w - W[j]) * narrow - 1.0
    f, f_s, f_ss = 0.0, 0.0, 0.0
    f_r, f_sr, f_rr = 0.0, 0.0, 0.0
    for k in range({top_T}, -1, -1):
        c, c_1, c_2 = 0.0, 0.0, 0.0
        for l in range({top_w}, -1, -1):
            c_2, c_1, c = c_2 * r + c_1, c_1 * r + c, c * r + C[i, j, k, l]
        f_ss, f_s, f = f_ss * s + f_s, f_s * s + f, f * s + c
        f_sr, f_r = f_sr * s + f_r, f_r * s + c_1
        f_rr = f_rr * s + c_2
    F_T, F_TT, F_w = f_s * scale, 2.0 * f_ss * scale * scale, f_r * narrow
    F_Tw, F_ww = f_sr * scale * narrow, 2.0 * f_rr * narrow * narrow
    f_TT = F_TT + 2.0 * F_Tw * w_T + F_ww * w_T * w_T + F_w * w_TT
    return f, F_T + F_w * w_T, F_w / d, f_TT, (F_Tw + F_ww * w_T - F_w * d_1 / d) / d, F_ww / (d * d)
'''

MIXTURE = '''def mixture(T, rho):
    """Return what `state` returns for both phases of {name} in equilibrium at T [K], rho [kg/m3]."""
    v = 1.0 / rho
    f, f_T, f_v, f_TT, f_Tv, f_vv = surface(T, v)
    c_v = -T * f_TT
    tpt = -T * f_Tv
    a = -f_v / (v * max(f_vv + tpt * tpt / (T * c_v), {least!r}))
    choke, choked = choking(1.0 / max(a, {least!r}))
    return -f_v, f - T * f_T - v * f_v, c_v, tpt, a, choke, choked
'''

MIXED_ENTROPY = '''def entropy(T, rho):
    """Return the specific entropy s [J/(kg K)] of {name}, two phases in equilibrium in the dome."""
    if inside(T, rho):
        return -surface(T, 1.0 / rho)[1]
    return single(T, rho)
'''


@lru_cache(maxsize=16)
def surface_kernel(fluid: str) -> Kernel:
    """Return `surface(T, v)` of a blend."""
    found = dome(fluid)
    cells_T, cells_w, points_T, points_w = found.c.shape
    text = SURFACE.format(
        name=describe(fluid).name, last_T=cells_T - 1, last_w=cells_w - 1, top_T=points_T - 1, top_w=points_w - 1
    )
    arrays: dict[str, Any] = {"EDGES": found.edges, "W": np.array(W_EDGES), "BORDER": found.border, "C": found.c}
    return written(text, f"{describe(fluid).name} dome", arrays)


@lru_cache(maxsize=16)
def blend_equilibrium_kernels(fluid: str) -> Mapping[str, Kernel]:
    """Return the kernels of a blend whose two phases are in equilibrium inside the dome, where its table reaches."""
    known, edges, of = describe(fluid), dome(fluid).edges, f"{describe(fluid).name} equilibrium"
    kernels, surface = dome_kernels(fluid), surface_kernel(fluid)
    numbers = {
        "name": known.name,
        "cold": float(edges[0]),
        "warm": float(edges[-1]),
        "per_T_c": 1.0 / saturation(fluid).T_c,
        "least": COUNTED,
    }
    inside = written(INSIDE.format(**numbers), of, {"log_density": kernels.log_density})
    mixture = written(MIXTURE.format(**numbers), of, {"surface": surface, "choking": choking})
    phased = written(phased_state_text(fluid), of, {"mixture": mixture, "critical_power": critical_power})
    phase = written(PHASE.format(**numbers), of, {"inside": inside})
    state = written(EQUILIBRIUM.format(**numbers), of, {"phase": phase, "phased_state": phased})
    uses = {"inside": inside, "surface": surface, "single": entropy_kernel(fluid)}
    entropy = written(MIXED_ENTROPY.format(**numbers), of, uses)
    return {"state": state, "specific_entropy": entropy, "phase": phase, "phased_state": phased}


class BlendWet:
    """Two phases in equilibrium of one blend, at stated pressures (SI units, per kg).

    Between the bubble and the dew temperature of a pressure the volume follows from p(T, v) at each T, and T from the
    wanted quantity, which increases with T along an isobar; each by a bracketed root (M353).
    """

    def __init__(self, fluid: str) -> None:
        border = blend_border(fluid)
        assert border is not None
        self.border, self.edges, kernel = border, dome(fluid).edges, surface_kernel(fluid)
        self._surface = getattr(load(flat_module((kernel,)), "fluid"), kernel.flat_name)

    def between(self, p: float) -> tuple[float, float]:
        """Return the bubble and the dew temperature [K] at p [Pa]. Raises UsageError where the table does not reach."""
        low, high = self.border.bubble_temperature(p), self.border.dew_temperature(p)
        if low < self.edges[0] or high >= self.edges[-1]:
            two = f"has two phases from {in_celsius(low)} to {in_celsius(high)}"
            reach = f"it is followed only from {in_celsius(self.edges[0])} to {in_celsius(self.edges[-1])}"
            raise UsageError(f"gas.two_phase: {self.border.known.name} at {in_bar(p)} {two}, and {reach}")
        return low, high

    def volume(self, p: float, T: float) -> float:
        """Return v [m³/kg] at p [Pa] and T [K] between bubble and dew temperature."""
        return _root(*self.border.saturated_volumes(T), lambda v: self._surface(T, v)[2] / p + 1.0)

    def value(self, T: float, v: float, entropy: bool) -> float:
        """Return s [J/(kg K)], or h [J/kg], of two phases at T [K] and v [m³/kg]."""
        f, f_T, f_v, *_ = self._surface(T, v)
        return -f_T if entropy else f - T * f_T - v * f_v

    def at_pressure(self, p: float, wanted: float, entropy: bool) -> tuple[float, float] | None:
        """Return (T [K], ρ [kg/m³]) at p [Pa] and a wanted entropy (else enthalpy); None where that is one phase."""
        lines = self.border.lines
        if p >= lines.p_c or p <= self.border.bubble_pressure(lines.T_low):
            return None
        low, high = self.border.bubble_temperature(p), self.border.dew_temperature(p)
        if not self.border.value(low, True, entropy) < wanted < self.border.value(high, False, entropy):
            return None
        self.between(p)
        T = _root(low, high, lambda T: self.value(T, self.volume(p, T), entropy) - wanted)
        return T, 1.0 / self.volume(p, T)

    def of_quality(self, p: float, quality: float) -> tuple[float, float]:
        """Return (T [K], ρ [kg/m³]) at p [Pa] and a mass fraction of vapour."""
        flashes = Flashes(self.border.known)
        masses = np.array([describe(name).molar_mass for name in self.border.known.components])

        def excess(T: float) -> float:
            found = flashes(np.array([T]), np.array([self.volume(p, T) * self.border.known.molar_mass]))
            vapour = found.beta[0] * float(masses @ found.vapour[:, 0])
            return vapour / self.border.known.molar_mass - quality

        bubble, dew = self.between(p)
        # at the ends themselves the quality of flashed states is rounding, in which a search gets lost
        T = {0.0: bubble, 1.0: dew}.get(quality) or _root(bubble, dew, excess)
        return T, 1.0 / self.volume(p, T)


def _root(low: float, high: float, rising: Callable[[float], float]) -> float:
    """Return the zero of an increasing function, or the end of the interval where rounding puts it outside."""
    if rising(low) >= 0.0:
        return low
    return high if rising(high) <= 0.0 else brentq(rising, low, high, xtol=1e-300, rtol=CLOSE)


@lru_cache(maxsize=16)
def blend_wet(fluid: str) -> BlendWet:
    """Return the wet states of a blend. Raises UsageError where its two phases are not found."""
    return BlendWet(fluid)
