"""The question of a fit: parameters with bounds, measured points with uncertainties; all in SI units."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from screwsim.figures.curves import reading_of
from screwsim.outputs.display import distinct_words
from screwsim.scene import Scene, value_at, with_values
from screwsim.scene.types import COVERAGE
from screwsim.study.asked.spans import place_between, value_between

EXACT, DIFFERENCES = "exact", "differences"  # how slopes are found
TOLERANCE_REMEDY = "prior from the scene's tolerance"
# correlation within a group of correlated parameters: with 1 the density would have no width across
GROUP_CORRELATION = 0.999
LEAST_PRIOR_VALUE = 1e-9  # of the mean of a logarithmic prior: smallest value, as bounds may begin at zero
SMALLEST, LARGEST = 1e-9, 1e9  # of a value: uncertainties outside are implausible or carry no information


class Tie(NamedTuple):
    """A path that follows a parameter: factor · value + offset [SI]."""

    path: str
    factor: float
    offset: float


class Prior(NamedTuple):
    """Prior of a parameter: normal with this mean and standard deviation [SI].

    `logarithmic`: the logarithm is normal about that of the mean, and the deviation is that of the logarithm.
    `of_scene`: the prior is the scene's tolerance, not the fit's own.
    """

    mean: float
    deviation: float
    logarithmic: bool = False
    of_scene: bool = False

    def off(self, value: float) -> float:
        """Return by how many standard deviations a value [SI] is off the mean."""
        off = math.log(max(value / self.mean, LEAST_PRIOR_VALUE)) if self.logarithmic else value - self.mean
        return off / self.deviation

    def slope(self, value: float) -> float:
        """Return the derivative of `off` by the value [1/SI]."""
        return 1.0 / self.deviation_at(value)

    def deviation_at(self, value: float) -> float:
        """Return the standard deviation [SI] around a value [SI]; for a logarithmic prior that of small changes."""
        return self.deviation * max(value, LEAST_PRIOR_VALUE * self.mean) if self.logarithmic else self.deviation

    @property
    def spread(self) -> float:
        """Standard deviation [SI] of the whole distribution."""
        if not self.logarithmic:
            return self.deviation
        square = self.deviation**2
        return self.mean * math.exp(0.5 * square) * math.sqrt(math.expm1(square))

    @property
    def tolerance(self) -> float:
        """Half of the 95 % interval [SI], or for a logarithmic prior its factor up and down, as scenes state it."""
        return math.exp(COVERAGE * self.deviation) if self.logarithmic else COVERAGE * self.deviation


class Measurement(NamedTuple):
    """A measured figure with its standard uncertainty [SI]."""

    value: float
    uncertainty: float


@dataclass(frozen=True)
class Parameter:
    """One unknown: its path in the scene, bounds [SI], and prior knowledge.

    `unheld`: it has no prior even where the scene states a tolerance (`prior: none`).
    """

    path: str
    low: float
    high: float
    start: float | None = None
    prior: Prior | None = None
    logarithmic: bool = False
    ties: tuple[Tie, ...] = ()
    unheld: bool = False

    def value(self, place: float) -> float:
        """Return the value [SI] at a place between the bounds, 0 … 1."""
        return value_between(self.low, self.high, place, self.logarithmic)

    def place(self, value: float) -> float:
        """Return the place 0 … 1 of a value [SI] between the bounds."""
        return place_between(self.low, self.high, value, self.logarithmic)

    def slope(self, value: float) -> float:
        """Return the derivative of the value [SI] by the place."""
        return value * math.log(self.high / self.low) if self.logarithmic else self.high - self.low

    def values(self, value: float) -> dict[str, float]:
        """Return the values [SI] of the path and of those that follow it."""
        return {self.path: value, **{tie.path: tie.factor * value + tie.offset for tie in self.ties}}


def odd_uncertainty(value: float, own: float) -> str:
    """Return why an uncertainty is implausible for a value, in one unit, with the remedy; '' where it is plausible."""
    size = abs(value)
    if SMALLEST * size <= own <= LARGEST * size or not size > 0.0:
        return ""
    what = "smaller than any measurement achieves" if own < size else "too large to be of use"
    remedy = "state one standard uncertainty, in the unit of the column, or write (k=2) behind the column's unit"
    return f"its uncertainty is {own / size:.1g} of the value, {what} ({remedy})"


def prior_of(scene: Scene, parameter: Parameter) -> Prior | None:
    """Return the prior of a parameter: its own, or the tolerance that the scene states for it; None without either."""
    tolerance = scene.uncertain.get(parameter.path)
    if parameter.prior is not None or parameter.unheld or tolerance is None:
        return parameter.prior
    value = float(value_at(scene, parameter.path))
    return Prior(value, tolerance.around(value).standard, tolerance.factor, of_scene=True)


@dataclass(frozen=True)
class Point:
    """One operating point: values [SI] by scene path, and measurements; `fitted` False: only predicted."""

    name: str
    values: Mapping[str, Any]
    measured: Mapping[str, Measurement]
    fitted: bool = True

    @property
    def traced(self) -> bool:
        """Whether curves at angles are measured, which are read from the cycle."""
        return any(reading_of(name) is not None for name in self.measured)


@dataclass(frozen=True)
class Fit:
    """The whole question. `scene` has no sweep, and the accuracy that the fit requires of each solution.

    `together` are groups of parameters, by index, with correlated priors (`with_priors`).
    """

    title: str
    name: str  # name of the file
    scene: Scene
    scene_file: str
    parameters: tuple[Parameter, ...]
    points: tuple[Point, ...]
    starts: int = 8
    seed: int = 1
    slopes: str = DIFFERENCES
    together: tuple[tuple[int, ...], ...] = ()

    @property
    def fitted(self) -> tuple[Point, ...]:
        """The points that are fitted; all others are only predicted."""
        return tuple(point for point in self.points if point.fitted)

    @property
    def held(self) -> dict[int, Prior]:
        """The priors of the parameters that have one, by index."""
        return {i: each.prior for i, each in enumerate(self.parameters) if each.prior is not None}

    @cached_property
    def whitener(self) -> NDArray[np.float64]:
        """Matrix W that decorrelates the deviations of the held parameters, in standard deviations.

        WᵀW is the inverse of their correlation matrix: `GROUP_CORRELATION` within a group, else 0.
        """
        correlation = np.eye(len(self.held))
        for group in self.together:
            rows = [list(self.held).index(i) for i in group]
            correlation[np.ix_(rows, rows)] = GROUP_CORRELATION
            correlation[rows, rows] = 1.0
        return np.asarray(np.linalg.inv(np.linalg.cholesky(correlation)), float)

    def machine(self, values: Mapping[str, float]) -> Scene:
        """Return the scene with other values [SI] of the parameters."""
        return with_values(self.scene, self.changes(values))

    def changes(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return every path that values [SI] of the parameters change, including those that follow."""
        found: dict[str, float] = {}
        for parameter in self.parameters:
            found |= parameter.values(values[parameter.path])
        return found

    def at(self, point: Point, values: Mapping[str, float]) -> Scene:
        """Return the scene of an operating point with other values [SI] of the parameters."""
        return with_values(self.machine(values), point.values)

    def with_priors(self) -> Self:
        """Return the fit with the scene's tolerances as priors of parameters that have none."""
        parameters = tuple(replace(each, prior=prior_of(self.scene, each)) for each in self.parameters)
        of_scene = [(i, each.path) for i, each in enumerate(parameters) if each.prior and each.prior.of_scene]
        groups = (tuple(i for i, path in of_scene if path in group) for group in self.scene.correlated)
        return replace(self, parameters=parameters, together=tuple(group for group in groups if len(group) > 1))

    def places(self, values: Mapping[str, float]) -> NDArray[np.float64]:
        """Return the places 0 … 1 of values [SI] of the parameters between their bounds."""
        return np.array([parameter.place(values[parameter.path]) for parameter in self.parameters])

    def short_names(self) -> dict[str, str]:
        """Return short names of the parameters by path: the words that tell them apart."""
        paths = [parameter.path for parameter in self.parameters]
        return dict(zip(paths, map(".".join, distinct_words(paths)), strict=True))

    def first_start(self) -> dict[str, float]:
        """Return the stated starts [SI], the middle of the bounds where none is stated."""
        return {each.path: each.value(0.5) if each.start is None else each.start for each in self.parameters}
