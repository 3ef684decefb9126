"""The rating of a refrigeration machine: its points over evaporating temperature and condenser, and part load.

A scene that sweeps these temperatures is rated at their values, one that does not at steps around its own point. Where
a gas cooler takes the condenser's place, its pressure takes that of the condensing temperature.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene, cross_check, value_at, with_values
from screwsim.scene.operation import CONDENSING, EVAPORATING, GAS_COOLER_P
from screwsim.scene.units import ZERO_CELSIUS
from screwsim.simulate import simulate_many
from screwsim.study.datasheet.bounds import Bound, Reach, envelope
from screwsim.study.each import each
from screwsim.study.inputs import read_text, shown_value
from screwsim.study.part_load import ENDS, LOADS, RATIO, Control, PartLoad, controls, part_load, ratios
from screwsim.study.progress import Progress
from screwsim.study.workers import DIED

STEP = 5.0  # [K] between temperatures of a table
BELOW, ABOVE = 15.0, 10.0  # [K] of the scene's own temperatures, over which a table goes by itself
LEAST_LIFT = 10.0  # [K]
SHARES = (0.85, 0.9, 0.95, 1.0, 1.05, 1.1)  # of a gas cooler's pressure
MOST = 12  # values on an axis of a table


class Axis(NamedTuple):
    """An axis of the table: its path and values [SI], rising."""

    path: str
    values: tuple[float, ...]


class Asked(NamedTuple):
    """What is rated: a scene without a sweep, both axes, limits, controls."""

    scene: Scene
    evaporating: Axis
    condensing: Axis
    bounds: tuple[Bound, ...]
    controls: tuple[Control, ...]
    ratios: tuple[float, ...] = ()  # built-in volume ratios among which each part load's best is found


@dataclass(frozen=True)
class Rating:
    """The results: at the scene's own point, by the numbers on both axes, of each control; the envelope."""

    asked: Asked
    own: Result
    points: dict[tuple[int, int], Result]
    loads: Sequence[PartLoad]
    reach: Sequence[Reach]

    @property
    def ok(self) -> bool:
        """Tell whether every point closed that there can be."""
        return self.own.status == "ok" and all(result.status == "ok" for result in self.points.values())


def asked_of(scene: Scene, evaporating: str | None, condensing: str | None, bounds: Sequence[Bound]) -> Asked:
    """Return what of a scene is to be rated; raise UsageError where it varies something else, or a range is none."""
    base = replace(scene, sweep={}, joints=())
    second = GAS_COOLER_P if base.operation.gas_cooler is not None else CONDENSING
    known = {EVAPORATING, second, RATIO, *ENDS}
    others = [path for path in scene.sweep if path not in known]
    if others or scene.joints:
        path = others[0] if others else scene.joints[0].paths[0]
        raise UsageError(
            f"datasheet: a sheet goes over {EVAPORATING}, {second} and controls of the capacity, and the scene varies "
            f"{path} otherwise (rate one value after the other: a scene without that axis, with --set {path}=VALUE)"
        )
    axes = (
        _axis(scene, base, EVAPORATING, evaporating, "--evaporating"),
        _axis(scene, base, second, condensing, "--condensing"),
    )
    return Asked(base, *axes, tuple(bounds), tuple(controls(scene)), ratios(scene))


def _axis(scene: Scene, base: Scene, path: str, text: str | None, option: str) -> Axis:
    if text is not None:
        return Axis(path, _range(base, path, text, option))
    if path in scene.sweep:
        return Axis(path, tuple(sorted(map(float, scene.sweep[path]))))
    own = float(value_at(base, path))
    if path == GAS_COOLER_P:
        return Axis(path, tuple(own * share for share in SHARES))
    middle = STEP * round((own - ZERO_CELSIUS) / STEP) + ZERO_CELSIUS
    values = [middle + STEP * i for i in range(-round(BELOW / STEP), round(ABOVE / STEP) + 1)]
    return Axis(path, tuple(value for value in values if not _faults(base, {path: value})) or (own,))


def _faults(base: Scene, values: dict[str, float]) -> list[str]:
    return [str(fault) for fault in cross_check(with_values(base, values))]


def _range(base: Scene, path: str, text: str, option: str) -> tuple[float, ...]:
    low, dots, high = text.partition("..")
    if not (dots and low.strip() and high.strip()) or "..." in text:
        example = "-10 degC..10 degC" if path != GAS_COOLER_P else "80 bar..110 bar"
        raise UsageError(f"{option} {text}: is not LOW..HIGH (write e.g. {option} '{example}')")
    first, last = (read_text(base, path, end) for end in (low, high))
    if not first < last:
        ends = " … ".join(shown_value(base, path, end) for end in (first, last))
        raise UsageError(f"{option} {text}: the range {ends} is empty (LOW must be below HIGH)")
    count = len(SHARES) if path == GAS_COOLER_P else min(max(round((last - first) / STEP) + 1, 2), MOST)
    return tuple(first + (last - first) * i / (count - 1) for i in range(count))


def rating(asked: Asked, jobs: int | None = None, progress: Progress | None = None) -> Rating:
    """Return the rating of what is asked for; columns of the table and controls are computed by `jobs` workers."""
    (own,) = simulate_many([asked.scene], trace=False)
    full = own.performance.get("cooling_capacity") if own.status == "ok" else None
    count, many = len(asked.evaporating.values), len(asked.controls) if full else 0
    work = partial(_part, asked, full)
    found = each(work, count + many, died=partial(_died, asked, count), jobs=jobs, progress=progress)
    columns, loads = [part.column for part in found[:count]], [part.load for part in found[count:]]
    points = {(i, j): result for i, column in enumerate(columns) for j, result in enumerate(column) if result}
    axes = asked.evaporating.values, asked.condensing.values
    figures = {
        (i, j): points[i, j].performance if (i, j) in points and points[i, j].status == "ok" else None
        for i in range(count)
        for j in range(len(axes[1]))
    }
    reach = tuple(envelope(figures, axes, asked.bounds))
    return Rating(asked, own, points, [load for load in loads if load is not None], reach)


class _Part(NamedTuple):
    """What one worker computes: the column of an evaporating temperature, or what a control does."""

    column: Sequence[Result | None] = ()
    load: PartLoad | None = None


def _part(asked: Asked, full: float | None, number: int) -> _Part:
    """Return a column by the number of its evaporating temperature, behind these what a control does."""
    count = len(asked.evaporating.values)
    if number >= count:
        return _Part(load=part_load(asked.scene, asked.controls[number - count], full, LOADS, asked.ratios))
    evaporating = asked.evaporating.values[number]
    cases = [_case(asked, evaporating, condensing) for condensing in asked.condensing.values]
    solved = simulate_many([case for case in cases if isinstance(case, Scene)], trace=False)
    return _Part([next(solved) if isinstance(case, Scene) else case for case in cases])


def _case(asked: Asked, evaporating: float, condensing: float) -> Scene | Result | None:
    """Return the scene of a point; why there is none, or nothing where the lift is too small for a point."""
    values = {asked.evaporating.path: evaporating, asked.condensing.path: condensing}
    if asked.condensing.path == CONDENSING and condensing - evaporating < LEAST_LIFT:
        return None
    faults = _faults(asked.scene, values)
    return Result("failed", message=faults[0]) if faults else with_values(asked.scene, values)


def _died(asked: Asked, count: int, number: int) -> _Part:
    lost = Result("failed", message=DIED)
    if number >= count:
        return _Part(load=PartLoad(asked.controls[number - count], (), (), DIED))
    return _Part([lost] * len(asked.condensing.values))


def celsius(T: float) -> float:
    """Return a temperature [K] in °C, without the rounding of 273.15."""
    found = round(T - ZERO_CELSIUS, 6)
    return 0.0 if math.isclose(found, 0.0, abs_tol=1e-9) else found
