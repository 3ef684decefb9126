"""A gas whose molecules take room, p = ρ R T/(1 − b ρ): a property back end of its own in one file.

Its energy is c_v T as the ideal gas's; b = 0 is the ideal gas. With x = 1 − b ρ: h = c_v T + R T/x = c_p T + b p,
s = c_v ln(T/T_0) − R ln(ρ/x), k_flow = ρ c²/p = k/x. Source: Noble & Abel's equation (textbook).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from screwsim.fluid.constants import gas_constant, isentropic_exponent
from screwsim.fluid.models import GasModel
from screwsim.fluid.nozzle import choking
from screwsim.fluid.reservoir import Reservoir
from screwsim.numerics.kernel import kernel

T_ZERO = 273.15


@kernel
def state(T, rho, R_gas, k_gas, b_gas):
    """Return (p, h, c_v, T ∂p/∂T, 1/k, drop and ψ² of choking)."""
    room = 1.0 - b_gas * rho
    p = rho * R_gas * T / room
    c_v = R_gas / (k_gas - 1.0)
    drop, choked = choking(k_gas / room)
    return p, c_v * T + R_gas * T / room, c_v, p, room / k_gas, drop, choked


@kernel
def specific_entropy(T, rho, R_gas, k_gas, b_gas):
    """Return s [J/(kg K)]."""
    return R_gas / (k_gas - 1.0) * math.log(T / T_ZERO) - R_gas * math.log(rho / (1.0 - b_gas * rho))


@dataclass(frozen=True)
class CovolumeGas:
    """R [J/(kg K)], k of the dilute gas, b [m³/kg]."""

    R: float
    k: float
    b: float
    equations = ()
    state = state
    specific_entropy = specific_entropy
    phased_state = None
    varies = True

    @property
    def values(self):
        return {"R_gas": self.R, "k_gas": self.k, "b_gas": self.b}

    @property
    def c_v(self):
        return self.R / (self.k - 1.0)

    @property
    def c_p(self):
        return self.c_v + self.R

    def density(self, p, T):
        return p / (self.R * T + self.b * p)

    def enthalpy(self, p, T):
        return self.c_p * T + self.b * p

    def entropy(self, p, T):
        return specific_entropy(T, self.density(p, T), *self.values.values())

    def temperature(self, p, h):
        return (h - self.b * p) / self.c_p

    def port_state(self, p, T):
        rho = self.density(p, T)
        _, h, _, _, a, drop, choked = state(T, rho, *self.values.values())
        return p, rho, h, a, drop, choked

    def port_state_of_enthalpy(self, p, h):
        return self.port_state(p, self.temperature(p, h))

    def vapour(self, p, T):
        p, rho, h, a, drop, choked = self.port_state(p, T)
        return Reservoir(p, T, rho, h, self.entropy(p, T), a, drop, choked)

    def nearest_vapour(self, p, T):
        return T

    def isentropic_work(self, p_1, p_2, T):
        return self.c_p * T * ((p_2 / p_1) ** (1.0 - 1.0 / self.k) - 1.0) + self.b * (p_2 - p_1)

    def isentropic_work_of_enthalpy(self, p_1, p_2, h):
        return self.isentropic_work(p_1, p_2, self.temperature(p_1, h))

    def isothermal_obstacle(self, p_1, p_2, T):
        return None

    def isothermal_work(self, p_1, p_2, T):
        return self.R * T * math.log(p_2 / p_1) + self.b * (p_2 - p_1)

    def ideal_isothermal_work(self, p_1, p_2, T):
        return self.R * T * math.log(p_2 / p_1)

    def first_outside(self, T, rho):
        return None

    def why_outside(self, T, rho):
        return None


COVOLUME = 2e-3  # [m³/kg]


def make(asked):
    """Return the gas of what a scene says; k from CoolProp at suction temperature where none is given."""
    k = asked.isentropic_exponent or isentropic_exponent(asked.fluid, asked.suction_temperature())
    return CovolumeGas(gas_constant(asked.fluid), k, COVOLUME)


GAS = GasModel(make)
