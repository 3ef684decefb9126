"""Newton's correction of a turn or a pitch: what its change makes of itself, through all chambers and the unknowns.

A turn leaves a residual: what it changed in the history that the chambers ahead were read from, in the state that a
life begins with, in the feedback unknowns. The linearised pitch (`tangents`) tells what these changes make of the next
turns, all at once; what is left of them after the correction is what slices and the equations' curvature leave.

Source: docs/explanation/closing.md, Newton's correction.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from screwsim.cycle.coordinates import logarithms, states_of
from screwsim.cycle.linear_pitch import Tangents, shifted
from screwsim.cycle.problem import Problem
from screwsim.cycle.tangents import angles_of, linearised, slopes_of_image
from screwsim.model.composition import Composition
from screwsim.model.run import Machinery
from screwsim.model.slots import P_INJECTION, P_PITCH, S_RHO

Array = np.ndarray
STALE = 0.6  # change of a corrected turn over that of the one before, above which it is linearised anew ...
OF_NO_USE = 0.9  # ... and above which, if it just was, corrections are given up
BEYOND = 0.1  # of a correction by new tangents, in coordinates, above which the next is by newer ones
REPEATED = 0.5  # share of a correction that the next repeats, up to which what later ones add is made at once
LARGEST = 1.0  # of a correction, in coordinates: of a larger one that share is made ...
LEAST_SHARE = 0.4  # ... but none where that is less: a linear one tells nothing there
SINGULAR = 300.0  # a correction over the change that it is made of, above which any state is about as good as another
TOO_OFTEN = 3  # corrections that were too large, after which there are no more
NEXT = 1e-9  # of a pitch, from whose end on a place is that of the chamber behind
EVEN = 1e-9  # imaginary part of an eigenvalue over its size, up to which it is real
ITSELF = 1e-6  # by which the image of an unknown may differ from itself where the scene states it


class Correction(NamedTuple):
    """Changes of coordinates: of states at the start of a pitch (N,), `along` the edges of its slices, of unknowns."""

    edges: Array
    start: Array
    along: Array
    unknowns: Array
    share: float  # of the linear one: less than 1 where that were too large
    mass: float  # of the trapped gas, relative
    sums: Array  # of a life's quadratures (q,)
    back: Array  # (u, u) what the unknowns make of themselves once the states have settled

    @property
    def work(self) -> float:
        """The change of the work of a life [J]."""
        return float(self.sums[0])

    def times(self, factor: float) -> Correction:
        """Return the same correction, longer or shorter."""
        start, along, unknowns, sums = (factor * each for each in (self.start, self.along, self.unknowns, self.sums))
        return Correction(self.edges, start, along, unknowns, self.share, factor * self.mass, sums, self.back)


class Lasting(NamedTuple):
    """The change of the unknowns that lasts longest, `along` (u,) in coordinates, and by which `factor` it comes back.

    That is one of an even course, with no change of sign: a real eigenvalue, above 1 where the course leads away.
    """

    factor: float
    along: Array


class Residual(NamedTuple):
    """What a turn or a pitch changed, in coordinates.

    `ahead` (slices, N): where chambers read the history before of those ahead of them; `start` (N,): the states at the
    start of a pitch. The quadratures q of the life, which met the unknowns `met` and makes `made` of them.
    """

    ahead: Array
    start: Array
    q: Array
    met: Array
    made: Array


def corrected(problem: Problem, machinery: Machinery, tangents: Tangents, residual: Residual) -> Correction | None:
    """Return Newton's correction after the last life; None where a linear one tells nothing."""
    c, entries = machinery.composition, problem.entries
    by_residual = tangents.ahead @ residual.ahead[:, :, None]
    sources = np.concatenate([by_residual, tangents.by_unknowns], axis=2)  # a column each, of its own change
    start = np.zeros((len(residual.start), sources.shape[2]))
    ends = tangents.along(start, sources)[-1]
    start[:, 0] = residual.start
    start = tangents.around @ (shifted(ends, c.chambers) + start)
    along = tangents.along(start, sources)
    given = tangents.sums_along(along, sources)
    given[:, :, 1:] += tangents.sums_by_unknowns
    met, made = entries.coordinates(residual.met), entries.coordinates(residual.made)
    back = slopes_of_image(problem, machinery, tangents, given, residual.q, residual.met, residual.made)
    if not np.isfinite(back).all():
        return None
    matrix = np.eye(len(met)) - back[:, 1:]
    unknowns = np.linalg.lstsq(matrix, made + back[:, 0] - met)[0]
    kept = np.abs(matrix).max(axis=1, initial=0.0) < ITSELF
    unknowns[kept] = made[kept] - met[kept]
    weights = np.append(1.0, unknowns)
    found = start @ weights, along @ weights, met + unknowns - made
    largest, changed = _largest(found), _largest((residual.ahead, residual.start, made - met))
    if not largest <= SINGULAR * changed:  # not finite, too
        return None
    share = min(1.0, LARGEST / max(largest, LARGEST))
    if share < LEAST_SHARE:
        return None
    of_states, along, of_unknowns = (share * each for each in found)
    sums = share * (given.sum(axis=0) @ weights)
    mass = _trapped(c, of_states)
    return Correction(tangents.edges, of_states, along, of_unknowns, share, mass, sums, back[:, 1:])


def _trapped(c: Composition, start: Array) -> float:
    """Return the relative change of the trapped gas: that of the density where oil is injected, or the largest."""
    density, index = start.reshape(c.chambers, -1)[:, S_RHO], round(c.P[P_INJECTION] / c.P[P_PITCH])
    return float(density[index]) if index < c.chambers else float(np.abs(density).max())


def _largest(changes: Sequence[Array]) -> float:
    return max(float(np.abs(each).max(initial=0.0)) for each in changes)


class Corrections:
    """Corrections of turns or pitches: with tangents as long as they serve, given up where new ones are of no use.

    `lent` are those of a cycle nearby, to begin with.
    """

    def __init__(self, problem: Problem, machinery: Machinery, lent: Tangents | None = None) -> None:
        self.problem, self.machinery = problem, machinery
        c = machinery.composition
        self.able = c.chambers > 1
        self.tangents, self.last = lent, lent
        self._fresh, self._moved, self._too_large, self._far = False, np.inf, 0, False
        self._before: Array | None = None  # correction before, in coordinates
        self._back: Array | None = None  # what the unknowns make of themselves, by the last correction

    @property
    def begun(self) -> bool:
        """Were the last ones corrected?"""
        return self.tangents is not None

    @property
    def borrowed(self) -> bool:
        """Are the tangents of another scene's cycle?"""
        return self.tangents is not None and self.tangents.elsewhere

    def due(self, slow: bool, moved: float, near: bool = False) -> bool:
        """Tell whether what was just integrated, and moved the coordinates by `moved`, is to be corrected.

        It is where it contracts slowly, and once it was before. `near` the end it is noise of the steps that moves
        them: tangents stay.
        """
        stale = self.begun and moved > STALE * self._moved and not near
        if stale and self._fresh and moved > OF_NO_USE * self._moved:
            self.able = False
        due = self.able and (slow or self.begun)
        if stale or (due and self._far and not near):
            self.tangents = None
        self._moved = moved
        return due

    def of_turn(
        self, before: int, start: Array, q: Array, met: Array, made: Array, whole: bool = False
    ) -> Correction | None:
        """Move the last history by the correction of a turn, and return it.

        `before` are the steps of the history before, `start` (n,) the change of the state that a life begins with. With
        `whole` none is made that would have to be shortened.
        """
        machinery, c = self.machinery, self.machinery.composition

        def residual(tangents: Tangents) -> Residual:
            angles, N = angles_of(tangents.middles, c), c.chambers * machinery.n
            new, old = (logarithms(machinery.states_at(angles, of), c) for of in (None, before))
            ahead = (new - old).reshape(c.chambers, -1, machinery.n).transpose(1, 0, 2).reshape(-1, N)
            return Residual(ahead, np.concatenate([start, np.zeros(N - len(start))]), q, met, made)

        found = self._found(residual, met)
        if whole and (found is None or found.share < 1.0):
            self._too_large, self.tangents, self.last = 0, None, None
            return None
        if found is not None:
            _move(machinery, found)
        return found

    def of_pitch(self, start: Array, q: Array, met: Array, made: Array) -> Correction | None:
        """Return the correction of a pitch of all chambers, which is installed as the last history.

        `start` (N,) is the change of the states at its start.
        """
        return self._found(lambda t: Residual(np.zeros((len(t.step), len(start))), start, q, met, made), met)

    def _found(self, residual: Callable[[Tangents], Residual], met: Array) -> Correction | None:
        """Return the correction of a residual; those that are too large again and again lead away, and are the last."""
        self._fresh = self.tangents is None
        try:
            tangents = self.tangents or linearised(self.problem, self.machinery, met)
            found = corrected(self.problem, self.machinery, tangents, residual(tangents))
        except np.linalg.LinAlgError:
            tangents = found = None
        self.tangents, self.last = tangents, tangents or self.last
        if found is not None:
            self._back = found.back
            found = self._in_full(found)
            self._far = self._fresh and float(np.abs(found.along).max()) > BEYOND
        if found is None or found.share < 1.0:
            self.tangents, self._too_large = None, self._too_large + 1
            self.able = self.able and self._too_large < TOO_OFTEN
        return found

    def lasting(self) -> Lasting | None:
        """Return what lasts longest of a change of the unknowns; None where no correction told."""
        if self._back is None or not len(self._back):
            return None
        factors, along = np.linalg.eig(self._back)
        real = np.abs(np.imag(factors)) <= EVEN * np.abs(factors)
        if not real.any():
            return None
        most = int(np.argmax(np.where(real, np.real(factors), -np.inf)))
        one = np.real(along[:, most])
        return Lasting(float(np.real(factors[most])), one / np.abs(one).max())

    def _in_full(self, found: Correction) -> Correction:
        """Return a correction with what later ones by the same tangents would add to it.

        They repeat a share of each other, which the last two tell.
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


def led(problem: Problem, by: Correction, end: Array, y: Array, made: Array) -> Array:
    """Lead the state y [in place] that the next life begins with, `end` in coordinates; return the unknowns met."""
    entries = problem.entries
    y[:] = states_of(end + by.along[-1, -len(end) :], y, problem.composition)
    return entries.values(entries.coordinates(made) + by.unknowns, made)


def _move(machinery: Machinery, by: Correction) -> None:
    """Move the last history by a correction, linear between the ends of the slices."""
    c, n = machinery.composition, machinery.n
    times, dense, quads, steps = machinery.last()
    t, states = times[: steps + 1].copy(), dense[:steps, :, :n].copy()
    changes = by.along.reshape(-1, c.chambers, n).transpose(1, 0, 2).reshape(-1, n)
    inside = by.edges.copy()
    inside[-1] *= 1.0 - NEXT  # the next chamber's place begins there
    angles = angles_of(inside, c)
    ends = t[1:] - NEXT * by.edges[-1]  # that of a step before oil is injected has not met it
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
