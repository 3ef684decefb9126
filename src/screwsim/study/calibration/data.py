"""Read the measured points of a fit: a CSV file whose columns are scene paths, figures and their uncertainties."""

import math
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from screwsim.figures import declared, known
from screwsim.figures.curves import Reading, reading_of
from screwsim.fluid import constants
from screwsim.inputs.declare import Kind
from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import BadSheet, Row, Sheet, name_and_unit, read_sheet
from screwsim.inputs.suggestions import counted
from screwsim.inputs.textfiles import Unreadable
from screwsim.outputs import Figure
from screwsim.outputs.customary import ZERO_CELSIUS, in_celsius
from screwsim.outputs.display import grouped
from screwsim.scene import Scene, cross_check, leaf_of, lines
from screwsim.scene.fields import Leaf, leaves_of, unknown_key
from screwsim.scene.numerals import odd_number, odd_number_text
from screwsim.scene.tolerances import COVERAGE_FACTOR, split_coverage
from screwsim.scene.units import (
    NUMBER,
    Refused,
    gauge_pressures_over,
    parse_quantity,
    tidy_unit,
)
from screwsim.scene.values import convert_cell, shown
from screwsim.scene.yaml_tree import LocatedFault, LocatedFaults, Position
from screwsim.study.asked.figure_units import (
    CELSIUS,
    UNITS,
    bare_percent,
    percent_are_points,
    quantity_of,
    units_of,
)
from screwsim.study.calibration.fit import Measurement, Point, odd_uncertainty
from screwsim.study.calibration.indicator import curve_of_files, pressures_of

MOST_POINTS = 10_000  # per fit
UNCERTAINTY_SUFFIX = "_uncertainty"
OF_OWN_ZERO = UNITS["K"], UNITS["Pa"]  # units of figures of which no share is an uncertainty: readings may be gauge
USE_WORDS = {"": True, "fit": True, "check": False}
# of the suction temperature [K]: no machine leaves a gas colder; lower values are mostly degC read as K
LEAST_TEMPERATURE_RATIO = 0.4
# heads by which tables of makers and test benches call these columns, in lower case without _ and blanks
_USUAL_HEADS = {
    **dict.fromkeys(("te", "t0", "to", "tevap", "evaporating"), "operation.evaporating_temperature [degC]"),
    **dict.fromkeys(("tc", "tcond", "condensing"), "operation.condensing_temperature [degC]"),
    **dict.fromkeys(("q", "q0", "qo", "qe", "capacity", "coolingcapacity"), "cooling_capacity [kW]"),
    **dict.fromkeys(("p", "pe", "pel", "power", "powerinput"), "shaft_power [kW] or electrical_power [kW]"),
    **dict.fromkeys(("n", "rpm", "speed"), "operation.speed [rpm]"),
    **dict.fromkeys(("m", "mdot", "massflow"), "gas_mass_flow [kg/s]"),
    **dict.fromkeys(("td", "t2", "discharge"), "discharge_temperature [degC]"),
    **dict.fromkeys(("ps", "p0", "p1"), "operation.suction.pressure [bar]"),
    **dict.fromkeys(("pd", "pc", "p2"), "operation.discharge.pressure [bar]"),
}
_EXAMPLE = "write e.g. operation.speed [rpm], shaft_power [kW], shaft_power_uncertainty [kW]"


@dataclass(frozen=True)
class _Column:
    """One column: its kind (name, use, figure, uncertainty, path, file), what it is of, and its unit.

    `quantity` is the dimension of a figure whose unit is one that only scenes know, `coverage` how many standard
    uncertainties an uncertainty of the column is; `relative` tells that it is a share of the value.
    """

    kind: str
    of: str
    unit: str
    leaf: Leaf | None = None
    quantity: Kind | None = None
    coverage: float = 1.0
    relative: bool = False

    @property
    def figure(self) -> str:
        """The figure whose units the column has: of a curve in files its value at any angle."""
        return _figure_of(self.of)


def _figure_of(column: str) -> str:
    """Return a figure with the units of a column: of one that names files their curve at any angle."""
    curve = curve_of_files(column)
    return column if curve is None else Reading(curve, 0.0).figure


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
    columns = _columns(_cells(sheet.head, start), scene, taken, problems, candidates)
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


def _cells(row: Row, start: Position) -> list[tuple[str, Position]]:
    """Return the cells of a row with their places."""
    return [(cell, start.at(row.line, at)) for cell, at in zip(row.cells, _starts(row), strict=False)]


def _starts(row: Row) -> Iterator[int]:
    """Yield the column at which each cell of a row begins; marks inside quotes do not separate cells."""
    yield 1
    quoted = False
    for place, letter in enumerate(row.text):
        quoted ^= letter == '"'
        if letter == row.mark and not quoted:
            yield place + 2


def _columns(
    cells: list[tuple[str, Position]], scene: Scene, taken: Sequence[str], problems: LocatedFaults, candidates: bool
) -> list[tuple[_Column, Position]]:
    found, refused = [], set()
    for cell, place in cells:
        name, unit = name_and_unit(COVERAGE_FACTOR.sub("", cell))
        try:
            found.append((_covered(_column(name, unit, scene, taken, candidates), cell), place))
        except (Refused, UsageError) as refusal:
            refused.add(name)
            problems.add(place, name or "data", str(refusal).removeprefix(f"{name}: "))
    names = [(column.kind, column.of) for column, _ in found]
    for (column, place), name in zip(found, names, strict=True):
        if names.count(name) > 1:
            problems.add(place, column.of, "appears twice (remove one column)")
        value = "figure" if curve_of_files(column.of) is None else "file"
        partner = {value: "uncertainty", "uncertainty": value}.get(column.kind)
        if partner and (partner, column.of) not in names and not (candidates and partner == "figure"):
            other = column.of + UNCERTAINTY_SUFFIX if partner == "uncertainty" else column.of
            if other not in refused:
                problems.add(place, column.of, f"needs a column {other} (add it)")
    in_percent = {column.of for column, _ in found if column.kind == "figure" and column.unit == "%"}
    for column, place in found:
        if column.kind == "uncertainty" and not column.unit and column.of in in_percent:
            own = column.of + UNCERTAINTY_SUFFIX
            problems.add(place, own, f"has no unit beside {column.of} [%] (write {own} [%], or [1] for a share)")
    found = [(_with_its_percent(column, column.of in in_percent), place) for column, place in found]
    for column, place in found if candidates else ():
        if column.relative:
            problems.add(place, column.of, f"has no value of which {column.unit} are a share (write [1], its own unit)")
    if not candidates and not any(kind in ("figure", "file") for kind, _ in names) and not problems:
        problems.add(cells[0][1], "data", f"has no column of a measured figure (known: {', '.join(_figures(scene))})")
    return found


def _figures(scene: Scene) -> Mapping[str, Figure]:
    """Return the program's figures and those of the scene's own effects."""
    return known() | {figure.name: figure for active in scene.effects.values() for figure in active.effect.figures}


def _covered(column: _Column, head: str) -> _Column:
    """Return a column with the coverage factor that its head states; raise `Refused` where it has none to state."""
    rest, coverage = split_coverage(head, 1.0)
    if rest != head and column.kind != "uncertainty":
        raise Refused(f"has a coverage factor, which only a column …{UNCERTAINTY_SUFFIX} may have (remove it)")
    return replace(column, coverage=coverage)


def _with_its_percent(column: _Column, in_percent: bool) -> _Column:
    """Return a column with what its % are, points or a share, if it is an uncertainty of a figure without dimension.

    `in_percent` tells that the values of the figure are in %.
    """
    if column.kind != "uncertainty" or column.unit != "%" or percent_are_points(column.figure, in_percent):
        return column
    return replace(column, relative=True)


def _column(name: str, unit: str, scene: Scene, taken: Sequence[str], candidates: bool) -> _Column:
    """Return the meaning of a column; raise `Refused` or UsageError."""
    if name in ("name", "use"):
        return _Column(name, name, unit)
    of = name.removesuffix(UNCERTAINTY_SUFFIX)
    filed, figures = curve_of_files(of) is not None, _figures(scene)
    if filed and candidates:
        raise Refused("is for measured pressures, and nothing is measured here yet (remove it)")
    if filed and of == name:
        if unit:
            raise Refused(f"names files, which state their unit (write {name} without [{unit}])")
        return _Column("file", name, unit)
    figure = _figure_of(of)
    reading = reading_of(figure)
    if reading is not None and figure != reading.figure:
        raise Refused(f"is not known (write {name.replace(figure, reading.figure)})")
    if figure in figures or reading is not None:
        kind = "uncertainty" if name.endswith(UNCERTAINTY_SUFFIX) else "figure"
        units, unit = units_of(figure), tidy_unit(unit)
        if unit in units or (CELSIUS == unit and units is UNITS["K"] and kind == "figure"):
            return _Column(kind, of, unit)
        if unit == "%" and kind == "uncertainty" and not candidates and units not in OF_OWN_ZERO:
            return _Column(kind, of, unit, relative=True)
        quantity = quantity_of(figure, kind, unit)
        if quantity is None:
            raise Refused(f"unit {shown(unit)} is not one of its units (write [{'], ['.join(u for u in units if u)}])")
        return _Column(kind, of, unit, quantity=quantity)
    if name in taken:
        raise Refused("is a parameter of the fit and cannot be a condition (remove one of the two)")
    in_brackets = re.fullmatch(r"(.*?)\s*\((.*)\)", name)
    if in_brackets is not None:
        raise Refused(f"is not known (a unit stands in square brackets: {in_brackets[1]} [{in_brackets[2]}])")
    if "." not in name:
        usual = _USUAL_HEADS.get(re.sub(r"[\s_]", "", name).lower())
        if usual is not None:
            raise Refused(f"is not known (write {usual}, if that is what it is)")
        known_names = [*figures, "name", "use", *leaves_of(scene)]
        raise Refused(unknown_key(name, known_names, "name, use, a scene path or a figure"))
    leaf = leaf_of(scene, name)
    if unit:
        _check_unit(leaf, unit)
    return _Column("path", name, unit, leaf)


def _check_unit(leaf: Leaf, unit: str) -> None:
    """Raise `Refused` where the unit in the head of a path's column is none of the path."""
    if leaf.dimension is None:
        raise Refused("has no unit (remove the brackets)")
    try:
        parse_quantity(leaf.dimension, f"1 {unit}")
    except Refused as refusal:
        raise Refused(str(refusal).replace(repr(f"1 {unit}"), f"unit {shown(unit)}")) from None


def _point(
    row: Row, start: Position, columns: list[tuple[_Column, Position]], problems: LocatedFaults, candidates: bool
) -> tuple[Point, Position] | None:
    place, before = start.at(row.line, 1), len(problems)
    kinds = ("name", "use", "path", "figure", "uncertainty", "file")
    found: dict[str, dict[str, Any]] = {kind: {} for kind in kinds}
    filed: dict[str, Measurement] = {}
    for (text, at), (column, _) in zip(_cells(row, start), columns, strict=True):
        try:
            value = _value(column, text)
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


def _value(column: _Column, text: str) -> Any:
    """Return the value [SI] of a cell, None for an empty cell of a figure; raise `Refused`."""
    if column.kind == "name":
        return text
    if column.kind == "file":
        return text or None
    if column.kind == "use":
        if text not in USE_WORDS:
            raise Refused(f"{shown(text)} is not known (write fit, or check: predicted and not fitted)")
        return USE_WORDS[text]
    odd = odd_number(text)
    if odd is not None and (column.unit or column.leaf is None):
        raise Refused(f"{shown(text)} {odd_number_text(odd, '')}")
    if column.leaf is not None:
        return convert_cell(column.leaf, text, column.unit)
    if not text:
        return None
    if not re.fullmatch(NUMBER, text):
        raise Refused(f"{shown(text)} is not a number (write e.g. 0.5; units go in the first line)")
    value = float(text) if column.quantity is None else float(parse_quantity(column.quantity, f"{text} {column.unit}"))
    if not column.unit and (meant := bare_percent(column.figure, text, column.kind)):
        head = column.of + (UNCERTAINTY_SUFFIX if column.kind == "uncertainty" else "")
        raise Refused(f"{text} {meant.partition(' (')[0]} (write the unit behind the column's name: {head} [%])")
    if column.kind == "uncertainty" and not value > 0.0:
        raise Refused(f"{text} is out of range (an uncertainty must be greater than 0)")
    if column.relative:
        return 0.01 * value / column.coverage
    if column.quantity is not None:
        return value / column.coverage
    if column.unit == CELSIUS:
        return value + ZERO_CELSIUS
    return value * units_of(column.figure)[column.unit] / column.coverage
