"""The highest pressure of a cycle as a smooth function of it: at its true place, not at the nearest sample.

The figure of a run is the highest of fifty samples on either side of the highest end of a step, or of a top elsewhere:
accurate enough for the pressure but not for its derivative, which by the envelope theorem is that at the maximum
itself.
"""

from typing import Any

import numpy as np

from screwsim.evaluate.evaluation import Evaluation
from screwsim.model.slots import P_INJECTION
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.rodas import dense_value

Array = np.ndarray
POINTS = 7  # of a step, for an interpolating polynomial
SAMPLES = 0.5 * (1.0 - np.cos(np.pi * (np.arange(POINTS) + 0.5) / POINTS))  # Chebyshev points, as shares of a step
THROUGH = np.linalg.inv(np.vander(SAMPLES))  # maps values to coefficients of that polynomial, highest power first
SEARCH_POINTS = 9  # points of a step, ends included, at which a higher top is looked for ...
ROUNDING = 1e-12  # ... if its end values and its bend allow one: relative error of that bound
REAL = 1e-9  # imaginary part up to which a root counts as real


def peak_pressure(of: Evaluation) -> float:
    """Return the highest pressure [Pa] from injection to the end of the figure's range, by states; NaN if none."""
    return peak(of.life, of.problem.parts.geometry)[0]


def peak_step(of: Evaluation) -> tuple[int, float] | None:
    """Return the step, and the share of it, of the highest pressure.

    None where it is at an end of the range or nowhere. The derivative of the maximum is that of the pressure at
    this share: the movement of the maximum does not matter.
    """
    life, (_, angle) = of.life, peak(of.life, of.problem.parts.geometry)
    if not np.isfinite(angle) or min(abs(angle - each) for each in _limits(of.life, of.problem.parts.geometry)) < REAL:
        return None
    i = int(np.clip(np.searchsorted(life.times[: life.steps + 1], angle) - 1, 0, life.steps - 1))
    low, high = float(life.times[i]), float(life.times[i + 1])
    return i, (angle - low) / (high - low)


def _limits(life: Trajectory, geometry: Any) -> tuple[float, float]:
    """Return the angles [rad] between which the highest pressure is sought."""
    limit = geometry.life if geometry.expands else geometry.widest_discharge()
    return float(life.composition.P[P_INJECTION]), float(limit)


def peak(life: Trajectory, geometry: Any) -> tuple[float, float]:
    """Return the highest pressure [Pa] and its angle [rad]; NaN if there is none."""
    first, limit = _limits(life, geometry)
    times = life.times[: life.steps + 1]
    steps = life.dense[: life.steps, :, len(life.composition.states)]
    inside = (times[1:] > first) & (times[1:] <= limit + 1e-9)
    if not inside.any():
        return float("nan"), float("nan")
    best = int(np.argmax(np.where(inside, steps[:, 1], -np.inf)))
    y0, y1, c3, c4 = steps.T
    possible = np.maximum(y0, y1) + 0.25 * (np.abs(c3) + np.abs(c4)) > (1.0 - ROUNDING) * steps[best, 1]
    reached = np.flatnonzero((times[1:] > first) & (times[:-1] < limit) & possible)
    starts, widths = times[reached], times[reached + 1] - times[reached]
    low, high = (np.clip((each - starts) / widths, 0.0, 1.0) for each in (first, limit))
    shares = np.linspace(low, high, SEARCH_POINTS)
    tops = dense_value(shares, *steps[reached].T).max(axis=0)  # a top within a step, or at an end of the range
    higher = reached[tops > steps[best, 1]]
    tried = sorted({best, min(best + 1, life.steps - 1), *higher.tolist()})
    return max(_highest(life, times, i, (first, limit)) for i in tried)


def _highest(life: Trajectory, times: Array, i: int, limits: tuple[float, float]) -> tuple[float, float]:
    """Return the highest pressure [Pa] of a step within limits [rad], and its angle."""
    low, high = float(times[i]), float(times[i + 1])
    of_step = THROUGH @ life.pressures_at(low + (high - low) * SAMPLES)
    from_, to = (min(1.0, max(0.0, (each - low) / (high - low))) for each in limits)
    found = np.roots(np.polyder(of_step))
    turns = [float(each.real) for each in found if abs(each.imag) < REAL and from_ < each.real < to]
    return max((float(np.polyval(of_step, each)), low + (high - low) * each) for each in (from_, to, *turns))
