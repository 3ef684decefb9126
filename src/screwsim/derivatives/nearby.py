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
            blocks = _blocks(pitch, Y)
        before = size
        last = tamed(_followed(blocks, -open_, pitch.n), last)
        Y = stepped(pitch, Y, last)
    return None


def _blocks(pitch: Pitch, Y: Array) -> list[Blocks]:
    """Return the stage equations of each chamber by itself, factored."""
    n, J, widths = pitch.n, pitch.slopes(Y).by_states, pitch.slices.widths
    every = (slice(i, i + n) for i in range(0, pitch.N, n))
    return [Blocks(np.ascontiguousarray(J[..., own, own]), widths, n, 0) for own in every]


def _followed(blocks: list[Blocks], right: Array, n: int) -> Array:
    """Return the changes at the nodes that right sides make, chamber by chamber."""
    parts = np.ascontiguousarray(right.reshape(*right.shape[:2], -1, n, 1).transpose(2, 0, 1, 3, 4))
    found = [each.follow(np.zeros((n, 1)), part) for each, part in zip(blocks, parts, strict=True)]
    return np.concatenate(found, axis=2)[..., 0]


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
