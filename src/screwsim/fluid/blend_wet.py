"""Wet states of a blend at a pressure: by enthalpy or entropy from its table, by quality from a flash.

Between the bubble and the dew temperature of that pressure the volume follows from p(T, v) at each T, and T from the
wanted quantity, which increases with T along an isobar; each by a bracketed root (M353).
"""

from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.codegen.modules import load
from screwsim.fluid.blend_border import blend_border
from screwsim.fluid.blend_dome import surface_kernel
from screwsim.fluid.blend_flash import Flashes, dome
from screwsim.fluid.description import describe
from screwsim.inputs.faults import UsageError
from screwsim.numerics.kept_text import flat_module
from screwsim.outputs.customary import in_bar, in_celsius

CLOSE = 1e-15  # relative accuracy of a root


class BlendWet:
    """Two phases in equilibrium of one blend, at stated pressures (SI units, per kg)."""

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

        T = _root(*self.between(p), excess)
        return T, 1.0 / self.volume(p, T)


def _root(low: float, high: float, rising: Any) -> float:
    """Return the zero of an increasing function, or the end of the interval where rounding puts it outside."""
    from scipy.optimize import brentq

    if rising(low) >= 0.0:
        return low
    if rising(high) <= 0.0:
        return high
    found: Any = brentq(rising, low, high, xtol=1e-300, rtol=np.float64(CLOSE))
    return float(found)


@lru_cache(maxsize=16)
def blend_wet(fluid: str) -> BlendWet:
    """Return the wet states of a blend. Raises UsageError where its two phases are not found."""
    return BlendWet(fluid)
