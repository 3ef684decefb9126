"""Extrapolate what consecutive points of a series were found to need, over the parameters in which they differ.

Polynomials through the last points are used where their parameters lie on a line. The degree is the one that predicted
the last points best: a higher one follows the trend more closely but amplifies the errors of the points.
"""

from collections.abc import Sequence
from math import prod

import numpy as np

Array = np.ndarray
DEPTH = 3  # most points in a guess
LINE_TOLERANCE = 0.1  # distance from the line of the steps before, as a share of a step, that still counts as on it
LARGEST_WEIGHT = 8.0  # largest weight of a polynomial; beyond it the errors of the points prevail over their trend
LAST_ALONE = np.ones(1)  # weights for the last point alone


class DegreeRecord:
    """What polynomials of each degree predicted for the next point, and how far off each has been lately."""

    def __init__(self) -> None:
        self.told: dict[int, Array] = {}  # by the number of points
        self.missed: dict[int, float] = {}

    def tell(self, ways: Sequence[Array], known: Array) -> list[tuple[Array, Array]]:
        """Return (weights, prediction) of the ways to extrapolate rows of `known`, the most reliable first."""
        self.told = {len(weights): weights @ known[-len(weights) :] for weights in ways}
        best = sorted(ways, key=lambda weights: self.missed.get(len(weights), 0.0))
        return [(weights, self.told[len(weights)]) for weights in best]

    def compare(self, off: Sequence[float]) -> None:
        """Record how far each prediction was off, in the order of `told`."""
        for points, missed in zip(self.told, off, strict=True):
            self.missed[points] = 0.5 * (self.missed.get(points, missed) + missed)


def extrapolation_weights(known: list[Array], wanted: Array) -> list[Array]:
    """Return weights of polynomials that extrapolate to the wanted parameters; the last are those of the last alone."""
    last = LAST_ALONE
    if len(known) < 2:
        return [last]
    every = np.array([*known, wanted])
    moved = np.logical_or.reduce(every[:-1] != wanted)
    along, squares = [0.0] * len(every), [0.0] * len(every)
    for column in every[:, moved].T.tolist():  # a few numbers: faster without numpy
        scale, before, start = max(map(abs, column)), column[-3], column[-2]
        line = (start - before) / scale  # from the last but one to the last
        for i, x in enumerate(column):
            way = (x - start) / scale
            along[i] += way * line
            squares[i] += way * way
    length = squares[-3]
    if length == 0.0:
        return [last]
    places = []
    for product, square in zip(along, squares, strict=True):
        place = product / length
        places.append(place if square - place * place * length <= LINE_TOLERANCE**2 * square else None)
    if places[-1] is None:
        return [last]
    return [*_polynomials(places), last]


def _polynomials(places: list[float | None]) -> list[Array]:
    """Return Lagrange's weights at the last place, of each degree whose weights are at most `LARGEST_WEIGHT`."""
    *known, x = places
    assert x is not None
    tame = []
    for first in range(len(known) - 1):
        nodes = [place for place in known[first:] if place is not None]
        if len(nodes) < len(known) - first or len(set(nodes)) < len(nodes):
            continue
        weights = [prod([(x - b) / (a - b) for b in nodes if b != a]) for a in nodes]
        if max(map(abs, weights)) <= LARGEST_WEIGHT:
            tame.append(np.array(weights))
    return tame
