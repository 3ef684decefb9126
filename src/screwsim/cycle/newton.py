"""Newton's correction of a turn or a pitch: remove at once what would otherwise circulate through many more turns.

A turn leaves a residual: its change of the history that the chambers ahead were read from, of the state that a life
starts with, and of the feedback unknowns. The linearised pitch (`tangents`) gives the limit of this residual's effect
through all chambers and unknowns. The errors of the slices and the curvature of the equations remain for the next turn.

Source: docs/explanation/closing.md, Newton's correction.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple, Self

import numpy as np

from screwsim.cycle.coordinates import logarithms, states_of
from screwsim.cycle.linear_pitch import Tangents, shifted
from screwsim.cycle.problem import Problem
from screwsim.cycle.tangents import angles_of, linearised, slopes_of_image
from screwsim.model.composition import Composition
from screwsim.model.run import Machinery
from screwsim.model.slots import P_INJECTION, P_PITCH, S_RHO

Array = np.ndarray
STALE = 0.6  # ratio of a corrected turn's change to that of the turn before, above which tangents are renewed ...
STALE_WHEN_NEW = 0.9  # ... and above which, if they just were, corrections are given up
RENEW_ABOVE = 0.1  # size of a correction by new tangents, in coordinates, above which they are renewed at once
REPEATED = 0.5  # share of a correction that repeats in the next, up to which the geometric series is summed at once
LARGEST = 1.0  # size of a correction, in coordinates, to which larger ones are shortened ...
LEAST_SHARE = 0.4  # ... but none is made if that leaves less: a linear correction is meaningless there
SINGULAR = 300.0  # ratio of a correction to its residual, above which any state is about as good a cycle as another
MOST_SHORTENED = 3  # shortened or impossible corrections after which no more are made
PLACE_MARGIN = 1e-9  # share of a pitch by which the end of a place stays before the next place
REAL_WITHIN = 1e-9  # imaginary part of an eigenvalue over its size, up to which it counts as real
IDENTITY_WITHIN = 1e-6  # departure of an image's derivatives from identity, up to which the scene states the unknown


class Correction(NamedTuple):
    """Changes of coordinates: of states at the start of a pitch (N,), `along` the slices' edges, of the unknowns."""

    edges: Array
    start: Array
    along: Array
    unknowns: Array
    share: float  # of the full linear correction: below 1 where that was too large
    mass: float  # relative change of the trapped gas
    sums: Array  # change of a life's quadratures (q,)
    back: Array  # (u, u) response of the unknowns to themselves, with the states settled

    @property
    def work(self) -> float:
        """The change of the work of a life [J]."""
        return float(self.sums[0])

    def times(self, factor: float) -> Self:
        """Return the correction multiplied by a factor."""
        changed = "start", "along", "unknowns", "mass", "sums"
        return self._replace(**{name: factor * getattr(self, name) for name in changed})


class SlowestMode(NamedTuple):
    """The slowest-decaying change of the unknowns, `along` (u,) in coordinates, and the `factor` by which it returns.

    It belongs to a real eigenvalue, so it does not change sign; above 1 the machine's own course leads away.
    """

    factor: float
    along: Array


class Residual(NamedTuple):
    """The changes over a turn or a pitch, in coordinates.

    `ahead` (slices, N): where chambers read those ahead from the history before; `start` (N,): of the states at the
    start of a pitch. q are the quadratures of the life, `unknowns_in` those it was integrated with,
    `unknowns_out` their next values.
    """

    ahead: Array
    start: Array
    q: Array
    unknowns_in: Array
    unknowns_out: Array


def corrected(problem: Problem, machinery: Machinery, tangents: Tangents, residual: Residual) -> Correction | None:
    """Return Newton's correction after the last life; None where a linear correction is meaningless."""
    c, entries = machinery.composition, problem.entries
    if not np.isfinite(residual.unknowns_out).all():
        return None
    by_residual = tangents.ahead @ residual.ahead[:, :, None]
    sources = np.concatenate([by_residual, tangents.by_unknowns], axis=2)  # a column for each change
    start = np.zeros((len(residual.start), sources.shape[2]))
    ends = tangents.along(start, sources)[-1]
    start[:, 0] = residual.start
    start = tangents.around @ (shifted(ends, c.chambers) + start)
    along = tangents.along(start, sources)
    given = tangents.sums_along(along, sources)
    given[:, :, 1:] += tangents.sums_by_unknowns
    unknowns_in, unknowns_out = entries.coordinates(residual.unknowns_in), entries.coordinates(residual.unknowns_out)
    back = slopes_of_image(problem, machinery, tangents, given, residual.q, residual.unknowns_in, residual.unknowns_out)
    if not np.isfinite(back).all():
        return None
    matrix = np.eye(len(unknowns_in)) - back[:, 1:]
    unknowns = np.linalg.lstsq(matrix, unknowns_out + back[:, 0] - unknowns_in)[0]
    kept = np.abs(matrix).max(axis=1, initial=0.0) < IDENTITY_WITHIN
    unknowns[kept] = unknowns_out[kept] - unknowns_in[kept]
    weights = np.append(1.0, unknowns)
    found = start @ weights, along @ weights, unknowns_in + unknowns - unknowns_out
    largest, changed = _largest(found), _largest((residual.ahead, residual.start, unknowns_out - unknowns_in))
    if not largest <= SINGULAR * changed:  # not finite, too
        return None
    share = min(1.0, LARGEST / max(largest, LARGEST))
    if share < LEAST_SHARE:
        return None
    of_states, along, of_unknowns = (share * each for each in found)
    sums = share * (given.sum(axis=0) @ weights)
    mass = _trapped_change(c, of_states)
    return Correction(tangents.edges, of_states, along, of_unknowns, share, mass, sums, back[:, 1:])


def _trapped_change(c: Composition, start: Array) -> float:
    """Return the relative change of the trapped gas: that of the density at the injection angle, else the largest."""
    density, index = start.reshape(c.chambers, -1)[:, S_RHO], round(c.P[P_INJECTION] / c.P[P_PITCH])
    return float(density[index]) if index < c.chambers else float(np.abs(density).max())


def _largest(changes: Sequence[Array]) -> float:
    """Return the largest absolute value among several arrays."""
    return max(float(np.abs(each).max(initial=0.0)) for each in changes)


class Corrections:
    """Corrections of turns or pitches: tangents are kept while they serve; all is given up where new ones do not help.

    `lent` are the tangents of a nearby cycle to start with.
    """

    def __init__(self, problem: Problem, machinery: Machinery, lent: Tangents | None = None) -> None:
        self.problem, self.machinery = problem, machinery
        c = machinery.composition
        self.able = c.chambers > 1
        self.tangents, self.last = lent, lent
        self._fresh, self._moved, self._too_large, self._far = False, np.inf, 0, False
        self._before: Array | None = None  # correction before, in coordinates
        self._back: Array | None = None  # response of the unknowns to themselves, by the last correction

    @property
    def begun(self) -> bool:
        """Whether corrections are being made."""
        return self.tangents is not None

    def due(self, slow: bool, moved: float, near: bool = False) -> bool:
        """Return whether the last turn or pitch, which moved the coordinates by `moved`, is to be corrected.

        It is if it contracts slowly, and always once corrections have begun. Tangents that have become stale
        are dropped, but not `near` the end, where changes are noise of the steps.
        """
        stale = self.begun and moved > STALE * self._moved and not near
        if stale and self._fresh and moved > STALE_WHEN_NEW * self._moved:
            self.able = False
        due = self.able and (slow or self.begun)
        if stale or (due and self._far and not near):
            self.tangents = None
        self._moved = moved
        return due

    def of_turn(
        self, before: int, start: Array, q: Array, unknowns_in: Array, unknowns_out: Array, whole: bool = False
    ) -> Correction | None:
        """Return the correction of a turn, and move the last history by it; None where there is none.

        Arguments are those of `foreseen`. With `whole`, a correction that would have to be shortened is not made.
        """
        found = self.foreseen(before, start, q, unknowns_in, unknowns_out)
        if whole and (found is None or found.share < 1.0):
            self._too_large, self.tangents, self.last = 0, None, None
            return None
        if found is not None:
            _move_history(self.machinery, found)
        return found

    def foreseen(
        self, before: int, start: Array, q: Array, unknowns_in: Array, unknowns_out: Array
    ) -> Correction | None:
        """Return the correction of a turn, which leaves the last history as it is; None where there is none.

        `before` is the number of steps of the history before, `start` (n,) the change of the state that a life
        starts with, q the turn's quadratures, `unknowns_out` the next values of the unknowns that it was made with.
        """
        machinery, c = self.machinery, self.machinery.composition

        def residual(tangents: Tangents) -> Residual:
            angles, N = angles_of(tangents.middles, c), c.chambers * machinery.n
            new, old = (logarithms(machinery.lives.states_at(angles, of), c) for of in (None, before))
            ahead = (new - old).reshape(c.chambers, -1, machinery.n).transpose(1, 0, 2).reshape(-1, N)
            return Residual(ahead, np.concatenate([start, np.zeros(N - len(start))]), q, unknowns_in, unknowns_out)

        return self._found(residual, unknowns_in)

    def of_pitch(self, start: Array, q: Array, unknowns_in: Array, unknowns_out: Array) -> Correction | None:
        """Return the correction of a pitch of all chambers, which is installed as the last history.

        `start` (N,) is the change of the states at its start.
        """
        return self._found(
            lambda t: Residual(np.zeros((len(t.step), len(start))), start, q, unknowns_in, unknowns_out), unknowns_in
        )

    def _found(self, residual: Callable[[Tangents], Residual], unknowns_in: Array) -> Correction | None:
        """Return a residual's correction, with new tangents where needed; stop after `MOST_SHORTENED` failures."""
        self._fresh = self.tangents is None
        try:
            tangents = self.tangents or linearised(self.problem, self.machinery, unknowns_in)
            found = corrected(self.problem, self.machinery, tangents, residual(tangents))
        except np.linalg.LinAlgError:
            tangents = found = None
        self.tangents, self.last = tangents, tangents or self.last
        if found is not None:
            self._back = found.back
            found = self._in_full(found)
            self._far = self._fresh and float(np.abs(found.along).max()) > RENEW_ABOVE
        if found is None or found.share < 1.0:
            self.tangents, self._too_large = None, self._too_large + 1
            self.able = self.able and self._too_large < MOST_SHORTENED
        return found

    def lasting(self) -> SlowestMode | None:
        """Return the slowest-decaying change of the unknowns; None without a correction or a real eigenvalue."""
        if self._back is None or not len(self._back):
            return None
        factors, along = np.linalg.eig(self._back)
        real = np.abs(np.imag(factors)) <= REAL_WITHIN * np.abs(factors)
        if not real.any():
            return None
        most = int(np.argmax(np.where(real, np.real(factors), -np.inf)))
        one = np.real(along[:, most])
        return SlowestMode(float(np.real(factors[most])), one / np.abs(one).max())

    def _in_full(self, found: Correction) -> Correction:
        """Return a correction together with what later ones by the same tangents would add.

        Each repeats a share of the one before, estimated from the last two; the geometric series is summed.
        """
        here = np.concatenate([found.along.ravel(), found.unknowns])
        before, self._before = self._before, here
        if self._fresh or before is None or found.share < 1.0:
            return found
        share = float(here @ before) / max(float(before @ before), 1e-300)
        if not abs(share) < REPEATED:
            return found
        self._before = here / (1.0 - share)
        return found.times(1.0 / (1.0 - share))


def corrected_start(problem: Problem, by: Correction, end: Array, y: Array, unknowns_out: Array) -> Array:
    """Set y [in place] to the corrected state that the next life starts with; return the corrected unknowns.

    `end` is the uncorrected state in coordinates.
    """
    entries = problem.entries
    y[:] = states_of(end + by.along[-1, -len(end) :], y, problem.composition)
    return entries.values(entries.coordinates(unknowns_out) + by.unknowns, unknowns_out)


def _move_history(machinery: Machinery, by: Correction) -> None:
    """Apply a correction to the last history, interpolated linearly between the edges of the slices."""
    c, n = machinery.composition, machinery.n
    times, dense, quads, steps = machinery.lives.last()
    t, states = times[: steps + 1].copy(), dense[:steps, :, :n].copy()
    changes = by.along.reshape(-1, c.chambers, n).transpose(1, 0, 2).reshape(-1, n)
    inside = by.edges.copy()
    inside[-1] *= 1.0 - PLACE_MARGIN  # the next chamber's place starts there
    angles = angles_of(inside, c)
    ends = t[1:] - PLACE_MARGIN * by.edges[-1]  # a step that ends at the injection precedes it
    began, ended = (np.column_stack([np.interp(at, angles, change) for change in changes.T]) for at in (t[:-1], ends))
    signed = list(c.signed)
    at_start, at_end = np.exp(began), np.exp(ended)
    at_start[:, signed] = at_end[:, signed] = 1.0
    states[:, 0] *= at_start
    states[:, 1] *= at_end
    states[:, 2:] *= (0.5 * (at_start + at_end))[:, None]
    if signed:
        states[:, 0, signed] += began[:, signed]
        states[:, 1, signed] += ended[:, signed]
    machinery.install(t, states, quads[:steps].copy())
