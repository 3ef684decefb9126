"""Evaluation of one set of values: simulated at every operating point, weighted, checked against the bounds."""

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from screwsim.figures import Performance
from screwsim.figures.errors import error_in_unit
from screwsim.outputs import STATUSES, Result
from screwsim.results.table import Table
from screwsim.scene import Scene, lines, refrigerating_effect
from screwsim.scene.operation import SPEED
from screwsim.study.asked.goals import Goal
from screwsim.study.asked.spans import Span, read_spans
from screwsim.study.asked.varied import Varied, accuracy_of, value_at, with_values
from screwsim.study.optimize.points import OperatingPoint, OperatingPoints
from screwsim.study.optimize.question import Question
from screwsim.study.part_load import CONTROL_ENDS
from screwsim.study.pool.solving import Simulate, simulated_if_valid
from screwsim.study.seek import one_goal
from screwsim.study.seek.trials import Trials, size_of

LOAD_TOLERANCE = 5e-3  # of a part load: the standards measure at loads within some percent
LEAST_CONTROL, MOST_CONTROL = 0.05, 1.3  # of the full load's control, the first times the load: search range
NOT_SIMULATED = "not simulated, because another operating point has no result"


class Evaluation(NamedTuple):
    """Evaluation of a set of values: each aim and its error [SI], the excess over each bound; or why it failed.

    Of several operating points `at` is the one that failed.
    """

    aims: tuple[float, ...]
    errors: tuple[float, ...]
    excess: tuple[float, ...]
    failed: str = ""
    at: str = ""

    @property
    def feasible(self) -> bool:
        return not self.failed and all(excess <= 0.0 for excess in self.excess)


@dataclass(frozen=True)
class SimulatedPoint:
    """An operating point with the values that its load required, and its result."""

    point: OperatingPoint
    values: dict[str, Any]
    result: Result


def simulated(asked: Question, values: dict[str, float], simulate: Simulate) -> list[SimulatedPoint]:
    """Return every operating point of a set of values; after one that fails the others are not simulated."""
    machine, full = with_values(asked.scene, values), None
    found: list[SimulatedPoint] = []
    for point in asked.points.points:
        scene, own = with_values(machine, point.values), dict(point.values)
        if found and found[-1].result.status != "ok":
            found.append(SimulatedPoint(point, own, Result("failed", message=NOT_SIMULATED)))
            continue
        if point.load is None or full is None or not isinstance(scene, Scene):
            result = simulated_if_valid(scene, simulate)
        else:
            control, result = _part_load_result(scene, asked.points, point.load, full, simulate)
            own |= control
        if full is None and result.status == "ok" and point.load is not None:
            full = result, value_at(scene, asked.points.by)
            own |= {asked.points.by: full[1]}
        if result.status == "ok" and (lacks := result.lacks(asked.figures)):
            result = replace(result, status="failed", message="; ".join(lacks))
        found.append(SimulatedPoint(point, own, result))
    return found


def _part_load_result(
    scene: Scene, points: OperatingPoints, load: float, full: tuple[Result, float], simulate: Simulate
) -> tuple[dict[str, float], Result]:
    """Return the control and the result at a part load of the full one's capacity."""
    result, control = full
    capacity = result.performance[points.aim.load]
    low, high = _control_range(scene, points.by, control, load)
    start = load * control * result.performance.volumetric_cooling_capacity / _cooling(scene, result)
    if points.heating:
        start *= _less_work(scene, result)
    span = Span(points.by, low, high, min(max(start, low), high) if points.by == SPEED else control)
    goal = Goal(points.aim.load, load * capacity)
    trials = Trials(scene, (span,), (goal,), simulate, LOAD_TOLERANCE)
    met = one_goal.solve(trials)
    if met is None or met.result is None:
        why = (
            trials.reasons[0]
            if trials.reasons
            else f"{points.by} does not reduce it that far (give this point a larger load)"
        )
        return {}, Result("failed", message=f"the load of {load:.0%} is not reached: {why}")
    return trials.values(met.places), met.result


def _cooling(scene: Scene, full: Result) -> float:
    """Return the approximate cooling per volume of suction gas [J/m³] at other temperatures, from the full load.

    The refrigerating effect is the fluid's own; the density follows the suction pressure.
    """
    then = full.performance
    effect = then.cooling_capacity / then.gas_mass_flow
    here, at = refrigerating_effect(scene) or effect, lines(scene)
    density = at.p_s / at.T_s / (then.suction_pressure / then.suction_temperature)
    return float(then.volumetric_cooling_capacity * here / effect * density)


def _control_range(scene: Scene, by: str, control: float, load: float) -> tuple[float, float]:
    """Return the range of a control [SI] for a part load: from its full setting to its end, where that is larger."""
    _, end = CONTROL_ENDS.get(by, ("", None))
    if end is not None and end > control:
        return control, end
    if not control:
        (span,) = read_spans(scene, [by], ranged=False)
        return span.low, span.high
    low, high = sorted((LEAST_CONTROL * load * control, MOST_CONTROL * control))
    return low, high


def _less_work(scene: Scene, full: Result) -> float:
    """Return heating over cooling at full load over that here, approximately: work over cooling follows the lift."""
    then, here = full.performance, scene.operation
    colds = then.get("evaporating_temperature"), here.evaporating_temperature
    warms = then.get("condensing_temperature"), here.condensing_temperature
    lifts = [warm - cold for cold, warm in zip(colds, warms, strict=True) if cold is not None and warm is not None]
    if len(lifts) < 2:
        return 1.0
    work = then.heating_capacity / then.cooling_capacity - 1.0
    return float((1.0 + work) / (1.0 + work * lifts[1] / lifts[0]))


def evaluation_of(asked: Question, table: Table, row: int) -> Evaluation:
    """Return the evaluation from the rows of a table that begin at `row`, one per operating point."""
    rows = range(row, row + len(asked.points.points))
    bad = [each for each in rows if table.status[each] != STATUSES.index("ok")]
    nothing = (math.nan,) * len(asked.aims)
    if bad:
        texts, at = table.texts["message"], asked.points.points[bad[0] - row].name
        status = STATUSES[table.status[bad[0]]].replace("_", " ") + (f" at {at}" if at else "")
        why = f"{status}: {texts.words[texts.number[bad[0]]]}"
        return Evaluation(nothing, nothing, (math.nan,) * len(asked.bounds), why, at)
    found = {name: table.column("performance", name)[rows] for name in asked.figures}
    wide = {name: np.array([error_of(asked.scene, table, each, name) for each in rows]) for name in asked.figures}
    pairs = [weighted_mean(asked.points, aim.figure, found[aim.figure], wide[aim.figure]) for aim in asked.aims]
    excess = tuple(float(max(map(bound.excess, found[bound.figure]))) for bound in asked.bounds)  # at the worst point
    return Evaluation(tuple(value for value, _ in pairs), tuple(error for _, error in pairs), excess)


def weighted_mean(points: OperatingPoints, name: str, values: np.ndarray, errors: np.ndarray) -> tuple[float, float]:
    """Return a figure over the operating points, and its error; with energy weights a COP is heat over work.

    In each bin of a standard the COP is interpolated between its points.
    """
    weights = np.array([point.weight for point in points.points])
    if points.energy and name in points.cops:
        bins = np.array(points.bins) if points.bins else np.diag(weights)
        bins = bins[bins.any(axis=1)] / bins.sum()
        energy = bins.sum(axis=1)
        cop = bins @ values / energy
        total = 1.0 / float(energy @ (1.0 / cop))
        return total, float(total**2 * (1.0 / cop**2) @ bins @ errors)
    weights = weights / weights.sum()
    return float(weights @ values), float(weights @ errors)


def error_of(scene: Varied, table: Table, row: int, name: str) -> float:
    """Return the estimated error of a figure in its own unit; from the wanted accuracy where nothing is estimated."""
    about = {each.name: each for each in table.about}
    groups = ((each, float(table.column("performance", each)[row])) for each in about)
    known = Performance({each: None if math.isnan(value) else value for each, value in groups}, about)
    relative = float(table.column("error", name)[row])
    relative = accuracy_of(scene) if math.isnan(relative) else relative
    return error_in_unit(name, known, {name: relative}) or 0.0


def total_violation(asked: Question, evaluation: Evaluation) -> float:
    """Return the sum of all violations of bounds, over their sizes; 0 within all."""
    pairs = zip(evaluation.excess, asked.bounds, strict=True)
    return sum(max(excess, 0.0) / size_of(bound) for excess, bound in pairs)
