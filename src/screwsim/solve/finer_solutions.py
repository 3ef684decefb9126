"""Finer solutions for error estimates: lives that follow a closed cycle, or the cycle closed once more.

Source: docs/model.md M41; docs/explanation/errors.md.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from screwsim.cycle.balances import meets_line_at_angle, streams_of
from screwsim.cycle.close import MOST_OF_A_TRY, close_again
from screwsim.cycle.coordinates import WEIGHT
from screwsim.cycle.feedback import set_unknowns, unknowns
from screwsim.cycle.newton import Correction, Corrections, corrected_start
from screwsim.cycle.problem import ClosingTask, Problem
from screwsim.cycle.relaxation import SLOW_CONTRACTION, along
from screwsim.cycle.search import FALLBACK_NAME
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.solution import CorrectedState, CycleSolution
from screwsim.cycle.ways import way_of
from screwsim.evaluate.evaluation import Evaluation, evaluate, evaluate_life
from screwsim.figures.errors import relative_errors, worst
from screwsim.model import slots
from screwsim.model.all_chambers import inject
from screwsim.model.slices import INSIDE
from screwsim.model.turn_scheduler import reach_station
from screwsim.outputs import Figures
from screwsim.solve.estimate_protocol import FINER, NO_SOLUTIONS, EstimateRequest, FinerSolutions
from screwsim.solve.swings import Solution, solution_of

Array = np.ndarray
TWO_LIVES_BELOW = 1e-4  # wanted accuracy up to which two lives estimate
LEAKAGE_DOMINATES = 0.75  # volumetric efficiency below which leaks dominate, and two lives estimate
QUICK_CONVERGENCE = 0.7  # ratio of successive lives' changes below which two lives determine the limit
LAST_CHANGE = 0.05  # of the wanted accuracy: change of the last life below which no more are needed
RELIABLE_CORRECTION = 0.15  # relative error of the corrections in closing, below which one replaces the second life
LEAST_DELIVERY = 0.2  # volumetric efficiency above which it may do so: with less delivered, leaks hide larger errors
TOGETHER_FACTOR = 0.05  # factor on the tolerance on changes when chambers are closed together beside a closed cycle
SHIFT = 10.0  # wanted accuracies by which gas and oil are moved before chambers of a leaky machine are closed again ...
SHIFTED_BELOW = 0.3  # ... that delivers less than this volumetric efficiency: pitches change next to nothing there
LINEARITY_ERROR = 0.1  # share of such a correction that is assumed to be wrong, at least


def finer_lives(request: EstimateRequest) -> FinerSolutions:
    """Return one or two further lives, finer than the closed cycle's; `NO_SOLUTIONS` where one stops.

    It applies to cycles closed by waveform relaxation. One life suffices unless errors feed back. Then there are
    two: the first is moved to its limit by the tangents that closed the cycle, or by those of an estimate nearby.
    Without any, or where the latter leave much, the second is moved by new tangents, for a third, if the two lives'
    changes hardly shrink.
    """
    cycle = request.cycle
    if cycle.needed or way_of(cycle).whole:
        return NO_SOLUTIONS
    if not (_errors_feed_back(request) or _slow_by_own_tangents(request)):
        return _next_life(request)
    lives = _Lives(request)
    if not lives.next():
        return NO_SOLUTIONS
    corrected = lives.corrections.begun and lives.correct()
    if lives.correction is not None and not lives.lent and _correction_suffices(request):
        return lives.foretold(lives.correction, max(LINEARITY_ERROR, cycle.missed))
    if not lives.next():
        return NO_SOLUTIONS
    if corrected and lives.lent and lives.left() > SLOW_CONTRACTION:
        lives.drop_lent()
        corrected = False
    if not corrected and lives.repeated() > SLOW_CONTRACTION and lives.correct():
        corrected = lives.next()
        if not corrected:
            return NO_SOLUTIONS
    if not corrected:
        return lives.read(FinerSolutions(lives.solutions))
    to_come, flow = lives.to_come()
    return lives.read(FinerSolutions(lives.solutions, left=lives.left(), flow=flow, to_come=to_come))


def repeated_share(steps: Sequence[Figures]) -> float:
    """Return the ratio of the last change to the one before."""
    before, last = (worst(step)[1] for step in steps[-2:])
    return last / before if before > 0.0 else 0.0


def _errors_feed_back(request: EstimateRequest) -> bool:
    """Return whether one finer life is not enough because errors feed back through what it still takes from the cycle.

    These are the coarser lives of its neighbours, unknowns beyond the discharge line, and its own initial state
    where much of that persists: with a single chamber, reeds, an oil amount that only flows determine, or films
    between chambers.
    """
    accurate = request.problem.scene.numerics.accuracy <= TWO_LIVES_BELOW
    return accurate or request.filling < LEAKAGE_DOMINATES or _inherits_more(request.problem)


def _inherits_more(problem: Problem) -> bool:
    """Return whether a life inherits more from the one before than the states of gas and its oil."""
    parts, c = problem.parts, problem.composition
    if parts.made or parts.suction_line or any(parts.films):
        return True
    displaced = c.carried and parts.oil is not None and "ratio" not in parts.oil.supply
    kept = c.chambers == 1 or bool(c.own_states)
    return kept or displaced or c.ported or c.dissolves


def _correction_suffices(request: EstimateRequest) -> bool:
    """Return whether a correction may stand in for another life, being as reliable as those that closed the cycle."""
    problem = request.problem
    if problem.scene.numerics.accuracy <= TWO_LIVES_BELOW or request.filling <= LEAST_DELIVERY:
        return False
    plain = meets_line_at_angle(problem) and not _inherits_more(problem) and not problem.composition.pulsating
    return plain and request.cycle.missed < RELIABLE_CORRECTION


def _slow_by_own_tangents(request: EstimateRequest) -> bool:
    """Return whether turns passed errors on so slowly that corrections closed the cycle, which may stand in for a life.

    Tangents of a nearby cycle say nothing of the turns' own pace. Where corrections missed so much that none may stand
    in for a life, two lives are made if turns were slow.
    """
    tangents, contraction = request.cycle.tangents, request.cycle.contraction
    if tangents is None or tangents.elsewhere:
        return False
    return _correction_suffices(request) or SLOW_CONTRACTION < contraction < 1.0


def _next_life(request: EstimateRequest) -> FinerSolutions:
    """Return the life that follows a closed cycle; `NO_SOLUTIONS` where it stops.

    It takes what the cycle's last turn made of the unknowns: with those that this turn took it would repeat it.
    """
    of, machinery, criteria, cycle, _ = request
    set_unknowns(request.problem, machinery, request.problem.entries.possible(of.image))
    machinery.set_widths(criteria.widths)
    status, _, q = machinery.turn(cycle.y.copy(), FINER * cycle.rtol)
    if status != 0:
        return NO_SOLUTIONS
    machinery.lives.swap()
    reach_station()
    return FinerSolutions([solution_of(evaluate_life(request.problem, machinery.trajectory, q))])


class _Lives:
    """Consecutive lives after a closed cycle, with finer steps and the criteria that are asked for."""

    def __init__(self, request: EstimateRequest) -> None:
        self.of, machinery, criteria, cycle, lent = request
        self.machinery, self.rtol, self.y = machinery, FINER * cycle.rtol, cycle.y.copy()
        machinery.set_widths(criteria.widths)
        self.lent = cycle.tangents is None and lent is not None  # the linearisation is that of a nearby cycle's life
        self.corrections = Corrections(request.problem, machinery, lent if self.lent else cycle.tangents)
        self.unknowns_in = self.unknowns_out = unknowns(request.problem, machinery)
        self.solutions: list[Solution] = []
        self.correction: Correction | None = None  # of the last life
        self.shown: list[Figures] = []  # relative changes of the figures to each solution from the one before
        self.changes: list[float] = []  # of states and unknowns over each life

    def next(self) -> bool:
        """Integrate one more life; return whether it completed."""
        problem, machinery = self.of.problem, self.machinery
        if self.solutions:
            self.unknowns_in = self.unknowns_out
            set_unknowns(problem, machinery, self.unknowns_in)
        self.start, self.steps = along(machinery, self.y), int(machinery.lives.kept[1])
        status, _, self.q = machinery.turn(self.y, self.rtol)
        if status != 0:
            return False
        machinery.lives.swap()
        life = evaluate_life(problem, machinery.trajectory, self.q)
        self._append(solution_of(life))
        self.unknowns_out = problem.entries.possible(life.image)
        self.end = along(machinery, self.y)
        moved = WEIGHT * float(np.max(np.abs(self.end - self.start)))
        self.changes.append(max(moved, problem.entries.change(self.unknowns_out, self.unknowns_in)))
        return True

    def _append(self, solution: Solution) -> None:
        """Append a solution, and how far its figures are from those before."""
        before = self.solutions[-1].figures if self.solutions else self.of.figures
        self.shown.append(relative_errors(before, solution.figures, *self.of.least))
        self.solutions.append(solution)

    def drop_lent(self) -> None:
        """Drop a linearisation that was lent: the next correction makes its own."""
        self.lent, self.corrections.tangents = False, None

    def correct(self) -> bool:
        """Move the last life to the limit of all that follow; return whether there was a correction."""
        pulsating = self.of.problem.composition.pulsating  # new tangents cost as much as some lives there
        if not self.corrections.able or (pulsating and not self.corrections.begun):
            return False
        n = self.machinery.n
        found = self.corrections.of_turn(*self._turned())
        if found is None:
            return False
        self.unknowns_out = corrected_start(self.of.problem, found, self.end[:n], self.y, self.unknowns_out)
        self.correction = found
        return True

    def _turned(self) -> tuple[int, Array, Array, Array, Array]:
        """Return what a correction is made of: steps before the last life, its change of states, sums, unknowns."""
        n = self.machinery.n
        return self.steps, self.end[:n] - self.start[:n], self.q, self.unknowns_in, self.unknowns_out

    def to_come(self) -> tuple[float, float]:
        """Return by how much a correction of the last life would still move gas, work and unknowns, and the net flow.

        Zeros where hardly at all. A life changes little where an error returns nearly in full: what it changes is far
        less than what is to come.
        """
        found = self.corrections.foreseen(*self._turned()) if self.corrections.begun else None
        if found is None:
            return 0.0, 0.0
        work = abs(found.work) / max(abs(float(self.q[slots.Q_WORK])), self.of.least[1], 1e-300)
        moved = max(abs(found.mass), work, float(np.abs(found.unknowns).max(initial=0.0)))
        if moved < LAST_CHANGE * self.of.problem.scene.numerics.accuracy:
            return 0.0, 0.0
        return moved, abs(found.mass) * self._trapped_over_sucked()

    def _trapped_over_sucked(self) -> float:
        """Return the trapped gas over what is sucked, at least 1."""
        problem, trapped = self.of.problem, float(self.machinery.R[slots.R_TRAPPED])
        sucked = abs(self.of.figures.get("gas_mass_flow") or 0.0) / (problem.rate * (1.0 - problem.suction.returned))
        return max(1.0, trapped / max(sucked, 1e-300))

    def foretold(self, by: Correction, wrong: float) -> FinerSolutions:
        """Return the lives together with the response to the last correction, read from the history that it moved.

        The net flow is left as in the last life: port flow and flow across the angle each change by far more
        than their sum. It errs by what the trapped gas changes, over what is sucked, or by what passes to discharge.
        """
        problem, machinery, c = self.of.problem, self.machinery, self.of.problem.composition
        sums = by.sums.copy()
        streams = streams_of(c, sums)
        out = streams[slots.DISCHARGE_IN : slots.DISCHARGE_OUT + 1, slots.OF_GAS].sum()
        trapped = float(machinery.R[slots.R_TRAPPED])
        passed = abs(out / max(trapped, 1e-300))
        streams[: slots.SUCTION_OUT + 1, slots.OF_GAS] = 0.0
        set_unknowns(problem, machinery, self.unknowns_out)
        at, n = float(c.P[slots.P_INJECTION]), machinery.n
        y = np.zeros(c.chambers * n)
        index = round(at / c.P[slots.P_PITCH])
        y[index * n : index * n + n] = machinery.lives.states_at(np.array([at - INSIDE]))[0]
        inject(machinery, y)
        life = Evaluation(problem, machinery.trajectory, self.q + sums)
        led = CorrectedState(self.y, (float(machinery.R[slots.R_TRAPPED]), float(life.q[slots.Q_WORK])))
        self._append(solution_of(life))
        return self.read(
            FinerSolutions(
                self.solutions,
                left=wrong,
                flow=max(abs(by.mass) * self._trapped_over_sucked(), passed),
                corrected_state=led,
            )
        )

    def repeated(self) -> float:
        """Return the ratio of the last life's change to that of the one before."""
        return repeated_share(self.shown)

    def read(self, finer: FinerSolutions) -> FinerSolutions:
        """Return finer solutions marked with whether they determine the limit of all later ones."""
        small = worst(self.shown[-1])[1] < LAST_CHANGE * self.of.problem.scene.numerics.accuracy
        again = repeated_share(self.shown) if finer.left is None else finer.left
        enough, tangents = small or again < QUICK_CONVERGENCE, self.corrections.tangents
        return finer._replace(enough=enough, changes=self.shown, tangents=tangents)

    def left(self) -> float:
        """Return the share of the first life's change that its correction left; 0 where hardly anything is left."""
        before, last = self.changes[-2:]
        return 0.0 if last < LAST_CHANGE * self.of.problem.scene.numerics.accuracy else last / max(before, 1e-300)


def chambers_together(request: EstimateRequest) -> FinerSolutions:
    """Return the cycle closed simultaneously from the closed one, where further lives would only repeat its error.

    Chambers begin from the closed cycle: pitches change next to nothing from the first on, and slowly lead far away.
    """
    if not request.hidden:
        return NO_SOLUTIONS
    problem, machinery, cycle = request.problem, request.machinery, request.cycle
    criteria = replace(
        request.criteria, rtol=FINER * cycle.rtol, tolerance=TOGETHER_FACTOR * request.criteria.tolerance
    )
    finer = close_together(ClosingTask(problem, machinery, criteria), chambers_at_pitches(machinery))
    if finer.closed:
        return FinerSolutions([solution_of(evaluate(problem, finer))])
    machinery.put(cycle.trajectory)
    return NO_SOLUTIONS


def closed_again(request: EstimateRequest) -> FinerSolutions:
    """Return the cycle closed again, with finer steps, from the closed one.

    A cycle that needed a fallback attracts its neighbourhood slowly or not at all, so a single life shows much less
    than its error. It is closed by the way that closed it before, at the cost of a fallback at most.

    Where simultaneous closing left a machine that delivers little, it starts from amounts that are moved. What slow
    pitches leave of that move is as much as they left of the first guess, which no closing from the cycle itself shows.
    """
    problem, cycle = request.problem, request.cycle
    criteria = replace(request.criteria, rtol=FINER * cycle.rtol, tolerance=FINER * request.criteria.tolerance)
    task = ClosingTask(problem, request.machinery, criteria)
    if cycle.needed:
        finer = close_again(task, cycle)
    else:
        start = _with_moved_amounts(request) if way_of(cycle).whole and request.filling < SHIFTED_BELOW else cycle
        finer = way_of(cycle).finer(task, start, MOST_OF_A_TRY)
    if finer is None or not finer.closed:
        return NO_SOLUTIONS
    searched = finer if finer.needed == FALLBACK_NAME else None
    together = finer.q if way_of(finer).whole else None
    return FinerSolutions([solution_of(evaluate(problem, finer))], cycle=searched, q=together)


def _with_moved_amounts(request: EstimateRequest) -> CycleSolution:
    """Return the cycle with the densities of all chambers, and carried oil per gas, moved by `SHIFT` accuracies."""
    cycle, c = request.cycle, request.problem.composition
    states = cycle.y.reshape(-1, len(c.states)).copy()
    states[:, [slots.S_RHO, *([slots.S_X_OIL] if c.carried else ())]] *= (
        1.0 + SHIFT * request.problem.scene.numerics.accuracy
    )
    return replace(cycle, y=states.ravel())
