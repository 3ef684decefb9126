"""The vertex of the parabola through three values: where it lies, and how high."""

from typing import Any

import numpy as np


def vertex(before: Any, middle: Any, after: Any) -> np.ndarray:
    """Return where the vertices of parabolas through evenly spaced values lie, in steps from the middle ones.

    It is 0 where these do not bend.
    """
    bend = np.asarray(before - 2.0 * middle + after)
    return np.divide(before - after, 2.0 * bend, out=np.zeros(bend.shape), where=bend != 0.0)


def top(before: float, middle: float, after: float) -> float:
    """Return the value at the vertex, of evenly spaced values; the middle one where these do not bend."""
    return float(middle - 0.25 * (before - after) * vertex(before, middle, after))


def summit(x: Any, y: Any) -> tuple[float, float]:
    """Return place and height of the top of the parabola through three points; the middle one where it has no top."""
    before, after = x[1] - x[0], x[2] - x[1]
    left, right = (y[1] - y[0]) / before, (y[2] - y[1]) / after
    bend, slope = (right - left) / (before + after), (left * after + right * before) / (before + after)
    off = -0.5 * slope / bend if bend < 0.0 else 0.0
    return float(x[1] + off), float(y[1] + 0.5 * slope * off)
