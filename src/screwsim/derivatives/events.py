"""Events within the turn of a single chamber: what moves between seat and stop meets one, bounces or rests, and leaves.

Each event ends a slice, at an angle that is an unknown of the collocated cycle: there the position equals that of seat
or stop, or the push on what rests there reverses. Between two slices the states jump by the law of impact. As slices
move with their events, a small change passes one by the derivatives of that law alone.

Source: docs/reference/slider-crank.md S26, S32, S33 (`model.impacts`); docs/explanation/derivatives.md.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np

from screwsim.derivatives.mesh import Mesh
from screwsim.derivatives.rate_numbers import SMALL, RateNumbers
from screwsim.model.impacts import LEAVES, MOVES, SEATED, STOPPED
from screwsim.model.run import Machinery
from screwsim.model.slots import S_RHO, S_T
from screwsim.model.trajectory import Trajectory

Array = np.ndarray
SHIFT = 1e-6  # relative, for differences of a push by states and numbers: it is nearly linear
UNIT = 100.0  # [rad] of an event's angle as an unknown: a relative step of differences then moves it far above rounding
MOST_MOVED = 0.3  # of the distance between two events, or an event and a breakpoint, in one iteration
BEYOND = 1e-6  # of the lift, or of the push: what is left open that is no missed event
Changes = Sequence[tuple[int, RateNumbers]]  # of the numbers, by their columns


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

    def modes_at(self, angles: Array) -> Array:
        """Return the mode of each pair at angles [rad] that are none of an event (angles, pairs)."""
        return self.modes()[np.searchsorted(self.angles, angles)]

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


class LinearEvent(NamedTuple):
    """An event at the end of a slice, linearised at the states y before it, with given numbers."""

    slice: int
    laws: EventLaws
    event: Event
    y: Array
    at: RateNumbers

    def condition(self, now: Array, numbers: Changes) -> Array:
        """Return the changes (k,) of its condition by those of the states before it (N, k), and of some numbers."""
        found = self.laws.open_by_states(self.event, self.y, self.at) @ now
        for k, each in numbers:
            found[k] += self.laws.open_by_numbers(self.event, self.y, self.at, each)
        return found

    def jumped(self, now: Array, numbers: Changes) -> Array:
        """Return the changes of the states after it (N, k)."""
        found = self.laws.after_by_states(self.event, self.y, self.at)[:, None] * now
        for k, each in numbers:
            found[:, k] += self.laws.after_by_numbers(self.event, self.y, self.at, each)
        return found


@dataclass(frozen=True)
class Events:
    """The events of a pitch on a mesh whose slices end at all `seams` [rad]: breakpoints, corners of laws, events.

    Coupled chambers have none. The unknown of each is its angle, in `UNIT`: with it the slices between two seams move
    in proportion.
    """

    laws: EventLaws
    course: Course
    seams: Array
    passed: Sequence[int]  # the slices that end with an event

    @classmethod
    def of(cls, machinery: Machinery, course: Course, seams: Array, mesh: Mesh) -> Self:
        """Return the events of a course that seams of a mesh include."""
        return cls(EventLaws(machinery), course, seams, (np.searchsorted(mesh.edges, course.angles) - 1).tolist())

    @property
    def _ends(self) -> Iterator[tuple[int, Event]]:
        """The slices that end with an event, with that event."""
        return zip(self.passed, self.course.events, strict=True)

    def after(self, Y: Array, numbers: RateNumbers) -> Array:
        """Return the states after each event (events, N), from those at the nodes."""
        return np.array([self.laws.after(event, Y[k, -1], numbers) for k, event in self._ends])

    def open_(self, Y: Array, numbers: RateNumbers) -> Array:
        """Return what is open of the condition of each event."""
        return np.array([self.laws.open_(event, Y[k, -1], numbers) for k, event in self._ends])

    def linearised(self, Y: Array, numbers: RateNumbers) -> list[LinearEvent]:
        """Return the linearised events, in order."""
        return [LinearEvent(k, self.laws, event, Y[k, -1].copy(), numbers) for k, event in self._ends]

    def moves(self, edges: Array) -> Array:
        """Return how the edges of slices move with the unknown of each event (events, edges) [rad]."""
        if not self.passed:
            return np.zeros((0, len(edges)))
        return UNIT * hats(edges, self.seams, self.course.angles)

    def share_of_move(self, by: Array) -> float:
        """Return the share of a change of the unknowns that leaves the events in their order."""
        widths = np.diff(self.seams)
        moves = np.abs(np.diff(by @ self.moves(self.seams)))
        return min(1.0, MOST_MOVED / max(1e-300, float((moves / widths).max())))

    def moved(self, edges: Array, by: Array) -> tuple[Array, Self]:
        """Return the edges of the slices and the events after a change of the unknowns."""
        angles, seams = self.course.angles + UNIT * by, self.seams.copy()
        there = edges + by @ self.moves(edges)
        seams[np.searchsorted(seams, self.course.angles)] = angles
        there[np.array(self.passed, int) + 1] = angles
        return there, replace(self, course=self.course.moved(angles), seams=seams)

    def carried(self, edges: Array, seams: Array, course: Course) -> Array:
        """Return other edges of slices, whose seams and events were elsewhere, with these moved here."""
        found = np.interp(edges, seams, self.seams)
        found[np.searchsorted(edges, course.angles)] = self.course.angles
        return found

    def missed(self, Y: Array, mesh: Mesh, numbers: RateNumbers) -> str:
        """Return why the events are not those of the states; empty if they are."""
        return self.laws.missed(self.course.modes_at(mesh.middles), Y, numbers)


def hats(edges: Array, seams: Array, angles: Sequence[float] | Array) -> Array:
    """Return how edges move with each event (events, edges): slices between two seams move in proportion."""
    units = np.eye(len(seams))[np.searchsorted(seams, angles)]
    return np.array([np.interp(edges, seams, unit) for unit in units]).reshape(len(units), len(edges))
