"""What surrounds the machine and follows from its cycle, as further numbers of the scene to differentiate by.

They are those that `solve.surroundings` finds (temperatures of the oil's circuit, losses of a package, what a scene
leaves open), and the mean speed where it follows from the motor's characteristic. Each is a coordinate in kelvin or
kilopascal.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from screwsim.build import Temperatures, open_temperatures, with_temperatures
from screwsim.build.open_values import coordinate_ranges, ends, with_coordinates
from screwsim.cycle.problem import Problem, Series, problem_of
from screwsim.derivatives.collocated_cycle import NotClosed
from screwsim.effects.base import PressureLosses
from screwsim.evaluate.evaluation import Evaluation
from screwsim.machine.drive.response import NoMotion, Response
from screwsim.scene import Scene, with_values
from screwsim.scene.operation import SPEED
from screwsim.solve.surroundings import KPA, implied_surroundings, unknowns_of

Array = np.ndarray
SIZE = 100.0  # [K, kPa] that a coordinate is shifted relative to
SPEED_SCALE = 100.0  # [K] of the speed's coordinate that make a factor e of it


def speed_follows(problem: Problem) -> bool:
    """Return whether the mean speed follows from a motor's characteristic."""
    return problem.parts.set_speed is not None


def coordinates(problem: Problem) -> Array:
    """Return where a problem stands [K, kPa]: what `unknowns_of` gives, then the speed where it follows."""
    speed = [SPEED_SCALE * math.log(problem.parts.omega)] if speed_follows(problem) else []
    return np.append(unknowns_of(problem), speed)


def open_coordinates(problem: Problem) -> list[int]:
    """Return the indices of coordinates that respond: not stated temperatures, nor what is at an end of its range."""
    scene = problem.scene
    held = [i for i, is_open in enumerate(open_temperatures(scene)) if not is_open]
    others = 2 if scene.losses is None else 4
    held += [i for i, span in enumerate(ends(scene), others) if span is not None]
    return [i for i in range(len(coordinates(problem))) if i not in held]


def moves_an_end(problem: Problem, other: Problem) -> bool:
    """Return whether a coordinate is at an end of its range that is elsewhere for another problem."""
    pairs = zip(ends(problem.scene), coordinate_ranges(other.scene), strict=True)
    return any(span is not None and span != there for span, there in pairs)


def implied_changes(of: Evaluation) -> Array:
    """Return the changes of the coordinates [K, kPa] that a cycle implies; zeros where gas and oil do not separate."""
    problem, asked = of.problem, implied_surroundings(of)
    off = np.zeros(len(unknowns_of(problem))) if asked is None else asked.off
    if not speed_follows(problem):
        return off
    return np.append(off, SPEED_SCALE * math.log(motion_of(of).mean_speed / problem.parts.omega))


def motion_of(of: Evaluation) -> Response:
    """Return the motion of the drive under a cycle's torque; raise NotClosed where it has none."""
    part = of.problem.parts.shaft
    assert part is not None  # asked only where there is a drive
    try:
        return part.respond(of.complete)
    except NoMotion as reason:
        raise NotClosed(str(reason)) from None


def problem_at(problem: Problem, series: Series, x: Array) -> Problem:
    """Return the problem with its coordinates at x [K, kPa]."""
    scene, others = problem.scene, x[2:].tolist()
    if any(open_temperatures(scene)):
        scene = with_temperatures(scene, Temperatures(*x[:2].tolist()))
    if scene.losses is not None:
        (before, behind), others = others[:2], others[2:]
        scene = replace(scene, losses=PressureLosses(KPA * before, KPA * behind))
    if speed_follows(problem):
        scene = replace(scene, operation=replace(scene.operation, speed=math.exp(others.pop() / SPEED_SCALE)))
    return _posed(problem, series, with_coordinates(scene, others))


def coordinate_shifted(problem: Problem, series: Series, i: int) -> Callable[[float], Problem]:
    """Return a function that poses the problem with a coordinate shifted by a share of `SIZE`."""

    def posed(by: float) -> Problem:
        x = coordinates(problem)
        x[i] += by * SIZE
        return problem_at(problem, series, x)

    return posed


def number_shifted(problem: Problem, series: Series, path: str, value: float) -> Callable[[float], Problem]:
    """Return a function that poses the problem with a number of its scene shifted by a share of its size."""

    def posed(by: float) -> Problem:
        moved = value + by * shift_size(value)
        if path == SPEED and speed_follows(problem):
            return problem_of(problem.scene, series, moved)
        return _posed(problem, series, with_values(problem.scene, {path: moved}))

    return posed


def shift_size(value: float) -> float:
    """Return the size that a number is shifted relative to: its magnitude, or 1 for zero."""
    return abs(value) or 1.0


def _posed(problem: Problem, series: Series, scene: Scene) -> Problem:
    return problem_of(scene, series, problem.parts.set_speed)
