"""What surrounds a machine and follows from its cycle: the unknowns, what a cycle implies of them, what a scene states.

Unknowns are the temperatures of the oil's circuit (M284), a package's losses (M343) and other open numbers of a scene
(`build.open_values`), in kelvin and kilopascal.
"""

from dataclasses import fields, is_dataclass, replace
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from screwsim.build import open_temperatures, open_values, package_of, separator_effects
from screwsim.cycle.problem import Problem
from screwsim.effects.base import CoolsOil, LosesPressure
from screwsim.evaluate.evaluation import Evaluation
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.scene.lines import lines

Array = np.ndarray
KPA = 1e3  # [Pa], the unit of lost pressures that weighs as much as 1 K


class ImpliedSurroundings(NamedTuple):
    """The surroundings that a cycle implies, relative to those it was closed with.

    `off` [K, kPa] are the differences of the unknowns, `share` is the response of the separator temperature to the
    supply's, `open` the residual over the shaft power or over a pressure, `free` the unknowns that are not held at an
    end of their range.
    """

    off: Array
    share: float
    open: float
    free: Array


def unknowns_of(problem: Problem) -> Array:
    """Return where a problem stands: supply and separator [K], lost pressures [kPa], other open numbers."""
    T = _oil_temperature(problem)
    asked = (one.separator_temperature for one in separator_effects(problem.scene))
    lost = () if problem.scene.losses is None else (each / KPA for each in problem.scene.losses)
    stands = (each for each in open_values.current_coordinates(problem.scene) if each is not None)
    return np.array([T, next((at for at in asked if at is not None), T), *lost, *stands], float)


def implied_surroundings(of: Evaluation) -> ImpliedSurroundings | None:
    """Return the surroundings that a cycle implies; None where gas and oil do not separate."""
    circuit, package, both = of.circuit, of.package, all(open_temperatures(of.problem.scene))
    if isinstance(circuit, str):
        return None
    off, share, open_ = [0.0, 0.0], 0.0, 0.0
    held: list[bool] = []
    if circuit is not None:
        off, share, open_ = [circuit.supply, circuit.separator], circuit.parted.share if both else 0.0, circuit.open
    if package is not None:
        off, open_ = [*off, package.before / KPA, package.behind / KPA], max(open_, package.open)
    if open_values.has_open_values(of.problem.scene):
        others = _implied_open_values(of)
        if others is None:
            return None
        off, open_ = [*off, *(each.off for each in others)], max(open_, *(each.open for each in others))
        held = [each.held for each in others]
    free = np.array([True] * (len(off) - len(held)) + [not each for each in held])
    return ImpliedSurroundings(np.array(off), share, open_, free)


def _implied_open_values(of: Evaluation) -> list[open_values.CoordinateChange] | None:
    """Return what a cycle implies for the scene's other open numbers; None where that is undefined."""
    scene = of.problem.scene
    return open_values.required_changes(scene, of.figures, _oil_temperature(of.problem), open_temperatures(scene)[0])


def _oil_temperature(problem: Problem) -> float:
    """Return the oil's supply temperature [K], 0 without oil."""
    return 0.0 if problem.parts.oil is None else problem.parts.oil.temperature


def open_values_residual(of: Evaluation) -> float:
    """Return the relative residual of a scene's other open numbers; 0 where it has none."""
    asked = _implied_open_values(of) if open_values.has_open_values(of.problem.scene) else None
    return max((each.open for each in asked or ()), default=0.0)


def surroundings_follow(problem: Problem) -> bool:
    """Return whether anything around the machine follows from its cycle."""
    scene = problem.scene
    return any(open_temperatures(scene)) or package_of(scene) is not None or open_values.has_open_values(scene)


def stated_numbers(problem: Problem) -> Array:
    """Return the parameters of a problem, the numbers of circuit and package, and the lines' pressures without losses.

    Some numbers enter the circuit alone, as the temperature that a thermostat keeps.
    """
    scene = problem.scene
    at = problem.lines if scene.losses is None else lines(replace(scene, losses=None))
    around = (one.parameters for one in scene.effects.values() if isinstance(one.parameters, CoolsOil | LosesPressure))
    stated = [number for section in around for number in _numbers_of(section)]
    return np.concatenate([problem.parameters, (at.p_s, at.p_d), stated])


@IdentityCache
def _numbers_of(section: Any) -> tuple[float, ...]:
    """Return the numbers that a section of a scene states, and the sections in it."""
    values = [getattr(section, each.name) for each in fields(section)]
    found = ((each,) if isinstance(each, float) else _numbers_of(each) if is_dataclass(each) else () for each in values)
    return tuple(chain.from_iterable(found))
