"""What moves with a number of a scene: the closed cycle, and the figures that are read of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from screwsim.derivatives.closed import Closed, reads_states, solved
from screwsim.derivatives.directions import Direction, Directions, sources_of
from screwsim.derivatives.linear import Response
from screwsim.derivatives.peak import peak_pressure, pressure_at
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
    whole = reads_states(pitch)
    held = Moved(found, off.copy(), pitch.life(found.start, found.nodes) if whole else np.zeros(len(directions)))
    own = _coordinates(standing(cycle, made, whole)) if directions else np.empty(0)
    for j, direction in enumerate(directions):
        image = _coordinates(placed(cycle, direction, held.by(j), made, whole))
        off[:, j] = np.where(cycle.given, direction.stated, (image - own) / direction.step)
    unknowns = np.stack([solved(cycle.back, each, cycle.given) for each in off.T], axis=-1) if len(directions) else off
    found = found.plus(cycle.by_unknowns.weighted(unknowns))
    return Moved(found, unknowns, pitch.life(found.start, found.nodes))


def _coordinates(of: Evaluation) -> Array:
    """Return what a cycle makes of its unknowns, in coordinates."""
    return of.problem.entries.coordinates(of.image)


def standing(cycle: Closed, made: Directions, whole: bool = True) -> Evaluation:
    """Return the evaluation of the cycle as it stands, to be read as one that is `placed`."""
    pitch = cycle.pitch
    pitch.put(made.own[0])
    if whole:
        pitch.install_life(made.life)
    return Evaluation(pitch.problem, pitch.machinery.trajectory, cycle.sums)


def placed(cycle: Closed, direction: Direction, moves: Moved, made: Directions, whole: bool = True) -> Evaluation:
    """Return the evaluation of the cycle moved with a shifted number; `whole`: its states, too.

    It stands on the machinery of the cycle: it is to be read before anything else is done with that.
    """
    pitch, problem, by = cycle.pitch, direction.problem, direction.step
    at, entries, (_, _, cells, sums) = direction.side, problem.entries, moves.response
    if moves.unknowns.any():
        met = entries.values(entries.coordinates(cycle.met) + by * moves.unknowns, cycle.met)
        at = made.numbers(problem, met)[0]
    pitch.put(at.plus(by, pitch.cells_as_numbers(cells)))
    if whole:
        edges = direction.change.edges
        edges = pitch.slices.edges if edges is None else pitch.slices.edges + by * edges
        pitch.install_life(made.life + by * moves.life, edges)
    return Evaluation(problem, pitch.machinery.trajectory, cycle.sums + by * sums)


def figures_of(of: Evaluation, turn: tuple[int, float] | None = None) -> dict[str, float]:
    """Return the figures that have a value; what is left open of a balance is none.

    The highest pressure is that where the pressure turns in a step (`peak.turn_of`) where that is given.
    """
    told = {name for name, each in of.figures.about.items() if not each.scale.unasked}
    found = {
        name: float(value) for name, value in of.figures.items() if isinstance(value, int | float) and name in told
    }
    if "peak_pressure" in found:
        found["peak_pressure"] = peak_pressure(of) if turn is None else pressure_at(of.life, turn)
    return found


def differenced(there: dict[str, float], here: dict[str, float], step: float) -> dict[str, float]:
    """Return the derivatives of what is there on both sides."""
    return {name: (there[name] - here[name]) / step for name in there if name in here}
