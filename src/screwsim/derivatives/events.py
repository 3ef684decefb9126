"""Events within the turn of a single chamber: what moves between seat and stop meets one, bounces or rests, and leaves.

Each event ends a slice, at an angle that is an unknown of the collocated cycle: there the position equals that of seat
or stop, or the push on what rests there reverses. Between two slices the states jump by the law of impact. As slices
move with their events, a small change passes one by the derivatives of that law alone.

Source: docs/reference/slider-crank.md S26, S32, S33 (`model.impacts`); docs/explanation/derivatives.md.
"""

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np

from screwsim.derivatives.rate_numbers import RateNumbers
from screwsim.model.impacts import LEAVES, MOVES, SEATED, STOPPED
from screwsim.model.run import Machinery
from screwsim.model.slots import S_RHO, S_T
from screwsim.model.trajectory import Trajectory

Array = np.ndarray
SHIFT = 1e-6  # relative, for differences of a push by states and numbers: it is nearly linear
SMALL = 1e-3  # least size of a state, for that
UNIT = 100.0  # [rad] of an event's angle as an unknown: a relative step of differences then moves it far above rounding
BEYOND = 1e-6  # of the lift, or of the push: what is left open that is no missed event


class Event(NamedTuple):
    """An event of a pair of position and speed: `what` meets (SEATED, STOPPED) or LEAVES, and whether it rests then."""

    pair: int
    what: float
    rests: bool


class Course(NamedTuple):
    """The events of a turn: their angles [rad], which event each is, and the modes of all pairs before the first."""

    angles: Array
    events: tuple[Event, ...]
    begins: tuple[float, ...]

    def modes(self) -> Array:
        """Return the mode of each pair between the events (events + 1, pairs)."""
        found = np.tile(np.array(self.begins), (len(self.events) + 1, 1))
        for k, event in enumerate(self.events):
            found[k + 1 :, event.pair] = event.what if event.rests else MOVES
        return found

    @property
    def returns(self) -> bool:
        """Whether what rests at the end of the turn does so at its start, and nothing else."""
        return tuple(self.modes()[-1].tolist()) == self.begins

    def moved(self, angles: Array) -> Self:
        """Return the same events at other angles."""
        return self._replace(angles=angles)


def course_of(life: Trajectory) -> Course:
    """Return the events of a life as it was integrated: steps end at them, and what rests does not move at all."""
    stops, steps = life.composition.stops, life.steps
    times, dense, found, begins = life.times, life.dense[:steps], [], []
    for pair, (i, j) in enumerate(stops):
        x, v = dense[:, :, i], dense[:, :, j]
        still = (x[:, 0] == x[:, 1]) & (x[:, 2:] == 0.0).all(axis=1) & (v == 0.0).all(axis=1)
        modes = np.where(still, np.where(x[:, 0] == 0.0, SEATED, STOPPED), MOVES)
        begins.append(float(modes[0]))
        leaves = (modes[:-1] != MOVES) & (modes[1:] == MOVES)
        meets = (modes[:-1] == MOVES) & ((modes[1:] != MOVES) | (v[:-1, 1] != v[1:, 0]))
        for k in np.flatnonzero(leaves | meets).tolist():
            side = LEAVES if leaves[k] else (SEATED if v[k, 1] < 0.0 else STOPPED)
            found.append((float(times[k + 1]), Event(pair, side, bool(modes[k + 1] != MOVES))))
    found.sort(key=lambda one: one[0])
    return Course(np.array([angle for angle, _ in found]), tuple(event for _, event in found), tuple(begins))


class EventLaws:
    """The conditions and jumps of events, and their derivatives, with the numbers of a machinery on loan."""

    def __init__(self, machinery: Machinery) -> None:
        self.machinery, self.stops = machinery, machinery.composition.stops

    def open_(self, event: Event, y: Array, numbers: RateNumbers) -> float:
        """Return what is open of an event's condition at the states before it: a position, or a push."""
        if event.what == LEAVES:
            P, TAB, R = numbers
            return float(self.machinery.module.push_on(event.pair, float(y[S_T]), float(y[S_RHO]), y, R, P, TAB))
        return float(y[self.stops[event.pair][0]]) - 0.5 * (1.0 + event.what)

    def open_by_states(self, event: Event, y: Array, numbers: RateNumbers) -> Array:
        """Return the derivatives of that by the states."""
        found = np.zeros(len(y))
        if event.what != LEAVES:
            found[self.stops[event.pair][0]] = 1.0
            return found
        for i in range(len(y)):
            step = SHIFT * max(abs(y[i]), SMALL)
            sides = [self.open_(event, np.where(np.arange(len(y)) == i, y + by, y), numbers) for by in (step, -step)]
            found[i] = (sides[0] - sides[1]) / (2.0 * step)
        return found

    def open_by_numbers(self, event: Event, y: Array, numbers: RateNumbers, change: RateNumbers) -> float:
        """Return the derivative of that along a change of the numbers."""
        if event.what != LEAVES:
            return 0.0
        sides = [self.open_(event, y, numbers.plus(by, change)) for by in (SHIFT, -SHIFT)]
        return (sides[0] - sides[1]) / (2.0 * SHIFT)

    def after(self, event: Event, y: Array, numbers: RateNumbers) -> Array:
        """Return the states after an event, from those before it."""
        found = y.copy()
        if event.what != LEAVES:
            (i, j), (P, TAB, R) = self.stops[event.pair], numbers
            cells = self.machinery.composition.own
            own = np.zeros(cells.size)
            own[cells.due][event.pair] = event.what
            self.machinery.module.chamber__take_event(found, 0.0, own, R, P, TAB)
            found[i] = 0.5 * (1.0 + event.what)
            found[j] = 0.0 if event.rests else found[j]
        return found

    def after_by_states(self, event: Event, y: Array, numbers: RateNumbers) -> Array:
        """Return the derivatives of each state after an event by the same one before it."""
        found = np.ones(len(y))
        if event.what != LEAVES:
            i, j = self.stops[event.pair]
            found[i], found[j] = 0.0, self.after(event, y, numbers)[j] / y[j]
        return found

    def after_by_numbers(self, event: Event, y: Array, numbers: RateNumbers, change: RateNumbers) -> Array:
        """Return the derivatives of the states after an event along a change of the numbers."""
        if event.what == LEAVES or event.rests or not change.P.any():
            return np.zeros(len(y))
        sides = [self.after(event, y, numbers.plus(by, change)) for by in (SHIFT, -SHIFT)]
        return (sides[0] - sides[1]) / (2.0 * SHIFT)

    def missed(self, modes: Array, Y: Array, numbers: RateNumbers) -> str:
        """Return what is wrong with the modes (slices, pairs) for states (slices, nodes, N); empty if nothing is.

        A push is asked for at the ends of slices alone.
        """
        P, TAB, R = numbers
        for pair, (i, _) in enumerate(self.stops):
            flies = Y[modes[:, pair] == MOVES][..., i]
            if len(flies) and (flies.min() < -BEYOND or flies.max() > 1.0 + BEYOND):
                return "a valve meets its seat or stop where the integrated turn does not"
            for side in (SEATED, STOPPED):
                for y in Y[modes[:, pair] == side][:, -1]:
                    push = self.machinery.module.push_on(pair, float(y[S_T]), float(y[S_RHO]), y, R, P, TAB)
                    if side * push < -BEYOND:
                        return "a valve leaves its seat or stop where the integrated turn does not"
        return ""


def hats(edges: Array, seams: Array, angles: Sequence[float] | Array) -> Array:
    """Return how edges move with each event (events, edges): slices between two seams move in proportion."""
    units = np.eye(len(seams))[np.searchsorted(seams, angles)]
    return np.array([np.interp(edges, seams, unit) for unit in units]).reshape(len(units), len(edges))
