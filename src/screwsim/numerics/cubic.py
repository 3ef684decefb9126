"""The cubic spline through points, with one cubic over the first two intervals and one over the last two (not a knot).

It equals scipy's CubicSpline to the bit where a processor fuses no operations; it is here because scipy.interpolate
takes longer to import than a run takes to solve.

Source: C. de Boor, A Practical Guide to Splines, Springer 2001, ch. IV.
"""

import numpy as np

Array = np.ndarray


def slopes(x: Array, y: Array) -> Array:
    """Return the derivatives at four or more points for which the spline's curvature is continuous."""
    step, d_first, d_last = np.diff(x), x[2] - x[0], x[-1] - x[-3]
    secant = np.diff(y) / step
    above, diagonal, below = np.empty(len(x) - 1), np.empty(len(x)), np.empty(len(x) - 1)
    right = np.empty(len(x))
    diagonal[1:-1], above[1:], below[:-1] = 2.0 * (step[:-1] + step[1:]), step[:-1], step[1:]
    right[1:-1] = 3.0 * (step[1:] * secant[:-1] + step[:-1] * secant[1:])
    diagonal[0], above[0], diagonal[-1], below[-1] = step[1], d_first, step[-2], d_last
    right[0] = ((step[0] + 2.0 * d_first) * step[1] * secant[0] + step[0] ** 2 * secant[1]) / d_first
    right[-1] = (step[-1] ** 2 * secant[-2] + (2.0 * d_last + step[-1]) * step[-2] * secant[-1]) / d_last
    return _tridiagonal(below.tolist(), diagonal.tolist(), above.tolist(), right.tolist())


def _tridiagonal(below: list[float], diagonal: list[float], above: list[float], right: list[float]) -> Array:
    """Return a tridiagonal system's solution, with row exchanges as in LAPACK's gtsv; the lists are overwritten."""
    n = len(diagonal)
    second = [0.0] * n  # second superdiagonal, filled where rows were exchanged
    for i in range(n - 1):
        if abs(diagonal[i]) >= abs(below[i]):
            factor = below[i] / diagonal[i]
            diagonal[i + 1] -= factor * above[i]
            right[i + 1] -= factor * right[i]
            continue
        factor, diagonal[i] = diagonal[i] / below[i], below[i]
        above[i], diagonal[i + 1] = diagonal[i + 1], above[i] - factor * diagonal[i + 1]
        if i < n - 2:
            second[i], above[i + 1] = above[i + 1], -factor * above[i + 1]
        right[i], right[i + 1] = right[i + 1], right[i] - factor * right[i + 1]
    right[-1] /= diagonal[-1]
    right[-2] = (right[-2] - above[-1] * right[-1]) / diagonal[-2]
    for i in range(n - 3, -1, -1):
        right[i] = (right[i] - above[i] * right[i + 1] - second[i] * right[i + 2]) / diagonal[i]
    return np.array(right)


def coefficients(x: Array, y: Array) -> Array:
    """Return the polynomials of the intervals from their left ends; rows in falling powers, beginning with the cube."""
    step, slope = np.diff(x), slopes(x, y)
    secant = np.diff(y) / step
    bend = (slope[:-1] + slope[1:] - 2.0 * secant) / step
    return np.array([bend / step, (secant - slope[:-1]) / step - bend, slope[:-1], y[:-1]])


def at_points(x: Array, rows: Array) -> Array:
    """Return the values at the points of piecewise polynomials, given by rows in falling powers."""
    return np.append(rows[-1], _at_the_end(rows[:, -1], x[-1] - x[-2]))


def slopes_at_points(x: Array, rows: Array) -> Array:
    """Return the derivatives at the points of piecewise polynomials, given by rows in falling powers."""
    return np.append(rows[-2], _at_the_end(rows[:, -1], x[-1] - x[-2], derived=True))


def integral(x: Array, rows: Array) -> Array:
    """Return the continuous integral of piecewise polynomials, 0 at the first point, as rows in falling powers."""
    found = np.append(rows / np.arange(float(len(rows)), 0.0, -1.0)[:, None], np.zeros((1, rows.shape[1])), axis=0)
    for i in range(1, rows.shape[1]):
        found[-1, i] = _at_the_end(found[:, i - 1], x[i] - x[i - 1])
    return found


def _at_the_end(falling: Array, s: float, derived: bool = False) -> float:
    """Return the value of a polynomial, or of its derivative, summed from the lowest power."""
    value, power = 0.0, 1.0
    for exponent, each in enumerate(falling[::-1].tolist()):
        if exponent or not derived:
            value += each * power * (exponent if derived else 1)
            power *= s
    return value
