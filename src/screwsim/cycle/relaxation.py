"""Waveform relaxation: one chamber's life after the other among the histories of its neighbours.

A turn integrates a life, reading the neighbours ahead from the last turn and those behind from this one; it is repeated
until the trapped mass, the work and the balances stand (docs/explanation/numerics.md).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from screwsim.cycle.balances import LEAST_WORK, residuals
from screwsim.cycle.coordinates import NEAR, change, logarithms, states_of
from screwsim.cycle.feedback import image as image_of
from screwsim.cycle.feedback import set_unknowns, unknowns
from screwsim.cycle.linear_pitch import Tangents
from screwsim.cycle.mixing import finer
from screwsim.cycle.newton import Corrections, led
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import NO_HOPE, CycleSolution, Hope
from screwsim.cycle.wanted import ENOUGH, Wanted
from screwsim.model.run import Machinery
from screwsim.model.slots import P_LIFE, R_TRAPPED
from screwsim.numerics.periodic import Anderson

Array = np.ndarray
DEAR = 80_000  # evaluations that simultaneous closing takes in the median, with steps of
DEAR_RTOL = 1e-4  # this tolerance; waveforms may take as many
FIRST_RTOL = 1e-3  # of the first turn; later ones follow the gap
AHEAD = 0.05  # tolerance of a turn over the gap of the one before: what it is hoped to contract by
GOOD = 0.1  # gap of a guess up to which a loose first turn would do more harm than it saves
DEPTH = 5  # of Anderson's method
MAX_TURNS = 40
SLOW = 0.3  # change of a turn over that of the one before, above which Newton corrects it
FAR = 0.02  # gap above which the second turn is corrected: how fast turns contract is told by the third
FARTHEST = 0.1  # change of the states (times `NEAR`) above which a linear correction tells nothing
STALL = 2  # corrected turns near the end without progress, after which steps are refined
PROGRESS = 0.5  # of the least gap before, below which a gap is progress
REFINED = 0.4  # tolerance of the steps then over that before
WORTH = 20.0  # of the tolerance: a change below it is left to the turns themselves


def dear(rtol: float) -> float:
    """Return the evaluations that waveforms may take with steps of a tolerance, by a method of order 4."""
    return DEAR * (DEAR_RTOL / rtol) ** 0.25


def relax(
    problem: Problem,
    machinery: Machinery,
    wanted: Wanted,
    y: Array,
    last: bool,
    hope: Hope = NO_HOPE,
    lent: Tangents | None = None,
) -> CycleSolution | None:
    """Close by turns from y [in place] and the last history; None when they do not and there is another way.

    They may cost as much as that other way does in the median (`last` is False): the two seldom cost more than twice
    the cheaper one. One turn maps (history, state at 0°, feedback unknowns) to the next; Anderson's method mixes the
    last images. The first turns are integrated loosely: their error is that of the guess. A guess made from cycles of
    machines nearby may be so good that the first turn closes: it is as fine as is hoped of the guess.
    """
    c, entries = machinery.composition, problem.entries
    c.P[c.widths] = wanted.widths
    accelerate, images = Anderson(DEPTH), []
    corrections = Corrections(problem, machinery, lent)
    met = unknowns(problem, machinery)
    least, stalled = np.inf, 0  # gap near the end, turns without progress there
    before, gap, turn, q = hope.seen, 1.0, 0, np.zeros(machinery.nq)
    finest = rtol = hope.share * wanted.of_histories * wanted.rtol
    first_rtol, first_gap = finest if hope.gap <= GOOD else FIRST_RTOL, 1.0
    most = machinery.evaluations_of(machinery.counts) + dear(wanted.rtol)

    def vector(values: Array) -> Array:
        """Return what a turn maps: states at 0° and along the last history, and the unknowns."""
        return np.concatenate([along(machinery, y), entries.coordinates(values)])

    def ended(status: str, angle: float = 0.0, gap: float = 0.0, residual: float = 0.0) -> CycleSolution:
        life, steps = machinery.trajectory.copy(), rtol if status == "failed" else finest
        first, impacts = first_gap if status == "ok" else 1.0, machinery.impacts
        return CycleSolution(
            *(status, life, q, y, turn, "histories", steps, angle, gap, "", first, residual / wanted.bound, impacts),
            tangents=corrections.last,
        )

    for turn in range(1, MAX_TURNS + 1):
        point = vector(met)
        steps_before = int(machinery.kept[1])
        rtol = max(finest, first_rtol if turn == 1 else min(0.5 * rtol, AHEAD * gap))
        status, angle, _, q = machinery.turn(y, rtol, 1e-3)
        if status != 0:
            return ended("failed", angle) if last else None
        machinery.swap()
        made = image_of(problem, machinery.trajectory, q)
        image = vector(made)
        now = (float(machinery.R[R_TRAPPED]), float(q[0]))
        least = LEAST_WORK * now[0] * problem.pv
        gap_before = gap
        gap, before = max(change(now, before, least), entries.change(made, met)), now
        moved = NEAR * float(np.max(np.abs(image - point)))
        if turn == 1:  # what was expected of mass and work may agree by chance: the states must, too
            gap = first_gap = max(gap, moved)
        if gap <= wanted.tolerance and rtol <= finest:
            residual = residuals(problem, machinery.R, q).largest
            if residual <= ENOUGH * wanted.bound:
                return ended("ok", gap=gap, residual=residual)
            if moved <= wanted.tolerance:  # else it is no matter of the steps yet
                finest = finer(finest, residual / wanted.bound)
        if not last and machinery.evaluations_of(machinery.counts) > most:
            return None
        near = gap <= WORTH * wanted.tolerance
        if corrections.begun and near and rtol <= finest:
            least, stalled = (gap, 0) if gap < PROGRESS * least else (least, stalled + 1)
            if stalled > STALL:  # what is corrected now is noise of the steps
                finest, least, stalled = REFINED * finest, np.inf, 0
        slow = turn > 1 and moved < FARTHEST and gap > (SLOW * gap_before if turn > 2 else FAR) and not near
        if corrections.due(slow, moved, near):
            begun = corrections.begun
            found = corrections.of_turn(steps_before, image[: machinery.n] - point[: machinery.n], q, met, made)
            if found is not None:
                if not begun:
                    accelerate.restart()
                made = led(problem, found, image[: machinery.n], y, made)
                image = vector(made)
        images = [*images, machinery.image()][-DEPTH - 1 :]
        weights, mixed = accelerate.mix(point, image)
        if len(weights) > 1 and np.max(np.abs(mixed - image)) < 0.3:
            machinery.blend(images[-len(weights) :], weights)
        else:
            mixed = image
        y[:] = states_of(mixed[: machinery.n], y, c)
        met = entries.values(mixed[len(mixed) - len(met) :], made)
        set_unknowns(problem, machinery, met)
    return ended("not_closed", gap=gap) if last else None


def along(machinery: Machinery, y: Array) -> Array:
    """Return the logarithms of the states y at 0° and of those along the last history."""
    c = machinery.composition
    angles = _angles(float(c.P[P_LIFE]), c.chambers)
    return logarithms(np.concatenate([y[None, : machinery.n], machinery.states_at(angles[1:])]), c)


@lru_cache(maxsize=8)
def _angles(life: float, chambers: int) -> Array:
    """Return where states are compared and mixed [rad]: at 0°, and from there on those of the last history."""
    return np.append(0.0, np.linspace(0.0, life, 8 * chambers, endpoint=False) + 1e-3)
