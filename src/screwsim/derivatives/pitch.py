"""The closed cycle as polynomials on slices of a pitch: nonlinear collocation, closed by Newton's method.

The states Y at the nodes, those at the pitch's start and the feedback unknowns u are solved for together: on each slice
Y = y₀ + h Σ a f(Y), a pitch on each chamber takes the next place, oil is injected, and u is what the cycle makes of it.
Its derivatives are then those of a system of equations (implicit-function theorem), whatever steps found the cycle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from screwsim.cycle.feedback import image as image_of
from screwsim.cycle.feedback import set_unknowns, unknowns
from screwsim.cycle.problem import Problem
from screwsim.derivatives.slices import INTEGRALS, NODES, Slices
from screwsim.derivatives.sweeps import compiled as sweeps
from screwsim.model import compiled
from screwsim.model.numbers import oil_places
from screwsim.model.run import Machinery
from screwsim.model.slots import FREE, P_INJECTION, P_LIFE, P_PITCH, PORT_STATE, R_RATIO, R_SIZE
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.reused import empty

Array = np.ndarray
INSIDE = 1e-9  # of a pitch: its end, of the chamber that is still there


class Numbers(NamedTuple):
    """What the rates take beside states and angle: parameters, tables and run-time cells; also a change of these."""

    P: Array
    TAB: Array
    R: Array

    def plus(self, by: float, change: Numbers) -> Numbers:
        """Return these and so many times a change of them."""
        return Numbers(*(one + by * more for one, more in zip(self, change, strict=True)))

    @property
    def nothing(self) -> bool:
        """Is this change none?"""
        return not any(each.any() for each in self)


class Slopes(NamedTuple):
    """Rates at the nodes (slices, NODES, …): f of the states, g of the quadratures, and both by the states."""

    f: Array
    g: Array
    by_states: Array
    g_by_states: Array


@dataclass
class Pitch:
    """All chambers over one pitch on slices; the machinery is lent, and its numbers are those of the cycle.

    Its tables are its own: they may be written into. On each slice chambers are held in `phases` (slices, chambers),
    those of the last history in its middle: slices end on the border, and no node goes to and fro over it.
    """

    problem: Problem
    machinery: Machinery
    slices: Slices
    phases: Array = field(init=False)

    def __post_init__(self) -> None:
        c = self.machinery.composition
        self.n, self.N, self.count = self.machinery.n, c.chambers * self.machinery.n, len(self.slices.middles)
        self.q = self.machinery.nq + 1  # gas across the injection angle last
        self.phases = np.full((self.count, c.chambers), FREE)
        if self.has_phases:
            starts = float(c.P[P_PITCH]) * np.arange(c.chambers)[:, None]
            states = self.machinery.states_at((starts + self.slices.middles).ravel())
            self.phases[:] = self.phases_of(states).reshape(c.chambers, -1).T

    # ---- numbers -----------------------------------------------------------------------------------------------

    @property
    def numbers(self) -> Numbers:
        """A copy of the numbers as they stand."""
        c = self.machinery.composition
        return Numbers(c.P.copy(), c.TAB.copy(), self.machinery.R.copy())

    def put(self, numbers: Numbers) -> None:
        """Let the rates take other numbers."""
        c = self.machinery.composition
        c.P[:], c.TAB[:], self.machinery.R[:] = numbers

    # ---- states ------------------------------------------------------------------------------------------------

    def read(self) -> Array:
        """Return the states at the nodes (slices, NODES, N) of the last history."""
        c = self.machinery.composition
        pitch = float(c.P[P_PITCH])
        inside = np.minimum(self.slices.angles.ravel(), pitch * (1.0 - INSIDE))
        at = self.machinery.states_at((pitch * np.arange(c.chambers)[:, None] + inside).ravel())
        return at.reshape(c.chambers, -1, self.n).transpose(1, 0, 2).reshape(self.count, NODES, self.N)

    def begin(self, Y: Array) -> Array:
        """Return the states at the pitch's start that follow from its end, oil injected; run-time cells are set."""
        y = self.machinery.shift(np.ascontiguousarray(Y[-1, -1]))
        self.machinery.inject(y)
        return y

    def injects(self, y: Array, numbers: Numbers) -> tuple[Array, Array]:
        """Return what `begin` makes of states y at the pitch's start with numbers (which it writes into), and cells."""
        states, (P, TAB, R) = y.copy(), numbers
        self.machinery.module.chamber__inject(states, (self.injected or 0) * self.n, P, TAB, R)
        return states, np.concatenate([R[R_RATIO:R_SIZE], P[self.noted]])

    @property
    def injected(self) -> int | None:
        """Which chamber stands at the injection angle at the pitch's start; none where that is no start of one."""
        c = self.machinery.composition
        index = round(float(c.P[P_INJECTION]) / float(c.P[P_PITCH]))
        return index if index < c.chambers else None

    run_cells = R_SIZE - R_RATIO  # the first of the cells; those that follow stand in P

    def cells(self) -> Array:
        """Return the run-time cells that the injection sets, and the parameters that it may note."""
        return np.concatenate([self.machinery.R[R_RATIO:R_SIZE], self.machinery.composition.P[self.noted]])

    def cells_as_numbers(self, change: Array) -> Numbers:
        """Return a change of the cells as one of all numbers."""
        c, R = self.machinery.composition, np.zeros_like(self.machinery.R)
        R[R_RATIO:R_SIZE], P = change[: self.run_cells], np.zeros_like(c.P)
        P[self.noted] = change[self.run_cells :]
        return Numbers(P, np.zeros_like(c.TAB), R)

    @property
    def noted(self) -> list[int]:
        """Where in P the trapped gas stands that a pump asks for (slots.P_TRAPPED): behind what `Numbers` laid out."""
        parts = self.problem.parts
        return [oil_places(parts)["P_TRAPPED"]] if parts.pumped else []

    # ---- rates -------------------------------------------------------------------------------------------------

    def rates(self, Y: Array, edges: Array | None = None) -> tuple[Array, Array]:
        """Return the rates of states and quadratures at the nodes, those of other edges where these are given."""
        slices = self.slices if edges is None else self.slices._replace(edges=edges)
        f, g = np.empty((self.count * NODES, self.N)), np.empty((self.count * NODES, self.q))
        asked = self._asked(Y, slices)
        for rows in self.runs(self.of_nodes):
            self.machinery.together.slices__rates_at_all(*(e[rows] for e in asked), *self._context, f[rows], g[rows])
        return f.reshape(self.count, NODES, -1), g.reshape(self.count, NODES, -1)

    @property
    def of_nodes(self) -> Array:
        """Of which slice each node is."""
        return np.repeat(np.arange(self.count), NODES)

    def runs(self, of: Array) -> Iterator[slice]:
        """Yield rows, each `of` a slice, that follow each other in the same phases: chambers are held in these."""
        held, phases = self._held(), self.phases[of]
        ends = np.flatnonzero((phases[1:] != phases[:-1]).any(axis=1)) + 1
        try:
            for low, high in pairwise([0, *ends.tolist(), len(of)]):
                held[:] = phases[low]
                yield slice(low, high)
        finally:
            held[:] = FREE

    def rates_in(self, phases: Array, edge: int, y: Array) -> tuple[Array, Array]:
        """Return the rates of states and quadratures where a slice begins, chambers held in phases, states y."""
        slices, f, g = self.slices, np.empty((1, self.N)), np.empty((1, self.q))
        self._held()[:] = phases
        asked = slices.edges[edge : edge + 1], slices.middles[edge : edge + 1], np.array(y[None])
        self.machinery.together.slices__rates_at_all(*asked, *self._context, f, g)
        self._held()[:] = FREE
        return f[0], g[0]

    @property
    def has_phases(self) -> bool:
        """Can the gas of a chamber have two phases?"""
        return self.problem.parts.gas.phased_state is not None

    def phases_of(self, y: Array) -> Array:
        """Return the phase of the gas at states of a chamber, a row each."""
        c, found = self.machinery.composition, np.empty(len(y))
        self.machinery.module.trace__phases(y, c.P, c.TAB, found)
        return found.astype(int)

    def slopes(self, Y: Array) -> Slopes:
        """Return rates and their derivatives by the states at the nodes."""
        *found, _ = self._slopes(self.of_nodes, *self._asked(Y, self.slices))
        return Slopes(*(each.reshape(self.count, NODES, *each.shape[1:]) for each in found))

    def by_own_states(self, Y: Array, slices: Array) -> Array:
        """Return the derivatives of each chamber's rates by its own states at the nodes of some slices.

        One chamber after the other (chambers slices, NODES, n, n).
        """
        angles, of = self.slices.angles[slices].ravel(), np.repeat(slices, NODES)
        y = np.ascontiguousarray(Y[slices]).reshape(-1, self.N)
        found = self._slopes(of, angles, self.slices.middles[of], y, alone=True)[-1]
        return found.reshape(-1, NODES, self.n, self.n)

    def slopes_at(self, angles: Array, y: Array) -> tuple[Array, Array]:
        """Return rates at one angle in each slice, and the derivatives of each chamber's by its own states."""
        f, *_, own = self._slopes(np.arange(self.count), angles, self.slices.middles, y, alone=True)
        return f, own.reshape(-1, len(angles), self.n, self.n)

    def _slopes(self, of: Array, *asked: Array, alone: bool = False) -> tuple[Array, ...]:
        """Return what the kernel finds at rows `of` slices: with `alone` nothing but rates and chambers by themselves.

        Those by themselves are one chamber after the other (chambers, rows, n, n).
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
        module = self.machinery.together
        if "tangents" not in compiled.warm(module):
            with self.machinery.compiling("tangents"):
                module.slices__derivatives_at_all(*asked)
        module.slices__derivatives_at_all(*asked)

    def _asked(self, Y: Array, slices: Slices) -> tuple[Array, Array, Array]:
        """Return angles, middles and states, as the kernels take them."""
        return slices.angles.ravel(), slices.middles[self.of_nodes], np.ascontiguousarray(Y).reshape(-1, self.N)

    @property
    def _context(self) -> tuple[Any, int]:
        return self.machinery.coupled_context, self.machinery.composition.n_E_all

    def _held(self) -> Array:
        """Return where the phases stand in which the gas of chambers is held."""
        return self.machinery.coupled_space()["spaces"][0][(self.machinery.composition.chambers + 1) * PORT_STATE :]

    # ---- reading -----------------------------------------------------------------------------------------------

    def sums(self, g: Array, widths: Array | None = None) -> Array:
        """Return the quadratures over the pitch from their rates at the nodes, a further axis kept."""
        return np.einsum("k,j,kj...->...", self.slices.widths if widths is None else widths, INTEGRALS[-1], g)[:-1]

    def life(self, y: Array, Y: Array) -> Array:
        """Return the dense output (…, steps, 4, n) of a life, from states at the start and nodes, or changes of these.

        These may have a further axis behind them, which becomes the first.
        """
        columns, steps = Y.shape[3:], self.N // self.n * self.count
        found = empty(*(columns or (1,)), steps, 4 * self.n)
        starts, nodes = (np.ascontiguousarray(each) for each in (y, Y))
        sweeps().sweeps__lives(starts.reshape(self.N, -1), nodes.reshape(self.count * NODES, self.N, -1), self.n, found)
        return found.reshape(*columns, steps, 4, self.n)

    def install(self, y: Array, Y: Array, edges: Array | None = None) -> None:
        """Make the polynomials the last history, from the states y at the start and those at the nodes."""
        self.install_life(self.life(y, Y), edges)

    def install_life(self, life: Array, edges: Array | None = None) -> None:
        """Make a life's dense output the last history."""
        machinery, c = self.machinery, self.machinery.composition
        edges = self.slices.edges if edges is None else edges
        begins = float(c.P[P_PITCH]) * np.arange(c.chambers)[:, None] + edges[:-1]
        machinery.install(np.append(begins, c.P[P_LIFE]), life, 0.0)

    def image(self, q: Array, life: Trajectory | None = None) -> Array:
        """Return what a life (None: the last history) of these quadratures makes of the unknowns, in coordinates."""
        return self.problem.entries.coordinates(image_of(self.problem, life or self.machinery.trajectory, q))

    @property
    def met(self) -> Array:
        """The unknowns as they stand."""
        return unknowns(self.problem, self.machinery)

    def meet(self, coordinates: Array, raw: Array) -> None:
        """Let the rates meet other unknowns."""
        set_unknowns(self.problem, self.machinery, self.problem.entries.values(coordinates, raw))
