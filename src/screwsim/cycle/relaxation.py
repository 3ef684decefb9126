"""Waveform relaxation: integrate one chamber's life again and again among the stored histories of its neighbours.

A turn (one sweep of the relaxation) integrates one life of 720°. It reads the neighbours ahead from the history of the
turn before, those behind from its own. Turns are repeated until the change still to come of trapped mass, work and
feedback unknowns is within the tolerance and the balances close (docs/explanation/closing.md).
"""

from functools import lru_cache

import numpy as np

from screwsim.cycle.backflow import NO_FEEDBACK, backflow_feedback
from screwsim.cycle.balances import LEAST_WORK, Residuals, residuals
from screwsim.cycle.coordinates import WEIGHT, change, logarithms, states_of
from screwsim.cycle.feedback import image as image_of
from screwsim.cycle.feedback import set_unknowns, unknowns
from screwsim.cycle.newton import Correction, Corrections, corrected_start
from screwsim.cycle.problem import ClosingTask
from screwsim.cycle.solution import CLOSED_SHARE, NO_EXPECTATION, CycleSolution, Start
from screwsim.cycle.turn_mixing import TurnMixing
from screwsim.cycle.turn_steps import NOISE_RATIO, StepTolerance
from screwsim.effects.base import FlowPath
from screwsim.model.run import Machinery
from screwsim.model.slots import P_LIFE, Q_WORK, R_TRAPPED
from screwsim.model.turn_scheduler import reach_station
from screwsim.numerics.settings import WAVEFORMS
from screwsim.outputs.variables import FAILED, NOT_CLOSED, OK

Array = np.ndarray
MOST_EVALUATIONS = 80_000  # evaluations that simultaneous closing takes in the median, with steps of
RTOL_OF_MOST = 1e-4  # this tolerance; waveform relaxation may take as many
MAX_TURNS = 40
LEAKS = 0.13  # mass residual of a first turn, over the charge, above which it is corrected: leaks not yet matched
SLOW_CONTRACTION = 0.3  # ratio of a turn's change to that of the turn before, above which Newton corrects it
LEAST_SAVING = 6  # turns that a correction must save where lines pulsate: its tangents cost as much
FIRST_CHANGE = 0.02  # gap above which the second turn is corrected: contraction is only known from the third on
FIRST_CHANGE_OIL = 0.01  # the same with carried oil, which brings its heat back and makes turns dearer
LINEAR_WITHIN = 0.1  # change of the states (times `WEIGHT`) above which a linear correction is useless
QUICK = 0.2  # ratio of a turn's change to that of the turn before, below which the change to come follows from it
ASSUMED_MISS = 0.1  # share of a turn's change that corrections are assumed to miss before a second one shows it
PREDICTED_WITHIN = 1.5  # tolerances: change to come, as a correction predicts it, with which the cycle may close
HEAVIER = 2.0  # weight of the unknowns' change to come: with much oil the energy balance depends on its temperature
FALLING = 0.5  # ratio of a residual to that of the turn before, below which turns, not finer steps, close the balance
CHANCE_MOVE = 3.0  # tolerances that the next turn would move the states by, above which a small gap may be chance
NEAR_TOLERANCES = 20.0  # tolerances: a smaller change is left to the turns themselves ...
NEAR_GAP = 2e-3  # ... if it is also below this
TELLING_CHANGE = 5.0  # tolerances that a correction must predict for the next turn to show its error


def affordable_evaluations(rtol: float) -> float:
    """Return the evaluations that waveform relaxation may take at a tolerance of a step, by a method of order 4."""
    return MOST_EVALUATIONS * (RTOL_OF_MOST / rtol) ** 0.25


def relax(task: ClosingTask, start: Start, last: bool) -> CycleSolution | None:
    """Close by turns from a start; return None when a turn stops and another way is left to try.

    Unless this is the `last` way, it gives up, unclosed, after the evaluations that the other way takes in the
    median: the two together seldom cost more than twice the cheaper one. The first turns are integrated loosely,
    since the error of the guess prevails. A guess from nearby cycles may be good enough to close in the first turn,
    which is then integrated as finely as its expected error allows.
    """
    turns, machinery = _Turns(task, start), task.machinery
    reach_station()
    most = np.inf if last else machinery.evaluations_of(machinery.counts) + affordable_evaluations(task.criteria.rtol)
    for _ in range(MAX_TURNS):
        angle = turns.integrate()
        if angle is not None:
            return turns.ended(FAILED, angle) if last else None
        if turns.closed():
            return turns.ended(OK)
        correction = turns.correction()
        if turns.closes(correction is not None):
            return turns.ended(OK)
        if machinery.evaluations_of(machinery.counts) > most:
            break
        turns.refine(correction)
        turns.go_on(correction)
    return turns.ended(NOT_CLOSED)


class _Turns:
    """The fixed-point iteration: a turn maps (history, state at 0°, feedback unknowns) to their next values.

    Newton's method corrects the images of slowly contracting turns, Anderson's method mixes the others. `gap` is
    the change of trapped mass, work and unknowns by a turn, against the expected values: those of the turn before,
    corrected or mixed. `left` is the estimated change still to come.
    """

    def __init__(self, task: ClosingTask, start: Start) -> None:
        self.problem, self.machinery, self.criteria = problem, machinery, criteria = task
        self.y, expected = start.y.copy(), start.expected
        machinery.set_widths(criteria.widths)
        self.corrections, self.mixing = Corrections(problem, machinery, start.tangents), TurnMixing(machinery)
        self.unknowns_in, self.q, self.number = unknowns(problem, machinery), np.zeros(machinery.nq), 0
        self.guessed, self.expected = expected is not NO_EXPECTATION, [expected.seen]
        self.contraction = expected.contraction
        self.steps = StepTolerance(expected.share * criteria.histories_factor * criteria.rtol, expected.gap)
        self.gap = self.first_gap = self.moved = self.left = 1.0
        self.before = 1.0, 1.0  # gap and change of the states in the turn before
        self.corrected = self.corrected_before = False  # whether the last turn was corrected, and the one before it
        self.open: Residuals | None = None  # residuals of a turn with the finest steps
        self.residual = self.residual_before = np.inf  # largest of the balances, where steps were the finest
        self.returning = NO_FEEDBACK  # feedback through the discharge line, where turns are not corrected
        self.missed = expected.missed  # relative error of a correction's prediction, seen by the next turn

    def vector(self, values: Array) -> Array:
        """Return the vector that a turn maps: states at 0° and along the last history, and the unknowns."""
        return np.concatenate([along(self.machinery, self.y), self.problem.entries.coordinates(values)])

    def integrate(self) -> float | None:
        """Integrate a turn and measure its changes; return the angle [rad] where it stopped, None if it completed."""
        problem, machinery = self.problem, self.machinery
        self.point, self.steps_before = self.vector(self.unknowns_in), int(machinery.lives.kept[1])
        self.corrected, self.corrected_before = False, self.corrected
        self.number += 1
        status, angle, self.q = machinery.turn(self.y, self.steps.begin())
        if status != 0:
            return angle
        machinery.lives.swap()
        reach_station()
        self.unknowns_out = image_of(problem, machinery.trajectory, self.q)
        self.image = self.vector(self.unknowns_out)
        now = (float(machinery.R[R_TRAPPED]), float(self.q[Q_WORK]))
        self.least_work = LEAST_WORK * now[0] * problem.pv
        self.before = self.gap, self.moved
        changed = min(change(now, expected, self.least_work) for expected in self.expected)
        self.gap = max(changed, problem.entries.change(self.unknowns_out, self.unknowns_in))
        self.moved = WEIGHT * float(np.maximum.reduce(np.abs(self.image - self.point)))
        if self.number == 1:  # expected mass and work may agree by chance: the states must agree, too
            self.gap = self.first_gap = max(self.gap, self.moved)
        if self.corrected_before and self.left >= TELLING_CHANGE * self.criteria.tolerance:
            self.missed = self.gap / self.left
        self.expected, self.residual_before = [now], self.residual
        self.open = residuals(problem, machinery.R, self.q) if self.steps.fine else None
        self.residual = np.inf if self.open is None else self.open.largest
        return None

    def closed(self) -> bool:
        """Return whether the last turn meets the tolerance, not by chance, with its balances closed.

        Where only the balances are open and no longer fall from turn to turn, the steps are to blame and are
        refined.
        """
        if not (self.gap <= self.criteria.tolerance and self.steps.fine):
            return False
        if self.residual <= CLOSED_SHARE * self.criteria.bound:
            return not self.by_chance()
        if self.moved <= self.criteria.tolerance and self.residual > FALLING * self.residual_before:
            self.steps.refine(self.residual / self.criteria.bound)
        return False

    def by_chance(self) -> bool:
        """Return whether the gap may be within the tolerance only by coincidence.

        So it is if the next turn, at the pace of the last two, would move the states by more than `CHANCE_MOVE`
        tolerances, or if corrected turns go back and forth. Never if the turn before met the tolerance, too: the noise
        of the steps may keep states moving above it.
        """
        (gap, moved), tolerance = self.before, self.criteria.tolerance
        if self.number == 1 or gap <= tolerance:
            return False
        swings = self.corrections.begun and self.steps.swings(self.gap)
        return swings or self.moved * min(self.moved / moved, 1.0) > CHANCE_MOVE * tolerance

    def closes(self, corrected: bool) -> bool:
        """Return whether too little is still to come to need a confirming turn, and the balances are closed well."""
        little = self.left <= (PREDICTED_WITHIN if corrected else 1.0) * self.criteria.tolerance
        return little and self.steps.fine and self.residual <= self.criteria.ahead * self.criteria.bound

    @property
    def near(self) -> bool:
        """Whether the end is so near that turns reach it without corrections."""
        return self.gap <= min(NEAR_TOLERANCES * self.criteria.tolerance, NEAR_GAP)

    def slow(self) -> bool:
        """Return whether this turn should be corrected: where turns contract slowly, or will.

        Chambers without any leak path return to their own state: any state is a cycle then, and a correction
        singles out none.
        """
        if not self.problem.parts.all(FlowPath):
            return False
        if self.problem.composition.pulsating:  # a dozen unknowns or more; without a valve turns alone are as quick
            return any(line.shut is not None for line in self.problem.parts.pulsations) and self._spares()
        if self.number == 1:  # a correction helps there even from states that are far off
            return not self.guessed and residuals(self.problem, self.machinery.R, self.q).mass > LEAKS
        ratio, known = self.gap / self.before[0], self.number > (1 if self.guessed else 2)
        if self.near:  # where more than two further turns would be needed
            slow = SLOW_CONTRACTION < ratio < NOISE_RATIO
            return known and slow and self.gap * ratio * ratio > self.criteria.tolerance
        far = FIRST_CHANGE_OIL if self.problem.composition.carried else FIRST_CHANGE
        return self.moved < LINEAR_WITHIN and (ratio > SLOW_CONTRACTION if self.number > 2 else self.gap > far)

    def _spares(self) -> bool:
        """Return whether turns alone would take so many more that a correction of many unknowns pays."""
        ratio = self.gap / self.before[0]
        noise = self.near and ratio >= NOISE_RATIO
        known = self.number > (1 if self.guessed else 2) and self.moved < LINEAR_WITHIN and not noise
        return known and self.gap * ratio**LEAST_SAVING > self.criteria.tolerance

    def correction(self) -> Correction | None:
        """Return Newton's correction of this turn, applied to the last history; set `left`, the change still to come.

        None where no correction is due or possible. Without one, the change to come follows from the
        contraction of the turns.
        """
        self.left, n, corrections, self.returning = self.gap, self.machinery.n, self.corrections, NO_FEEDBACK
        begun = corrections.begun
        if corrections.due(self.slow(), self.moved, self.near):
            self.corrected = True
            start = self.image[:n] - self.point[:n]
            whole = self.number == 1  # far from the solution a shortened correction may lead anywhere
            found = corrections.of_turn(self.steps_before, start, self.q, self.unknowns_in, self.unknowns_out, whole)
            if found is not None and not begun:
                self.mixing.restart()
            if found is not None and found.share == 1.0:
                work = abs(found.work) / max(abs(self.q[Q_WORK]), self.least_work)
                told = max(abs(found.mass), work, HEAVIER * float(np.abs(found.unknowns).max(initial=0.0)))
                self.left = max(told, self.gap * self._missed())
                if self.corrected_before:  # it was led here by a linear correction too
                    again = self.missed * self.problem.entries.change(self.unknowns_out, self.unknowns_in)
                    self.left = max(self.left, HEAVIER * again)
            return found
        if not begun:
            if self.number > (1 if self.guessed else 2):
                self.contraction = max(self.gap / self.before[0], self.moved / self.before[1])
            self.returning = backflow_feedback(self.problem, self.q, self.unknowns_in, self.unknowns_out)
            pace = max(self.contraction, self.returning.share)  # a small contraction may be chance, the backflow is not
            if self.contraction < QUICK:
                self.left = self.gap * pace / (1.0 - pace)
        return None

    def _missed(self) -> float:
        """Return the share of a turn's change that corrections miss when their tangents are another cycle's.

        What one correction misses, the next turn repeats: two corrected turns in a row show how much.
        """
        tangents = self.corrections.tangents
        if tangents is None or not tangents.elsewhere:
            return 0.0
        if not self.corrected_before:
            return ASSUMED_MISS
        ratio = self.gap / self.before[0]
        return ratio / (1.0 - ratio) if ratio < NOISE_RATIO else 0.0

    def refine(self, correction: Correction | None) -> None:
        """Refine the steps where their error is all that is left.

        That is so where the gap is within the tolerance but the balances are open and, by the correction's
        prediction, stay open; and where turns near the end make no progress: corrected ones then correct the noise
        of the steps, those of pulsating lines wander in it until they meet their tolerance by chance.
        """
        if not self.steps.fine:  # the next turn is finer anyway
            return
        if correction is not None and self.gap <= self.criteria.tolerance:
            foretold = residuals(self.problem, self.machinery.R, self.q + correction.sums).largest
            stays = min(foretold, self.residual)
            if stays > CLOSED_SHARE * self.criteria.bound:
                self.steps.refine(stays / self.criteria.bound)
                return
        if self.near and (self.corrections.begun or self.problem.composition.pulsating):
            self.steps.watch(self.gap, self.corrections.begun)

    def go_on(self, correction: Correction | None) -> None:
        """Set the start of the next turn: this one's image, corrected or mixed with earlier ones."""
        problem, machinery, n = self.problem, self.machinery, self.machinery.n
        unknowns_out = self.unknowns_out
        if correction is not None:
            unknowns_out = corrected_start(problem, correction, self.image[:n], self.y, unknowns_out)
            ((mass, work),) = self.expected
            self.expected = [(mass * float(np.exp(correction.mass)), work + correction.work)]
            mixed = self._mixed(self.vector(unknowns_out), self.steps.stalled > 0)
            self.steps.follow_correction(self.left)
        else:
            unknowns_out = self.returning.extrapolated(unknowns_out)
            mixed = self._mixed(self.image if unknowns_out is self.unknowns_out else self.vector(unknowns_out))
            self.steps.follow(self.gap)
        self.y[:] = states_of(mixed[:n], self.y, machinery.composition)
        self.unknowns_in = problem.entries.values(mixed[len(mixed) - len(self.unknowns_in) :], unknowns_out)
        set_unknowns(problem, machinery, self.unknowns_in)

    def _mixed(self, image: Array, wanted: bool = True) -> Array:
        """Return the next point, and expect its mass and work beside those of the image."""
        mixed, seen = self.mixing.next(self.point, image, self.expected[0], wanted)
        if seen is not None:
            self.expected = [*self.expected, seen]
        return mixed

    def ended(self, status: str, angle: float = 0.0) -> CycleSolution:
        """Return the cycle as the last turn left it."""
        machinery, ok = self.machinery, status == OK
        reach_station()
        return CycleSolution(
            *(status, machinery.trajectory.copy(), self.q, self.y, self.number, WAVEFORMS),
            rtol=self.steps.now if status == FAILED else self.steps.finest,
            angle=angle,
            change=0.0 if status == FAILED else self.gap,
            first_gap=self.first_gap if ok else 1.0,
            residual=self.residual / self.criteria.bound if ok else 0.0,
            impacts=machinery.impacts,
            tangents=self.corrections.last,
            contraction=self.contraction,
            open=self.open if ok and not self.corrected else None,
            unknowns_out=self.unknowns_out if ok and not self.corrected else None,
            left=self.left if ok and self.gap > self.criteria.tolerance and self.corrections.begun else 0.0,
            missed=self.missed,
        )


def along(machinery: Machinery, y: Array) -> Array:
    """Return the logarithms of the states y at 0° and of those along the last history."""
    c = machinery.composition
    angles = _angles(float(c.P[P_LIFE]), c.chambers)
    return logarithms(machinery.lives.states_along(y[: machinery.n], angles), c)


@lru_cache(maxsize=8)
def _angles(life: float, chambers: int) -> Array:
    """Return the angles [rad] of the last history at which states are compared and mixed, besides 0°."""
    return np.linspace(0.0, life, 8 * chambers, endpoint=False) + 1e-3
