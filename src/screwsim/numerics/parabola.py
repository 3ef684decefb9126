"""The vertex of the parabola through three evenly spaced values: where it lies, and how high."""

from typing import Any

import numpy as np


def vertex(before: Any, middle: Any, after: Any) -> np.ndarray:
    """Return where the vertices of parabolas lie, in steps from the middle values; 0 where these do not bend."""
    bend = np.asarray(before - 2.0 * middle + after)
    return np.divide(before - after, 2.0 * bend, out=np.zeros(bend.shape), where=bend != 0.0)


def top(before: float, middle: float, after: float) -> float:
    """Return the value at the vertex of the parabola; the middle value where these do not bend."""
    return float(middle - 0.25 * (before - after) * vertex(before, middle, after))
