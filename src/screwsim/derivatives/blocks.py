"""The stage equations of all slices, solved: a chamber meets only the next ones, so their matrix has few diagonals.

Chambers are grouped so that a group meets its two neighbours alone: a block tridiagonal matrix, all slices at once.
"""

from __future__ import annotations

import numpy as np

from screwsim.derivatives.slices import INTEGRALS, NODES

Array = np.ndarray


class Blocks:
    """1 − h a J of every slice, factored; J (slices, NODES, N, N) are derivatives by the states of all chambers."""

    def __init__(self, J: Array, widths: Array, states: int, reach: int) -> None:
        """`states` are those of a chamber, `reach` is how many chambers on it meets others."""
        count, _, N, _ = J.shape
        chambers = N // states
        self.size = states * max(1, reach)
        self.groups = -(-chambers // max(1, reach))
        self.N, room = N, self.groups * self.size
        if room > N:
            wide = np.zeros((count, NODES, room, room))
            wide[:, :, :N, :N] = J
            J = wide
        split = J.reshape(count, NODES, self.groups, self.size, self.groups, self.size)
        weights = widths[:, None, None] * INTEGRALS
        own = self._block(weights, split, 0)
        own += np.eye(NODES * self.size)
        self.upper, lower = self._block(weights, split, 1), self._block(weights, split, -1)
        self.inverses, self.below = [np.linalg.inv(own[:, 0])], []
        for g in range(1, self.groups):
            self.below.append(lower[:, g - 1] @ self.inverses[-1])
            self.inverses.append(np.linalg.inv(own[:, g] - self.below[-1] @ self.upper[:, g - 1]))

    def _block(self, weights: Array, split: Array, diagonal: int) -> Array:
        """Return the blocks on a diagonal (slices, groups, NODES size, NODES size)."""
        first, last = max(0, -diagonal), self.groups - max(0, diagonal)
        rows = range(first, last)
        blocks = np.stack([split[:, :, g, :, g + diagonal, :] for g in rows] or [split[:, :, 0, :, 0, :] * 0.0], axis=1)
        spread = -weights[:, None, :, None, :, None] * blocks.transpose(0, 1, 3, 2, 4)[:, :, None]
        wide = NODES * self.size
        return spread.reshape(len(weights), -1, wide, wide)

    def solve(self, right: Array) -> Array:
        """Return what solves the stage equations for right sides (slices, NODES, N, k)."""
        count, _, N, k = right.shape
        if self.groups * self.size > N:
            wide = np.zeros((count, NODES, self.groups * self.size, k))
            wide[:, :, :N] = right
            right = wide
        split = right.reshape(count, NODES, self.groups, self.size, k).transpose(2, 0, 1, 3, 4)
        found = list(split.reshape(self.groups, count, NODES * self.size, k))
        for g in range(1, self.groups):
            found[g] = found[g] - self.below[g - 1] @ found[g - 1]
        found[-1] = self.inverses[-1] @ found[-1]
        for g in range(self.groups - 2, -1, -1):
            found[g] = self.inverses[g] @ (found[g] - self.upper[:, g] @ found[g + 1])
        whole = np.stack(found).reshape(self.groups, count, NODES, self.size, k).transpose(1, 2, 0, 3, 4)
        return whole.reshape(count, NODES, -1, k)[:, :, :N]
