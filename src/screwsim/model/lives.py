"""The last life of a chamber, and the one being integrated: the arrays that the compiled module reads and fills.

A history holds the angles of a life's steps [rad], their dense output, and the quadratures up to the end of each.
"""

from collections.abc import Sequence
from types import ModuleType

import numpy as np

from screwsim.numerics.reused_arrays import room

Array = np.ndarray
History = tuple[Array, Array, Array]  # times, dense output, quadratures


def new_history(steps: int, n: int, nq: int) -> History:
    """Return arrays for a history: times, dense output of n columns, quadratures."""
    return room(steps + 1), room(steps, 4, n), room(steps, nq)


class Lives:
    """Two histories: `histories[0]` is the last life's, `histories[1]` the one being written.

    `kept` are their numbers of steps, the one being written first. The first `n` columns of the dense output are
    states.
    """

    def __init__(self, module: ModuleType, n: int, columns: int, nq: int, max_steps: int) -> None:
        self.module, self.n, self.columns, self.nq, self.max_steps = module, n, columns, nq, max_steps
        self.histories = [new_history(max_steps, columns, nq) for _ in range(2)]
        self.kept = np.zeros(2, np.int64)
        self._rows: dict[int, tuple[Array, Array]] = {}  # buffers of `states_along`, by length

    def swap(self) -> None:
        """Make the life just integrated the last one."""
        self.histories.reverse()
        self.kept[1] = self.kept[0]
        self.kept[0] = 0

    def last(self) -> tuple[Array, Array, Array, int]:
        """Return (times, dense, quadratures, steps) of the last life."""
        return (*self.histories[0], int(self.kept[1]))

    def store(self, times: Array, dense: Array, quads: Array | float) -> History:
        """Store steps as the last life, of which `dense` may have the states alone; return its arrays."""
        steps = len(dense)
        self._make_room(steps)
        old = self.histories[0]
        old[0][: steps + 1], old[1][:steps, :, : dense.shape[2]], old[2][:steps] = times, dense, quads
        self.kept[:] = 0, steps
        return old

    def renewed(self, steps: int) -> History:
        """Return new arrays for the life being integrated, with room for a number of steps."""
        self.histories[1] = new_history(max(steps, self.max_steps), self.columns, self.nq)
        return self.histories[1]

    def image(self) -> tuple[Array, Array, int]:
        """Return a copy of the last life's times and dense output, and its steps, for blending with others."""
        times, dense, _, steps = self.last()
        return times[: steps + 1].copy(), dense[:steps].copy(), steps

    def blend(self, histories: Sequence[tuple[Array, Array, int]], weights: Array) -> None:
        """Replace the last life by a weighted sum of lives, on the steps of the last of them."""
        times, dense, steps = histories[-1]
        self._make_room(steps)
        old = self.histories[0]
        old[0][: steps + 1] = times
        self.kept[:] = 0, steps
        *others, last = weights.tolist()
        np.multiply(dense, last, out=old[1][:steps])
        for weight, (t, d, n) in zip(others, histories[:-1], strict=True):
            self.module.history__add_history(times, steps, t, d, n, weight, old[1])

    def states_at(self, angles: Array, before: int | None = None) -> Array:
        """Return the states of the last life at increasing angles [rad], one row for each angle.

        With `before`, those of the life before it, which had that many steps; valid until a turn overwrites it.
        """
        out = np.empty((len(angles), self.n))
        times, dense, _ = self.histories[0 if before is None else 1]
        steps = int(self.kept[1]) if before is None else before
        self.module.history__states_at(angles, times, dense, steps, out)
        return out

    def states_along(self, first: Array, angles: Array) -> Array:
        """Return a state (n,) followed by those of the last life at increasing angles [rad].

        The rows belong to this object: the next call overwrites them.
        """
        rows = self._rows.get(len(angles))
        if rows is None:
            every = np.empty((len(angles) + 1, self.n))
            rows = self._rows[len(angles)] = every, every[1:]  # kept, as calls remember the addresses of arrays
        rows[0][0] = first
        times, dense, _ = self.histories[0]
        self.module.history__states_at(angles, times, dense, int(self.kept[1]), rows[1])
        return rows[0]

    def _make_room(self, steps: int) -> None:
        """Enlarge both histories where they have too few steps."""
        if steps > self.max_steps:
            self.max_steps = steps
            self.histories = [new_history(steps, self.columns, self.nq) for _ in range(2)]
