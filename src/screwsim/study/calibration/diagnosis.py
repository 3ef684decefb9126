"""Which parameters of a machine have changed, and with what probability: one, two or none, by Bayes' rule.

The unchanged machine is the fit's scene, with its parameters at the means of their priors where these are stated. Each
parameter alone, or each pair, may have moved anywhere between its bounds, or none has. Inputs of the unchanged machine
are known as far as priors and the scene's tolerances say, with the same errors at all points. All hypotheses are judged
by exact slopes at the unchanged machine; the likely ones are solved again at their best estimates.
"""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations
from typing import NamedTuple

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures
from screwsim.study.calibration import pair_likelihood
from screwsim.study.calibration.fit import Fit, Parameter
from screwsim.study.calibration.hypotheses import (
    INTERVAL_LEVEL,
    LEAST_CHANCE,
    LIKELY_PROBABILITY,
    Change,
    Hypothesis,
    IndistinguishablePair,
    PriorOdds,
    chance_of_misfit,
    indistinguishable_pairs,
    probabilities,
)
from screwsim.study.calibration.machine import (
    Group,
    fit_of_unchanged,
    inputs_of,
    places_of,
    prepare,
    residual_shifts,
    unchanged_machine,
)
from screwsim.study.calibration.pair_likelihood import PairLikelihood, ResidualCurves, additive_likelihood, curves_of
from screwsim.study.calibration.profile import (
    LinearLikelihood,
    ProfileLikelihood,
    linear_likelihood,
    profile_likelihood,
    whitener,
)
from screwsim.study.calibration.residuals import Array, Objective, Simulate
from screwsim.study.parallel import parallel_map
from screwsim.study.progress import Progress
from screwsim.study.workers import WORKER_DIED

PRIOR_UNCHANGED = 0.5  # prior probability that nothing changed; the others share the rest
PRIOR_PAIR_ODDS = 0.1  # prior odds of two changes at once against one
# of the width of an interval from the bounds alone: above it the points hardly determine the parameter
UNDETERMINED_SHARE = 0.95
LEAST_SINGLES = 3  # single changes that are solved again in any case, besides those likely by slopes
LIKELY_PAIR = 1e-2  # probability from which on two changes at once are solved, ...
MOST_PAIRS = 6  # ... at most so many pairs, ...
FIRST_PAIRS = 2  # ... and in any case so many where nothing else fits
UNLIKELY, UNSOLVED = "improbable", "no other value has a solution at every point"  # why slopes alone


@dataclass(frozen=True)
class Diagnosis:
    """The answer: hypotheses, the most probable first; `unchanged` are the parameters [SI] of the unchanged machine.

    `chance` is the probability of a misfit at least as large as the best one's. `odds` are the prior odds of two
    changes at once against one. `reasons` are those of points without a solution. `status` ok | failed.
    """

    fit: Fit
    status: str
    message: str
    unchanged: Mapping[str, float]
    hypotheses: tuple[Hypothesis, ...] = ()
    alike: tuple[IndistinguishablePair, ...] = ()
    chance: float | None = None
    inputs: tuple[str, ...] = ()  # inputs of the unchanged machine that are not known exactly
    reasons: Mapping[str, str] = field(default_factory=dict)
    solutions: int = 0
    failed: int = 0
    odds: float = 0.0

    @property
    def changed(self) -> dict[str, float]:
        """Probability that each parameter has changed, alone or with another; the most probable first."""
        sums = dict.fromkeys(self.unchanged, 0.0)
        for one in self.hypotheses:
            for path in one.paths:
                sums[path] += one.probability
        return dict(sorted(sums.items(), key=lambda item: -item[1]))

    @property
    def untold(self) -> tuple[str, ...]:
        """Parameters that the points hardly determine: any value between the bounds fits as well."""
        single = {one.path: one.changes[0] for one in self.hypotheses if len(one.changes) == 1 and not one.linear}

        def width(parameter: Parameter) -> float:
            was, now = self.unchanged[parameter.path], single[parameter.path]
            return parameter.place(was + now.high) - parameter.place(was + now.low)

        return tuple(
            each.path
            for each in self.fit.parameters
            if each.path in single and width(each) > UNDETERMINED_SHARE * INTERVAL_LEVEL
        )


class UnchangedPoint(NamedTuple):
    """One point of the unchanged machine: residuals (n,), slopes (n, parameters), effect of its inputs (n, inputs)."""

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
    unchanged: float = PRIOR_UNCHANGED,
    pairs: float = PRIOR_PAIR_ODDS,
    jobs: int | None = None,
    simulate: Simulate | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Return which parameters of a fit's machine have changed by its points; `unchanged` is the prior of no change.

    `pairs` are the prior odds of two changes at once against one; 0: single changes only. Raises UsageError where the
    unchanged machine lies outside a parameter's bounds.
    """
    _check(unchanged, pairs)
    machine, before = unchanged_machine(fit)
    asked = fit_of_unchanged(fit, machine, simulate)
    names, priors = inputs_of(fit, machine)
    prepare(asked, simulate)
    call = partial(unchanged_point, asked, names, priors, before, simulate)
    dead = UnchangedPoint(np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0)), Figures(), WORKER_DIED, 0, 0)
    points = [point for point in asked.points if point.fitted]
    found = parallel_map(
        call, len(points), died=lambda number: dead, jobs=jobs, failed=lambda one: bool(one.why), progress=progress
    )
    reasons = {point.name: one.why for point, one in zip(points, found, strict=True) if one.why}
    solutions, failed = sum(one.solutions for one in found), sum(one.failed for one in found)
    good = [i for i, one in enumerate(found) if not one.why]
    if not good:
        why = f"none of the points has a solution: {next(iter(reasons.values()))}"
        return Diagnosis(fit, "failed", why, before, reasons=reasons, solutions=solutions, failed=failed)
    asked = replace(asked, points=tuple(points[i] for i in good))
    residuals = np.concatenate([found[i].residuals for i in good])
    slopes = np.vstack([found[i].slopes for i in good])
    white = whitener(np.vstack([found[i].inputs for i in good]))
    start = places_of(asked, before)
    here_, columns = white @ residuals, (white @ slopes).T
    by_slopes = [linear_likelihood(u, here_, column) for u, column in zip(start, columns, strict=True)]
    none = float(here_ @ here_)
    likely = _likely_changes(none, by_slopes, unchanged)
    odds, count = pairs if len(by_slopes) > 1 else 0.0, len(residuals)
    solved: dict[int, ProfileLikelihood | None] = {}
    while True:
        call = partial(solved_likelihood, asked, white, simulate, likely, start, columns)
        solved |= dict(zip(likely, parallel_map(call, len(likely), died=lambda number: None, jobs=jobs), strict=True))
        singles = [solved.get(i) or one for i, one in enumerate(by_slopes)]
        prior = PriorOdds(unchanged, odds, none, tuple(one.log_evidence for one in singles))
        curves, misfits = curves_of(here_, start, columns, singles), [none, *(one.misfit for one in singles)]
        doubles = _pair_likelihoods(asked, white, simulate, curves, prior, misfits, jobs)
        rows, left = _hypotheses(asked, before, singles, doubles, set(solved), prior, count)
        first = max(rows, key=lambda one: one.probability)
        likely = [i for i in range(len(by_slopes)) if i not in solved]
        if not likely or chance_of_misfit(first.misfit, first.freedom) >= LEAST_CHANCE:
            break  # else a hypothesis that fits may have been dismissed by its slopes
        solutions += sum(one.solutions for one in doubles.values())
        failed += sum(one.failed for one in doubles.values())
    every = [*(one for one in solved.values() if one), *doubles.values()]
    solutions += sum(one.solutions for one in every)
    failed += sum(one.failed for one in every)
    for i, one in enumerate(singles):
        by_slope = here_ + columns[i] * (one.estimate - start[i])
        left[(i,)] = one.residuals if isinstance(one, ProfileLikelihood) else by_slope
    ranked = tuple(sorted(rows, key=lambda each: -each.probability))
    by_path = {tuple(asked.parameters[i].path for i in which): each for which, each in left.items()}
    message = f"{len(reasons)} of {len(points)} points have no solution" if reasons else ""
    status, inputs = "failed" if reasons else "ok", tuple(" + ".join(group) for group in (*names, *priors))
    alike, chance = indistinguishable_pairs(ranked, by_path), chance_of_misfit(ranked[0].misfit, ranked[0].freedom)
    head = fit, status, message, before, ranked
    return Diagnosis(*head, alike, chance, inputs, reasons, solutions, failed, odds)


def _check(unchanged: float, pairs: float) -> None:
    if not 0.0 < unchanged < 1.0:
        raise UsageError(f"--unchanged {unchanged:g}: is not a probability between 0 and 1 (write e.g. 0.5)")
    if not (pairs >= 0.0 and np.isfinite(pairs)):
        what = "is not the odds of two changes against one (write e.g. 0.1, or 0 for single changes only)"
        raise UsageError(f"--pairs {pairs:g}: {what}")


def unchanged_point(
    fit: Fit,
    groups: Sequence[Group],
    priors: Mapping[Group, float],
    values: Mapping[str, float],
    simulate: Simulate | None,
    number: int,
) -> UnchangedPoint:
    """Return one point of the unchanged machine, with its slopes."""
    point = [point for point in fit.points if point.fitted][number]
    asked = Objective(replace(fit, points=(point,)), simulate)
    places = places_of(fit, values)
    outcome = asked.outcome(places)
    count = len(point.measured)
    empty = np.zeros((count, len(groups) + len(priors)))
    why = outcome.reasons.get(point.name, "")
    if why:
        nothing = np.zeros(count), np.zeros((count, len(places))), empty, Figures()
        return UnchangedPoint(*nothing, why, asked.solutions, asked.failed)
    slopes = asked.slopes(places)
    own = residual_shifts(fit.at(point, values), point, groups)
    paths = [parameter.path for parameter in fit.parameters]
    for (path,), deviation in priors.items():
        i = paths.index(path)
        own.append(slopes[:, i] * deviation / fit.parameters[i].slope(values[path]))
    inputs = np.column_stack(own) if own else empty
    return UnchangedPoint(outcome.residuals, slopes, inputs, outcome.figures[0], "", asked.solutions, asked.failed)


def _likely_changes(none: float, by_slopes: Sequence[LinearLikelihood], unchanged: float) -> list[int]:
    """Return the indices of the hypotheses worth solving again."""
    chances = probabilities(none, [one.log_evidence for one in by_slopes], unchanged)[1:]
    ranked = sorted(range(len(by_slopes)), key=lambda i: -chances[i])
    return [i for rank, i in enumerate(ranked) if rank < LEAST_SINGLES or chances[i] > LIKELY_PROBABILITY]


def solved_likelihood(
    fit: Fit, white: Array, simulate: Simulate | None, likely: Sequence[int], start: Array, columns: Array, number: int
) -> ProfileLikelihood | None:
    """Return the likelihood over one of the likely parameters; None where only slopes give one."""
    index = likely[number]
    asked = Objective(replace(fit, parameters=(fit.parameters[index],)), simulate)
    return profile_likelihood(asked, white, float(start[index]), columns[index])


def _pair_likelihoods(
    fit: Fit,
    white: Array,
    simulate: Simulate | None,
    curves: ResidualCurves,
    prior: PriorOdds,
    misfits: Sequence[float],
    jobs: int | None,
) -> dict[tuple[int, ...], PairLikelihood]:
    """Return the likelihoods of all pairs, the likely ones solved; none where the odds of pairs are zero."""
    if not prior.odds > 0.0:
        return {}
    found = {
        pair: additive_likelihood(curves, pair, INTERVAL_LEVEL) for pair in combinations(range(len(curves.start)), 2)
    }
    tried: set[tuple[int, int]] = set()
    while len(tried) < MOST_PAIRS:
        order = list(found)
        chances = prior.probabilities([found[pair].log_evidence for pair in order])[1 + len(prior.singles) :]
        least = min([*misfits, *(one.misfit for one in found.values() if one.solved)])
        first = FIRST_PAIRS if chance_of_misfit(least, len(white) - 1) < LEAST_CHANCE else 0
        ranked = sorted(range(len(order)), key=lambda i: -chances[i])
        wanted = [order[i] for rank, i in enumerate(ranked) if rank < first or chances[i] > LIKELY_PAIR]
        guesses = [(pair, found[pair]) for pair in wanted if pair not in tried][: MOST_PAIRS - len(tried)]
        if not guesses:
            break
        call = partial(pair_likelihood.solved_pair, fit, white, simulate, guesses, INTERVAL_LEVEL)
        answers = parallel_map(call, len(guesses), died=lambda number: None, jobs=jobs)
        found |= {pair: one for (pair, _), one in zip(guesses, answers, strict=True) if one}
        tried |= {pair for pair, _ in guesses}
    return {**found}


def _hypotheses(
    fit: Fit,
    before: Mapping[str, float],
    singles: Sequence[LinearLikelihood | ProfileLikelihood],
    doubles: Mapping[tuple[int, ...], PairLikelihood],
    likely: Set[int],
    prior: PriorOdds,
    count: int,
) -> tuple[list[Hypothesis], dict[tuple[int, ...], Array]]:
    """Return all hypotheses, and the residuals at the best values of pairs."""
    chances = prior.probabilities([one.log_evidence for one in doubles.values()])
    rows = [Hypothesis((), float(chances[0]), -0.5 * prior.none, prior.none, count)]
    for i, (one, chance) in enumerate(zip(singles, chances[1:], strict=False)):
        parameter = fit.parameters[i]
        also = tuple(map(parameter.value, one.others())) if isinstance(one, ProfileLikelihood) else ()
        why = "" if isinstance(one, ProfileLikelihood) else UNSOLVED if i in likely else UNLIKELY
        changes = (_change(parameter, before, one.estimate, one.interval(INTERVAL_LEVEL)),)
        rows.append(Hypothesis(changes, float(chance), one.log_evidence, float(one.misfit), count - 1, why, also))
    for (pair, one), chance in zip(doubles.items(), chances[1 + len(singles) :], strict=True):
        ends = zip(pair, one.places, one.intervals, strict=True)
        changes = tuple(_change(fit.parameters[i], before, place, interval) for i, place, interval in ends)
        why = "" if one.solved else UNLIKELY
        rows.append(Hypothesis(changes, float(chance), one.log_evidence, float(one.misfit), count - 2, why))
    return rows, {pair: one.residuals for pair, one in doubles.items()}


def _change(parameter: Parameter, before: Mapping[str, float], place: float, ends: tuple[float, float]) -> Change:
    was, value = before[parameter.path], parameter.value(place)
    low, high = (parameter.value(end) - was for end in ends)
    return Change(parameter.path, value, value - was, low, high)
