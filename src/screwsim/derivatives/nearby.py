"""States near those of the closed cycle, to place slices by: the start and the unknowns held as the integrator left them.

Newton's method with what each chamber makes of itself alone: gaps tie it to the others, by little. So the matrix is that
of one chamber, no change goes around the pitch, and a solution takes a fraction of the closing one.
"""

from __future__ import annotations

import numpy as np

from screwsim.derivatives.blocks import Blocks
from screwsim.derivatives.pitch import Pitch
from screwsim.derivatives.slices import INTEGRALS

Array = np.ndarray
MOST = 12  # iterations
KEPT = 0.5  # of the residual before, down to which slopes of the iteration before are good enough
LONGEST = 0.3  # change of a state in one iteration, over itself
SWING = 0.4  # of the change before, beyond which one that goes back is halved
SMALL = 1e-3  # of a state, for relative residuals


def near(pitch: Pitch, bound: float) -> tuple[Array, Array] | None:
    """Return states at the start and the nodes that leave less than a relative residual, installed; None for none."""
    Y, before, blocks = pitch.read(), np.inf, None
    start, last = pitch.begin(Y), np.zeros_like(Y)
    for _ in range(MOST):
        open_ = residual(pitch, Y, start, pitch.rates(Y)[0])
        size = size_of(open_, Y)
        if size < bound:
            pitch.install(start, Y)
            return start, Y
        if not np.isfinite(size):
            break
        if blocks is None or size > KEPT * before:
            blocks = Blocks(pitch.slopes(Y).by_states, pitch.slices.widths, pitch.n, 0)
        before = size
        last = tamed(blocks.follow(np.zeros((pitch.N, 1)), -open_[..., None])[..., 0], last)
        Y = stepped(pitch, Y, last)
    return None


def residual(pitch: Pitch, Y: Array, start: Array, f: Array) -> Array:
    """Return what the stage equations leave open (slices, NODES, N)."""
    before = np.concatenate([start[None], Y[:-1, -1]])
    return Y - before[:, None] - np.einsum("k,ij,kjn->kin", pitch.slices.widths, INTEGRALS, f)


def size_of(open_: Array, Y: Array) -> float:
    """Return a relative residual."""
    return float(np.max(np.abs(open_) / np.maximum(np.abs(Y), SMALL)))


def tamed(change: Array, last: Array) -> Array:
    """Return a change, half of it where it all but takes the last one back: from side to side of a steep flow."""
    swings = (change * last < 0.0) & (np.abs(change) > SWING * np.abs(last))
    return np.where(swings, 0.5 * change, change)


def stepped(pitch: Pitch, Y: Array, change: Array) -> Array:
    """Return states changed by no more than `LONGEST` of themselves, those that may have either sign as asked."""
    c = pitch.machinery.composition
    signed = np.tile(np.isin(np.arange(pitch.n), c.signed), c.chambers)
    most = np.where(signed, np.inf, LONGEST * np.maximum(np.abs(Y), 0.0))
    return Y + np.clip(change, -most, most)
