"""All cases of a results file as a table, a row each: varied paths, status, figures; in SI, metric or US units."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from screwsim.figures.engineering import figure_unit, shown_name
from screwsim.fluid.constants import gas_constant
from screwsim.outputs import PERFORMANCE, Figure
from screwsim.outputs.customary import NORMAL_STATE, RPM, ZERO_CELSIUS
from screwsim.outputs.us_units import BTU, CFM, FOOT, GALLON, HORSEPOWER, INCH, POUND, POUND_FORCE, PSI, STANDARD_STATE
from screwsim.results import Results
from screwsim.results.atomic import make_folder
from screwsim.results.fluid_name import fluid_name
from screwsim.results.protection import protect_other_heads
from screwsim.results.read import STAGES
from screwsim.results.schema import Axis, cf_unit, quantities_along
from screwsim.results.tables import write_table
from screwsim.scene.fields import catalogue_leaves
from screwsim.scene.types import COVERAGE
from screwsim.study.calibration.columns import UNCERTAINTY_SUFFIX

Array = np.ndarray
SI, METRIC, US = "si", "metric", "us"
FAHRENHEIT = 1.8  # degF per K
KELVIN, PRESSURE_DIFFERENCE = "kelvin", "pressure difference"  # units of differences, in K and in Pa
_DIFFERENCES = {"temperature_difference": KELVIN, "pressure_difference": PRESSURE_DIFFERENCE}  # kind of input: unit
_LOST = ("loss", "drop", "difference")  # last words of figures that are differences of pressure
IN_METRIC = {  # SI unit: factor, unit
    "W": (1e-3, "kW"),
    "J": (1e-3, "kJ"),
    "N": (1e-3, "kN"),
    "m": (1e3, "mm"),
    "m2": (1e4, "cm2"),
    "m3": (1e6, "cm3"),
    "m3 s-1": (3600.0, "m3/h"),
    "m3 min-1": (60.0, "m3/min"),  # from m3 s-1, for figures shown in this unit
    "L min-1": (60000.0, "L/min"),
    "m s-1": (1.0, "m/s"),
    "Pa": (1e-5, "bar"),
    PRESSURE_DIFFERENCE: (1e-5, "bar"),
    "Pa s": (1e3, "mPa s"),
    "kg": (1e3, "g"),
    "kg s-1": (1.0, "kg/s"),
    "kg h-1": (3600.0, "kg/h"),  # from kg s-1
    "h": (1.0 / 3600.0, "h"),  # from s
    "kg m-3": (1.0, "kg/m3"),
    "rad": (180.0 / np.pi, "deg"),
    "rad s-1": (1.0 / RPM, "rpm"),
    "W s m-3": (1e-3 / 60.0, "kW/(m3/min)"),
    "J m-3": (1e-3, "kJ/m3"),
    KELVIN: (1.0, "K"),
}
IN_US = {
    "W": (1.0 / HORSEPOWER, "hp"),
    "J": (1.0 / (FOOT * POUND_FORCE), "ft lbf"),
    "N": (1.0 / POUND_FORCE, "lbf"),
    "N m": (1.0 / (FOOT * POUND_FORCE), "lbf ft"),
    "m": (1.0 / INCH, "in"),
    "m2": (1.0 / INCH**2, "in2"),
    "m3": (1.0 / INCH**3, "in3"),
    "m3 s-1": (1.0 / CFM, "cfm"),
    "L min-1": (60.0 / GALLON, "gpm"),
    "m s-1": (1.0 / FOOT, "ft/s"),
    "Pa": (1.0 / PSI, "psia"),
    PRESSURE_DIFFERENCE: (1.0 / PSI, "psi"),
    "Pa s": (1e3, "cP"),
    "kg": (1.0 / POUND, "lb"),
    "kg s-1": (3600.0 / POUND, "lb/h"),
    "h": (1.0 / 3600.0, "h"),
    "kg m-3": (FOOT**3 / POUND, "lb/ft3"),
    "rad": (180.0 / np.pi, "deg"),
    "rad s-1": (1.0 / RPM, "rpm"),
    "W s m-3": (100.0 * CFM / HORSEPOWER, "hp/(100 cfm)"),
    "J m-3": (FOOT**3 / BTU, "Btu/ft3"),
    KELVIN: (FAHRENHEIT, "F diff"),
}
FLOW, DISPLACED, LAMBDA = "gas_mass_flow", "displacement_flow", "volumetric_efficiency"
HUMIDITY = "humidity_ratio"
STANDARD = {METRIC: NORMAL_STATE, US: STANDARD_STATE}  # K, Pa


class CaseColumn(NamedTuple):
    """A column of the table: its name, its unit, its values, numbers or texts, and a coverage factor behind it."""

    name: str
    unit: str
    values: Array
    coverage: str = ""

    @property
    def head(self) -> str:
        """The column's name in the first line of the table."""
        return " ".join(filter(None, (self.name, f"[{self.unit}]" if self.unit else "", self.coverage)))


def case_columns(results: Results, units: str) -> list[CaseColumn]:
    """Return the columns of all cases, in the order of the sweep; figures without any value are left out."""
    found = [_varied(results, path, units) for path in results.varied]
    found.append(CaseColumn("status", "", results.status.ravel()))
    for name in results.figures:
        values = results.performance[name].ravel()
        shown = shown_name(name) if units != SI else name
        found.append(CaseColumn(shown, *converted(results.figure(name), values, units)))
        if name in results.uncertainty and np.nan_to_num(results.uncertainty[name]).any():
            head = f"{name}{UNCERTAINTY_SUFFIX}" if units == SI else f"{shown} uncertainty"
            found.append(_uncertainty(results, name, head, units))
    found += _volume_flows(results, units)
    for name, texts in (("message", results.messages), ("warnings", results.warnings)):
        if any(texts.ravel()):
            found.append(CaseColumn(name, "", np.array([text.replace("\n", "; ") for text in texts.ravel()])))
    return found


def _uncertainty(results: Results, name: str, head: str, units: str) -> CaseColumn:
    """Return half of the 95 % interval of a figure by the inputs, with its coverage factor as columns of a fit have."""
    figure = results.figure(name)
    if units != SI:
        figure = replace(figure, units={"K": KELVIN, "Pa": PRESSURE_DIFFERENCE}.get(figure.units, figure.units))
    unit, values = converted(figure, COVERAGE * results.uncertainty[name].ravel(), units)
    return CaseColumn(head, unit, values, f"(k={COVERAGE:g})")


def _varied(results: Results, path: str, units: str) -> CaseColumn:
    axis = next(each for each in quantities_along(results.axis_list) if each.path == path)
    along = results.along(path).ravel()
    if axis.values.dtype.kind not in "fiu":
        return CaseColumn(path, "", along)
    return CaseColumn(path, *converted(as_figure(axis, units), along, units))


def _volume_flows(results: Results, units: str) -> Iterator[CaseColumn]:
    """Yield the flow at suction conditions, and that of the ideal gas at standard conditions, for metric and US units.

    The latter only where all cases have one gas. Of two stages both are those of the first, which draws the gas.
    """
    results = results.stages.get(STAGES[0], results)
    if units == SI or not {FLOW, DISPLACED, LAMBDA} <= set(results.figures):
        return
    drawn = (results.performance[LAMBDA] * results.performance[DISPLACED]).ravel()
    name, factor = ("acfm", 1.0 / CFM) if units == US else ("m3/h", 3600.0)
    yield CaseColumn("inlet flow", name, factor * drawn)
    if any(path.startswith("gas.") for path in results.varied):
        return
    T, p = STANDARD[units]
    wet = results.performance[HUMIDITY] if HUMIDITY in results.figures else 0.0
    volume = gas_constant(fluid_name(results)) * T / p  # [m³/kg]
    flow = (results.performance[FLOW] / (1.0 + wet)).ravel() * volume  # [m³/s], without the water
    name, factor = ("MMSCFD", 86400e-6 / FOOT**3) if units == US else ("Nm3/h", 3600.0)
    yield CaseColumn("standard flow", name, factor * flow)


def protect_other_cases(path: Path) -> None:
    """Raise UsageError where the file at `path` is not such a table, as measured data: it would be lost."""
    named = {each for name in PERFORMANCE for each in (name, shown_name(name))}

    def ours(heads: list[str]) -> bool:  # dotted paths, the status, then a figure with its unit, or messages
        at = heads.index("status") if "status" in heads else len(heads)
        figures = (head.partition(" [") for head in heads[at + 1 :])
        told = any(name == "message" or (unit and name in named) for name, _, unit in figures)
        return told and all("." in head for head in heads[:at])

    protect_other_heads(path, ours)


def write_cases(path: Path, columns: Sequence[CaseColumn]) -> str:
    """Write columns as a table with their units in the first line; return the path."""
    make_folder(path.parent)
    heads = (each.head for each in columns)
    rows = zip(*(each.values.tolist() for each in columns), strict=True)
    return write_table(path, heads, ([_cell(value) for value in row] for row in rows))


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.8g}"
    return value


def converted(figure: Figure, values: Array, units: str) -> tuple[str, Array]:
    """Return the unit, and the values [SI] in it, of a figure or a varied path; what has no other keeps its SI unit."""
    if units == SI:
        return "" if figure.units == "1" else figure.units, values
    if figure.units == "K":
        celsius = values - ZERO_CELSIUS
        return ("degF", FAHRENHEIT * celsius + 32.0) if units == US else ("degC", celsius)
    if figure.units == "1":
        factor, unit = figure_unit(figure, 0.0)
        return unit, factor * values
    table = IN_US if units == US else IN_METRIC
    words = figure.name.split("_")
    lost = words[-1] in _LOST or "pulsation" in words  # differences of pressures, by their names
    of = PRESSURE_DIFFERENCE if figure.units == "Pa" and lost else figure.units
    factor, unit = table.get(figure.shown, table.get(of, (1.0, figure.units)))
    return unit, factor * values


def as_figure(axis: Axis, units: str) -> Figure:
    """Return a varied path as a figure: its name, its unit, beside SI one of their own for differences, its meaning."""
    unit = cf_unit(axis.units)
    if units != SI:
        unit = _DIFFERENCES.get(_kind(axis), unit)
    return Figure(axis.path, unit or "1", axis.long_name)


def _kind(axis: Axis) -> str:
    """Return the kind of a varied path; of one of a user's own by its last word."""
    known = catalogue_leaves()
    for path in (axis.path, axis.path.partition(".")[2]):  # the latter of one of two stages
        if path in known:
            return known[path].kind
    last = axis.path.rpartition("_")[2].rpartition(".")[2]
    if axis.units == "K":
        return "temperature" if last == "temperature" else "temperature_difference"
    return "pressure_difference" if axis.units == "Pa" and last in _LOST else ""
