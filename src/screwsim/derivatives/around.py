"""All of it: derivatives of a scene's figures by numbers of it, through what lies around the machine, too.

Temperatures of an oil's circuit and losses of a package follow from the cycle that meets them: they are numbers of the
scene like others, and what the cycle asks of them closes one more small system.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from screwsim.build import Temperatures, filled, open_temperatures
from screwsim.cycle.problem import Built, Problem, Series, problem_of
from screwsim.derivatives.closed import Closed
from screwsim.derivatives.directions import Directions, Structural
from screwsim.derivatives.figures import differenced, figures_of, placed, responses, standing
from screwsim.derivatives.peak import turn_of
from screwsim.effects.base import PressureLosses
from screwsim.evaluate.evaluation import Evaluation
from screwsim.inputs.faults import UsageError
from screwsim.scene import with_values
from screwsim.solve.circuit import KPA, asked_of, unknowns_of

Array = np.ndarray
STEP = 2e-7  # of its size, by which a number is shifted
AROUND = 100.0  # [K, kPa] the size of what lies around the machine


class Sides(NamedTuple):
    """What is read on both sides of a number: figures, and what the cycle asks of its surroundings."""

    figures: dict[str, float]
    asked: Array


def derivatives(
    cycle: Closed, values: Mapping[str, float], built: Built | None = None
) -> tuple[dict[str, dict[str, float]], dict[str, str]]:
    """Return the derivatives [SI] of the figures by the numbers at paths of the scene, by path; and why some have none.

    `values` are the numbers [SI] at the paths, `built` what was built and composed of the scene.
    """
    made, series = Directions(cycle), Series(built)
    around = [made.of(_around(cycle.pitch.problem, series, i), STEP) for i in _open(cycle.pitch.problem)]
    directions, refused = {}, {}
    for path, value in values.items():
        try:
            directions[path] = made.of(_shifted(cycle.pitch.problem, series, path, value), STEP)
        except (Structural, UsageError) as why:
            refused[path] = str(why)
    every = [*around, *directions.values()]
    if not every:
        return {}, refused
    moves, read = responses(cycle, every, made), []
    turn = turn_of(standing(cycle, made))
    here = _read(standing(cycle, made, turn), bool(around))
    for j, direction in enumerate(every):
        there = _read(placed(cycle, direction, moves.by(j), made, turn), bool(around))
        figures = differenced(there.figures, here.figures, direction.step)
        read.append(Sides(figures, (there.asked - here.asked) / direction.step))
    through, own = read[: len(around)], dict(zip(directions, read[len(around) :], strict=True))
    found = {}
    for path, each in own.items():
        closed = _closed(each, through, _open(cycle.pitch.problem))
        found[path] = {name: slope / _size(values[path]) for name, slope in closed.items()}
    return found, refused


def _closed(own: Sides, through: Sequence[Sides], rows: Sequence[int]) -> dict[str, float]:
    """Return derivatives with what the surroundings add that follow."""
    if not through:
        return own.figures
    matrix = np.array([each.asked[list(rows)] for each in through]).T
    by = np.linalg.solve(matrix, -own.asked[list(rows)])
    names = [name for name in own.figures if all(name in each.figures for each in through)]
    slopes = np.array([[each.figures[name] for name in names] for each in (own, *through)])
    return dict(zip(names, (slopes[0] + by @ slopes[1:]).tolist(), strict=True))


def _read(of: Evaluation, whole: bool) -> Sides:
    """Return what is read of an evaluation; `whole`: what it asks of around, too."""
    asked = asked_of(of) if whole else None
    return Sides(figures_of(of), np.zeros(4) if asked is None else np.resize(np.append(asked.off, (0.0, 0.0)), 4))


def _size(value: float) -> float:
    """Return by what a number is measured: itself, or the unit of one that is nothing."""
    return abs(value) or 1.0


def _shifted(problem: Problem, series: Series, path: str, value: float) -> Callable[[float], Problem]:
    return lambda by: problem_of(with_values(problem.scene, {path: value + by * _size(value)}), series)


def _open(problem: Problem) -> list[int]:
    """Return which of the circuit's unknowns are open: temperatures of supply and separator, lost pressures."""
    temperatures = [i for i, each in enumerate(open_temperatures(problem.scene)) if each]
    return [*temperatures, *((2, 3) if problem.scene.losses is not None else ())]


def _around(problem: Problem, series: Series, i: int) -> Callable[[float], Problem]:
    """Return what poses the problem with one of the circuit's unknowns shifted by a share of its size."""

    def posed(by: float) -> Problem:
        x, scene = unknowns_of(problem), problem.scene
        x[i] += by * AROUND
        if any(open_temperatures(scene)):
            scene = filled(scene, Temperatures(*x[:2].tolist()))
        if len(x) > 2:
            scene = replace(scene, losses=PressureLosses(*(KPA * x[2:]).tolist()))
        return problem_of(scene, series)

    return posed
