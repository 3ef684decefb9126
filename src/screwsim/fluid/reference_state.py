"""Reference state of a dissolved refrigerant: its saturation, continued beyond the critical temperature (M198).

Up to 0.99 of the critical temperature it is saturated liquid. Beyond, ln p over 1/T goes on as a straight line.

Source: J. M. Prausnitz, F. H. Shair, AIChE J. 7 (1961) 682, of the hypothetical liquid of a gas in solution.
"""

import math
from functools import lru_cache

from screwsim.fluid import constants

NEAR_CRITICAL = 0.99  # of the critical temperature: up to there it is saturated liquid
STEP = 1.0  # [K] over which the line's slope is taken


def last_saturation(fluid: str) -> float:
    """Return the temperature [K] up to which the reference state is saturated liquid."""
    known = constants.limits(fluid)
    assert known is not None  # a fluid of a scene
    return NEAR_CRITICAL * known.T_critical


@lru_cache(maxsize=32)
def _line(fluid: str) -> tuple[float, float, float]:
    """Return where the line begins: 1/T [1/K] and ln p [Pa], and its slope [K]."""
    T = last_saturation(fluid)
    at, before = (math.log(constants.dew_pressure(fluid, each)) for each in (T, T - STEP))
    return 1.0 / T, at, (at - before) / (1.0 / T - 1.0 / (T - STEP))


def reference_pressure(fluid: str, T: float) -> float:
    """Return the pressure [Pa] of the reference state at T [K]: dew point, or its continuation."""
    if last_saturation(fluid) >= T:
        return constants.dew_pressure(fluid, T)
    inverse, logarithm, slope = _line(fluid)
    return math.exp(logarithm + slope * (1.0 / T - inverse))
