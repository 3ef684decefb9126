"""Bounded least squares: Gauss-Newton steps in a box-shaped trust region, with Broyden updates between Jacobians.

A step solves the linearised problem within the bounds and the box (bounded-variable least squares). Broyden's update
lets the Jacobian follow every step; it is computed anew where a step with an updated one does not reduce the sum of
squares and, where that is wanted, at the end. The search ends where a step promises less than a thousandth of the
change due to one standard error.

Sources: J. Nocedal, S. J. Wright, Numerical Optimization, 2nd ed., Springer 2006, 4.1 and 10.3; P. B. Stark, R. L.
Parker, Computational Statistics 10 (1995) 129; of the update, `numerics.broyden`.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from screwsim.numerics import broyden

Array = NDArray[np.float64]
INITIAL_TRUST_REGION = 0.3  # of the bounds' distance: half size of the first box
LEAST_GAIN = 1e-3  # of chi squared per residual, at least of 1: a smaller promised gain ends the search
SHORTEST_STEP = 1e-5  # of the bounds' distance: shortest step
SHORTEST_SECANT = 3e-3  # of the bounds' distance: a shorter secant shows the solver's noise more than the slope
RESIDUAL_JUMP = 5e3  # uncertainties: a larger change means that a figure has lost or gained its solution
POOR, GOOD = 0.25, 0.75  # of the promised gain: below and above it the box shrinks or grows


def least_squares(
    residuals: Callable[[Array], Array],
    jacobian: Callable[[Array], Array],
    places: Array,
    most: int,
    *,
    confirmed: bool,
) -> tuple[Array, bool]:
    """Return the places within 0 … 1 of the least sum of squares, and whether it was reached in at most `most` steps.

    With `confirmed` the search ends with a Jacobian computed at its end.
    """
    here = residuals(places)
    slopes, fresh, box = jacobian(places), True, INITIAL_TRUST_REGION
    for _ in range(most):
        cost = float(here @ here)
        step = _step(slopes, here, np.maximum(-places, -box), np.minimum(1.0 - places, box))
        promised = cost - float(np.sum((here + slopes @ step) ** 2))
        length = float(np.max(np.abs(step)))
        if length < SHORTEST_STEP or promised < LEAST_GAIN * max(1.0, cost / len(here)):
            if fresh or not confirmed:
                return places, True
            slopes, fresh = jacobian(places), True
            continue
        there = residuals(places + step)
        gained, was_fresh = cost - float(there @ there), fresh
        if length > SHORTEST_SECANT:
            slopes, fresh = broyden.updated(slopes, _followed(slopes, step, there - here), step), False
        if gained < POOR * promised:
            box = 0.5 * length
        elif gained > GOOD * promised and length > 0.9 * box:
            box *= 2.0
        if gained > 0.0:
            places, here, fresh = places + step, there, False
        elif not was_fresh:
            slopes, fresh = jacobian(places), True
    return places, False


def _step(slopes: Array, here: Array, low: Array, high: Array) -> Array:
    """Return the step between two ends that minimises the linearised residuals."""
    from scipy.optimize import lsq_linear

    room = np.maximum(high - low, 1e-12)
    found = lsq_linear(slopes, -here, (low, low + room), method="bvls")
    return np.clip(found.x, low, high)


def _followed(slopes: Array, step: Array, change: Array) -> Array:
    """Return the change of the residuals; of one that jumps, as to a failure, what its slopes say, which then stay."""
    return np.where(np.abs(change) > RESIDUAL_JUMP, slopes @ step, change)
