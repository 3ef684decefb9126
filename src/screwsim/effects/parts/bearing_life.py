"""Rating life of rolling bearings: equivalent load, basic rating life, life of a set (docs/model.md M482–M484).

Source: ISO 281:2007 (P = X F_r + Y F_a, with X, Y of table 3 for ball bearings and of that for radial roller bearings;
exponents 3 and 10/3; Weibull slopes 10/9 and 9/8); the mean of a varying load by linear summation of damage,
A. Palmgren, 1924; the set as a series system, G. Lundberg, A. Palmgren, 1947. Valid up to half the rating
(`MOST_SHARE`), as ISO 281 says.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from screwsim.numerics.roots import brentq

MOST_SHARE = 0.5  # of the rating: the largest equivalent load for which ISO 281 holds
RATED = 1e6 * 2.0 * math.pi  # [rad] that nine of ten bearings turn under the load C


class BearingType(NamedTuple):
    """Exponent p of the life, Weibull slope, and X, Y beyond e = F_a/F_r; None: of the maker's table.

    `at_e` is P/F_r at e, where both branches meet: 1 of single rows, more of pairs, which carry F_a below e, too.
    """

    exponent: float
    slope: float
    radial_factor: float | None
    axial_factor: float | None
    at_e: float = 1.0
    symmetrical: bool = False

    @property
    def either_way(self) -> bool:
        """Whether it holds a thrust to either side: two rows against each other, or a row with two shoulders."""
        return self.symmetrical or self.at_e > 1.0


_BALL, _ROLLER = (3.0, 10.0 / 9.0), (10.0 / 3.0, 9.0 / 8.0)
TYPES = {
    "cylindrical_roller": BearingType(*_ROLLER, None, None),  # carries no thrust
    "tapered_roller": BearingType(*_ROLLER, 0.4, None),  # Y = 0.4 cot α
    "tapered_roller_pair": BearingType(*_ROLLER, 0.67, None, 1.675),  # 0.67 cot α; 0.45 cot α below e = 1.5 tan α
    "angular_contact_ball": BearingType(*_BALL, 0.35, 0.57),  # α = 40°
    "angular_contact_ball_pair": BearingType(*_BALL, 0.57, 0.93, (0.93 - 0.57 * 0.55) / (0.93 - 0.55)),  # 0.55 below e
    "deep_groove_ball": BearingType(*_BALL, 0.56, None, symmetrical=True),  # Y by F_a/C_0
}


def equivalent_load(radial: np.ndarray, axial: np.ndarray, X: float, Y: float, at_e: float = 1.0) -> np.ndarray:
    """Return P [N] by angle from radial and axial load [N] (M482): F_r + Y_1 F_a up to e, X F_r + Y F_a beyond it.

    The two branches of ISO 281 meet at F_a/F_r = e, where P is `at_e` F_r, so the larger one holds; Y_1 follows.
    """
    Y_1 = Y * (at_e - 1.0) / (at_e - X) if at_e > 1.0 else 0.0
    thrust = np.abs(axial)
    return np.maximum(radial + Y_1 * thrust, X * radial + Y * thrust)


def mean_load(load: np.ndarray, exponent: float) -> float:
    """Return the constant load [N] of the same life as one that varies over even angles of a turn (M482)."""
    most = float(load.max())
    return most * float(np.mean((load / most) ** exponent)) ** (1.0 / exponent) if most > 0.0 else 0.0


def rating_life(rating: float, load: float, exponent: float, speed: float, life_factor: float) -> float:
    """Return the life L_10mh [s] (M483): rating C and load P > 0 [N], speed [rad/s], a_ISO (1: basic rating life)."""
    return life_factor * (rating / load) ** exponent * RATED / speed


def life_of_set(lives: Sequence[tuple[float, float]]) -> float:
    """Return the life [s] that nine of ten sets reach with all bearings whole, from (life [s], slope) of each (M484).

    With one slope for all it is (Σ L^−e)^(−1/e); else the root of Σ (L/L_i)^e_i = 1, to rounding.
    """
    least = min(life for life, _ in lives)
    most = math.log(len(lives))  # no slope is below 1

    def beyond(x: float) -> float:
        return sum((math.exp(-x) * least / life) ** slope for life, slope in lives) - 1.0

    return least * math.exp(-brentq(beyond, 0.0, most))
