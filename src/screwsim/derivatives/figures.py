"""What moves with a number of a scene: the closed cycle, and the figures that are read of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from screwsim.derivatives.closed import Closed, reads_states, solved
from screwsim.derivatives.directions import Direction, Directions, sources_of
from screwsim.derivatives.linear import Response
from screwsim.derivatives.peak import peak_pressure
from screwsim.evaluate.evaluation import Evaluation

Array = np.ndarray


class Moved(NamedTuple):
    """How the cycle moves with numbers, an axis behind all others: states, cells, quadratures, unknowns in coordinates.

    `life` is how its dense output does, numbers first.
    """

    response: Response
    unknowns: Array
    life: Array

    def by(self, j: int) -> Moved:
        """Return how it moves with one of them."""
        return Moved(Response(*(each[..., j] for each in self.response)), self.unknowns[:, j], self.life[j])


def responses(cycle: Closed, directions: Sequence[Direction], made: Directions) -> Moved:
    """Return how the cycle moves along directions, a column each, its unknowns with it."""
    found = cycle.linear.respond(sources_of(cycle, list(directions)))
    off, pitch = np.zeros((len(cycle.met), len(directions))), cycle.pitch
    held = Moved(found, off.copy(), pitch.life(found.start, found.nodes))
    for j, direction in enumerate(directions):
        images = [_image(cycle, direction, held.by(j), made, side) for side in (0, 1)]
        off[:, j] = np.where(
            cycle.given, direction.stated, (images[0] - images[1]) / (direction.steps[0] - direction.steps[1])
        )
    unknowns = np.stack([solved(cycle.back, each, cycle.given) for each in off.T], axis=-1) if len(directions) else off
    found = found.plus(cycle.by_unknowns.weighted(unknowns))
    return Moved(found, unknowns, pitch.life(found.start, found.nodes))


def _image(cycle: Closed, direction: Direction, moves: Moved, made: Directions, side: int) -> Array:
    """Return what the cycle, moved to one side, makes of its unknowns, in coordinates."""
    of = placed(cycle, direction, moves, made, side, reads_states(cycle.pitch))
    return of.problem.entries.coordinates(of.image)


def placed(
    cycle: Closed, direction: Direction, moves: Moved, made: Directions, side: int, whole: bool = True
) -> Evaluation:
    """Return the evaluation of the cycle moved to one side of a number (0 above, 1 below); `whole`: its states, too.

    It stands on the machinery of the cycle: it is to be read before anything else is done with that.
    """
    pitch, problem, by = cycle.pitch, direction.problems[side], direction.steps[side]
    at, entries, (_, _, cells, sums) = direction.sides[side], problem.entries, moves.response
    if moves.unknowns.any():
        met = entries.values(entries.coordinates(cycle.met) + by * moves.unknowns, cycle.met)
        at = made.numbers(problem, met)[0]
    pitch.put(at.plus(by, pitch.cells_as_numbers(cells)))
    if whole:
        edges = direction.change.edges
        edges = pitch.slices.edges if edges is None else pitch.slices.edges + by * edges
        pitch.install_life(made.life + by * moves.life, edges)
    return Evaluation(problem, pitch.machinery.trajectory, cycle.sums + by * sums)


def figures_of(of: Evaluation) -> dict[str, float]:
    """Return the figures that have a value; what is left open of a balance is none."""
    told = {name for name, each in of.figures.about.items() if not each.scale.unasked}
    found = {
        name: float(value) for name, value in of.figures.items() if isinstance(value, int | float) and name in told
    }
    return found | ({"peak_pressure": peak_pressure(of)} if "peak_pressure" in found else {})


def differenced(sides: Sequence[dict[str, float]], steps: tuple[float, float]) -> dict[str, float]:
    """Return the derivatives of what is there on both sides."""
    above, below = sides
    return {name: (above[name] - below[name]) / (steps[0] - steps[1]) for name in above if name in below}
