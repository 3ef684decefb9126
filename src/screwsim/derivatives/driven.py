"""The response of a drive: how numbers change the speed over the angle, which the torque of the chambers makes.

The curve of the speed is among the numbers of the rates. A direction's change of it is a fixed point: the cycle
responds to the direction and to the curve, the drive to the torque of that cycle (docs/model.md M214, M217). A ripple
changes the torque by much less than itself, so that a few rounds suffice.
"""

from collections.abc import Sequence

import numpy as np

from screwsim.derivatives.around import motion_of
from screwsim.derivatives.collocated_cycle import NotClosed
from screwsim.derivatives.directions import Direction, Directions
from screwsim.derivatives.response import CycleResponse, image, responses, shifted_evaluation, unshifted_evaluation
from screwsim.evaluate.evaluation import Evaluation
from screwsim.model import speed
from screwsim.solve.drive import speed_curve_of

Array = np.ndarray
MOST_ROUNDS = 12  # rounds of chambers and drive
SETTLED = 1e-6  # last change of the squared relative speed, per share of a number, at which rounds end


def closed_with_drive(
    all_directions: Directions, directions: Sequence[Direction]
) -> tuple[list[Direction], CycleResponse]:
    """Return directions (at least one) with the response of the drive, where there is one, and that of the cycle."""
    composition, found = all_directions.cycle.pitch.machinery.composition, list(directions)
    here = unshifted_evaluation(all_directions)
    unmoved, driven = image(here), composition.speed_curve is not None
    own = _curve_of(here) if driven else np.zeros(0)
    moves = responses(all_directions, found, unmoved)
    if not driven:
        return found, moves
    last, moved = np.zeros((len(found), speed.ROWS - 1)), np.inf
    for _ in range(MOST_ROUNDS):
        curves = []
        for j, each in enumerate(found):
            there = _curve_of(shifted_evaluation(all_directions, each, moves.by(j)))
            curves.append((there - own) / each.step)
        now = np.array([speed.squares_at(each, 0) for each in curves])
        moved, before = float(np.abs(now - last).max()), moved
        if moved <= SETTLED:
            return found, moves
        at = speed.curve_places(composition)
        found, last = [each.with_parameters(at, change) for each, change in zip(directions, curves, strict=True)], now
        moves = responses(all_directions, found, unmoved)
        if moved * moved <= SETTLED * before < np.inf:  # what the next round would still change
            return found, moves
    raise NotClosed("the response of the drive does not converge")


def _curve_of(of: Evaluation) -> Array:
    """Return the packed curve of the speed that the drive makes of a cycle's torque."""
    _, curve = speed_curve_of(motion_of(of), of.problem.parts.geometry.pitch)
    if curve is None:
        raise NotClosed("the drive nearly stops")
    return curve
