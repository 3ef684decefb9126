"""Pressure of R134a over oils by the equations that the sources fitted to their own points, with their constants.

They tell in which unit a loading is stored (in any other, a source's equation misses its own points many times over),
and how far the points scatter about a smooth law. Constants: as SorpPropLib has them from the papers. x is the mole
fraction of R134a in the solution, T [K], pressures [Pa].
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import CoolProp
import numpy as np
from CoolProp.CoolProp import AbstractState
from scipy.optimize import brentq

from screwsim.fluid.solubility import M_OIL, R, log_activity
from screwsim.fluid.solubility_laws import ESTER

Pressure = Callable[[float, float], float]  # of T and x
LEAST, STEP = 100.0, 0.9  # [Pa] least pressure that is sought, and the steps of the search down to it
BELOW = 0.9999  # share of the saturation pressure up to which vapour is asked for its fugacity


@lru_cache(maxsize=1)
def _vapour() -> AbstractState:
    state = AbstractState("HEOS", "R134a")
    state.specify_phase(CoolProp.iphase_gas)
    return state


def fugacity(T: float, p: float) -> float:
    """Return the fugacity [Pa] of R134a as vapour."""
    state = _vapour()
    state.update(CoolProp.PT_INPUTS, p, T)
    return p * float(state.fugacity_coefficient(0))


def flory_huggins(segments: float, energy: float, bend: float) -> Pressure:
    """Return the law of Wahlström and Vamling: χ = energy/T (1 + bend/T) of an oil of so many segments."""

    def pressure(T: float, x: float) -> float:
        oil = segments * (1.0 - x) / (x + segments * (1.0 - x))
        most = BELOW * ESTER.p_sat(T)
        chi = energy / T * (1.0 + bend / T)
        log_gamma = math.log(1.0 - (1.0 - 1.0 / segments) * oil) + (1.0 - 1.0 / segments) * oil + chi * oil * oil
        wanted = x * math.exp(log_gamma) * fugacity(T, most)
        return most if wanted >= fugacity(T, most) else float(brentq(lambda p: fugacity(T, p) - wanted, 1.0, most))

    return pressure


def heil(d_12: float, d_21: float, molar_mass: float, density: tuple[float, float]) -> Pressure:
    """Return Heil's model as Martz and Jacobi fitted it: d in J/mol, oil of ρ = a − b T_F [lb/ft³].

    Activities are ratios of fugacities: with these their constants, too, miss their points by less than with pressures.
    """

    def pressure(T: float, x: float) -> float:
        known = ESTER.pair(T)
        like = known.lambda_12 * math.exp(known.tau_12)  # of M195's oil, v_2/v_1
        fahrenheit = 1.8 * (T - 273.15) + 32.0
        like *= molar_mass / M_OIL * (61.387 - 0.024138 * fahrenheit) / (density[0] - density[1] * fahrenheit)
        own_12, own_21 = d_12 / (R * T), d_21 / (R * T)
        activity = log_activity(x, like * math.exp(-own_12), math.exp(-own_21) / like, own_12, own_21)
        return known.p_sat * ESTER.vapour(T).share(activity)

    return pressure


class Cubic(NamedTuple):
    """A cubic equation of state: p = R T/(v − b) − a/((v + first b)(v + second b)).

    a_b: a and b of n_1 mol of R134a and n_2 of oil at T.
    """

    first: float
    second: float
    a_b: Callable[[float, float, float], tuple[float, float]]

    def log_fugacity(self, T: float, p: float, x: float, liquid: bool) -> float:
        """Return ln φ of R134a at its mole fraction x, by the slope of the residual Helmholtz energy."""
        a, b = self.a_b(T, x, 1.0 - x)
        u, w = self.first + self.second, self.first * self.second
        A, B = a * p / (R * T) ** 2, b * p / (R * T)
        cubic = (1.0, (u - 1.0) * B - 1.0, A + (w - u) * B * B - u * B, -(A * B + w * B * B * (1.0 + B)))
        roots = [root.real for root in np.roots(cubic) if abs(root.imag) < 1e-9 and root.real > B]
        Z = min(roots) if liquid else max(roots)
        V, step = Z * R * T / p, 1e-6

        def residual(n_1: float, n_2: float) -> float:
            n = n_1 + n_2
            a, b = self.a_b(T, n_1 / n, n_2 / n)
            ends = math.log((V + self.first * n * b) / (V + self.second * n * b))
            return -n * math.log(1.0 - n * b / V) - n * a / (b * R * T * (self.first - self.second)) * ends

        slope = (residual(x + step, 1.0 - x) - residual(x - step, 1.0 - x)) / (2.0 * step)
        return slope - math.log(Z)

    def pressure(self, T: float, x: float) -> float:
        """Return the pressure at which R134a has one fugacity in the solution and as vapour, its own at most."""

        def excess(p: float) -> float:
            return math.log(x) + self.log_fugacity(T, p, x, True) - self.log_fugacity(T, p, 1.0, False)

        high = most = BELOW * ESTER.p_sat(T)
        if excess(most) > 0.0:
            return most  # by the equation the oil would part in two liquids
        while high > LEAST:
            low = STEP * high
            if excess(low) > 0.0:
                return float(brentq(excess, low, high))
            high = low
        return math.nan


def alkylbenzene(p_c: float, T_c: float, omega: float, kappa_1: float, delta: float) -> Pressure:
    """Return the Peng–Robinson–Stryjek–Vera equation of Takigawa, Sandler and Yokozeki: the oil's constants."""

    def pure(T: float, p_c: float, T_c: float, omega: float, kappa_1: float) -> tuple[float, float]:
        kappa = 0.378893 + 1.4897153 * omega - 0.17131848 * omega**2 + 0.0196554 * omega**3
        kappa += kappa_1 * (1.0 + math.sqrt(T / T_c)) * (0.7 - T / T_c)
        alpha = (1.0 + kappa * (1.0 - math.sqrt(T / T_c))) ** 2
        return 0.457235 * (R * T_c) ** 2 / p_c * alpha, 0.077796 * R * T_c / p_c

    def a_b(T: float, x: float, y: float) -> tuple[float, float]:
        a_1, b_1 = pure(T, 4.0593e6, 374.21, 0.32684, -0.0077)
        a_2, b_2 = pure(T, p_c, T_c, omega, kappa_1)
        return x * x * a_1 + 2.0 * x * y * math.sqrt(a_1 * a_2) * (1.0 - delta) + y * y * a_2, x * b_1 + y * b_2

    root = math.sqrt(2.0)
    return Cubic(1.0 + root, 1.0 - root, a_b).pressure


def redlich_kwong(p_c: float, T_c: float, beta: float, m: float, l_12: float, l_21: float) -> Pressure:
    """Return the Redlich–Kwong equation of Yokozeki, mixing as in SorpPropLib: the oil's constants."""

    def pure(T: float, p_c: float, T_c: float, betas: tuple[float, ...]) -> tuple[float, float]:
        alpha = sum(each * (T_c / T - T / T_c) ** power for power, each in enumerate(betas))
        return 0.42748 * (R * T_c) ** 2 / p_c * alpha, 0.08664 * R * T_c / p_c

    def a_b(T: float, x: float, y: float) -> tuple[float, float]:
        a_1, b_1 = pure(T, 4.059e6, 374.21, (1.0025, 0.50532, -0.04983))
        a_2, b_2 = pure(T, p_c, T_c, (1.0, beta))
        k = l_12 * l_21 / (l_21 * x + l_12 * y)
        a = x * x * a_1 + 2.0 * x * y * math.sqrt(a_1 * a_2) * (1.0 - k) + y * y * a_2
        return a, x * x * b_1 + x * y * (b_1 + b_2) * (1.0 - m) + y * y * b_2

    return Cubic(1.0, 0.0, a_b).pressure
