"""The collocated cycle, linearised: the response of a pitch, closed periodically, to small changes.

Changes of the stage equations enter as sources, a column each. The results are the changes of the states at all nodes,
of the cells that the injection sets, and of the quadratures, with the period closed and the unknowns fixed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple, Self

import numpy as np

from screwsim.codegen.kinds import LANES
from screwsim.cycle.linear_pitch import shifted
from screwsim.derivatives.argument_changes import ArgumentChange, along, along_events, step_of
from screwsim.derivatives.block_bidiagonal import BlockBidiagonal, follow_once
from screwsim.derivatives.line_flows import by_states, flows_of, pulsates
from screwsim.derivatives.node_rates import Slopes
from screwsim.derivatives.period import RUN_CELLS
from screwsim.derivatives.phases import BorderCrossing
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.rate_numbers import SMALL, RateNumbers
from screwsim.derivatives.sweeps import compiled
from screwsim.effects.base import LINES
from screwsim.numerics.identity_cache import once
from screwsim.numerics.reused_arrays import zeros

Array = np.ndarray


class DirectEffects(NamedTuple):
    """Direct effects of changes besides those on rates, columns (…, k): on states after the injection, on its cells."""

    start: Array
    cells: Array


class RateEffects(NamedTuple):
    """Effects on the stage equations (slices, NODES, N, k), on quadratures (…, k) and on line flows of changes."""

    right: Array
    sums: Array
    lines: Array


class Response(NamedTuple):
    """Changes, columns (…, k), of states at the start, of cells, of quadratures, of line flows and of states at nodes.

    `lines` are the mean flows [kg/s] into pulsating lines (lines, angles, k) of `line_flows`. Those at nodes are linear
    combinations, by `weights` (K, k), of what was `followed` (slices, NODES, N, K): most are never needed. `events` are
    the changes of the unknowns of events within a turn, `passed` (events, N, K) those of the states behind them.
    """

    start: Array
    cells: Array
    sums: Array
    lines: Array
    weights: Array
    followed: Array
    events: Array
    passed: Array

    @property
    def nodes(self) -> Array:
        """Changes of the states at all nodes (slices, NODES, N, k)."""
        return self.inside(slice(None))

    @property
    def after(self) -> Array:
        """Changes of the states after each event (events, N, k)."""
        return self.passed @ self.weights

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
        start, cells, sums, lines, weights, _, events, _ = other
        return self._replace(
            start=self.start + start,
            cells=self.cells + cells,
            sums=self.sums + sums,
            lines=self.lines + lines,
            weights=self.weights + weights,
            events=self.events + events,
        )

    def _each(self, made: Callable[[Array], Array]) -> Response:
        """Return the response with a function applied to each array of columns."""
        names = "start", "cells", "sums", "lines", "weights", "events"
        return self._replace(**{name: made(getattr(self, name)) for name in names})


class Followed(NamedTuple):
    """Changes followed through a pitch, a column each: at nodes (slices, NODES, N, K), of quadratures, of line flows.

    Then those of the conditions of events (events, K), and of the states behind these (events, N, K).
    """

    nodes: Array
    sums: Array
    lines: Array
    conditions: Array
    passed: Array

    @classmethod
    def of(cls, nodes: Array, sums: Array, lines: Array, conditions: Sequence[Array], passed: Sequence[Array]) -> Self:
        """Return changes with those of events, of which there may be none."""
        N, K = nodes.shape[-2:]
        return cls(nodes, sums, lines, np.array(conditions).reshape(-1, K), np.array(passed).reshape(-1, N, K))

    def of_columns(self, columns: slice) -> Self:
        """Return some of the columns."""
        return self._make(each[..., columns] for each in self)

    def beside(self, other: Self) -> Self:
        """Return the columns of both."""
        return self._make(np.concatenate(each, axis=-1) for each in zip(self, other, strict=True))


class Columns(NamedTuple):
    """What the columns of followed changes are: N states at the start, the cells that rates feel, events, then others.

    `felt` are the indices of these cells among those that the injection sets.
    """

    N: int
    felt: list[int]
    events: int
    changes: int

    @property
    def cells(self) -> slice:
        """The columns of cells."""
        return slice(self.N, self.N + len(self.felt))

    @property
    def moves(self) -> slice:
        """The columns of the unknowns of events."""
        return slice(self.cells.stop, self.cells.stop + self.events)

    @property
    def own(self) -> slice:
        """The columns of what closes with the period: states, cells, events."""
        return slice(self.moves.stop)

    @property
    def total(self) -> int:
        """The number of columns."""
        return self.own.stop + self.changes


class LinearisedPitch:
    """The linearised pitch at states Y and the current numbers, with slices fixed, or bounded by moving phase borders.

    `first` is its response to changes, a column each: passing them at once costs little more than the matrices
    alone. `injected` are the direct effects of the last of these changes on states after the injection and on its
    cells. `own` are the effects of cells, events and the first changes, as many as `shared`: those of an earlier
    linearisation at the same states serve again.
    """

    def __init__(
        self,
        pitch: CollocatedPitch,
        Y: Array,
        slopes: Slopes,
        changes: Sequence[ArgumentChange] = (),
        injected: DirectEffects | None = None,
        borders: Sequence[BorderCrossing] = (),
        shared: int = 0,
        own: RateEffects | None = None,
    ) -> None:
        self.pitch, self.slopes = pitch, slopes
        self.inject, self.noted = pitch.period.jacobian(Y, step_of(pitch))
        self._events = pitch.events.linearised(Y, pitch.numbers)
        self._columns = columns = Columns(pitch.N, _felt_cells(pitch), len(self._events), len(changes))
        right, sums, lines = self._sources(Y, changes, own)
        if own is None:
            some = slice(columns.own.stop - columns.N + shared)
            of_some = right[..., columns.N : columns.own.stop + shared].copy()
            own = RateEffects(of_some, sums[:, some], lines[..., some])
        self.own = own
        start = np.eye(columns.N, right.shape[-1])
        found = self._through(start, right, borders, self._numbers(changes))
        found.sums[:] += self._summed(found.nodes)
        self._followed = found.of_columns(slice(columns.total))
        self._followed.sums[:, columns.N :] += sums
        self._followed.lines[..., columns.N :] += lines
        self._around = np.linalg.inv(np.eye(self._size) - self._monodromy())
        self.first = self._responded(self._followed, injected)

    def _numbers(self, changes: Sequence[ArgumentChange]) -> list[RateNumbers]:
        """Return the changes of the numbers for all columns after those of states."""
        columns, nothing = self._columns, self.pitch.numbers.times(0.0)
        of_cells = map(self.pitch.period.cells_as_numbers, np.eye(len(self.noted))[columns.felt])
        return [*of_cells, *[nothing] * columns.events, *(each.numbers for each in changes)]

    def _sources(
        self, Y: Array, changes: Sequence[ArgumentChange], own: RateEffects | None
    ) -> tuple[Array, Array, Array]:
        """Return the right sides of the stage equations, then what changes quadratures and line flows at once.

        Right sides (slices, NODES, N, …) are of all columns, and of whole registers, as a partial one takes as long;
        the others are of all but states. Effects that are known from before are `own`.
        """
        pitch, columns = self.pitch, self._columns
        sizes = np.maximum(np.abs(pitch.period.cells()), SMALL)
        of_cells = [ArgumentChange(pitch.period.cells_as_numbers(each)) for each in np.diag(sizes)[columns.felt]]
        fixed = [ArgumentChange(pitch.numbers.times(0.0))] * columns.events  # their edges move, see `along_events`
        every, known = [*of_cells, *fixed, *changes], 0 if own is None else own.right.shape[-1]
        right = zeros(*Y.shape, -(-columns.total // LANES) * LANES)
        sums, lines = along(pitch, Y, pitch.numbers, every[known:], right, columns.N + known)  # cheaper side by side
        if own is not None:
            right[..., columns.N : columns.N + known] = own.right
            return right, np.concatenate([own.sums, sums], axis=-1), np.concatenate([own.lines, lines], axis=-1)
        units = sizes[columns.felt]
        for each, cells in (right, columns.cells), (sums, slice(len(units))), (lines, slice(len(units))):
            each[..., cells] /= units
        moves = slice(len(units), len(units) + columns.events)
        sums[:, moves] = along_events(pitch, Y, right[..., columns.moves])
        return right, sums, lines

    @property
    def _equations(self) -> tuple[Array, Array, int, int]:
        """The arguments for factoring the stage equations."""
        reach = max(self.pitch.machinery.composition.offsets, default=1)
        return self.slopes.by_states, self.pitch.mesh.widths, self.pitch.n, max(1, reach)

    def _through(
        self, now: Array, right: Array, borders: Sequence[BorderCrossing], numbers: Sequence[RateNumbers]
    ) -> Followed:
        """Return the changes at all nodes from those at the start, past phase borders and events.

        Of the quadratures only the effect of borders is included, of line flows all. `numbers` are the changes of the
        numbers for the columns after those of states; `now` and `right` are overwritten.
        """
        J, widths, states, reach = self._equations
        sums, first, conditions, passed = np.zeros((self.pitch.machinery.nq, right.shape[-1])), 0, [], []
        jumps = np.zeros((self.pitch.count, len(LINES), right.shape[-1])) if borders and pulsates(self.pitch) else 0.0
        felt = [(k, each) for k, each in enumerate(numbers, self.pitch.N) if self._events and not each.nothing]
        for each in sorted([*borders, *self._events], key=lambda each: each.slice):
            part = slice(first, each.slice + 1)
            if part.stop > first:
                follow_once(J[part], widths[part], states, reach, now, right[part])
                now = right[each.slice, -1].copy()
            first = part.stop
            if isinstance(each, BorderCrossing):
                delay = each.by_states @ now
                delay[self.pitch.N : self.pitch.N + len(numbers)] += [each.by_numbers(one) for one in numbers]
                now += np.outer(each.states, delay)
                sums += np.outer(each.sums, delay)
                if isinstance(jumps, np.ndarray):
                    jumps[each.slice] += np.outer(flows_of(self.pitch, each.sums, 0), delay)
            else:
                conditions.append(each.condition(now, felt))
                now = each.jumped(now, felt)
                passed.append(now)
        follow_once(J[first:], widths[first:], states, reach, now, right[first:])
        return Followed.of(right, sums, self._lines(right, jumps), conditions, passed)

    @once
    def blocks(self) -> BlockBidiagonal:
        """The factored stage equations, for repeated use."""
        return BlockBidiagonal(*self._equations)

    def _summed(self, nodes: Array) -> Array:
        """Return the change of the quadratures with changes at the nodes (slices, NODES, N, k)."""
        sums, widths = np.zeros((self.pitch.machinery.nq, nodes.shape[-1])), self.pitch.mesh.widths
        slopes = self.slopes.g_by_states
        compiled().sweeps__add_through(
            slopes.reshape(-1, *slopes.shape[2:]), nodes.reshape(-1, *nodes.shape[2:]), widths, sums
        )
        return sums

    def _lines(self, nodes: Array, jumps: Array | float = 0.0) -> Array:
        """Return the change of the mean flows into lines with changes at the nodes, and jumps at the ends of slices."""
        return by_states(self.pitch, self.slopes.g_by_states, nodes, jumps)

    def _returned(self, followed: Followed) -> Array:
        """Return the changes of the next start, of the cells, and of the conditions of events, a column each."""
        period, nodes = self.pitch.period, followed.nodes
        end = shifted(nodes[-1, -1], self.pitch.machinery.composition.chambers)
        cells = self.noted @ period.change_before_injection(nodes)
        return np.concatenate([self.inject @ end, cells, followed.conditions])

    @property
    def _size(self) -> int:
        """The number of unknowns that close with the period: states, all cells, events."""
        return self._columns.N + len(self.noted) + self._columns.events

    def _monodromy(self) -> Array:
        """Return the map of start and cells over one period; of events, which do not map, 1 − their conditions."""
        columns, size = self._columns, self._size
        first = size - columns.events  # row of the first event
        found = np.zeros((size, size))
        felt = [*range(columns.N), *(columns.N + i for i in columns.felt), *range(first, size)]
        found[:, felt] = self._returned(self._followed.of_columns(columns.own))
        found[range(first, size), range(first, size)] += 1.0
        return found

    def respond(self, stages: Array, conditions: Array) -> Response:
        """Return the periodic response to sources (…, k) in the stage equations and in the conditions of events."""
        begins, nodes = np.zeros((self.pitch.N, stages.shape[-1])), stages.copy()
        firsts, passed, of_events = [0, *(each.slice + 1 for each in self._events), len(nodes)], [], []
        for i, (low, high) in enumerate(pairwise(firsts)):
            self.blocks.follow(begins, nodes[low:high], slice(low, high))
            if high < len(nodes):
                of_events.append(self._events[i].condition(nodes[high - 1, -1], ()) + conditions[i])
                begins = self._events[i].jumped(nodes[high - 1, -1], ())
                passed.append(begins)
        more = Followed.of(nodes, self._summed(nodes), self._lines(nodes), of_events, passed)
        return self._responded(self._followed.of_columns(self._columns.own).beside(more))

    def _responded(self, followed: Followed, injected: DirectEffects | None = None) -> Response:
        """Return the periodic response to what was followed beyond start, felt cells and events, a column each.

        The last columns also have injected sources.
        """
        columns, first = self._columns, self._size - self._columns.events
        made = self._returned(followed.of_columns(slice(columns.own.stop, None)))
        if injected is not None:
            made[:first, made.shape[1] - injected.start.shape[1] :] += np.concatenate(injected)
        start, cells, moved = np.split(self._around @ made, [columns.N, first])
        weights = np.concatenate([start, cells[columns.felt], moved, np.eye(made.shape[1])])
        sums, lines = (each @ weights for each in (followed.sums, followed.lines))
        return Response(start, cells, sums, lines, weights, followed.nodes, moved, followed.passed)


def _felt_cells(pitch: CollocatedPitch) -> list[int]:
    """Return the indices of cells on which rates depend: the oil ratio, the first one, and what a pump uses."""
    c = pitch.machinery.composition
    ratio = not c.carried and "T_oil" in c.states
    return [*([0] if ratio else []), *range(RUN_CELLS, len(pitch.period.cells()))]
