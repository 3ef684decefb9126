"""All chambers over one pitch as a linear map: what small changes make of themselves (made by `tangents`).

Source: docs/explanation/closing.md, Newton's correction.
"""

from typing import NamedTuple

import numpy as np

Array = np.ndarray


class Tangents(NamedTuple):
    """One pitch of N coordinates, linearised in the middles of its slices between `edges` [rad].

    `enter` (N, N) is the injection of oil at its start. Over a slice, (slices, N, …): `step` takes a change to its end,
    `gain` a source there; sources are `ahead`, what the chambers ahead changed, and `by_unknowns` (…, u). Of the
    quadratures, (slices, q, …): `sums` what a change at a slice's start adds, `sums_gain` a source, `sums_by_unknowns`
    the unknowns at unchanged states. `around` (N, N) is the inverse of 1 − the map of a pitch. Those of another scene's
    cycle are from `elsewhere`.
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
        """Return what changes (N, k) at the start and sources (slices, N, k) make of themselves, at all edges."""
        made = np.empty((len(sources) + 1, *start.shape))
        made[0] = self.enter @ start
        for k, gained in enumerate(self.gain @ sources):
            made[k + 1] = self.step[k] @ made[k] + gained
        return made

    def sums_along(self, along: Array, sources: Array) -> Array:
        """Return what changes `along` a pitch, and their sources, add to the quadratures (slices, q, k)."""
        return self.sums @ along[:-1] + self.sums_gain @ sources

    def spread(self, given: Array, points: int) -> Array:
        """Return what a slice gives (slices, …), as rates by the angle [1/rad] at even angles of a pitch (points, …).

        Each rate is the mean around its angle, so that none of what slices give is lost between angles.
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
    """Return rows of all chambers a pitch on: each takes the next place."""
    return np.roll(changes, len(changes) // chambers, axis=0)
