"""The cubic equation of Peng and Robinson: p = R T/(v − b) − a/(v² + 2 b v − b²).

a = 0.45724 R² T_c²/p_c [1 + m (1 − √(T/T_c))]², b = 0.07780 R T_c/p_c, m = 0.37464 + 1.54226 ω − 0.26992 ω². The heat
capacity of the dilute gas is constant, R k/(k − 1). Source: Peng, Robinson, Ind. Eng. Chem. Fundam. 15 (1976).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from CoolProp.CoolProp import PropsSI

from screwsim.fluid.constants import gas_constant, isentropic_exponent
from screwsim.fluid.equation_gas import EquationGas
from screwsim.fluid.models import GasModel
from screwsim.fluid.nozzle import choking
from screwsim.numerics.kernel import kernel

ROOT = math.sqrt(2.0)
T_ZERO = 273.15


@kernel
def attraction(T, T_c, m_gas, a_c):
    """Return a [Pa m⁶/kg²], its derivative by T, and the second one."""
    root = math.sqrt(T / T_c)
    bracket = 1.0 + m_gas * (1.0 - root)
    slope = -a_c * m_gas * bracket / (root * T_c)
    return a_c * bracket * bracket, slope, 0.5 * a_c * m_gas * (1.0 + m_gas) / (root * T_c * T)


@kernel
def room(rho, b_gas):
    """Return the logarithm of the equation's departures over 2√2 b [kg/m³]."""
    b = b_gas * rho
    return math.log((1.0 + (1.0 + ROOT) * b) / (1.0 + (1.0 - ROOT) * b)) / (2.0 * ROOT * b_gas)


@kernel
def state(T, rho, R_gas, k_gas, b_gas, T_c, m_gas, a_c):
    """Return (p, h, c_v, T ∂p/∂T, 1/k, drop and ψ² of choking)."""
    a, slope, curve = attraction(T, T_c, m_gas, a_c)
    b = b_gas * rho
    lower, around = 1.0 - b, 1.0 + 2.0 * b - b * b
    p = rho * R_gas * T / lower - a * rho * rho / around
    dilute, log = R_gas / (k_gas - 1.0), room(rho, b_gas)
    c_v = dilute + T * curve * log
    h = dilute * T + (T * slope - a) * log + p / rho
    T_dp_dT = T * (rho * R_gas / lower - slope * rho * rho / around)
    dp_drho = R_gas * T / (lower * lower) - 2.0 * a * rho * (1.0 + b) / (around * around)
    c2 = dp_drho + T_dp_dT * T_dp_dT / (T * c_v * rho * rho)
    drop, choked = choking(rho * c2 / p)
    return p, h, c_v, T_dp_dT, p / (rho * c2), drop, choked


@kernel
def specific_entropy(T, rho, R_gas, k_gas, b_gas, T_c, m_gas, a_c):
    """Return s [J/(kg K)]."""
    _, slope, _ = attraction(T, T_c, m_gas, a_c)
    dilute = R_gas / (k_gas - 1.0)
    return dilute * math.log(T / T_ZERO) + R_gas * math.log((1.0 - b_gas * rho) / rho) + slope * room(rho, b_gas)


@dataclass(frozen=True)
class PengRobinson(EquationGas):
    """R [J/(kg K)], k of the dilute gas, critical temperature [K] and pressure [Pa], acentric factor."""

    R: float
    k: float
    T_critical: float
    p_critical: float
    acentric: float
    state = state
    specific_entropy = specific_entropy

    @property
    def values(self):
        m = 0.37464 + (1.54226 - 0.26992 * self.acentric) * self.acentric
        b = 0.07780 * self.R * self.T_critical / self.p_critical
        a = 0.45724 * (self.R * self.T_critical) ** 2 / self.p_critical
        return {"R_gas": self.R, "k_gas": self.k, "b_gas": b, "T_c": self.T_critical, "m_gas": m, "a_c": a}

    @property
    def c_v(self):
        return self.R / (self.k - 1.0)


def make(asked):
    """Return the gas of what a scene says, with CoolProp's critical point and acentric factor of the fluid."""
    k = asked.isentropic_exponent or isentropic_exponent(asked.fluid, asked.suction_temperature())
    return PengRobinson(
        gas_constant(asked.fluid), k, *(PropsSI(name, asked.fluid) for name in ("Tcrit", "pcrit", "acentric"))
    )


GAS = GasModel(make, condenses=True)
