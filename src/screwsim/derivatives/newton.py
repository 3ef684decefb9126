"""Close the collocated cycle by Newton's method: all chambers, feedback unknowns and events together.

Each chamber is closed by itself first (`chamber_newton`), which costs less; where that does not converge, all are
linearised, as often as necessary.
"""

from typing import NamedTuple

import numpy as np

from screwsim.derivatives import chamber_newton, unknowns
from screwsim.derivatives.chamber_newton import KEEP_SLOPES_BELOW, ChamberFactors, damped, limited_step
from screwsim.derivatives.collocated_cycle import CollocatedCycle, NotClosed
from screwsim.derivatives.linear import LinearisedPitch
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.residual import Residual, residual_of

Array = np.ndarray
MOST_ITERATIONS = 20  # Newton iterations ...
STALLED = 6  # ... of which this many may pass without progress
STATES_WITHIN = 1e-5  # relative residual that is accepted where no iteration reduces it further


def close(
    pitch: CollocatedPitch, bound: float, linear: LinearisedPitch | None, own: ChamberFactors
) -> tuple[Array, LinearisedPitch | None]:
    """Close the cycle to a relative residual; return the states at the nodes, installed, and the last linearisation.

    It starts from the last history, with a linearisation of as many slices, if given. Raises NotClosed.
    """
    Y, size, before = pitch.read(), np.inf, np.inf
    found = None if pitch.alone else chamber_newton.closed(pitch, Y, bound, own)
    if found is not None:
        return found, linear
    last, least, stalled = np.zeros_like(Y), np.inf, 0
    for left in range(MOST_ITERATIONS, 0, -1):
        open_ = residual_of(pitch, Y)
        size = open_.size(Y)
        stalled = 0 if size < least else stalled + 1
        least = min(size, least)
        ends = left == 1 or stalled == STALLED
        if size < bound or (size < STATES_WITHIN and ends):
            pitch.install(open_.start, Y)
            return Y, linear
        if ends or not np.isfinite(size):
            break
        if linear is None or size > KEEP_SLOPES_BELOW * before:
            at, now = pitch.numbers, unknowns.unknowns_of(pitch)
            changes = [unknowns.as_argument(pitch, at, now, j) for j in range(len(now))]
            linear = LinearisedPitch(pitch, Y, pitch.rates.slopes(Y), changes)
        before = size
        step = _newton_step(pitch, Y, open_, linear)
        share = pitch.events.share_of_move(step.events)
        last = damped(share * step.nodes, last)
        Y = limited_step(pitch, Y, last)
        pitch.move_events(share * step.events)
        now = unknowns.unknowns_of(pitch)
        unknowns.put_unknowns(pitch, unknowns.coordinates_of(pitch, now) + step.unknowns, now)
    raise NotClosed(f"the collocated cycle leaves a residual of {size:.1g} open")


class _Step(NamedTuple):
    """Newton's change of the states at the nodes (slices, NODES, N), of the unknowns in coordinates, and of events."""

    nodes: Array
    unknowns: Array
    events: Array


def _newton_step(pitch: CollocatedPitch, Y: Array, open_: Residual, linear: LinearisedPitch) -> _Step:
    """Return Newton's step: the response to the residuals at fixed unknowns, and that to a change of these.

    With that change they equal their image.
    """
    response, of_unknowns = linear.respond(-open_.stages[..., None], open_.events), linear.first
    now = unknowns.unknowns_of(pitch)
    cycle = CollocatedCycle(pitch, open_.start, Y, linear.slopes, open_.sums, pitch.numbers, now, open_.into)
    back = unknowns.image_response(cycle, of_unknowns, to_unknowns=True)
    off = open_.unknowns + unknowns.image_response(cycle, response, to_unknowns=False)[:, 0]
    change = unknowns.solved(back, off, unknowns.stated(back))
    direct, through = response.of(0), of_unknowns.weighted(change)
    return _Step(direct.nodes + through.nodes, change, direct.events + through.events)
