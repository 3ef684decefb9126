"""Maximum of a function of one variable: a coarse bracket, scipy's bounded search, and how certain its place is.

The function carries its own numerical error. Where a maximum is flat, that error and not the search limits how well its
place is known: `Maximum` gives the interval in which the function is within its error of the maximum.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import NamedTuple

COARSE_POINTS = 13  # points of the coarse search
RESOLUTION = 1e-4  # fraction of the range at which the bounded search stops
CLEAR_ERRORS = 4.0  # errors below the top from which on a point shows the curvature there


class SearchPoint(NamedTuple):
    """A value of the function with its absolute error; NaN where it has none."""

    x: float
    y: float
    error: float = 0.0


@dataclass(frozen=True)
class Maximum:
    """The highest point; from `low` to `high` the function is within its error of it; `others`: further local maxima.

    `bracket` holds its neighbours in the coarse search.
    """

    point: SearchPoint
    low: float
    high: float
    bracket: tuple[float, float]
    others: tuple[SearchPoint, ...] = ()


Function = Callable[[float], SearchPoint]


def find_maximum(function: Function, first: float, last: float, count: int = COARSE_POINTS) -> Maximum | None:
    """Return the highest point between two ends; None when fewer than three points of the coarse search have values."""
    step = (last - first) / (count - 1)
    tried = [function(first + step * number if number < count - 1 else last) for number in range(count)]
    good = [point for point in tried if math.isfinite(point.y)]
    if len(good) < 3:
        return None
    tops = []
    for bracket, peak in _brackets(tried):
        seen = _refined(function, bracket, good, RESOLUTION * (last - first))
        tops.append((max([peak, *seen], key=lambda point: point.y), bracket, seen))
    tops.sort(key=lambda top: -top[0].y)
    best, bracket, _ = tops[0]
    known = [*good, *(point for _, _, seen in tops for point in seen)]
    low, high = (_equally_high_to(best, known, sign) for sign in (-1.0, 1.0))
    return Maximum(best, low, high, bracket, tuple(top[0] for top in tops[1:]))


def _brackets(tried: Sequence[SearchPoint]) -> Iterator[tuple[tuple[float, float], SearchPoint]]:
    """Yield each local maximum with its neighbours; one may lie at the edge of the points that have values."""
    last = len(tried) - 1
    for have_values, run in groupby(range(last + 1), key=lambda number: math.isfinite(tried[number].y)):
        numbers = list(run)
        for peak in _peaks([tried[number] for number in numbers]) if have_values else ():
            number = numbers[peak]
            yield (tried[max(number - 1, 0)].x, tried[min(number + 1, last)].x), tried[number]


def _peaks(points: Sequence[SearchPoint]) -> list[int]:
    """Return the indices of local maxima, ends included, that are separated by valleys deeper than the errors."""
    last = len(points) - 1
    local = [
        number
        for number, point in enumerate(points)
        if (number == 0 or point.y >= points[number - 1].y) and (number == last or point.y > points[number + 1].y)
    ]
    kept: list[int] = []
    for number in sorted(local, key=lambda number: -points[number].y):
        if all(_valley(points, number, other) for other in kept):
            kept.append(number)
    return kept


def _valley(points: Sequence[SearchPoint], number: int, higher: int) -> bool:
    """Return whether a valley deeper than the errors lies between two maxima."""
    between = points[min(number, higher) + 1 : max(number, higher)]
    return any(points[number].y - point.y > 2.0 * (points[number].error + point.error) for point in between)


def _refined(
    function: Function, bracket: tuple[float, float], known: Sequence[SearchPoint], resolution: float
) -> list[SearchPoint]:
    """Return the points seen by a bounded search within the bracket; it takes missing values as low."""
    from scipy.optimize import minimize_scalar

    floor = min(point.y for point in known)
    seen: list[SearchPoint] = []

    def lowered(x: float) -> float:
        point = function(float(x))
        if not math.isfinite(point.y):
            return -floor
        seen.append(point)
        return -point.y

    minimize_scalar(lowered, bounds=bracket, method="bounded", options={"xatol": resolution})
    return seen


def _equally_high_to(top: SearchPoint, known: Sequence[SearchPoint], sign: float) -> float:
    """Return how far to one side (±1) the function is within its error of the top, from the nearest clear point.

    Near its top the function falls with the square of the distance. Without a clear point the interval extends to the
    last known point on that side.
    """
    side = sorted((point for point in known if sign * (point.x - top.x) > 0.0), key=lambda point: abs(point.x - top.x))
    error = max(top.error, 0.0)
    for point in side:
        drop = top.y - point.y
        if drop > CLEAR_ERRORS * error and drop > 0.0:
            return top.x + (point.x - top.x) * math.sqrt(error / drop)
    return side[-1].x if side else top.x
