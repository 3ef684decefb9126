"""Read the measured points of a fit: a CSV file whose columns are scene paths, figures and their uncertainties."""

import math
import os
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from screwsim.figures import declared
from screwsim.fluid import constants
from screwsim.inputs.sheets import BadSheet, Row, Sheet, read_sheet
from screwsim.inputs.suggestions import counted
from screwsim.inputs.textfiles import Unreadable
from screwsim.outputs.customary import in_celsius
from screwsim.outputs.display import grouped
from screwsim.scene import Scene, cross_check, lines
from screwsim.scene.units import (
    Refused,
    gauge_pressures_over,
)
from screwsim.scene.values import shown
from screwsim.scene.yaml_tree import LocatedFault, LocatedFaults, Position
from screwsim.study.asked.figure_units import (
    CELSIUS,
)
from screwsim.study.calibration.columns import Column, cells_of, read_columns, value_of
from screwsim.study.calibration.fit import Measurement, Point, odd_uncertainty
from screwsim.study.calibration.indicator import curve_of_files, pressures_of

MOST_POINTS = 10_000  # per fit
# of the suction temperature [K]: no machine leaves a gas colder; lower values are mostly degC read as K
LEAST_TEMPERATURE_RATIO = 0.4
_EXAMPLE = "write e.g. operation.speed [rpm], shaft_power [kW], shaft_power_uncertainty [kW]"


def read_points(
    path: str, label: str, scene: Scene, taken: Sequence[str], problems: LocatedFaults, *, candidates: bool = False
) -> list[tuple[Point, Position]]:
    """Return the points of a file with their places; `taken` are paths that a parameter sets.

    With `candidates` nothing needs to be measured: uncertainties are those of future measurements, and figures without
    a value are NaN.
    """
    start = Position(1, label, folder=os.path.dirname(path))
    try:
        sheet = read_sheet(path)
    except Unreadable as reason:
        there = start.at(reason.line, reason.column)
        problems.add(there, "data", f"cannot be read: {reason} (name a CSV file in UTF-8)")
        return []
    except BadSheet as fault:
        problems.add(start.at(fault.line or 1, 1), "data", fault.what)
        return []
    if not sheet.rows:
        remedy = f"write a line of column names, then one line per point; {_EXAMPLE}"
        problems.add(start, "data", f"has no points ({remedy})")
        return []
    if len(sheet.rows) > MOST_POINTS:
        problems.add(start, "data", f"has {len(sheet.rows)} points (at most {MOST_POINTS} are fitted)")
        return []
    with gauge_pressures_over(scene.operation.ambient_pressure):
        found = _read(sheet, start, scene, taken, problems, candidates)
    if not problems:
        problems += [LocatedFault(at, name, what) for point, at in found for name, what in _too_cold(point, scene)]
    return found


def point_faults(points: Iterable[tuple[Scene, Position]]) -> Iterator[LocatedFault]:
    """Yield faults of the scenes of points, that of several points once, at the first."""
    every = grouped(((fault.path, fault.what), place) for scene, place in points for fault in cross_check(scene))
    for (path, what), (place, *others) in every.items():
        more = f"; the same at {counted(len(others), 'other point')}" if others else ""
        yield LocatedFault(place, path, what + more)


def _read(
    sheet: Sheet, start: Position, scene: Scene, taken: Sequence[str], problems: LocatedFaults, candidates: bool
) -> list[tuple[Point, Position]]:
    """Return the points of a table; gauge pressures are relative to the scene's ambient pressure."""
    before = len(problems)
    columns = read_columns(cells_of(sheet.head, start), scene, taken, problems, candidates)
    if len(problems) > before:
        return []
    read = [_point(row, start, columns, problems, candidates) for row in sheet.rows]
    points = [row for row in read if row is not None]
    names: set[str] = set()
    for point, place in points:
        if point.name in names:
            problems.add(place, "name", f"{shown(point.name)} appears twice (name each point once)")
        names.add(point.name)
    if not problems and not any(point.fitted for point, _ in points):
        problems.add(start, "use", "leaves no point to fit (write fit in that column for some)")
    return points


def _too_cold(point: Point, scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield (figure, fault) of measured temperatures so low that they must be readings in degC under [K]."""
    T_s, fluid = lines(scene).T_s, scene.gas.name
    limits = constants.limits(fluid)
    T_triple = 0.0 if limits is None else limits.T_triple
    for name, (value, _) in point.measured.items():
        if declared(name).units == "K" and value < max(LEAST_TEMPERATURE_RATIO * T_s, T_triple):
            limit = f"is drawn in at {in_celsius(T_s)}" if value >= T_triple else f"freezes at {in_celsius(T_triple)}"
            what = f"{value:.4g} K is {in_celsius(value)}, and {fluid} {limit}"
            yield name, f"{what} (write [{CELSIUS}] for values in that unit)"


def _point(
    row: Row, start: Position, columns: list[tuple[Column, Position]], problems: LocatedFaults, candidates: bool
) -> tuple[Point, Position] | None:
    place, before = start.at(row.line, 1), len(problems)
    kinds = ("name", "use", "path", "figure", "uncertainty", "file")
    found: dict[str, dict[str, Any]] = {kind: {} for kind in kinds}
    filed: dict[str, Measurement] = {}
    for (text, at), (column, _) in zip(cells_of(row, start), columns, strict=True):
        try:
            value = value_of(column, text)
        except Refused as refusal:
            problems.add(at, column.of, str(refusal))
            continue
        if value is not None:
            found[column.kind][column.of] = value
    if len(problems) > before:
        return None
    for name in (column.of for column, _ in columns if column.kind == "file"):
        own = found["uncertainty"].pop(name, None)
        if (file := found["file"].get(name)) is not None:
            try:
                if own is None:
                    raise Refused("needs an uncertainty (fill the empty cell)")
                filed |= (read := pressures_of(curve_of_files(name) or name, file, start.folder, own))
                if both := [figure for figure in read if figure in found["figure"]]:
                    raise Refused(f"its file has {both[0]}, too (remove it there, or empty the cell)")
            except Refused as refusal:
                problems.add(place, name, str(refusal))
                return None
    if candidates:
        found["figure"] = {name: found["figure"].get(name, math.nan) for name in found["uncertainty"]}
    for figure in (column.of for column, _ in columns if column.relative):
        if figure in found["figure"] and figure in found["uncertainty"]:
            found["uncertainty"][figure] *= abs(found["figure"][figure])
            if not found["figure"][figure]:
                problems.add(place, figure, "is 0, of which no share is an uncertainty (state it in the figure's unit)")
    for figure, value in found["figure"].items():
        own = found["uncertainty"].get(figure)
        if own is not None and (why := odd_uncertainty(value, own)):
            problems.add(place, figure, why)
    for figure in found["figure"].keys() ^ found["uncertainty"].keys():
        problems.add(place, figure, "needs both a value and an uncertainty, or neither (fill the empty cell)")
    if len(problems) > before:
        return None
    measured = {name: Measurement(value, found["uncertainty"][name]) for name, value in found["figure"].items()}
    measured |= filed
    name = found["name"].get("name") or f"line {place.line}"
    return Point(name, found["path"], measured, found["use"].get("use", True)), place
