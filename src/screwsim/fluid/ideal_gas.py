"""Ideal gas with constant isentropic exponent: p = ρ R T, u = c_v T, h = c_p T, c_v = R/(k − 1).

Source: Chernov et al. 2015, assumptions; docs/model.md M5, M6. It implements the protocol `fluid.gas`.
"""

import math
from dataclasses import dataclass

from screwsim.fluid.gas import CommonGas
from screwsim.fluid.limits import Outside
from screwsim.fluid.nozzle import choking
from screwsim.numerics.identity_cache import once
from screwsim.numerics.kernel import kernel

T_ZERO = 273.15  # [K] temperature of the entropy's reference state


@kernel
def state(T, rho, R_gas, c_v_gas, c_p_gas, a_gas, choke_gas, choked_gas):
    """Return (p, h, c_v, T ∂p/∂T, 1/k, drop and ψ² of choking) of an ideal gas (M5, M6)."""
    p = rho * R_gas * T
    return p, c_p_gas * T, c_v_gas, p, a_gas, choke_gas, choked_gas


@kernel
def specific_entropy(T, rho, R_gas, c_v_gas):
    """Return s = c_v ln(T/T_0) − R ln(ρ/ρ_0) [J/(kg K)], zero at T_0 = 273.15 K and ρ_0 = 1 kg/m³."""
    return c_v_gas * math.log(T / T_ZERO) - R_gas * math.log(rho)


@dataclass(frozen=True)
class IdealGas(CommonGas):
    """An ideal gas by its constant R [J/(kg K)] and isentropic exponent k."""

    R: float
    k: float
    name: str = "ideal"
    equations = ("M5", "M6")
    state = state
    specific_entropy = specific_entropy
    phased_state = None  # one phase
    varies = False  # exponent and choking are the same everywhere

    @once
    def values(self) -> dict[str, float]:
        """Values of the kernels' arguments beside T and rho."""
        choke, choked = self.choked
        return {
            "R_gas": self.R,
            "c_v_gas": self.c_v,
            "c_p_gas": self.c_p,
            "a_gas": 1.0 / self.k,
            "choke_gas": choke,
            "choked_gas": choked,
        }

    @once
    def choked(self) -> tuple[float, float]:
        """Drop and ψ² of choking."""
        return choking(self.k)

    @property
    def c_p(self) -> float:
        """Specific heat capacity at constant pressure [J/(kg K)]."""
        return self.R * self.k / (self.k - 1.0)

    @property
    def c_v(self) -> float:
        """Specific heat capacity at constant volume [J/(kg K)]."""
        return self.R / (self.k - 1.0)

    def density(self, p: float, T: float) -> float:
        """Return density [kg/m³] at pressure [Pa] and temperature [K]."""
        return p / (self.R * T)

    def enthalpy(self, p: float, T: float) -> float:
        """Return specific enthalpy [J/kg]."""
        return self.c_p * T

    def entropy(self, p: float, T: float) -> float:
        """Return specific entropy [J/(kg K)], zero at 273.15 K and 1 kg/m³."""
        return specific_entropy(T, self.density(p, T), self.R, self.c_v)

    def temperature(self, p: float, h: float) -> float:
        """Return temperature [K] at pressure [Pa] and specific enthalpy [J/kg]."""
        return h / self.c_p

    def port_state(self, p: float, T: float) -> tuple[float, ...]:
        """Return (p, ρ, h, 1/k, drop and ψ² of choking) of a plenum."""
        return p, self.density(p, T), self.enthalpy(p, T), 1.0 / self.k, *self.choked

    def port_state_of_enthalpy(self, p: float, h: float) -> tuple[float, ...]:
        """Return the same as `port_state`, at pressure [Pa] and specific enthalpy [J/kg]."""
        return self.port_state(p, self.temperature(p, h))

    def why_outside(self, T: float, rho: float) -> Outside | None:
        """Return None: an ideal gas has no limits."""
        return None

    def isothermal_work(self, p_1: float, p_2: float, T: float) -> float:
        """Return the reversible isothermal work R T ln(p_2/p_1) [J/kg]."""
        return self.ideal_isothermal_work(p_1, p_2, T)

    def isentropic_work_of_enthalpy(self, p_1: float, p_2: float, h: float) -> float:
        """Return the isentropic enthalpy rise [J/kg] from p_1 and specific enthalpy h to p_2."""
        return self.isentropic_work(p_1, p_2, self.temperature(p_1, h))

    def isentropic_work(self, p_1: float, p_2: float, T: float) -> float:
        """Return the isentropic enthalpy rise [J/kg] from (p_1, T) to p_2."""
        return self.c_p * T * ((p_2 / p_1) ** ((self.k - 1.0) / self.k) - 1.0)
