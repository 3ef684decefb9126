"""The residuals of a fit, over their uncertainties, and how they change with each parameter.

A solution that fails or does not close never enters as NaN: its figures count as PENALTY uncertainties off, so that the
search turns back, and a difference over it is taken to the other side.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from screwsim.outputs import Figures, Result
from screwsim.study.calibration.fit import Fit, Point
from screwsim.study.optimum import Simulate, closed
from screwsim.study.warm import Warm

Array = NDArray[np.float64]
PENALTY = 1e4  # [uncertainties] of a figure without a solution
STEP = 0.01  # of the bounds' distance, each way: far above the solver's noise


@dataclass(frozen=True)
class Outcome:
    """What one set of parameters gives: residuals of fitted points and priors, results by point, why some failed."""

    residuals: Array
    figures: tuple[Figures, ...]  # of each asked point; empty where it failed
    reasons: Mapping[str, str]  # by the name of the point

    @property
    def chi_squared(self) -> float:
        """Return the sum of squares of what was solved: penalties are no measure of a fit."""
        return float(np.sum(self.residuals[np.abs(self.residuals) < PENALTY] ** 2))


@dataclass
class Objective:
    """Residuals over places 0 … 1 between the bounds; counts solutions, remembers the best set."""

    fit: Fit
    simulate: Simulate | None = None
    note: Path | None = None  # where the best so far is written
    solutions: int = 0
    failed: int = 0
    best: tuple[float, Array, Outcome] | None = None
    _last: tuple[bytes, Outcome] | None = None
    _warm: dict[str, Simulate] = field(default_factory=dict)

    @property
    def points(self) -> list[Point]:
        return [point for point in self.fit.points if point.fitted]

    def values(self, places: Array) -> dict[str, float]:
        """Return the parameters [SI] at places."""
        inside = np.clip(places, 0.0, 1.0)
        return {each.path: each.value(float(place)) for each, place in zip(self.fit.parameters, inside, strict=True)}

    def outcome(self, places: Array) -> Outcome:
        """Return residuals and figures of the fitted points."""
        if self._last is None or self._last[0] != places.tobytes():
            self._last = places.tobytes(), self._outcome(places)
        return self._last[1]

    def _outcome(self, places: Array) -> Outcome:
        values = self.values(places)
        found = [self.solved(point, values) for point in self.points]
        residuals = [
            self._residual(result, figure, measured)
            for point, result in zip(self.points, found, strict=True)
            for figure, measured in point.measured.items()
        ]
        for each in self.fit.parameters:
            if each.prior is not None:
                residuals.append((values[each.path] - each.prior.mean) / each.prior.deviation)
        why = {point.name: why_not(point, result) for point, result in zip(self.points, found, strict=True)}
        reasons = {name: reason for name, reason in why.items() if reason}
        outcome = Outcome(np.array(residuals), tuple(result.performance for result in found), reasons)
        cost = float(np.sum(outcome.residuals**2))
        if self.best is None or cost < self.best[0]:
            self.best = cost, np.array(places), outcome
            self._write(cost, places)
        return outcome

    def _write(self, cost: float, places: Array) -> None:
        """Note the best so far, whole or not at all."""
        if self.note is not None:
            fresh = self.note.with_suffix(".new")
            fresh.write_text(json.dumps([cost, places.tolist(), self.solutions, self.failed]), encoding="utf-8")
            fresh.replace(self.note)

    def solved(self, point: Point, values: Mapping[str, float]) -> Result:
        """Return the result of one point."""
        simulate = self.simulate or self._warm.setdefault(point.name, Warm())
        result = closed(self.fit.at(point, values), simulate)
        self.solutions += 1
        if result.status != "ok":
            self.failed += 1
            return replace(result, performance=Figures())
        return result

    def _residual(self, result: Result, figure: str, measured: Any) -> float:
        value = result.performance.get(figure)
        return PENALTY if value is None else (value - measured.value) / measured.uncertainty

    def slopes(self, places: Array) -> Array:
        """Return the slopes of the residuals over the places, by central differences; one-sided at bounds."""
        here = self.outcome(places).residuals
        columns = [self._column(places, index, here) for index in range(len(places))]
        return np.column_stack(columns)

    def _column(self, places: Array, index: int, here: Array) -> Array:
        """Return the slopes over one place; zero for a figure that has no solution on two sides."""
        known = [(float(places[index]), here)]
        for sign in (1.0, -1.0):
            moved = np.array(places)
            moved[index] += sign * STEP
            if 0.0 <= moved[index] <= 1.0:
                known.append((float(moved[index]), self.outcome(moved).residuals))
        column = np.zeros(len(here))
        for row in range(len(column)):
            pairs = sorted((place, left[row]) for place, left in known if abs(left[row]) < PENALTY)
            if len(pairs) > 1:
                column[row] = (pairs[-1][1] - pairs[0][1]) / (pairs[-1][0] - pairs[0][0])
        return column


def why_not(point: Point, result: Result) -> str:
    """Return why a point has no figures, or not all; empty when it has."""
    return result.told if result.status != "ok" else "; ".join(result.lacks(point.measured))
