"""Measurement of one case of the study: time, evaluations and true error, or why there is none.

Likewise for an accuracy that a user asks for: `simulate` as it is, with its estimate, against the reference.
"""

import statistics
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from screwsim.evaluate.traces import traces as traces_of
from screwsim.evaluate.verdict import outside_gas_range
from screwsim.figures.errors import relative_errors, worst
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.numerics.integrators import DEFAULT
from screwsim.outputs import Figures, Result
from screwsim.scene import Scene
from screwsim.simulate import simulate
from screwsim.study.accuracy.solving import Case, Scope, SolvedCase, WorkLimit, method_of, solve

Traces = Mapping[str, np.ndarray]
COMPARED_TRACES = ("pressure", "gas_temperature")  # traces that are compared
REFERENCE_MARGIN = 1e3  # ratio by which a reference must be more accurate than what it measures
LEAST_VOLUME = 0.01  # of the largest volume: below it the little gas at the ends of a life affects no figure


class NoReference(Exception):
    """A scene has no solution that can serve as a reference."""


@dataclass(frozen=True)
class MeasuredCase:
    """A case with its cost and true error; `reason` says why it is left out, when it is."""

    part: str
    label: str
    back_end: str
    asked: float
    factor: float | None
    status: str
    reason: str = ""
    time: float = np.nan  # [s], median
    runs: int = 0
    evaluations: int = 0
    steps: int = 0
    error: float = np.nan
    figure: str = ""
    pressure_error: float = np.nan
    temperature_error: float = np.nan
    pressure_error_at_ends: float = np.nan  # ends of the life included
    temperature_error_at_ends: float = np.nan
    change: float = np.nan  # of the answer from that of the scene as it is, where the case changes the model
    changed_figure: str = ""
    errors: Figures = field(default_factory=Figures)
    traces: Traces = field(default_factory=dict)


@dataclass(frozen=True)
class Reference:
    """A reference: figures, traces, and their difference from a second method (NaN without one).

    `accuracy` is that of the reference; it cannot measure solutions that are less than `REFERENCE_MARGIN` times
    coarser.
    """

    figures: Figures
    traces: Traces
    how: str
    accuracy: float
    second: str = ""
    difference: float = np.nan
    different_figure: str = ""
    traces_difference: tuple[float, float] = (np.nan, np.nan)
    seconds: float = 0.0

    def why_not(self, asked: float) -> str:
        """Return why a solution of this accuracy cannot be measured; empty where it can."""
        if asked >= 0.999 * REFERENCE_MARGIN * self.accuracy:
            return ""
        return f"the reference closes only at {self.accuracy:g}, which is not {REFERENCE_MARGIN:g} times tighter"


@dataclass(frozen=True)
class RequestedAccuracy:
    """A requested accuracy: its cost [s], the solver's estimate, the true error."""

    asked: float
    status: str
    closing: str
    time: float
    estimating_time: float
    evaluations: int
    estimated: float
    error: float
    figure: str


def trace_errors(found: Traces, better: Traces, least: float = LEAST_VOLUME) -> tuple[float, float]:
    """Return the largest relative errors of pressure and temperature at common angles.

    Only angles count at which the volume is at least this share of its largest.
    """
    chosen = better["volume"] >= least * np.max(better["volume"])
    off = (np.abs(found[name][chosen] / better[name][chosen] - 1.0) for name in COMPARED_TRACES)
    pressure, temperature = (float(np.nanmax(each)) for each in off)
    return pressure, temperature


def _finest_solution(scene: Any, extent: Scope, wanted: float) -> tuple[SolvedCase, float]:
    """Return the finest solution that closes, and its accuracy; NoReference where none does, or the scene fails."""
    reasons = []
    for fine in (wanted, 10.0 * wanted, 100.0 * wanted):
        try:
            first = solve(scene, method_of(fine, regularised=1e-2 * fine), extent.check_limit)
        except WorkLimit as error:
            reasons.append(f"the reference (coupled, {fine:g}) {error}")
            continue
        if first.cycle.closed:
            if outside := outside_gas_range(first.evaluation.problem, first.evaluation.life):
                raise NoReference(f"the scene itself has no result: {outside}")
            return first, fine
        reasons.append(f"the reference (coupled, {fine:g}) ended {first.cycle.status.replace('_', ' ')}")
    found = simulate(scene, trace=False)
    if found.status != "ok":
        raise NoReference(f"the scene itself has no result: {found.message}")
    raise NoReference(reasons[0])


def reference_of(scene: Any, extent: Scope, checked: bool = True) -> Reference:
    """Return the reference of a scene: coupled chambers with hardly any regularisation, checked by scipy's Radau.

    It is as accurate as `extent` says, or up to a hundred times less where that takes too long. Raises NoReference
    where none closes.
    """
    started = time.perf_counter()
    first, fine = _finest_solution(scene, extent, extent.reference)
    figures, traces = first.evaluation.figures, traces_of(first.evaluation)
    how = f"rodas4, coupled, accuracy {fine:g}, regularisation {1e-2 * fine:g} of the pressures"
    if not checked:
        return Reference(figures, traces, how, fine, seconds=time.perf_counter() - started)
    # errors of balances by scipy's methods are of the size of the step errors, over all steps
    closed = max(fine, 10.0 * extent.check)
    tight = method_of(closed, "scipy-radau", rtol=extent.check, regularised=1e-2 * fine, bound=1e-5)
    second, difference = f"scipy-radau, coupled, rtol {extent.check:g}", ("", np.nan)
    apart = (np.nan, np.nan)
    try:
        other = solve(scene, tight, extent.check_limit)
        if other.cycle.closed:
            difference = worst(relative_errors(other.evaluation.figures, figures))
            apart = trace_errors(traces_of(other.evaluation), traces)
        else:
            second += f" ({other.cycle.status.replace('_', ' ')})"
    except WorkLimit as error:
        second += f" ({error})"
    seconds = time.perf_counter() - started
    return Reference(figures, traces, how, fine, second, difference[1], difference[0], apart, seconds)


def one_line(text: str) -> str:
    return " ".join(text.split())[:200]


def measure(case: Case, reference: Reference, own: Reference, extent: Scope) -> MeasuredCase:
    """Return the case measured against `reference`; `own` is that of the scene as it is."""
    head = (case.part, case.label, case.back_end, case.asked, case.factor)
    if why := reference.why_not(case.asked):
        return MeasuredCase(*head, "left out", why)
    try:
        solved, times = _repeated(case, extent)
    except WorkLimit as error:
        return MeasuredCase(*head, "left out", str(error))
    except (SceneError, UsageError, ValueError) as error:
        return MeasuredCase(*head, "left out", one_line(str(error)))
    cycle, reason = solved.cycle, ""
    if cycle.failed:
        reason = f"stopped at {np.degrees(cycle.angle):.1f} deg"
        return MeasuredCase(*head, "failed", reason, statistics.median(times), len(times), solved.evaluations)
    if not cycle.closed:
        reason = f"not closed: last change {cycle.change:.2g}"
    figures, traces = solved.evaluation.figures, traces_of(solved.evaluation)
    errors = relative_errors(figures, reference.figures)
    name, error = worst(errors)
    changed = worst(relative_errors(figures, own.figures)) if case.own_reference else ("", np.nan)
    took = (statistics.median(times), len(times), solved.evaluations, solved.steps)
    apart = (*trace_errors(traces, reference.traces), *trace_errors(traces, reference.traces, 0.0))
    kept = {each: traces[each] for each in COMPARED_TRACES}
    return MeasuredCase(*head, cycle.status, reason, *took, error, name, *apart, changed[1], changed[0], errors, kept)


def _repeated(case: Case, extent: Scope) -> tuple[SolvedCase, list[float]]:
    """Return the last of several solutions and their times, without the first where there are more."""
    machinery = None
    if case.back_end == "coolprop":
        from screwsim.study.accuracy.coolprop_back_end import machinery_with_coolprop

        machinery = machinery_with_coolprop(case.scene)
    solved = solve(case.scene, case.way, extent.limit, machinery)
    times = [solved.time]
    while len(times) < extent.runs and sum(times) + times[-1] < extent.seconds:
        solved = solve(case.scene, case.way, extent.limit, machinery)
        times.append(solved.time)
    return solved, times[1:] or times


def time_of(result: Result) -> float:
    """Return the wall time [s] of a result, with that of its estimate of the errors."""
    return result.numerics.wall_time + result.numerics.estimating_time


def solved_as_requested(scene: Scene, accuracy: float, reference: Reference, extent: Scope) -> RequestedAccuracy:
    """Return the results of asking for this accuracy."""
    numerics = replace(scene.numerics, accuracy=accuracy, integrator=DEFAULT, rtol=None, error="estimate")
    wanted = replace(scene, numerics=numerics)
    results = [simulate(wanted, trace=False)]
    spent = 0.0
    while len(results) <= extent.runs and spent < extent.seconds:
        results.append(simulate(wanted, trace=False))
        spent += time_of(results[-1])
    timed = results[1:] or results
    last = results[-1]
    known = any(size is not None for size in last.error.values())
    name, error = worst(relative_errors(last.performance, reference.figures)) if last.performance else ("", np.nan)
    return RequestedAccuracy(
        accuracy,
        last.status,
        last.numerics.closing,
        statistics.median(each.numerics.wall_time for each in timed),
        statistics.median(each.numerics.estimating_time for each in timed),
        int(last.numerics.rhs_evaluations),
        worst(last.error)[1] if known else np.nan,
        error,
        name,
    )
