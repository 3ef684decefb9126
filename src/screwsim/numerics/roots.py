"""A zero between two places, as scipy's brentq finds it, to the bit.

Here, since scipy.optimize takes longer to import than the zeros of a run to find.

Source: R. P. Brent, Algorithms for Minimization without Derivatives, Prentice-Hall 1973, ch. 4, with hyperbolic
extrapolation in place of the inverse quadratic one (J. C. P. Bus, T. J. Dekker, ACM Trans. Math. Softw. 1 (1975)).
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from math import copysign, inf

RTOL = 8.881784197001252e-16  # four times the rounding of a float
MOST = 100  # steps


def brentq(f: Callable[[float], float], low: float, high: float, xtol: float = 2e-12, rtol: float = RTOL) -> float:
    """Return where a function passes zero, within xtol + rtol |x|; raise ValueError where both ends have one sign."""
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
            with suppress(ZeroDivisionError):  # places or values that rounding makes equal
                tried = _tried((x_before, x, x_across), (f_before, f_x, f_across))
        if 2.0 * abs(tried) < min(abs(step_before), 3.0 * abs(half) - delta):
            step_before, step = step, tried
        else:
            step_before = step = half
        x_before, f_before = x, f_x
        x += step if abs(step) > delta else copysign(delta, half)
        f_x = f(x)
    raise RuntimeError(f"no zero found in {MOST} steps, last tried at {x}")


def _tried(x: tuple[float, float, float], f: tuple[float, float, float]) -> float:
    """Return the step to where a line, or a hyperbola, through the last places passes zero."""
    (x_before, x_now, x_across), (f_before, f_now, f_across) = x, f
    if x_before == x_across:
        return -f_now * (x_now - x_before) / (f_now - f_before)
    by_before = (f_before - f_now) / (x_before - x_now)
    by_across = (f_across - f_now) / (x_across - x_now)
    above = -f_now * (f_across * by_across - f_before * by_before)
    return above / (by_across * by_before * (f_across - f_before))
