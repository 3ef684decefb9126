"""Which points to measure next: the candidates that say most about the parameters of a fit.

Slopes are exact, at the parameters that the scene states (or the means of priors). Prior information comes from the
fit's points, priors, tolerances of the scene and, for a parameter without either, from a uniform distribution between
its bounds.

Nuisance inputs follow the parameters among the unknowns: they are not known exactly, but not wanted either. With the
information A = prior + Σ JᵀJ of what is measured, candidates are chosen that minimise the determinant of the
parameters' block of A⁻¹ (Ds-optimal): one after the other, then exchanged one for one until no exchange helps
(Fedorov).

Sources: V. V. Fedorov, Theory of Optimal Experiments, Academic Press 1972; K. Chaloner, I. Verdinelli, Statistical
Science 10 (1995) 273.
"""

import itertools
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures
from screwsim.outputs.display import About, Brief
from screwsim.scene import Scene, cross_check
from screwsim.study.asked.inputs import shown_value
from screwsim.study.asked.spans import Span, read_ranges
from screwsim.study.calibration.fit import Fit, Measurement, Point, odd_uncertainty, prior_of
from screwsim.study.calibration.machine import (
    NO_SHIFTS,
    Group,
    PointShifts,
    TypicalUncertainty,
    groups_without,
    inputs_of,
    known_everywhere,
    point_shifts,
    points_of,
    typical_uncertainties,
    unchanged_fit,
)
from screwsim.study.calibration.residuals import Array, Objective, Simulate
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import WORKER_DIED

UNIFORM_INFORMATION = 12.0  # one over the variance of a uniform distribution on 0 … 1
COUNT, LEVELS = 3, 4  # points to choose; values per range
MOST_CANDIDATES = 2000  # candidates
NONE_DELIVERS = "no candidate delivers anything (use candidates at a higher speed or a lower pressure ratio)"
NOTHING_MEASURED: Mapping[str, Measurement] = {}
LEAST_IMPROVEMENT = 1e-9  # least improvement of the logarithm of a determinant


def point_name(scene: Scene, values: Mapping[str, Any]) -> str:
    """Return the name of a candidate: its values [SI] as people write them."""
    return ", ".join(shown_value(scene, path, value) for path, value in values.items())


@dataclass(frozen=True)
class PlannedPoint:
    """One point to measure: standard deviations [SI] of the parameters with it and those before, the gain in nats.

    `gain` is the decrease of the logarithm of the volume in which the parameters may lie.
    """

    point: Point
    gain: float
    deviations: tuple[float, ...]


@dataclass(frozen=True, repr=False)
class Plan(Brief):
    """The answer: points in the order of their information; `before` are the present deviations [SI].

    `even` are the parameters of which only the bounds are known beforehand. `reasons` are those of points and
    candidates without a solution. `status` ok | failed.
    """

    fit: Fit
    status: str
    message: str
    values: Mapping[str, float]
    candidates: int = 0
    before: tuple[float, ...] = ()
    steps: tuple[PlannedPoint, ...] = ()
    even: tuple[str, ...] = ()
    inputs: tuple[str, ...] = ()
    left_out: Mapping[str, str] = field(default_factory=dict)  # inputs without a derivative at a point, and why
    reasons: Mapping[str, str] = field(default_factory=dict)
    solutions: int = 0
    failed: int = 0
    idle: tuple[str, ...] = ()
    unsure: Mapping[str, str] = field(default_factory=dict)  # candidates at which an input has no derivative, and why

    def _about(self) -> About:
        rows = [(step.point.name, f"{step.gain:.3f}") for step in self.steps]
        heading = f"Plan: {self.status}; {len(self.steps)} of {self.candidates} candidates"
        return About(heading, [text for text in (self.fit.title, self.message) if text], ("measure next", "gain"), rows)


class PointInformation(NamedTuple):
    """What a point tells: slopes over uncertainties (figures, parameters), shifts by inputs, and the figures."""

    slopes: Array = np.zeros((0, 0))
    shifts: PointShifts = NO_SHIFTS
    measured: Mapping[str, Measurement] = NOTHING_MEASURED
    why: str = ""
    solutions: int = 0
    failed: int = 0
    idle: bool = False  # nothing is delivered there
    odd: str = ""  # fault of an uncertainty that the point states

    def information(self, groups: Sequence[Group]) -> Array:
        """Return the information on parameters and groups of inputs (unknowns, unknowns)."""
        rows = np.column_stack([self.slopes, *self.shifts.of(groups)])
        return rows.T @ rows

    def lacking(self, groups: Sequence[Group]) -> str:
        """Return the first of these inputs that has no derivative here, and why; '' for none."""
        why = self.shifts.left_out
        return next((f"{path}: {why[path]}" for group in groups for path in group if path in why), "")


def candidates_of(
    fit: Fit, file: str | os.PathLike[str] | None = None, paths: Sequence[str] = (), levels: int = LEVELS
) -> tuple[Point, ...]:
    """Return the candidates of a CSV file, or all combinations of so many values of ranges PATH=LOW..HIGH.

    A candidate measures the figures whose uncertainties its file states; from ranges, and without such columns, none
    yet. Raises SceneError with one line per fault of the file, UsageError.
    """
    if (file is None) == (not paths):
        remedy = "write either --candidates GRID.csv or one or more --path PATH=LOW..HIGH"
        raise UsageError(f"candidates come from one place ({remedy})")
    if file is not None:
        found = tuple(point for point in points_of(fit, file, "--candidates", "candidates") if point.fitted)
    else:
        found = _candidates_of_ranges(fit, read_ranges(fit.scene, paths), levels)
    if len(found) > MOST_CANDIDATES:
        raise UsageError(f"{len(found)} candidates are more than {MOST_CANDIDATES} (use fewer values)")
    return found


def _candidates_of_ranges(fit: Fit, ranges: Sequence[Span], levels: int) -> tuple[Point, ...]:
    if levels < 2:
        raise UsageError(f"--levels {levels}: a range has at least two values, its ends (write 2 or more)")
    taken = fit.changes(fit.first_start())
    for one in ranges:
        if one.path in taken:
            raise UsageError(f"--path {one.path}: is a parameter of the fit and cannot be a condition")
    count = levels ** len(ranges)
    if count > MOST_CANDIDATES:
        raise UsageError(f"--levels {levels}: makes {count} candidates, more than {MOST_CANDIDATES} (use fewer)")
    found = []
    axes = [np.linspace(one.low, one.high, levels).tolist() for one in ranges]
    for numbers in itertools.product(*axes):
        values = {one.path: number for one, number in zip(ranges, numbers, strict=True)}
        name = point_name(fit.scene, values)
        if faults := cross_check(fit.at(Point(name, values, {}), fit.first_start())):
            raise UsageError(f"--path: at {name}: {faults[0]}")
        found.append(Point(name, values, {}))
    return tuple(found)


def plan(
    fit: Fit,
    candidates: Sequence[Point],
    *,
    count: int = COUNT,
    jobs: int | None = None,
    simulate: Simulate | None = None,
    progress: Progress | None = None,
) -> Plan:
    """Return which `count` of the candidates say most in addition to the fit's points; raise UsageError."""
    if not 1 <= count <= len(candidates):
        raise UsageError(f"--count {count}: of {len(candidates)} candidates 1 to {len(candidates)} can be chosen")
    asked, values = unchanged_fit(fit, simulate)
    groups, _ = inputs_of(fit, asked.scene)
    # a parameter's tolerance is its prior, and what follows it has none of its own
    groups = groups_without(groups, fit.changes(values))
    measured = [point for point in fit.fitted if point.measured]
    points = [*measured, *candidates]
    answers = parallel_map(
        partial(point_information, asked, points, typical_uncertainties(fit), groups, values, simulate),
        len(points),
        died=lambda number: PointInformation(why=WORKER_DIED),
        jobs=jobs,
        failed=lambda answer: bool(answer.why),
        progress=progress,
    )
    pairs = list(zip(points, answers, strict=True))
    if fault := next((f"{point.name}: {answer.odd}" for point, answer in pairs if answer.odd), ""):
        raise UsageError(fault)
    solved = [(point, answer) for point, answer in pairs[len(measured) :] if not answer.why]
    delivering = [(point, answer) for point, answer in solved if not answer.idle]
    groups, left_out, unsure = _known_groups(groups, answers[: len(measured)], delivering)
    delivering = [(point, answer) for point, answer in delivering if point.name not in unsure]
    known, even = _prior_information(fit, asked.scene, values, len(groups))
    measured_too = (answer.information(groups) for answer in answers[: len(measured)] if not answer.why)
    known += sum(measured_too, 0.0 * known)
    reasons = {point.name: answer.why for point, answer in pairs if answer.why}
    message = f"{len(reasons)} of {len(points)} points have no solution" if reasons else ""
    found = Plan(
        fit,
        "failed" if reasons else "ok",
        message,
        values,
        len(candidates),
        left_out=left_out,
        unsure=unsure,
        reasons=reasons,
        solutions=sum(answer.solutions for answer in answers),
        failed=sum(answer.failed for answer in answers),
    )
    if not delivering:
        why = NONE_DELIVERS if solved else f"none of the candidates has a solution: {next(iter(reasons.values()))}"
        return replace(found, status="failed", message=why)
    pieces = [answer.information(groups) for _, answer in delivering]
    order = optimal_choice(known, pieces, len(fit.parameters), count)
    picked = [(replace(point, measured=answer.measured), pieces[i]) for i in order for point, answer in [delivering[i]]]
    before, steps = _planned(fit, values, known, picked)
    inputs, idle = (" + ".join(group) for group in groups), (point.name for point, answer in solved if answer.idle)
    return replace(found, before=before, steps=steps, even=even, inputs=tuple(inputs), idle=tuple(idle))


def _known_groups(
    groups: Sequence[Group], measured: Sequence[PointInformation], candidates: Sequence[tuple[Point, PointInformation]]
) -> tuple[tuple[Group, ...], dict[str, str], dict[str, str]]:
    """Return the groups of inputs known at what is measured, those left out, and the candidates without one of them.

    A candidate without an input's derivative would tell too much. An input without one at any candidate is left out, as
    are all that some candidate lacks where none has each of the others.
    """
    lost = [answer.shifts.left_out for _, answer in candidates]
    nowhere = {path: why for path, why in (lost[0] if lost else {}).items() if all(path in each for each in lost)}
    known, left_out = known_everywhere(groups, (*(answer.shifts for answer in measured), PointShifts({}, nowhere)))
    unsure = {point.name: why for point, answer in candidates if (why := answer.lacking(known))}
    if len(unsure) < len(candidates):
        return known, left_out, unsure
    every = (*measured, *(answer for _, answer in candidates))
    return *known_everywhere(groups, (answer.shifts for answer in every)), {}


def _planned(
    fit: Fit, values: Mapping[str, float], known: Array, picked: Sequence[tuple[Point, Array]]
) -> tuple[tuple[float, ...], tuple[PlannedPoint, ...]]:
    """Return the deviations [SI] of the parameters by what is known, and the picked points with those after each.

    Each is picked with its information.
    """
    size = len(fit.parameters)
    scales = np.array([parameter.slope(values[parameter.path]) for parameter in fit.parameters])

    def deviations(information: Array) -> tuple[float, ...]:
        return tuple((scales * np.sqrt(np.diag(covariance(information, size)))).tolist())

    before, steps = deviations(known), []
    for point, information in picked:
        more = known + information
        gain = 0.5 * float(log_determinant(known, size) - log_determinant(more, size))
        steps.append(PlannedPoint(point, gain, deviations(more)))
        known = more
    return before, tuple(steps)


def _prior_information(
    fit: Fit, machine: Scene, values: Mapping[str, float], inputs: int
) -> tuple[Array, tuple[str, ...]]:
    """Return the prior information, and the parameters of which it is that of the bounds alone."""
    diagonal, even = [], []
    for one in fit.parameters:
        value, prior = values[one.path], prior_of(machine, one)
        if prior is None:
            even.append(one.path)
        diagonal.append(UNIFORM_INFORMATION if prior is None else (one.slope(value) / prior.deviation_at(value)) ** 2)
    known, held = np.diag([*diagonal, *[1.0] * inputs]), replace(fit, scene=machine).with_priors()
    if held.together:
        rows = list(held.held)
        of = held.whitener @ np.diag([known[i, i] ** 0.5 for i in rows])
        known[np.ix_(rows, rows)] = of.T @ of
    return known, tuple(even)


def point_information(
    fit: Fit,
    points: Sequence[Point],
    usual: Mapping[str, TypicalUncertainty],
    groups: Sequence[Group],
    values: Mapping[str, float],
    simulate: Simulate | None,
    number: int,
) -> PointInformation:
    """Return the information of one point; a candidate without stated uncertainties is measured like the others."""
    point = points[number]
    asked, places = Objective(fit, simulate), fit.places(values)
    if not point.measured:
        point = replace(point, measured={name: Measurement(0.0, 1.0) for name in usual})
    result = asked.solved(point, values)
    if why := result.why_not(point.measured):
        return PointInformation(why=why, solutions=asked.solutions, failed=asked.failed)
    measured = _as_measured(points[number], result.performance, usual)
    for name, one in measured.items():
        if odd := odd_uncertainty(one.value, one.uncertainty):
            return PointInformation(odd=f"{name}: {odd}")
    point = replace(point, measured=measured)
    slopes = asked.point_slopes(point, places, result.performance)
    shifts = point_shifts(fit.at(point, values), point, groups, result if simulate is None else None)
    # power without flow depends on the leaks, but nobody rates such a point
    flow = result.performance.get("gas_mass_flow")
    return PointInformation(
        slopes, shifts, measured, "", asked.solutions, asked.failed, flow is not None and flow <= 0.0
    )


def _as_measured(point: Point, figures: Figures, usual: Mapping[str, TypicalUncertainty]) -> dict[str, Measurement]:
    """Return the computed figures that a point measures, with its stated uncertainties, or the usual ones."""
    if point.measured:
        return {name: Measurement(figures[name], one.uncertainty) for name, one in point.measured.items()}
    return {name: Measurement(figures[name], one.of(figures[name])) for name, one in usual.items() if figures[name]}


def covariance(information: Array, asked: int) -> Array:
    """Return the covariance of the first `asked` unknowns, from information (…, unknowns, unknowns)."""
    return np.asarray(np.linalg.inv(information)[..., :asked, :asked], float)


def log_determinant(information: Array, asked: int) -> Array:
    """Return the logarithm of the determinant (…) of the covariance of the first `asked` unknowns."""
    return np.linalg.slogdet(covariance(information, asked))[1]


def optimal_choice(known: Array, pieces: Sequence[Array], asked: int, count: int) -> list[int]:
    """Return the indices of the `count` pieces of information that minimise the spread, the most informative first."""
    picked = greedy_choice(known, pieces, asked, range(len(pieces)), count)
    every, improved = np.array(pieces), True
    while improved:
        improved = False
        for place in range(len(picked)):
            rest = known + sum((pieces[i] for k, i in enumerate(picked) if k != place), np.zeros_like(known))
            here = log_determinant(rest + pieces[picked[place]], asked)
            others = sorted(set(range(len(pieces))).difference(picked))
            if not others:
                break
            found = log_determinant(rest + every[others], asked)
            best = int(np.argmin(found))
            if found[best] < here - LEAST_IMPROVEMENT:
                picked[place], improved = others[best], True
    return greedy_choice(known, pieces, asked, picked, count)


def greedy_choice(known: Array, pieces: Sequence[Array], asked: int, among: Sequence[int], count: int) -> list[int]:
    """Return up to `count` of the indices `among`, each the one that minimises the spread after those before it."""
    left, picked, information, every = list(among), [], known, np.array(pieces)
    while left and len(picked) < count:
        best = left.pop(int(np.argmin(log_determinant(information + every[left], asked))))
        picked.append(best)
        information = information + pieces[best]
    return picked
