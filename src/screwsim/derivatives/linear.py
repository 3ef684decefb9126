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
    are never needed. `events` are the changes of the unknowns of events within a turn, `passed` (events, N, K) those of
    the states behind them.
    """

    start: Array
    cells: Array
    sums: Array
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
        start, cells, sums, weights, _, events, _ = other
        return self._replace(
            start=self.start + start,
            cells=self.cells + cells,
            sums=self.sums + sums,
            weights=self.weights + weights,
            events=self.events + events,
        )

    def _each(self, made: Callable[[Array], Array]) -> Response:
        """Return the response with a function applied to each array of columns."""
        names = "start", "cells", "sums", "weights", "events"
        return self._replace(**{name: made(getattr(self, name)) for name in names})


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
    sums = np.zeros((pitch.machinery.nq, len(changes)))
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
    N, n, index = pitch.N, pitch.n, pitch.injected
    states, cells = np.eye(N), np.zeros((len(pitch.cells()), N))
    if index is None:
        return states, cells
    before, step = pitch.at_injection(Y), step_of(pitch)
    for i in range(index * n, index * n + n):
        size = max(abs(before[i]), SMALL)
        found = []
        for sign in (1.0, -1.0):
            y = before.copy()
            y[i] += sign * step * size
            found.append(pitch.injects(y, pitch.numbers))
        states[:, i] = (found[0][0] - found[1][0]) / (2.0 * step * size)
        cells[:, i] = (found[0][1] - found[1][1]) / (2.0 * step * size)
    return states, cells


class Followed(NamedTuple):
    """Changes followed through a pitch, a column each: at nodes (slices, NODES, N, K), and of the quadratures.

    Then those of the conditions of events (events, K), and of the states behind these (events, N, K).
    """

    nodes: Array
    sums: Array
    conditions: Array
    passed: Array

    @classmethod
    def of(cls, nodes: Array, sums: Array, conditions: Sequence[Array], passed: Sequence[Array]) -> Self:
        """Return changes with those of events, of which there may be none."""
        N, K = nodes.shape[-2:]
        return cls(nodes, sums, np.array(conditions).reshape(-1, K), np.array(passed).reshape(-1, N, K))

    def of_columns(self, columns: slice) -> Self:
        """Return some of the columns."""
        return self._make(each[..., columns] for each in self)

    def beside(self, other: Self) -> Self:
        """Return the columns of both."""
        return self._make(np.concatenate(each, axis=-1) for each in zip(self, other, strict=True))


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
        cells, nothing = N + len(felt), pitch.numbers.times(0.0)
        moving = [ArgumentChange(nothing, edges) for edges in pitch.events_move]
        self._events = pitch.linear_events(Y)
        self._known = cells + len(moving)  # columns before those of changes
        columns = self._known + len(changes)
        right = zeros(*Y.shape, -(-columns // LANES) * LANES)  # whole registers, as a partial one takes as long
        of_rates = along(pitch, Y, pitch.numbers, [*felt, *moving, *changes], right, N)  # cheaper side by side
        right[..., N:cells] /= sizes[self._feels]
        of_rates[:, : len(felt)] /= sizes[self._feels]
        of_cells = map(pitch.cells_as_numbers, np.eye(len(sizes))[self._feels])
        numbers = [*of_cells, *(each.numbers for each in (*moving, *changes))]
        found = self._through(np.eye(N, right.shape[-1]), right, borders, numbers)
        found.sums[:] += self._summed(found.nodes)
        self._followed = found.of_columns(slice(columns))
        self._followed.sums[:, N:] += of_rates
        self._around = self._closing()
        self.first = self._responded(self._followed, injected)

    @property
    def _equations(self) -> tuple[Array, Array, int, int]:
        """The arguments for factoring the stage equations."""
        reach = max(self.pitch.machinery.composition.offsets, default=1)
        return self.slopes.by_states, self.pitch.slices.widths, self.pitch.n, max(1, reach)

    def _through(
        self, now: Array, right: Array, borders: Sequence[BorderCrossing], numbers: Sequence[RateNumbers]
    ) -> Followed:
        """Return the changes at all nodes from those at the start, past phase borders and events.

        Of the quadratures only the effect of borders is included. `numbers` are the changes of the numbers for the
        columns after those of states; `now` and `right` are overwritten.
        """
        J, widths, states, reach = self._equations
        sums, first, conditions, passed = np.zeros((self.pitch.machinery.nq, right.shape[-1])), 0, [], []
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
            else:
                conditions.append(each.condition(now, numbers))
                now = each.jumped(now, numbers)
                passed.append(now)
        follow_once(J[first:], widths[first:], states, reach, now, right[first:])
        return Followed.of(right, sums, conditions, passed)

    @once
    def blocks(self) -> Blocks:
        """The factored stage equations, for repeated use."""
        return Blocks(*self._equations)

    def _summed(self, nodes: Array) -> Array:
        """Return the change of the quadratures with changes at the nodes (slices, NODES, N, k)."""
        sums, widths = np.zeros((self.pitch.machinery.nq, nodes.shape[-1])), self.pitch.slices.widths
        slopes = self.slopes.g_by_states
        compiled().sweeps__add_through(
            slopes.reshape(-1, *slopes.shape[2:]), nodes.reshape(-1, *nodes.shape[2:]), widths, sums
        )
        return sums

    def _returned(self, followed: Followed) -> Array:
        """Return the changes of the next start, of the cells, and of the conditions of events, a column each."""
        pitch, nodes = self.pitch, followed.nodes
        end = shifted(nodes[-1, -1], pitch.machinery.composition.chambers)
        return np.concatenate([self.inject @ end, self.noted @ pitch.before_injection(nodes), followed.conditions])

    def _closing(self) -> Array:
        """Return the inverse of 1 − (the map of start and cells over one period); events: of minus their conditions."""
        found = self._returned(self._followed.of_columns(slice(self._known)))
        N, events = self.pitch.N, len(self._events)
        first = len(found) - events  # row of the first event
        back = np.zeros((len(found), len(found)))
        back[:, [*range(N), *(N + i for i in self._feels), *range(first, len(found))]] = found
        back[range(first, len(found)), range(first, len(found))] += 1.0
        return np.linalg.inv(np.eye(len(back)) - back)

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
        more = Followed.of(nodes, self._summed(nodes), of_events, passed)
        return self._responded(self._followed.of_columns(slice(self._known)).beside(more))

    def _responded(self, followed: Followed, injected: DirectEffects | None = None) -> Response:
        """Return the periodic response to what was followed beyond start, felt cells and events, a column each.

        The last columns also have injected sources.
        """
        N, known, events = self.pitch.N, self._known, len(self._events)
        made = self._returned(followed.of_columns(slice(known, None)))
        if injected is not None:
            made[: len(made) - events, made.shape[1] - injected.start.shape[1] :] += np.concatenate(injected)
        found = self._around @ made
        start, cells, moved = np.split(found, [N, len(found) - events])
        weights = np.concatenate([start, cells[self._feels], moved, np.eye(made.shape[1])])
        return Response(start, cells, followed.sums @ weights, weights, followed.nodes, moved, followed.passed)
