"""Certainty of a fit by its slopes: standard errors, correlations, and parameters that the data cannot separate."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from screwsim.study.calibration.fit import Parameter
from screwsim.study.calibration.residuals import Array

CORRELATED = 0.95  # from this |r| on two parameters cannot be separated
WEAK_VALUE = 0.02  # of the largest singular value of the scaled slopes: below it a combination is not determined
LEAST_SINGULAR_VALUE = 1e-100  # smallest singular value whose inverse can be squared
# of the bounds' distance: a larger standard error carries no information, even where it is the smallest
UNINFORMATIVE = 1.0
NOTHING = 1e3  # of the bounds' distance: the standard error of a parameter on which no figure depends noticeably
BOUND_DISTANCE = 5e-3  # of the bounds' distance: nearer counts as at the bound
LEAST_COMPONENT = 0.25  # of the largest component: least component that belongs to a combination


@dataclass(frozen=True)
class UndeterminedCombination:
    """Parameters that the data do not determine together: moves over the bounds' distance that keep the figures.

    `strength` is the singular value over the largest; `span` is the standard error along the move, over the bounds'
    distance, without an upper limit. `says` states it in words.
    """

    paths: tuple[str, ...]
    moves: tuple[float, ...]
    strength: float
    span: float
    says: str


@dataclass(frozen=True)
class Certainty:
    """Certainty of the parameters: standard errors [SI] and correlations of those that are not at a bound.

    `border` names the bound, else it is empty. `blank` has the parameters, by index, on which no figure of the points
    depends noticeably; they have no standard error and leave those of the others as they are.
    """

    errors: tuple[float | None, ...]
    correlation: tuple[tuple[float | None, ...], ...]
    border: tuple[str, ...]
    open: tuple[UndeterminedCombination, ...]
    singular: tuple[float, ...]  # singular values of the scaled slopes, over the largest
    blank: frozenset[int] = frozenset()


def active_bounds(places: Array) -> tuple[str, ...]:
    """Return the bound at which each parameter is: lower, upper or ''."""
    return tuple("lower" if u < BOUND_DISTANCE else "upper" if u > 1.0 - BOUND_DISTANCE else "" for u in places)


def certainty(
    parameters: Sequence[Parameter],
    places: Array,
    slopes: Array,
    residuals: Array,
    *,
    apart: Array | None = None,
    together: Sequence[Sequence[int]] = (),
) -> Certainty:
    """Return the certainty of parameters from the residuals and their slopes over the places.

    A parameter at a bound has no error of its own, but those of the others allow for the values that it may have. For
    parameters whose priors are correlated (`together`, by index), `apart` are the slopes as if they were not.
    """
    at = active_bounds(places)
    n, blank = len(parameters), frozenset(np.flatnonzero(np.linalg.norm(slopes, axis=0) * NOTHING < 1.0).tolist())
    free = [index for index, border in enumerate(at) if not border and index not in blank]
    errors: list[float | None] = [None] * n
    matrix: list[list[float | None]] = [[None] * n for _ in range(n)]
    if free:
        held = [index for index in range(n) if index not in free and index not in blank]
        _, s, v = np.linalg.svd(_with_bounds(slopes, residuals, free, held), full_matrices=False)
        scaled = (v.T * _inverse(s))[: len(free)]
        deviation = np.sqrt(np.sum(scaled**2, axis=1))
        correlation = np.clip((scaled @ scaled.T) / np.outer(deviation, deviation), -1.0, 1.0)
        for row, index in enumerate(free):
            value = parameters[index].value(float(places[index]))
            errors[index] = float(deviation[row]) * parameters[index].slope(value)
            for column, other in enumerate(free):
                matrix[index][other] = float(correlation[row, column])
    share, found = undetermined_combinations(parameters, slopes, slopes if apart is None else apart, together)
    return Certainty(tuple(errors), tuple(map(tuple, matrix)), at, found, share, blank)


def _with_bounds(slopes: Array, residuals: Array, free: Sequence[int], held: Sequence[int]) -> Array:
    """Return the slopes of the free parameters, then those held at a bound, each of these with a residual of its own.

    Their mean square distance from the bound is 1/3 where the data say nothing (even between both bounds), and 2/g²
    where half of chi squared rises with the slope g from the bound on (exponential).
    """
    rise = slopes[:, held].T @ residuals
    own = np.hstack([np.zeros((len(held), len(free))), np.diag(np.sqrt(3.0 + 0.5 * rise**2))])
    return np.vstack([slopes[:, [*free, *held]], own]) if held else slopes[:, free]


def _inverse(s: Array) -> Array:
    return 1.0 / np.maximum(s, max(1e-9 * float(s[0]), LEAST_SINGULAR_VALUE))


def undetermined_combinations(
    parameters: Sequence[Parameter], slopes: Array, apart: Array, together: Sequence[Sequence[int]]
) -> tuple[tuple[float, ...], tuple[UndeterminedCombination, ...]]:
    """Return singular values of the slopes over the largest, and what the data cannot separate.

    All parameters count, also those at a bound: one of a pair may have ended there by chance. The largest value is that
    of the slopes `apart`: a correlation of two priors says nothing about how well others are known.
    """
    _, s, v = np.linalg.svd(slopes, full_matrices=False)
    largest = float(s[0]) if apart is slopes else float(np.linalg.svd(apart, compute_uv=False)[0])
    share, inverse = np.minimum(s / max(largest, 1e-300), 1.0), _inverse(s)
    scaled = v.T * inverse
    deviation = np.sqrt(np.sum(scaled**2, axis=1))
    correlation = (scaled @ scaled.T) / np.outer(deviation, deviation)
    found = list(_weak_combinations(parameters, share, inverse, v))
    known = {path for each in found for path in each.paths}
    found += _correlated_pairs(parameters, correlation, deviation, known, together)
    return tuple(map(float, share)), tuple(found)


def _weak_combinations(
    parameters: Sequence[Parameter], share: Array, inverse: Array, v: Array
) -> Iterator[UndeterminedCombination]:
    """Yield the combinations whose singular value is small, and those determined by their bounds more than by data."""
    for strength, span, direction in zip(share, inverse, v, strict=True):
        if strength < WEAK_VALUE or span > UNINFORMATIVE:
            move = direction / direction[int(np.argmax(np.abs(direction)))]
            parts = [index for index, size in enumerate(move) if abs(size) >= LEAST_COMPONENT]
            yield _combination([parameters[index] for index in parts], move[parts], float(strength), float(span))


def _correlated_pairs(
    parameters: Sequence[Parameter],
    correlation: Array,
    deviation: Array,
    known: set[str],
    together: Sequence[Sequence[int]],
) -> Iterator[UndeterminedCombination]:
    """Yield strongly correlated pairs that are in no weak combination already, and whose priors are not correlated."""
    for i, first in enumerate(parameters):
        for j, second in enumerate(parameters[:i]):
            r = float(correlation[i, j])
            if any(i in group and j in group for group in together):
                continue
            if abs(r) > CORRELATED and not {first.path, second.path} <= known:
                moves = np.array([1.0, r * deviation[i] / deviation[j]])
                moves /= np.max(np.abs(moves))
                yield _combination([second, first], moves, float("nan"), float(max(deviation[i], deviation[j])))


def _combination(
    parameters: Sequence[Parameter], moves: Array, strength: float, span: float
) -> UndeterminedCombination:
    paths = tuple(parameter.path for parameter in parameters)
    nothing = len(paths) == 1 and span >= NOTHING
    says = f"no figure of these points depends on {paths[0]}" if nothing else _combination_in_words(parameters, moves)
    return UndeterminedCombination(paths, tuple(map(float, moves)), strength, span, says)


def _combination_in_words(parameters: Sequence[Parameter], moves: Array) -> str:
    """Return in words the meaning of a move that keeps the figures."""
    names = [parameter.path for parameter in parameters]
    if len(parameters) == 1:
        return f"the data hardly constrain {names[0]}"
    middles = [parameter.value(0.5) for parameter in parameters]
    growth = [float(move) * each.slope(at) / at for each, move, at in zip(parameters, moves, middles, strict=True)]
    if len(parameters) == 2 and all(parameter.logarithmic for parameter in parameters):
        ratio = growth[1] / growth[0] if growth[0] else 0.0
        if abs(ratio - 1.0) < 0.05:
            return f"{names[0]} and {names[1]} are indistinguishable: the data fix only their quotient"
        if abs(ratio + 1.0) < 0.05:
            return f"{names[0]} and {names[1]} are indistinguishable: the data fix only their product"
    unit = max(abs(each) for each in growth) or 1.0
    parts = [f"{name} {10.0 * each / unit:+.2g} %" for name, each in zip(names, growth, strict=True)]
    return f"indistinguishable: {', '.join(parts)} together hardly change the figures"
