"""Simultaneous closing: all chambers over one pitch, accelerated by Anderson's method.

It evaluates each flow between chambers once, so that it conserves exactly, and converges where leakage rules
(docs/explanation/closing.md).
"""

import numpy as np

from screwsim.cycle.balances import LEAST_WORK, residuals
from screwsim.cycle.coordinates import NEAR, change, logarithms, states_of
from screwsim.cycle.feedback import image as image_of
from screwsim.cycle.feedback import set_unknowns, unknowns
from screwsim.cycle.mixing import FULL, Mixing, MixingRule, Refining
from screwsim.cycle.newton import Corrections
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import ENOUGH, CycleSolution, Wanted
from screwsim.model.run import Machinery
from screwsim.model.slots import P_PITCH, Q_WORK, R_TRAPPED
from screwsim.numerics.rodas import EVALUATED, dense_value
from screwsim.numerics.settings import TOGETHER
from screwsim.outputs.variables import FAILED, NOT_CLOSED, OK

Array = np.ndarray
STALL = 3  # pitches without progress of the states
MAX_PITCHES = 160
IN_VAIN = 40  # accelerated pitches, all of which change more than `LOST`: over the second half of them no less than ...
IN_VAIN_PLAIN = 32  # (the same of pitches that are the machine's own course)
LOST = 0.2
NEARER = 0.7  # ... this share of what those of the first half changed at least: they lead nowhere
FARTHEST = 0.3  # change of a pitch above which a linear correction tells nothing
MAX_EVALUATIONS = 1_000_000  # of one chamber's rates, after which a cycle that does not close is given up,
OF_A_CHECK = 20  # so many times that under a check: its pitch may take a million


def close_together(
    problem: Problem,
    machinery: Machinery,
    wanted: Wanted,
    y: Array,
    rule: MixingRule = FULL,
    most: int = MAX_EVALUATIONS,
    pitches: int = MAX_PITCHES,
    patient: bool = False,
) -> CycleSolution:
    """Close all chambers from their states y; the fixed point in logarithms of the states, accelerated.

    Pitches that lead nowhere end, unless it is `patient`.
    """
    run = _Pitches(problem, machinery, wanted, y, rule)
    budget = int(machinery.counts[EVALUATED]) + (OF_A_CHECK * most if wanted.check else most)
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
    """Pitches of all chambers, each begun from the last: (states, feedback unknowns) are mapped to the next.

    Newton's method corrects the images of slow ones; Anderson's mixes those of the others. `gap` is what a pitch
    changed of states and unknowns. `astray` are those before the first correction.
    """

    def __init__(self, problem: Problem, machinery: Machinery, wanted: Wanted, y: Array, rule: MixingRule) -> None:
        self.problem, self.machinery, self.wanted, self.rule, self.y = problem, machinery, wanted, rule, y
        self.c, self.entries = machinery.composition, problem.entries
        self.c.P[self.c.widths] = wanted.widths
        self.corrections = Corrections(problem, machinery)
        self.mixing, self.refining = Mixing(rule), Refining(wanted.rtol, wanted.tolerance, wanted.bound)
        self.met, self.q, self.rtol = unknowns(problem, machinery), np.zeros(machinery.nq), wanted.rtol
        self.astray: tuple[Array, Array] | None = None
        self.seen: list[tuple[float, float]] = []  # trapped mass and work of each
        self.gaps: list[float] = []
        self.number, self.gap = 0, 1.0

    def integrate(self) -> float | None:
        """Integrate a pitch and measure what it changed; return where it stopped, None where it came to its end."""
        problem, machinery, c, entries = self.problem, self.machinery, self.c, self.entries
        self.point = np.concatenate([logarithms(self.y, c), entries.coordinates(self.met)])
        end, self.rtol = self.y.copy(), self.refining.rtol
        status, angle, _, self.q = machinery.pitch(end, self.rtol, 1e-3, check=self.wanted.check)
        if status != 0:
            self.y = end
            return angle
        self.seen.append((float(machinery.R[R_TRAPPED]), float(self.q[Q_WORK])))
        if c.pulsating:  # the image reads the flows of the pitch
            machinery.install_coupled()
        self.made = image_of(problem, machinery.trajectory, self.q)
        self.next_states = machinery.shift(end)
        self.image = np.concatenate([logarithms(self.next_states, c), entries.coordinates(self.made)])
        self.gap = float(np.max(np.abs(self.image - self.point)))
        self.gaps.append(self.gap)
        return None

    def in_vain(self) -> bool:
        """Tell whether undamped pitches of several chambers lead nowhere."""
        count = IN_VAIN if self.rule.depth else IN_VAIN_PLAIN
        return self.c.chambers > 1 and self.rule.damping == 1.0 and _lead_nowhere(self.gaps, count)

    def closed(self) -> bool:
        """Tell whether pitches settled and their balances close; what these leave decides on the next tolerance."""
        problem, wanted = self.problem, self.wanted
        least = LEAST_WORK * self.seen[-1][0] * problem.pv
        if not (_settled(self.seen, wanted.tolerance, least) and _stands(self.gaps, wanted.tolerance)):
            return False
        residual = residuals(problem, self.machinery.R, self.q).largest
        if residual <= ENOUGH * wanted.bound:
            return True
        self.refining.consider(self.gap, residual)
        return False

    def go_on(self) -> None:
        """Begin the next pitch at the image, corrected or mixed with those before."""
        plain = self.rule is FULL and not self.c.pulsating  # states at a pitch's start kick what a line is given there
        near = self.wanted.tolerance < self.gap < FARTHEST
        if self.corrections.due(plain and self.number > 1 and near, self.gap):
            self._correct()
        if self.astray is not None and not self.corrections.able:  # on without them, from where they began
            (self.y, self.met), self.astray = self.astray, None
            self.mixing.restart()
        else:
            n, mixed = len(self.y), self.mixing.next(self.point, self.image, self.gap)
            if self.refining.rtol < self.rtol:
                self.mixing.restart()
            self.met = self.entries.values(mixed[n:], self.made)
            self.y = states_of(mixed[:n], self.next_states, self.c)
        set_unknowns(self.problem, self.machinery, self.met)

    def _correct(self) -> None:
        """Move the image to where Newton's method leads, if that has tangents."""
        begun, n = self.corrections.begun, len(self.y)
        if not begun:
            self.machinery.install_coupled()
            self.astray = self.astray or (self.y.copy(), self.met)
        found = self.corrections.of_pitch(self.image[:n] - self.point[:n], self.q, self.met, self.made)
        if found is not None:
            if not begun:
                self.mixing.restart()
            unknowns_led = self.entries.coordinates(self.made) + found.unknowns
            self.image = np.concatenate([self.point[:n] + found.start, unknowns_led])

    def ended(self, status: str, angle: float = 0.0) -> CycleSolution:
        """Return the outcome; its states are those with which the last pitch began, or where it stopped."""
        machinery, moved = self.machinery, 0.0 if status == FAILED else self.gap
        if status != FAILED:
            machinery.install_coupled()
        life, turns, impacts = machinery.trajectory.copy(), self.number / self.c.chambers, machinery.impacts
        lasting = self.corrections.lasting() if status == OK else None
        how = TOGETHER, self.rtol, angle, moved
        return CycleSolution(status, life, self.q, self.y, turns, *how, impacts=impacts, lasting=lasting)


def _settled(seen: list[tuple[float, float]], tolerance: float, least: float) -> bool:
    """Tell whether trapped mass and work of the last three pitches agree."""
    return len(seen) >= 3 and max(change(seen[-1], old, least) for old in seen[-3:-1]) <= tolerance


def _lead_nowhere(gaps: list[float], count: int) -> bool:
    """Tell whether so many last pitches changed much, and hardly less in the end: a machine that swings goes on to."""
    if len(gaps) < count:
        return False
    before, last = min(gaps[-count : -count // 2]), min(gaps[-count // 2 :])
    return last > max(LOST, NEARER * before)


def _stands(gaps: list[float], tolerance: float) -> bool:
    """Tell whether the states of the last pitch agree, or stall near that: what is left is noise of the steps."""
    if gaps[-1] <= tolerance:
        return True
    stalled = len(gaps) > 2 * STALL and min(gaps[-STALL:]) >= 0.5 * min(gaps[:-STALL])
    return stalled and NEAR * gaps[-1] <= tolerance


def chambers_at_pitches(machinery: Machinery) -> Array:
    """Return the states of all chambers at the start of a pitch, read from the last history."""
    c = machinery.composition
    times, dense, _, steps = machinery.last()
    states = []
    for j in range(c.chambers):
        i = int(np.searchsorted(times[: steps + 1], j * c.P[P_PITCH] + 1e-9, side="right")) - 1
        i = max(0, i - 1) if abs(times[i] - j * c.P[P_PITCH]) < 1e-9 and i > 0 else i
        theta = (j * c.P[P_PITCH] - times[i]) / (times[i + 1] - times[i])
        states.append(dense_value(theta, *dense[i])[: machinery.n])
    states = np.array(states)
    oil = slice(2, len(c.states) - len(c.own_states))
    states[:, oil] = np.maximum(states[:, oil], 0.0)  # the cubic of an oil ratio may dip below none by its error
    return states.ravel()
