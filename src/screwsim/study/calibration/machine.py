"""The unchanged machine of a fit, the response of its points to inputs, and points that are not measured yet."""

import os
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from screwsim.figures import declared
from screwsim.inputs.declare import FoundWithCycle
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.outputs.display import grouped
from screwsim.scene import Scene, cross_check, value_at, with_values
from screwsim.scene.yaml_tree import LocatedFault, LocatedFaults, Position
from screwsim.study.calibration.data import read_points
from screwsim.study.calibration.fit import DIFFERENCES, EXACT, Fit, Point
from screwsim.study.calibration.residuals import Array, Simulate
from screwsim.study.pool.solving import simulator
from screwsim.study.uncertainty.point import sensitivities
from screwsim.study.uncertainty.spreads import groups_of

Group = tuple[str, ...]  # paths of correlated inputs, one or more


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
    known = {path for i in fit.held for path in fit.parameters[i].values(0.0)}
    groups = (tuple(path for path in group if path not in known) for group in groups_of(machine))
    return tuple(group for group in groups if group), priors


def residual_shifts(scene: Scene, point: Point, groups: Sequence[Group], result: Result | None = None) -> list[Array]:
    """Return the changes of a point's residuals by one standard uncertainty of each group of correlated inputs.

    The scene is that of the point; it is solved where its `result` is not known. Raises UsageError for an input without
    a derivative: what it does must not count as nothing.
    """
    if not groups:
        return []
    paths = [path for group in groups for path in group]
    found = sensitivities(scene, paths, list(point.measured), fine=False, result=result)
    lost = next((path for path in paths if path not in found.values), "")
    if lost and found.result.status == "ok":
        why = f"has a tolerance, but no derivative at {point.name}: {found.left_out.get(lost, 'not known')}"
        raise UsageError(f"{lost}: {why} (write its value without a tolerance)")
    every = []
    for group in groups:
        total = np.zeros(len(point.measured))
        for path in group:
            standard = scene.uncertain[path].standard_at(float(value_at(scene, path)))
            for row, (figure, measured) in enumerate(point.measured.items()):
                total[row] += found.derivatives.get(figure, {}).get(path, 0.0) * standard / measured.uncertainty
        every.append(total)
    return every


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
    for point, place in rows:
        problems += [LocatedFault(place, fault.path, fault.what) for fault in cross_check(fit.at(point, values))]
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
