"""The collocated cycle, linearised: the response of a pitch, closed periodically, to small changes.

Changes of the stage equations enter as sources, a column each. The results are the changes of the states at all nodes,
of the cells that the injection sets, and of the quadratures, with the period closed and the unknowns fixed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from screwsim.codegen.kinds import LANES
from screwsim.cycle.linear_pitch import shifted
from screwsim.derivatives.blocks import Blocks, follow_once
from screwsim.derivatives.lane_rates import RateRequest, rates_of
from screwsim.derivatives.phases import BorderCrossing
from screwsim.derivatives.pitch import CollocatedPitch, RateNumbers, Slopes
from screwsim.derivatives.sweeps import compiled
from screwsim.model.slots import P_GAP_WIDTH, PORT_STATE, PRESSURE, R_RATIO
from screwsim.numerics.identity_cache import once
from screwsim.numerics.reused_arrays import zeros

Array = np.ndarray
OF_WIDTH = 1e-5  # step of differences over the regularisation: a tenth of a node's distance from a turning ...
LEAST, MOST = 1e-10, 1e-9  # ... within these bounds
SMALL = 1e-3  # least size of a state or a cell, for relative steps


class DirectEffects(NamedTuple):
    """Direct effects of changes besides those on rates, columns (…, k): on states after the injection, on its cells."""

    start: Array
    cells: Array


class Response(NamedTuple):
    """Changes, columns (…, k), of states at the start, of cells, of quadratures and of states at nodes.

    Those at nodes are linear combinations, by `weights` (K, k), of what was `followed` (slices, NODES, N, K): most
    are never needed.
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
        """Return the changes of the states at the nodes of some slices."""
        return self.followed[slices] @ self.weights

    def of(self, columns: int | slice) -> Response:
        """Return some of the columns; a single one without its axis."""
        return self._each(lambda each: each[..., columns])

    def weighted(self, weights: Array) -> Response:
        """Return linear combinations of the columns, by weights (k, m) or (k,)."""
        return self._each(lambda each: each @ weights)

    def added(self, other: Response) -> Response:
        """Return the sum with another response that shares what was followed."""
        start, cells, sums, weights, _ = other
        return Response(self.start + start, self.cells + cells, self.sums + sums, self.weights + weights, self.followed)

    def _each(self, made: Callable[[Array], Array]) -> Response:
        """Return the response with a function applied to each array of columns."""
        return Response(made(self.start), made(self.cells), made(self.sums), made(self.weights), self.followed)


def step_along(change: ArgumentChange, at: RateNumbers, step: float) -> float:
    """Return the relative step of differences along a change: of central ones so that pressures move by `step` at most.

    A saturation temperature moves the pressure of its line ten times as far as itself, and nodes must not be moved
    beyond the turning of a flow.
    """
    if not change.both:
        return step
    lines = slice(PRESSURE, R_RATIO, PORT_STATE)
    moved = change.numbers.R[lines] / np.where(at.R[lines] > 0.0, at.R[lines], np.inf)
    return step / max(1.0, float(np.abs(moved).max()))


def step_of(pitch: CollocatedPitch) -> float:
    """Return the relative step of differences: small against the regularisation, far above rounding."""
    width = float(pitch.machinery.composition.P[P_GAP_WIDTH])
    return min(MOST, max(LEAST, OF_WIDTH * width))


class ArgumentChange(NamedTuple):
    """A direction: change of the numbers, and of the slices' edges [rad]; `side` is the sign of its differences.

    Where two breakpoints of the laws coincide and one of them moves, edges stay, and the differences are taken on
    the side where the nodes at the ends of slices remain in their segments; one sign for each slice where
    breakpoints move both ways.
    """

    numbers: RateNumbers
    edges: Array | None = None
    side: float | Array = 1.0

    @property
    def nothing(self) -> bool:
        """Whether no rate depends on it."""
        return self.numbers.nothing and self.edges is None

    @property
    def both(self) -> bool:
        """Whether differences must be central: for pressures of lines, in whose layers chambers may remain for long."""
        return bool(self.numbers.R[PRESSURE:R_RATIO:PORT_STATE].any())


def along(
    pitch: CollocatedPitch, Y: Array, at: RateNumbers, changes: Sequence[ArgumentChange], right: Array, first: int
) -> Array:
    """Return the change of the quadratures with changes of the rates' arguments, a column each.

    Changes of the stage equations are added to `right` (slices, NODES, N, …), from column `first` on.
    """
    sums = np.zeros((pitch.q - 1, len(changes)))
    some = [i for i, each in enumerate(changes) if not each.nothing]
    if not some:
        return sums
    of_pressures, asked, of_asked = step_of(pitch), [RateRequest(at, None)], []
    for i in some:
        numbers, edges, side = changes[i]
        both, step = changes[i].both, step_along(changes[i], at, of_pressures)
        signs = (side,) if isinstance(side, float) and not both else (1.0, -1.0)
        of_asked += [(i, sign / step * (0.5 if both else np.equal(side, sign)), not both) for sign in signs]
        for sign in signs:
            there = None if edges is None else pitch.slices.edges + sign * step * edges
            asked.append(RateRequest(at.plus(sign * step, numbers), there))
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


def injection(pitch: CollocatedPitch, Y: Array) -> tuple[Array, Array]:
    """Return the derivatives of states after the injection, and of the cells it sets, by the states before it."""
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


class LinearisedPitch:
    """The linearised pitch at states Y and the current numbers, with slices fixed, or bounded by moving phase borders.

    `first` is its response to changes, a column each: passing them at once costs little more than the matrices
    alone. `injected` are the direct effects of the last of these changes on states after the injection and on its
    cells.
    """

    def __init__(
        self,
        pitch: CollocatedPitch,
        Y: Array,
        slopes: Slopes,
        changes: Sequence[ArgumentChange] = (),
        injected: DirectEffects | None = None,
        borders: Sequence[BorderCrossing] = (),
    ) -> None:
        self.pitch, self.slopes = pitch, slopes
        self.inject, self.noted = injection(pitch, Y)
        sizes, N = np.maximum(np.abs(pitch.cells()), SMALL), pitch.N
        c = pitch.machinery.composition
        ratio = not c.carried and "T_oil" in c.states  # whether rates depend on the oil ratio (the first cell) ...
        self._feels = [*([0] if ratio else []), *range(pitch.run_cells, len(sizes))]  # ... and on what a pump uses
        felt = [ArgumentChange(pitch.cells_as_numbers(each)) for each in np.diag(sizes)[self._feels]]
        self._known = N + len(felt)  # columns before those of changes
        columns = self._known + len(changes)
        right = zeros(*Y.shape, -(-columns // LANES) * LANES)  # whole registers, as a partial one takes as long
        of_rates = along(pitch, Y, pitch.numbers, [*felt, *changes], right, N)  # cheaper side by side
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
        """The arguments for factoring the stage equations."""
        reach = max(self.pitch.machinery.composition.offsets, default=1)
        return self.slopes.by_states, self.pitch.slices.widths, self.pitch.n, max(1, reach)

    def _through(
        self, now: Array, right: Array, borders: Sequence[BorderCrossing], numbers: Sequence[RateNumbers]
    ) -> tuple[Array, Array]:
        """Return the changes at all nodes from those at the start, and the effect of phase borders on the quadratures.

        `numbers` are the changes of the numbers for the columns after those of states; `now` and `right` are
        overwritten.
        """
        J, widths, states, reach = self._equations
        sums, first = np.zeros((self.pitch.q - 1, right.shape[-1])), 0
        for border in sorted(borders, key=lambda each: each.slice):
            part = slice(first, border.slice + 1)
            if part.stop > first:
                follow_once(J[part], widths[part], states, reach, now, right[part])
                now = right[border.slice, -1].copy()
            delay = border.by_states @ now
            delay[self.pitch.N : self.pitch.N + len(numbers)] += [border.by_numbers(each) for each in numbers]
            now += np.outer(border.states, delay)
            sums += np.outer(border.sums, delay)
            first = part.stop
        follow_once(J[first:], widths[first:], states, reach, now, right[first:])
        return right, sums

    @once
    def blocks(self) -> Blocks:
        """The factored stage equations, for repeated use."""
        return Blocks(*self._equations)

    def _summed(self, nodes: Array) -> Array:
        """Return the change of the quadratures with changes at the nodes (slices, NODES, N, k)."""
        sums, widths = np.zeros((self.pitch.q - 1, nodes.shape[-1])), self.pitch.slices.widths
        slopes = self.slopes.g_by_states
        compiled().sweeps__add_through(
            slopes.reshape(-1, *slopes.shape[2:]), nodes.reshape(-1, *nodes.shape[2:]), widths, sums
        )
        return sums

    def _closing(self, end: Array) -> Array:
        """Return the inverse of 1 − (the map of start and cells over one period).

        `end` is the response of the states at the end to start and felt cells.
        """
        N, chambers = self.pitch.N, self.pitch.machinery.composition.chambers
        made = np.zeros((N, N + len(self.noted)))
        made[:, [*range(N), *(N + i for i in self._feels)]] = end
        back = np.concatenate([self.inject, self.noted]) @ shifted(made, chambers)
        return np.linalg.inv(np.eye(len(back)) - back)

    def respond(self, stages: Array) -> Response:
        """Return the periodic response to sources (…, k) in the stage equations."""
        nodes = self.blocks.follow(np.zeros((self.pitch.N, stages.shape[-1])), stages.copy())
        followed = np.concatenate([self._followed[..., : self._known], nodes], axis=-1)
        return self._responded(followed, np.concatenate([self._sums[:, : self._known], self._summed(nodes)], axis=-1))

    def _responded(self, followed: Array, sums: Array, injected: DirectEffects | None = None) -> Response:
        """Return the periodic response to what was followed beyond start and felt cells, a column each.

        `sums` are the corresponding changes of the quadratures; the last columns also have injected sources.
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
