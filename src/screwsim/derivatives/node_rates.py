"""The rates of all chambers at the nodes of a mesh, and their derivatives by the states, by compiled kernels.

They are those for the numbers that the machinery holds (`rate_numbers`).
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from screwsim.derivatives.held import Held
from screwsim.derivatives.mesh import Mesh
from screwsim.derivatives.radau import NODES
from screwsim.model import compiled
from screwsim.model.run import Machinery
from screwsim.numerics.reused_arrays import empty

Array = np.ndarray


class Slopes(NamedTuple):
    """Rates at the nodes (slices, NODES, …): f of states, g of quadratures, then the derivatives of both by states."""

    f: Array
    g: Array
    by_states: Array
    g_by_states: Array


@dataclass(frozen=True)
class NodeRates:
    """Rates on a mesh, on each slice of which chambers are held."""

    machinery: Machinery
    mesh: Mesh
    held: Held

    @property
    def n(self) -> int:
        """The number of states of a chamber."""
        return self.machinery.n

    @property
    def N(self) -> int:
        """The number of states of all chambers."""
        return self.machinery.composition.chambers * self.machinery.n

    @property
    def q(self) -> int:
        """The number of rates of quadratures; of several chambers the last is the gas across the injection angle."""
        return self.machinery.nq + (not self.machinery.alone)

    def at(self, Y: Array, edges: Array | None = None) -> tuple[Array, Array]:
        """Return the rates of states and quadratures at the nodes, or at those of other edges."""
        mesh = self.mesh if edges is None else self.mesh.with_edges(edges)
        f, g = np.empty((mesh.count * NODES, self.N)), np.empty((mesh.count * NODES, self.q))
        asked = self._asked(Y, mesh)
        for rows in self.held.runs(mesh.of_nodes):
            self.machinery.together.slices__rates_at_all(*(e[rows] for e in asked), *self._context, f[rows], g[rows])
        return f.reshape(mesh.count, NODES, -1), g.reshape(mesh.count, NODES, -1)

    def at_start(self, k: int, y: Array, phases: Array) -> tuple[Array, Array]:
        """Return the rates of states and quadratures at the start of slice k, for states y, chambers held in phases."""
        f, g, mesh = np.empty((1, self.N)), np.empty((1, self.q)), self.mesh
        with self.held.on(k, phases):
            asked = mesh.edges[k : k + 1], mesh.middles[k : k + 1], np.array(y[None])
            self.machinery.together.slices__rates_at_all(*asked, *self._context, f, g)
        return f[0], g[0]

    def slopes(self, Y: Array) -> Slopes:
        """Return the rates and their derivatives by the states at the nodes."""
        *found, _ = self._slopes(self.mesh.of_nodes, *self._asked(Y, self.mesh))
        return Slopes(*(each.reshape(self.mesh.count, NODES, *each.shape[1:]) for each in found))

    def by_own_states(self, Y: Array, slices: Array) -> Array:
        """Return the derivatives of each chamber's rates by its own states at the nodes of some slices.

        The order is chamber by chamber (chambers slices, NODES, n, n).
        """
        angles, of = self.mesh.angles[slices].ravel(), np.repeat(slices, NODES)
        y = np.ascontiguousarray(Y[slices]).reshape(-1, self.N)
        found = self._slopes(of, angles, self.mesh.middles[of], y, alone=True)[-1]
        return found.reshape(-1, NODES, self.n, self.n)

    def at_one_angle(self, angles: Array, y: Array) -> tuple[Array, Array]:
        """Return the rates at one angle in each slice, and the derivatives of each chamber's by its own states.

        The latter are (chambers, slices, n, n).
        """
        f, *_, own = self._slopes(np.arange(self.mesh.count), angles, self.mesh.middles, y, alone=True)
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
        for run in self.held.runs(of):
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
        return mesh.angles.ravel(), mesh.middles[mesh.of_nodes], np.ascontiguousarray(Y).reshape(-1, self.N)

    @property
    def _context(self) -> tuple[Any, int]:
        """The last arguments of the kernels."""
        return self.machinery.coupled_context, self.machinery.composition.n_E_all
