"""Solve a scene and differentiate its figures by numbers of it, including the response of the machine's surroundings.

The temperatures of an oil's circuit and the losses of a package follow from the cycle: they are treated as numbers of
the scene, and what the cycle implies for them closes one more small linear system.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

from screwsim.build import Temperatures, open_temperatures, with_temperatures
from screwsim.build.open_values import at_an_end, with_coordinates
from screwsim.codegen.program import CannotCompile
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import BuiltParts, Problem, Series, problem_of, release_series, series_of_one
from screwsim.derivatives.collocation import FINE, CollocatedCycle, Fineness, NotClosed, collocated
from screwsim.derivatives.collocation import solve_unknowns as solved_pitch
from screwsim.derivatives.directions import Direction, Directions, Structural, along
from screwsim.derivatives.linear import Response
from screwsim.derivatives.peak import peak_pressure, peak_step
from screwsim.derivatives.pitch import CollocatedPitch, RateNumbers
from screwsim.derivatives.shifted_life import PeakPlace, ShiftedLife, in_step
from screwsim.effects.base import PressureLosses
from screwsim.evaluate.evaluation import Evaluation
from screwsim.inputs.faults import ImpossibleValue, UsageError
from screwsim.model import leases
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.garbage import no_search
from screwsim.scene import Scene, with_values
from screwsim.solve.circuit import solve_with_surroundings, steady_state
from screwsim.solve.surroundings import KPA, implied_surroundings, unknowns_of

Array = np.ndarray
STEP = 2e-7  # relative shift of a number, for differences
SURROUNDINGS_SIZE = 100.0  # [K, kPa], the size that unknowns of the surroundings are shifted relative to
LARGEST_RESIDUAL = 1e-5  # [K, kPa], largest admissible residual of the surroundings of the collocated cycle ...
MOST_STEPS = 3  # ... unless so many Newton steps were made
ONE_CHAMBER = "chambers are integrated one at a time, with valve and seat events of their own"
DRIVEN = "the speed follows from the drive"
AT_END = "what is found with the cycle (the oil flow, an economizer, a valve) is at an end of its range"


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
    around = [
        all_directions.of(_with_surroundings_shifted(cycle.pitch.problem, series, i), STEP)
        for i in _open_unknowns(cycle.pitch.problem)
    ]
    directions, refused = {}, {}
    for path, value in values.items():
        try:
            directions[path] = all_directions.of(_shifted(cycle.pitch.problem, series, path, value), STEP)
        except (Structural, UsageError) as why:
            refused[path] = str(why)
    every = [*around, *directions.values()]
    if not every:
        return {}, refused
    moves, read = responses(cycle, every, all_directions), []
    peak = peak_step(unshifted_evaluation(cycle, all_directions))
    states = cycle.nodes.__getitem__
    turn = None if peak is None else PeakPlace(*peak, in_step(cycle.pitch, cycle.start, states, peak[0]))
    here = _readings_of(unshifted_evaluation(cycle, all_directions, turn), bool(around))
    for j, direction in enumerate(every):
        there = _readings_of(shifted_evaluation(cycle, direction, moves.by(j), all_directions, turn), bool(around))
        both = [name for name in there.figures if name in here.figures]
        figures = {name: (there.figures[name] - here.figures[name]) / direction.step for name in both}
        read.append(SideReadings(figures, (there.asked - here.asked) / direction.step))
    through, own = read[: len(around)], dict(zip(directions, read[len(around) :], strict=True))
    found = {}
    for path, each in own.items():
        closed = _with_response(each, through, _open_unknowns(cycle.pitch.problem))
        found[path] = {name: slope / _shift_size(values[path]) for name, slope in closed.items()}
    return found, refused


def with_settled_surroundings(
    cycle: CollocatedCycle, life: Trajectory, built: BuiltParts | None = None, fineness: Fineness = FINE
) -> CollocatedCycle:
    """Return the collocated cycle of a life with its surroundings converged to `LARGEST_RESIDUAL`.

    A solution leaves a residual within its accuracy: 3 mK of the oil's temperature changed a derivative by 1e-4.
    """
    rows, series = _open_unknowns(cycle.pitch.problem), Series(built)
    for _ in range(MOST_STEPS if rows else 0):
        asked = _newton_step(cycle, series, rows)
        if asked is None:
            break
        problem, numbers = asked
        pitch = cycle.pitch
        pitch.machinery.put(life)
        pitch.put(numbers)
        cycle = collocated(problem, pitch.machinery, pitch.machinery.trajectory.copy(), fineness)
    return cycle


def _newton_step(cycle: CollocatedCycle, series: Series, rows: Sequence[int]) -> tuple[Problem, RateNumbers] | None:
    """Return the problem and its numbers after a Newton step of the surroundings; None where these have converged."""
    problem, all_directions = cycle.pitch.problem, Directions(cycle)
    here = _implied_changes(unshifted_evaluation(cycle, all_directions))[rows]
    if float(np.abs(here).max()) <= LARGEST_RESIDUAL:
        return None
    around = [all_directions.of(_with_surroundings_shifted(problem, series, i), STEP) for i in rows]
    moves = responses(cycle, around, all_directions)
    asked = [
        _implied_changes(shifted_evaluation(cycle, each, moves.by(j), all_directions))[rows]
        for j, each in enumerate(around)
    ]
    matrix = np.array([(there - here) / each.step for there, each in zip(asked, around, strict=True)]).T
    by = np.linalg.solve(matrix, -here)
    x, entries = unknowns_of(problem), problem.entries
    x[rows] += by * SURROUNDINGS_SIZE
    moved = _problem_at(problem, series, x)
    unknowns_in = entries.values(entries.coordinates(cycle.unknowns_in) + moves.unknowns @ by, cycle.unknowns_in)
    return moved, all_directions.numbers(moved, unknowns_in)[0]


def _implied_changes(of: Evaluation) -> Array:
    """Return the changes of its surroundings [K, kPa] that a cycle implies, in the order of `unknowns_of`."""
    asked = implied_surroundings(of)
    return np.zeros(len(unknowns_of(of.problem))) if asked is None else asked.off


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
    return SideReadings(figures_of(of), _implied_changes(of) if whole else np.empty(0))


def _shift_size(value: float) -> float:
    """Return the size that a number is shifted relative to: its magnitude, or 1 for zero."""
    return abs(value) or 1.0


def _shifted(problem: Problem, series: Series, path: str, value: float) -> Callable[[float], Problem]:
    """Return a function that poses the problem with a number shifted by a share of its size."""
    return lambda by: problem_of(with_values(problem.scene, {path: value + by * _shift_size(value)}), series)


def _open_unknowns(problem: Problem) -> list[int]:
    """Return the indices, in `unknowns_of`, of those that are open: all but temperatures that the scene states."""
    stated = [i for i, each in enumerate(open_temperatures(problem.scene)) if not each]
    return [i for i in range(len(unknowns_of(problem))) if i not in stated]


def _with_surroundings_shifted(problem: Problem, series: Series, i: int) -> Callable[[float], Problem]:
    """Return a function that poses the problem with one of the circuit's unknowns shifted by a share of its size."""

    def posed(by: float) -> Problem:
        x = unknowns_of(problem)
        x[i] += by * SURROUNDINGS_SIZE
        return _problem_at(problem, series, x)

    return posed


def _problem_at(problem: Problem, series: Series, x: Array) -> Problem:
    """Return the problem with the unknowns around its machine at x [K, kPa]."""
    scene, others = problem.scene, x[2:].tolist()
    if any(open_temperatures(scene)):
        scene = with_temperatures(scene, Temperatures(*x[:2].tolist()))
    if scene.losses is not None:
        (before, behind), others = others[:2], others[2:]
        scene = replace(scene, losses=PressureLosses(KPA * before, KPA * behind))
    return problem_of(with_coordinates(scene, others), series)


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
    except (ImpossibleValue, CannotCompile) as error:
        return SceneDerivatives({}, {}, f"the cycle cannot be linearised: {error}")


def _found(scene: Scene, values: Mapping[str, float], fineness: Fineness) -> SceneDerivatives:
    """Solve the scene, collocate its cycle and return the derivatives."""
    series = series_of_one()
    if not fineness.estimated:
        scene = replace(scene, numerics=replace(scene.numerics, error="none"))
    problem, search = steady_state(problem_of(scene, series), series)
    why = _refused(problem)
    if why:
        return SceneDerivatives({}, {}, why)
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


def _refused(problem: Problem) -> str:
    """Return why this method cannot give a problem's derivatives; empty where it can."""
    if problem.parts.shaft is not None:
        return DRIVEN
    if at_an_end(problem.scene):
        return AT_END
    return ONE_CHAMBER if problem.composition.chambers == 1 else ""


class CycleResponse(NamedTuple):
    """The response of the cycle to one number or several: states, cells, quadratures, and unknowns in coordinates.

    Several have a column each. `life` returns the response of the dense output, numbers first; it is computed on first
    use.
    """

    response: Response
    unknowns: Array
    life: Callable[[], Array]

    def by(self, j: int) -> CycleResponse:
        """Return the response to one of several numbers."""
        return CycleResponse(self.response.of(j), self.unknowns[:, j], lambda: self.life()[j])


def _moved(pitch: CollocatedPitch, response: Response, unknowns: Array) -> CycleResponse:
    """Return the response with its dense output still to be computed."""
    return CycleResponse(response, unknowns, cache(lambda: pitch.life(response.start, response.nodes)))


def responses(cycle: CollocatedCycle, directions: Sequence[Direction], all_directions: Directions) -> CycleResponse:
    """Return the response of the cycle and its unknowns to directions (at least one), a column each."""
    linear, off, pitch = along(cycle, directions), np.zeros((len(cycle.unknowns_in), len(directions))), cycle.pitch
    held = _moved(pitch, linear.by_changes, off.copy())
    own = _coordinates(unshifted_evaluation(cycle, all_directions))
    for j, direction in enumerate(directions):
        image = _coordinates(shifted_evaluation(cycle, direction, held.by(j), all_directions))
        off[:, j] = np.where(linear.given, direction.stated, (image - own) / direction.step)
    unknowns = np.stack([solved_pitch(linear.back, each, linear.given) for each in off.T], axis=-1)
    return _moved(pitch, linear.by_changes.added(linear.by_unknowns.weighted(unknowns)), unknowns)


def _coordinates(of: Evaluation) -> Array:
    """Return the next values of a cycle's unknowns, in coordinates."""
    return of.problem.entries.coordinates(of.image)


def unshifted_evaluation(
    cycle: CollocatedCycle, all_directions: Directions, turn: PeakPlace | None = None
) -> Evaluation:
    """Return the evaluation of the unchanged cycle, read in the same way as one that is `shifted_evaluation`."""
    pitch = cycle.pitch
    pitch.put(all_directions.own[0])
    return Evaluation(
        pitch.problem, ShiftedLife.of(pitch, lambda: pitch.install_life(all_directions.life), turn), cycle.sums
    )


def shifted_evaluation(
    cycle: CollocatedCycle,
    direction: Direction,
    moves: CycleResponse,
    all_directions: Directions,
    turn: PeakPlace | None = None,
) -> Evaluation:
    """Return the evaluation of the cycle after a shift of a number; with a `turn`, its highest pressure is read there.

    The `turn` is that of the unchanged cycle. The evaluation uses the machinery of the
    cycle, so it must be read before that is used for anything else.
    """
    pitch, problem, by = cycle.pitch, direction.problem, direction.step
    at, entries, response = direction.side, problem.entries, moves.response
    if moves.unknowns.any():
        unknowns_in = entries.values(entries.coordinates(cycle.unknowns_in) + by * moves.unknowns, cycle.unknowns_in)
        at = all_directions.meeting(direction, unknowns_in)
    pitch.put_with_cells(at, by, response.cells)

    def fill() -> None:
        edges = direction.change.edges
        edges = pitch.slices.edges if edges is None else pitch.slices.edges + by * edges
        pitch.install_life(all_directions.life + by * moves.life(), edges)

    turning = None
    if turn is not None:
        moved = in_step(pitch, response.start, response.inside, turn.step)
        turning = turn._replace(states=turn.states + by * moved)
    return Evaluation(problem, ShiftedLife.of(pitch, fill, turning), cycle.sums + by * response.sums)


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
