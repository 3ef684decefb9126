"""States of a blend outside the compiled cycle: saturation from its phase envelope, enthalpies by its equation.

CoolProp's flashes of mixtures take up to a second and fail for some; here everything is read from the tables of
`saturation` (M315) and from the equation itself (M310), in plain Python.
"""

from functools import lru_cache

import numpy as np

from screwsim.fluid.description import Description, describe
from screwsim.fluid.helmholtz import entropy_kernel, ideal_heat_capacity_kernel, potentials_kernel
from screwsim.fluid.saturation import Saturation, saturation
from screwsim.inputs.faults import UsageError
from screwsim.numerics.compiling import announced
from screwsim.numerics.roots import brentq
from screwsim.outputs.customary import in_bar, in_celsius

ENOUGH, CLOSE = 1e-13, 1e-9  # last relative step of a density: where the search ends, and the most it may leave
STEPS = 300  # most Newton steps
SEEN = 400  # points of a line between which the crossing of a pressure is searched


class BlendBorder:
    """A blend's saturation and enthalpies (SI units, per kg)."""

    def __init__(self, fluid: str) -> None:
        self.known: Description = describe(fluid)
        with announced("phases", f"the dew and bubble lines of {self.known.name}", "some seconds"):
            self.lines: Saturation = saturation(fluid)
        self._potentials, self._entropy = potentials_kernel(fluid), entropy_kernel(fluid)
        self.ideal_heat_capacity = ideal_heat_capacity_kernel(fluid)  # cp⁰ [J/(kg K)] at T [K]

    # ---- saturation ------------------------------------------------------------------------------------------

    def _theta(self, T: float) -> float:
        """Return θ of saturated liquid at T [K]; the vapour's is its negative. Raises UsageError."""
        self._known(f"at {in_celsius(T)}")
        if not self.lines.T_low <= T < self.lines.T_c:
            reach = f"it has one from {in_celsius(self.lines.T_low)} to {in_celsius(self.lines.T_c)}"
            raise UsageError(f"gas.fluid: {self.known.name} has no saturation at {in_celsius(T)} ({reach})")
        return float(np.sqrt(1.0 - T / self.lines.T_c))

    def _known(self, at: str) -> None:
        """Raise UsageError where the blend is known as a gas only."""
        if self.lines.always_gas:
            since = f"it is known as a gas only, from {in_celsius(self.lines.T_low)} on"
            raise UsageError(f"gas.fluid: {self.known.name} has no known saturation {at} ({since})")

    def _pressure(self, theta: float) -> float:
        table = self.lines.log_p_of_theta
        assert table is not None
        return float(np.exp(table(np.array([theta]))[0]))

    def _density(self, theta: float) -> float:
        return float(np.exp(self.lines.log_rho(np.array([theta]))[0]))

    def dew_pressure(self, T: float) -> float:
        """Return the pressure [Pa] at which vapour of T [K] begins to condense."""
        return self._pressure(-self._theta(T))

    def bubble_pressure(self, T: float) -> float:
        """Return the pressure [Pa] at which liquid of T [K] begins to boil."""
        return self._pressure(self._theta(T))

    def dew_temperature(self, p: float) -> float:
        """Return the temperature [K] at which vapour of p [Pa] begins to condense."""
        return self._temperature(p, -1.0)

    def bubble_temperature(self, p: float) -> float:
        """Return the temperature [K] at which liquid of p [Pa] begins to boil."""
        return self._temperature(p, 1.0)

    def _temperature(self, p: float, side: float) -> float:
        self._known(f"at {in_bar(p)}")
        table, wanted = self.lines.log_p_of_theta, float(np.log(p))
        assert table is not None
        places = np.linspace(np.sqrt(1.0 - self.lines.T_low / self.lines.T_c), 0.0, SEEN)
        above = table(side * places) >= wanted  # from cold to warm
        if above[0] or not above.any():
            low, high = (float(np.exp(table(side * places[i : i + 1])[0])) for i in (0, SEEN - 1))
            what = (
                f"{self.known.name} has no saturation at {in_bar(p)} (it has one from {in_bar(low)} to {in_bar(high)})"
            )
            raise UsageError(f"gas.fluid: {what}")
        first = int(np.argmax(above))
        theta = brentq(
            lambda x: float(table(np.array([side * x]))[0]) - wanted, places[first], places[first - 1], xtol=1e-15
        )
        return self.lines.T_c * (1.0 - theta**2)

    # ---- enthalpy and density --------------------------------------------------------------------------------

    def _enthalpy(self, T: float, rho: float) -> float:
        return self._potentials(T, rho)[2] + T * self._entropy(T, rho)

    def _found(self, p: float, T: float, rho: float) -> float:
        """Return the density [kg/m³] at p and T by Newton's method from rho, on the same branch."""
        step = 0.0
        for _ in range(STEPS):
            found, slope, _ = self._potentials(T, rho)
            step = (p - found) / (rho * slope)
            rho *= float(np.exp(min(max(step, -0.1), 0.1))) if slope > 0.0 else 0.9
            if abs(step) < ENOUGH:
                return rho
        if abs(step) > CLOSE:
            raise UsageError(f"gas.fluid: no density of {self.known.name} was found at {in_bar(p)}, {in_celsius(T)}")
        return rho

    def vapour_enthalpy(self, p: float, T: float) -> float:
        """Return the enthalpy [J/kg] of vapour at p [Pa] and T [K]."""
        return self._enthalpy(T, self._found(p, T, min(p / (self.known.R * T), 0.5 * self.lines.rho_c)))

    def liquid_enthalpy(self, p: float, T: float) -> float:
        """Return the enthalpy [J/kg] of liquid at p [Pa] and T [K], saturated or colder."""
        return self._enthalpy(T, self._found(p, T, self._density(self._theta(T))))

    def saturated_liquid(self, T: float) -> tuple[float, float]:
        """Return (h [J/kg], ρ [kg/m³]) of the liquid that begins to boil at T [K]."""
        rho = self._density(self._theta(T))
        return self._enthalpy(T, rho), rho

    def saturated_volumes(self, T: float) -> tuple[float, float]:
        """Return v [m³/kg] of the bubble and of the dew point at T [K]."""
        theta = self._theta(T)
        return 1.0 / self._density(theta), 1.0 / self._density(-theta)

    def value(self, T: float, liquid: bool, entropy: bool) -> float:
        """Return entropy [J/(kg K)] or enthalpy [J/kg] of the saturated liquid or vapour at T [K]."""
        theta = self._theta(T)
        rho = self._density(theta if liquid else -theta)
        return self._entropy(T, rho) if entropy else self._enthalpy(T, rho)


@lru_cache(maxsize=16)
def blend_border(fluid: str) -> BlendBorder | None:
    """Return the saturation and enthalpies of a blend; None for a pure fluid."""
    return BlendBorder(fluid) if describe(fluid).blend else None
