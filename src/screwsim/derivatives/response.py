"""The response of the closed cycle to changes of its numbers, and the evaluation of the cycle so shifted."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple, Self

import numpy as np

from screwsim.derivatives.directions import Direction, Directions
from screwsim.derivatives.linear import Response
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.shifted_life import PeakPlace, ShiftedLife, in_step
from screwsim.derivatives.unknowns import solved
from screwsim.evaluate.evaluation import Evaluation

Array = np.ndarray


class CycleResponse(NamedTuple):
    """The response of the cycle to one number or several: states, cells, quadratures, and unknowns in coordinates.

    Several have a column each. `life` returns the response of the dense output, numbers first; it is computed on first
    use.
    """

    response: Response
    unknowns: Array
    life: Callable[[], Array]

    def by(self, j: int) -> Self:
        """Return the response to one of several numbers."""
        return self._make((self.response.of(j), self.unknowns[:, j], lambda: self.life()[j]))


def _moved(pitch: CollocatedPitch, response: Response, unknowns: Array) -> CycleResponse:
    """Return the response with its dense output still to be computed."""
    return CycleResponse(response, unknowns, cache(lambda: pitch.life(response.start, response.nodes, response.after)))


def responses(all_directions: Directions, directions: Sequence[Direction], own: Array) -> CycleResponse:
    """Return the response of the cycle and its unknowns to directions (at least one), a column each.

    `own` is the `image` of the unchanged cycle.
    """
    linear, cycle, pitch = all_directions.along(directions), all_directions.cycle, all_directions.cycle.pitch
    off = np.zeros((len(cycle.unknowns_in), len(directions)))
    held = _moved(pitch, linear.by_changes, off.copy())
    for j, direction in enumerate(directions):
        there = image(shifted_evaluation(all_directions, direction, held.by(j)))
        off[:, j] = np.where(linear.given, direction.stated, (there - own) / direction.step)
    unknowns = np.stack([solved(linear.back, each, linear.given) for each in off.T], axis=-1)
    return _moved(pitch, linear.by_changes.added(linear.by_unknowns.weighted(unknowns)), unknowns)


def image(of: Evaluation) -> Array:
    """Return the next values of a cycle's unknowns, in coordinates."""
    return of.problem.entries.coordinates(of.image)


def unshifted_evaluation(all_directions: Directions, turn: PeakPlace | None = None) -> Evaluation:
    """Return the evaluation of the unchanged cycle, read in the same way as one that is `shifted_evaluation`."""
    cycle, pitch = all_directions.cycle, all_directions.cycle.pitch
    pitch.put(all_directions.own[0])
    life = ShiftedLife.of(pitch, lambda: pitch.install_life(all_directions.life), turn)
    return Evaluation(pitch.problem, life, cycle.sums, into=cycle.into)


def shifted_evaluation(
    all_directions: Directions, direction: Direction, moves: CycleResponse, turn: PeakPlace | None = None
) -> Evaluation:
    """Return the evaluation of the cycle after a shift of a number; with a `turn`, its highest pressure is read there.

    The `turn` is that of the unchanged cycle. The evaluation uses the machinery of the
    cycle, so it must be read before that is used for anything else.
    """
    cycle, problem, by = all_directions.cycle, direction.problem, direction.step
    pitch, at, entries, response = cycle.pitch, direction.side, problem.entries, moves.response
    if moves.unknowns.any():
        unknowns_in = entries.values(entries.coordinates(cycle.unknowns_in) + by * moves.unknowns, cycle.unknowns_in)
        at = all_directions.meeting(direction, unknowns_in)
    pitch.put(at)
    pitch.period.move_cells(by, response.cells)

    def fill() -> None:
        edges, moved = direction.change.edges, response.events @ pitch.events.moves(pitch.mesh.edges)
        edges = pitch.mesh.edges + by * (moved if edges is None else moved + edges)
        pitch.install_life(all_directions.life + by * moves.life(), edges)

    turning = None
    if turn is not None:
        moved = in_step(pitch, response.start, response.inside, response.after, turn.step)
        turning = turn._replace(states=turn.states + by * moved)
    into = cycle.into and cycle.into.moved(by * response.lines, direction.open_volumes)
    return Evaluation(problem, ShiftedLife.of(pitch, fill, turning), cycle.sums + by * response.sums, into=into)
