"""Operating points at which nothing is measured yet: those of a file, and how well they would be measured."""

import os
from typing import NamedTuple

import numpy as np

from screwsim.figures import declared
from screwsim.inputs.faults import UsageError
from screwsim.scene import cross_check
from screwsim.scene.yaml_tree import Place, Problem, scene_error
from screwsim.study.calibration.data import read_points
from screwsim.study.calibration.fit import Fit, Point


class Typical(NamedTuple):
    """How well a figure is measured: a standard uncertainty [SI], of temperatures, or a share of the value."""

    size: float
    share: bool

    def of(self, value: float) -> float:
        """Return the standard uncertainty [SI] of a value [SI]."""
        return self.size * abs(value) if self.share else self.size


def points_of(fit: Fit, file: str | os.PathLike[str], option: str, what: str) -> tuple[Point, ...]:
    """Return the points of a CSV file that names conditions, and of figures at least how well they would be measured.

    `option` is the one by which the file was named. Raises SceneError with a line a fault, UsageError.
    """
    if not os.path.isfile(file):
        raise UsageError(f"{option} {file}: is not a file (name an existing one)")
    problems: list[Problem] = []
    name, values = os.fspath(file), fit.first_start()
    rows = read_points(name, name, fit.scene, list(fit.changes(values)), problems, candidates=True)
    for point, place in rows:
        problems += [Problem(place, fault.path, fault.what) for fault in cross_check(fit.at(point, values))]
    if not rows and not problems:
        problems.append(Problem(Place(1, name), "", f"has no {what}"))
    if problems:
        raise scene_error(problems)
    return tuple(point for point, _ in rows)


def typical(fit: Fit) -> dict[str, Typical]:
    """Return how well the fit's points measure each figure: the median share; of temperatures the median itself."""
    found = {}
    every = [(name, one) for point in fit.points for name, one in point.measured.items()]
    for name in dict.fromkeys(name for name, _ in every):
        share = declared(name).units != "K"
        sizes = [
            one.uncertainty / (abs(one.value) if share else 1.0) for key, one in every if key == name and one.value
        ]
        if sizes:
            found[name] = Typical(float(np.median(sizes)), share)
    return found
