"""The closed cycle as polynomials on the slices of a pitch: nonlinear collocation, closed by Newton's method.

The states Y at the nodes, those at the pitch's start and the feedback unknowns u are solved for together: on each slice
Y = y₀ + h Σ a f(Y), after a pitch each chamber moves to the next place, oil is injected, and u equals its image. Its
derivatives are then those of a system of equations (implicit-function theorem), whatever steps found the cycle.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from screwsim.cycle.problem import Problem
from screwsim.derivatives.events import Course, Events
from screwsim.derivatives.held import held_of
from screwsim.derivatives.mesh import Mesh
from screwsim.derivatives.node_rates import NodeRates
from screwsim.derivatives.period import period_of
from screwsim.derivatives.radau import INTEGRALS, NODES
from screwsim.derivatives.rate_numbers import RateNumbers
from screwsim.derivatives.sweeps import compiled as sweeps
from screwsim.model.run import Machinery
from screwsim.model.slots import P_LIFE, P_PITCH
from screwsim.numerics.history import NUDGE
from screwsim.numerics.reused_arrays import empty

Array = np.ndarray
INSIDE = 1e-9  # share of a pitch before its end that still belongs to the same chamber


class CollocatedPitch:
    """All chambers over one pitch, or a single one over a turn, on a mesh: states at its nodes, and lives.

    It uses a machinery on loan whose numbers are those of the cycle; its tables are a copy that may be written to.
    `rates` are those at the nodes, `period` leads from the end to the next start, `events` end slices of a turn.
    """

    def __init__(self, problem: Problem, machinery: Machinery, mesh: Mesh, seams: Array, course: Course) -> None:
        """Place the pitch on a mesh whose slices end at all `seams` [rad]; of a turn, with the events of its `course`.

        Chambers are held in what they are in, in the last history.
        """
        self.problem, self.machinery = problem, machinery
        self.n, self.N = machinery.n, machinery.composition.chambers * machinery.n  # states of a chamber, of all
        self.rates = NodeRates(machinery, mesh, held_of(machinery, problem.parts, mesh, course))
        self.period = period_of(machinery, problem.parts, mesh, course)
        self.events = Events.of(machinery, course, seams, mesh)

    @property
    def mesh(self) -> Mesh:
        """The mesh; that of a turn moves with events (`move_events`)."""
        return self.rates.mesh

    @property
    def count(self) -> int:
        """The number of slices."""
        return self.mesh.count

    @property
    def alone(self) -> bool:
        """Whether there is a single chamber."""
        return self.machinery.alone

    @property
    def numbers(self) -> RateNumbers:
        """A copy of the current numbers."""
        return RateNumbers.of(self.machinery)

    def put(self, numbers: RateNumbers) -> None:
        """Set the numbers that the rates use."""
        numbers.put(self.machinery)

    # ---- states at the nodes -----------------------------------------------------------------------------------

    def read(self) -> Array:
        """Return the states at the nodes (slices, NODES, N), read from the last history: at events those before it."""
        c, angles = self.machinery.composition, self.mesh.angles
        if self.alone:
            angles[:, -1] -= 2.0 * NUDGE
            return self.machinery.lives.states_at(angles.ravel()).reshape(self.count, NODES, self.N)
        pitch = float(c.P[P_PITCH])
        inside = np.minimum(angles.ravel(), pitch * (1.0 - INSIDE))
        at = self.machinery.lives.states_at((pitch * np.arange(c.chambers)[:, None] + inside).ravel())
        return at.reshape(c.chambers, -1, self.n).transpose(1, 0, 2).reshape(self.count, NODES, self.N)

    def after(self, Y: Array) -> Array:
        """Return the states after each event (events, N), from those at the nodes."""
        return self.events.after(Y, self.numbers) if self.passed else np.empty((0, self.N))

    def open_events(self, Y: Array) -> Array:
        """Return what is open of the condition of each event (events,)."""
        return self.events.open_(Y, self.numbers) if self.passed else np.empty(0)

    def begins(self, start: Array, Y: Array) -> Array:
        """Return the states at the start of each slice (slices, N)."""
        found = np.concatenate([start[None], Y[:-1, -1]])
        found[[k + 1 for k in self.passed]] = self.after(Y)
        return found

    @property
    def passed(self) -> Sequence[int]:
        """The slices that end with an event."""
        return self.events.passed

    def move_events(self, by: Array) -> None:
        """Move the edges of slices with the unknowns of events."""
        if len(by):
            edges, self.events = self.events.moved(self.mesh.edges, by)
            self.rates = replace(self.rates, mesh=Mesh.between(edges))

    def sums(self, g: Array) -> Array:
        """Return the quadratures over the pitch from their rates at the nodes."""
        return np.einsum("k,j,kj...->...", self.mesh.widths, INTEGRALS[-1], g)[: self.machinery.nq]

    # ---- lives -------------------------------------------------------------------------------------------------

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
        after, edges = self.after(Y) + by * change.after, self.mesh.edges
        edges = edges + by * (change.events @ self.events.moves(edges))
        self.install_life(self.life(y + by * change.start, Y + by * change.nodes, after), edges)

    def install_life(self, life: Array, edges: Array | None = None) -> None:
        """Install a life's dense output as the last history."""
        machinery, c = self.machinery, self.machinery.composition
        edges = self.mesh.edges if edges is None else edges
        begins = float(c.P[P_PITCH]) * np.arange(c.chambers)[:, None] + edges[:-1]
        machinery.install(np.append(begins, c.P[P_LIFE]), life, 0.0)
