"""A real gas: the Helmholtz equation of state of a fluid or a blend, compiled; two phases refused or in equilibrium.

`state`, `specific_entropy` and `margin` are kernels of (T, rho) alone: the fluid's numbers are in their text. They hold
inside the dome, too, in equilibrium (dome.py; for a blend blend_dome.py, where that is chosen). For pseudo-pure fluids,
and for blends with two phases refused, the single phase is continued: while a cycle is being closed its chambers may
condense for a time. `two_phase: refuse` only refuses a closed cycle to which `why_outside` objects. Everything else
here is for use outside the cycle, and runs compiled.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import inf
from typing import Any

import numpy as np

from screwsim.fluid.always_gas import P_MOST
from screwsim.fluid.blend_dome import blend_wet
from screwsim.fluid.blend_flash import dome
from screwsim.fluid.description import PSEUDO_PURE, Description, describe
from screwsim.fluid.gas import CompiledGas
from screwsim.fluid.limits import Limit, Outside
from screwsim.fluid.oils import ZERO_CELSIUS
from screwsim.fluid.real_kernels import compiled, kernels_of
from screwsim.fluid.reservoir import Reservoir
from screwsim.fluid.saturation import saturation
from screwsim.fluid.settings import EQUILIBRIUM, REFUSE
from screwsim.inputs.faults import QuantityNotFound, UsageError
from screwsim.numerics.kernel import Kernel
from screwsim.outputs.customary import in_bar, in_celsius

AT_SATURATION = 1e-9  # relative excess of p over p_sat(T) that still counts as saturated vapour
LIQUID = 1e-6  # relative deficit of density at which a liquid still counts as saturated
UNRESOLVED, FLAT_TOP = 1e-5, 0.05  # relative distances of T and rho from the critical point: tables of c_v fail there
TYPICAL = 300.0  # [K] temperature of the representative heat capacities


@dataclass(frozen=True)
class RealGas(CompiledGas):
    """A fluid by one of CoolProp's names, or a blend; `two_phase` is 'refuse' or 'equilibrium'."""

    fluid: str
    two_phase: str = REFUSE
    name = "real"
    varies = True  # exponent and choking vary with the state

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        """The hash, computed once: cached states are looked up by their gas."""
        return hash((self.fluid, self.two_phase))

    def __post_init__(self) -> None:
        if self.equilibrium and self.known.pseudo_pure:
            raise UsageError(f"gas.two_phase: {PSEUDO_PURE.format(self.known.name)}")

    @property
    def equilibrium(self) -> bool:
        """Whether both phases are computed where the gas condenses."""
        return self.two_phase == EQUILIBRIUM

    @property
    def equations(self) -> tuple[str, ...]:
        """Numbers of its equations in docs/model.md."""
        if not self.known.blend:
            return "M46", "M47", "M48"
        own = ("M350", "M351", "M352", "M353") if self.equilibrium else ()
        if saturation(self.fluid).always_gas:
            return "M46", "M310", "M311", "M312", "M313", "M314", "M317", "M48"
        return "M46", "M310", "M311", "M312", "M313", "M314", "M315", "M316", *own, "M48"

    @property
    def follows(self) -> bool:
        """Whether it is a blend whose two phases are computed."""
        return self.known.blend and self.equilibrium

    @property
    def known(self) -> Description:
        """CoolProp's description of the fluid."""
        return describe(self.fluid)

    # ---- kernels ---------------------------------------------------------------------------------------------

    @property
    def _text(self) -> Mapping[str, Kernel]:
        return kernels_of(self.fluid, self.two_phase)

    @property
    def values(self) -> dict[str, float]:
        """Values of the kernels' arguments beside T and rho: none."""
        return {}

    # ---- constants -------------------------------------------------------------------------------------------

    @property
    def R(self) -> float:
        """Specific gas constant [J/(kg K)]."""
        return self.known.R

    @property
    def c_v(self) -> float:
        """Heat capacity at constant volume of the dilute gas at 300 K [J/(kg K)], for first guesses only."""
        T = min(max(TYPICAL, self.known.T_min), self.known.T_max)
        return float(self._kernels["state"](T, 1e-9 * self.known.rho_c)[2])

    # ---- states ----------------------------------------------------------------------------------------------

    @cached_property
    def _kernels(self) -> dict[str, Callable[..., Any]]:
        return compiled(self.fluid, self.two_phase)

    @cached_property
    def _isobar(self) -> tuple[bool, Callable[..., Any], tuple[float, ...]]:
        """Whether two phases of a blend are computed, the search along an isobar, and its further arguments."""
        found, known = saturation(self.fluid), self.known
        numbers = known.T_min, 2.0 * known.T_max, found.p_c, self.R, found.T_c, found.rho_c
        return self.follows, self._kernels["at_pressure"], numbers

    def saturation_temperature(self, p: float) -> float | None:
        """Return the saturation temperature [K] at p [Pa]; None where there is none."""
        found = saturation(self.fluid)
        if found.always_gas or p > found.p_c or p < self.saturation_pressure(found.T_low):
            return None
        return float(self._kernels["saturation_temperature"](p))

    def nearest_vapour(self, p: float, T: float) -> float:
        """Return T, or 1 K above saturation where there is no vapour at p [Pa] and T [K]; for first guesses."""
        if T >= saturation(self.fluid).T_c or saturation(self.fluid).always_gas or p < self.saturation_pressure(T):
            return T
        return (self.saturation_temperature(p) or saturation(self.fluid).T_c) + 1.0

    @cached_property
    def saturation_pressure(self) -> Callable[[float], float]:
        """Function that returns the saturation pressure [Pa] at T [K]; infinite from the critical temperature on.

        A few temperatures are asked for again and again.
        """
        found, pressure = saturation(self.fluid), self._kernels["saturation_pressure"]
        return lru_cache(maxsize=64)(lambda T: float(pressure(max(T, found.T_low))[0]) if T < found.T_c else inf)

    def density(self, p: float, T: float) -> float:
        """Return density [kg/m³] of the vapour at p [Pa], T [K]. Raises Unfound for a liquid."""
        found = saturation(self.fluid)
        if found.always_gas and T < found.T_low:
            raise QuantityNotFound(f"{self.known.name} {self._gas_only}; give a higher temperature")
        if p > self.saturation_pressure(T) * (1.0 + AT_SATURATION):
            what = "is liquid, or wet: it condenses below" if self.known.glides else "is liquid: it boils at"
            raise QuantityNotFound(
                f"{self.known.name} at {in_bar(p)}, {in_celsius(T)} {what} "
                f"{in_celsius(self.saturation_temperature(p) or found.T_c)}; "
                "give a higher temperature or a lower pressure"
            )
        return _vapour_density(self, p, T)

    def _found(self, p: float, wanted: float, entropy: bool) -> tuple[float, float]:
        """Return (T, ρ) at p and an enthalpy or entropy: vapour, two phases or liquid; ρ ≤ 0 below these."""
        return _at_pressure(self, p, wanted, entropy)

    @property
    def _called(self) -> str:
        return self.known.name

    def enthalpy(self, p: float, T: float) -> float:
        """Return specific enthalpy [J/kg] at p [Pa], T [K]."""
        return _vapour_energies(self, p, T)[0]

    def entropy(self, p: float, T: float) -> float:
        """Return specific entropy [J/(kg K)] at p [Pa], T [K]."""
        return _vapour_energies(self, p, T)[1]

    def vapour(self, p: float, T: float) -> Reservoir:
        """Return a reservoir of vapour at p [Pa] and T [K], saturated or not. Raises Unfound for a liquid."""
        return self._reservoir(p, T, self.density(p, T))

    def liquid(self, p: float, h: float) -> Reservoir:
        """Return a reservoir of liquid at p [Pa] and h [J/kg], saturated or colder, which flows without flashing.

        Raises UsageError where that is wet or vapour.
        """
        T, rho = self._at(p, h, False)
        if T >= saturation(self.fluid).T_c or rho < self._kernels["saturated_liquid"](T) * (1.0 - LIQUID):
            raise UsageError(f"{self.known.name} at {in_bar(p)}, h = {h:.6g} J/kg is not a liquid; give a colder state")
        return self._reservoir(p, T, rho)

    def _reservoir(self, p: float, T: float, rho: float) -> Reservoir:
        """Return a reservoir of a single phase, also on the border to two phases."""
        _p, h, _c_v, _tpt, exponent, choke, choked = self._kernels["single_state"](T, rho)
        return Reservoir(p, T, rho, h, float(self._kernels["specific_entropy"](T, rho)), exponent, choke, choked)

    def isentrope(self, p: float, s: float) -> tuple[float, float, float]:
        """Return (T [K], ρ [kg/m³], h [J/kg]) at p [Pa] and specific entropy s [J/(kg K)]; wet states in equilibrium.

        Raises Unfound where a fluid with glide would be wet and two phases are refused.
        """
        T, rho, h = super().isentrope(p, s)
        below = self.known.glides and not self.equilibrium and T < saturation(self.fluid).T_c
        border = ("saturated_vapour", "saturated_liquid")
        vapour, liquid = (self._kernels[what](T) for what in border) if below else (rho, rho)
        if vapour * (1.0 + AT_SATURATION) < rho < liquid * (1.0 - LIQUID):
            what = f"{self.known.name} at {in_bar(p)}, s = {s:.6g} J/(kg K), at the end of an isentrope, is wet"
            raise QuantityNotFound(f"{what}; use warmer gas in the suction line, or gas.two_phase: equilibrium")
        return T, rho, h

    # ---- work ------------------------------------------------------------------------------------------------

    def isothermal_obstacle(self, p_1: float, p_2: float, T: float) -> str | None:
        """Return why there is no isothermal compression from p_1 to p_2 at T, or None."""
        p_sat = self.saturation_pressure(T)
        if max(p_1, p_2) <= p_sat:
            return None
        at = f"{self.known.name} at {T - ZERO_CELSIUS:.2f} °C"
        return f"{at} condenses at {p_sat / 1e5:.4g} bar, below the discharge pressure"

    # ---- limits ----------------------------------------------------------------------------------------------

    def first_outside(self, T: np.ndarray, rho: np.ndarray) -> int | None:
        """Return the index of a state (T [K], ρ [kg/m³]) to which `why_outside` objects; None where there is none."""
        if not self.equilibrium:
            found = int(self._kernels["first_outside"](T, rho))
            return found if found >= 0 and self.why_outside(float(T[found]), float(rho[found])) else None
        if self.follows:  # wet states outside the table may lie anywhere in the history
            low, high = dome(self.fluid).edges[[0, -1]]
            beyond = np.flatnonzero((T < low) | ((T >= high) & (T < saturation(self.fluid).T_c)))
            for i in beyond:
                if self.why_outside(float(T[i]), float(rho[i])) is not None:
                    return int(i)
        return super().first_outside(T, rho)

    def why_outside(self, T: float, rho: float) -> Outside | None:
        """Return which limit a state violates, None where none; two phases do not with `two_phase: equilibrium`."""
        known, found = self.known, saturation(self.fluid)
        at = f"{known.name} at {in_celsius(T)} is"
        if T < found.T_low and found.always_gas:
            return Outside(Limit.COLD, f"{known.name} at {in_celsius(T)} is too cold: it {self._gas_only}")
        if T < found.T_low:
            return Outside(Limit.COLD, f"{at} below the equation's lowest temperature, {in_celsius(found.T_low)}")
        if T < found.T_c and rho >= self._kernels["saturated_vapour"](T) * (1.0 + AT_SATURATION):
            if self.equilibrium:
                return self._beyond(T, rho)
            saturated = f"{self._kernels['saturated_vapour'](T):.6g} kg/m3 at {in_bar(self.saturation_pressure(T))}"
            what = f"{known.name} condenses at {in_celsius(T)}, {rho:.6g} kg/m3 (saturated vapour: {saturated})"
            return Outside(Limit.GLIDING if known.pseudo_pure else Limit.WET, what)
        if T > known.T_max:
            return Outside(Limit.HOT, f"{at} above the equation's highest temperature, {in_celsius(known.T_max)}")
        p = float(self._kernels["single_state"](T, rho)[0])
        p_max = min(known.p_max, P_MOST) if found.always_gas else known.p_max
        if p > p_max:
            what = f"{known.name} at {in_bar(p)} is above the equation's highest pressure, {in_bar(p_max)}"
            return Outside(Limit.PRESSED, what)
        return None

    def at_critical_point(self, T: float, rho: float) -> str:
        """Return in words the critical point where a state is so close that its two phases are not resolved; else ''.

        Beside it the heat capacity of both phases in equilibrium grows beyond any table.
        """
        found = saturation(self.fluid)
        beside = abs(T / found.T_c - 1.0) < UNRESOLVED and abs(rho / found.rho_c - 1.0) < FLAT_TOP
        if not beside or found.always_gas or not self.equilibrium:
            return ""
        return f"the critical point of {self.known.name} ({in_celsius(found.T_c)}, {found.rho_c:.3g} kg/m3)"

    @property
    def _gas_only(self) -> str:
        return f"is known as a gas only, from {in_celsius(saturation(self.fluid).T_low)} on (M317)"

    def _beyond(self, T: float, rho: float) -> Outside | None:
        """Return that a blend's table does not cover a wet state; None where it does, and for a liquid."""
        if not self.known.blend or rho > self._kernels["saturated_liquid"](T):
            return None
        low, high = (float(edge) for edge in dome(self.fluid).edges[[0, -1]])
        if low <= T < high:
            return None
        what = f"{self.known.name} condenses at {in_celsius(T)}, {rho:.6g} kg/m3"
        limit = Limit.GLIDING if T < low else Limit.CRITICAL
        return Outside(limit, f"{what}: its two phases are followed from {in_celsius(low)} to {in_celsius(high)} only")


@lru_cache(maxsize=64)  # a few states of the lines are needed again and again
def _vapour_density(gas: RealGas, p: float, T: float) -> float:
    found = saturation(gas.fluid)
    return float(gas._kernels["density"](p, T, gas.R, found.T_c, found.rho_c))


@lru_cache(maxsize=64)
def _vapour_energies(gas: RealGas, p: float, T: float) -> tuple[float, float]:
    """Return specific enthalpy [J/kg] and entropy [J/(kg K)] of the vapour at p [Pa], T [K]."""
    rho = gas.density(p, T)
    return float(gas._kernels["state"](T, rho)[1]), float(gas._kernels["specific_entropy"](T, rho))


@lru_cache(maxsize=64)
def _at_pressure(gas: RealGas, p: float, wanted: float, entropy: bool) -> tuple[float, float]:
    """Return (T, ρ) at p and a given enthalpy or entropy; ρ ≤ 0 where there is no such state."""
    follows, at_pressure, numbers = gas._isobar
    wet = blend_wet(gas.fluid).at_pressure(p, wanted, entropy) if follows else None
    if wet is not None:
        return wet
    return at_pressure(p, wanted, entropy, *numbers)
