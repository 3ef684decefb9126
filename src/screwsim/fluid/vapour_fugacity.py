"""Fugacity of a pure vapour at one temperature over that at its saturation, as a function of p/p_sat, and its inverse.

Beyond the saturation's end p_sat is the pressure of the reference state (`reference_state`).

ln φ / (p/p_sat) is a polynomial over temperature and over t, in which √(1 − κ p/p_sat) is linear: the vapour's
volume has such a root at its spinodal, which near the critical temperature is just beyond saturation. Nodes are those
of Chebyshev. Of R134a from 255 K to 370 K, ln(f/f_sat) is within 2e-6 of CoolProp's between them
(tests/fluid/test_vapour_fugacity.py). φ goes to 1 with falling pressure; f/f_sat is 1 at saturation, exactly.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from screwsim.fluid.constants import ask
from screwsim.fluid.reference_state import last_saturation, reference_pressure

Array = np.ndarray

KAPPA = 0.98  # a root at 1.02 p_sat
ROOT = math.sqrt(1.0 - KAPPA)  # at saturation
ROWS, COLUMNS = 8, 14  # nodes over pressure and over temperature
ITERATIONS, NEAR = 60, 1e-14  # most Newton steps; last one of ln(p/p_sat)


class Fugacity(NamedTuple):
    """That of vapour at one temperature: coefficients of ln φ / (p/p_sat) by powers of t, highest first; ln φ_sat."""

    powers: tuple[float, ...]
    at_saturation: float

    def logarithm(self, share: float) -> tuple[float, float]:
        """Return ln φ and its slope over `share`, p/p_sat, from 0 to 1."""
        root = math.sqrt(1.0 - KAPPA * share)
        t = (1.0 - root) / (1.0 - ROOT)
        value = slope = 0.0
        for each in self.powers:
            slope = slope * t + value
            value = value * t + each
        return share * value, value + share * slope * KAPPA / (2.0 * root * (1.0 - ROOT))

    def ratio(self, share: float) -> float:
        """Return f/f_sat at `share`, p/p_sat, which counts as 1 beyond; 0 where it is not positive."""
        if share >= 1.0 or share <= 0.0:
            return float(share > 0.0)
        return share * math.exp(self.logarithm(share)[0] - self.at_saturation)

    def share(self, log_ratio: float) -> float:
        """Return p/p_sat from ln(f/f_sat); beyond saturation by the slope there.

        Newton's method: ln f is concave over ln p, so that steps from below never pass the root.
        """
        if log_ratio >= 0.0:
            return math.exp(log_ratio / (1.0 + self.logarithm(1.0)[1]))
        y = log_ratio + self.at_saturation
        for _ in range(ITERATIONS):
            share = math.exp(y)
            value, slope = self.logarithm(share)
            step = (log_ratio + self.at_saturation - y - value) / (1.0 + share * slope)
            y = min(y + step, 0.0)
            if abs(step) < NEAR * (1.0 + abs(y)):
                break
        return math.exp(y)


class FugacityTable:
    """That of a vapour from a lowest to a highest temperature [K], beyond which it is that of the end."""

    def __init__(self, fluid: str, low: float, high: float) -> None:
        self._middle, self._half = 0.5 * (low + high), 0.5 * (high - low)
        u, v = _nodes(ROWS), _nodes(COLUMNS)
        t = 0.5 * (u + 1.0)
        shares = (1.0 - (1.0 - t * (1.0 - ROOT)) ** 2) / KAPPA
        logs = np.log(_coefficients(fluid, (self._middle + self._half * v).tolist(), shares.tolist()))
        over_t = np.linalg.solve(np.vander(t, ROWS), (logs / shares).T)
        self._over_T = np.linalg.solve(chebyshev.chebvander(v, COLUMNS - 1), over_t.T)

    def at(self, T: float) -> Fugacity:
        """Return that at a temperature [K]."""
        v = min(max((T - self._middle) / self._half, -1.0), 1.0)
        powers = tuple(np.cos(math.acos(v) * np.arange(COLUMNS)) @ self._over_T)
        return Fugacity(tuple(map(float, powers)), float(sum(powers)))


def _coefficients(fluid: str, temperatures: list[float], shares: list[float]) -> list[list[float]]:
    """Return CoolProp's φ of the vapour at temperatures [K] and shares of the pressures of the reference state."""

    def question() -> list[list[float]]:
        import CoolProp.CoolProp as coolprop

        state, found = coolprop.AbstractState("HEOS", fluid), []
        for T in temperatures:
            state.unspecify_phase()
            if last_saturation(fluid) >= T:
                state.update(coolprop.QT_INPUTS, 1.0, T)
                p_sat = state.p()
                state.specify_phase(coolprop.iphase_gas)
            else:
                p_sat = reference_pressure(fluid, T)
            found.append([])
            for share in shares:
                state.update(coolprop.PT_INPUTS, share * p_sat, T)
                found[-1].append(state.fugacity_coefficient(0))
        return found

    return ask(f"{fluid} phi {temperatures!r} {shares!r}", question)


def _nodes(count: int) -> Array:
    return np.cos(np.pi * (np.arange(count) + 0.5) / count)


@lru_cache(maxsize=4)
def fugacity_table(fluid: str, low: float, high: float) -> FugacityTable:
    """Return the table of a pure fluid between temperatures [K]."""
    return FugacityTable(fluid, low, high)
