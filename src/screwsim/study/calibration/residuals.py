"""Residuals of a fit, over their uncertainties, and their slopes over each parameter.

A solution that fails or does not close never enters as NaN: its figures count as further off than any solved ones, so
that the search turns back, and a difference across it is taken to the other side.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from screwsim.derivatives.collocation import QUICK
from screwsim.derivatives.solving import SceneDerivatives, scene_derivatives
from screwsim.figures.curves import with_readings
from screwsim.outputs import Figures, Result
from screwsim.study.calibration.fit import EXACT, Fit, Measurement, Parameter, Point
from screwsim.study.pool.parallel import WarmSimulation
from screwsim.study.pool.solving import Simulate, simulated_if_valid

Array = NDArray[np.float64]
PENALTY = 1e4  # [uncertainties] least residual of a figure without a solution
PENALTY_FACTOR = 10.0  # times the measured value: least difference of a figure without a solution
EXACT_OPTION = "slopes: exact takes derivatives"
DIFFERENCE_STEP = 0.01  # of the bounds' distance, to each side: far above the solver's noise


@dataclass(frozen=True)
class Residuals:
    """Outcome of one set of parameters: residuals of fitted points and priors, results by point, reasons of failures.

    `unsolved` marks the residuals of figures without a solution.
    """

    residuals: Array
    results: Mapping[str, Result]  # by name of the fitted point; without figures where it failed
    reasons: Mapping[str, str]  # by name of the point
    unsolved: NDArray[np.bool_]

    @property
    def known(self) -> Array:
        """Return the residuals, those of figures without a solution as zero."""
        return np.where(self.unsolved, 0.0, self.residuals)

    @property
    def chi_squared(self) -> float:
        """Return the sum of squares of the solved residuals: penalties do not measure a fit."""
        return float(np.sum(self.residuals[~self.unsolved] ** 2))


@dataclass
class Objective:
    """Residuals over places 0 … 1 between the bounds; counts solutions and remembers the best set."""

    fit: Fit
    simulate: Simulate | None = None
    note: Path | None = None  # where the best set so far is written
    solutions: int = 0
    failed: int = 0
    best: tuple[float, Array, Residuals] | None = None
    jacobians: int = 0
    methods: dict[str, str] = field(default_factory=dict)  # by path: why the last slopes are differences, '' if exact
    _last: tuple[bytes, Residuals] | None = None
    _slopes: tuple[tuple[bytes, int], Array] | None = None
    _warm: dict[str, Simulate] = field(default_factory=dict)

    def values(self, places: Array) -> dict[str, float]:
        """Return the parameters [SI] at places."""
        inside = np.clip(places, 0.0, 1.0)
        return {each.path: each.value(float(place)) for each, place in zip(self.fit.parameters, inside, strict=True)}

    def outcome(self, places: Array) -> Residuals:
        """Return residuals and figures of the fitted points."""
        if self._last is not None and self._last[0] == places.tobytes():
            return self._last[1]
        values = self.values(places)
        found = {point.name: self.solved(point, values) for point in self.fit.fitted}
        pairs = ((found[point.name].performance, point.measured.items()) for point in self.fit.fitted)
        every = [(figures.get(name), one) for figures, measured in pairs for name, one in measured]
        residuals = [_residual(value, measured) for value, measured in every]
        unsolved = [value is None for value, _ in every] + [False] * len(self.fit.held)
        off = [prior.off(values[self.fit.parameters[i].path]) for i, prior in self.fit.held.items()]
        residuals += (self.fit.whitener @ off).tolist() if self.fit.together else off
        reasons = reasons_of(self.fit.fitted, found)
        outcome = Residuals(np.array(residuals), found, reasons, np.array(unsolved, bool))
        cost = float(np.sum(outcome.residuals**2))
        if self.best is None or cost < self.best[0]:
            self.best = cost, np.array(places), outcome
            if self.note is not None:
                fresh = self.note.with_suffix(".new")
                fresh.write_text(json.dumps([cost, places.tolist(), self.solutions, self.failed]), encoding="utf-8")
                fresh.replace(self.note)
        self._last = places.tobytes(), outcome
        return outcome

    def solved(self, point: Point, values: Mapping[str, float]) -> Result:
        """Return the result of one point, with the curves at angles that are measured there."""
        simulate = self.simulate or self._warm.get(point.name)
        if simulate is None:
            simulate = self._warm[point.name] = WarmSimulation(trace=point.traced)
        result = simulated_if_valid(self.fit.at(point, values), simulate)
        self.solutions += 1
        if result.status != "ok":
            self.failed += 1
            return replace(result, performance=Figures())
        return replace(with_readings(result, point.measured), cycle={}) if point.traced else result

    def slopes(self, places: Array, sides: int = 2) -> Array:
        """Return the slopes of the residuals over the places: exact where possible, else one- or two-sided differences.

        The rows of a figure without a solution are zero.
        """
        if self._slopes is None or self._slopes[0] != (places.tobytes(), sides):
            outcome, values = self.outcome(places), self.values(places)
            self.jacobians += 1
            pairs = ((point, outcome.results[point.name].performance) for point in self.fit.fitted)
            rows = [self.point_slopes(point, places, figures, sides) for point, figures in pairs]
            priors = np.zeros((len(self.fit.held), len(places)))
            for row, (index, prior) in enumerate(self.fit.held.items()):
                each = self.fit.parameters[index]
                priors[row, index] = prior.slope(values[each.path]) * each.slope(values[each.path])
            rows.append(np.asarray(self.fit.whitener @ priors, float) if self.fit.together else priors)
            self._slopes = (places.tobytes(), sides), np.vstack(rows)
        return self._slopes[1]

    def apart(self, slopes: Array) -> Array:
        """Return slopes of all residuals as they would be with uncorrelated priors."""
        if not self.fit.together:
            return slopes
        priors = np.asarray(np.linalg.solve(self.fit.whitener, slopes[-len(self.fit.held) :]), float)
        return np.vstack([slopes[: -len(self.fit.held)], priors])

    def point_slopes(self, point: Point, places: Array, figures: Figures, sides: int = 2) -> Array:
        """Return the slopes (figures, places) of a point's residuals; `figures` are those at the places."""
        values, names = self.values(places), tuple(point.measured)
        solved = np.array([figures.get(name) is not None for name in names])
        if not solved.any():
            return np.zeros((len(names), len(places)))
        exact = SceneDerivatives({}, {}, EXACT_OPTION)
        if self.fit.slopes == EXACT:
            self.solutions += 1
            exact = scene_derivatives(self.fit.at(point, values), self.fit.changes(values), QUICK)
        columns = []
        for index, parameter in enumerate(self.fit.parameters):
            column, why = exact_column(parameter, values[parameter.path], point, exact)
            if column is None:
                column = self._differences(point, places, index, figures, sides)
            self.methods[parameter.path] = why or self.methods.get(parameter.path, "")
            columns.append(np.where(solved, column, 0.0))
        return np.column_stack(columns) if columns else np.zeros((len(names), 0))

    def _differences(self, point: Point, places: Array, index: int, here: Figures, sides: int) -> Array:
        """Return the slopes of a point's residuals over one place; zero where there is no second solution."""
        known = [(float(places[index]), here)]
        for sign in (1.0, -1.0) if places[index] < 0.5 else (-1.0, 1.0):
            moved = np.array(places)
            moved[index] += sign * DIFFERENCE_STEP
            if 0.0 <= moved[index] <= 1.0 and len(known) <= sides:
                known.append((float(moved[index]), self.solved(point, self.values(moved)).performance))
        column = np.zeros(len(point.measured))
        for row, (name, measured) in enumerate(point.measured.items()):
            pairs = sorted((place, each[name]) for place, each in known if each.get(name) is not None)
            if len(pairs) > 1:
                column[row] = (pairs[-1][1] - pairs[0][1]) / (pairs[-1][0] - pairs[0][0]) / measured.uncertainty
        return column


def reasons_of(points: Iterable[Point], results: Mapping[str, Result]) -> dict[str, str]:
    """Return why points have no result, or lack figures that are measured there, by their names."""
    why = {point.name: results[point.name].why_not(point.measured) for point in points}
    return {name: reason for name, reason in why.items() if reason}


def _residual(value: float | None, measured: Measurement) -> float:
    """Return by how many uncertainties a figure is off; more than any other for one without a solution."""
    if value is None:
        return max(PENALTY, PENALTY_FACTOR * abs(measured.value) / measured.uncertainty)
    return (value - measured.value) / measured.uncertainty


def exact_column(parameter: Parameter, value: float, point: Point, exact: SceneDerivatives) -> tuple[Array | None, str]:
    """Return the slopes of a point's residuals over the place of a parameter, or None and why they are not exact."""
    if exact.why:
        return None, exact.why
    total = np.zeros(len(point.measured))
    for path, factor in ((parameter.path, 1.0), *((tie.path, tie.factor) for tie in parameter.ties)):
        slopes = exact.derivatives.get(path)
        if slopes is None:
            return None, exact.refused.get(path, "it has no derivative")
        missing = [name for name in point.measured if name not in slopes]
        if missing:
            return None, f"{missing[0]} has no derivative"
        sizes = (slopes[name] / measured.uncertainty for name, measured in point.measured.items())
        total += factor * parameter.slope(value) * np.array(list(sizes))
    return total, ""
