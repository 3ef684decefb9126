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
from screwsim.model import all_chambers, compiled, under_scipy
from screwsim.model.composition import Composition
from screwsim.model.lives import Lives, new_history
from screwsim.model.slots import FREE, PORT_STATE
from screwsim.model.trajectory import ChamberContext, CoupledContext, Trajectory
from screwsim.model.turn_scheduler import scheduler
from screwsim.numerics.compiling import clock
from screwsim.numerics.frozen import with_changes
from screwsim.numerics.integrators import Check
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
        columns = n + composition.n_port_state
        self.lives = Lives(self.module, n, columns, self.nq, max_steps)
        self.hints = np.zeros(64, np.int64)
        cells = composition.own
        own = np.zeros(cells.size)
        own[cells.phase] = own[cells.held] = FREE
        self._at_first = own.copy()
        self.spaces = (np.zeros(columns), own)
        self.counts = np.zeros(4, np.int64)
        self._contexts: dict[tuple[int, ...], Context] = {}  # by ids of arrays, which it keeps alive
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

    @property
    def context(self) -> Context:
        """The context of one chamber, which reads the last life and writes the one being integrated."""
        c, (old, new) = self.composition, self.lives.histories
        key = id(c.P), id(c.TAB), id(old[1]), id(new[1])
        if key not in self._contexts:
            if len(self._contexts) >= MOST_CONTEXTS:
                self._contexts.clear()
            histories = old[0], old[1], new[0], new[1]
            arrays = ChamberContext(c.P, c.TAB, self.R, *histories, self.lives.kept, self.hints, *self.spaces)
            self._contexts[key] = Context(arrays)
        return self._contexts[key]

    def reset(self) -> None:
        """Reset run-time cells, search hints and histories."""
        self.line_flows = {}
        self.R[:] = 0.0
        self.spaces[1][:] = self._at_first
        self.hints[:] = 0
        self.lives.kept[:] = 0

    def warm_up(self, start: Callable[[], Array]) -> None:
        """Compile (or load) the driver of one chamber, announced if it takes long; not counted as solution time."""
        if "one" not in compiled.warm_drivers(self.module):
            with self.compiling("one"):
                self.own_turn(start(), 1e-2)
                lives = self.lives
                lives.swap()
                lives.states_at(np.array([0.1]))
                lives.blend([lives.image(), lives.image()], np.array([0.5, 0.5]))
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
            *(*self.lives.histories[1], self.lives.kept, self.counts),
        )
        return int(status), float(phi), q

    def evaluations_of(self, counts: Sequence[int] | Array) -> int:
        """Return the evaluations of one chamber's right-hand side in counts, including those for Jacobians."""
        return int(counts[EVALUATED] + counts[JACOBIANS] * self.n)

    @property
    def impacts(self) -> int:
        """Impact events of the last turn, where something moves between seat and stop."""
        return int(self.spaces[1][self.composition.own.impacts]) if self.composition.stops else 0

    @property
    def trajectory(self) -> Trajectory:
        """The last turn as a view: the next turn overwrites it."""
        return Trajectory(
            self.composition, self.module, self.R, *self.lives.last(), self.context, self._reading, self.line_flows
        )

    def put(self, trajectory: Trajectory) -> None:
        """Make a life the last turn, together with the numbers that it was integrated with."""
        self.composition.P[:], self.R[:] = trajectory.composition.P, trajectory.R
        self.lives.store(trajectory.times, trajectory.dense, trajectory.quads)

    def install(self, times: Array, dense: Array, quads: Array | float) -> None:
        """Install a history of states as the last turn's, and compute the port states of its steps."""
        _, stored, _ = self.lives.store(times, dense, quads)
        self.module.port_states__port_states_along(stored, len(dense), self.context)

    # ---- all chambers together -------------------------------------------------------------------------------

    @cached_property
    def coupled(self) -> CoupledArrays:
        """The arrays of all chambers together, created on first use."""
        c = self.composition
        port_states = np.append(np.zeros((c.chambers + 1) * PORT_STATE), np.full(c.chambers, FREE))
        return CoupledArrays(
            self._at_first.copy() if self.alone else port_states,
            np.zeros(c.n_work_all),
            new_history(self.lives.max_steps, c.chambers * self.n, self.nq + 1),
        )

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
                all_chambers.own_pitch(self, y.copy(), 1e-2, h)
        self.watch()
        if check is not None:
            return under_scipy.pitch(self, check, y, rtol, h)
        return all_chambers.own_pitch(self, y, rtol, h, inset)

    @cached_property
    def together(self) -> ModuleType:
        """The module of all chambers, loaded on first use."""
        return compiled.load(self.composition.together())

    @property
    def alone(self) -> bool:
        """Whether there is a single chamber, whose life is the pitch, integrated by its own driver."""
        return self.composition.chambers == 1
