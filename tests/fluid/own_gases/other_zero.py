"""An ideal gas whose enthalpy has another zero: negative in both lines."""

from __future__ import annotations

from dataclasses import dataclass

from screwsim.fluid.constants import gas_constant
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.models import GasModel
from screwsim.numerics.kernel import kernel

T_ZERO = 500.0  # [K] at which h is zero


@kernel
def state(T, rho, R_gas, c_v_gas, c_p_gas, a_gas, choke_gas, choked_gas, zero_gas):
    """Return (p, h, c_v, T ∂p/∂T, 1/k, drop and ψ² of choking); `zero_gas` [J/kg] is taken from c_p T."""
    p = rho * R_gas * T
    return p, c_p_gas * T - zero_gas, c_v_gas, p, a_gas, choke_gas, choked_gas


@dataclass(frozen=True)
class OtherZero(IdealGas):
    """An ideal gas with h = c_p (T − T_ZERO)."""

    state = state

    @property
    def values(self):
        return {**super().values, "zero_gas": self.c_p * T_ZERO}

    def enthalpy(self, p, T):
        return self.c_p * (T - T_ZERO)

    def temperature(self, p, h):
        return h / self.c_p + T_ZERO


GAS = GasModel(lambda asked: OtherZero(gas_constant(asked.fluid), asked.isentropic_exponent))
