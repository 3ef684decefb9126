"""Simultaneous closing: all chambers over one pitch, accelerated by Anderson's method.

It evaluates each flow between chambers once, so that it conserves exactly, and converges where leakage rules
(docs/explanation/numerics.md).
"""

from __future__ import annotations

import numpy as np

from screwsim.cycle.balances import LEAST_WORK, residuals
from screwsim.cycle.coordinates import NEAR, change, logarithms, states_of
from screwsim.cycle.feedback import image as image_of
from screwsim.cycle.feedback import set_unknowns, unknowns
from screwsim.cycle.mixing import FULL, Mixing, MixingRule, Refining
from screwsim.cycle.newton import Corrections
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution
from screwsim.cycle.wanted import ENOUGH, Wanted
from screwsim.model.run import Machinery
from screwsim.model.slots import P_PITCH, R_TRAPPED
from screwsim.numerics.closings import TOGETHER
from screwsim.numerics.rodas import dense_value
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
    c, entries = machinery.composition, problem.entries
    c.P[c.widths] = wanted.widths
    corrections = Corrections(problem, machinery)
    mixing, refining = Mixing(rule), Refining(wanted.rtol, wanted.tolerance, wanted.bound)
    met = unknowns(problem, machinery)
    astray: tuple[Array, Array] | None = None  # states and unknowns before the first correction
    seen: list[tuple[float, float]] = []
    gaps: list[float] = []
    n, gap, pitch, q = len(y), 1.0, 0, np.zeros(machinery.nq)
    rtol = wanted.rtol
    budget = int(machinery.counts[2]) + (OF_A_CHECK * most if wanted.check else most)

    def ended(status: str, y: Array, pitch: int, angle: float = 0.0) -> CycleSolution:
        if status != FAILED:
            machinery.install_coupled()
        life, turns, moved = machinery.trajectory.copy(), pitch / c.chambers, 0.0 if status == FAILED else gap
        return CycleSolution(status, life, q, y, turns, TOGETHER, rtol, angle, moved, impacts=machinery.impacts)

    for pitch in range(1, pitches + 1):
        if machinery.counts[2] > budget:
            break
        point = np.concatenate([logarithms(y, c), entries.coordinates(met)])
        end, rtol = y.copy(), refining.rtol
        status, angle, _, q = machinery.pitch(end, rtol, 1e-3, check=wanted.check)
        if status != 0:
            return ended(FAILED, end, pitch, angle)
        seen.append((float(machinery.R[R_TRAPPED]), float(q[0])))
        if c.pulsating:  # the image reads the flows of the pitch
            machinery.install_coupled()
        made = image_of(problem, machinery.trajectory, q)
        image = np.concatenate([logarithms(machinery.shift(end), c), entries.coordinates(made)])
        gap = float(np.max(np.abs(image - point)))
        gaps.append(gap)
        if (
            not patient
            and c.chambers > 1
            and rule.damping == 1.0
            and _lead_nowhere(gaps, IN_VAIN if rule.depth else IN_VAIN_PLAIN)
        ):
            break
        if _settled(seen, wanted.tolerance, LEAST_WORK * seen[-1][0] * problem.pv) and _stands(gaps, wanted.tolerance):
            residual = residuals(problem, machinery.R, q).largest
            if residual <= ENOUGH * wanted.bound:
                return ended(OK, y, pitch)
            refining.consider(gap, residual)
        corrected = rule is FULL and not c.pulsating  # states at a pitch's start kick what a line is given there
        if corrections.due(corrected and pitch > 1 and wanted.tolerance < gap < FARTHEST, gap):
            begun = corrections.begun
            if not begun:
                machinery.install_coupled()
                astray = astray or (y.copy(), met)
            found = corrections.of_pitch(image[:n] - point[:n], q, met, made)
            if found is not None:
                if not begun:
                    mixing.restart()
                image = np.concatenate([point[:n] + found.start, entries.coordinates(made) + found.unknowns])
        if astray is not None and not corrections.able:  # on without them, from where they began
            (y, met), astray = astray, None
            set_unknowns(problem, machinery, met)
            mixing.restart()
            continue
        mixed = mixing.next(point, image, gap)
        if refining.rtol < rtol:
            mixing.restart()
        y, met = states_of(mixed[:n], machinery.shift(end), c), entries.values(mixed[n:], made)
        set_unknowns(problem, machinery, met)
    return ended(NOT_CLOSED, y, pitch)


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
