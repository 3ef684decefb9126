"""The linearised stage equations of all slices: a block-bidiagonal system, as each begins where the last one ends.

The block of a slice is 1 − h A ⊗ J, with the tableau A of Radau's method (`radau`). It is a band of blocks itself, as
each chamber couples only to the next ones (`stages`).
"""

from __future__ import annotations

import numpy as np

from screwsim.derivatives.chamber_stages import compiled as alone
from screwsim.derivatives.radau import NODES
from screwsim.derivatives.stages import LITTLE, compiled
from screwsim.numerics.reused_arrays import empty

Array = np.ndarray
ALL = slice(None)


class BlockBidiagonal:
    """The system, its blocks factored; J (slices, NODES, N, N) are the derivatives by the states of all chambers."""

    def __init__(self, J: Array, widths: Array, states: int, reach: int) -> None:
        """Factor; a chamber has so many `states` and couples to `reach` chambers on, further ones are left out."""
        count, _, N, _ = J.shape
        self.states, self.reach = states, reach
        self.factors, self.pivots = empty(count, NODES * N, NODES * N), np.empty((count, NODES * N), np.int64)
        if N == states and NODES * N <= LITTLE:
            alone().chamber_stages__factor(J.reshape(-1, N, N), widths, states, self.factors, self.pivots)
        else:
            compiled().stages__factor(J.reshape(-1, N, N), widths, states, reach, self.factors, self.pivots)

    def among(self, others: BlockBidiagonal, own: Array, at: Array, chambers: int) -> BlockBidiagonal:
        """Return a mixture of these factors and others, for each chamber: slices marked in `own` are from these.

        The remaining slices are those at indices `at` of the others.
        """
        found = object.__new__(BlockBidiagonal)
        found.states, found.reach = self.states, self.reach
        size, count = self.factors.shape[-1], len(own)
        found.factors, found.pivots = empty(chambers * count, size, size), np.empty((chambers * count, size), np.int64)
        for name in ("factors", "pivots"):
            each, mine, theirs = (getattr(one, name) for one in (found, self, others))
            parts = each.reshape(chambers, count, -1)
            parts[:, own] = mine.reshape(chambers, -1, parts.shape[-1])
            parts[:, ~own] = theirs.reshape(chambers, -1, parts.shape[-1])[:, at]
        return found

    def follow(self, start: Array, right: Array, part: slice = ALL) -> Array:
        """Return changes at the nodes of a part of the slices (slices, NODES, N, k) from those at its start (N, k).

        `right`, of the nodes' shape, are the right sides of the stage equations; it is overwritten.
        """
        count, _, N, k = right.shape
        if k:
            rows, now = right.reshape(count, NODES * N, k), np.array(start, order="C")
            factors = self.factors[part], self.pivots[part]
            compiled().stages__follow(*factors, self.states, self.reach, now, rows)
        return right

    def follow_one_by_one(self, right: Array, inject: Array) -> Array:
        """Return changes at the nodes (slices, NODES, N) of uncoupled chambers.

        The factors are those of all slices of the first chamber, then of the next. `right`, of that shape, are
        the right sides; each chamber starts with `inject` (N, N) applied to the end of the one before.
        """
        count, _, N = right.shape
        parts = right.reshape(count, NODES, -1, self.states).transpose(2, 0, 1, 3)  # by chamber
        rows = np.array(parts, order="C").reshape(-1, NODES * self.states)
        alone().chamber_stages__follow_one_by_one(self.factors, self.pivots, self.states, inject, rows)
        return rows.reshape(parts.shape).transpose(1, 2, 0, 3).reshape(count, NODES, N)


def follow_once(J: Array, widths: Array, states: int, reach: int, start: Array, right: Array) -> Array:
    """Return the same as `BlockBidiagonal(J, …).follow(start, right)`, slice by slice without keeping the factors."""
    count, _, N, k = right.shape
    now, rows = np.array(start, order="C"), right.reshape(count, NODES * N, k)
    compiled().stages__follow_once(J.reshape(-1, N, N), widths, states, reach, now, rows)
    return right
