"""Surroundings that follow from the cycle: the temperatures of the oil's circuit (M284) and a package's losses (M343).

A cycle is closed with given temperatures of oil supply and separator and given pressure losses; its flows into the
separator then imply other values (`evaluate.separator`). Broyden's method makes the two agree (`surroundings_steps`),
starting from the Jacobian of the circuit's own heat capacities or from that of the point before, and learns the
chambers' response. Every cycle starts from the one before and is closed only as accurately as the next step needs. The
last one is closed as accurately as the scene asks, with its errors estimated; it is repeated where the surroundings do
not agree so well.
"""

from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from screwsim.build import Temperatures, open_temperatures, open_values, temperature_faults, with_temperatures
from screwsim.cycle.close import close
from screwsim.cycle.continuation import Course
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import ClosingTask, Problem, Series, problem_of
from screwsim.cycle.solution import ClosingCriteria, CycleSolution
from screwsim.cycle.surroundings import FIRST_OPEN, KnownSurroundings
from screwsim.effects.base import PressureLosses
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.figures.errors import worst
from screwsim.inputs.faults import UsageError
from screwsim.model import leases
from screwsim.model.run import Machinery
from screwsim.outputs import Figures
from screwsim.outputs.variables import NOT_CLOSED
from screwsim.solve.accurately import AIM, TIGHTEST, Accurate, Cost, CostMeter, criteria_of, record_in_course, solve
from screwsim.solve.drive import at_motor_speed, close_with_drive
from screwsim.solve.surroundings import (
    KPA,
    ImpliedSurroundings,
    implied_surroundings,
    stated_numbers,
    surroundings_follow,
    unknowns_of,
)
from screwsim.solve.surroundings_errors import LearntResponse, Seen, errors_with_unknowns
from screwsim.solve.surroundings_steps import LONGEST_STEP, BroydenSteps, started_jacobian

Array = np.ndarray
MOST_CYCLES = 20  # cycles of one search
MOST_REPETITIONS = 8  # repetitions of the final cycle
OPEN = 0.2  # of the wanted accuracy: admissible residual of the circuit over the shaft power, or of a pressure
NOISE = 2.0  # error of a cycle's residuals over the larger of its last turn's change and its open balances
HALVINGS = 6  # of a step to impossible oil or effects, or to where no cycle closes or one implies nothing
WARMER_STARTS = (15.0, 30.0, 50.0)  # [K] above the first guess, tried where no cycle closes with that
CONTRACTION = 0.1  # expected ratio of the residual after a step to that before ...
LEARNT_CONTRACTION = 0.01  # ... the same with the Jacobian of the point before ...
ROUGH_TOLERANCE = 0.05  # ... and tolerance on changes, over the expected residual, with which the next cycle is closed
ROUGHEST_RTOL = 1e-3  # largest tolerance of a step in such a cycle; looser ones may diverge
LARGEST_LOSS = 0.98  # largest pressure loss before the machine, over the suction pressure


@dataclass
class SurroundingsSearch:
    """The search, on a course of its own: Broyden's steps, what was learnt for errors, and the cycles closed for it."""

    series: Series
    stated: float  # [rad/s], the stated speed
    course: Course = field(default_factory=Course)
    cost: Cost = field(default_factory=Cost)  # of closing the cycles
    why: str = ""  # why it ended without a solution
    steps: BroydenSteps = field(default_factory=BroydenSteps)
    learnt: LearntResponse = field(default_factory=LearntResponse)
    noise: float = 0.0  # error of the last cycle's residuals over the shaft power
    expected: float = FIRST_OPEN  # residual of the next cycle
    contracts: float = CONTRACTION  # expected ratio of residuals over a step
    cycle: CycleSolution | None = None  # the last cycle; None where it was closed less tightly than the scene asks
    left_open: tuple[Problem, CycleSolution] | None = None  # the last that closing as asked left open, and its problem

    def step(self, x: Array, asked: ImpliedSurroundings) -> Array:
        """Return the next change of the unknowns [K, kPa] from x."""
        return self.steps.step(x, asked, self._error_of(asked))

    def learn(self, of: Evaluation, x: Array, asked: ImpliedSurroundings) -> Array:
        """Record a cycle; return the response of the residuals to the unknowns, as it is then known."""
        known, jacobian = self.known, self.steps.jacobian
        started = started_jacobian(asked) if jacobian is None else jacobian
        known.slopes = self.learnt.add(of, Seen(x, asked.off, self._error_of(asked), of.figures), started, known.slopes)
        return self.learnt.response

    def _error_of(self, asked: ImpliedSurroundings) -> float:
        """Return the error [K, kPa] of what the last cycle implies, since it is not closed better."""
        return self.noise * float(np.max(np.abs(asked.off))) / asked.open if asked.open > 0.0 else 0.0

    @property
    def known(self) -> KnownSurroundings:
        """What the series knows of its surroundings."""
        return self.series.surroundings

    def closed(self, problem: Problem, course: Course) -> Evaluation | None:
        """Return a problem's closed cycle, started from a course; None where it does not close."""
        machinery = lease_for(problem)
        watch, asked = CostMeter(machinery), criteria_of(problem, self.course.tightness)
        criteria = _rough_criteria(asked, self.expected)
        task = ClosingTask(problem, machinery, criteria)
        first = close(task, course)
        if criteria is asked and course is self.course and first.status == NOT_CLOSED:
            self.left_open = problem, first
        cycle = close_with_drive(task, first)
        watch.lap()
        self.cost = self.cost.plus(watch.cost)
        leases.give_back(machinery)
        of = evaluate(problem, cycle)
        if not cycle.closed:
            return None
        self.cycle = cycle if criteria is asked else None
        self.judge(cycle, criteria)
        record_in_course(self.course, of, cycle, criteria, self.course.tightness)
        return of

    def judge(self, cycle: CycleSolution, criteria: ClosingCriteria) -> None:
        """Estimate the noise of what this cycle shows from its last change and its open balance."""
        self.noise = NOISE * max(cycle.change, cycle.residual * criteria.bound)

    def known_open(self, problem: Problem) -> CycleSolution | None:
        """Return what closing this problem as asked has left open; None where it is not known."""
        if self.left_open is None or self.left_open[0] is not problem:
            return None
        return self.left_open[1]

    def closed_as_asked(self, of: Evaluation) -> Evaluation | None:
        """Return a cycle closed as accurately as asked; None where it was closed so, or does not close."""
        if self.cycle is not None:
            return None
        self.expected = 0.0
        return self.closed(of.problem, self.course)

    def posed(self, problem: Problem, x: Array) -> Problem | None:
        """Return the problem at unknowns x; None, with the reason in `why`, where oil or effects rule it out."""
        scene = problem.scene
        if any(open_temperatures(scene)):
            self.known.temperatures = Temperatures(*x[:2].tolist())
            scene = with_temperatures(scene, self.known.temperatures)
            faults = temperature_faults(scene)
            if faults:
                self.why = f"the oil circuit leads to an impossible state: {faults[0]}"
                return None
        lost, others = (2 if scene.losses is not None else 0), x[2:].tolist()
        if len(others) > lost:
            self.known.sought = open_numbers = others[lost:]
            scene = open_values.with_coordinates(scene, open_numbers)
        if scene.losses is not None:
            before, behind = (KPA * each for each in others[:lost])
            if not before < LARGEST_LOSS * problem.lines.p_s:
                self.why = (
                    "the pressure losses before the machine use up the whole suction pressure (choose smaller losses)"
                )
                return None
            if not problem.lines.p_d - scene.losses.behind + behind > 0.0:
                self.why = "the pressure losses behind the machine lead below a vacuum (choose smaller losses)"
                return None
            self.known.losses = PressureLosses(max(before, 0.0), behind)
            scene = replace(scene, losses=self.known.losses)
        part = problem.parts.shaft
        held = part is None or part.train(self.stated).holds_mean
        return at_motor_speed(problem_of(scene, self.series, None if held else self.stated), self.series)

    def next(self, of: Evaluation, asked: ImpliedSurroundings) -> Evaluation | None:
        """Return the cycle at the next unknowns; None, with the reason in `why`, where none is found.

        A step to a cycle that implies nothing, as one without net flow, is halved, too.
        """
        x, undefined = unknowns_of(of.problem), None
        self.learn(of, x, asked)
        step = self.step(x, asked)
        for _ in range(HALVINGS):
            problem = self.posed(of.problem, x + step)
            found = None if problem is None else self.closed(problem, self.course)
            if found is not None:
                self.why = ""
                if implied_surroundings(found) is not None:
                    return found
            undefined = found or undefined
            step = 0.5 * step
        return undefined


def _rough_criteria(criteria: ClosingCriteria, open_: float) -> ClosingCriteria:
    """Return criteria for a cycle whose surroundings will leave the residual `open_`; unchanged where too small."""
    tolerance, bound = ROUGH_TOLERANCE * open_, CONTRACTION * open_
    if criteria.check or tolerance <= criteria.tolerance:
        return criteria
    rtol = min(tolerance * criteria.rtol / criteria.tolerance, max(ROUGHEST_RTOL, criteria.rtol))
    return replace(criteria, rtol=rtol, tolerance=tolerance, bound=max(bound, criteria.bound), histories_factor=1.0)


def _first_cycle(search: SurroundingsSearch, problem: Problem, expected: Array | None) -> Evaluation | None:
    """Return a first closed cycle: with expected unknowns, those of the problem, or warmer oil; None if none closes."""
    course, guess, known = search.series.course, unknowns_of(problem), search.known
    if expected is not None and float(np.max(np.abs(expected - guess))) <= LONGEST_STEP:
        last = known.temperatures, known.losses, known.sought
        with suppress(UsageError):  # the trend may lead to no state of the gas
            posed = search.posed(problem, expected)
            of = None if posed is None else search.closed(posed, course)
            if of is not None:
                return of
        known.temperatures, known.losses, known.sought = last
        search.why = ""
    of = search.closed(problem, course)
    for warmer in WARMER_STARTS if any(open_temperatures(problem.scene)) else ():
        if of is not None:
            break
        other = search.posed(problem, guess + warmer * (np.arange(len(guess)) < 2))
        of = None if other is None else search.closed(other, course)
    return of if of is None or implied_surroundings(of) is not None else _cautious_cycle(search, of) or of


def _cautious_cycle(search: SurroundingsSearch, of: Evaluation) -> Evaluation | None:
    """Return a cycle with cautious guesses of the open numbers, instead of one that implies nothing (no net flow)."""
    x, cautious = unknowns_of(of.problem), open_values.cautious_coordinates(of.problem.scene)
    if not cautious:
        return None
    x[len(x) - len(cautious) :] = cautious
    posed = search.posed(of.problem, x)
    return None if posed is None else search.closed(posed, search.series.course)


def steady_state(problem: Problem, series: Series) -> tuple[Problem, SurroundingsSearch | None]:
    """Return the problem at its mean speed and surroundings, and the search that found these (None: no search)."""
    if not surroundings_follow(problem):
        return at_motor_speed(problem, series), None
    search = SurroundingsSearch(series, problem.scene.operation.speed)
    search.course.adopt(series.course)
    problem = at_motor_speed(problem, series)
    known, stated = search.known, stated_numbers(problem)
    known.begin(len(unknowns_of(problem)))
    search.steps.jacobian, search.expected = known.around
    search.contracts = CONTRACTION if search.steps.jacobian is None else LEARNT_CONTRACTION
    of = _first_cycle(search, problem, known.expected(stated))
    if of is None:
        return problem, search
    first: ImpliedSurroundings | None = None
    for _ in range(MOST_CYCLES):
        asked = implied_surroundings(of)
        if asked is None:
            closed = search.closed_as_asked(of)
            if closed is None:
                break
            of = closed
            continue
        first = first or asked
        enough = asked.open <= OPEN * of.problem.scene.numerics.accuracy
        if enough and search.cycle is not None:
            break
        search.expected = 0.0 if enough else search.contracts * asked.open
        after = search.next(of, asked)
        if after is None:
            break
        of = after
    if first is not None:
        known.around = search.steps.jacobian, first.open
        known.add(stated, stated_numbers(of.problem), unknowns_of(of.problem))
    return of.problem, search


def solve_with_surroundings(
    problem: Problem, machinery: Machinery, course: Course | None, search: SurroundingsSearch | None
) -> Accurate:
    """Return the cycle solved as accurately as asked, with surroundings that agree as well.

    The cost of the search counts as closing. Errors of the unknowns are added to those of the figures.
    """
    if search is None:
        return solve(problem, machinery, course)
    accurate = solve(problem, machinery, search.course, search.cycle or search.known_open(problem))
    errors, tightness, cost = _with_unknowns(accurate, search), 1.0, search.cost
    for _ in range(MOST_REPETITIONS):
        asked = implied_surroundings(accurate.evaluation)
        at_rest, size = _finality_and_error(accurate, asked, errors)
        if at_rest or asked is None:
            break
        x = unknowns_of(accurate.evaluation.problem)
        tightness = min(tightness, accurate.tightness * min(1.0, AIM / size))  # looser balances would mislead
        record_in_course(
            search.course, accurate.evaluation, accurate.cycle, accurate.criteria, max(tightness, TIGHTEST)
        )
        search.course.keep_finer(accurate.tangents, accurate.evaluation.life.composition)
        other = search.posed(accurate.evaluation.problem, x + search.step(x, asked))
        if other is None:
            break
        cost = cost.plus(accurate.cost)
        machinery.begin(other.composition)
        accurate = solve(other, machinery, search.course)
        errors = _with_unknowns(accurate, search)
    return accurate._replace(errors=errors, cost=cost.plus(accurate.cost))


def _finality_and_error(accurate: Accurate, asked: ImpliedSurroundings | None, errors: Figures) -> tuple[bool, float]:
    """Return whether a cycle's unknowns are final, and the largest error over the wanted accuracy."""
    accuracy = accurate.evaluation.problem.scene.numerics.accuracy
    size = worst(errors)[1] / accuracy
    if asked is None or not accurate.cycle.closed:
        return True, size
    fixed = accurate.evaluation.problem.scene.numerics.rtol is not None
    return asked.open <= OPEN * accuracy and (size <= 1.0 or fixed), max(size, AIM)


def _with_unknowns(accurate: Accurate, search: SurroundingsSearch) -> Figures:
    """Return the errors of the figures including those due to errors of the unknowns.

    Sensitivities are learnt over the last step of the search, too: within an earlier one figures may turn or begin (gas
    that flashes). With little oil flow, temperatures that leave next to no residual of the shaft power may be far off.
    """
    of, errors = accurate.evaluation, Figures(accurate.errors)
    asked = implied_surroundings(of)
    if asked is None or search.why or not errors:
        return errors
    search.judge(accurate.cycle, accurate.criteria)
    response = search.learn(of, unknowns_of(of.problem), asked)
    return errors_with_unknowns(of, errors, asked.off, response, search.known.slopes)
