"""Measured points made fair: the curve with the fewest and smallest jumps of curvature within a tolerance of them.

Profiles consist of pieces whose curvature jumps where they meet, so a smoothing spline overshoots there and makes loops
in the conjugate rotor. Here points move along the normal by d, so as to minimise

    Σ d²  +  λ Σ (|Δκ|/(1 + r1 |κ|))^½ ,

κ: curvature at a point, Δκ: its jump to the next, r1: pitch radius of the male rotor; λ: the largest for which no point
moves by more than the tolerance. Source: ours; that a sum of |Δκ| keeps the jumps is total-variation denoising (Rudin,
Osher & Fatemi 1992); the power ½, which shrinks a tip's curvature less, and the solution by weighted least squares are
those of Chartrand & Yin (2008). Lengths: m.
"""

import math
from dataclasses import dataclass

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.rotors.pair import Array, tangents

APART = 7.0  # distance of points over the tolerance below which they say nothing about the tangent
PASSES, SWEEPS, HALVINGS = 3, 12, 16
LOG_RANGE = -16.0, 0.0  # range of log10 λ, with lengths over r1
JUMP = 3e-3  # jump of curvature, times the pitch radius, below which it counts as none


@dataclass(frozen=True)
class FairedCurve:
    """A faired curve [m], and its largest and RMS distance [m] from the points that it was made of."""

    x: Array
    y: Array
    farthest: float
    rms: float

    def words(self, points: int) -> str:
        """Return in words how the curve lies to a number of points."""
        away = f"{self.farthest * 1e6:.2g} um at most, {self.rms * 1e6:.2g} um RMS"
        return f"{len(self.x)} of {points} points; the faired curve misses them by {away}"


def faired_curve(x: Array, y: Array, tolerance: float, pitch_radius: float) -> FairedCurve:
    """Return the fairest curve within a tolerance [m] of points in order along a lobe.

    Points closer together than seven tolerances are thinned first.
    """
    kept = _apart(x, y, APART * tolerance)
    if len(kept) < 20:
        raise UsageError(
            f"machine.profile.tolerance: only {len(kept)} points lie {APART * tolerance * 1e3:.3g} mm apart "
            f"({APART:g} tolerances), 20 are needed (choose a smaller tolerance)"
        )
    px, py = x[kept] / pitch_radius, y[kept] / pitch_radius
    low, high = LOG_RANGE
    best = px, py
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        curve = _least(px, py, 10.0**middle)
        if np.hypot(curve[0] - px, curve[1] - py).max() * pitch_radius <= tolerance:
            low, best = middle, curve
        else:
            high = middle
    moved = np.hypot(best[0] - px, best[1] - py) * pitch_radius
    return FairedCurve(
        best[0] * pitch_radius, best[1] * pitch_radius, float(moved.max()), float(np.sqrt(np.mean(moved**2)))
    )


def _apart(x: Array, y: Array, least: float) -> list[int]:
    """Return indices of points, including the first and the last, that are at least a distance apart."""
    kept = [0]
    for i in range(1, len(x) - 1):
        if math.hypot(x[i] - x[kept[-1]], y[i] - y[kept[-1]]) >= least:
            kept.append(i)
    if len(kept) > 1 and math.hypot(x[-1] - x[kept[-1]], y[-1] - y[kept[-1]]) < least:
        kept.pop()
    return [*kept, len(x) - 1]


def _least(px: Array, py: Array, weight: float) -> tuple[Array, Array]:
    """Return the minimising curve for one λ: linear in d about the last curve, reweighted in each sweep."""
    x, y = px.copy(), py.copy()
    for _ in range(PASSES):
        step, chord = np.hypot(np.diff(x), np.diff(y)), np.unwrap(np.arctan2(np.diff(y), np.diff(x)))
        angle, curvature = tangents(step, chord), np.diff(chord) / (0.5 * (step[1:] + step[:-1]))
        nx, ny = -np.sin(angle), np.cos(angle)
        away = (px - x) * nx + (py - y) * ny  # distance of the measured points from the present curve
        bands, jumps = _jumps(step, curvature), np.diff(curvature)
        at_points = jumps + _times(bands, away)
        size = np.abs(np.concatenate([curvature[:1], curvature, curvature[-1:]]))
        size = (size[:-2] + size[1:-1] + size[2:]) / 3.0
        scale = 1.0 / (1.0 + 0.5 * (size[:-1] + size[1:]))
        d = -away
        for _ in range(SWEEPS):
            jump = scale * (at_points + _times(bands, d))
            strength = weight * scale**2 * (jump**2 + JUMP**2) ** -0.75
            d = _solved(bands, at_points, strength)
        x, y = x + (away + d) * nx, y + (away + d) * ny
    return x, y


def _jumps(step: Array, curvature: Array) -> Array:
    """Return how the jumps of curvature respond to normal moves of four points in a row: κ grows by d'' + κ² d."""
    before = 2.0 / (step[:-1] * (step[:-1] + step[1:]))
    after = 2.0 / (step[1:] * (step[:-1] + step[1:]))
    own = curvature**2 - before - after
    return np.stack([-before[:-1], before[1:] - own[:-1], own[1:] - after[:-1], after[1:]])


def _times(bands: Array, d: Array) -> Array:
    """Return the product of the bands with values at the points."""
    count = bands.shape[1]
    return sum((bands[i] * d[i : i + count] for i in range(4)), np.zeros(count))


def _solved(bands: Array, jumps: Array, strength: Array) -> Array:
    """Return the moves that minimise Σ d² + Σ strength (jump + bands d)², by a banded Cholesky factorisation."""
    from scipy.linalg import solveh_banded  # here: closed forms need none of it

    count = bands.shape[1]
    matrix, right = np.zeros((4, count + 3)), np.zeros(count + 3)
    matrix[3] = 1.0
    for i in range(4):
        right[i : i + count] -= strength * bands[i] * jumps
        for j in range(i, 4):
            matrix[3 + i - j, j : j + count] += strength * bands[i] * bands[j]
    return np.asarray(solveh_banded(matrix, right))
