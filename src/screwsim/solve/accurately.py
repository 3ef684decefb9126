"""Close a cycle, by fallbacks where necessary, and again more tightly until its figures are accurate enough."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from screwsim.cycle.close import close, close_again, fallbacks
from screwsim.cycle.continuation import Course
from screwsim.cycle.feedback import set_unknowns
from screwsim.cycle.linear_pitch import Tangents
from screwsim.cycle.problem import ClosingTask, Problem
from screwsim.cycle.solution import ClosingCriteria, CorrectedState, CycleSolution
from screwsim.cycle.ways import way_of
from screwsim.effects.base import Separator
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.figures.errors import worst
from screwsim.model import speed
from screwsim.model.run import Machinery
from screwsim.model.slots import S_RHO, S_T
from screwsim.model.turn_scheduler import reach_station, scheduler
from screwsim.numerics.compiling import clock
from screwsim.outputs import Figures
from screwsim.solve.drive import close_with_drive
from screwsim.solve.estimate import estimated_errors
from screwsim.solve.estimate_protocol import FINER

Array = np.ndarray
TIGHTER = 0.25  # smallest factor on tolerances and regularisation from one try to the next
AIM = 0.6  # estimate, over the wanted accuracy, at which the next try aims
EASILY_REACHED = 0.4  # the same, below which the next scene of a course starts less tight ...
LOOSER = 1.5  # ... by this factor, AIM over `EASILY_REACHED`, so that no estimate exceeds AIM
TIGHTEST = 0.05  # smallest factor on the tolerances with which a scene of a course starts
EARLY_SHARE = 0.3  # share of the bound on the balances within which a cycle with an oil separator may close early
TRIES = 7  # closings of one cycle, at most
NO_COUNTS = np.zeros(4, np.int64)  # counts before any integration


class Cost(NamedTuple):
    """The counts of closing, and the times [s] of closing and of estimating."""

    counts: Array = NO_COUNTS
    closing: float = 0.0
    estimating: float = 0.0

    def plus(self, other: "Cost") -> "Cost":
        """Return the sum."""
        closing, estimating = self.closing + other.closing, self.estimating + other.estimating
        return Cost(self.counts + other.counts, closing, estimating)


class Accurate(NamedTuple):
    """A closed cycle with its evaluation, the estimated errors of its figures ({}: not estimated), and their cost.

    `criteria` are the last criteria, `tightness` is the factor on the tolerances with which the next scene of a course
    starts, `tangents` the linearisation that the last estimate made or used (None: none).
    """

    cycle: CycleSolution
    evaluation: Evaluation
    criteria: ClosingCriteria
    errors: Figures
    tightness: float
    cost: Cost
    tangents: Tangents | None = None


def solve(
    problem: Problem, machinery: Machinery, course: Course | None = None, given: CycleSolution | None = None
) -> Accurate:
    """Close the cycle, and again more tightly while the estimated error exceeds the wanted accuracy.

    Nothing is estimated for a cycle that did not close, that a check closed, or where the scene says
    `numerics.error: none`. A course provides the guess; recording the cycle there is left to the caller. A cycle
    that is `given` is closed already, or is what closing from this course left open: then only fallbacks are tried.
    """
    numerics, watch = problem.scene.numerics, CostMeter(machinery)
    tightness = 1.0 if course is None else course.tightness
    lent = None if course is None else course.finer_for(problem.composition)
    criteria = criteria_of(problem, tightness)
    if given is not None:
        machinery.put(given.trajectory)
    if given is not None and given.closed:
        cycle = given
    else:
        task = ClosingTask(problem, machinery, criteria)
        cycle = close_with_drive(task, _close_with_fallbacks(task, course, given))
    reach_station()
    of, errors, largest = evaluate(problem, cycle), Figures(), 0.0
    watch.lap()
    for attempt in range(TRIES):
        if not cycle.closed or criteria.check or not numerics.estimates:
            break
        found = estimated_errors(of, machinery, criteria, cycle, lent)
        errors, on, lent = found.errors, found.on, found.tangents or lent
        largest = worst(errors)[1]
        watch.lap(estimating=True)
        if largest <= numerics.accuracy or numerics.rtol is not None or attempt == TRIES - 1:
            break
        finer = on if isinstance(on, CycleSolution) and problem.parts.shaft is None else None
        factor = max(TIGHTER, AIM * numerics.accuracy / largest) if finer is None else FINER
        tightness, criteria = tightness * factor, criteria.tighter(factor)
        led = on if isinstance(on, CorrectedState) else None
        task = ClosingTask(problem, machinery, criteria)
        tighter = finer or _tighter(task, cycle, led=led)  # a search is costly: keep its cycle
        watch.lap()
        if not tighter.closed:
            break
        cycle, of = tighter, evaluate(problem, tighter)
    if largest < EASILY_REACHED * numerics.accuracy:
        tightness = min(1.0, LOOSER * tightness)
    return Accurate(cycle, of, criteria, errors, max(tightness, TIGHTEST), watch.cost, lent)


def criteria_of(problem: Problem, tightness: float) -> ClosingCriteria:
    """Return the closing criteria of a problem, with tolerances multiplied by a factor.

    With an oil separator the bound on the balances is tightened too: an open energy balance opens the oil's
    circuit, relative to the shaft power, which is less than the sum of flows.
    """
    criteria = problem.criteria if tightness == 1.0 else problem.criteria.tighter(tightness)
    separates = problem.parts.all(Separator)
    return replace(criteria, ahead=EARLY_SHARE, bound=tightness * criteria.bound) if separates else criteria


def solve_tighter(machinery: Machinery, accurate: Accurate) -> Accurate:
    """Close a closed cycle once more with finer tolerances; return the old one, with the added cost, where that fails.

    It starts from the last turn's next values of the lines: where next to nothing flows back, a cycle may close
    while these are far from the values that the turn was integrated with, and every first turn would do so again.
    """
    watch, of, problem = CostMeter(machinery), accurate.evaluation, accurate.evaluation.problem
    task = ClosingTask(problem, machinery, accurate.criteria.tighter(TIGHTER))
    cycle = _tighter(task, accurate.cycle, problem.entries.possible(of.image))
    watch.lap()
    accurate = accurate._replace(cost=accurate.cost.plus(watch.cost))
    if not cycle.closed:
        return accurate
    return accurate._replace(cycle=cycle, evaluation=evaluate(problem, cycle), criteria=task.criteria)


def _tighter(
    task: ClosingTask, cycle: CycleSolution, unknowns_out: Array | None = None, led: CorrectedState | None = None
) -> CycleSolution:
    """Close a closed cycle again, together with its drive.

    It starts from `unknowns_out`, if given, or from where its finer lives have `led`, which the machinery then
    holds.
    """
    if led is None:
        task.machinery.put(cycle.trajectory)
    if unknowns_out is not None:
        set_unknowns(task.problem, task.machinery, unknowns_out)
    return close_with_drive(task, close_again(task, cycle, led))


def _close_with_fallbacks(task: ClosingTask, course: Course | None, left_open: CycleSolution | None) -> CycleSolution:
    """Close the cycle, by fallbacks where the first way fails, or has `left_open` a cycle, and the scene allows them.

    A gas outside its equation of state stays there, so nothing further is tried. Where no fallback closes the
    cycle, the first way's result is returned.
    """
    cycle, criteria = left_open or close(task, course), task.criteria
    if cycle.closed or criteria.check or not criteria.fallbacks or _outside_gas_range(task.problem, cycle):
        return cycle
    for name, attempt in fallbacks(task, cycle.change):
        better = attempt()
        if better.closed:
            return better if better.needed else replace(better, needed=name)
    return cycle


def _outside_gas_range(problem: Problem, cycle: CycleSolution) -> bool:
    """Return whether closing stopped at, or left a cycle with, a state outside the gas's equation of state.

    If all chambers stopped in their first pitch, the state of any of them counts: every fallback starts there too.
    Otherwise that of the first one does.
    """
    gas, c = problem.parts.gas, problem.composition
    if cycle.failed:
        stopped = cycle.y.reshape(-1, len(c.states))[: None if cycle.turns * c.chambers <= 1.0 else 1]
        return any(gas.why_outside(float(y[S_T]), float(y[S_RHO])) is not None for y in stopped)
    return gas.first_outside(*cycle.trajectory.ends) is not None


def record_in_course(
    course: Course, of: Evaluation, cycle: CycleSolution, criteria: ClosingCriteria, tightness: float
) -> None:
    """Record a closed cycle for the following problems of a course.

    The unknowns are recorded as the last turn's next values: those it was integrated with may be a guess
    themselves, and the errors of guesses would add up along the course.
    """
    curve = speed.curve_at(of.life.composition) if cycle.speed_curve is None else cycle.speed_curve
    unknowns_out = np.concatenate([of.problem.entries.possible(of.image), curve])
    course.add(cycle, of.problem.parameters, unknowns_out, way_of(cycle).share(cycle, criteria), tightness)


class CostMeter:
    """The cost of what one machinery has done since it is metered; compilation is excluded."""

    def __init__(self, machinery: Machinery) -> None:
        self.machinery, self.started, self.cost = machinery, _now(machinery), Cost()

    def lap(self, estimating: bool = False) -> None:
        """Add what was spent since the last lap: on closing, or on estimating."""
        (then, before), self.started = self.started, _now(self.machinery)
        time, counts = self.started[0] - then, self.started[1] - before
        self.cost = self.cost.plus(Cost(estimating=time) if estimating else Cost(counts, time))


def _now(machinery: Machinery) -> tuple[float, Array]:
    """Return the time [s] without compilation, and the counts so far."""
    now = clock() - machinery.compile_time - scheduler.elsewhere
    return now, machinery.counts.copy()
