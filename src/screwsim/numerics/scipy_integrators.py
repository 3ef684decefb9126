"""scipy's integrators over breakpoints, an independent check of our own: Radau, BDF, LSODA; RK45, DOP853 for studies.

Each segment between breakpoints is integrated by itself. Tolerances are relative to the state; quadratures are states
here, with an absolute tolerance from their scale.
"""

import warnings
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

from screwsim.numerics.integrators import Check

Array = np.ndarray


class Path:
    """An integrated path: times, dense[step] = (y0, y1, c3, c4) as stored by `rodas.keep`, counts, a message."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.dense: list[Array] = []
        self.calls = 0
        self.jacobians = 0
        self.message = ""

    def add(self, t: Array, y: Array, slopes: Array) -> None:
        """Append accepted steps, with Hermite cubics as dense output."""
        if not self.times:
            self.times.append(float(t[0]))
        for i in range(len(t) - 1):
            h = t[i + 1] - t[i]
            rise = y[i + 1] - y[i]
            c3 = h * slopes[i] - rise
            self.dense.append(np.array([y[i], y[i + 1], c3, rise - h * slopes[i + 1] - c3]))
            self.times.append(float(t[i + 1]))


Slopes = Callable[[float, float, Array], Array]


class Events(Protocol):
    """Events of the state within a segment: scipy's terminal events, and the changes of state that they cause.

    `least` holds for each state the size to which its error is relative where the state is smaller; a state that may be
    zero needs one.
    """

    least: Array

    def watched(self, t: float, y: Array) -> list[Callable[[float, Array], float]]: ...
    def passed(self, which: int, y: Array) -> bool: ...


def integrate(
    rates: Slopes,
    jacobian: Slopes,
    breakpoints: Array,
    y: Array,
    q_scale: Array,
    rtol: float,
    check: Check,
    events: Events | None = None,
) -> tuple[Array, Array, Path]:
    """Integrate y and the quadratures (appended to it in `rates`) over the breakpoints; return y, q and the path.

    `rates(t, middle, y)` returns the derivatives of both in one vector, `jacobian` their derivatives by y. The Jacobian
    is supplied because scipy's own differences overflow for quadratures, on which nothing depends. `path.message` is
    empty where the end was reached.
    """
    from scipy.integrate import solve_ivp

    n = len(y)
    z = np.concatenate([y, np.zeros(len(q_scale))])
    path, method = Path(), _method(check.method)
    for start, end in pairwise(breakpoints):
        middle = 0.5 * (start + end)
        of_states = 1e-3 * rtol * np.abs(z[:n])
        if events is not None:
            of_states = np.maximum(of_states, rtol * events.least)
        atol = np.concatenate([of_states, rtol * np.maximum(q_scale, 1e-300)])

        def slopes_at(t: float, state: Array, middle: float = middle) -> Array:
            return rates(t, middle, state[:n])

        def derivatives_at(t: float, state: Array, middle: float = middle) -> Array:
            full = np.zeros((len(state), len(state)))
            full[:, :n] = jacobian(t, middle, state[:n])
            return full

        extra: dict[str, Any] = {"jac": derivatives_at} if check.implicit else {}
        at, going = start, True
        while going and at < end:
            if events is not None:
                extra["events"] = events.watched(at, z[:n])
            found = solve_ivp(slopes_at, (at, end), z, method, rtol=rtol, atol=atol, **extra)
            path.calls += found.nfev
            path.jacobians += found.njev
            slopes = np.array([slopes_at(t, state) for t, state in zip(found.t, found.y.T, strict=True)])
            path.add(found.t, found.y.T[:, :n], slopes[:, :n])
            z, at = found.y[:, -1], found.t[-1]
            if found.status < 0 or not np.all(np.isfinite(z)):
                path.message = str(found.message)
                break
            if events is not None and found.status == 1:
                which = next(i for i, times in enumerate(found.t_events) if len(times) > 0)
                z = z.copy()
                going = events.passed(which, z[:n])
                path.message = "" if going else "too many events"
        if path.message:
            break
    return z[:n], z[n:], path


@cache
def _method(method: Any) -> Any:
    """Return the method for `solve_ivp`, by name or class; scipy's own implicit ones are made to call LAPACK directly.

    scipy's wrappers inspect each matrix and right-hand side again and again, which takes several times as long.
    """
    from scipy.integrate import BDF, Radau

    scipys: Any = {"Radau": Radau, "BDF": BDF}.get(method)
    if scipys is None:
        return method

    def __init__(self: Any, *arguments: Any, **options: Any) -> None:
        scipys.__init__(self, *arguments, **options)

        def factored(A: Array) -> tuple[Array, Array]:
            self.nlu += 1
            return _factored(A)

        self.lu, self.solve_lu = factored, _solved

    return type(method, (scipys,), {"__init__": __init__})


def _factored(A: Array) -> tuple[Array, Array]:
    from scipy.linalg import LinAlgWarning, lapack

    factor: Any = getattr(lapack, "zgetrf" if A.dtype.kind == "c" else "dgetrf")
    if not np.isfinite(A).all():
        raise ValueError("derivatives are not finite")
    lu, pivots, info = factor(A, overwrite_a=True)
    if info > 0:
        warnings.warn("the equations of a step are singular", LinAlgWarning, stacklevel=2)  # as scipy does
    return lu, pivots


def _solved(factors: tuple[Array, Array], b: Array) -> Array:
    from scipy.linalg import lapack

    if not np.isfinite(b).all():
        raise ValueError("slopes are not finite")
    lu, pivots = factors
    solve: Any = getattr(lapack, "zgetrs" if lu.dtype.kind == "c" else "dgetrs")
    return solve(lu, pivots, b, overwrite_b=True)[0]
