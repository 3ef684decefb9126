"""Effect of errors of the links' lengths on the law of motion: transfer function, its spread, accuracy grades.

Source: V. V. Solovyova, "Optimization of the transfer function of a piston compressor by technological criteria", 2019
(in Russian). Its printed function is not the derivative of its x(α), and its table is that of a third function; all
three are here (docs/reference/slider-crank.md). Angles in rad, lengths in m; deviations in m/rad.
"""

import math
from collections.abc import Callable, Mapping
from itertools import product
from typing import NamedTuple, Self

import numpy as np

from screwsim.inputs.faults import UsageError

Array = np.ndarray


class Links(NamedTuple):
    """Lengths of crank and rod, and the offset [m]."""

    crank: float
    rod: float
    offset: float

    def scaled(self, crank: float, rod: float) -> Self:
        """Return the links with the lengths of crank and rod multiplied."""
        return self._replace(crank=self.crank * crank, rod=self.rod * rod)


Transfer = Callable[[Array, Links], Array]


def tan_beta(alpha: Array, links: Links) -> Array:
    """Return the slope of the rod (S1)."""
    sine = (links.crank * np.sin(alpha) - links.offset) / links.rod
    return sine / np.sqrt(1.0 - sine**2)


def right(alpha: Array, links: Links) -> Array:
    """Return the correct derivative dx/dα [m/rad] (S2)."""
    return -links.crank * (np.sin(alpha) + np.cos(alpha) * tan_beta(alpha, links))


def printed(alpha: Array, links: Links) -> Array:
    """Return the formula as the source prints it: lengths in m, the second term over the rod once too often (S6)."""
    return -links.crank * (np.sin(alpha) + np.cos(alpha) * tan_beta(alpha, links) / links.rod)


def tabulated(alpha: Array, links: Links) -> Array:
    """Return the formula behind the source's table: as printed, with the sign of the first term reversed (S7)."""
    return links.crank * (np.sin(alpha) - np.cos(alpha) * tan_beta(alpha, links) / links.rod)


FUNCTIONS: Mapping[str, Transfer] = {"right": right, "printed": printed, "tabulated": tabulated}


def links_of(mean_speed: float, turns: float, ratio: float, offset: float) -> Links:
    """Return the links of the source: r from its mean piston speed 4 r n [m/s] and n [1/s], the rod as a ratio to r."""
    crank = mean_speed / (4.0 * turns)
    return Links(crank, ratio * crank, offset)


def spread(differences: Array) -> float:
    """Return the standard deviation, with n inside the root (S8; the source prints it outside)."""
    return float(np.std(differences))


def deviation(function: Transfer, alpha: Array, nominal: Links, changed: Links, values: Array | None = None) -> float:
    """Return the standard deviation [m/rad] of a changed mechanism (S8).

    `values` are the nominal values to compare with, such as rounded ones; default: the function's own.
    """
    reference = function(alpha, nominal) if values is None else values
    return spread(function(alpha, changed) - reference)


def plane(function: Transfer, alpha: Array, nominal: Links, share: float = 0.05) -> float:
    """Return the standard deviation [m/rad] of a function that is larger by the same share everywhere (S9)."""
    return abs(share) * spread(function(alpha, nominal))


def surface(function: Transfer, alpha: Array, nominal: Links, errors: Array) -> Array:
    """Return the standard deviation over relative errors of crank (rows) and rod (columns)."""
    found = [deviation(function, alpha, nominal, nominal.scaled(1.0 + i, 1.0 + j)) for i in errors for j in errors]
    return np.reshape(found, (len(errors), len(errors)))


# ISO 286-1: steps of nominal sizes [mm] and multiples of the tolerance unit from IT5 on
_STEPS = (1, 3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000, 2500, 3150)
_UNITS = {5: 7, 6: 10, 7: 16, 8: 25, 9: 40, 10: 64, 11: 100, 12: 160, 13: 250}
_UNITS |= {14: 400, 15: 640, 16: 1000, 17: 1600, 18: 2500}
GRADES = tuple(_UNITS)


def tolerance(size: float, grade: int) -> float:
    """Return the width of an ISO 286 tolerance [m] of a size [m] and a grade IT5–IT18 (S10), not rounded.

    The standard's table holds rounded values of this formula, which differ by up to 4 %.
    """
    if grade not in _UNITS:
        raise UsageError(f"IT{grade} is not a grade of this formula (choose IT{GRADES[0]} to IT{GRADES[-1]})")
    size_mm = 1e3 * size
    if not _STEPS[0] <= size_mm <= _STEPS[-1]:
        raise UsageError(f"{size_mm:.6g} mm lies outside ISO 286 (choose a length of {_STEPS[0]} to {_STEPS[-1]} mm)")
    i = max(int(np.searchsorted(_STEPS, size_mm)), 1)
    mean = math.sqrt(_STEPS[i - 1] * _STEPS[i])
    unit = 0.45 * mean ** (1.0 / 3.0) + 0.001 * mean if mean <= 500.0 else 0.004 * mean + 2.1
    return 1e-6 * _UNITS[grade] * unit


def worst(function: Transfer, alpha: Array, nominal: Links, crank_error: float, rod_error: float) -> float:
    """Return the largest standard deviation [m/rad] over the four combinations of ± errors [m]."""
    corners = (
        Links(nominal.crank + s * crank_error, nominal.rod + t * rod_error, nominal.offset)
        for s, t in product((-1.0, 1.0), repeat=2)
    )
    return max(deviation(function, alpha, nominal, corner) for corner in corners)


class Grade(NamedTuple):
    """What a pair of accuracy grades allows: tolerances [m], and the law's error relative to the law itself."""

    crank: int
    rod: int
    crank_width: float
    rod_width: float
    error: float  # uniform relative error with the same standard deviation
    head: float  # shift of the piston at the top dead centre, ± [m]


def grade(function: Transfer, alpha: Array, nominal: Links, crank: int, rod: int) -> Grade:
    """Return what two grades allow; tolerances are symmetric, ± half of their width (S10)."""
    widths = tolerance(nominal.crank, crank), tolerance(nominal.rod, rod)
    found = worst(function, alpha, nominal, 0.5 * widths[0], 0.5 * widths[1])
    return Grade(crank, rod, *widths, found / plane(function, alpha, nominal, 1.0), 0.5 * (widths[0] + widths[1]))


def coarsest(function: Transfer, alpha: Array, nominal: Links, share: float) -> Grade | None:
    """Return the coarsest grade of both links with a relative error of the law up to `share`; None: not even IT5."""
    kept = [found for number in GRADES if (found := grade(function, alpha, nominal, number, number)).error <= share]
    return kept[-1] if kept else None
