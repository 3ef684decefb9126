"""The stage equations of all slices, solved: a chamber meets the next ones alone, so their matrix is a band."""

from __future__ import annotations

import numpy as np

from screwsim.derivatives.slices import NODES
from screwsim.derivatives.stages import compiled

Array = np.ndarray


class Blocks:
    """1 − h a J of every slice, factored; J (slices, NODES, N, N) are derivatives by the states of all chambers."""

    def __init__(self, J: Array, widths: Array, states: int, reach: int, right: Array) -> None:
        """`states` are those of a chamber, `reach` is how many chambers on it meets others.

        What is known of right sides (slices, NODES, N, k) is solved at once, as `first`: one column costs most of what
        all do.
        """
        count, _, N, _ = J.shape
        self.states, self.reach = states, max(1, reach)
        self.factors, self.pivots = np.empty((count, NODES * N, NODES * N)), np.empty((count, NODES * N), np.int64)
        by_node = np.ascontiguousarray(J).reshape(-1, N, N)
        compiled().stages__factor(by_node, widths, states, self.reach, self.factors, self.pivots)
        every = np.empty((count, NODES, N, N + right.shape[-1]))
        every[..., :N], every[..., N:] = np.eye(N), right
        found = self.solve(every)
        self.steps, self.first = np.ascontiguousarray(found[..., :N]), found[..., N:]

    def solve(self, right: Array) -> Array:
        """Return what solves the stage equations for right sides (slices, NODES, N, k)."""
        count, _, N, k = right.shape
        found = np.array(right, order="C", copy=True)
        if k:
            rows = found.reshape(count, NODES * N, k)
            compiled().stages__solve(self.factors, self.pivots, self.states, self.reach, rows)
        return found

    def run(self, start: Array, gained: Array) -> Array:
        """Return changes at all nodes (slices, NODES, N, k) from those at the start and what slices gain."""
        count, _, N, k = gained.shape
        nodes = np.empty(gained.shape)
        if k:
            rows = (np.ascontiguousarray(each).reshape(count, NODES * N, -1) for each in (self.steps, gained, nodes))
            steps, gains, out = rows
            compiled().stages__carry(steps, gains, np.array(start, order="C"), np.empty((count, N, k)), out)
        return nodes
