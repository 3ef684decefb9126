"""How far the tolerances of inputs that are not fitted move the fitted parameters.

The best fit x satisfies Jᵀ r = 0. An input that is off by one standard uncertainty changes the residuals r by s, by its
own slopes at every point, and with them the parameters by −(JᵀJ)⁻¹ Jᵀ s. Linear; parameters at a bound stay there.

Source: JCGM 100:2008 (GUM), section 5.
"""

from collections.abc import Sequence
from functools import partial
from itertools import chain
from typing import NamedTuple

import numpy as np

from screwsim.study.calibration.fit import Fit
from screwsim.study.calibration.identifiability import active_bounds
from screwsim.study.calibration.machine import Group, PointShifts, groups_without, known_everywhere, point_shifts
from screwsim.study.calibration.residuals import Array, Residuals
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.workers import WORKER_DIED
from screwsim.study.uncertainty.spreads import groups_of


class InputShift(NamedTuple):
    """Correlated inputs that are not fitted, one or more, and the changes [SI] of the parameters by one standard
    uncertainty of theirs; zero for a parameter at a bound.
    """

    paths: Group
    changes: tuple[float, ...]


def other_inputs(fit: Fit) -> tuple[Group, ...]:
    """Return the groups of inputs with a tolerance that are neither fitted nor follow a parameter."""
    return groups_without(groups_of(fit.scene), fit.changes(fit.first_start()))


def input_shifts(
    fit: Fit, places: Array, slopes: Array, outcome: Residuals, values: dict[str, float], jobs: int | None
) -> tuple[tuple[InputShift, ...], dict[str, str]]:
    """Return the shifts of the best values by the tolerances of other inputs; those inputs left out, and why.

    `slopes` are those of all residuals over the places; points without a solution have no part.
    """
    groups = other_inputs(fit)
    if not groups:
        return (), {}
    every = parallel_map(
        partial(_shifts, fit, groups, outcome, values),
        len(fit.fitted),
        died=lambda number: PointShifts({}, dict.fromkeys(chain(*groups), WORKER_DIED)),
        jobs=jobs,
    )
    groups, left_out = known_everywhere(groups, every)
    if not groups:
        return (), left_out
    parts = (np.column_stack(each.of(groups)) for each in every)
    shifts = np.vstack([*parts, np.zeros((len(fit.held), len(groups)))])
    shifts[outcome.unsolved] = 0.0
    return tuple(map(InputShift, groups, _moved(fit, places, slopes, shifts))), left_out


def _shifts(
    fit: Fit, groups: Sequence[Group], outcome: Residuals, values: dict[str, float], number: int
) -> PointShifts:
    """Return how inputs shift the residuals of a point; not at all where it has no solution."""
    point = fit.fitted[number]
    found = outcome.results[point.name]
    if found.status != "ok":
        return PointShifts(dict.fromkeys(chain(*groups), np.zeros(len(point.measured))), {})
    return point_shifts(fit.at(point, values), point, groups, found)


def _moved(fit: Fit, places: Array, slopes: Array, shifts: Array) -> list[tuple[float, ...]]:
    """Return by group the changes [SI] of the parameters, from the changes of the residuals (n, groups)."""
    free = [index for index, bound in enumerate(active_bounds(places)) if not bound]
    moved = np.zeros((len(fit.parameters), shifts.shape[1]))
    if free:
        moved[free] = -np.linalg.lstsq(slopes[:, free], shifts, rcond=None)[0]
    scales = [each.slope(each.value(float(place))) for each, place in zip(fit.parameters, places, strict=True)]
    return [tuple(map(float, column)) for column in (moved * np.array(scales)[:, None]).T]


def errors_by_inputs(shifts: Sequence[InputShift], count: int) -> tuple[float, ...]:
    """Return the standard errors [SI] of so many parameters by all other inputs together."""
    changes = np.array([shift.changes for shift in shifts]).reshape(len(shifts), count)
    return tuple(map(float, np.sqrt(np.sum(changes**2, axis=0))))
