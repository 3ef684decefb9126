"""What moves with a number of a scene: the closed cycle, and the figures that are read of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from screwsim.derivatives.closed import Closed, solved
from screwsim.derivatives.directions import Direction, Directions, along
from screwsim.derivatives.linear import Response
from screwsim.derivatives.peak import peak_pressure
from screwsim.derivatives.pitch import Pitch
from screwsim.derivatives.placed import Placed, Turning, in_step
from screwsim.evaluate.evaluation import Evaluation

Array = np.ndarray


class Moved(NamedTuple):
    """How the cycle moves with numbers, an axis behind all others: states, cells, quadratures, unknowns in coordinates.

    `lives` returns how its dense output does, numbers first: found when it is first asked for.
    """

    response: Response
    unknowns: Array
    lives: Callable[[], Array]

    def by(self, j: int) -> Move:
        """Return how it moves with one of them."""
        return Move(self.response.of(j), self.unknowns[:, j], lambda: self.lives()[j])


class Move(NamedTuple):
    """How the cycle moves with one number, as `Moved` has it."""

    response: Response
    unknowns: Array
    life: Callable[[], Array]


def _moved(pitch: Pitch, response: Response, unknowns: Array) -> Moved:
    return Moved(response, unknowns, cache(lambda: pitch.life(response.start, response.nodes)))


def responses(cycle: Closed, directions: Sequence[Direction], made: Directions) -> Moved:
    """Return how the cycle moves along directions (at least one), a column each, its unknowns with it."""
    linear, off, pitch = along(cycle, directions), np.zeros((len(cycle.met), len(directions))), cycle.pitch
    held = _moved(pitch, linear.by_changes, off.copy())
    own = _coordinates(standing(cycle, made))
    for j, direction in enumerate(directions):
        image = _coordinates(placed(cycle, direction, held.by(j), made))
        off[:, j] = np.where(linear.given, direction.stated, (image - own) / direction.step)
    unknowns = np.stack([solved(linear.back, each, linear.given) for each in off.T], axis=-1)
    return _moved(pitch, linear.by_changes.added(linear.by_unknowns.weighted(unknowns)), unknowns)


def _coordinates(of: Evaluation) -> Array:
    """Return what a cycle makes of its unknowns, in coordinates."""
    return of.problem.entries.coordinates(of.image)


def standing(cycle: Closed, made: Directions, turn: tuple[int, float] | None = None) -> Evaluation:
    """Return the evaluation of the cycle as it stands, to be read as one that is `placed`."""
    pitch = cycle.pitch
    pitch.put(made.own[0])
    turning = None if turn is None else Turning(*turn, in_step(pitch, cycle.start, cycle.nodes.__getitem__, turn[0]))
    return Evaluation(pitch.problem, Placed.of(pitch, lambda: pitch.install_life(made.life), turning), cycle.sums)


def placed(
    cycle: Closed, direction: Direction, moves: Move, made: Directions, turn: tuple[int, float] | None = None
) -> Evaluation:
    """Return the evaluation of the cycle moved with a shifted number, its highest pressure that at a `turn`.

    It stands on the machinery of the cycle: it is to be read before anything else is done with that.
    """
    pitch, problem, by = cycle.pitch, direction.problem, direction.step
    at, entries, response = direction.side, problem.entries, moves.response
    if moves.unknowns.any():
        met = entries.values(entries.coordinates(cycle.met) + by * moves.unknowns, cycle.met)
        at = made.meeting(direction, met)
    pitch.put(at.plus(by, pitch.cells_as_numbers(response.cells)))

    def fill() -> None:
        edges = direction.change.edges
        edges = pitch.slices.edges if edges is None else pitch.slices.edges + by * edges
        pitch.install_life(made.life + by * moves.life(), edges)

    turning = None
    if turn is not None:
        here = in_step(pitch, cycle.start, cycle.nodes.__getitem__, turn[0])
        turning = Turning(*turn, here + by * in_step(pitch, response.start, response.inside, turn[0]))
    return Evaluation(problem, Placed.of(pitch, fill, turning), cycle.sums + by * response.sums)


def figures_of(of: Evaluation) -> dict[str, float]:
    """Return the figures that have a value; what is left open of a balance is none.

    The highest pressure is that where the pressure turns in a step, where that is known (`placed`).
    """
    told = {name for name, each in of.figures.about.items() if not each.scale.unasked}
    found = {
        name: float(value) for name, value in of.figures.items() if isinstance(value, int | float) and name in told
    }
    if "peak_pressure" in found and not (isinstance(of.life, Placed) and of.life.turning is not None):
        found["peak_pressure"] = peak_pressure(of)
    return found


def differenced(there: dict[str, float], here: dict[str, float], step: float) -> dict[str, float]:
    """Return the derivatives of what is there on both sides."""
    return {name: (there[name] - here[name]) / step for name in there if name in here}
