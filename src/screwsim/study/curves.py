"""Shape of efficiency curves over the oil ratio: optimum, curvature, drop to both sides."""

from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Optimum:
    """Maximum of η over ln d: its place, height and sharpness.

    `curvature` is −d²η/d(ln d)²/η there; `drop` the mean relative loss at a third and at three times the optimal d
    (None where the curve does not reach that far). `interior` is False when the maximum lies at an end.
    """

    ratio: float
    efficiency: float
    curvature: float
    drop: float | None
    interior: bool


def curve_optimum(ratio: Array, efficiency: Array) -> Optimum | None:
    """Return the optimum of one curve, from a parabola in ln d through the points within a factor 1.6 of the best.

    Points that are not finite are left out; None when fewer than five remain.
    """
    x, eta = _over_logarithm(ratio, efficiency)
    if len(x) < 5:
        return None
    best = int(np.argmax(eta))
    if best in (0, len(x) - 1):
        return Optimum(float(np.exp(x[best])), float(eta[best]), 0.0, None, False)
    near = np.abs(x - x[best]) <= np.log(1.6)
    near[best - 1 : best + 2] = True
    a, b, c = np.polyfit(x[near] - x[best], eta[near], 2)
    if a >= 0.0:
        return Optimum(float(np.exp(x[best])), float(eta[best]), 0.0, None, True)
    shift = float(np.clip(-b / (2.0 * a), x[best - 1] - x[best], x[best + 1] - x[best]))
    top = float(a * shift**2 + b * shift + c)
    at = x[best] + shift
    sides = [float(np.interp(at + s, x, eta)) for s in (-np.log(3.0), np.log(3.0)) if x[0] <= at + s <= x[-1]]
    drop = float(np.mean([1.0 - side / top for side in sides])) if len(sides) == 2 else None
    return Optimum(float(np.exp(at)), top, float(-2.0 * a / top), drop, True)


def value_at(ratio: Array, efficiency: Array, d: float) -> float | None:
    """Return η at the oil ratio d, linear in ln d; None outside the curve or without values there."""
    x, eta = _over_logarithm(ratio, efficiency)
    if len(x) < 2 or not x[0] - 1e-9 <= np.log(d) <= x[-1] + 1e-9:
        return None
    return float(np.interp(np.log(d), x, eta))


def _over_logarithm(ratio: Array, efficiency: Array) -> tuple[Array, Array]:
    """Return the finite points of a curve as ascending ln d, and η."""
    good = np.isfinite(efficiency) & (ratio > 0.0)
    order = np.argsort(ratio[good])
    return np.log(ratio[good])[order], efficiency[good][order]
