"""R134a dissolved in a polyol ester oil: activity by Heil's model, and the content in equilibrium (M195).

Source: J. J. Grebner, thesis, 1992 (constants; oil of 0.590 kg/mol); J. F. Heil, J. M. Prausnitz, AIChE J. 12 (1966)
678. Fitted from 255 K to 394 K; mean error 3.2 % at its 44 points. Activities are ratios of the vapour's fugacities:
what is p in `dissolved` is p_sat f/f_sat. The indices of Λ and τ are those with which the model has the limit of Flory
and Huggins; docs/model.md says how it is found elsewhere, and what that costs.
"""

import math
from typing import NamedTuple

from screwsim.numerics.kernel import kernel
from screwsim.numerics.spline import table_value

FLUID = "R134a"
LOW = 255.0  # [K] from which it was fitted, up to 394 K
M_REFRIGERANT, M_OIL = 0.102032, 0.590  # [kg/mol]
R = 8.314462618  # [J/(mol K)]
TAU_12, TAU_21 = 948.0, 3993.0  # [J/mol]
ITERATIONS = 60  # most Newton steps
NEAR = 1e-12  # last step of ln x


class RefrigerantOilPair(NamedTuple):
    """The pair at one temperature: p_sat [Pa] of the refrigerant, Heil's Λ and τ, and the ratio of molar masses.

    Λ12 = (v_oil/v_refrigerant) e^−τ12 weighs the oil around a molecule of refrigerant, Λ21 the refrigerant around one
    of oil.
    """

    p_sat: float
    lambda_12: float
    lambda_21: float
    tau_12: float
    tau_21: float
    mass_ratio: float


def pair(T: float, p_sat: float, liquid_density: float) -> RefrigerantOilPair:
    """Return the pair's constants at T [K] from the refrigerant's saturation pressure [Pa] and its liquid's density."""
    fahrenheit = 1.8 * (T - 273.15) + 32.0
    v_1 = M_REFRIGERANT / liquid_density
    v_2 = M_OIL / (16.0185 * (61.387 - 0.024138 * fahrenheit))
    tau_12, tau_21 = TAU_12 / (R * T), TAU_21 / (R * T)
    return RefrigerantOilPair(
        p_sat, v_2 / v_1 * math.exp(-tau_12), v_1 / v_2 * math.exp(-tau_21), tau_12, tau_21, M_REFRIGERANT / M_OIL
    )


@kernel
def log_activity(x, lambda_12, lambda_21, tau_12, tau_21):
    """Return ln(γ x) of the refrigerant at its mole fraction x by Heil's model (M195)."""
    oil = 1.0 - x
    a = x + lambda_12 * oil
    b = lambda_21 * x + oil
    gamma = -math.log(a) + oil * (lambda_12 / a - lambda_21 / b)
    gamma += oil * oil * (tau_12 * (lambda_12 / a) * (lambda_12 / a) + tau_21 * lambda_21 / (b * b))
    return gamma + math.log(x)


@kernel
def dissolved(p, p_sat, lambda_12, lambda_21, tau_12, tau_21, mass_ratio):
    """Return the refrigerant [kg per kg of oil] in equilibrium at p [Pa] below p_sat (M195); 0 where p is not positive.

    Newton's method in ln x, inside a shrinking bracket.
    """
    if p <= 0.0:
        return 0.0
    wanted = math.log(min(p / p_sat, 1.0 - 1e-9))
    low = -60.0
    high = -1e-12
    z = min(wanted, -1e-3)
    for _ in range(ITERATIONS):
        f = log_activity(math.exp(z), lambda_12, lambda_21, tau_12, tau_21) - wanted
        if f > 0.0:
            high = z
        else:
            low = z
        step = 1e-6 * (abs(z) + 1e-3)
        slope = (log_activity(math.exp(z - step), lambda_12, lambda_21, tau_12, tau_21) - wanted - f) / -step
        new = z - f / slope if slope > 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        done = abs(new - z) < NEAR
        z = new
        if done:
            break
    x = math.exp(z)
    return mass_ratio * x / (1.0 - x)


@kernel
def given_off(m_oil, w, s, h, T_oil, TAB, curve, enthalpy, release, uptake, oil_heat_capacity):
    """Return the gas [kg/s] that oil with content w releases, its enthalpy flow [W], and its heat over c_oil (M231).

    s and h are those of the chamber's gas, with whose state the gas leaves and is absorbed. `curve` gives the logarithm
    of the content over the entropy of the dissolved gas, whose enthalpy is constant.
    """
    latent = h - enthalpy
    excess = w - math.exp(table_value(s - latent / max(T_oil, 1.0), TAB, curve))
    gas = m_oil * excess * (release if excess > 0.0 else uptake)
    return gas, gas * h, gas * latent / oil_heat_capacity


@kernel
def entropies(w, TAB, curve, rest):
    """Return the entropy [J/(kg K)] of a kilogram of gas dissolved in oil with content w, and of all of it (M233)."""
    z = math.log(max(w, 1e-12))
    s = table_value(z, TAB, curve)
    return s, w * (s + table_value(z, TAB, rest))
