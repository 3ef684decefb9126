"""What small changes make of themselves over a pitch and around it: the collocated cycle, linearised.

Changes of the stage equations enter as sources, a column each; what comes back are changes of the states at all nodes,
of the cells that the injection sets, and of the quadratures, the period closed, the unknowns held.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from screwsim.codegen.kinds import LANES
from screwsim.cycle.linear_pitch import shifted
from screwsim.derivatives.beside import Asked, rates_of
from screwsim.derivatives.blocks import Blocks, follow_once
from screwsim.derivatives.phases import Border
from screwsim.derivatives.pitch import Numbers, Pitch, Slopes
from screwsim.derivatives.sweeps import compiled
from screwsim.model.slots import P_GAP_WIDTH, PORT_STATE, PRESSURE, R_RATIO
from screwsim.numerics.remembered import once
from screwsim.numerics.reused import zeros

Array = np.ndarray
OF_WIDTH = 1e-5  # of the regularisation: steps of differences, a tenth of how near to its turn a node is ...
LEAST, MOST = 1e-10, 1e-9  # ... within these
SMALL = 1e-3  # of a state or a cell, for relative steps


class Sources(NamedTuple):
    """Columns (…, k) that a change makes beside rates: states behind the injection, cells it sets."""

    start: Array
    cells: Array


class Response(NamedTuple):
    """Columns (…, k): changes of the states at the start, of the cells, of the quadratures, and of the states at nodes.

    Those at nodes are sums of what was followed (slices, NODES, N, K), `weights` (K, k): most are never asked for.
    """

    start: Array
    cells: Array
    sums: Array
    weights: Array
    followed: Array

    @property
    def nodes(self) -> Array:
        """Changes of the states at all nodes (slices, NODES, N, k)."""
        return self.inside(slice(None))

    def inside(self, slices: slice) -> Array:
        """Return changes of the states at the nodes of some slices."""
        return self.followed[slices] @ self.weights

    def of(self, columns: int | slice) -> Response:
        """Return some of the columns, or one of them, without its axis."""
        return self._each(lambda each: each[..., columns])

    def weighted(self, weights: Array) -> Response:
        """Return sums of the columns (k, m), or one sum of them (k,)."""
        return self._each(lambda each: each @ weights)

    def added(self, other: Response) -> Response:
        """Return both together, of the same that was followed."""
        start, cells, sums, weights, _ = other
        return Response(self.start + start, self.cells + cells, self.sums + sums, self.weights + weights, self.followed)

    def _each(self, made: Callable[[Array], Array]) -> Response:
        return Response(made(self.start), made(self.cells), made(self.sums), made(self.weights), self.followed)


def step_of(pitch: Pitch) -> float:
    """Return the relative step of differences: within the regularisation, far above rounding."""
    width = float(pitch.machinery.composition.P[P_GAP_WIDTH])
    return min(MOST, max(LEAST, OF_WIDTH * width))


class Change(NamedTuple):
    """A direction: of the numbers, of the edges of the slices [rad]; `side` is the sign of its differences.

    Where two breakpoints of the laws coincide and one of them moves, edges stay, and the differences go to the side on
    which the nodes at the ends of slices stay in theirs: of each slice, where the number moves breakpoints either way.
    """

    numbers: Numbers
    edges: Array | None = None
    side: float | Array = 1.0

    @property
    def nothing(self) -> bool:
        """Does no rate feel it?"""
        return self.numbers.nothing and self.edges is None

    @property
    def both(self) -> bool:
        """Is it to be differenced to both sides: pressures of lines, in whose layers chambers may stand for long?"""
        return bool(self.numbers.R[PRESSURE:R_RATIO:PORT_STATE].any())


def along(pitch: Pitch, Y: Array, at: Numbers, changes: Sequence[Change], right: Array, first: int) -> Array:
    """Return what rates along changes make of the quadratures, a column each.

    What they make of the stage equations is added to `right` (slices, NODES, N, …), from column `first` on.
    """
    sums = np.zeros((pitch.q - 1, len(changes)))
    some = [i for i, each in enumerate(changes) if not each.nothing]
    if not some:
        return sums
    step, asked, of_asked = step_of(pitch), [Asked(at, None)], []
    for i in some:
        numbers, edges, side = changes[i]
        both = changes[i].both
        signs = (side,) if isinstance(side, float) and not both else (1.0, -1.0)
        of_asked += [(i, sign / step * (0.5 if both else np.equal(side, sign)), not both) for sign in signs]
        for sign in signs:
            there = None if edges is None else pitch.slices.edges + sign * step * edges
            asked.append(Asked(at.plus(sign * step, numbers), there))
    own: list[Array] = []
    for which, *found in rates_of(pitch, Y, asked):
        found = [rates.reshape(-1, *rates.shape[2:]) for rates in found]
        own = own or [rates[..., 0].copy() for rates in found]
        lane, widths = int(not which.start), pitch.slices.widths
        of_lanes = of_asked[which.start + lane - 1 : which.stop - 1]
        edges = [each.edges for each in asked[which.start + lane : which.stop]]
        there = [per * (widths if e is None else np.diff(e)) for (_, per, _), e in zip(of_lanes, edges, strict=True)]
        here = [per * one_sided * widths for _, per, one_sided in of_lanes]
        how = lane, *(np.ascontiguousarray(np.transpose(each)) for each in (there, here))
        columns = np.array([i for i, *_ in of_lanes])
        compiled().sweeps__add_stages(found[0], own[0], *how, first + columns, right.reshape(-1, *right.shape[2:]))
        compiled().sweeps__add_sums(found[1], own[1], *how, columns, sums)
    return sums


def injection(pitch: Pitch, Y: Array) -> tuple[Array, Array]:
    """Return the derivatives of states behind the injection, and of the cells it sets, by the states before it."""
    N, n, index, at = pitch.N, pitch.n, pitch.injected, pitch.numbers
    states, cells = np.eye(N), np.zeros((len(pitch.cells()), N))
    if index is None:
        return states, cells
    before, step = pitch.machinery.shift(np.ascontiguousarray(Y[-1, -1])), step_of(pitch)
    for i in range(index * n, index * n + n):
        size = max(abs(before[i]), SMALL)
        found = []
        for sign in (1.0, -1.0):
            y = before.copy()
            y[i] += sign * step * size
            pitch.put(at)
            pitch.machinery.inject(y)
            found.append((y, pitch.cells()))
        states[:, i] = (found[0][0] - found[1][0]) / (2.0 * step * size)
        cells[:, i] = (found[0][1] - found[1][1]) / (2.0 * step * size)
    pitch.put(at)
    return states, cells


class Linear:
    """The linearised pitch, at states Y and numbers as they stand, its slices fixed, or led by the borders of phases.

    `first` is its response to changes, a column each: what is known beforehand costs little more than the matrices.
    `injected` are what the last of the changes make of states behind the injection and of the cells it sets.
    """

    def __init__(
        self,
        pitch: Pitch,
        Y: Array,
        slopes: Slopes,
        changes: Sequence[Change] = (),
        injected: Sources | None = None,
        borders: Sequence[Border] = (),
    ) -> None:
        self.pitch, self.slopes = pitch, slopes
        self.inject, self.noted = injection(pitch, Y)
        sizes, N = np.maximum(np.abs(pitch.cells()), SMALL), pitch.N
        self._feels = [i for i in range(len(sizes)) if self._is_felt(i)]
        felt = [Change(pitch.cells_as_numbers(each)) for each in np.diag(sizes)[self._feels]]
        self._known = N + len(felt)  # columns of what is followed before those of changes
        columns = self._known + len(changes)
        right = zeros(*Y.shape, -(-columns // LANES) * LANES)  # whole registers: what is left over takes as long as one
        of_rates = along(pitch, Y, pitch.numbers, [*felt, *changes], right, N)  # rates side by side cost less
        right[..., N : self._known] /= sizes[self._feels]
        of_rates[:, : len(felt)] /= sizes[self._feels]
        cells = map(pitch.cells_as_numbers, np.eye(len(sizes))[self._feels])
        numbers = [*cells, *(each.numbers for each in changes)]
        followed, at_borders = self._through(np.eye(N, right.shape[-1]), right, borders, numbers)
        self._followed, self._sums = followed[..., :columns], (self._summed(followed) + at_borders)[:, :columns]
        self._sums[:, N:] += of_rates
        self._around = self._closing(self._followed[-1, -1, :, : self._known])
        self.first = self._responded(self._followed, self._sums, injected)

    @property
    def _equations(self) -> tuple[Array, Array, int, int]:
        """What the stage equations are factored from."""
        reach = max(self.pitch.machinery.composition.offsets, default=1)
        return self.slopes.by_states, self.pitch.slices.widths, self.pitch.n, max(1, reach)

    def _through(
        self, now: Array, right: Array, borders: Sequence[Border], numbers: Sequence[Numbers]
    ) -> tuple[Array, Array]:
        """Return changes at all nodes from those at the start, and what borders make of the quadratures.

        `numbers` are the changes of the numbers that the columns behind those of states go with; `now` and `right` are
        written over.
        """
        J, widths, states, reach = self._equations
        sums, first = np.zeros((self.pitch.q - 1, right.shape[-1])), 0
        for border in sorted(borders, key=lambda each: each.slice):
            part = slice(first, border.slice + 1)
            if part.stop > first:
                follow_once(J[part], widths[part], states, reach, now, right[part])
                now = right[border.slice, -1].copy()
            delay = border.by_states @ now
            delay[self.pitch.N : self.pitch.N + len(numbers)] += border.by_numbers(numbers)
            now += np.outer(border.states, delay)
            sums += np.outer(border.sums, delay)
            first = part.stop
        follow_once(J[first:], widths[first:], states, reach, now, right[first:])
        return right, sums

    @once
    def blocks(self) -> Blocks:
        """The stage equations, factored to be followed again."""
        return Blocks(*self._equations)

    def _is_felt(self, cell: int) -> bool:
        """Tell whether rates take a cell: oil per gas that is none of the states (the first), what a pump asks for."""
        c = self.pitch.machinery.composition
        return (cell == 0 and not c.carried and "T_oil" in c.states) or cell >= self.pitch.run_cells

    def _summed(self, nodes: Array) -> Array:
        """Return what changes at the nodes (slices, NODES, N, k) make of the quadratures."""
        sums, widths = np.zeros((self.pitch.q - 1, nodes.shape[-1])), self.pitch.slices.widths
        slopes = self.slopes.g_by_states
        compiled().sweeps__add_through(
            slopes.reshape(-1, *slopes.shape[2:]), nodes.reshape(-1, *nodes.shape[2:]), widths, sums
        )
        return sums

    def _closing(self, end: Array) -> Array:
        """Return the inverse of what closes the period: of start and cells less what they make of themselves.

        `end` is what start and felt cells make of the states at the end.
        """
        N, chambers = self.pitch.N, self.pitch.machinery.composition.chambers
        made = np.zeros((N, N + len(self.noted)))
        made[:, [*range(N), *(N + i for i in self._feels)]] = end
        back = np.concatenate([self.inject, self.noted]) @ shifted(made, chambers)
        return np.linalg.inv(np.eye(len(back)) - back)

    def respond(self, stages: Array) -> Response:
        """Return what is made, the period closed, of stages that are added to the stage equations (…, k)."""
        nodes = self.blocks.follow(np.zeros((self.pitch.N, stages.shape[-1])), stages.copy())
        followed = np.concatenate([self._followed[..., : self._known], nodes], axis=-1)
        return self._responded(followed, np.concatenate([self._sums[:, : self._known], self._summed(nodes)], axis=-1))

    def _responded(self, followed: Array, sums: Array, injected: Sources | None = None) -> Response:
        """Return the response to what was followed behind start and felt cells, a column each.

        `sums` are what all that was followed makes of the quadratures; the last columns have sources that are injected.
        """
        N, chambers, known = self.pitch.N, self.pitch.machinery.composition.chambers, self._known
        end = shifted(followed[-1, -1, :, known:], chambers)
        made = np.concatenate([self.inject @ end, self.noted @ end])
        if injected is not None:
            made[:, made.shape[1] - injected.start.shape[1] :] += np.concatenate(injected)
        found = self._around @ made
        start, cells = found[:N], found[N:]
        weights = np.concatenate([start, cells[self._feels], np.eye(end.shape[1])])
        return Response(start, cells, sums @ weights, weights, followed)
