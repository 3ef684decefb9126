"""Kernels of a blend whose two phases are in equilibrium, with the blend's composition as a whole, from its table.

Everything follows from one function f(T, v), so that Maxwell's relations hold exactly whatever the table's error (M351,
M352; a subscript is a derivative):
    p = −f_v,  s = −f_T,  h = f − T f_T − v f_v,  c_v = −T f_TT,  T p_T = −T f_Tv,  w² = v² (f_vv + T f_Tv²/c_v).
"""

from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.fluid.blend_flash import W_EDGES, dome
from screwsim.fluid.description import describe
from screwsim.fluid.dome import EQUILIBRIUM, PHASE, PHASED, EquilibriumKernels, saturation_kernels
from screwsim.fluid.helmholtz import entropy_kernel, phased_state_text
from screwsim.fluid.nozzle import choking, critical_power
from screwsim.fluid.saturation import saturation
from screwsim.numerics.kernel import Kernel, written

COUNTED = 1e-7  # lower bound of 1/k, for states beyond the border that iterations pass through

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
def blend_equilibrium_kernels(fluid: str) -> EquilibriumKernels:
    """Return the kernels of a blend whose two phases are in equilibrium inside the dome, where its table reaches."""
    known, edges, of = describe(fluid), dome(fluid).edges, f"{describe(fluid).name} equilibrium"
    kernels, surface = saturation_kernels(fluid), surface_kernel(fluid)
    numbers = {
        "name": known.name,
        "cold": float(edges[0]),
        "warm": float(edges[-1]),
        "per_T_c": 1.0 / saturation(fluid).T_c,
        "least": COUNTED,
    }
    inside = written(INSIDE.format(**numbers), of, {"log_density": kernels.log_density})
    mixture = written(MIXTURE.format(**numbers), of, {"surface": surface, "choking": choking})
    text = phased_state_text(fluid, PHASED, ("if phase == 1:", "    return mixture(T, rho)"))
    phased = written(text, of, {"mixture": mixture, "critical_power": critical_power})
    phase = written(PHASE.format(**numbers), of, {"inside": inside})
    state = written(EQUILIBRIUM.format(**numbers), of, {"phase": phase, "phased_state": phased})
    uses = {"inside": inside, "surface": surface, "single": entropy_kernel(fluid)}
    return EquilibriumKernels(state, written(MIXED_ENTROPY.format(**numbers), of, uses), phase, phased)
