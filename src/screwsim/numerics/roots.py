"""A zero between two places, as found by scipy's brentq to the bit; and many zeros at once, with vectorised calls.

It is here because scipy.optimize takes longer to import than the zeros of a run take to find.

Source: R. P. Brent, Algorithms for Minimization without Derivatives, Prentice-Hall 1973, ch. 4, with hyperbolic
extrapolation in place of the inverse quadratic one (J. C. P. Bus, T. J. Dekker, ACM Trans. Math. Softw. 1 (1975)); many
at once: T. R. Chandrupatla, Adv. Eng. Softw. 28 (1997) 145-149.
"""

from collections.abc import Callable
from contextlib import suppress
from math import copysign, inf

import numpy as np

RTOL = 8.881784197001252e-16  # four times the rounding unit of a float
MOST = 100  # most steps


def brentq(f: Callable[[float], float], low: float, high: float, xtol: float = 2e-12, rtol: float = RTOL) -> float:
    """Return a zero of a function within xtol + rtol |x|; raise ValueError where both ends have the same sign."""
    x_before, x = float(low), float(high)
    f_before, f_x = f(x_before), f(x)
    if f_before == 0.0:
        return x_before
    if f_x == 0.0:
        return x
    if copysign(1.0, f_before) == copysign(1.0, f_x):
        raise ValueError("f(a) and f(b) must have different signs")
    x_across = f_across = step_before = step = 0.0
    for _ in range(MOST):
        if f_before != 0.0 and f_x != 0.0 and copysign(1.0, f_before) != copysign(1.0, f_x):
            x_across, f_across = x_before, f_before
            step_before = step = x - x_before
        if abs(f_across) < abs(f_x):
            x_before, x, x_across = x, x_across, x
            f_before, f_x, f_across = f_x, f_across, f_x
        delta = (xtol + rtol * abs(x)) / 2.0
        half = (x_across - x) / 2.0
        if f_x == 0.0 or abs(half) < delta:
            return x
        tried = inf
        if abs(step_before) > delta and abs(f_x) < abs(f_before):
            with suppress(ZeroDivisionError):  # places or values may be equal by rounding
                tried = _interpolated_step((x_before, x, x_across), (f_before, f_x, f_across))
        if 2.0 * abs(tried) < min(abs(step_before), 3.0 * abs(half) - delta):
            step_before, step = step, tried
        else:
            step_before = step = half
        x_before, f_before = x, f_x
        x += step if abs(step) > delta else copysign(delta, half)
        f_x = f(x)
    raise RuntimeError(f"no zero found in {MOST} steps, last tried at {x}")


def bisected(
    below: Callable[[float], bool], low: float, high: float, rtol: float = 0.0, xtol: float = 0.0
) -> tuple[float, float]:
    """Return an interval halved to xtol or rtol |high|, at most sixty times; `below` holds up to some place alone."""
    for _ in range(60):
        if abs(high - low) <= max(xtol, rtol * abs(high)):
            break
        middle = 0.5 * (low + high)
        low, high = (middle, high) if below(middle) else (low, middle)
    return low, high


def _interpolated_step(x: tuple[float, float, float], f: tuple[float, float, float]) -> float:
    """Return the step to the zero of the line, or the hyperbola, through the last places."""
    (x_before, x_now, x_across), (f_before, f_now, f_across) = x, f
    if x_before == x_across:
        return -f_now * (x_now - x_before) / (f_now - f_before)
    by_before = (f_before - f_now) / (x_before - x_now)
    by_across = (f_across - f_now) / (x_across - x_now)
    above = -f_now * (f_across * by_across - f_before * by_before)
    return above / (by_across * by_before * (f_across - f_before))


def bracketed(
    f: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray, share: float, least: np.ndarray
) -> np.ndarray:
    """Return zeros of functions between places, NaN where there is no change of sign; `f` evaluates all at once.

    Each is found within a share of the interval's length, or to where its function is smaller than `least`.
    """
    x, other, third = np.array(low, float), np.array(high, float), np.array(high, float)
    f_x, f_other = f(x), f(other)
    f_third, none, within = f_other.copy(), f_x * f_other > 0.0, share * (other - x)
    along = np.full(len(x), 0.5)
    for _ in range(MOST):
        open_ = (np.abs(other - x) > within) & (np.minimum(np.abs(f_x), np.abs(f_other)) > least) & ~none
        if not open_.any():
            break
        tried = np.where(open_, x + along * (other - x), x)
        f_tried = f(tried)
        same = np.signbit(f_tried) == np.signbit(f_x)
        third, f_third = _where(open_, (same, x, other), third), _where(open_, (same, f_x, f_other), f_third)
        other, f_other = _where(open_, (same, other, x), other), _where(open_, (same, f_other, f_x), f_other)
        x, f_x = np.where(open_, tried, x), np.where(open_, f_tried, f_x)
        along = _share_of((x, other, third), (f_x, f_other, f_third))
        shortest = np.minimum(0.5, 0.5 * within / np.maximum(np.abs(other - x), 1e-300))
        along = np.minimum(np.maximum(along, shortest), 1.0 - shortest)
    return np.where(none, np.nan, np.where(np.abs(f_x) <= np.abs(f_other), x, other))


def _where(open_: np.ndarray, of: tuple[np.ndarray, np.ndarray, np.ndarray], old: np.ndarray) -> np.ndarray:
    """Return the first of two where `same` holds, else the second; the old value where a search is finished."""
    same, first, second = of
    return np.where(open_, np.where(same, first, second), old)


def _share_of(x: tuple[np.ndarray, ...], f: tuple[np.ndarray, ...]) -> np.ndarray:
    """Return the fraction of the way from the first place to the second: inverse quadratic interpolation, or a half."""
    (x1, x2, x3), (f1, f2, f3) = x, f
    with np.errstate(all="ignore"):
        xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2)
        along = f1 / (f2 - f1) * f3 / (f2 - f3) + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        good = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi) & np.isfinite(along)
    return np.where(good, along, 0.5)
