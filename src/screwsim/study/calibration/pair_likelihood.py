"""Two parameters changed at once, against measured points: their best change, and the evidence of both.

The best places are found by least squares. Around them the likelihood is taken as normal (Laplace's approximation, with
the slopes there); the evidence is its integral over the places, uniform between the bounds of both: in closed form over
one place, by the trapezoidal rule over the other.

All pairs are judged without solving: the change of the residuals by two parameters is taken as the sum of the changes
by each alone, from its slopes or, where it was solved again, from its solutions. The likely pairs are then solved.

Source: D. J. C. MacKay, Information Theory, Inference, and Learning Algorithms, Cambridge 2003, chapters 27 and 28.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from screwsim.study.calibration.descent import least_squares
from screwsim.study.calibration.fit import DIFFERENCES, Fit
from screwsim.study.calibration.profile import TAILS, LinearLikelihood, ProfileLikelihood, log_mass, refined_grid
from screwsim.study.calibration.residuals import Array, Objective, Simulate

STEPS, CHEAP = 8, 40  # least-squares steps with solutions, and without
NEGLIGIBLE_DEPTH = 40.0  # of the logarithm below the largest, where the likelihood is negligible
SLOPE_DISTANCE = 1e-4  # distance of places for the slope of a curve through solutions

ResidualCurve = Callable[[float], Array]


@dataclass(frozen=True)
class PairLikelihood:
    """Likelihood over two places: the best, its chi², the evidence, intervals, residuals and slopes there."""

    places: tuple[float, float]
    misfit: float
    log_evidence: float
    intervals: tuple[tuple[float, float], tuple[float, float]]
    residuals: Array
    slopes: Array
    solved: bool = False
    solutions: int = 0
    failed: int = 0


PairGuesses = Sequence[tuple[tuple[int, int], PairLikelihood]]  # pairs of parameters, and guesses of their best places


class ResidualCurves(NamedTuple):
    """Changes of the whitened residuals by each parameter alone, from `here` of the unchanged machine at `start`.

    `of` are functions of the place that return the change of the residuals; `best` the best places of each alone.
    """

    here: Array
    start: Array
    of: tuple[ResidualCurve, ...]
    best: Array


def curves_of(
    here: Array, start: Array, columns: Array, singles: Sequence[LinearLikelihood | ProfileLikelihood]
) -> ResidualCurves:
    """Return the curves from solutions where there are any, else from slopes (parameters, n)."""

    def curve(one: LinearLikelihood | ProfileLikelihood, begin: float, column: Array) -> ResidualCurve:
        if isinstance(one, ProfileLikelihood):
            between = one.curve()
            return lambda place: between(place) - here
        return lambda place: column * (place - begin)

    of = tuple(curve(one, float(begin), column) for one, begin, column in zip(singles, start, columns, strict=True))
    return ResidualCurves(here, start, of, np.array([single.estimate for single in singles]))


def additive_likelihood(curves: ResidualCurves, pair: tuple[int, int]) -> PairLikelihood:
    """Return the likelihood over two parameters without solving: their separate changes are added."""
    i, j = pair
    alone = curves.start[i], curves.start[j]
    begins = [alone, (curves.best[i], alone[1]), (alone[0], curves.best[j])]

    def residuals(places: Array) -> Array:
        return curves.here + curves.of[i](float(places[0])) + curves.of[j](float(places[1]))

    def slopes(places: Array) -> Array:
        return np.column_stack([_slope(curves.of[k], float(u)) for k, u in zip(pair, places, strict=True)])

    ends = [least_squares(residuals, slopes, np.array(begin), CHEAP, confirmed=True)[0] for begin in begins]
    end = min(ends, key=lambda places: float(np.sum(residuals(places) ** 2)))
    return normal_about(end, residuals(end), slopes(end))


def _slope(curve: ResidualCurve, place: float) -> Array:
    low, high = max(0.0, place - SLOPE_DISTANCE), min(1.0, place + SLOPE_DISTANCE)
    return (curve(high) - curve(low)) / (high - low)


def solved_pair(
    fit: Fit, white: Array, simulate: Simulate | None, guesses: PairGuesses, number: int
) -> PairLikelihood | None:
    """Return the likelihood over one of the pairs around its best places, found by solutions from the guess.

    The first slopes are those of the guess; later ones, and those at the end, are differences. None where the best
    places have no solution at all points.
    """
    pair, guess = guesses[number]
    alone = replace(fit, parameters=tuple(fit.parameters[k] for k in pair), slopes=DIFFERENCES)
    asked, known, begin = Objective(alone, simulate), {}, np.array(guess.places)
    unsolved: set[bytes] = set()
    first = [guess.slopes]

    def residuals(places: Array) -> Array:
        key = places.tobytes()
        if key not in known:
            there = asked.outcome(places)
            known[key] = white @ there.residuals
            if there.reasons:
                known[key] = np.full(len(white), float(np.linalg.norm(there.residuals)))
                unsolved.add(key)
        return known[key]

    def slopes(places: Array) -> Array:
        return first.pop() if first else white @ asked.slopes(places, 1)

    end, _ = least_squares(residuals, slopes, begin, STEPS, confirmed=False)
    left = residuals(end)
    if end.tobytes() in unsolved:
        return None
    found = normal_about(end, left, white @ asked.slopes(end))
    return replace(found, solved=True, solutions=asked.solutions, failed=asked.failed)


def normal_about(places: Array, residuals: Array, slopes: Array) -> PairLikelihood:
    """Return the likelihood over two places, linear around these, from whitened residuals (n,) and slopes (n, 2)."""
    intervals, evidence = [], -np.inf
    for own, other in ((0, 1), (1, 0)):
        grid, density = _marginal(places, residuals, slopes, own, other)
        weights = np.exp(density - np.max(density))
        mass = np.concatenate([[0.0], np.cumsum(0.5 * (weights[1:] + weights[:-1]) * np.diff(grid))])
        low, high = (float(np.interp(share * mass[-1], mass, grid)) for share in TAILS)
        intervals.append((low, high))
        evidence = float(np.max(density) + np.log(mass[-1]))
    best = float(places[0]), float(places[1])
    return PairLikelihood(best, float(residuals @ residuals), evidence, (intervals[0], intervals[1]), residuals, slopes)


def _marginal(places: Array, residuals: Array, slopes: Array, own: int, other: int) -> tuple[Array, Array]:
    """Return a grid of one place, and the logarithms of the likelihood integrated over the other."""
    along, beside = slopes[:, own], slopes[:, other]
    information = float(beside @ beside)

    def density(grid: Array) -> Array:
        off = grid - places[own]
        chi_squared = residuals @ residuals + 2.0 * (residuals @ along) * off + (along @ along) * off**2
        if information <= 1e-12:
            return -0.5 * chi_squared
        step = -(beside @ residuals + (beside @ along) * off) / information
        centre, sharp = places[other] + step, information**0.5
        inside = log_mass(-centre * sharp, (1.0 - centre) * sharp)
        return -0.5 * (chi_squared - information * step**2) + 0.5 * np.log(2.0 * np.pi / information) + inside

    grid = refined_grid(density, NEGLIGIBLE_DEPTH)
    return grid, density(grid)
