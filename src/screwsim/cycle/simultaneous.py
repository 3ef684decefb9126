"""Simultaneous closing: integrate all chambers together over one pitch, accelerated by Anderson's method.

Each flow between chambers is evaluated once, so that it conserves exactly; it also converges where leakage is strong
(docs/explanation/closing.md).
"""

import numpy as np

from screwsim.cycle.balances import LEAST_WORK, residuals
from screwsim.cycle.coordinates import WEIGHT, change, logarithms, states_of
from screwsim.cycle.feedback import image as image_of
from screwsim.cycle.feedback import set_unknowns, unknowns
from screwsim.cycle.mixing import FULL_RULE, Mixing, MixingRule, StepRefinement
from screwsim.cycle.newton import Corrections
from screwsim.cycle.problem import ClosingTask
from screwsim.cycle.solution import CLOSED_SHARE, CycleSolution
from screwsim.model.all_chambers import install_pitch, moved_on
from screwsim.model.run import Machinery
from screwsim.model.slots import P_PITCH, Q_WORK, R_TRAPPED
from screwsim.numerics.rodas import EVALUATED, dense_value
from screwsim.numerics.settings import TOGETHER
from screwsim.outputs.variables import FAILED, NOT_CLOSED, OK

Array = np.ndarray
STALL = 3  # pitches without progress of the states, after which a change is noise of the steps
MAX_PITCHES = 160
FRUITLESS = 40  # accelerated pitches, all with a change above `SWINGING` and the second half with no less than ...
FRUITLESS_PLAIN = 32  # (the same without acceleration)
SWINGING = 0.2  # smallest change, in coordinates, of pitches that lead nowhere
PROGRESS = 0.7  # ... this share of the smallest change of the first half, after which closing is given up
FARTHEST = 0.3  # change of a pitch above which a linear correction is meaningless
MAX_EVALUATIONS = 1_000_000  # of one chamber's rates, after which an unclosed cycle is given up ...
CHECK_FACTOR = 20  # ... times this under a check, one pitch of which may take a million


def close_together(
    task: ClosingTask,
    y: Array,
    rule: MixingRule = FULL_RULE,
    most: int = MAX_EVALUATIONS,
    pitches: int = MAX_PITCHES,
    patient: bool = False,
) -> CycleSolution:
    """Close all chambers from their states y by the accelerated fixed-point iteration of pitches.

    Unless it is `patient`, iteration ends early where pitches make no progress.
    """
    run, machinery = _Pitches(task, y, rule), task.machinery
    budget = int(machinery.counts[EVALUATED]) + (CHECK_FACTOR * most if task.criteria.check else most)
    for run.number in range(1, pitches + 1):
        if machinery.counts[EVALUATED] > budget:
            break
        angle = run.integrate()
        if angle is not None:
            return run.ended(FAILED, angle)
        if not patient and run.in_vain():
            break
        if run.closed():
            return run.ended(OK)
        run.go_on()
    return run.ended(NOT_CLOSED)


class _Pitches:
    """The fixed-point iteration: a pitch maps (states, feedback unknowns) to their next values.

    Newton's method corrects the images of slowly contracting pitches, Anderson's method mixes the others. `gap` is
    the change of states and unknowns over a pitch. `astray` keeps those from before the first correction.
    """

    def __init__(self, task: ClosingTask, y: Array, rule: MixingRule) -> None:
        self.problem, self.machinery, self.criteria = problem, machinery, criteria = task
        self.rule, self.y = rule, y
        self.c, self.entries = machinery.composition, problem.entries
        machinery.set_widths(criteria.widths)
        self.corrections = Corrections(problem, machinery)
        self.mixing, self.refining = Mixing(rule), StepRefinement(criteria.rtol, criteria.tolerance, criteria.bound)
        self.unknowns_in, self.q, self.rtol = unknowns(problem, machinery), np.zeros(machinery.nq), criteria.rtol
        self.astray: tuple[Array, Array] | None = None
        self.seen: list[tuple[float, float]] = []  # trapped mass and work of each pitch
        self.gaps: list[float] = []
        self.number, self.gap = 0, 1.0

    def integrate(self) -> float | None:
        """Integrate a pitch and measure its changes; return the angle [rad] where it stopped, None if it completed."""
        problem, machinery, c, entries = self.problem, self.machinery, self.c, self.entries
        self.point = np.concatenate([logarithms(self.y, c), entries.coordinates(self.unknowns_in)])
        end, self.rtol = self.y.copy(), self.refining.rtol
        status, angle, self.q = machinery.pitch(end, self.rtol, check=self.criteria.check)
        if status != 0:
            self.y = end
            return angle
        self.seen.append((float(machinery.R[R_TRAPPED]), float(self.q[Q_WORK])))
        if c.pulsating:  # the image reads the flows of the pitch
            install_pitch(machinery)
        self.unknowns_out = image_of(problem, machinery.trajectory, self.q)
        self.next_states = moved_on(machinery, end)
        self.image = np.concatenate([logarithms(self.next_states, c), entries.coordinates(self.unknowns_out)])
        self.gap = float(np.max(np.abs(self.image - self.point)))
        self.gaps.append(self.gap)
        return None

    def in_vain(self) -> bool:
        """Return whether undamped pitches of several chambers make no progress."""
        count = FRUITLESS if self.rule.depth else FRUITLESS_PLAIN
        return self.c.chambers > 1 and self.rule.damping == 1.0 and _make_no_progress(self.gaps, count)

    def closed(self) -> bool:
        """Return whether pitches have settled and the balances close; open balances may refine the next steps."""
        problem, criteria = self.problem, self.criteria
        *before, now = self.seen[-3:]  # trapped mass and work of the last pitches
        changes = [change(now, old, LEAST_WORK * now[0] * problem.pv) for old in before]
        agree = len(changes) == 2 and max(changes) <= criteria.tolerance
        if not (agree and _is_stationary(self.gaps, criteria.tolerance)):
            return False
        residual = residuals(problem, self.machinery.R, self.q).largest
        if residual <= CLOSED_SHARE * criteria.bound:
            return True
        self.refining.consider(self.gap, residual)
        return False

    def go_on(self) -> None:
        """Set the start of the next pitch: the image, corrected or mixed with earlier ones."""
        plain = self.rule is FULL_RULE and not self.c.pulsating  # a jump of states at a pitch's start would kick a line
        near = self.criteria.tolerance < self.gap < FARTHEST
        if self.corrections.due(plain and self.number > 1 and near, self.gap):
            self._correct()
        if self.astray is not None and not self.corrections.able:  # continue without corrections, from where they began
            (self.y, self.unknowns_in), self.astray = self.astray, None
            self.mixing.restart()
        else:
            n, mixed = len(self.y), self.mixing.next(self.point, self.image, self.gap)
            if self.refining.rtol < self.rtol:
                self.mixing.restart()
            self.unknowns_in = self.entries.values(mixed[n:], self.unknowns_out)
            self.y = states_of(mixed[:n], self.next_states, self.c)
        set_unknowns(self.problem, self.machinery, self.unknowns_in)

    def _correct(self) -> None:
        """Move the image by Newton's correction, if there is one."""
        begun, n = self.corrections.begun, len(self.y)
        if not begun:
            install_pitch(self.machinery)
            self.astray = self.astray or (self.y.copy(), self.unknowns_in)
        found = self.corrections.of_pitch(self.image[:n] - self.point[:n], self.q, self.unknowns_in, self.unknowns_out)
        if found is not None:
            if not begun:
                self.mixing.restart()
            unknowns_led = self.entries.coordinates(self.unknowns_out) + found.unknowns
            self.image = np.concatenate([self.point[:n] + found.start, unknowns_led])

    def ended(self, status: str, angle: float = 0.0) -> CycleSolution:
        """Return the outcome; its states are those that the last pitch started with, or where it stopped."""
        machinery, moved = self.machinery, 0.0 if status == FAILED else self.gap
        if status != FAILED:
            install_pitch(machinery)
        life, turns, impacts = machinery.trajectory.copy(), self.number / self.c.chambers, machinery.impacts
        lasting = self.corrections.lasting() if status == OK else None
        how = TOGETHER, self.rtol, angle, moved
        return CycleSolution(status, life, self.q, self.y, turns, *how, impacts=impacts, lasting=lasting)


def _make_no_progress(gaps: list[float], count: int) -> bool:
    """Return whether the last `count` pitches changed much and hardly less at the end: the machine oscillates."""
    if len(gaps) < count:
        return False
    before, last = min(gaps[-count : -count // 2]), min(gaps[-count // 2 :])
    return last > max(SWINGING, PROGRESS * before)


def _is_stationary(gaps: list[float], tolerance: float) -> bool:
    """Return whether the last pitch changed the states within the tolerance, or stalled near it: the rest is noise."""
    if gaps[-1] <= tolerance:
        return True
    stalled = len(gaps) > 2 * STALL and min(gaps[-STALL:]) >= 0.5 * min(gaps[:-STALL])
    return stalled and WEIGHT * gaps[-1] <= tolerance


def chambers_at_pitches(machinery: Machinery) -> Array:
    """Return the states of all chambers at the start of a pitch, read from the last history."""
    c = machinery.composition
    times, dense, _, steps = machinery.lives.last()
    states = []
    for j in range(c.chambers):
        i = int(np.searchsorted(times[: steps + 1], j * c.P[P_PITCH] + 1e-9, side="right")) - 1
        i = max(0, i - 1) if abs(times[i] - j * c.P[P_PITCH]) < 1e-9 and i > 0 else i
        theta = (j * c.P[P_PITCH] - times[i]) / (times[i + 1] - times[i])
        states.append(dense_value(theta, *dense[i])[: machinery.n])
    states = np.array(states)
    oil = slice(2, len(c.states) - len(c.own_states))
    states[:, oil] = np.maximum(states[:, oil], 0.0)  # the cubic of an oil ratio may dip below zero
    return states.ravel()
