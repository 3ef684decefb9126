"""Solve a scene and differentiate its figures by numbers of it, including the response of the machine's surroundings.

What surrounds the machine and follows from the cycle (`derivatives.around`) is treated as numbers of the scene, and
what the cycle implies for them closes one more small linear system.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from screwsim.codegen.program import CannotCompile
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import BuiltParts, Problem, Series, problem_of, release_series, series_of_one
from screwsim.derivatives.around import (
    SIZE,
    coordinate_shifted,
    coordinates,
    implied_changes,
    moves_an_end,
    number_shifted,
    open_coordinates,
    problem_at,
    shift_size,
)
from screwsim.derivatives.collocated_cycle import CollocatedCycle, NotClosed
from screwsim.derivatives.collocation import FINE, Fineness, collocated, collocated_nearby
from screwsim.derivatives.directions import Direction, Directions, Structural
from screwsim.derivatives.driven import closed_with_drive
from screwsim.derivatives.linear import Response
from screwsim.derivatives.peak import peak_pressure, peak_step
from screwsim.derivatives.rate_numbers import RateNumbers
from screwsim.derivatives.response import shifted_evaluation, unshifted_evaluation
from screwsim.derivatives.shifted_life import PeakPlace, ShiftedLife, in_step
from screwsim.evaluate.evaluation import Evaluation
from screwsim.inputs.faults import ImpossibleValue, UsageError
from screwsim.model import leases
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.garbage import no_search
from screwsim.scene import Scene
from screwsim.solve.circuit import solve_with_surroundings, steady_state

Array = np.ndarray
STEP = 2e-7  # relative shift of a number, for differences
LARGEST_RESIDUAL = 1e-4  # [K, kPa], largest admissible residual of the surroundings of the collocated cycle ...
MOST_STEPS = 3  # ... unless so many Newton steps were made
AT_END = "it moves the end of the range at which what is found with the cycle stands (oil flow, economizer, valve)"


class SideReadings(NamedTuple):
    """The results on one side of a number: figures, and the changes of its surroundings that the cycle implies."""

    figures: dict[str, float]
    asked: Array


def derivatives(
    cycle: CollocatedCycle, values: Mapping[str, float], built: BuiltParts | None = None
) -> tuple[dict[str, dict[str, float]], dict[str, str]]:
    """Return the derivatives [SI] of the figures by numbers of the scene, by path; and why some paths have none.

    `values` are the numbers [SI] at the paths, `built` the parts and composer of the scene's series.
    """
    all_directions, series = Directions(cycle), Series(built)
    around = _by_surroundings(all_directions, series)
    own, refused = _by_values(all_directions, series, values)
    every = [*around, *own.values()]
    if not every:
        return {}, refused
    read, rows = _differences(all_directions, every, bool(around)), open_coordinates(cycle.pitch.problem)
    through, slopes = read[: len(around)], {}
    for path, each in zip(own, read[len(around) :], strict=True):
        closed = _with_response(each, through, rows)
        slopes[path] = {name: slope / shift_size(values[path]) for name, slope in closed.items()}
    return slopes, refused


def _by_values(
    all_directions: Directions, series: Series, values: Mapping[str, float]
) -> tuple[dict[str, Direction], dict[str, str]]:
    """Return the directions of numbers [SI] by path, and why some paths have none."""
    problem, found, refused = all_directions.cycle.pitch.problem, {}, {}
    for path, value in values.items():
        try:
            direction = all_directions.of(number_shifted(problem, series, path, value), STEP)
            if moves_an_end(problem, direction.problem):
                raise Structural(AT_END)
            found[path] = direction
        except (Structural, UsageError) as why:
            refused[path] = str(why)
    return found, refused


def _differences(all_directions: Directions, directions: Sequence[Direction], around: bool) -> list[SideReadings]:
    """Return the derivatives of figures along directions, with `around` also those of what the cycle implies."""
    directions, moves = closed_with_drive(all_directions, directions)
    turn = _peak_place(all_directions)
    here, found = _readings_of(unshifted_evaluation(all_directions, turn), around), []
    for j, direction in enumerate(directions):
        there = _readings_of(shifted_evaluation(all_directions, direction, moves.by(j), turn), around)
        both = [name for name in there.figures if name in here.figures]
        figures = {name: (there.figures[name] - here.figures[name]) / direction.step for name in both}
        found.append(SideReadings(figures, (there.asked - here.asked) / direction.step))
    return found


def _peak_place(all_directions: Directions) -> PeakPlace | None:
    """Return where in a step the cycle's highest pressure lies; None where that is at an end of its range."""
    step, cycle = peak_step(unshifted_evaluation(all_directions)), all_directions.cycle
    if step is None:
        return None
    states, after = cycle.nodes.__getitem__, cycle.pitch.after(cycle.nodes)
    return PeakPlace(*step, in_step(cycle.pitch, cycle.start, states, after, step[0]))


def _by_surroundings(all_directions: Directions, series: Series) -> list[Direction]:
    """Return the directions of the coordinates that respond; raise NotClosed where one moves the end of another."""
    problem = all_directions.cycle.pitch.problem
    found = [all_directions.of(coordinate_shifted(problem, series, i), STEP) for i in open_coordinates(problem)]
    if any(moves_an_end(problem, each.problem) for each in found):
        raise NotClosed(AT_END)
    return found


def with_settled_surroundings(
    cycle: CollocatedCycle, life: Trajectory, built: BuiltParts | None = None, fineness: Fineness = FINE
) -> CollocatedCycle:
    """Return the collocated cycle of a life with its surroundings converged to `LARGEST_RESIDUAL`.

    A solution leaves a residual within its accuracy: 3 mK of the oil's temperature changed a derivative by 1e-4.
    """
    series = Series(built)
    for _ in range(MOST_STEPS):
        rows = open_coordinates(cycle.pitch.problem)  # a step may lead one to an end of its range
        asked = _newton_step(cycle, series, rows) if rows else None
        if asked is None:
            break
        problem, numbers, moves = asked
        try:
            cycle = collocated_nearby(cycle, problem, numbers, moves, fineness)
        except (NotClosed, np.linalg.LinAlgError):
            machinery = cycle.pitch.machinery
            machinery.put(life)
            cycle.pitch.put(numbers)
            cycle = collocated(problem, machinery, machinery.trajectory.copy(), fineness)
    return cycle


def _newton_step(
    cycle: CollocatedCycle, series: Series, rows: Sequence[int]
) -> tuple[Problem, RateNumbers, Response] | None:
    """Return the problem, its numbers and the cycle's response to a Newton step of the surroundings.

    None where these have converged.
    """
    problem, all_directions = cycle.pitch.problem, Directions(cycle)
    here = implied_changes(unshifted_evaluation(all_directions))[rows]
    if float(np.abs(here).max()) <= LARGEST_RESIDUAL:
        return None
    around, moves = closed_with_drive(all_directions, _by_surroundings(all_directions, series))
    pairs = enumerate(around)
    asked = [implied_changes(shifted_evaluation(all_directions, each, moves.by(j)))[rows] for j, each in pairs]
    matrix = np.array([(there - here) / each.step for there, each in zip(asked, around, strict=True)]).T
    by = np.linalg.solve(matrix, -here)
    x, entries = coordinates(problem), problem.entries
    x[rows] += by * SIZE
    moved = problem_at(problem, series, x)
    unknowns_in = entries.values(entries.coordinates(cycle.unknowns_in) + moves.unknowns @ by, cycle.unknowns_in)
    return moved, all_directions.numbers(moved, unknowns_in)[0], moves.response.weighted(by)


def _with_response(own: SideReadings, through: Sequence[SideReadings], rows: Sequence[int]) -> dict[str, float]:
    """Return derivatives including the response of the surroundings."""
    if not through:
        return own.figures
    matrix = np.array([each.asked[list(rows)] for each in through]).T
    by = np.linalg.solve(matrix, -own.asked[list(rows)])
    names = [name for name in own.figures if all(name in each.figures for each in through)]
    slopes = np.array([[each.figures[name] for name in names] for each in (own, *through)])
    return dict(zip(names, (slopes[0] + by @ slopes[1:]).tolist(), strict=True))


def _readings_of(of: Evaluation, whole: bool) -> SideReadings:
    """Return the results of an evaluation; with `whole` also what it implies for its surroundings."""
    return SideReadings(figures_of(of), implied_changes(of) if whole else np.empty(0))


class SceneDerivatives(NamedTuple):
    """Derivatives [SI] by path and figure; why paths have none; why there are none at all (empty: there are)."""

    derivatives: Mapping[str, Mapping[str, float]]
    refused: Mapping[str, str]
    why: str = ""


def scene_derivatives(scene: Scene, values: Mapping[str, float], fineness: Fineness = FINE) -> SceneDerivatives:
    """Return the derivatives of a scene's figures by numbers [SI] at paths of it."""
    try:
        with no_search():  # many objects are created, hardly any in reference cycles
            return _found(scene, values, fineness)
    except NotClosed as error:
        return SceneDerivatives({}, {}, str(error))
    except (ImpossibleValue, CannotCompile, np.linalg.LinAlgError) as error:
        return SceneDerivatives({}, {}, f"the cycle cannot be linearised: {error}")


def _found(scene: Scene, values: Mapping[str, float], fineness: Fineness) -> SceneDerivatives:
    """Solve the scene, collocate its cycle and return the derivatives."""
    series = series_of_one()
    if not fineness.estimated:
        scene = replace(scene, numerics=replace(scene.numerics, error="none"))
    problem, search = steady_state(problem_of(scene, series), series)
    machinery = lease_for(problem)
    accurate = solve_with_surroundings(problem, machinery, None, search)
    if not accurate.cycle.closed:
        return SceneDerivatives({}, {}, "the cycle does not close")
    cycle = collocated(accurate.evaluation.problem, machinery, accurate.evaluation.life, fineness)
    if fineness.estimated:
        cycle = with_settled_surroundings(
            cycle, accurate.evaluation.life, (series.parts_cache.lent(), series.composer.lent()), fineness
        )
    slopes, refused = derivatives(cycle, values, (series.parts_cache.lent(), series.composer.lent()))
    leases.give_back(machinery)
    release_series(series)
    return SceneDerivatives(slopes, refused)


def figures_of(of: Evaluation) -> dict[str, float]:
    """Return the figures that have a value, except residuals of balances.

    The highest pressure is that at the turning point within a step, where this is known (`shifted_evaluation`).
    """
    told = {name for name, each in of.figures.about.items() if not each.scale.unasked}
    found = {
        name: float(value) for name, value in of.figures.items() if isinstance(value, int | float) and name in told
    }
    if "peak_pressure" in found and not (isinstance(of.life, ShiftedLife) and of.life.turning is not None):
        found["peak_pressure"] = peak_pressure(of)
    return found
