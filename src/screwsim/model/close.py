"""Closing the cycle: the periodic state of a chamber among neighbours that live the same life, a pitch apart.

Two ways (docs/explanation/numerics.md). *Histories*: integrate one chamber's life, reading the neighbours ahead from
the last turn and those behind from this one; repeat until the trapped mass, the work and the balances stand. *Coupled*:
integrate all chambers over one pitch, accelerated by Anderson's method; conserves exactly, and converges where leakage
rules. `auto` takes histories as long as they have not cost as much as coupled chambers would.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, Protocol

import numpy as np

from screwsim.model.compose import Composition
from screwsim.model.pace import FULL, Mixing, Pace, Refining, finer
from screwsim.model.residues import LEAST_OIL, LEAST_WORK, Array
from screwsim.model.run import Machinery
from screwsim.model.slots import HELD, P_LIFE, P_PITCH, R_TRAPPED
from screwsim.numerics.integrators import DEFAULT, check_of
from screwsim.numerics.made import Entries
from screwsim.numerics.periodic import Anderson
from screwsim.numerics.rodas import dense_value

DEAR = 120_000  # evaluations that coupled chambers take in the median, with steps of
DEAR_RTOL = 1e-4  # this tolerance; the histories may take as many
ENOUGH = 0.8  # of the bound on the balances, with which a cycle counts as closed
STALL = 3  # pitches without progress of the states
NEAR = 0.1  # weight of a change of the states, which stall above the tolerance, beside that of mass and work
FIRST_RTOL = 1e-3  # of the first turn; later ones follow the gap
AHEAD = 0.05  # tolerance of a turn over the gap of the one before: what it is hoped to contract by
GOOD = 0.1  # gap of a guess up to which a loose first turn would do more harm than it saves
HISTORY_DEPTH = 5  # of Anderson's method for histories
MAX_TURNS = 40
MAX_PITCHES = 400
MAX_EVALUATIONS = 10_000_000  # of one chamber's rates, after which a cycle that does not close is given up


@dataclass(frozen=True)
class Wanted:
    """What counts as closed: `tolerance` on changes of mass and work, `bound` on the balances, `rtol` of a step.

    Steps of histories have `of_histories` times that `rtol`.
    """

    rtol: float
    tolerance: float
    bound: float
    closing: str
    of_histories: float = 1.0


@dataclass
class Closed:
    """The outcome of closing: quadratures of one chamber's life, how far it got, why it stopped."""

    status: str  # 'ok' | 'not_closed' | 'failed'
    q: Array
    y: Array
    turns: float
    how: str
    rtol: float
    angle: float = 0.0
    change: float = 0.0
    needed: str = ""  # the further try that it took; empty where the first did
    first_gap: float = 1.0  # what the first turn changed: how far the guess was off
    residue: float = 0.0  # of histories: the larger residue of mass and energy over their bound


class Hope(NamedTuple):
    """What is hoped of a guess: its trapped mass [kg] and work [J], and what the first turn will change.

    `share` is that of the wanted tolerance of a step with which the balances will close.
    """

    seen: tuple[float, float]
    gap: float
    share: float = 1.0


NO_HOPE = Hope((0.0, 0.0), 1.0)


class Task(Protocol):
    """What is to be closed: the machinery, what counts as closed, and what the cycle makes (model.made).

    `made` returns the numbers with which the last turn was integrated, `image` what that turn makes of them.
    """

    machinery: Machinery
    wanted: Wanted
    pv: float  # p/ρ of the suction line [J/kg], the scale of work

    entries: Entries

    def made(self) -> Array: ...
    def set_made(self, values: Array) -> None: ...
    def image(self, q: Array) -> Array: ...
    def residue(self, q: Array) -> float: ...


def _change(new: tuple[float, float], old: tuple[float, float], least_work: float) -> float:
    """Return the larger relative change of trapped mass and work."""
    mass = abs(new[0] - old[0]) / max(new[0], old[0], 1e-300)
    return max(mass, abs(new[1] - old[1]) / max(abs(new[1]), abs(old[1]), least_work))


def _logarithms(states: Array, c: Composition) -> Array:
    """Return ln of states, those that may be negative as they are: what closing iterates on.

    Oil not above LEAST_OIL of the gas counts as that, of one temperature, without dissolved gas.
    """
    raw, signed = states.reshape(-1, len(c.states)), list(c.signed)
    rows = np.maximum(raw, 1e-300)
    if c.carried:
        little = rows[:, 3] <= LEAST_OIL
        if little.any():
            rows[little, 2:4] = 1.0, LEAST_OIL
    logs = np.log(rows)
    if signed:
        logs[:, signed] = raw[:, signed]
    if c.dissolves and little.any():  # pyright: ignore[reportPossiblyUnboundVariable]
        logs[little, HELD] = 0.0  # pyright: ignore[reportPossiblyUnboundVariable]
    return logs.ravel()


def dear(rtol: float) -> float:
    """Return the evaluations that histories may take with steps of a tolerance, by a method of order 4."""
    return DEAR * (DEAR_RTOL / rtol) ** 0.25


def by_histories(task: Task, y: Array, last: bool, hope: Hope = NO_HOPE) -> Closed | None:
    """Close by histories; return None when they do not, and another way is allowed (`last` is False).

    They may cost as much as that other way does in the median: the two seldom cost more than twice the cheaper one.
    One turn maps (history, state at 0°, what the cycle makes) to the next; Anderson's method mixes the last images. The
    first turns are integrated loosely: their error is that of the guess. A guess made from cycles of machines nearby
    may be so good that the first turn closes: it is as fine as is hoped of the guess.
    """
    machinery, wanted = task.machinery, task.wanted
    c = machinery.composition
    angles = _angles(float(c.P[P_LIFE]), c.chambers)
    accelerate = Anderson(HISTORY_DEPTH)
    made = task.made()
    before, gap, turn, q = hope.seen, 1.0, 0, np.zeros(machinery.nq)
    finest = rtol = hope.share * wanted.of_histories * wanted.rtol
    first_rtol, first_gap = finest if hope.gap <= GOOD else FIRST_RTOL, 1.0
    most = machinery.evaluations_of(machinery.counts) + dear(wanted.rtol)
    for turn in range(1, MAX_TURNS + 1):
        point = _vector(task, _all_states(machinery, y, angles), made)
        rtol = max(finest, first_rtol if turn == 1 else min(0.5 * rtol, AHEAD * gap))
        status, angle, _, q = machinery.turn(y, rtol, 1e-3)
        if status != 0:
            return Closed("failed", q, y, turn, "histories", rtol, angle) if last else None
        machinery.swap()
        made_image = task.image(q)
        image = _vector(task, _all_states(machinery, y, angles), made_image)
        now = (float(machinery.R[R_TRAPPED]), float(q[0]))
        least = LEAST_WORK * now[0] * task.pv
        gap, before = max(_change(now, before, least), task.entries.change(made_image, made)), now
        states = NEAR * float(np.max(np.abs(image - point)))
        if turn == 1:  # what was expected of mass and work may agree by chance: the states must, too
            gap = first_gap = max(gap, states)
        if gap <= wanted.tolerance and rtol <= finest:
            residue = task.residue(q)
            if residue <= ENOUGH * wanted.bound:
                over = residue / wanted.bound
                return Closed("ok", q, y, turn, "histories", finest, change=gap, first_gap=first_gap, residue=over)
            if states <= wanted.tolerance:  # else it is no matter of the steps yet
                finest = finer(finest, residue / wanted.bound)
        if not last and machinery.evaluations_of(machinery.counts) > most:
            return None
        machinery.remember()
        mixed = _mixed(machinery, accelerate, point, image)
        y[:] = _states(mixed[: machinery.n], y, c)
        made = task.entries.values(mixed[len(mixed) - len(made) :], made_image)
        task.set_made(made)
    return Closed("not_closed", q, y, turn, "histories", finest, change=gap) if last else None


@lru_cache(maxsize=8)
def _angles(life: float, chambers: int) -> Array:
    """Return where states are compared and mixed [rad]: at 0°, and from there on those of the last history."""
    return np.append(0.0, np.linspace(0.0, life, 8 * chambers, endpoint=False) + 1e-3)


def _states(mixed: Array, raw: Array, c: Composition) -> Array:
    """Return states from mixed `_logarithms`; oil too little to count keeps its raw value: mixing makes none."""
    rows, raw, signed = mixed.reshape(-1, len(c.states)), raw.reshape(-1, len(c.states)), list(c.signed)
    logs = rows.copy()
    if signed:
        logs[:, signed] = 0.0
    states = np.exp(logs)
    if signed:
        states[:, signed] = rows[:, signed]
    if c.carried:
        little = raw[:, 3] <= LEAST_OIL
        if little.any():
            oil = slice(2, HELD + 1 if c.dissolves else HELD)
            states[little, oil] = raw[little, oil]
    return states.ravel()


def _all_states(machinery: Machinery, y: Array, angles: Array) -> Array:
    """Return the states at 0° and those of the last history at the other angles, one row an angle."""
    return np.concatenate([y[None, : machinery.n], machinery.states_at(angles[1:])])


def _vector(task: Task, states: Array, made: Array) -> Array:
    """Return what one turn maps: `_all_states`, and what the cycle makes (`_logarithms`)."""
    return np.concatenate([_logarithms(states, task.machinery.composition), task.entries.coordinates(made)])


def _mixed(machinery: Machinery, accelerate: Anderson, point: Array, image: Array) -> Array:
    """Mix the last images in place as the next history; return the mixed vector."""
    weights, mixed = accelerate.mix(point, image)
    if len(weights) > 1 and np.max(np.abs(mixed - image)) < 0.3:
        machinery.mix(weights)
    else:
        mixed = image
    return mixed


def by_coupling(
    task: Task, y: Array, pace: Pace = FULL, most: int = MAX_EVALUATIONS, pitches: int = MAX_PITCHES
) -> Closed:
    """Close all chambers over one pitch; the fixed point in logarithms of the states, accelerated."""
    machinery, wanted = task.machinery, task.wanted
    c = machinery.composition
    mixing, refining = Mixing(pace), Refining(wanted.rtol, wanted.tolerance, wanted.bound)
    made = task.made()
    seen: list[tuple[float, float]] = []
    gaps: list[float] = []
    n, gap, pitch, q = len(y), 1.0, 0, np.zeros(machinery.nq)
    rtol = wanted.rtol
    budget = int(machinery.counts[2]) + most
    for pitch in range(1, pitches + 1):
        if machinery.counts[2] > budget:
            break
        point = np.concatenate([_logarithms(y, c), task.entries.coordinates(made)])
        end, rtol = y.copy(), refining.rtol
        status, angle, _, q = machinery.pitch(end, rtol, 1e-3)
        if status != 0:
            return Closed("failed", q, end, pitch / c.chambers, "coupled", rtol, angle)
        seen.append((float(machinery.R[R_TRAPPED]), float(q[0])))
        if machinery.composition.pulsating:  # the image reads the flows of the pitch
            machinery.install_coupled()
        made_image = task.image(q)
        image = np.concatenate([_logarithms(machinery.shift(end), c), task.entries.coordinates(made_image)])
        gap = float(np.max(np.abs(image - point)))
        least = LEAST_WORK * seen[-1][0] * task.pv
        gaps.append(gap)
        if _settled(seen, wanted.tolerance, least) and _stands(gaps, wanted.tolerance):
            residue = task.residue(q)
            if residue <= ENOUGH * wanted.bound:
                machinery.install_coupled()
                return Closed("ok", q, y, pitch / c.chambers, "coupled", rtol, change=gap)
            refining.consider(gap, residue)
        mixed = mixing.next(point, image, gap)
        if refining.rtol < rtol:
            mixing.restart()
        y, made = _states(mixed[:n], machinery.shift(end), c), task.entries.values(mixed[n:], made_image)
        task.set_made(made)
    machinery.install_coupled()
    return Closed("not_closed", q, y, pitch / c.chambers, "coupled", rtol, change=gap)


def _settled(seen: list[tuple[float, float]], tolerance: float, least: float) -> bool:
    """Tell whether trapped mass and work of the last three pitches agree."""
    return len(seen) >= 3 and max(_change(seen[-1], old, least) for old in seen[-3:-1]) <= tolerance


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


def close(task: Task, y: Array, integrator: str = DEFAULT, hope: Hope = NO_HOPE) -> Closed:
    """Close the cycle from a first guess that is installed as the last history.

    With a check the coupled chambers are closed under it, from where our own method closes.
    """
    task.machinery.integrator = DEFAULT
    closed = _close(task, y, hope)
    if check_of(integrator) is None or closed.status == "failed":
        return closed
    task.machinery.integrator = integrator
    return by_coupling(task, chambers_at_pitches(task.machinery))


def again(task: Task, closed: Closed) -> Closed:
    """Close a closed cycle once more, with what is wanted of the task now."""
    if closed.how == "histories":
        return _close(task, closed.y, Hope(seen_of(task.machinery, closed), 0.0))
    return by_coupling(task, closed.y.copy())


def seen_of(machinery: Machinery, closed: Closed) -> tuple[float, float]:
    """Return the trapped mass [kg] and the work [J] of a closed cycle."""
    return float(machinery.R[R_TRAPPED]), float(closed.q[0])


def _close(task: Task, y: Array, hope: Hope = NO_HOPE) -> Closed:
    if task.wanted.closing in ("auto", "histories"):
        first = by_histories(task, y.copy(), task.wanted.closing == "histories", hope)
        if first is not None:
            return first
    return by_coupling(task, chambers_at_pitches(task.machinery))
