"""Closing a cycle, by fallbacks where it must be, and again more tightly until its figures are accurate enough."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from screwsim.cycle.close import again, close, fallbacks
from screwsim.cycle.continuation import Course
from screwsim.cycle.feedback import set_unknowns
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution, Led, Wanted
from screwsim.cycle.ways import way_of
from screwsim.effects.base import Separator
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.figures.errors import worst
from screwsim.model import speed
from screwsim.model.exchange import here, station
from screwsim.model.run import Machinery
from screwsim.model.slots import S_RHO, S_T
from screwsim.numerics.compiling import clock
from screwsim.outputs import Figures
from screwsim.solve.drive import settled
from screwsim.solve.estimate import estimated_errors
from screwsim.solve.finer import FINER

Array = np.ndarray
TIGHTER = 0.25  # least factor of tolerances and regularisation in the next try, where the estimate exceeds the accuracy
AIM = 0.6  # of the wanted accuracy, at which the next try aims
EASY = 0.4  # of the wanted accuracy: an estimate below it lets the next scene of a course begin less tight
LOOSER = 1.5  # by this factor, AIM over EASY: none of them is estimated above AIM then
TIGHTEST = 0.05  # factor of the tolerances with which a scene of a course may begin
AHEAD = 0.3  # of the bound on the balances, with which a cycle that gives a separator its oil may close early
TRIES = 7
NONE = np.zeros(4, np.int64)  # counts of a machinery that has done nothing


class Accurate(NamedTuple):
    """A closed cycle being read, the estimated error of its figures ({} where nothing is estimated), what both took.

    `counts` and times [s] are those of closing and of estimating, apart; `wanted` is what was asked last, `tightness`
    the factor of the tolerances with which the next scene of a course begins.
    """

    cycle: CycleSolution
    evaluation: Evaluation
    wanted: Wanted
    errors: Figures
    tightness: float
    counts: Array
    closing_time: float
    estimating_time: float


def solve(
    problem: Problem, machinery: Machinery, course: Course | None = None, given: CycleSolution | None = None
) -> Accurate:
    """Close the cycle, and again more tightly while the estimated error exceeds the wanted accuracy.

    Nothing is estimated of a cycle that did not close, that a check closed, or where the scene says
    `numerics.error: none`. A course lends its guess; that the cycle is noted there is its owner's to see to. A cycle
    that is `given` is closed already.
    """
    numerics, watch = problem.scene.numerics, Watch(machinery)
    tightness = 1.0 if course is None else course.tightness
    wanted = asked_for(problem, tightness)
    if given is None:
        cycle = settled(problem, machinery, wanted, _close_somehow(problem, machinery, wanted, course))
    else:
        cycle = given
        machinery.put(given.trajectory)
    station()
    of, errors, largest = evaluate(problem, cycle), Figures(), 0.0
    watch.lap("closing")
    for attempt in range(TRIES):
        if not cycle.closed or wanted.check or not numerics.estimates:
            break
        errors, on = estimated_errors(of, machinery, wanted, cycle)
        largest = worst(errors)[1]
        watch.lap("estimating")
        if largest <= numerics.accuracy or numerics.rtol is not None or attempt == TRIES - 1:
            break
        finer = on if isinstance(on, CycleSolution) and problem.parts.shaft is None else None
        factor = max(TIGHTER, AIM * numerics.accuracy / largest) if finer is None else FINER
        tightness, wanted = tightness * factor, wanted.tighter(factor)
        led = on if isinstance(on, Led) else None
        tighter = finer or _tighter(problem, machinery, wanted, cycle, led=led)  # a search is dear: its cycle is taken
        watch.lap("closing")
        if not tighter.closed:
            break
        cycle, of = tighter, evaluate(problem, tighter)
    if largest < EASY * numerics.accuracy:
        tightness = min(1.0, LOOSER * tightness)
    tightness = max(tightness, TIGHTEST)
    times, counts = watch.times, watch.counts["closing"]
    return Accurate(cycle, of, wanted, errors, tightness, counts, times["closing"], times["estimating"])


def asked_for(problem: Problem, tightness: float) -> Wanted:
    """Return what is wanted of a problem's cycle, with tolerances times a factor.

    What its energy balance leaves open an oil's circuit does, too, over the shaft's power: less than the sum of flows.
    """
    wanted = problem.wanted if tightness == 1.0 else problem.wanted.tighter(tightness)
    separates = problem.parts.all(Separator)
    return replace(wanted, ahead=AHEAD, bound=tightness * wanted.bound) if separates else wanted


def solve_tighter(machinery: Machinery, accurate: Accurate) -> Accurate:
    """Close a closed cycle once more, with finer tolerances; the old one stays where that fails.

    It begins with what the last turn made of the lines: a cycle may close while that is far from what the turn met,
    where next to nothing flows back, and every first turn would do so again.
    """
    watch, of, problem = Watch(machinery), accurate.evaluation, accurate.evaluation.problem
    wanted = accurate.wanted.tighter(TIGHTER)
    cycle = _tighter(problem, machinery, wanted, accurate.cycle, problem.entries.possible(of.image))
    watch.lap("closing")
    counts, spent = accurate.counts + watch.counts["closing"], accurate.closing_time + watch.times["closing"]
    accurate = accurate._replace(counts=counts, closing_time=spent)
    if not cycle.closed:
        return accurate
    return accurate._replace(cycle=cycle, evaluation=evaluate(problem, cycle), wanted=wanted)


def _tighter(
    problem: Problem,
    machinery: Machinery,
    wanted: Wanted,
    cycle: CycleSolution,
    made: Array | None = None,
    led: Led | None = None,
) -> CycleSolution:
    """Return a closed cycle closed again, with its drive; from what it `made` of the unknowns, where that is given.

    Or from where its finer lives have `led`, on which the machinery stands.
    """
    if led is None:
        machinery.put(cycle.trajectory)
    if made is not None:
        set_unknowns(problem, machinery, made)
    return settled(problem, machinery, wanted, again(problem, machinery, wanted, cycle, led))


def _close_somehow(problem: Problem, machinery: Machinery, wanted: Wanted, course: Course | None) -> CycleSolution:
    """Close the cycle; by fallbacks where the first way does not close it and the scene leaves the way to us.

    A gas outside its equation stays there, whatever is tried. What nothing closes is left as the first way left it.
    """
    cycle = close(problem, machinery, wanted, course)
    if cycle.closed or wanted.check or not wanted.fallbacks or _outside(problem, cycle):
        return cycle
    for name, attempt in fallbacks(problem, machinery, wanted, cycle.change):
        better = attempt()
        if better.closed:
            return better if better.needed else replace(better, needed=name)
    return cycle


def _outside(problem: Problem, cycle: CycleSolution) -> bool:
    """Tell whether the state where closing stopped, or the cycle that it left, is outside the gas's equation.

    That of any chamber where all stopped in their first pitch, with which every further try begins as well.
    """
    gas, c = problem.parts.gas, problem.composition
    if cycle.failed:
        stopped = way_of(cycle).stopped(cycle, len(c.states), c.chambers)
        return any(gas.why_outside(float(y[S_T]), float(y[S_RHO])) is not None for y in stopped)
    return gas.first_outside(*cycle.trajectory.ends) is not None


def note(course: Course, of: Evaluation, cycle: CycleSolution, wanted: Wanted, tightness: float) -> None:
    """Leave a closed cycle to the problems that follow on a course.

    What the cycle makes goes as the last turn made it: one that closes at once would hand on what it was given, and
    errors of guesses would add up along the course.
    """
    curve = speed.curve_at(of.life.composition) if cycle.speed_curve is None else cycle.speed_curve
    made = np.concatenate([of.problem.entries.possible(of.image), curve])
    course.add(cycle, of.problem.parameters, made, way_of(cycle).share(cycle, wanted), tightness)


class Watch:
    """Time and counts of one machinery by what they were spent on; compilation does not count."""

    def __init__(self, machinery: Machinery) -> None:
        self.machinery, self.started = machinery, _now(machinery)
        self.times = {"closing": 0.0, "estimating": 0.0}
        self.counts: dict[str, Array] = dict.fromkeys(self.times, NONE)

    def lap(self, name: str) -> None:
        """Add what was spent since the last lap."""
        (then, before), self.started = self.started, _now(self.machinery)
        self.times[name] += self.started[0] - then
        self.counts[name] = self.counts[name] + self.started[1] - before


def _now(machinery: Machinery) -> tuple[float, Array]:
    now = clock() - machinery.compile_time - here.elsewhere
    return now, machinery.counts.copy()
