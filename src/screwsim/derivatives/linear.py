"""What small changes make of themselves over a pitch and around it: the collocated cycle, linearised.

Changes of the stage equations enter as sources, a column each; what comes back are changes of the states at all nodes,
of the cells that the injection sets, and of the quadratures, the period closed, the unknowns held.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from screwsim.cycle.linear_pitch import shifted
from screwsim.derivatives.beside import Asked, rates_of
from screwsim.derivatives.blocks import Blocks
from screwsim.derivatives.pitch import Numbers, Pitch, Slopes
from screwsim.derivatives.slices import NODES
from screwsim.derivatives.sweeps import compiled
from screwsim.model.slots import P_GAP_WIDTH, PLACE, PRESSURE, R_RATIO

Array = np.ndarray
OF_WIDTH = 1e-5  # of the regularisation: steps of differences, a tenth of how near to its turn a node is ...
LEAST, MOST = 1e-10, 1e-9  # ... within these
SMALL = 1e-3  # of a state or a cell, for relative steps


class Sources(NamedTuple):
    """Columns (…, k): right sides of the stage equations, quadratures, states behind the injection, cells it sets."""

    right: Array
    sums: Array
    start: Array
    cells: Array

    def and_then(self, *others: Sources) -> Sources:
        """Return these columns and those of others behind them."""
        return Sources(*(np.concatenate(each, axis=-1) for each in zip(self, *others, strict=True)))


class Response(NamedTuple):
    """Columns (…, k): changes of the states at the start and at the nodes, of the cells, of the quadratures."""

    start: Array
    nodes: Array
    cells: Array
    sums: Array

    def and_then(self, other: Response) -> Response:
        """Return these columns and those of another behind them."""
        return Response(*(np.concatenate(each, axis=-1) for each in zip(self, other, strict=True)))

    def weighted(self, weights: Array) -> Response:
        """Return sums of the columns (k, m)."""
        return Response(*(each @ weights for each in self))

    def added(self, other: Response) -> Response:
        """Return both together, in the place of these."""
        return Response(*(np.add(one, more, out=one) for one, more in zip(self, other, strict=True)))


def step_of(pitch: Pitch) -> float:
    """Return the relative step of differences: within the regularisation, far above rounding."""
    width = float(pitch.machinery.composition.P[P_GAP_WIDTH])
    return min(MOST, max(LEAST, OF_WIDTH * width))


class Change(NamedTuple):
    """A direction: of the numbers, of the edges of the slices [rad]; `side` is the sign of its differences.

    Where two breakpoints of the laws coincide and one of them moves, edges stay, and the differences go to the side on
    which the nodes at the ends of slices stay in theirs.
    """

    numbers: Numbers
    edges: Array | None = None
    side: float = 1.0

    @property
    def nothing(self) -> bool:
        """Does no rate feel it?"""
        return self.numbers.nothing and self.edges is None

    @property
    def both(self) -> bool:
        """Is it to be differenced to both sides: pressures of lines, in whose layers chambers may stand for long?"""
        return bool(self.numbers.R[PRESSURE:R_RATIO:PLACE].any())


def along(pitch: Pitch, Y: Array, at: Numbers, changes: Sequence[Change]) -> tuple[Array, Array]:
    """Return what rates along changes make of the stage equations (slices, NODES, N, changes) and of quadratures."""
    right, sums = (np.zeros((*shape, len(changes))) for shape in ((pitch.count, NODES, pitch.N), (pitch.q - 1,)))
    some = [i for i, each in enumerate(changes) if not each.nothing]
    if not some:
        return right, sums
    step, asked, of_asked = step_of(pitch), [Asked(at, None)], []
    for i in some:
        numbers, edges, side = changes[i]
        signs = (1.0, -1.0) if changes[i].both else (side,)
        of_asked += [(i, sign / (step * len(signs)), len(signs) == 1) for sign in signs]
        for sign in signs:
            there = None if edges is None else pitch.slices.edges + sign * step * edges
            asked.append(Asked(at.plus(sign * step, numbers), there))
    own: list[Array] = []
    for which, *found in rates_of(pitch, Y, asked):
        found = [rates.reshape(-1, *rates.shape[2:]) for rates in found]
        own = own or [rates[..., 0].copy() for rates in found]
        first, widths = int(not which.start), pitch.slices.widths
        of_lanes = of_asked[which.start + first - 1 : which.stop - 1]
        edges = [each.edges for each in asked[which.start + first : which.stop]]
        there = [per * (widths if e is None else np.diff(e)) for (_, per, _), e in zip(of_lanes, edges, strict=True)]
        here = [per * one_sided * widths for _, per, one_sided in of_lanes]
        how = first, *(np.ascontiguousarray(np.transpose(each)) for each in (there, here))
        columns = np.array([i for i, *_ in of_lanes])
        compiled().sweeps__add_stages(found[0], own[0], *how, columns, right.reshape(-1, *right.shape[2:]))
        compiled().sweeps__add_sums(found[1], own[1], *how, columns, sums)
    return right, sums


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
    """The linearised pitch, at states Y and numbers as they stand.

    `first` is its response to `stages`, which are added to the stage equations as they are, and to changes, a column
    each: what is known beforehand costs little more than the matrices. `injected` are what the changes make of states
    behind the injection and of the cells it sets, a column each.
    """

    def __init__(
        self,
        pitch: Pitch,
        Y: Array,
        slopes: Slopes,
        changes: Sequence[Change] = (),
        stages: Array | None = None,
        injected: Sequence[Array] = (),
    ) -> None:
        self.pitch, self.Y, self.slopes, self.at = pitch, Y, slopes, pitch.numbers
        reach = max(pitch.machinery.composition.offsets, default=1)
        self.inject, self.noted = injection(pitch, Y)
        self._feels, self._felt, changed = self._first(changes)
        self.changed = changed._replace(**dict(zip(("start", "cells"), injected, strict=False)))
        felt, N = len(self._feels), pitch.N
        known = [self._felt.right, *([] if stages is None else [stages]), self.changed.right]
        right = np.zeros((*Y.shape, N + sum(each.shape[-1] for each in known)))
        np.concatenate(known, axis=-1, out=right[..., N:])
        self.blocks = Blocks(slopes.by_states, pitch.slices.widths, pitch.n, max(1, reach))
        nodes = self.blocks.follow(np.eye(N, right.shape[-1]), right)
        self._from, self._around = nodes[..., : N + felt], self._closing(nodes[-1, -1, :, : N + felt])
        columns = 0 if stages is None else stages.shape[-1]
        nothing = Sources(*(np.zeros((*each.shape[:-1], columns)) for each in self.changed))
        self.first = self._responded(nothing.and_then(self.changed), nodes[..., N + felt :])

    def _first(self, changes: Sequence[Change]) -> tuple[list[int], Sources, Sources]:
        """Return which cells the rates feel, their sources, one column each, and those of changes.

        They are asked for together: rates side by side cost less.
        """
        sizes = np.maximum(np.abs(self.pitch.cells()), SMALL)
        felt = [i for i in range(len(sizes)) if self._is_felt(i)]
        asked = (self.pitch.cells_as_numbers(each) for each in np.diag(sizes)[felt])
        every = self.sources([*map(Change, asked), *changes])
        found = Sources(*(each[..., : len(felt)] / sizes[felt] for each in every))
        return felt, found, Sources(*(each[..., len(felt) :] for each in every))

    def _is_felt(self, cell: int) -> bool:
        """Tell whether rates take a cell: oil per gas that is none of the states (the first), what a pump asks for."""
        c = self.pitch.machinery.composition
        return (cell == 0 and not c.carried and "T_oil" in c.states) or cell >= self.pitch.run_cells

    def sources(self, changes: Sequence[Change]) -> Sources:
        """Return the sources of changes of numbers and edges, a column each; nothing of what the injection does."""
        pitch, count = self.pitch, len(changes)
        right, sums = along(pitch, self.Y, self.at, changes)
        return Sources(right, sums, np.zeros((pitch.N, count)), np.zeros((len(pitch.cells()), count)))

    def _closing(self, end: Array) -> Array:
        """Return the inverse of what closes the period: of start and cells less what they make of themselves.

        `end` is what start and felt cells make of the states at the end.
        """
        N, chambers = self.pitch.N, self.pitch.machinery.composition.chambers
        made = np.zeros((N, N + len(self.noted)))
        made[:, [*range(N), *(N + i for i in self._feels)]] = end
        back = np.concatenate([self.inject, self.noted]) @ shifted(made, chambers)
        return np.linalg.inv(np.eye(len(back)) - back)

    def respond(self, sources: Sources, stages: Array | None = None) -> Response:
        """Return what sources make, the period closed; `stages` are added to the stage equations as they are.

        What `right` of the sources holds is written over.
        """
        right = sources.right
        if stages is not None:
            right += stages
        return self._responded(sources, self.blocks.follow(np.zeros_like(sources.start), right))

    def _responded(self, sources: Sources, nodes: Array) -> Response:
        """Return what sources make that, the start held, make `nodes` (slices, NODES, N, k) of the states."""
        N, chambers = self.pitch.N, self.pitch.machinery.composition.chambers
        end = shifted(nodes[-1, -1], chambers)
        found = self._around @ np.concatenate([self.inject @ end + sources.start, self.noted @ end + sources.cells])
        start, cells = found[:N], found[N:]
        felt = cells[self._feels]
        through = self._from @ np.concatenate([start, felt])
        nodes = np.add(nodes, through, out=through)
        sums = self.pitch.sums(self.slopes.g_by_states @ nodes) + sources.sums + self._felt.sums @ felt
        return Response(start, nodes, cells, sums)
