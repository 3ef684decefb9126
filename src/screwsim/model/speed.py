"""A speed that varies over the lobe pitch, as the chambers see it (docs/model.md M217).

Quantities per time (flows and heat) have to be divided by the speed. Instead, areas and heat rates are multiplied by
the mean speed over the speed at the angle, so that nothing else in the model changes. P holds the square of the
relative speed as a curve; its slope is the torque, so it is smooth even in a creeping start.
"""

import math

import numpy as np

from screwsim.model.composition import Composition
from screwsim.numerics.kernel import kernel
from screwsim.numerics.spline import pack_curve

Array = np.ndarray
ROWS = 361  # of the curve over a pitch
TOO_LARGE = 0.98  # largest ripple, over twice the mean, with which a course of the speed is accepted


@kernel
def slowness(phi, pitch, curve, P):
    """Return the mean speed over the speed where a chamber is at phi [rad]; periodic with the pitch."""
    s = phi - pitch * math.floor(phi / pitch)
    rows = int(curve) + 1
    s = min(max(s, P[rows]), P[rows + ROWS - 1])
    i = min(int(s * (ROWS - 1) / pitch), ROWS - 2)  # rows are evenly spaced, up to rounding
    if P[rows + i] > s and i > 0:
        i -= 1
    elif P[rows + i + 1] <= s and i < ROWS - 2:
        i += 1
    s -= P[rows + i]
    c = rows + ROWS + 4 * i
    return 1.0 / math.sqrt(P[c] + s * (P[c + 1] + s * (P[c + 2] + s * P[c + 3])))


def flat_curve(pitch: float) -> Array:
    """Return the packed curve of a constant speed."""
    return curve_of(np.ones(ROWS), np.zeros(ROWS), pitch)


def curve_of(squares: Array, slopes: Array, pitch: float) -> Array:
    """Return the packed curve of the squared relative speed, from its values and slopes [1/rad] at `ROWS` angles.

    Slopes are limited so that no cubic between positive squares becomes negative.
    """
    most = 3.0 * (ROWS - 1) / pitch * squares
    both = np.column_stack([np.maximum(slopes, -most)[:-1], np.minimum(slopes, most)[1:]])
    return pack_curve(np.linspace(0.0, pitch, ROWS), squares, both)


def put(P: Array, at: int, curve: Array) -> None:
    """Store a packed curve in P."""
    P[at : at + len(curve)] = curve


def squares_at(P: Array, at: int) -> Array:
    """Return the squared relative speed at the first `ROWS` − 1 angles of the curve."""
    first = at + 1 + ROWS
    return P[first : first + 4 * (ROWS - 1) : 4].copy()


def curve_places(composition: Composition) -> slice:
    """Return where in P a composition has its curve; an empty slice where its speed is constant."""
    at = composition.speed_curve
    return slice(0, 0) if at is None else slice(at, at + 5 * ROWS - 3)


def curve_at(composition: Composition) -> Array:
    """Return a composition's curve; an empty array where its speed is constant."""
    return composition.P[curve_places(composition)].copy()


def restore_curve(composition: Composition, course: Array) -> None:
    """Store a curve, or a weighted sum of curves, unless its speed falls nearly to zero."""
    at = composition.speed_curve
    if at is not None and len(course) and squares_at(course, 0).min() > (1.0 - TOO_LARGE) ** 2:
        put(composition.P, at, course)
