"""Which parameters of a machine have changed, and with what probability: one, two or none, by Bayes' rule.

The unchanged machine is the fit's scene, with its parameters at the means of their priors where these are stated. Each
parameter alone, or each pair, may have moved anywhere between its bounds, or none has. Inputs of the unchanged machine
are known as far as priors and the scene's tolerances say, with the same errors at all points. All hypotheses are judged
by exact slopes at the unchanged machine; the likely ones are solved again at their best estimates.
"""

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs.display import About, Brief
from screwsim.study.asked.inputs import shown_value
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
)
from screwsim.study.calibration.machine import (
    NO_SHIFTS,
    Group,
    PointShifts,
    inputs_of,
    known_everywhere,
    point_shifts,
    unchanged_fit,
)
from screwsim.study.calibration.misread_units import HOPELESS, misread_by_residuals
from screwsim.study.calibration.pair_likelihood import PairLikelihood, additive_likelihood, curves_of, solved_pair
from screwsim.study.calibration.profile import (
    LinearLikelihood,
    ProfileLikelihood,
    linear_likelihood,
    profile_likelihood,
    whitener,
)
from screwsim.study.calibration.residuals import Array, Objective, Simulate
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import WORKER_DIED

Mapped = Callable[..., list[Any]]  # `parallel_map` with its workers and its progress

PRIOR_UNCHANGED = 0.5  # prior probability that nothing changed; the others share the rest
PRIOR_PAIR_ODDS = 0.1  # prior odds of two changes at once against one
# of the width of an interval from the bounds alone: above it the points hardly determine the parameter
UNDETERMINED_SHARE = 0.95
LEAST_SINGLES = 3  # single changes that are solved again in any case, besides those likely by slopes
LIKELY_PAIR = 1e-2  # probability from which on two changes at once are solved, ...
MOST_PAIRS = 6  # ... at most so many pairs, ...
FIRST_PAIRS = 2  # ... and in any case so many where nothing else fits
UNLIKELY, UNSOLVED = "improbable", "no other value has a solution at every point"  # why slopes alone


@dataclass(frozen=True, repr=False)
class Diagnosis(Brief):
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
    left_out: Mapping[str, str] = field(default_factory=dict)  # those without a derivative at a point, and why
    reasons: Mapping[str, str] = field(default_factory=dict)
    solutions: int = 0
    failed: int = 0
    odds: float = 0.0
    misread: tuple[str, ...] = ()  # lines on columns that look like those of another unit, where the misfit is hopeless

    def _about(self) -> About:
        scene, rows = self.fit.scene, []
        for one in self.hypotheses:
            now = ", ".join(shown_value(scene, each.path, each.value, 4) for each in one.changes)
            rows.append((one.path or "nothing", f"{100.0 * one.probability:.3g} %", now, f"{one.misfit:.3g}"))
        none = "nothing fits: chance alone produces a misfit as large in less than 1 % of all cases"
        fits = self.chance is None or self.chance >= LEAST_CHANCE
        notes = [text for text in (self.fit.title, self.message, "" if fits else none) if text]
        heading = f"Diagnosis: {self.status}; {len(self.fit.fitted)} points"
        return About(heading, notes, ("changed", "probability", "now", "chi²"), rows)

    @property
    def changed(self) -> dict[str, float]:
        """Probability that each parameter has changed, alone or with another; the most probable first."""
        sums = dict.fromkeys(self.unchanged, 0.0)
        for hypothesis in self.hypotheses:
            for path in hypothesis.paths:
                sums[path] += hypothesis.probability
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


Single = LinearLikelihood | ProfileLikelihood  # of one parameter: by slopes, or solved


@dataclass(frozen=True)
class LinearMachine:
    """The unchanged machine by its slopes: whitened residuals (n,) and slopes (parameters, n) at its places `start`.

    `before` are its parameters [SI], `white` the matrix (n, n) that whitens residuals.
    """

    fit: Fit
    simulate: Simulate | None
    before: Mapping[str, float]
    start: Array
    white: Array
    residuals: Array
    slopes: Array

    @property
    def misfit(self) -> float:
        """Chi² of no change."""
        return float(self.residuals @ self.residuals)

    def residuals_of(self, i: int, single: Single) -> Array:
        """Return the residuals (n,) at the best place of one parameter."""
        if isinstance(single, ProfileLikelihood):
            return single.residuals
        return self.residuals + self.slopes[i] * (single.estimate - self.start[i])

    def change(self, i: int, place: float, ends: tuple[float, float]) -> Change:
        """Return the change of one parameter to a place, between the places `ends`."""
        parameter = self.fit.parameters[i]
        was, value = self.before[parameter.path], parameter.value(place)
        low, high = (parameter.value(end) - was for end in ends)
        return Change(parameter.path, value, value - was, low, high)


class Judgement(NamedTuple):
    """All hypotheses, the residuals (n,) that each change leaves, by its paths, and the solutions that this took."""

    hypotheses: Sequence[Hypothesis]
    residuals: Mapping[tuple[str, ...], Array]
    solutions: int
    failed: int


class UnchangedPoint(NamedTuple):
    """One point of the unchanged machine: residuals (n,), slopes (n, parameters), shifts by its inputs.

    Without a solution there is the reason alone.
    """

    residuals: Array = np.zeros(0)
    slopes: Array = np.zeros((0, 0))
    shifts: PointShifts = NO_SHIFTS
    why: str = ""
    solutions: int = 0
    failed: int = 0


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
    asked, before = unchanged_fit(fit, simulate)
    groups, priors = inputs_of(fit, asked.scene)
    points = asked.fitted
    answers = parallel_map(
        partial(unchanged_point, asked, groups, before, simulate),
        len(points),
        died=lambda number: UnchangedPoint(why=WORKER_DIED),
        jobs=jobs,
        failed=lambda answer: bool(answer.why),
        progress=progress,
    )
    reasons = {point.name: answer.why for point, answer in zip(points, answers, strict=True) if answer.why}
    solved = [point for point, answer in zip(points, answers, strict=True) if not answer.why]
    solutions, failed = sum(answer.solutions for answer in answers), sum(answer.failed for answer in answers)
    if not solved:
        why = f"none of the points has a solution: {next(iter(reasons.values()))}"
        return Diagnosis(fit, "failed", why, before, reasons=reasons, solutions=solutions, failed=failed)
    known = [answer for answer in answers if not answer.why]
    groups, left_out = known_everywhere(groups, (answer.shifts for answer in known))
    linear = _linearised(replace(asked, points=tuple(solved)), before, known, groups, priors, simulate)
    odds = pairs if len(fit.parameters) > 1 else 0.0
    judged = _judged(linear, unchanged, odds, partial(parallel_map, jobs=jobs, progress=progress))
    ranked = tuple(sorted(judged.hypotheses, key=lambda hypothesis: -hypothesis.probability))
    hopeless = ranked[0].misfit > HOPELESS * max(ranked[0].freedom, 1)
    return Diagnosis(
        fit,
        "failed" if reasons else "ok",
        f"{len(reasons)} of {len(points)} points have no solution" if reasons else "",
        before,
        ranked,
        alike=indistinguishable_pairs(ranked, judged.residuals),
        chance=chance_of_misfit(ranked[0].misfit, ranked[0].freedom),
        inputs=tuple(" + ".join(group) for group in (*groups, *priors)),
        left_out=left_out,
        reasons=reasons,
        solutions=solutions + judged.solutions,
        failed=failed + judged.failed,
        odds=odds,
        misread=misread_by_residuals(fit, solved, [each.residuals for each in known]) if hopeless else (),
    )


def _check(unchanged: float, pairs: float) -> None:
    if not 0.0 < unchanged < 1.0:
        raise UsageError(f"--unchanged {unchanged:g}: is not a probability between 0 and 1 (write e.g. 0.5)")
    if not (pairs >= 0.0 and np.isfinite(pairs)):
        what = "is not the odds of two changes against one (write e.g. 0.1, or 0 for single changes only)"
        raise UsageError(f"--pairs {pairs:g}: {what}")


def unchanged_point(
    fit: Fit,
    groups: Sequence[Group],
    values: Mapping[str, float],
    simulate: Simulate | None,
    number: int,
) -> UnchangedPoint:
    """Return one point of the unchanged machine, with its slopes."""
    point = fit.fitted[number]
    asked = Objective(replace(fit, points=(point,)), simulate)
    places = fit.places(values)
    outcome = asked.outcome(places)
    if why := outcome.reasons.get(point.name, ""):
        return UnchangedPoint(why=why, solutions=asked.solutions, failed=asked.failed)
    slopes = asked.slopes(places)
    shifts = point_shifts(fit.at(point, values), point, groups)
    return UnchangedPoint(outcome.residuals, slopes, shifts, "", asked.solutions, asked.failed)


def _linearised(
    fit: Fit,
    before: Mapping[str, float],
    points: Sequence[UnchangedPoint],
    groups: Sequence[Group],
    priors: Mapping[Group, float],
    simulate: Simulate | None,
) -> LinearMachine:
    """Return the unchanged machine by the residuals and slopes of its points; its inputs and priors whiten them."""
    slopes = np.vstack([point.slopes for point in points])
    shapes = ((len(groups), len(point.residuals)) for point in points)
    parts = [np.reshape(point.shifts.of(groups), shape).T for point, shape in zip(points, shapes, strict=True)]
    shifts = np.vstack(parts)
    paths = [parameter.path for parameter in fit.parameters]
    for (path,), deviation in priors.items():
        i = paths.index(path)
        shifts = np.column_stack([shifts, slopes[:, i] * deviation / fit.parameters[i].slope(before[path])])
    white = whitener(shifts)
    residuals = white @ np.concatenate([point.residuals for point in points])
    return LinearMachine(fit, simulate, before, fit.places(before), white, residuals, (white @ slopes).T)


def _judged(machine: LinearMachine, unchanged: float, odds: float, mapped: Mapped) -> Judgement:
    """Return all hypotheses, judged by slopes, the likely ones solved again; see `diagnose`."""
    pairs = zip(machine.start, machine.slopes, strict=True)
    by_slopes = [linear_likelihood(place, machine.residuals, slopes) for place, slopes in pairs]
    solved: dict[int, ProfileLikelihood | None] = {}
    spent: list[PairLikelihood | ProfileLikelihood] = []
    # the hypotheses worth solving again
    prior = PriorOdds(unchanged, odds, machine.misfit, tuple(linear.log_evidence for linear in by_slopes))
    chances = prior.probabilities()[1:]
    ranked = sorted(range(len(by_slopes)), key=lambda i: -chances[i])
    likely = [i for rank, i in enumerate(ranked) if rank < LEAST_SINGLES or chances[i] > LIKELY_PROBABILITY]
    while True:
        call = partial(solved_likelihood, machine, likely)
        solved |= dict(zip(likely, mapped(call, len(likely), died=lambda number: None), strict=True))
        singles = [solved.get(i) or linear for i, linear in enumerate(by_slopes)]
        prior = prior._replace(singles=tuple(single.log_evidence for single in singles))
        doubles = _pair_likelihoods(machine, singles, prior, mapped)
        spent += doubles.values()
        hypotheses = _hypotheses(machine, singles, doubles, set(solved), prior)
        best = max(hypotheses, key=lambda hypothesis: hypothesis.probability)
        likely = [i for i in range(len(by_slopes)) if i not in solved]
        if not likely or chance_of_misfit(best.misfit, best.freedom) >= LEAST_CHANCE:
            break  # else a hypothesis that fits may have been dismissed by its slopes
    spent += filter(None, solved.values())
    paths = [parameter.path for parameter in machine.fit.parameters]
    left: dict[Group, Array] = {(paths[i], paths[j]): double.residuals for (i, j), double in doubles.items()}
    left |= {(paths[i],): machine.residuals_of(i, single) for i, single in enumerate(singles)}
    return Judgement(hypotheses, left, sum(one.solutions for one in spent), sum(one.failed for one in spent))


def solved_likelihood(machine: LinearMachine, likely: Sequence[int], number: int) -> ProfileLikelihood | None:
    """Return the likelihood over one of the likely parameters; None where only slopes give one."""
    i = likely[number]
    asked = Objective(replace(machine.fit, parameters=(machine.fit.parameters[i],)), machine.simulate)
    return profile_likelihood(asked, machine.white, float(machine.start[i]), machine.slopes[i])


def _pair_likelihoods(
    machine: LinearMachine, singles: Sequence[Single], prior: PriorOdds, mapped: Mapped
) -> dict[tuple[int, int], PairLikelihood]:
    """Return the likelihoods of all pairs, the likely ones solved; none where the odds of pairs are zero."""
    if not prior.odds > 0.0:
        return {}
    curves = curves_of(machine.residuals, machine.start, machine.slopes, singles)
    pairs = list(combinations(range(len(singles)), 2))
    found = {pair: additive_likelihood(curves, pair) for pair in pairs}
    best_of_others = min([machine.misfit, *(single.misfit for single in singles)])
    tried: set[tuple[int, int]] = set()
    while len(tried) < MOST_PAIRS:
        chances = prior.probabilities([found[pair].log_evidence for pair in pairs])[1 + len(singles) :]
        least = min([best_of_others, *(double.misfit for double in found.values() if double.solved)])
        first = FIRST_PAIRS if chance_of_misfit(least, len(machine.residuals) - 1) < LEAST_CHANCE else 0
        ranked = sorted(range(len(pairs)), key=lambda i: -chances[i])
        wanted = [pairs[i] for rank, i in enumerate(ranked) if rank < first or chances[i] > LIKELY_PAIR]
        guesses = [(pair, found[pair]) for pair in wanted if pair not in tried][: MOST_PAIRS - len(tried)]
        if not guesses:
            break
        call = partial(solved_pair, machine.fit, machine.white, machine.simulate, guesses)
        answers = mapped(call, len(guesses), died=lambda number: None)
        found |= {pair: double for (pair, _), double in zip(guesses, answers, strict=True) if double}
        tried |= {pair for pair, _ in guesses}
    return found


def _hypotheses(
    machine: LinearMachine,
    singles: Sequence[Single],
    doubles: Mapping[tuple[int, int], PairLikelihood],
    tried: Set[int],
    prior: PriorOdds,
) -> list[Hypothesis]:
    """Return all hypotheses: no change, each single change, each pair."""
    none, *chances = map(float, prior.probabilities([double.log_evidence for double in doubles.values()]))
    count = len(machine.residuals)
    rows = [Hypothesis((), none, -0.5 * prior.none, prior.none, count)]
    for i, (single, chance) in enumerate(zip(singles, chances, strict=False)):
        why, also = UNSOLVED if i in tried else UNLIKELY, ()
        if isinstance(single, ProfileLikelihood):
            why, also = "", tuple(map(machine.fit.parameters[i].value, single.others()))
        changes = (machine.change(i, single.estimate, single.interval),)
        rows.append(Hypothesis(changes, chance, single.log_evidence, float(single.misfit), count - 1, why, also))
    for (pair, double), chance in zip(doubles.items(), chances[len(singles) :], strict=True):
        changes = tuple(map(machine.change, pair, double.places, double.intervals))
        why = "" if double.solved else UNLIKELY
        rows.append(Hypothesis(changes, chance, double.log_evidence, float(double.misfit), count - 2, why))
    return rows
