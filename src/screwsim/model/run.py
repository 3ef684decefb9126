"""A composition ready to run: its arrays, one turn of a chamber, one pitch of all chambers.

`Machinery` owns the arrays that the compiled module reads and writes; nothing here knows what a cycle is used for.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from threading import Lock
from types import ModuleType
from typing import Any

import numpy as np

from screwsim.codegen.calls import Context
from screwsim.model import compiled, under_scipy
from screwsim.model.composition import Composition
from screwsim.model.slots import FREE, P_INJECTION, P_LIFE, P_PITCH, PORT_STATE
from screwsim.model.trajectory import ChamberContext, CoupledContext, Trajectory
from screwsim.model.turn_scheduler import scheduler
from screwsim.numerics.compiling import clock
from screwsim.numerics.frozen import with_changes
from screwsim.numerics.integrators import Check
from screwsim.numerics.reused_arrays import room
from screwsim.numerics.rodas import EVALUATED, JACOBIANS

MAX_STEPS = 60000  # capacity of a history; unwritten pages cost nothing
FIRST_STEP = 1e-3  # [rad] with which a turn or pitch begins, unless its caller knows better
MOST_CONTEXTS = 6  # that are kept
Array = np.ndarray


@dataclass
class CoupledArrays:
    """The arrays that the driver of all chambers reads and writes."""

    port_states: Array  # of the chambers and of the line beyond the last one, then the phase that each is held in;
    # of a single chamber its own cells
    work: Array
    history: tuple[Array, Array, Array]  # of one pitch: times, dense output of all chambers, quadratures
    kept: Array = field(default_factory=lambda: np.zeros(1, np.int64))  # steps of the history

    def last(self) -> tuple[Array, Array, int]:
        """Return (times, dense, steps) of the last pitch."""
        return self.history[0], self.history[1], int(self.kept[0])


class Machinery:
    """Arrays and drivers of one composition; `R` holds the plenums and what happened at the injection angle.

    The composition's numbers are a copy: writing to them affects nobody else.
    """

    def __init__(self, composition: Composition, module: ModuleType | None = None, max_steps: int = MAX_STEPS) -> None:
        self.composition = with_changes(composition, P=composition.P.copy())
        self.module = compiled.load(composition.text) if module is None else module
        self.n = n = len(composition.states)
        self.nq = composition.n_quadratures
        self.R = np.zeros(composition.n_R)
        self.max_steps = max_steps
        self.columns = n + composition.n_port_state
        self.histories = [self.new_history(max_steps, self.columns, self.nq) for _ in range(2)]
        self.kept = np.zeros(2, np.int64)
        self.hints = np.zeros(64, np.int64)
        cells = composition.own
        own = np.zeros(cells.size)
        own[cells.phase] = own[cells.held] = FREE
        self._at_first = own.copy()
        self.spaces = (np.zeros(self.columns), own)
        self.counts = np.zeros(4, np.int64)
        self._contexts: dict[tuple[int, ...], Context] = {}  # by ids of arrays, which it keeps alive
        self._rows: dict[int, tuple[Array, Array]] = {}  # buffers of `states_along`, by length
        self._reading = Lock()
        self.line_flows: dict[tuple[Any, ...], tuple[Array, Array]] = {}  # by lives of this composition
        self.compile_time = 0.0
        self.watch: Callable[[], None] = lambda: None  # called regularly; what it raises ends the work

    def begin(self, composition: Composition) -> None:
        """Take on another composition of the same structure, and reset everything of the one before."""
        own = self.composition.P
        lent = not own.flags.writeable  # the array belongs to somebody else
        if lent or composition.TAB is not self.composition.TAB or len(composition.P) != len(own):
            own = np.empty(len(composition.P))
            self._contexts.clear()
        own[:] = composition.P
        self.composition = with_changes(composition, P=own)
        self.reset()
        self.counts[:] = 0
        self.compile_time = 0.0
        self.watch = lambda: None

    @staticmethod
    def new_history(steps: int, n: int, nq: int) -> tuple[Array, Array, Array]:
        """Return arrays for a history: times, dense output of n columns, quadratures."""
        return room(steps + 1), room(steps, 4, n), room(steps, nq)

    @property
    def context(self) -> Context:
        """The context of one chamber: histories[0] is the last turn's, histories[1] the one being written."""
        c, (old, new) = self.composition, self.histories
        key = id(c.P), id(c.TAB), id(old[1]), id(new[1])
        if key not in self._contexts:
            if len(self._contexts) >= MOST_CONTEXTS:
                self._contexts.clear()
            histories = old[0], old[1], new[0], new[1]
            arrays = ChamberContext(c.P, c.TAB, self.R, *histories, self.kept, self.hints, *self.spaces)
            self._contexts[key] = Context(arrays)
        return self._contexts[key]

    def reset(self) -> None:
        """Reset run-time cells, search hints and histories."""
        self.line_flows = {}
        self.R[:] = 0.0
        self.spaces[1][:] = self._at_first
        self.hints[:] = 0
        self.kept[:] = 0

    def warm_up(self, start: Callable[[], Array]) -> None:
        """Compile (or load) the driver of one chamber, announced if it takes long; not counted as solution time."""
        if "one" not in compiled.warm_drivers(self.module):
            with self.compiling("one"):
                self.own_turn(start(), 1e-2)
                self.swap()
                self.states_at(np.array([0.1]))
                self.blend([self.image(), self.image()], np.array([0.5, 0.5]))
                if self.composition.pulsating:
                    self.trajectory.into_lines(1)

    @contextmanager
    def compiling(self, driver: str) -> Iterator[None]:
        """Announce what is compiled inside, unless it is ready; none of it counts as solution time or evaluations."""
        started, counts, R = clock(), self.counts.copy(), self.R.copy()
        with compiled.announce_first(self.module if driver == "one" else self.together, driver):
            yield
        self.counts[:], self.R[:] = counts, R
        self.compile_time += clock() - started

    def set_widths(self, widths: Sequence[float]) -> None:
        """Set the widths of the regularisation [Pa; gaps: a share]."""
        self.composition.P[self.composition.widths] = widths

    def turn(self, y: Array, rtol: float, h: float = FIRST_STEP) -> tuple[int, float, Array]:
        """Integrate one life from y (changed in place); return (status, angle reached [rad], quadratures).

        `h` [rad] is the first step.
        """
        self.watch()
        if scheduler.turn is not None:
            return scheduler.turn(self, y, rtol, h)
        return self.own_turn(y, rtol, h)

    def own_turn(self, y: Array, rtol: float, h: float = FIRST_STEP) -> tuple[int, float, Array]:
        """Do what `turn` does here, regardless of a scheduler of this thread."""
        c = self.composition
        q = np.zeros(self.nq)
        status, phi, _ = self.module.rodas__integrate_one(
            *(c.breakpoints, len(c.breakpoints), y, q, self.context, rtol, h, c.n_E),
            *(*self.histories[1], self.kept, self.counts),
        )
        return int(status), float(phi), q

    def evaluations_of(self, counts: Sequence[int] | Array) -> int:
        """Return the evaluations of one chamber's right-hand side in counts, including those for Jacobians."""
        return int(counts[EVALUATED] + counts[JACOBIANS] * self.n)

    @property
    def impacts(self) -> int:
        """Impact events of the last turn, where something moves between seat and stop."""
        return int(self.spaces[1][self.composition.own.impacts]) if self.composition.stops else 0

    def swap(self) -> None:
        """Make the turn just integrated the last one."""
        self.histories.reverse()
        self.kept[1] = self.kept[0]
        self.kept[0] = 0

    def last(self) -> tuple[Array, Array, Array, int]:
        """Return (times, dense, quadratures, steps) of the last turn."""
        return (*self.histories[0], int(self.kept[1]))

    @property
    def trajectory(self) -> Trajectory:
        """The last turn as a view: the next turn overwrites it."""
        return Trajectory(
            self.composition, self.module, self.R, *self.last(), self.context, self._reading, self.line_flows
        )

    def put(self, trajectory: Trajectory) -> None:
        """Make a life the last turn, together with the numbers that it was integrated with."""
        self.composition.P[:], self.R[:] = trajectory.composition.P, trajectory.R
        steps = trajectory.steps
        self._make_room(steps)
        times, dense, quads = self.histories[0]
        times[: steps + 1], dense[:steps], quads[:steps] = trajectory.times, trajectory.dense, trajectory.quads
        self.kept[:] = 0, steps

    def image(self) -> tuple[Array, Array, int]:
        """Return a copy of the last turn's history, for blending with others."""
        times, dense, _, steps = self.last()
        return times[: steps + 1].copy(), dense[:steps].copy(), steps

    def blend(self, histories: Sequence[tuple[Array, Array, int]], weights: Array) -> None:
        """Replace the last history by a weighted sum of histories, on the steps of the last of them."""
        times, dense, steps = histories[-1]
        self._make_room(steps)
        old = self.histories[0]
        old[0][: steps + 1] = times
        self.kept[:] = 0, steps
        *others, last = weights.tolist()
        np.multiply(dense, last, out=old[1][:steps])
        for weight, (t, d, n) in zip(others, histories[:-1], strict=True):
            self.module.history__add_history(times, steps, t, d, n, weight, old[1])

    def states_at(self, angles: Array, before: int | None = None) -> Array:
        """Return the states of the last history at increasing angles [rad], one row for each angle.

        With `before`, those of the history before it, which had that many steps; valid until a turn overwrites
        it.
        """
        out = np.empty((len(angles), self.n))
        times, dense, _ = self.histories[0 if before is None else 1]
        steps = int(self.kept[1]) if before is None else before
        self.module.history__states_at(angles, times, dense, steps, out)
        return out

    def states_along(self, first: Array, angles: Array) -> Array:
        """Return a state (n,) followed by those of the last history at increasing angles [rad].

        The rows belong to this workspace: the next call overwrites them.
        """
        rows = self._rows.get(len(angles))
        if rows is None:
            every = np.empty((len(angles) + 1, self.n))
            rows = self._rows[len(angles)] = every, every[1:]  # kept, as calls remember the addresses of arrays
        rows[0][0] = first
        times, dense, _ = self.histories[0]
        self.module.history__states_at(angles, times, dense, int(self.kept[1]), rows[1])
        return rows[0]

    def install(self, times: Array, dense: Array, quads: Array | float) -> None:
        """Install a history of states as the last turn's, and compute the port states of its steps."""
        steps = len(dense)
        self._make_room(steps)
        old = self.histories[0]
        old[0][: steps + 1], old[1][:steps, :, : self.n], old[2][:steps] = times, dense, quads
        self.kept[:] = 0, steps
        self.module.port_states__port_states_along(old[1], steps, self.context)

    def _make_room(self, steps: int) -> None:
        """Enlarge the histories where they have too few steps."""
        if steps > self.max_steps:
            self.max_steps = steps
            self.histories = [self.new_history(steps, self.columns, self.nq) for _ in range(2)]

    # ---- all chambers together -------------------------------------------------------------------------------

    @cached_property
    def coupled(self) -> CoupledArrays:
        """The arrays of all chambers together, created on first use."""
        c = self.composition
        port_states = np.append(np.zeros((c.chambers + 1) * PORT_STATE), np.full(c.chambers, FREE))
        return CoupledArrays(
            self._at_first.copy() if self.alone else port_states,
            np.zeros(c.n_work_all),
            self.new_history(self.max_steps, c.chambers * self.n, self.nq + 1),
        )

    def pitch_breakpoints(self) -> Array:
        """Return the breakpoints of all chambers within one pitch [rad]."""
        pitch = self.composition.P[P_PITCH]
        breakpoints = np.sort(np.mod(self.composition.breakpoints, pitch))
        breakpoints = np.append(breakpoints[breakpoints < pitch - 1e-7], pitch)
        return np.concatenate([[0.0], breakpoints[np.diff(breakpoints, prepend=0.0) > 1e-7]])

    @property
    def coupled_context(self) -> Context:
        """The context of all chambers."""
        c = self.composition
        return Context(CoupledContext(c.P, c.TAB, self.R, self.coupled.port_states, self.coupled.work))

    def pitch(
        self, y: Array, rtol: float, h: float = FIRST_STEP, inset: float = 0.0, check: Check | None = None
    ) -> tuple[int, float, Array]:
        """Integrate all chambers over one pitch from y (in place), after injection; return as `turn` does.

        `inset` [rad] is left out at both ends, where a speed that is not periodic jumps. With a `check` its
        method integrates.
        """
        if self.alone:
            return self.turn(y, rtol, h) if check is None else under_scipy.life(self, check, y, rtol, h)
        if "all" not in compiled.warm_drivers(self.together):
            with self.compiling("all"):
                self.own_pitch(y.copy(), 1e-2, h)
        self.watch()
        if check is not None:
            return under_scipy.pitch(self, check, y, rtol, h)
        return self.own_pitch(y, rtol, h, inset)

    @cached_property
    def together(self) -> ModuleType:
        """The module of all chambers, loaded on first use."""
        return compiled.load(self.composition.together())

    @property
    def alone(self) -> bool:
        """Whether there is a single chamber, whose life is the pitch, integrated by its own driver."""
        return self.composition.chambers == 1

    def own_pitch(self, y: Array, rtol: float, h: float = FIRST_STEP, inset: float = 0.0) -> tuple[int, float, Array]:
        """Do what `pitch` does, with our own method."""
        c = self.composition
        self.inject(y)
        q = np.zeros(self.nq + 1)
        counts, breakpoints = np.zeros(4, np.int64), self.pitch_breakpoints()
        breakpoints[[0, -1]] += inset, -inset
        status, s, _ = self.together.rodas__integrate_all(
            breakpoints,
            len(breakpoints),
            y,
            q,
            self.coupled_context,
            rtol,
            h,
            c.n_E_all,
            *self.coupled.history,
            self.coupled.kept,
            counts,
        )
        self.counts += counts * (1, 1, c.chambers, c.chambers)  # counted as evaluations of one chamber
        return int(status), float(s), q[:-1]

    def inject(self, y: Array) -> None:
        """Inject oil into the chamber at the injection angle."""
        c = self.composition
        index = round(c.P[P_INJECTION] / c.P[P_PITCH])
        if index < c.chambers:
            self.module.chamber__inject(y, index * self.n, c.P, c.TAB, self.R)

    def shift(self, y: Array) -> Array:
        """Return the states a pitch later: each chamber moves on, the last starts anew with what it retained."""
        return np.concatenate([y[-self.n :], y[: -self.n]])

    def install_coupled(self) -> None:
        """Install the last pitch of all chambers as the history of one chamber's life."""
        if self.alone:
            if self.kept[0] > 0:
                self.swap()
            return
        c = self.composition
        times, dense, steps = self.coupled.last()
        t = np.concatenate([times[:steps] + j * c.P[P_PITCH] for j in range(c.chambers)] + [[c.P[P_LIFE]]])
        states = dense[:steps].reshape(steps, 4, c.chambers, self.n)
        life = np.concatenate([states[:, :, j] for j in range(c.chambers)])
        self.install(t, life, np.zeros((len(life), self.nq)))
        self.module.trace__work_along(*self.last(), self.context)
