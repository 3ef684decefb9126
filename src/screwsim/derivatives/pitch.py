"""The closed cycle as polynomials on slices of a pitch: nonlinear collocation, closed by Newton's method.

The states Y at the nodes, those at the pitch's start and the feedback unknowns u are solved for together: on each slice
Y = y₀ + h Σ a f(Y), after a pitch each chamber moves to the next place, oil is injected, and u equals its image. Its
derivatives are then those of a system of equations (implicit-function theorem), whatever steps found the cycle.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from screwsim.cycle.feedback import LineInflow, set_unknowns, unknowns
from screwsim.cycle.feedback import image as image_of
from screwsim.cycle.linear_pitch import shifted
from screwsim.cycle.problem import Problem
from screwsim.derivatives.events import Course
from screwsim.derivatives.mesh import Mesh
from screwsim.derivatives.radau import INTEGRALS, NODES
from screwsim.derivatives.rate_numbers import LinearEvent, RateNumbers
from screwsim.derivatives.sweeps import compiled as sweeps
from screwsim.model import compiled
from screwsim.model.numbers import oil_places
from screwsim.model.run import Machinery
from screwsim.model.slots import FREE, P_INJECTION, P_LIFE, P_PITCH, PORT_STATE, R_RATIO, R_SIZE
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.reused_arrays import empty

Array = np.ndarray
INSIDE = 1e-9  # share of a pitch before its end that still belongs to the same chamber


class Slopes(NamedTuple):
    """Rates at the nodes (slices, NODES, …): f of states, g of quadratures, then the derivatives of both by states."""

    f: Array
    g: Array
    by_states: Array
    g_by_states: Array


@dataclass
class CollocatedPitch:
    """All chambers over one pitch on slices, using a machinery on loan whose numbers are those of the cycle.

    Its tables are a copy that may be written to. On each slice chambers are held in `phases` (slices, chambers),
    those of the last history at its middle: slices end on phase borders, so that no node changes side during
    iteration.
    """

    problem: Problem
    machinery: Machinery
    mesh: Mesh
    phases: Array = field(init=False)

    def __post_init__(self) -> None:
        c = self.machinery.composition
        self.n, self.N, self.count = self.machinery.n, c.chambers * self.machinery.n, len(self.mesh.middles)
        self.q = self.machinery.nq + (c.chambers > 1)  # the last one of several is the gas across the injection angle
        self.phases = np.full((self.count, c.chambers), FREE)
        if self.has_phases:
            starts = float(c.P[P_PITCH]) * np.arange(c.chambers)[:, None]
            states = self.machinery.states_at((starts + self.mesh.middles).ravel())
            self.phases[:] = self.phases_of(states).reshape(c.chambers, -1).T

    # ---- numbers -----------------------------------------------------------------------------------------------

    @property
    def numbers(self) -> RateNumbers:
        """A copy of the current numbers."""
        c = self.machinery.composition
        return RateNumbers(c.P.copy(), c.TAB.copy(), self.machinery.R.copy())

    def put(self, numbers: RateNumbers) -> None:
        """Set the numbers that the rates use."""
        c = self.machinery.composition
        c.P[:], c.TAB[:], self.machinery.R[:] = numbers
        self.machinery.line_flows.clear()  # they do not know of other tables

    def put_with_cells(self, numbers: RateNumbers, by: float, change: Array) -> None:
        """Set the numbers that the rates use, with a multiple of a change of the cells that the injection sets."""
        self.put(numbers)
        self.machinery.R[R_RATIO:R_SIZE] += by * change[: self.run_cells]
        noted = self.noted
        if noted:
            self.machinery.composition.P[noted] += by * change[self.run_cells :]

    # ---- states ------------------------------------------------------------------------------------------------

    def read(self) -> Array:
        """Return the states at the nodes (slices, NODES, N), read from the last history."""
        c = self.machinery.composition
        pitch = float(c.P[P_PITCH])
        inside = np.minimum(self.mesh.angles.ravel(), pitch * (1.0 - INSIDE))
        at = self.machinery.states_at((pitch * np.arange(c.chambers)[:, None] + inside).ravel())
        return at.reshape(c.chambers, -1, self.n).transpose(1, 0, 2).reshape(self.count, NODES, self.N)

    def begin(self, Y: Array) -> Array:
        """Return the states at the pitch's start that follow from its end, after injection; set the run-time cells."""
        y = self.machinery.shift(np.ascontiguousarray(Y[-1, -1]))
        self.machinery.inject(y)
        return y

    def at_injection(self, Y: Array) -> Array:
        """Return the states before the injection, from those at the nodes."""
        return self.machinery.shift(np.ascontiguousarray(Y[-1, -1]))

    def injects(self, y: Array, numbers: RateNumbers) -> tuple[Array, Array]:
        """Return states y after the injection with given numbers (which it overwrites), and the cells it sets."""
        states, (P, TAB, R) = y.copy(), numbers
        self.machinery.module.chamber__inject(states, (self.injected or 0) * self.n, P, TAB, R)
        return states, np.concatenate([R[R_RATIO:R_SIZE], P[self.noted]])

    @property
    def injected(self) -> int | None:
        """The index of the chamber at the injection angle when a pitch starts; None where there is none."""
        c = self.machinery.composition
        index = round(float(c.P[P_INJECTION]) / float(c.P[P_PITCH]))
        return index if index < c.chambers else None

    run_cells = R_SIZE - R_RATIO  # number of cells in R; further ones are in P

    def cells(self) -> Array:
        """Return the run-time cells that the injection sets, and the parameters that it may set."""
        return np.concatenate([self.machinery.R[R_RATIO:R_SIZE], self.machinery.composition.P[self.noted]])

    def cells_as_numbers(self, change: Array) -> RateNumbers:
        """Return a change of the cells as a change of all numbers."""
        c, R = self.machinery.composition, np.zeros_like(self.machinery.R)
        R[R_RATIO:R_SIZE], P = change[: self.run_cells], np.zeros_like(c.P)
        P[self.noted] = change[self.run_cells :]
        return RateNumbers(P, np.zeros_like(c.TAB), R)

    @property
    def noted(self) -> list[int]:
        """Indices in P of the trapped gas that a pump uses (slots.P_TRAPPED), behind what `model.numbers` lays out."""
        parts = self.problem.parts
        return [oil_places(parts)["P_TRAPPED"]] if parts.pumped else []

    def missed(self, Y: Array) -> str:
        """Return why the events are not those of the states; empty if they are."""
        return ""

    @property
    def alone(self) -> bool:
        """Whether there is a single chamber."""
        return self.machinery.alone

    def before_injection(self, followed: Array) -> Array:
        """Return the changes of the states on which the cells depend, from those at all nodes (slices, NODES, N, k)."""
        return shifted(followed[-1, -1], self.machinery.composition.chambers)

    # ---- events ------------------------------------------------------------------------------------------------

    @property
    def passed(self) -> Sequence[int]:
        """The slices that end with an event."""
        return ()

    def after(self, Y: Array) -> Array:
        """Return the states after each event (events, N), from those at the nodes."""
        return np.empty((0, self.N))

    def begins(self, start: Array, Y: Array) -> Array:
        """Return the states at the start of each slice (slices, N)."""
        found = np.concatenate([start[None], Y[:-1, -1]])
        found[[k + 1 for k in self.passed]] = self.after(Y)
        return found

    @property
    def begin_at_rest(self) -> Sequence[int]:
        """The states that start with a value of their own, whatever they end with."""
        return ()

    def open_events(self, Y: Array) -> Array:
        """Return what is open of the condition of each event."""
        return np.empty(0)

    def linear_events(self, Y: Array) -> Sequence[LinearEvent]:
        """Return the linearised events, in order."""
        return ()

    @property
    def events_move(self) -> Array:
        """How the edges of slices move with the unknown of each event (events, edges)."""
        return np.empty((0, self.count + 1))

    def share_of_move(self, by: Array) -> float:
        """Return the share of a change of the events' unknowns that leaves them in their order."""
        return 1.0

    def move_events(self, by: Array) -> None:
        """Move the edges of slices with the unknowns of events."""

    def with_events_moved(self, edges: Array, seams: Array, course: Course) -> tuple[Array, Array, Course]:
        """Return other edges, the seams and the events where these are now."""
        return edges, seams, course

    # ---- rates -------------------------------------------------------------------------------------------------

    def rates(self, Y: Array, edges: Array | None = None) -> tuple[Array, Array]:
        """Return the rates of states and quadratures at the nodes, or at those of other edges."""
        mesh = self.mesh if edges is None else self.mesh.with_edges(edges)
        f, g = np.empty((self.count * NODES, self.N)), np.empty((self.count * NODES, self.q))
        asked = self._asked(Y, mesh)
        for rows in self.runs(self.of_nodes):
            self.machinery.together.slices__rates_at_all(*(e[rows] for e in asked), *self._context, f[rows], g[rows])
        return f.reshape(self.count, NODES, -1), g.reshape(self.count, NODES, -1)

    @property
    def of_nodes(self) -> Array:
        """The slice of each node."""
        return np.repeat(np.arange(self.count), NODES)

    def runs(self, of: Array) -> Iterator[slice]:
        """Yield ranges of rows with equal phases, with the chambers held in these; `of` is the slice of each row."""
        if not self.holds:  # all are free
            yield slice(0, len(of))
            return
        cells, held = self._held(), self.held[of]
        ends, free = np.flatnonzero((held[1:] != held[:-1]).any(axis=1)) + 1, cells.copy()
        try:
            for low, high in pairwise([0, *ends.tolist(), len(of)]):
                cells[:] = held[low]
                yield slice(low, high)
        finally:
            cells[:] = free

    def rates_in(self, phases: Array, edge: int, y: Array) -> tuple[Array, Array]:
        """Return the rates of states and quadratures at the start of a slice, for states y, chambers held in phases."""
        mesh, f, g = self.mesh, np.empty((1, self.N)), np.empty((1, self.q))
        cells = self._held()
        free = cells.copy()
        cells[:] = self.held[edge]
        cells[: len(phases)] = phases
        asked = mesh.edges[edge : edge + 1], mesh.middles[edge : edge + 1], np.array(y[None])
        self.machinery.together.slices__rates_at_all(*asked, *self._context, f, g)
        cells[:] = free
        return f[0], g[0]

    @property
    def holds(self) -> bool:
        """Whether chambers are held in anything."""
        return self.has_phases

    @property
    def held(self) -> Array:
        """What the chambers are held in on each slice (slices, …), the phases first."""
        return self.phases

    @property
    def has_phases(self) -> bool:
        """Whether the gas of a chamber can have two phases."""
        return self.problem.parts.gas.phased_state is not None

    def phases_of(self, y: Array) -> Array:
        """Return the phase of the gas for states of a chamber, a row each."""
        c, found = self.machinery.composition, np.empty(len(y))
        self.machinery.module.trace__phases(y, c.P, c.TAB, found)
        return found.astype(int)

    def slopes(self, Y: Array) -> Slopes:
        """Return the rates and their derivatives by the states at the nodes."""
        *found, _ = self._slopes(self.of_nodes, *self._asked(Y, self.mesh))
        return Slopes(*(each.reshape(self.count, NODES, *each.shape[1:]) for each in found))

    def by_own_states(self, Y: Array, slices: Array) -> Array:
        """Return the derivatives of each chamber's rates by its own states at the nodes of some slices.

        The order is chamber by chamber (chambers slices, NODES, n, n).
        """
        angles, of = self.mesh.angles[slices].ravel(), np.repeat(slices, NODES)
        y = np.ascontiguousarray(Y[slices]).reshape(-1, self.N)
        found = self._slopes(of, angles, self.mesh.middles[of], y, alone=True)[-1]
        return found.reshape(-1, NODES, self.n, self.n)

    def slopes_at(self, angles: Array, y: Array) -> tuple[Array, Array]:
        """Return the rates at one angle in each slice, and the derivatives of each chamber's by its own states."""
        f, *_, own = self._slopes(np.arange(self.count), angles, self.mesh.middles, y, alone=True)
        return f, own.reshape(-1, len(angles), self.n, self.n)

    def _slopes(self, of: Array, *asked: Array, alone: bool = False) -> tuple[Array, ...]:
        """Return the kernel's results at rows of slices `of`.

        With `alone` only rates and each chamber's own derivatives. The latter are ordered chamber by chamber
        (chambers, rows, n, n).
        """
        many, N, q, n = len(of), self.N, self.q, self.n
        rows = 1 if alone else many
        own = empty(N // n, many, n, n) if alone else np.empty((0, 0, n, n))
        found = np.empty((many, N)), np.empty((rows, q)), empty(rows, N, N), empty(rows, q, N), own
        for run in self.runs(of):
            f, *rest = (each[run] if len(each) == many else each for each in found[:-1])
            apart = own if run == slice(0, many) or not alone else empty(N // n, run.stop - run.start, n, n)
            self._derived(*(each[run] for each in asked), *self._context, f, *rest, apart.reshape(-1, n, n))
            if apart is not own:
                own[:, run] = apart
        return found

    def _derived(self, *asked: Any) -> None:
        """Call the kernel of derivatives, compiling it first where necessary."""
        module = self.machinery.together
        if "tangents" not in compiled.warm_drivers(module):
            with self.machinery.compiling("tangents"):
                module.slices__derivatives_at_all(*asked)
        module.slices__derivatives_at_all(*asked)

    def _asked(self, Y: Array, mesh: Mesh) -> tuple[Array, Array, Array]:
        """Return angles, middles and states in the form that the kernels take."""
        return mesh.angles.ravel(), mesh.middles[self.of_nodes], np.ascontiguousarray(Y).reshape(-1, self.N)

    @property
    def _context(self) -> tuple[Any, int]:
        """The last arguments of the kernels."""
        return self.machinery.coupled_context, self.machinery.composition.n_E_all

    def _held(self) -> Array:
        """Return the cells that hold what chambers are held in."""
        return self.machinery.coupled.port_states[(self.machinery.composition.chambers + 1) * PORT_STATE :]

    # ---- reading -----------------------------------------------------------------------------------------------

    def sums(self, g: Array, widths: Array | None = None) -> Array:
        """Return the quadratures over the pitch from their rates at the nodes; a further axis is kept."""
        found = np.einsum("k,j,kj...->...", self.mesh.widths if widths is None else widths, INTEGRALS[-1], g)
        return found[: self.machinery.nq]

    def life(self, y: Array, Y: Array, after: Array) -> Array:
        """Return the dense output (…, steps, 4, n) of a life from states at start and nodes, or changes of these.

        They are followed by those after each event (events, N, …). All may have a further axis at the end, which
        becomes the first.
        """
        columns, steps = Y.shape[3:], self.N // self.n * self.count
        found = empty(*(columns or (1,)), steps, 4 * self.n)
        firsts = [0, *(k + 1 for k in self.passed), self.count]
        for begins, (low, high) in zip((y, *after), pairwise(firsts), strict=True):
            starts = np.ascontiguousarray(begins).reshape(self.N, -1)
            nodes = np.ascontiguousarray(Y[low:high]).reshape((high - low) * NODES, self.N, -1)
            part = found if len(firsts) == 2 else np.empty((len(found), high - low, 4 * self.n))
            sweeps().sweeps__lives(starts, nodes, self.n, part)
            if part is not found:
                found[:, low:high] = part
        return found.reshape(*columns, steps, 4, self.n)

    def install(self, y: Array, Y: Array) -> None:
        """Install the polynomials as the last history, from the states y at the start and Y at the nodes."""
        self.install_life(self.life(y, Y, self.after(Y)))

    def install_shifted(self, y: Array, Y: Array, by: float, change: Any) -> None:
        """Install the polynomials of states at the start and the nodes with a multiple of a `linear.Response`."""
        after = self.after(Y) + by * change.after
        edges = self.mesh.edges + by * (change.events @ self.events_move)
        self.install_life(self.life(y + by * change.start, Y + by * change.nodes, after), edges)

    def install_life(self, life: Array, edges: Array | None = None) -> None:
        """Install a life's dense output as the last history."""
        machinery, c = self.machinery, self.machinery.composition
        edges = self.mesh.edges if edges is None else edges
        begins = float(c.P[P_PITCH]) * np.arange(c.chambers)[:, None] + edges[:-1]
        machinery.install(np.append(begins, c.P[P_LIFE]), life, 0.0)

    def image(self, q: Array, life: Trajectory, into: LineInflow | None) -> Array:
        """Return the next unknowns, in coordinates, after a life with quadratures q, and flows to lines if known."""
        return self.problem.entries.coordinates(image_of(self.problem, life, q, into=into))

    @property
    def unknowns_in(self) -> Array:
        """The current unknowns."""
        return unknowns(self.problem, self.machinery)

    def meet(self, coordinates: Array, raw: Array) -> None:
        """Set the unknowns from coordinates."""
        set_unknowns(self.problem, self.machinery, self.problem.entries.values(coordinates, raw))
