"""The closed cycle of a single chamber as polynomials on slices of a turn: the events of valves are among its unknowns.

A slice ends at each event, where a valve meets seat or stop or leaves it, and moves with it (`derivatives.events`).
Nothing is injected: a turn starts with the states at its end, and cells that the injection angle sets are only read.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from screwsim.derivatives.events import UNIT, Course, Event, EventLaws, hats
from screwsim.derivatives.mesh import Mesh
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.radau import NODES
from screwsim.derivatives.rate_numbers import Changes, LinearEvent, RateNumbers
from screwsim.model.impacts import MOVES
from screwsim.model.slots import FREE, P_INJECTION, PORT_STATE, PRESSURE
from screwsim.numerics.history import NUDGE

Array = np.ndarray
MOST_MOVED = 0.3  # of the distance between two events, or an event and a breakpoint, in one iteration


class TurnEvent(NamedTuple):
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


@dataclass
class CollocatedTurn(CollocatedPitch):
    """A single chamber over one turn, on slices that end at all `seams`: breakpoints of the laws, corners, events."""

    seams: Array
    course: Course
    laws: EventLaws = field(init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.laws = EventLaws(self.machinery)
        self.switches = self._switches()
        self.modes = self.course.modes()[np.searchsorted(self.course.angles, self.mesh.middles)]

    def _switches(self) -> Array:
        """Return the switch of each path on each slice (slices, paths): whether a check valve is open; else FREE."""
        parts, life = self.problem.parts, self.machinery.trajectory
        found, middles = np.full((self.count, len(parts.ports)), FREE), self.mesh.middles
        for i, (_, path) in enumerate(parts.ports):
            if path.one_way:
                number = parts.number(path.to)
                line = float(life.R[number * PORT_STATE + PRESSURE])
                line = line * (1.0 + life.line_pulses(number, middles).sum(axis=1))
                found[:, i] = path.one_way * (line - life.pressures_at(middles)) > 0.0
        return found

    # ---- what a slice holds ------------------------------------------------------------------------------------

    @property
    def holds(self) -> bool:
        """Whether the chamber is held in anything."""
        return True

    @property
    def held(self) -> Array:
        """What the chamber is held in on each slice: the phase, then, as in its port state, switches and modes."""
        return np.hstack([self.phases, np.zeros_like(self.switches), self.switches, self.modes])

    def _held(self) -> Array:
        """Return the cells that hold what the chamber is held in."""
        return self.machinery.coupled.port_states[self.machinery.composition.own.holding]

    # ---- states ------------------------------------------------------------------------------------------------

    def read(self) -> Array:
        """Return the states at the nodes (slices, NODES, N), read from the last history: at events those before it."""
        angles = self.mesh.angles.copy()
        angles[:, -1] -= 2.0 * NUDGE
        return self.machinery.states_at(angles.ravel()).reshape(self.count, NODES, self.N)

    injected = 0  # index of the chamber whose cells are set

    def begin(self, Y: Array) -> Array:
        """Return the states at the turn's start that follow from its end; set the run-time cells."""
        P, TAB, R = self.machinery.composition.P, self.machinery.composition.TAB, self.machinery.R
        self.machinery.module.chamber__inject(self.at_injection(Y), 0, P, TAB, R)
        y = np.array(Y[-1, -1])
        for (position, speed), mode in zip(self.laws.stops, self.course.begins, strict=True):
            if mode != MOVES:
                y[position], y[speed] = 0.5 * (1.0 + mode), 0.0
        return y

    @property
    def begin_at_rest(self) -> Sequence[int]:
        """The states of what rests where the turn starts: it may rest for the whole turn."""
        pairs = zip(self.laws.stops, self.course.begins, strict=True)
        return [state for pair, mode in pairs if mode != MOVES for state in pair]

    @property
    def injection_slice(self) -> int:
        """The slice that ends at the angle where cells are set."""
        at = float(self.machinery.composition.P[P_INJECTION])
        return int(np.abs(self.mesh.edges[1:] - at).argmin())

    def at_injection(self, Y: Array) -> Array:
        """Return the states at the angle where cells are set."""
        return Y[self.injection_slice, -1].copy()

    def before_injection(self, followed: Array) -> Array:
        """Return the changes of the states on which the cells depend, from those at all nodes (slices, NODES, N, k)."""
        return followed[self.injection_slice, -1]

    # ---- events ------------------------------------------------------------------------------------------------

    @property
    def passed(self) -> Sequence[int]:
        """The slices that end with an event."""
        return (np.searchsorted(self.mesh.edges, self.course.angles) - 1).tolist()

    def after(self, Y: Array) -> Array:
        """Return the states after each event (events, N), from those at the nodes."""
        at, pairs = self.numbers, zip(self.passed, self.course.events, strict=True)
        return np.array([self.laws.after(event, Y[k, -1], at) for k, event in pairs]).reshape(-1, self.N)

    def open_events(self, Y: Array) -> Array:
        """Return what is open of the condition of each event."""
        at, pairs = self.numbers, zip(self.passed, self.course.events, strict=True)
        return np.array([self.laws.open_(event, Y[k, -1], at) for k, event in pairs])

    def linear_events(self, Y: Array) -> Sequence[LinearEvent]:
        """Return the linearised events, in order."""
        at, pairs = self.numbers, zip(self.passed, self.course.events, strict=True)
        return [TurnEvent(k, self.laws, event, Y[k, -1].copy(), at) for k, event in pairs]

    @property
    def events_move(self) -> Array:
        """How the edges of slices move with the unknown of each event (events, edges)."""
        return UNIT * hats(self.mesh.edges, self.seams, self.course.angles)

    def share_of_move(self, by: Array) -> float:
        """Return the share of a change of the events' unknowns that leaves them in their order."""
        widths = np.diff(self.seams)
        moves = np.abs(np.diff(by @ (UNIT * hats(self.seams, self.seams, self.course.angles))))
        return min(1.0, MOST_MOVED / max(1e-300, float((moves / widths).max())))

    def move_events(self, by: Array) -> None:
        """Move the edges of slices with the unknowns of events."""
        angles, passed = self.course.angles + UNIT * by, np.array(self.passed, int)
        edges, seams = self.mesh.edges + by @ self.events_move, self.seams.copy()
        seams[np.searchsorted(seams, self.course.angles)] = angles
        edges[passed + 1] = angles
        self.mesh, self.seams, self.course = Mesh.between(edges), seams, self.course.moved(angles)

    def with_events_moved(self, edges: Array, seams: Array, course: Course) -> tuple[Array, Array, Course]:
        """Return other edges, the seams and the events where these are now."""
        found = np.interp(edges, seams, self.seams)
        found[np.searchsorted(edges, course.angles)] = self.course.angles
        return found, self.seams, self.course

    def missed(self, Y: Array) -> str:
        """Return why the course of events is not that of the states; empty if it is."""
        return self.laws.missed(self.modes, Y, self.numbers)
