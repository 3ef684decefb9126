"""What a fit asks: parameters with bounds, measured points with uncertainties; all in SI units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from screwsim.scene import Scene, with_values

EXACT, DIFFERENCES = "exact", "differences"  # how slopes are found


class Tie(NamedTuple):
    """A path that follows a parameter: factor · value + offset [SI]."""

    path: str
    factor: float
    offset: float


class Prior(NamedTuple):
    """What is known of a parameter beforehand: mean and standard deviation [SI]."""

    mean: float
    deviation: float

    def off(self, value: float) -> float:
        """Return by how many standard deviations a value [SI] is off."""
        return (value - self.mean) / self.deviation

    def slope(self) -> float:
        """Return by how much that grows with the value [1/SI]."""
        return 1.0 / self.deviation


class Measured(NamedTuple):
    """A measured figure with its standard uncertainty [SI]."""

    value: float
    uncertainty: float


@dataclass(frozen=True)
class Parameter:
    """One unknown: its path in the scene, bounds [SI], and what else is known."""

    path: str
    low: float
    high: float
    start: float | None = None
    prior: Prior | None = None
    logarithmic: bool = False
    ties: tuple[Tie, ...] = ()

    def value(self, place: float) -> float:
        """Return the value [SI] at a place between the bounds, 0 … 1."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** place
        return self.low + (self.high - self.low) * place

    def place(self, value: float) -> float:
        """Return where between the bounds a value [SI] lies, 0 … 1."""
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def slope(self, value: float) -> float:
        """Return by how much the value [SI] grows per unit of place."""
        return value * math.log(self.high / self.low) if self.logarithmic else self.high - self.low

    def values(self, value: float) -> dict[str, float]:
        """Return the values [SI] of the path and of those that follow it."""
        return {self.path: value, **{tie.path: tie.factor * value + tie.offset for tie in self.ties}}


@dataclass(frozen=True)
class Point:
    """One operating point: values [SI] by scene path, and what was measured there; `fitted` False: only predicted."""

    name: str
    values: Mapping[str, Any]
    measured: Mapping[str, Measured]
    fitted: bool = True


@dataclass(frozen=True)
class Fit:
    """The whole question. `scene` has no sweep and the accuracy that the fit asks of each solution."""

    title: str
    name: str  # of the file
    scene: Scene
    scene_file: str
    parameters: tuple[Parameter, ...]
    points: tuple[Point, ...]
    starts: int = 8
    seed: int = 1
    slopes: str = DIFFERENCES

    def machine(self, values: Mapping[str, float]) -> Scene:
        """Return the scene with other values [SI] of the parameters."""
        return with_values(self.scene, self.changes(values))

    def changes(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return every path that values [SI] of the parameters change, those that follow included."""
        found: dict[str, float] = {}
        for parameter in self.parameters:
            found |= parameter.values(values[parameter.path])
        return found

    def at(self, point: Point, values: Mapping[str, float]) -> Scene:
        """Return the scene of an operating point with other values [SI] of the parameters."""
        return with_values(self.machine(values), point.values)

    def short_names(self) -> list[str]:
        """Return the last words of the parameters' paths, as many as tell them apart."""
        paths = [each.path.split(".") for each in self.parameters]
        ends = [path[-1] for path in paths]
        return [".".join(path[-2:]) if ends.count(path[-1]) > 1 else path[-1] for path in paths]

    def first_start(self) -> dict[str, float]:
        """Return the stated starts [SI], the middle of the bounds where none is stated."""
        return {each.path: each.value(0.5) if each.start is None else each.start for each in self.parameters}
