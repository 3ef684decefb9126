"""Curves from tables: a shape-preserving C1 cubic (PCHIP, Fritsch & Carlson 1980, as in scipy), packed flat.

Where slopes are known the cubics are Hermite's through values and slopes, which may differ on both sides of a row.

A curve is packed into one array as [n, x_0 … x_{n-1}, c_0 … c_{4(n-1)-1}], where interval i has the polynomial c[4i] +
c[4i+1] s + c[4i+2] s² + c[4i+3] s³ in s = x − x_i. Outside the table the curve is constant.
"""

import math
from collections.abc import Sequence

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import read_sheet, sheet_or_usage_error
from screwsim.inputs.textfiles import once_per_file
from screwsim.numerics import pchip
from screwsim.numerics.kernel import kernel

Array = np.ndarray
LEAST = 1e-9  # area over the largest one below which it counts as zero
SEEN = 0.02  # change over the largest value below which a reversal of a curve is ignored
NARROW = math.radians(15.0)  # distance of two reversals of a curve below which a step could jump over them


@once_per_file
def read_curve(path: str, column: str) -> tuple[Array, Array]:
    """Return angle [rad] and the values of `column` from a CSV file with a header; angles must increase.

    Raises `UsageError` in one line: the file, its line and the remedy.
    """
    with sheet_or_usage_error("name an existing CSV file", path):
        rows = read_sheet(path).columns("angle_deg", column)
    angles, values = [], []
    for line, cells in rows:
        try:
            angle, value = map(float, cells)
        except ValueError:
            shown = ", ".join(f"{cell[:20]!r}" for cell in cells)
            raise UsageError(f"{path}: line {line}: {shown} are not two numbers (write e.g. 90, 0.004)") from None
        if not (math.isfinite(angle) and math.isfinite(value) and value >= 0.0):
            raise UsageError(f"{path}: line {line}: values must be finite and not negative")
        if angles and math.radians(angle) <= angles[-1]:
            raise UsageError(f"{path}: line {line}: angles must increase (sort the rows, remove repetitions)")
        angles.append(math.radians(angle))
        values.append(value)
    if len(angles) < 3:
        raise UsageError(f"{path}: has {len(angles)} rows; a curve needs at least 3")
    curve = np.array(angles), np.array(values)
    for each in curve:
        each.setflags(write=False)  # shared by many callers
    return curve


def negligible_areas(areas: Array) -> np.ndarray:
    """Return which areas are negligible beside the largest."""
    return np.asarray(areas) <= LEAST * np.max(areas)


def edges(angles: Array, areas: Array) -> tuple[float, ...]:
    """Return the rows [rad] at which a table of areas opens or has closed: zeros next to an open row."""
    none = negligible_areas(areas)
    beside = np.append(~none[1:], False) | np.append(False, ~none[:-1])
    return tuple(np.asarray(angles)[none & beside].tolist())


def features(angles: Array, areas: Array) -> tuple[float, ...]:
    """Return the rows [rad] over which no step may jump: `edges`, and maxima and minima close to another of these.

    A step over a bump whose inside it does not sample sees no error; a broad bump cannot be missed.
    """
    found = edges(angles, areas)
    turns = _turns(np.asarray(areas)) if found or np.ptp(areas) > 0.0 else []
    points = np.sort(np.append(found, [angles[i] for i in turns]))
    near = np.flatnonzero(np.diff(points) < NARROW)
    return tuple(sorted({*found, *points[near].tolist(), *points[near + 1].tolist()}))


def slope_oscillation(x: Array, y: Array) -> tuple[float, float]:
    """Return the largest back-and-forth jump of a table's slope between rows, over its largest slope, and where it is.

    At a corner of a curve the slope jumps only once, so the smaller of two successive opposite jumps counts.
    """
    slope = np.diff(y) / np.diff(x)
    jumps, steepest = np.diff(slope), float(np.abs(slope).max())
    if len(jumps) < 2 or steepest == 0.0:
        return 0.0, float(x[0])
    back = np.where(jumps[:-1] * jumps[1:] < 0.0, np.minimum(np.abs(jumps[:-1]), np.abs(jumps[1:])), 0.0)
    worst = int(back.argmax())
    return float(back[worst]) / steepest, float(x[worst + 1])


def _turns(areas: Array) -> list[int]:
    """Return the rows of maxima and minima after which areas change by more than `SEEN` of the largest."""
    least, found, top, bottom = SEEN * float(np.max(areas)), [], 0, 0
    rising = falling = False
    for i, area in enumerate(areas.tolist()):
        top, bottom = (i if area > areas[top] else top), (i if area < areas[bottom] else bottom)
        if not falling and area < areas[top] - least:
            found += [top] if rising else []
            rising, falling, bottom = False, True, i
        elif not rising and area > areas[bottom] + least:
            found += [bottom] if falling else []
            rising, falling, top = True, False, i
    return found


def pack_curve(x: Array, y: Array, slope: Array | None = None) -> Array:
    """Return the packed shape-preserving C1 spline through (x, y); with slopes, the Hermite cubics that have them.

    slope: derivatives at both ends of each interval, shape (n − 1, 2); at a kink a row has two different ones.
    """
    rows = pchip.coefficients(x, y) if slope is None else _hermite(x, y, slope)
    return np.concatenate([[float(len(x))], x, rows.ravel()])


def _hermite(x: Array, y: Array, slope: Array) -> Array:
    step, (first, last) = np.diff(x), slope.T
    secant = np.diff(y) / step
    square, cube = (3.0 * secant - 2.0 * first - last) / step, (first + last - 2.0 * secant) / step**2
    return np.column_stack([y[:-1], first, square, cube])


def differences(x: Array, y: Array, breakpoints: Sequence[float]) -> Array:
    """Return the derivatives at both ends of each interval, shape (n − 1, 2), of a curve smooth between breakpoints.

    Second-order differences, one-sided at the rows that lie on a breakpoint (within 1e-9).
    """
    step = np.diff(x)
    secant = np.diff(y) / step
    rate = np.diff(secant) / (step[:-1] + step[1:])  # half the second derivative at each inner row
    rate = np.concatenate([rate[:1], rate, rate[-1:]]) if len(rate) else np.zeros(2)
    border = _borders(x, breakpoints)
    lone = border[:-1] & border[1:]
    before, after = np.where(border[:-1], rate[1:], rate[:-1]), np.where(border[1:], rate[:-1], rate[1:])
    first, last = secant - step * before, secant + step * after
    return np.column_stack([np.where(lone, secant, first), np.where(lone, secant, last)])


def side_slopes(x: Array, y: Array, breakpoints: Sequence[float]) -> Array:
    """Return `differences`, limited so that the Hermite cubics are monotone wherever the rows are.

    Source: Fritsch & Carlson 1980. Except at breakpoints the slopes on both sides of a row are equal.
    """
    found, secant = differences(x, y, breakpoints), (np.diff(y) / np.diff(x))[:, None]
    found = np.where(found * secant > 0.0, np.sign(secant) * np.minimum(np.abs(found), 3.0 * np.abs(secant)), 0.0)
    left, right = found[:-1, 1], found[1:, 0]
    both = np.where(left * right > 0.0, np.sign(left) * np.minimum(np.abs(left), np.abs(right)), 0.0)
    smooth = ~_borders(x, breakpoints)[1:-1]
    found[:-1, 1], found[1:, 0] = np.where(smooth, both, left), np.where(smooth, both, right)
    return found


def _borders(x: Array, breakpoints: Sequence[float]) -> np.ndarray:
    """Return which rows lie on a breakpoint or at an end."""
    border = np.zeros(len(x), bool)
    border[[0, -1]] = True
    rows = np.searchsorted(x, np.asarray(breakpoints) - 1e-9)
    border[rows[rows < len(x)]] = True
    return border


@kernel
def table_interval(x, TAB, curve):
    """Return the interval of a packed curve that contains x (bisection)."""
    low = 0
    high = int(TAB[curve]) - 1
    while high - low > 1:
        middle = (low + high) // 2
        if TAB[curve + 1 + middle] <= x:
            low = middle
        else:
            high = middle
    return low


@kernel
def table_value(x, TAB, curve):
    """Return the value of the packed curve that begins at index `curve`; constant outside the table."""
    curve = int(curve)
    n = int(TAB[curve])
    x = min(max(x, TAB[curve + 1]), TAB[curve + n])
    i = table_interval(x, TAB, curve)
    s = x - TAB[curve + 1 + i]
    c = curve + 1 + n + 4 * i
    return TAB[c] + s * (TAB[c + 1] + s * (TAB[c + 2] + s * TAB[c + 3]))


@kernel
def table_slope(x, TAB, curve):
    """Return the derivative of the packed curve; zero outside the table."""
    curve = int(curve)
    n = int(TAB[curve])
    if x < TAB[curve + 1] or x > TAB[curve + n]:
        return 0.0
    i = table_interval(x, TAB, curve)
    s = x - TAB[curve + 1 + i]
    c = curve + 1 + n + 4 * i
    return TAB[c + 1] + s * (2.0 * TAB[c + 2] + s * 3.0 * TAB[c + 3])
