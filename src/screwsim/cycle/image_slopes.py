"""What small changes along a pitch make of the feedback unknowns: differences of the image itself.

It is made of whatever. It reads the quadratures, which the linearised pitch tells, and, where lines pulsate, the flow
into them over the pitch: that changes by what the slices of the pitch give the lines, each spread over its angles.

Source: docs/explanation/numerics.md, Newton's correction.
"""

import numpy as np

from screwsim.cycle.feedback import LINE_POINTS, IntoLines, into_lines, set_unknowns
from screwsim.cycle.feedback import image as image_of
from screwsim.cycle.linear_pitch import Tangents
from screwsim.cycle.problem import Problem
from screwsim.model.composition import Composition
from screwsim.model.run import Machinery
from screwsim.model.slots import P_OMEGA

Array = np.ndarray
STEP = 1e-4  # of a change of the quadratures and unknowns, for differences of what they make of the unknowns


def slopes_of_image(
    problem: Problem, machinery: Machinery, tangents: Tangents, given: Array, q: Array, met: Array, made: Array
) -> Array:
    """Return what changes of the last life make of the unknowns, in coordinates (u, k), a column each.

    `given` (slices, q, k) are what the changes add to the quadratures q, slice by slice; the last u changes are of one
    unknown each, which are met as `met` and made `made`.
    """
    entries, here = problem.entries, problem.entries.coordinates(met)
    at_made, sums, count = entries.coordinates(made), given.sum(axis=0), given.shape[2]
    first = count - len(met)
    found = np.empty((len(met), count))
    base = moved = None
    if problem.composition.pulsating:
        base = into_lines(machinery.trajectory)
        moved = _into(problem.composition, tangents, given)
    for j in range(count):
        there = here.copy()
        if j >= first:
            there[j - first] += STEP
        set_unknowns(problem, machinery, entries.values(there, met) if j >= first else met)
        into = None if base is None or moved is None else IntoLines(base.flow + STEP * moved[j], base.volume)
        image = image_of(problem, machinery.trajectory, q + STEP * sums[:, j], into=into)
        found[:, j] = (entries.coordinates(image) - at_made) / STEP
    set_unknowns(problem, machinery, met)
    return found


def _into(c: Composition, tangents: Tangents, given: Array) -> Array:
    """Return by how much the flows [kg/s] into suction and discharge line change over a pitch (k, 2, LINE_POINTS)."""
    streams = given[:, c.first_stream :: c.width][:, :4]  # gas to the chambers: suction in, out, discharge in, out
    lines = -(streams[:, 0::2] + streams[:, 1::2])
    return float(c.P[P_OMEGA]) * tangents.spread(lines, LINE_POINTS).transpose(2, 1, 0)
