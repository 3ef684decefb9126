"""Approximate Newton iterations of the collocated cycle with each chamber's own derivatives only.

Chambers are coupled by gaps, weakly. So the matrix is that of one chamber, and a solution costs a fraction of the full
one. To place slices (`approach`), start and unknowns are kept as the integrator left them. To close the cycle
(`closed`), a chamber's changes are followed through its life, and the unknowns are set to their image.
"""

from dataclasses import dataclass, field

import numpy as np

from screwsim.derivatives import residual
from screwsim.derivatives.argument_changes import step_of
from screwsim.derivatives.block_bidiagonal import BlockBidiagonal
from screwsim.derivatives.lane_rates import rates
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.residual import largest_by_slice
from screwsim.derivatives.unknowns import coordinates_of, put_unknowns, unknowns_of

Array = np.ndarray
MOST_ITERATIONS = 12  # iterations
KEEP_SLOPES_BELOW = 0.2  # ratio of residuals up to which the derivatives of the iteration before are kept
RENEWED_ABOVE = 0.1  # share of the wanted residual above which the derivatives of a slice are taken anew
CLOSINGS = 8  # iterations that may close a cycle, while each residual is at most ...
AGAIN = 4.0  # ... this many times the least before: a residual may return through other chambers before it decays
LONGEST = 0.3  # relative change of a state in one iteration
SWING_SHARE = 0.4  # ratio to the change before, above which a change of opposite sign is halved
ALIKE = 0.03  # of its width: how much longer or shorter a slice may be than one whose factors it takes over
UNCHANGED_WITHIN = 1e-3  # relative change of a state, up to which its slice's derivatives are kept for the next round


@dataclass
class ChamberFactors:
    """The last factored stage equations of each chamber alone, with the edges and states of their slices.

    They are tried for other slices of the same number, which have moved slightly with turning flows. If the number
    differs, slices take over the factors of one at their place with (nearly) the same width and states. Where the
    iteration then converges too slowly, the slices to blame are factored anew.
    """

    blocks: BlockBidiagonal | None = None
    edges: Array = field(default_factory=lambda: np.zeros(1))
    states: Array = field(default_factory=lambda: np.zeros(0))
    good: bool = True  # whether iterations with them converged fast enough

    def of(self, pitch: CollocatedPitch) -> BlockBidiagonal | None:
        """Return the kept factors, if they may serve a pitch."""
        return self.blocks if pitch.count == len(self.edges) - 1 else None

    def begun(self, pitch: CollocatedPitch, Y: Array, alike: float = 0.0) -> BlockBidiagonal:
        """Return the factors for a pitch with other slices; only slices that are new or have moved are factored.

        Those of slices whose widths differ by up to a share `alike` are taken over.
        """
        if self.blocks is None or not self.good:
            return self.anew(pitch, Y)
        states = self.states[self._before(pitch)]
        return self.renewed(pitch, Y, largest_by_slice(Y - states, Y) > UNCHANGED_WITHIN, alike)

    def renewed(self, pitch: CollocatedPitch, Y: Array, wrong: Array, alike: float) -> BlockBidiagonal:
        """Return the factors for a pitch where those of `wrong` slices, and of ones that are not `alike`, are new."""
        assert self.blocks is not None
        edges, before, at = pitch.mesh.edges, self.edges, self._before(pitch)
        widths = np.diff(before)[at]
        new = wrong | (np.abs(np.diff(edges) - widths) > alike * widths)
        if not new.any():
            return self.anew(pitch, Y)
        found, self.states = _blocks(pitch, Y, np.flatnonzero(new)), np.where(new[:, None, None], Y, self.states[at])
        self.blocks, self.edges = found.among(self.blocks, new, at[~new], pitch.N // pitch.n), edges
        return self.blocks

    def _before(self, pitch: CollocatedPitch) -> Array:
        """Return the index of the kept slice that holds the middle of each slice of a pitch."""
        return np.clip(np.searchsorted(self.edges, pitch.mesh.middles) - 1, 0, len(self.edges) - 2)

    def anew(self, pitch: CollocatedPitch, Y: Array) -> BlockBidiagonal:
        """Return, and keep, new factors for a pitch at given states."""
        self.blocks, self.edges = _blocks(pitch, Y, np.arange(pitch.count)), pitch.mesh.edges
        self.states = Y
        return self.blocks


def approach(pitch: CollocatedPitch, bound: float, kept: ChamberFactors) -> tuple[Array, Array] | None:
    """Return states at start and nodes with less than a relative residual, installed; None if none are found."""
    Y, before, blocks = pitch.read(), np.inf, kept.of(pitch)
    start, last, nothing = pitch.period.start(Y), np.zeros_like(Y), np.zeros((pitch.N, pitch.N))
    for _ in range(MOST_ITERATIONS):
        open_ = residual.stage_residual(pitch, Y, start, rates(pitch.rates, Y)[0])
        size = residual.size_of(open_, Y)
        if size < bound:
            kept.good = size < KEEP_SLOPES_BELOW * before
            pitch.install(start, Y)
            return start, Y
        if not np.isfinite(size):
            break
        if blocks is None:
            blocks = kept.begun(pitch, Y, ALIKE)
        elif size > KEEP_SLOPES_BELOW * before:
            blocks = kept.renewed(pitch, Y, largest_by_slice(open_, Y) > RENEWED_ABOVE * bound, ALIKE)
        before = size
        last = damped(blocks.follow_one_by_one(-open_, nothing), last)
        Y = limited_step(pitch, Y, last)
    return None


def closed(pitch: CollocatedPitch, Y: Array, bound: float, kept: ChamberFactors) -> Array | None:
    """Return states at the nodes that close the cycle within a relative residual, installed; None if none are found.

    The unknowns are set to their image; where it fails, they are restored.
    """
    at, least, first = pitch.numbers, np.inf, Y
    blocks, inject = kept.of(pitch), None
    lent = blocks is not None
    for _ in range(CLOSINGS):
        open_ = residual.residual_of(pitch, Y)
        size = open_.size(Y)
        if size < bound:
            pitch.install(open_.start, Y)
            return Y
        worse = not size < AGAIN * least
        if worse and not (lent and np.isfinite(size)):
            break
        if blocks is None:
            blocks, lent = kept.begun(pitch, Y), True
        elif worse:
            blocks, lent = kept.anew(pitch, Y), False
        inject = pitch.period.jacobian(Y, step_of(pitch))[0] if inject is None else inject
        least = min(size, least)
        Y = limited_step(pitch, Y, blocks.follow_one_by_one(-open_.stages, inject))
        now = unknowns_of(pitch)
        put_unknowns(pitch, coordinates_of(pitch, now) + open_.unknowns, now)
    pitch.put(at)
    pitch.install(pitch.period.start(first), first)
    return None


def _blocks(pitch: CollocatedPitch, Y: Array, slices: Array) -> BlockBidiagonal:
    """Return the factored stage equations of each chamber alone, for some slices."""
    chambers, n = pitch.N // pitch.n, pitch.n
    return BlockBidiagonal(pitch.rates.by_own_states(Y, slices), np.tile(pitch.mesh.widths[slices], chambers), n, 0)


def damped(change: Array, last: Array) -> Array:
    """Return a change, halved where it nearly takes back the last one, alternating across a steep flow."""
    swings = (change * last < 0.0) & (np.abs(change) > SWING_SHARE * np.abs(last))
    return np.where(swings, 0.5 * change, change)


def limited_step(pitch: CollocatedPitch, Y: Array, change: Array) -> Array:
    """Return states changed by at most `LONGEST` of themselves; states of either sign change without limit."""
    c = pitch.machinery.composition
    most = LONGEST * np.abs(Y)
    for signed in c.signed:
        most[..., signed :: pitch.n] = np.inf
    return Y + np.minimum(np.maximum(change, -most), most)
