"""A gas whose molecules take room, p = ρ R T/(1 − b ρ): a property back end of its own in one file.

Its energy is c_v T as the ideal gas's; b = 0 is the ideal gas. With x = 1 − b ρ: h = c_v T + R T/x = c_p T + b p,
s = c_v ln(T/T_0) − R ln(ρ/x), k_flow = ρ c²/p = k/x. Source: Noble & Abel's equation (textbook).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from screwsim.fluid.constants import gas_constant, isentropic_exponent
from screwsim.fluid.equation_gas import EquationGas
from screwsim.fluid.models import GasModel
from screwsim.fluid.nozzle import choking
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
class CovolumeGas(EquationGas):
    """R [J/(kg K)], k of the dilute gas, b [m³/kg]."""

    R: float
    k: float
    b: float
    state = state
    specific_entropy = specific_entropy

    @property
    def values(self):
        return {"R_gas": self.R, "k_gas": self.k, "b_gas": self.b}

    @property
    def c_v(self):
        return self.R / (self.k - 1.0)


COVOLUME = 2e-3  # [m³/kg]


def make(asked):
    """Return the gas of what a scene says; k from CoolProp at suction temperature where none is given."""
    k = asked.isentropic_exponent or isentropic_exponent(asked.fluid, asked.suction_temperature())
    return CovolumeGas(gas_constant(asked.fluid), k, COVOLUME)


GAS = GasModel(make)
