"""A gas of which only its equation is written: its kernels, R and the dilute c_v. All else is searched.

Searches are Newton's method in plain Python, on derivatives that the kernel `state` gives:
∂p/∂ρ|T = c² − T (∂p/∂T)²/(ρ² c_v) and c_p = c_v c²/(∂p/∂ρ|T), with c² = k p/ρ (textbook). They find gas, never a
liquid: a density is sought from that of the ideal gas, which is thinner than vapour whose molecules attract each other.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from screwsim.fluid.gas import CommonGas, kernel_value
from screwsim.fluid.limits import Outside
from screwsim.inputs.faults import QuantityNotFound
from screwsim.outputs.customary import in_bar, in_celsius

MOST_STEPS = 60  # of a search; a usual one takes five
ROUNDING = 1e-12  # relative step that ends a search
HOT = 600.0  # [K] from which temperatures are sought, downwards: there is gas at any usual pressure


class _State(NamedTuple):
    """A state of a gas: ρ [kg/m³], h [J/kg], ∂p/∂ρ at constant T [J/kg], c_p [J/(kg K)]."""

    rho: float
    h: float
    stiffness: float
    c_p: float


class EquationGas(CommonGas):
    """Base class of a gas by its kernels `state` and `specific_entropy`, their `values`, `R` and `c_v`.

    It has one phase, 1/k and choking that depend on the state, and no limits, unless a subclass says otherwise.
    """

    equations: tuple[str, ...] = ()
    phased_state = None
    varies = True

    def density(self, p: float, T: float) -> float:
        """Return density [kg/m³] of the gas at p [Pa], T [K]; raise QuantityNotFound where there is none."""
        return self._at(p, T).rho

    def enthalpy(self, p: float, T: float) -> float:
        """Return specific enthalpy [J/kg] at p [Pa], T [K]."""
        return self._at(p, T).h

    def entropy(self: Any, p: float, T: float) -> float:
        """Return specific entropy [J/(kg K)] at p [Pa], T [K]."""
        return kernel_value(self, self.specific_entropy, T, self.density(p, T))

    def temperature(self, p: float, h: float) -> float:
        """Return temperature [K] at p [Pa] and specific enthalpy h [J/kg]; raise QuantityNotFound without one."""
        return self._isobar(p, lambda T, at: T - (at.h - h) / at.c_p)

    def port_state(self: Any, p: float, T: float) -> tuple[float, ...]:
        """Return (p, ρ, h, 1/k, drop and ψ² of choking) of a plenum at p [Pa], T [K]."""
        rho = self.density(p, T)
        _p, h, _c_v, _slope, inverse, drop, choked = kernel_value(self, self.state, T, rho)
        return p, rho, h, inverse, drop, choked

    def port_state_of_enthalpy(self, p: float, h: float) -> tuple[float, ...]:
        """Return the same as `port_state`, at p [Pa] and specific enthalpy h [J/kg]."""
        return self.port_state(p, self.temperature(p, h))

    def isentropic_work(self, p_1: float, p_2: float, T: float) -> float:
        """Return the isentropic enthalpy rise [J/kg] from (p_1, T) to p_2."""
        s = self.entropy(p_1, T)
        T_2 = self._isobar(p_2, lambda T, at: T * math.exp((s - self.entropy(p_2, T)) / at.c_p))
        return self.enthalpy(p_2, T_2) - self.enthalpy(p_1, T)

    def isentropic_work_of_enthalpy(self, p_1: float, p_2: float, h: float) -> float:
        """Return the isentropic enthalpy rise [J/kg] from p_1 and specific enthalpy h to p_2."""
        return self.isentropic_work(p_1, p_2, self.temperature(p_1, h))

    def isothermal_obstacle(self, p_1: float, p_2: float, T: float) -> str | None:
        """Return why there is no isothermal compression from p_1 to p_2 [Pa] at T [K], or None."""
        try:
            self.density(max(p_1, p_2), T)
        except QuantityNotFound as reason:
            return str(reason)
        return None

    def why_outside(self, T: float, rho: float) -> Outside | None:
        """Return None: the equation is taken to cover every state."""
        return None

    def _at(self: Any, p: float, T: float) -> _State:
        """Return the gas at p [Pa], T [K]; raise QuantityNotFound where the equation has none."""
        rho = p / (self.R * T)
        for _ in range(MOST_STEPS):
            found, h, c_v, slope, inverse, *_ = kernel_value(self, self.state, T, rho)
            c2 = found / (inverse * rho) if inverse > 0.0 else math.nan
            stiffness = c2 - slope**2 / (T * c_v * rho**2) if c_v > 0.0 else math.nan
            if not stiffness > 0.0:  # beyond the densest vapour, and NaN
                break
            step = (p - found) / stiffness
            if abs(step) <= ROUNDING * rho:
                return _State(rho, h, stiffness, c_v * c2 / stiffness)
            rho = max(rho + step, 0.5 * rho)
        raise QuantityNotFound(f"the equation of the gas has no vapour at {in_bar(p)}, {in_celsius(T)}; use warmer gas")

    def _isobar(self, p: float, step: Callable[[float, _State], float]) -> float:
        """Return the temperature [K] at p [Pa] that a step of Newton's method does not change, from hot gas."""
        T, at = HOT, self._at(p, HOT)
        for _ in range(MOST_STEPS):
            wanted = min(max(step(T, at), 0.5 * T), 2.0 * T)
            if abs(wanted - T) <= ROUNDING * T:
                return wanted
            try:
                T, at = wanted, self._at(p, wanted)
            except QuantityNotFound:  # a step too far, into the liquid
                T = 0.5 * (T + wanted)
                at = self._at(p, T)
        raise QuantityNotFound(f"the equation of the gas has no such state at {in_bar(p)}; use warmer gas or oil")
