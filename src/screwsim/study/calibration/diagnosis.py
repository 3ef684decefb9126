"""Which parameter of a machine has changed, and with what probability: single changes against none, by Bayes' rule.

The machine is a fit's scene, its parameters at the means of their priors where these are stated. Each parameter alone
may have come to lie anywhere between its bounds, or none has. Inputs of the unchanged machine are known as far as
priors and the scene's tolerances say, and off by the same at all points. All hypotheses are judged by exact slopes at
the unchanged machine; the likely ones are solved again at their best estimates.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations
from typing import NamedTuple

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures
from screwsim.study.calibration.fit import Fit, Parameter
from screwsim.study.calibration.machine import (
    Group,
    by_tolerance,
    inputs_of,
    places_of,
    posed,
    prepare,
    unchanged_machine,
)
from screwsim.study.calibration.profile import Profile, profile, straight
from screwsim.study.calibration.residuals import PENALTY, Array, Objective, Simulate
from screwsim.study.calibration.single import Along, along, whitener
from screwsim.study.each import each
from screwsim.study.progress import Progress
from screwsim.study.workers import DIED

NONE = ""  # the path of the hypothesis that nothing changed
LEVEL = 0.9  # of the intervals
UNCHANGED = 0.5  # probability beforehand that nothing changed; the others share the rest
LIKELY = 1e-3  # probability by slopes from which on a hypothesis is solved again, and in any case ...
FIRST = 3  # ... so many of them
UNLIKELY, UNSOLVED = "hardly probable", "no other value has a solution at all points"  # why by slopes alone
APART = 2.0  # uncertainties: nearer than that two changes make the same of the points
CHANCE = 0.01  # probability of a misfit below which no hypothesis fits


@dataclass(frozen=True)
class Hypothesis:
    """A change of one parameter, or none (path ''): its probability, and what is left over, chi² of all points.

    `value` is what the parameter would be now, `change` from the unchanged one, between `low` and `high` with the
    probability `LEVEL` [SI]; `also` are values that fit nearly as well, further off. `linear` says why it was not
    solved again, '' where it was.
    """

    path: str
    probability: float
    log_evidence: float
    misfit: float
    freedom: int
    value: float | None = None
    change: float | None = None
    low: float | None = None
    high: float | None = None
    linear: str = ""
    also: tuple[float, ...] = ()


class Alike(NamedTuple):
    """Two changes that the points do not tell apart: `off` is by how many uncertainties they differ at all points."""

    first: str
    second: str
    off: float


@dataclass(frozen=True)
class Diagnosis:
    """The answer: hypotheses, the most probable first; `unchanged` are the parameters [SI] of the machine as it was.

    `chance` is the probability of a misfit at least as large as the best one's. `reasons` are those of points without a
    solution. `status` ok | failed.
    """

    fit: Fit
    status: str
    message: str
    unchanged: Mapping[str, float]
    hypotheses: tuple[Hypothesis, ...] = ()
    alike: tuple[Alike, ...] = ()
    chance: float | None = None
    inputs: tuple[str, ...] = ()  # of the unchanged machine, that are not known exactly
    reasons: Mapping[str, str] = field(default_factory=dict)
    solutions: int = 0
    failed: int = 0


class Here(NamedTuple):
    """One point of the unchanged machine: residuals (n,), slopes (n, parameters), what its inputs make (n, inputs)."""

    residuals: Array
    slopes: Array
    inputs: Array
    figures: Figures
    why: str
    solutions: int
    failed: int


def diagnose(
    fit: Fit,
    *,
    unchanged: float = UNCHANGED,
    jobs: int | None = None,
    simulate: Simulate | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Return which parameter of a fit's machine its points say has changed; `unchanged` is how probable none is.

    Raises UsageError where the unchanged machine lies outside a parameter's bounds.
    """
    if not 0.0 < unchanged < 1.0:
        raise UsageError(f"--unchanged {unchanged:g}: is no probability between 0 and 1 (write e.g. 0.5)")
    machine, before = unchanged_machine(fit)
    asked = posed(fit, machine, simulate)
    names, priors = inputs_of(fit, machine)
    prepare(asked, simulate)
    call = partial(here, asked, names, priors, before, simulate)
    points = [point for point in asked.points if point.fitted]
    found = each(call, len(points), died=_lost, jobs=jobs, failed=lambda one: bool(one.why), progress=progress)
    reasons = {point.name: one.why for point, one in zip(points, found, strict=True) if one.why}
    solutions, failed = sum(one.solutions for one in found), sum(one.failed for one in found)
    good = [i for i, one in enumerate(found) if not one.why]
    if not good:
        why = f"no point has a solution: {next(iter(reasons.values()))}"
        return Diagnosis(fit, "failed", why, before, reasons=reasons, solutions=solutions, failed=failed)
    asked = replace(asked, points=tuple(points[i] for i in good))
    residuals = np.concatenate([found[i].residuals for i in good])
    slopes = np.vstack([found[i].slopes for i in good])
    white = whitener(np.vstack([found[i].inputs for i in good]))
    start = places_of(asked, before)
    here_, columns = white @ residuals, (white @ slopes).T
    by_slopes = [along(u, here_, column) for u, column in zip(start, columns, strict=True)]
    none = float(here_ @ here_)
    likely = _likely(none, by_slopes, unchanged)
    call = partial(refined, asked, white, simulate, likely, start, columns)
    solved = dict(zip(likely, each(call, len(likely), died=lambda number: None, jobs=jobs), strict=True))
    solutions += sum(one.solutions for one in solved.values() if one)
    failed += sum(one.failed for one in solved.values() if one)
    best = {i: solved.get(i) or one for i, one in enumerate(by_slopes)}
    left = [
        one.residuals if isinstance(one, Profile) else straight(one, start[i], here_, columns[i])
        for i, one in best.items()
    ]
    ranked = _ranked(asked, before, none, best, set(likely), unchanged, len(residuals))
    alike = _alike(ranked, asked.parameters, left)
    message = f"{len(reasons)} of {len(points)} points have no solution" if reasons else ""
    rest = (_chance(ranked), tuple(" + ".join(group) for group in (*names, *priors)), reasons, solutions, failed)
    return Diagnosis(fit, "failed" if reasons else "ok", message, before, ranked, alike, *rest)


def here(
    fit: Fit,
    groups: Sequence[Group],
    priors: Mapping[Group, float],
    values: Mapping[str, float],
    simulate: Simulate | None,
    number: int,
) -> Here:
    """Return one point of the unchanged machine, and how it moves."""
    point = [point for point in fit.points if point.fitted][number]
    asked = Objective(replace(fit, points=(point,)), simulate)
    places = places_of(fit, values)
    outcome = asked.outcome(places)
    count = len(point.measured)
    empty = np.zeros((count, len(groups) + len(priors)))
    why = outcome.reasons.get(point.name, "")
    if why or np.any(np.abs(outcome.residuals) >= PENALTY):
        why = why or "a figure has no value"
        nothing = np.zeros(count), np.zeros((count, len(places))), empty, Figures()
        return Here(*nothing, why, asked.solutions, asked.failed)
    slopes = asked.slopes(places)
    own = [by_tolerance(fit.at(point, values), point, group) for group in groups]
    paths = [parameter.path for parameter in fit.parameters]
    for (path,), deviation in priors.items():
        i = paths.index(path)
        own.append(slopes[:, i] * deviation / fit.parameters[i].slope(values[path]))
    inputs = np.column_stack(own) if own else empty
    return Here(outcome.residuals, slopes, inputs, outcome.figures[0], "", asked.solutions, asked.failed)


def _lost(number: int) -> Here:
    return Here(np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0)), Figures(), DIED, 0, 0)


def _likely(none: float, by_slopes: Sequence[Along], unchanged: float) -> list[int]:
    """Return which hypotheses are worth solving again."""
    chances = probabilities(none, [one.log_evidence for one in by_slopes], unchanged)[1:]
    ranked = sorted(range(len(by_slopes)), key=lambda i: -chances[i])
    return [i for rank, i in enumerate(ranked) if rank < FIRST or chances[i] > LIKELY]


def probabilities(none: float, evidences: Sequence[float], unchanged: float) -> Array:
    """Return the probabilities of no change (chi² `none`) and of each change, by logarithms of their evidences."""
    logs = np.log([unchanged, *[(1.0 - unchanged) / max(len(evidences), 1)] * len(evidences)])
    logs += np.array([-0.5 * none, *evidences])
    weights = np.exp(logs - np.max(logs))
    return weights / weights.sum()


def refined(
    fit: Fit, white: Array, simulate: Simulate | None, likely: Sequence[int], start: Array, columns: Array, number: int
) -> Profile | None:
    """Return the likelihood over one of the likely parameters; None where there is none but by slopes."""
    index = likely[number]
    asked = Objective(replace(fit, parameters=(fit.parameters[index],)), simulate)
    return profile(asked, white, float(start[index]), columns[index])


def _ranked(
    fit: Fit,
    before: Mapping[str, float],
    none: float,
    best: Mapping[int, Along | Profile],
    likely: Set[int],
    unchanged: float,
    count: int,
) -> tuple[Hypothesis, ...]:
    """Return all hypotheses, the most probable first."""
    order = sorted(best)
    chances = probabilities(none, [best[i].log_evidence for i in order], unchanged)
    found = [Hypothesis(NONE, float(chances[0]), -0.5 * none, none, count)]
    for i, chance in zip(order, chances[1:], strict=True):
        parameter, one = fit.parameters[i], best[i]
        was, value = before[parameter.path], parameter.value(one.estimate)
        low, high = (parameter.value(place) - was for place in one.interval(LEVEL))
        also = tuple(map(parameter.value, one.others())) if isinstance(one, Profile) else ()
        why = "" if isinstance(one, Profile) else UNSOLVED if i in likely else UNLIKELY
        rest = (value, value - was, low, high, why, also)
        found.append(Hypothesis(parameter.path, float(chance), one.log_evidence, one.misfit, count - 1, *rest))
    return tuple(sorted(found, key=lambda each: -each.probability))


def _alike(ranked: Sequence[Hypothesis], parameters: Sequence[Parameter], left: Sequence[Array]) -> tuple[Alike, ...]:
    """Return pairs of likely changes that the points do not tell apart; none where nothing changed most probably.

    `left` are the residuals at the best value of each parameter.
    """
    by_path = {parameter.path: each for parameter, each in zip(parameters, left, strict=True)}
    likely = [each for each in ranked if each.path and each.probability > LIKELY]
    if ranked[0].path == NONE:
        return ()
    pairs = ((one, other, by_path[one.path] - by_path[other.path]) for one, other in combinations(likely, 2))
    found = (Alike(one.path, other.path, float(np.linalg.norm(apart))) for one, other, apart in pairs)
    return tuple(each for each in found if each.off < APART)


def _chance(ranked: Sequence[Hypothesis]) -> float:
    from scipy.stats import chi2

    best = ranked[0]
    return float(chi2.sf(best.misfit, max(best.freedom, 1)))
