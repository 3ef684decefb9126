"""By how much the sums of a flow between two chambers differ in a life: each chamber sums it with its own steps.

Where a neighbour takes many steps within one of a chamber, that step may lie across what the neighbour does meanwhile.
Source: ours; docs/explanation/errors.md.
"""

from typing import NamedTuple

import numpy as np

from screwsim.cycle.problem import Problem
from screwsim.model.trajectory import Trajectory

Array = np.ndarray
MANY = 4  # steps of a neighbour that end within a step, from which on their sums are compared
EQUAL = 1e-9  # rad, within which angles are the same


class MetTwice(NamedTuple):
    """Steps in which the two chambers at a gap sum different flows: index of the step, column of sums, difference.

    Even columns are with a chamber ahead, odd ones with one behind, pair by pair of the offsets. `differ` [kg] is what
    the step sums into its chamber less what the neighbour sums, with its many steps. A step may stand there several
    times, for several columns.
    """

    step: Array
    column: Array
    differ: Array


def sums_met_twice(problem: Problem, life: Trajectory) -> MetTwice:
    """Return the sums that differ in steps of a life before the discharge port opens; it must have sums of its own."""
    c, geometry, ends = problem.composition, problem.parts.geometry, life.times[: life.steps + 1]
    until = max(geometry.injection_angle, geometry.discharge_opens or geometry.life)
    first = int(ends[1:].searchsorted(until + EQUAL))  # steps that end before
    shifts = shifts_to_neighbours(problem)
    low, high = ends[:first] + shifts[:, None], ends[1 : first + 1] + shifts[:, None]
    many = ends.searchsorted(high - EQUAL) - ends.searchsorted(low + EQUAL) >= MANY
    column, step = np.nonzero(many & (high < ends[-1] + EQUAL) & (low > -EQUAL))
    sums = np.zeros((life.steps + 1, len(shifts)))
    sums[1:] = life.quads[: life.steps, c.all_met]

    def met(angles: Array) -> Array:
        """Return the sums of neighbours up to angles of their lives."""
        i = (ends.searchsorted(angles, "right") - 1).clip(0, life.steps - 1)
        share = (angles - ends[i]) / (ends[i + 1] - ends[i])
        return (1.0 - share) * sums[i, column ^ 1] + share * sums[i + 1, column ^ 1]

    own = sums[step + 1, column] - sums[step, column]
    return MetTwice(step, column, own + met(high[column, step]) - met(low[column, step]))


def shifts_to_neighbours(problem: Problem) -> Array:
    """Return the angles [rad] by which neighbours are ahead, in the order of the sums of what is met."""
    offsets = problem.composition.offsets
    return problem.parts.geometry.pitch * np.array([way * offset for offset in offsets for way in (1, -1)])
