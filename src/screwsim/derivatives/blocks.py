"""The stage equations of all slices, solved: a chamber meets the next ones alone, so their matrix is a band."""

from __future__ import annotations

import numpy as np

from screwsim.derivatives.slices import NODES
from screwsim.derivatives.stages import compiled

Array = np.ndarray


class Blocks:
    """1 − h a J of every slice, factored; J (slices, NODES, N, N) are derivatives by the states of all chambers."""

    def __init__(self, J: Array, widths: Array, states: int, reach: int) -> None:
        """`states` are those of a chamber, `reach` is how many chambers on it meets others; what lies beyond is left out."""
        count, _, N, _ = J.shape
        self.states, self.reach = states, reach
        self.factors, self.pivots = np.empty((count, NODES * N, NODES * N)), np.empty((count, NODES * N), np.int64)
        compiled().stages__factor(J.reshape(-1, N, N), widths, states, reach, self.factors, self.pivots)

    def follow(self, start: Array, right: Array) -> Array:
        """Return changes at all nodes (slices, NODES, N, k) from those at the start (N, k).

        `right`, of the nodes' shape, are the right sides of the stage equations; it is written over.
        """
        count, _, N, k = right.shape
        if k:
            rows, now = right.reshape(count, NODES * N, k), np.array(start, order="C")
            compiled().stages__follow(self.factors, self.pivots, self.states, self.reach, now, rows)
        return right
