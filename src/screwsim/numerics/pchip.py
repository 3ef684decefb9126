"""The shape-preserving cubic of Fritsch and Butland, equal to scipy's PchipInterpolator to the bit.

It is here because scipy.interpolate takes longer to import than most of what a run reads from it.

Source: F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300–304; slopes at the ends by C. Moler,
Numerical Computing with MATLAB, SIAM 2004, ch. 3.6.
"""

from bisect import bisect_right

import numpy as np

Array = np.ndarray


def slopes(x: Array, y: Array) -> Array:
    """Return the derivative at each point: the harmonic mean of the neighbouring secants, 0 at a maximum or a minimum.

    Raise ValueError for points that do not form a curve.
    """
    if len(x) < 2 or len(x) != len(y) or not (np.all(np.isfinite(x)) and np.all(np.isfinite(y))):
        raise ValueError("a curve needs two points or more, all of them numbers")
    step = np.diff(x)
    if not np.all(step > 0.0):
        raise ValueError("points of a curve must increase")
    secant = np.diff(y) / step
    if len(x) == 2:
        return np.repeat(secant, 2)
    before, after = secant[:-1], secant[1:]
    turns = (np.sign(after) != np.sign(before)) | (after == 0.0) | (before == 0.0)
    w_1, w_2 = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
    found = np.zeros(len(x))
    with np.errstate(divide="ignore", invalid="ignore"):  # where it turns
        mean = (w_1 / before + w_2 / after) / (w_1 + w_2)
        found[1:-1] = np.where(turns, 0.0, 1.0 / mean)
    found[0] = _at_an_end(step[0], step[1], secant[0], secant[1])
    found[-1] = _at_an_end(step[-1], step[-2], secant[-1], secant[-2])
    return found


def _at_an_end(h_0: float, h_1: float, m_0: float, m_1: float) -> float:
    """Return the one-sided derivative from three points, limited to the shape of the end interval."""
    found = ((2.0 * h_0 + h_1) * m_0 - h_0 * m_1) / (h_0 + h_1)
    if np.sign(found) != np.sign(m_0):
        return 0.0
    if np.sign(m_0) != np.sign(m_1) and abs(found) > 3.0 * abs(m_0):
        return 3.0 * m_0
    return found


def coefficients(x: Array, y: Array) -> Array:
    """Return the coefficients of the powers of x − x_i, one row per interval, the constant first."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    slope, step = slopes(x, y), np.diff(x)
    secant = np.diff(y) / step
    bend = (slope[:-1] + slope[1:] - 2.0 * secant) / step
    return np.column_stack([y[:-1], slope[:-1], (secant - slope[:-1]) / step - bend, bend / step])


class Pchip:
    """The curve through points, evaluated at single places; beyond the ends the outer cubics are continued."""

    def __init__(self, x: Array, y: Array) -> None:
        self._x: list[float] = np.asarray(x, float).tolist()
        self._rows: list[list[float]] = coefficients(x, y).tolist()

    def __call__(self, at: float) -> float:
        """Return the value at a place."""
        i = min(max(bisect_right(self._x, at) - 1, 0), len(self._rows) - 1)
        c_0, c_1, c_2, c_3 = self._rows[i]
        z = at - self._x[i]
        return c_0 + c_1 * z + c_2 * (z * z) + c_3 * (z * z * z)
