"""Several goals by as many paths: damped Newton steps; the Jacobian from differences, updated by Broyden's rule."""

import numpy as np
from numpy.typing import NDArray

from screwsim.numerics import broyden
from screwsim.study.seek.trials import Trial, Trials

Array = NDArray[np.float64]

DIFFERENCE_STEP = 0.01  # of the ranges: difference for the Jacobian
LONGEST_STEP = 0.35  # of a range: longest Newton step
MOST_STEPS = 60  # Newton steps from one start
MOST_HALVINGS = 4  # halvings of a step before the Jacobian is computed anew
SHORTEST_STEP = 1e-9  # step below which nothing is gained
START_FRACTIONS = ((), (0.5,), (0.25,), (0.75,))  # the scene's own place, then these fractions of all ranges


def solve(trials: Trials) -> Trial | None:
    """Return the solution that meets all goals; None where no start leads to one."""
    for place in START_FRACTIONS:
        start = tuple(place[0] if place else span.first for span in trials.spans)
        found = _newton_from(trials, trials.at(*start)) if trials.at(*start).closed else None
        if found is not None and trials.met(found):
            return found
    return None


def jacobian(trials: Trials, at: Trial) -> Array | None:
    """Return the derivatives of the figures, over their sizes, by the places; None where both sides of a place fail."""
    columns = []
    for number, place in enumerate(at.places):
        for step in sorted((DIFFERENCE_STEP, -DIFFERENCE_STEP), key=lambda step, place=place: abs(place + step - 0.5)):
            moved = trials.at(*(each + step * (i == number) for i, each in enumerate(at.places)))
            if moved.closed:
                columns.append((_scaled(trials, moved) - _scaled(trials, at)) / (moved.places[number] - place))
                break
        else:
            return None
    return np.column_stack(columns)


def _scaled(trials: Trials, trial: Trial) -> Array:
    return np.array(trial.off, float) / np.array(trials.sizes)


def _newton_from(trials: Trials, here: Trial) -> Trial:
    """Return where damped steps from a solution lead."""
    slopes, fresh = jacobian(trials, here), True
    for _ in range(MOST_STEPS):
        if trials.met(here) or slopes is None:
            return here
        step = _newton_step(slopes, here.places, _scaled(trials, here))
        new = _damped_step(trials, here, step, slopes)
        if new is not None:
            slopes, here, fresh = _learnt(trials, slopes, here, new), new, False
            continue
        if fresh:
            return here  # even Newton's own direction gains nothing: the nearest within the ranges
        slopes, fresh = jacobian(trials, here), True
    return here


def _newton_step(slopes: Array, places: tuple[float, ...], off: Array) -> Array:
    """Return the step that minimises the linear model within the ranges, no longer than `LONGEST_STEP`."""
    from scipy.optimize import lsq_linear

    low = np.maximum(-np.array(places), -LONGEST_STEP)
    high = np.minimum(1.0 - np.array(places), LONGEST_STEP)
    tiny = 1e-12  # lsq_linear needs distinct bounds
    return np.asarray(lsq_linear(slopes, -off, (low - tiny, high + tiny)).x, float)


def _damped_step(trials: Trials, here: Trial, step: Array, slopes: Array) -> Trial | None:
    """Return the first solution along a step, full, halved …, that is nearer to the goals; None where none is."""
    for number in range(MOST_HALVINGS):
        part = step * 0.5**number
        if np.max(np.abs(part)) < SHORTEST_STEP:
            return None
        new = trials.at(*(np.array(here.places) + part))
        if new.closed and trials.far(new) < (1.0 - 1e-4) * trials.far(here):
            return new
    return None


def _learnt(trials: Trials, slopes: Array, here: Trial, new: Trial) -> Array:
    """Return the Jacobian that reproduces the change along the last step."""
    step = np.array(new.places) - np.array(here.places)
    return broyden.updated(slopes, _scaled(trials, new) - _scaled(trials, here), step)
