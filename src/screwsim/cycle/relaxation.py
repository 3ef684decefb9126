"""Waveform relaxation: one chamber's life after the other among the histories of its neighbours.

A turn integrates a life, reading the neighbours ahead from the last turn and those behind from this one; it is repeated
until no more is to come of the trapped mass, the work and the unknowns, and the balances stand
(docs/explanation/closing.md).
"""

from functools import lru_cache

import numpy as np

from screwsim.cycle.balances import LEAST_WORK, Residuals, residuals
from screwsim.cycle.coordinates import NEAR, change, logarithms, states_of
from screwsim.cycle.feedback import image as image_of
from screwsim.cycle.feedback import set_unknowns, unknowns
from screwsim.cycle.mixing import finer
from screwsim.cycle.newton import Correction, Corrections, led
from screwsim.cycle.problem import Problem
from screwsim.cycle.returning import NOTHING, returning
from screwsim.cycle.solution import ENOUGH, NO_HOPE, CycleSolution, Start, Wanted
from screwsim.effects.base import FlowPath
from screwsim.model.exchange import station
from screwsim.model.run import Machinery
from screwsim.model.slots import P_LIFE, Q_WORK, R_TRAPPED
from screwsim.numerics.periodic import Anderson
from screwsim.numerics.settings import WAVEFORMS
from screwsim.outputs.variables import FAILED, NOT_CLOSED, OK

Array = np.ndarray
DEAR = 80_000  # evaluations that simultaneous closing takes in the median, with steps of
DEAR_RTOL = 1e-4  # this tolerance; waveforms may take as many
FIRST_RTOL = 2e-3  # of the first turn; later ones follow the gap
THEN = 0.3  # tolerance of a turn over that of the one before, at most
AHEAD = 0.015  # tolerance of a turn over the gap of the one before
LED = 1e-3  # tolerance of a turn over what the correction before it changed
GOOD = 0.1  # gap of a guess up to which a loose first turn would do more harm than it saves
DEPTH = 5  # of Anderson's method
TOO_FAR = 0.3  # of a mixture from the newest image, in coordinates, which is not taken
MAX_TURNS = 40
LEAKS = 0.13  # mass residual of a first turn, above which it is corrected: what chambers give each other of the charge
SLOW = 0.3  # change of a turn over that of the one before, above which Newton corrects it
SPARED = 6  # turns that a correction has to spare where lines pulsate: so much its tangents cost
LASTING = 0.9  # the same, above which near the end it is noise of the steps
FAR = 0.02  # gap above which the second turn is corrected: how fast turns contract is told by the third
FAR_WITH_OIL = 0.01  # the same where oil is carried, whose heat comes back, and whose turns are dearer
FARTHEST = 0.1  # change of the states (times `NEAR`) above which a linear correction tells nothing
QUICK = 0.2  # change of a turn over that of the one before, below which what is to come follows from it
UNSEEN = 0.1  # share of a turn's change that corrections may miss before a second one has shown it
FORESEEN = 1.5  # tolerances: what a correction may tell to be still to come
HEAVIER = 2.0  # weight of what is to come of the unknowns: an energy balance with much oil hangs on its temperature
STALL = 2  # corrected turns near the end without progress, after which steps are refined
PROGRESS = 0.5  # of the least gap before, below which a gap is progress
REFINED = 0.4  # tolerance of the steps then over that before
FALLING = 0.5  # residual over that of the turn before, below which it is the turns that close a balance, not the steps
PASSING = 3.0  # tolerances that the next turn would move the states by, above which the last may have met one by chance
WORTH = 20.0  # of the tolerance: a change below it is left to the turns themselves ...
LITTLE = 2e-3  # ... and below this
SHOWS = 5.0  # tolerances that a correction has to foretell, for the turn after it to show what it missed


def dear(rtol: float) -> float:
    """Return the evaluations that waveforms may take with steps of a tolerance, by a method of order 4."""
    return DEAR * (DEAR_RTOL / rtol) ** 0.25


def relax(problem: Problem, machinery: Machinery, wanted: Wanted, start: Start, last: bool) -> CycleSolution | None:
    """Close by turns from a start; None when one stops and there is another way.

    They may cost as much as that other way does in the median (`last` is False), and are left as they are then: the two
    seldom cost more than twice the cheaper one. The first turns are integrated loosely: their error is that of the
    guess. A guess made from cycles of machines nearby may be so good that the first turn closes: it is as fine as is
    hoped of the guess.
    """
    turns = _Turns(problem, machinery, wanted, start)
    station()
    most = np.inf if last else machinery.evaluations_of(machinery.counts) + dear(wanted.rtol)
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
    """Turns, each begun from the last: (history, state at 0°, feedback unknowns) are mapped to the next.

    Newton's method corrects the images of slow ones; Anderson's mixes those of the others. `gap` is what a turn changed
    of trapped mass, work and unknowns, beyond what was expected: those of the turn before, corrected or mixed. `left`
    is what later ones yet would.
    """

    def __init__(self, problem: Problem, machinery: Machinery, wanted: Wanted, start: Start) -> None:
        self.problem, self.machinery, self.wanted, self.y = problem, machinery, wanted, start.y.copy()
        c, hope = machinery.composition, start.hope
        c.P[c.widths] = wanted.widths
        self.corrections, self.accelerate = Corrections(problem, machinery, start.tangents), Anderson(DEPTH)
        self.images: list[tuple[Array, Array, int]] = []
        self.seen: list[tuple[float, float]] = []  # mass and work of each
        self.met, self.q, self.number = unknowns(problem, machinery), np.zeros(machinery.nq), 0
        self.guessed, self.expected, self.contraction = hope is not NO_HOPE, [hope.seen], hope.contraction
        self.finest = self.rtol = hope.share * wanted.of_histories * wanted.rtol
        self.next_rtol = self.finest if hope.gap <= GOOD else FIRST_RTOL
        self.gap = self.first_gap = self.moved = self.left = 1.0
        self.before = 1.0, 1.0  # gap, and change of the states, of the turn before
        self.corrected = self.led = False  # was the last turn, and the one before it?
        self.open: Residuals | None = None  # what a turn of the finest steps left open
        self.residual = self.residual_before = np.inf  # of the balances, where steps were the finest
        self.least_gap, self.stalled = np.inf, 0  # near the end, turns without progress there
        self.returning = NOTHING  # of the discharge line, where turns are not corrected
        self.missed = hope.missed  # share of what a correction foretold that the turn after it did not follow

    def vector(self, values: Array) -> Array:
        """Return what a turn maps: states at 0° and along the last history, and the unknowns."""
        return np.concatenate([along(self.machinery, self.y), self.problem.entries.coordinates(values)])

    def integrate(self) -> float | None:
        """Integrate a turn and measure what it changed; return where it stopped, None where it came to its end."""
        problem, machinery = self.problem, self.machinery
        self.point, self.steps_before = self.vector(self.met), int(machinery.kept[1])
        self.corrected, self.led = False, self.corrected
        self.rtol, self.number = max(self.finest, self.next_rtol), self.number + 1
        status, angle, _, self.q = machinery.turn(self.y, self.rtol, 1e-3)
        if status != 0:
            return angle
        machinery.swap()
        station()
        self.made = image_of(problem, machinery.trajectory, self.q)
        self.image = self.vector(self.made)
        now = (float(machinery.R[R_TRAPPED]), float(self.q[Q_WORK]))
        self.least_work = LEAST_WORK * now[0] * problem.pv
        self.before = self.gap, self.moved
        changed = min(change(now, expected, self.least_work) for expected in self.expected)
        self.gap = max(changed, problem.entries.change(self.made, self.met))
        self.moved = NEAR * float(np.maximum.reduce(np.abs(self.image - self.point)))
        if self.number == 1:  # what was expected of mass and work may agree by chance: the states must, too
            self.gap = self.first_gap = max(self.gap, self.moved)
        if self.led and self.left >= SHOWS * self.wanted.tolerance:
            self.missed = self.gap / self.left
        self.expected, self.residual_before = [now], self.residual
        self.open = residuals(problem, machinery.R, self.q) if self.rtol <= self.finest else None
        self.residual = np.inf if self.open is None else self.open.largest
        return None

    def closed(self) -> bool:
        """Tell whether the last turn changed as little as is wanted, not by chance, and the balances are closed.

        Where only these are not, nor on the way there, it is for the steps.
        """
        if not (self.gap <= self.wanted.tolerance and self.rtol <= self.finest):
            return False
        if self.residual <= ENOUGH * self.wanted.bound:
            return not self.by_chance()
        if self.moved <= self.wanted.tolerance and self.residual > FALLING * self.residual_before:
            self.finest = finer(self.finest, self.residual / self.wanted.bound)
        return False

    def by_chance(self) -> bool:
        """Tell whether mass, work and unknowns may have met their tolerance as they passed by it.

        The states say so that the next turn, at the pace of the last two, would move by far more; and corrected turns
        that lead to and fro. Not after a turn that met it likewise: states stall above it where the steps' noise is all
        that moves them.
        """
        (gap, moved), tolerance = self.before, self.wanted.tolerance
        if self.number == 1 or gap <= tolerance:
            return False
        return self._swings() or self.moved * min(self.moved / moved, 1.0) > PASSING * tolerance

    def _swings(self) -> bool:
        """Tell whether corrected turns lead to and fro: one that is hardly nearer than another is as likely off."""
        return self.stalled > 0 and self.gap > PROGRESS * self.least_gap

    def closes(self, corrected: bool) -> bool:
        """Tell whether so little is still to come that no turn need show it, and the balances are closed well."""
        little = self.left <= (FORESEEN if corrected else 1.0) * self.wanted.tolerance
        return little and self.rtol <= self.finest and self.residual <= self.wanted.ahead * self.wanted.bound

    @property
    def near(self) -> bool:
        """Is the end so near that turns get there by themselves?"""
        return self.gap <= min(WORTH * self.wanted.tolerance, LITTLE)

    def slow(self) -> bool:
        """Tell whether this turn is to be corrected: where turns contract slowly, or will.

        Chambers that nothing leads out of come back as they were: any state is a cycle, and corrections find no one.
        """
        if not self.problem.parts.all(FlowPath):
            return False
        if self.problem.composition.pulsating:  # a dozen unknowns and more; without a valve turns lead there as soon
            return any(line.shut is not None for line in self.problem.parts.pulsations) and self._spares()
        if self.number == 1:  # states that are far off still lead nearer there
            return not self.guessed and residuals(self.problem, self.machinery.R, self.q).mass > LEAKS
        ratio, known = self.gap / self.before[0], self.number > (1 if self.guessed else 2)
        if self.near:  # where turns by themselves would take more than two more
            return known and SLOW < ratio < LASTING and self.gap * ratio * ratio > self.wanted.tolerance
        far = FAR_WITH_OIL if self.problem.composition.carried else FAR
        return self.moved < FARTHEST and (ratio > SLOW if self.number > 2 else self.gap > far)

    def _spares(self) -> bool:
        """Tell whether turns by themselves would be so many more that a correction of many unknowns is worth it."""
        ratio = self.gap / self.before[0]
        noise = self.near and ratio >= LASTING
        known = self.number > (1 if self.guessed else 2) and self.moved < FARTHEST and not noise
        return known and self.gap * ratio**SPARED > self.wanted.tolerance

    def correction(self) -> Correction | None:
        """Return Newton's correction of this turn, by which the last history is moved; foresee what is still to come.

        None where none is due, or to be had. Without one, what is to come follows from how fast turns contract.
        """
        self.left, n, corrections, self.returning = self.gap, self.machinery.n, self.corrections, NOTHING
        begun = corrections.begun
        if corrections.due(self.slow(), self.moved, self.near):
            self.corrected = True
            start = self.image[:n] - self.point[:n]
            whole = self.number == 1  # of a guess that is farther off a correction may be anything
            found = corrections.of_turn(self.steps_before, start, self.q, self.met, self.made, whole)
            if found is not None and not begun:
                self.accelerate.restart()
            if found is not None and found.share == 1.0:
                work = abs(found.work) / max(abs(self.q[Q_WORK]), self.least_work)
                told = max(abs(found.mass), work, HEAVIER * float(np.abs(found.unknowns).max(initial=0.0)))
                self.left = max(told, self.gap * self._missed())
                if self.led:  # by a linear correction, as this one is
                    again = self.missed * self.problem.entries.change(self.made, self.met)
                    self.left = max(self.left, HEAVIER * again)
            return found
        if not begun:
            if self.number > (1 if self.guessed else 2):
                self.contraction = max(self.gap / self.before[0], self.moved / self.before[1])
            self.returning = returning(self.problem, self.q, self.met, self.made)
            pace = max(self.contraction, self.returning.share)  # by which a change comes back, though next to none will
            if self.contraction < QUICK:
                self.left = self.gap * pace / (1.0 - pace)
        return None

    def _missed(self) -> float:
        """Return the share of a turn's change that corrections miss by tangents of another cycle, which may be far off.

        What they miss is repeated by turns: two corrected ones tell how much of it.
        """
        if not self.corrections.borrowed:
            return 0.0
        if not self.led:
            return UNSEEN
        ratio = self.gap / self.before[0]
        return ratio / (1.0 - ratio) if ratio < LASTING else 0.0

    def refine(self, correction: Correction | None) -> None:
        """Refine the steps where their error is all that is left.

        It is where the cycle stands, its balances are open and stay so by what the correction tells; and where
        corrected turns near the end make no progress: what they correct is their noise.
        """
        if self.rtol > self.finest:  # they are already
            return
        if correction is not None and self.gap <= self.wanted.tolerance:
            foretold = residuals(self.problem, self.machinery.R, self.q + correction.sums).largest
            stays = min(foretold, self.residual)
            if stays > ENOUGH * self.wanted.bound:
                self.finest = finer(self.finest, stays / self.wanted.bound)
                return
        if self.corrections.begun and self.near:
            progress = self.gap < PROGRESS * self.least_gap
            self.least_gap, self.stalled = (self.gap, 0) if progress else (self.least_gap, self.stalled + 1)
            if self.stalled > STALL:
                self.finest, self.least_gap, self.stalled = REFINED * self.finest, np.inf, 0

    def go_on(self, correction: Correction | None) -> None:
        """Let the next turn begin where this one leads: corrected, or mixed with those before."""
        problem, machinery, n = self.problem, self.machinery, self.machinery.n
        made = self.made
        if correction is not None:
            made = led(problem, correction, self.image[:n], self.y, made)
            ((mass, work),) = self.expected
            self.expected = [(mass * float(np.exp(correction.mass)), work + correction.work)]
            mixed = self._mixed(self.vector(made), self.stalled > 0)
            self.next_rtol = LED * self.left
        else:
            made = self.returning.led(made)
            mixed = self._mixed(self.image if made is self.made else self.vector(made))
            self.next_rtol = min(THEN * self.rtol, AHEAD * self.gap)
        self.y[:] = states_of(mixed[:n], self.y, machinery.composition)
        self.met = problem.entries.values(mixed[len(mixed) - len(self.met) :], made)
        set_unknowns(problem, machinery, self.met)

    def _mixed(self, image: Array, wanted: bool = True) -> Array:
        """Return what Anderson's method mixes of the last images, where that is wanted, and do so with their histories.

        Those that were corrected are not mixed as long as corrections lead on: what different steps leave between their
        histories is a residual of the gas.
        """
        self.images = [*self.images, self.machinery.image()][-DEPTH - 1 :]
        self.seen = [*self.seen, self.expected[0]][-DEPTH - 1 :]
        weights, mixed = self.accelerate.mix(self.point, image)
        if not wanted or len(weights) == 1 or not np.max(np.abs(mixed - image)) < TOO_FAR:
            return image
        self.machinery.blend(self.images[-len(weights) :], weights)
        mass, work = (weights @ np.array(self.seen[-len(weights) :])).tolist()
        self.expected = [*self.expected, (mass, work)]
        return mixed

    def ended(self, status: str, angle: float = 0.0) -> CycleSolution:
        """Return the cycle as the last turn left it."""
        machinery, ok = self.machinery, status == OK
        station()
        return CycleSolution(
            *(status, machinery.trajectory.copy(), self.q, self.y, self.number, WAVEFORMS),
            rtol=self.rtol if status == FAILED else self.finest,
            angle=angle,
            change=0.0 if status == FAILED else self.gap,
            first_gap=self.first_gap if ok else 1.0,
            residual=self.residual / self.wanted.bound if ok else 0.0,
            impacts=machinery.impacts,
            tangents=self.corrections.last,
            contraction=self.contraction,
            open=self.open if ok and not self.corrected else None,
            made=self.made if ok and not self.corrected else None,
            left=self.left if ok and self.gap > self.wanted.tolerance and self.corrections.begun else 0.0,
            missed=self.missed,
        )


def along(machinery: Machinery, y: Array) -> Array:
    """Return the logarithms of the states y at 0° and of those along the last history."""
    c = machinery.composition
    angles = _angles(float(c.P[P_LIFE]), c.chambers)
    return logarithms(machinery.states_along(y[: machinery.n], angles), c)


@lru_cache(maxsize=8)
def _angles(life: float, chambers: int) -> Array:
    """Return where states of the last history are compared and mixed [rad], beside those at 0°."""
    return np.linspace(0.0, life, 8 * chambers, endpoint=False) + 1e-3
