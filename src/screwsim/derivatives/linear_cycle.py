"""The collocated cycle linearised together with its feedback unknowns."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from screwsim.derivatives import unknowns
from screwsim.derivatives.argument_changes import ArgumentChange
from screwsim.derivatives.collocated_cycle import CollocatedCycle
from screwsim.derivatives.linear import DirectEffects, LinearisedPitch, RateEffects, Response
from screwsim.derivatives.phases import borders

Array = np.ndarray


class LinearisedCycle(NamedTuple):
    """The response of a collocated cycle to changes, a column each, at fixed unknowns, and to each unknown.

    `back` (u, u) is the response of the unknowns to themselves, in coordinates; `given` marks those that the scene
    states; `own` are the effects of the unknowns.
    """

    by_changes: Response
    by_unknowns: Response
    back: Array
    given: Array
    own: RateEffects


def linearised(
    cycle: CollocatedCycle, changes: Sequence[ArgumentChange], injected: DirectEffects, last: LinearisedCycle | None
) -> LinearisedCycle:
    """Return the cycle's responses to changes and to its unknowns; from the `last`, what depends on it alone.

    `injected`: those of states and cells by the injection, a column each. All at once, side by side, cost less.
    """
    pitch, count, own = cycle.pitch, len(cycle.unknowns_in), None if last is None else last.own
    pitch.put(cycle.at)
    every = [*(unknowns.as_argument(pitch, cycle.at, cycle.unknowns_in, j) for j in range(count)), *changes]
    crossed = borders(pitch, cycle.nodes)
    linear = LinearisedPitch(pitch, cycle.nodes, cycle.slopes, every, injected, crossed, count, own)
    by_unknowns, by_changes = linear.first.of(slice(count)), linear.first.of(slice(count, None))
    back = unknowns.image_response(cycle, by_unknowns, to_unknowns=True) if last is None else last.back
    return LinearisedCycle(by_changes, by_unknowns, back, unknowns.stated(back), linear.own)
