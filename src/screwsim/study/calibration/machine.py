"""The unchanged machine of a fit, the response of its points to inputs, and points that are not measured yet."""

import os
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from screwsim.figures import declared
from screwsim.inputs.declare import FoundWithCycle
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.outputs.display import grouped
from screwsim.scene import Scene, value_at, with_values
from screwsim.scene.yaml_tree import LocatedFaults, Position
from screwsim.study.calibration.data import point_faults, read_points
from screwsim.study.calibration.fit import DIFFERENCES, EXACT, Fit, Point
from screwsim.study.calibration.residuals import Array, Simulate
from screwsim.study.pool.solving import simulator
from screwsim.study.uncertainty.point import slopes_by_inputs
from screwsim.study.uncertainty.spreads import groups_of

Group = tuple[str, ...]  # paths of correlated inputs, one or more
NO_DERIVATIVE = "a curve at an angle has no exact derivative"


def unchanged_fit(fit: Fit, simulate: Simulate | None) -> tuple[Fit, dict[str, float]]:
    """Return the fit of the unchanged machine without priors, ready for workers, and its parameters [SI].

    Its slopes are exact unless `simulate` is given.
    """
    before = {}
    for parameter in fit.parameters:
        stated = value_at(fit.scene, parameter.path) if parameter.prior is None else parameter.prior.mean
        if not isinstance(stated, int | float) or isinstance(stated, FoundWithCycle):
            raise UsageError(f"{parameter.path}: is not stated in the scene (state its unchanged value there)")
        if not parameter.low <= stated <= parameter.high:
            why = f"is {stated:.6g} [SI] unchanged, outside its bounds {parameter.low:.6g} … {parameter.high:.6g}"
            raise UsageError(f"{parameter.path}: {why} (widen from and to, within which it may have changed)")
        before[parameter.path] = float(stated)
    bare = tuple(replace(parameter, prior=None) for parameter in fit.parameters)
    slopes = EXACT if simulate is None else DIFFERENCES
    found = replace(fit, scene=fit.machine(before), parameters=bare, slopes=slopes)
    prepare(found, simulate)
    return found, before


def prepare(fit: Fit, simulate: Simulate | None) -> None:
    """Compile what the points need, before workers are forked."""
    if simulate is None and fit.points:
        simulator(with_values(fit.scene, fit.points[0].values))


def inputs_of(fit: Fit, machine: Scene) -> tuple[tuple[Group, ...], dict[Group, float]]:
    """Return the groups of the scene's inputs with a tolerance, and deviations [SI] of parameters by their priors.

    A parameter's prior replaces the tolerances of its path and of those that follow it.
    """
    priors: dict[Group, float] = {(fit.parameters[i].path,): prior.deviation for i, prior in fit.held.items()}
    return groups_without(
        groups_of(machine), {path for i in fit.held for path in fit.parameters[i].values(0.0)}
    ), priors


def groups_without(groups: Iterable[Group], paths: Container[str]) -> tuple[Group, ...]:
    """Return the groups without some of their paths, and none that is empty then."""
    rest = (tuple(path for path in group if path not in paths) for group in groups)
    return tuple(group for group in rest if group)


class PointShifts(NamedTuple):
    """Changes of a point's residuals (n,) by one standard uncertainty of each input, and why some inputs have none."""

    by_path: Mapping[str, Array]
    left_out: Mapping[str, str]

    def of(self, groups: Sequence[Group]) -> list[Array]:
        """Return the changes by groups of correlated inputs."""
        return [np.sum([self.by_path[path] for path in group], axis=0) for group in groups]


NO_SHIFTS = PointShifts({}, {})


def point_shifts(scene: Scene, point: Point, groups: Sequence[Group], result: Result | None = None) -> PointShifts:
    """Return how the inputs of these groups shift the residuals of a point with a solution.

    The scene is that of the point; it is solved where its `result` is not known.
    """
    if not groups:
        return NO_SHIFTS
    if point.traced:
        return PointShifts({}, dict.fromkeys(chain(*groups), f"at {point.name}: {NO_DERIVATIVE}"))
    found = slopes_by_inputs(scene, list(chain(*groups)), list(point.measured), result=result)
    over = np.array([measured.uncertainty for measured in point.measured.values()])
    by_path = {}
    for path, value in found.values.items():
        slopes = np.array([found.derivatives.get(figure, {}).get(path, 0.0) for figure in point.measured])
        by_path[path] = slopes * scene.uncertain[path].standard_at(value) / over
    return PointShifts(by_path, {path: f"at {point.name}: {why}" for path, why in found.left_out.items()})


def known_everywhere(
    groups: Sequence[Group], points: Iterable[PointShifts]
) -> tuple[tuple[Group, ...], dict[str, str]]:
    """Return the groups without the inputs that lack a derivative at a point, and those inputs, and why.

    What such an input does at the other points must not count as all that it does.
    """
    left_out: dict[str, str] = {}
    for point in points:
        left_out = {**point.left_out, **left_out}
    return groups_without(groups, left_out), left_out


class TypicalUncertainty(NamedTuple):
    """Usual standard uncertainty of a figure: an absolute one [SI] for temperatures, else a share of the value."""

    size: float
    share: bool

    def of(self, value: float) -> float:
        """Return the standard uncertainty [SI] of a value [SI]."""
        return self.size * abs(value) if self.share else self.size


def points_of(fit: Fit, file: str | os.PathLike[str], option: str, what: str) -> tuple[Point, ...]:
    """Return the points of a CSV file with conditions, and with at least the uncertainty of each figure listed.

    `option` is the one that named the file. Raises SceneError with one line per fault, UsageError.
    """
    if not os.path.isfile(file):
        raise UsageError(f"{option} {file}: is not a file (name an existing one)")
    problems = LocatedFaults()
    name, values = os.fspath(file), fit.first_start()
    rows = read_points(name, name, fit.scene, list(fit.changes(values)), problems, candidates=True)
    problems += point_faults((fit.at(point, values), place) for point, place in rows)
    if not rows and not problems:
        problems.add(Position(1, name), "", f"has no {what}")
    if problems:
        raise problems.error()
    return tuple(point for point, _ in rows)


def typical_uncertainties(fit: Fit) -> dict[str, TypicalUncertainty]:
    """Return the usual uncertainty of each figure at the fit's points: the median share, or for temperatures [K]."""
    found = {}
    for name, every in grouped(each for point in fit.points for each in point.measured.items()).items():
        share = declared(name).units != "K"
        sizes = [one.uncertainty / (abs(one.value) if share else 1.0) for one in every if one.value]
        if sizes:
            found[name] = TypicalUncertainty(float(np.median(sizes)), share)
    return found
