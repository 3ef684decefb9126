"""Fit parameters to measured points: bounded least squares from several starts, and the certainty of the best."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from screwsim.inputs.faults import Interrupted, UsageError
from screwsim.inputs.suggestions import counted
from screwsim.outputs.display import About, Brief, library
from screwsim.scene import Scene
from screwsim.study.asked.inputs import shown_value
from screwsim.study.asked.varied import leaf_of, with_text
from screwsim.study.calibration.descent import LEAST_GAIN, least_squares
from screwsim.study.calibration.fit import DIFFERENCES, EXACT, TOLERANCE_REMEDY, Fit, Measurement, Point
from screwsim.study.calibration.identifiability import Certainty, active_bounds, certainty
from screwsim.study.calibration.machine import prepare
from screwsim.study.calibration.misread_units import HOPELESS, misread_units
from screwsim.study.calibration.other_inputs import InputShift, input_shifts
from screwsim.study.calibration.residuals import PENALTY, Array, Objective, Residuals, Simulate, reasons_of
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import WORKER_DIED

PROBABILITY = 0.6827  # of the joint region of the free parameters within which fits count as equally good
MOST_STEPS = 40  # steps per round of a start
MOST_ROUNDS = 3
TABLES = ("points", "parameters")
SAME_FIT = 10.0 * LEAST_GAIN  # of chi squared per residual, at least of 1: difference of ends that fit alike
APART = 0.1  # of the bounds' distance: ends this far apart are not one minimum


@dataclass(frozen=True)
class Start:
    """Result of one start: places 0 … 1 where it began and ended, sum of squares with penalties."""

    status: str  # ok | not converged | failed | interrupted
    message: str
    began: tuple[float, ...]
    places: tuple[float, ...]
    cost: float
    solutions: int = 0
    failed: int = 0
    jacobians: int = 0


@dataclass(frozen=True)
class ComparedMeasurement:
    """A measured figure beside the computed one [SI]; None where the point has no solution."""

    point: Point
    figure: str
    measured: Measurement
    ours: float | None

    @property
    def residual(self) -> float | None:
        """Return computed less measured over the uncertainty."""
        return None if self.ours is None else (self.ours - self.measured.value) / self.measured.uncertainty


@dataclass(frozen=True, repr=False)
class Calibration(Brief):
    """The answer: values and their certainty, the remaining residuals, and the fits that are equally good."""

    fit: Fit
    status: str  # ok | failed | interrupted
    message: str
    starts: tuple[Start, ...]
    values: dict[str, float]
    certainty: Certainty | None
    chi_squared: float | None
    freedom: int
    margin: float  # of chi², within which a fit is equally good
    as_good: tuple[int, ...]  # numbers of the starts
    compared: tuple[ComparedMeasurement, ...]
    reasons: dict[str, str]  # of points without a solution
    solutions: int
    failed: int
    jacobians: int = 0
    methods: Mapping[str, str] = field(default_factory=dict)  # by path: '' for exact slopes, else why differences
    warnings: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # of points that warn at the best values
    shifts: tuple[InputShift, ...] = ()  # of the values by the tolerances of inputs that are not fitted
    left_out: Mapping[str, str] = field(default_factory=dict)  # of those inputs, without a derivative, and why
    misread: tuple[str, ...] = ()  # lines on columns that look like those of another unit, where the misfit is hopeless

    @property
    def scale(self) -> float:
        """Return the factor of standard errors where the residuals exceed the uncertainties; at least 1."""
        if self.chi_squared is None or self.freedom < 1:
            return 1.0
        return max(1.0, float(np.sqrt(self.chi_squared / self.freedom)))

    @property
    def scene(self) -> Scene:
        """The fitted machine: the scene of the fit with the values found."""
        return with_text(self.fit.machine(self.values))

    @property
    def errors(self) -> dict[str, float | None]:
        """Standard errors of the parameters [SI] by path, times `scale`; None for one at a bound."""
        plain = [None] * len(self.values) if self.certainty is None else self.certainty.errors
        return {path: None if one is None else one * self.scale for path, one in zip(self.values, plain, strict=True)}

    def to_pandas(self, table: str = "points") -> Any:
        """Return a pandas.DataFrame [SI]: the `points`, a row a measured figure, or the `parameters`.

        `residual` is computed less measured over the standard uncertainty, `error` a standard error.
        """
        if table not in TABLES:
            raise UsageError(f"table: {table!r} is not one of {', '.join(TABLES)}")
        if table == "parameters":
            of = {path: leaf_of(self.fit.scene, path).dimension for path in self.values}
            units = ["1" if kind is None else kind.si for kind in of.values()]
            rows = zip(self.values, self.values.values(), self.errors.values(), units, strict=True)
            return library("pandas").DataFrame(rows, columns=["parameter", "value", "error", "units"])
        points = [
            (one.point.name, one.figure, *one.measured, one.ours, one.residual, "fit" if one.point.fitted else "check")
            for one in self.compared
        ]
        columns = ["point", "figure", "measured", "uncertainty", "computed", "residual", "use"]
        return library("pandas").DataFrame(points, columns=columns)

    def _about(self) -> About:
        scene, known = self.fit.scene, self.certainty
        rows = []
        for i, (path, value) in enumerate(self.values.items()):
            error = self.errors[path]
            told = "not known" if error is None else f"{100.0 * error / abs(value):.2g} %" if value else f"{error:.2g}"
            border = known.border[i] if known is not None else ""
            prior = self.fit.parameters[i].prior
            beside = [f"at the {border} bound"] if border else []
            beside += [TOLERANCE_REMEDY] if prior is not None and prior.of_scene else []
            rows.append((path, shown_value(scene, path, value), told, ", ".join(beside)))
        left = "" if self.chi_squared is None else f"; chi² {self.chi_squared:.4g} of {self.freedom} degrees of freedom"
        heading = f"Calibration: {self.status}{left}; {len(self.fit.points)} points, {len(self.starts)} starts"
        other = "standard errors are without the tolerances of other inputs (.shifts)" if self.shifts else ""
        notes = [text for text in (self.fit.title, self.message, other) if text]
        return About(heading, notes, ("parameter", "value", "standard error", ""), rows)


def start_places(fit: Fit) -> Array:
    """Return the places where the starts begin (starts, parameters): the stated values, then a Latin hypercube."""
    from scipy.stats import qmc

    first = fit.places(fit.first_start())[None]
    if fit.starts == 1:
        return first
    cube = qmc.LatinHypercube(len(fit.parameters), rng=np.random.default_rng(fit.seed))
    return np.vstack([first, cube.random(fit.starts - 1)])


def cost_in_words(fit: Fit) -> str:
    """Return in a line the approximate number of solutions, for one to three Jacobians, and how to need fewer."""
    points = len(fit.fitted)
    jacobian = points * (2 if fit.slopes == EXACT else 2 * len(fit.parameters) + 1)
    least = fit.starts * jacobian
    many = counted(fit.starts, "start")
    told = f"{many}, {points} points, {len(fit.parameters)} parameters: some {least} to {3 * least} solutions"
    fewer = "fewer `starts:` in the fit take less time, but may miss the best fit"
    return f"{told} ({fewer})" if fit.starts > 1 else told


def calibrate(
    fit: Fit, *, jobs: int | None = None, simulate: Simulate | None = None, progress: Progress | None = None
) -> Calibration:
    """Return the best fit of all starts. The number of workers does not matter.

    The scene's tolerance is the prior of a parameter for which the fit states none. Ctrl-C raises KeyboardInterrupt, or
    `Interrupted` once a start has begun: with the best fit so far, whose status is interrupted.
    """
    fit = fit.with_priors()
    places = start_places(fit)
    prepare(replace(fit, scene=fit.machine(fit.first_start())), simulate)
    if simulate is not None:
        fit = replace(fit, slopes=DIFFERENCES)
    answers: dict[int, Start] = {}
    with TemporaryDirectory(prefix="screwsim-") as folder:
        try:
            parallel_map(
                partial(run_start, fit, places, simulate, folder),
                len(places),
                died=lambda number: _failed_start(places[number], WORKER_DIED),
                jobs=jobs,
                failed=lambda start: start.status == "failed",
                progress=progress,
                kept=answers.update,
            )
            return _calibration_of_starts(fit, answers, simulate, jobs)
        except KeyboardInterrupt as pressed:
            answers |= _interrupted_starts(places, Path(folder), answers)
            if not answers:
                raise
            raise Interrupted(_calibration_of_starts(fit, answers, simulate, jobs, interrupted=True)) from pressed


def _interrupted_starts(places: Array, folder: Path, known: Mapping[int, Start]) -> dict[int, Start]:
    """Return the best results so far of interrupted starts."""
    found = {}
    for number in range(len(places)):
        note = folder / f"{number}.json"
        if number not in known and note.exists():
            cost, best, solutions, failed = json.loads(note.read_text(encoding="utf-8"))
            began = tuple(places[number].tolist())
            found[number] = Start("interrupted", "interrupted", began, tuple(best), cost, solutions, failed)
    return found


def run_start(fit: Fit, places: Array, simulate: Simulate | None, folder: str, number: int) -> Start:
    """Return the end of a least-squares search from one start; a folder holds the best so far for interruptions."""
    began = np.clip(places[number], 1e-6, 1.0 - 1e-6)
    asked = Objective(fit, simulate, Path(folder) / f"{number}.json")
    first = asked.outcome(began)
    if np.all(first.unsolved[: sum(len(point.measured) for point in asked.fit.fitted)]):
        found = _failed_start(began, next(iter(first.reasons.values())))
    else:
        converged = _search(asked, began, confirmed=False)
        status, message = ("ok", "") if converged else ("not converged", f"no minimum within {MOST_STEPS} steps")
        assert asked.best is not None
        cost, best, _ = asked.best
        found = Start(status, message, tuple(began.tolist()), tuple(best.tolist()), cost)
    return replace(found, solutions=asked.solutions, failed=asked.failed, jacobians=asked.jacobians)


def _search(asked: Objective, began: Array, confirmed: bool) -> bool:
    """Search for a minimum; return whether one was reached.

    Figures that have no solution where a round begins are left out of it: their penalty is constant and would hide the
    improvement of the others. Where other figures have solutions at the end than at the beginning, another round begins
    there.
    """
    places, converged = began, False
    for _ in range(MOST_ROUNDS):
        without = asked.outcome(places).unsolved
        places, converged = least_squares(
            lambda u, without=without: np.where(without, 0.0, asked.outcome(u).residuals),
            lambda u, without=without: np.where(without[:, None], 0.0, asked.slopes(u, 1 + confirmed)),
            places,
            MOST_STEPS,
            confirmed=confirmed,
        )
        if np.array_equal(asked.outcome(places).unsolved, without):
            break
    return converged


def _failed_start(began: Array, reason: str) -> Start:
    where = tuple(began.tolist())
    return Start("failed", reason, where, where, float("inf"))


def _calibration_of_starts(
    fit: Fit, answers: Mapping[int, Start], simulate: Simulate | None, jobs: int | None, interrupted: bool = False
) -> Calibration:
    """Return the answer from the results of the starts, by their numbers."""
    starts = [answers[number] for number in sorted(answers)]
    best = best_start(starts, sum(len(point.measured) for point in fit.fitted))
    if not np.isfinite(best.cost):
        reason = f"no start has a solution: {best.message} (change starts or bounds)"
        nothing = (None, None, 0, 0.0, (), (), {})
        return Calibration(fit, "failed", reason, tuple(starts), {}, *nothing, **_counts(starts))
    asked = Objective(fit, simulate)
    places, known = np.array(best.places), None
    shifts: tuple[InputShift, ...] = ()
    left_out: dict[str, str] = {}
    if not interrupted:
        if _search(asked, places, confirmed=True) and asked.best is not None:
            best = replace(best, status="ok", message="")
        assert asked.best is not None
        places = asked.best[1]
        best = replace(best, places=tuple(places.tolist()), cost=asked.best[0])
        slopes, off = asked.slopes(places), asked.outcome(places).known
        known = certainty(fit.parameters, places, slopes, off, apart=asked.apart(slopes), together=fit.together)
        if simulate is None:
            outcome, values = asked.outcome(places), asked.values(places)
            shifts, left_out = input_shifts(fit, places, slopes, outcome, values, jobs)
    outcome = asked.outcome(places)
    values = asked.values(places)
    compared, reasons, warned = _compared(asked, outcome, values)
    free = sum(not border for border in active_bounds(places))
    freedom = int(np.sum(~outcome.unsolved)) - free
    margin = _margin(free, outcome.chi_squared, freedom)
    as_good = tuple(i for i, one in enumerate(starts) if one.cost - best.cost <= margin and one.status != "failed")
    status = "interrupted" if interrupted else "failed" if outcome.reasons else "ok"
    message = _message(outcome, best, interrupted, len(starts))
    rest = (known, outcome.chi_squared, freedom, margin, as_good, compared, reasons)
    before = Objective(fit, simulate)
    hopeless = not interrupted and outcome.chi_squared > HOPELESS * max(freedom, 1)
    misread = _misread(before) if hopeless else ()
    more: dict[str, Any] = {**_counts((*starts, asked, before)), "methods": asked.methods, "warnings": warned}
    more |= {"shifts": shifts, "left_out": left_out, "misread": misread}
    return Calibration(fit, status, message, tuple(starts), values, *rest, **more)


def _misread(before: Objective) -> tuple[str, ...]:
    """Return which columns look like those of another unit, by the machine that the first start begins with."""
    fit = before.fit
    outcome = before.outcome(fit.places(fit.first_start()))
    numbers = (
        (name, measured, outcome.results[point.name].performance.get(name))
        for point in fit.fitted
        for name, measured in point.measured.items()
    )
    solved = ((name, measured, ours) for name, measured, ours in numbers if ours is not None)
    return misread_units(solved, fit.scene.operation.ambient_pressure)


def _counts(spent: Sequence[Start | Objective]) -> dict[str, Any]:
    return {name: sum(getattr(one, name) for one in spent) for name in ("solutions", "failed", "jacobians")}


def best_start(starts: Sequence[Start], count: int) -> Start:
    """Return the start that fits `count` figures best; the first of those that fit alike if they lie apart.

    A search ends within a few of its least gains of the least sum of squares, so that chance decides which of such ends
    is the lowest. Along a combination that the data do not determine they lie far apart. That holds for starts that
    ended in the same way, and for sums of squares without the penalty of a figure that has no solution.
    """
    least = min(starts, key=lambda start: start.cost)
    if not least.cost < PENALTY**2:  # nor infinity
        return least
    most = least.cost + SAME_FIT * max(1.0, least.cost / count)
    alike = [start for start in starts if start.cost <= most and start.status == least.status]
    spread = np.ptp([start.places for start in alike], axis=0)
    return alike[0] if np.max(spread, initial=0.0) > APART else least


def _margin(free: int, chi_squared: float, freedom: int) -> float:
    """Return the increase of chi² within which a fit counts as equally good."""
    from scipy.stats import chi2

    if free < 1:
        return 0.0
    return float(chi2.ppf(PROBABILITY, free)) * max(1.0, chi_squared / freedom if freedom > 0 else 1.0)


def _message(outcome: Residuals, best: Start, interrupted: bool, count: int) -> str:
    parts = [f"the best so far of {count} starts"] if interrupted else []
    if outcome.reasons:
        name, reason = next(iter(outcome.reasons.items()))
        parts.append(f"{len(outcome.reasons)} fitted points have no solution: {name}: {reason}")
    if best.status == "not converged":
        parts.append(f"the best start did not converge: {best.message}")
    return "; ".join(parts)


def _compared(
    asked: Objective, outcome: Residuals, values: dict[str, float]
) -> tuple[tuple[ComparedMeasurement, ...], dict[str, str], dict[str, tuple[str, ...]]]:
    """Return every measured figure beside the computed one, also at points not fitted, with reasons and warnings."""
    fitted, others = asked.fit.fitted, [point for point in asked.fit.points if not point.fitted]
    results = {**outcome.results, **{point.name: asked.solved(point, values) for point in others}}
    compared = (
        ComparedMeasurement(point, name, each, results[point.name].performance.get(name))
        for point in asked.fit.points
        for name, each in point.measured.items()
    )
    warned = {name: result.warnings for name, result in results.items() if result.warnings}
    return tuple(compared), reasons_of((*fitted, *others), results), warned
