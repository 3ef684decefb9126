"""The linearised pitch: the linear map of small changes of all chambers over one pitch (built by `tangents`).

Source: docs/explanation/closing.md, Newton's correction.
"""

from typing import NamedTuple

import numpy as np

Array = np.ndarray


class Tangents(NamedTuple):
    """One pitch of N coordinates, linearised at the middle of each slice between `edges` [rad].

    `enter` (N, N) is the injection of oil at its start. Over a slice, (slices, N, …): `step` maps a change to its
    end, `gain` a source there. Sources are `ahead`, the response to changes of the chambers ahead, and
    `by_unknowns` (…, u). For the quadratures, (slices, q, …): `sums` is the response to a change at a slice's
    start, `sums_gain` to a source, `sums_by_unknowns` to the unknowns at unchanged states. `around` (N, N) is the
    inverse of 1 − the map of a pitch. `elsewhere`: these belong to another scene's cycle.
    """

    edges: Array
    enter: Array
    step: Array
    gain: Array
    ahead: Array
    by_unknowns: Array
    sums: Array
    sums_gain: Array
    sums_by_unknowns: Array
    around: Array
    elsewhere: bool = False

    @property
    def middles(self) -> Array:
        """The middles of the slices [rad]."""
        return 0.5 * (self.edges[:-1] + self.edges[1:])

    def along(self, start: Array, sources: Array) -> Array:
        """Return the response, at all edges, to changes (N, k) at the start and sources (slices, N, k)."""
        made = np.empty((len(sources) + 1, *start.shape))
        made[0] = self.enter @ start
        for k, gained in enumerate(self.gain @ sources):
            made[k + 1] = self.step[k] @ made[k] + gained
        return made

    def sums_along(self, along: Array, sources: Array) -> Array:
        """Return the response of the quadratures (slices, q, k) to changes `along` a pitch and their sources."""
        return self.sums @ along[:-1] + self.sums_gain @ sources

    def spread(self, given: Array, points: int) -> Array:
        """Return amounts by slice (slices, …) as rates by the angle [1/rad] at even angles of a pitch (points, …).

        Each rate is the mean around its angle, so that nothing is lost between angles.
        """
        pitch = float(self.edges[-1])
        sums = np.concatenate([np.zeros((1, *given.shape[1:])), np.cumsum(given, axis=0)])
        places = (np.arange(points + 1) - 0.5) * (pitch / points)
        turns = np.floor(places / pitch)
        flat = sums.reshape(len(sums), -1)
        at = np.array([np.interp(places - turns * pitch, self.edges, column) for column in flat.T]).T
        at += turns[:, None] * flat[-1]
        return (np.diff(at, axis=0) * (points / pitch)).reshape(points, *given.shape[1:])


def shifted(changes: Array, chambers: int) -> Array:
    """Return rows of all chambers a pitch later: each moves to the next place."""
    return np.roll(changes, len(changes) // chambers, axis=0)
