"""Columns of the measured points of a fit: what a head means, and the values below it in SI units."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from screwsim.figures import known
from screwsim.figures.curves import Reading, effects_with_trace, reading_of
from screwsim.inputs.declare import Kind
from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import Row, name_and_unit
from screwsim.outputs import Figure
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.scene import Scene, leaf_of
from screwsim.scene.fields import Leaf, leaves_of, unknown_key
from screwsim.scene.numerals import odd_number, odd_number_text
from screwsim.scene.tolerances import COVERAGE_FACTOR, split_coverage
from screwsim.scene.units import NUMBER, Refused, parse_quantity, tidy_unit
from screwsim.scene.values import convert_cell, shown
from screwsim.scene.yaml_tree import LocatedFaults, Position
from screwsim.study.asked.figure_units import (
    CELSIUS,
    UNITS,
    bare_percent,
    percent_are_points,
    quantity_of,
    units_of,
)
from screwsim.study.calibration.indicator import curve_of_files

UNCERTAINTY_SUFFIX = "_uncertainty"
OF_OWN_ZERO = UNITS["K"], UNITS["Pa"]  # units of figures of which no share is an uncertainty: readings may be gauge
USE_WORDS = {"": True, "fit": True, "check": False}
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


@dataclass(frozen=True)
class Column:
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


def cells_of(row: Row, start: Position) -> list[tuple[str, Position]]:
    """Return the cells of a row with their places."""
    return [(cell, start.at(row.line, at)) for cell, at in zip(row.cells, row.places, strict=False)]


def read_columns(
    cells: list[tuple[str, Position]], scene: Scene, taken: Sequence[str], problems: LocatedFaults, candidates: bool
) -> list[tuple[Column, Position]]:
    """Return the columns of the cells of a head, with their places; those that mean nothing here add a problem.

    `taken` are paths that a parameter sets. With `candidates` nothing has been measured yet, and values may be missing.
    """
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


def _covered(column: Column, head: str) -> Column:
    """Return a column with the coverage factor that its head states; raise `Refused` where it has none to state."""
    rest, coverage = split_coverage(head, 1.0)
    if rest != head and column.kind != "uncertainty":
        raise Refused(f"has a coverage factor, which only a column …{UNCERTAINTY_SUFFIX} may have (remove it)")
    return replace(column, coverage=coverage)


def _with_its_percent(column: Column, in_percent: bool) -> Column:
    """Return a column with what its % are, points or a share, if it is an uncertainty of a figure without dimension.

    `in_percent` tells that the values of the figure are in %.
    """
    if column.kind != "uncertainty" or column.unit != "%" or percent_are_points(column.figure, in_percent):
        return column
    return replace(column, relative=True)


def _column(name: str, unit: str, scene: Scene, taken: Sequence[str], candidates: bool) -> Column:
    """Return the meaning of a column; raise `Refused` or UsageError."""
    if name in ("name", "use"):
        return Column(name, name, unit)
    of = name.removesuffix(UNCERTAINTY_SUFFIX)
    filed, figures = curve_of_files(of) is not None, _figures(scene)
    if filed and candidates:
        raise Refused("is for measured pressures, and nothing is measured here yet (remove it)")
    figure = _figure_of(of)
    reading = reading_of(figure)
    givers = [] if reading is None else effects_with_trace(reading.curve)
    if givers and not scene.effects.keys() & set(givers):
        raise Refused(f"is a curve of effects.{' or '.join(givers)}, which the scene lacks (name it, or remove this)")
    if filed and of == name:
        if unit:
            raise Refused(f"names files, which state their unit (write {name} without [{unit}])")
        return Column("file", name, unit)
    if reading is not None and figure != reading.figure:
        raise Refused(f"is not known (write {name.replace(figure, reading.figure)})")
    if figure in figures or reading is not None:
        kind = "uncertainty" if name.endswith(UNCERTAINTY_SUFFIX) else "figure"
        units, unit = units_of(figure), tidy_unit(unit)
        if unit in units or (CELSIUS == unit and units is UNITS["K"] and kind == "figure"):
            return Column(kind, of, unit)
        if unit == "%" and kind == "uncertainty" and not candidates and units not in OF_OWN_ZERO:
            return Column(kind, of, unit, relative=True)
        quantity = quantity_of(figure, kind, unit)
        if quantity is None:
            raise Refused(f"unit {shown(unit)} is not one of its units (write [{'], ['.join(u for u in units if u)}])")
        return Column(kind, of, unit, quantity=quantity)
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
    return Column("path", name, unit, leaf)


def _check_unit(leaf: Leaf, unit: str) -> None:
    """Raise `Refused` where the unit in the head of a path's column is none of the path."""
    if leaf.dimension is None:
        raise Refused("has no unit (remove the brackets)")
    try:
        parse_quantity(leaf.dimension, f"1 {unit}")
    except Refused as refusal:
        raise Refused(str(refusal).replace(repr(f"1 {unit}"), f"unit {shown(unit)}")) from None


def value_of(column: Column, text: str) -> Any:
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
