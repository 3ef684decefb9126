"""Units of the table of all cases: one for each quantity, in the metric system and in that of the US."""

import numpy as np

from screwsim.effects import catalogue
from screwsim.figures.engineering import figure_unit
from screwsim.outputs import Figure
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.results.schema import Axis, cf_unit
from screwsim.scene.fields import leaf_paths

SI, METRIC, US = "si", "metric", "us"
UNITS = SI, METRIC, US
FAHRENHEIT = 1.8  # degF per K
FOOT, POUND = 0.3048, 0.45359237  # [m], [kg], exact
POUND_FORCE = POUND * 9.80665  # [N]
HORSEPOWER = 550.0 * FOOT * POUND_FORCE  # [W]
PSI = POUND_FORCE / (FOOT / 12.0) ** 2  # [Pa]
CUBIC_FOOT = FOOT**3  # [m³]
GALLON = 231.0 * (FOOT / 12.0) ** 3  # [m³], US
BTU = 2326.0 * POUND  # [J], of the International Table
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
    "rad s-1": (30.0 / np.pi, "rpm"),
    "W s m-3": (1e-3 / 60.0, "kW/(m3/min)"),
    "J m-3": (1e-3, "kJ/m3"),
    KELVIN: (1.0, "K"),
}
IN_US = {
    "W": (1.0 / HORSEPOWER, "hp"),
    "J": (1.0 / (FOOT * POUND_FORCE), "ft lbf"),
    "N": (1.0 / POUND_FORCE, "lbf"),
    "N m": (1.0 / (FOOT * POUND_FORCE), "lbf ft"),
    "m": (12.0 / FOOT, "in"),
    "m2": ((12.0 / FOOT) ** 2, "in2"),
    "m3": ((12.0 / FOOT) ** 3, "in3"),
    "m3 s-1": (60.0 / CUBIC_FOOT, "cfm"),
    "L min-1": (60.0 / GALLON, "gpm"),
    "m s-1": (1.0 / FOOT, "ft/s"),
    "Pa": (1.0 / PSI, "psia"),
    PRESSURE_DIFFERENCE: (1.0 / PSI, "psi"),
    "Pa s": (1e3, "cP"),
    "kg": (1.0 / POUND, "lb"),
    "kg s-1": (3600.0 / POUND, "lb/h"),
    "h": (1.0 / 3600.0, "h"),
    "kg m-3": (CUBIC_FOOT / POUND, "lb/ft3"),
    "rad": (180.0 / np.pi, "deg"),
    "rad s-1": (30.0 / np.pi, "rpm"),
    "W s m-3": (100.0 * CUBIC_FOOT / 60.0 / HORSEPOWER, "hp/(100 cfm)"),
    "J m-3": (CUBIC_FOOT / BTU, "Btu/ft3"),
    KELVIN: (FAHRENHEIT, "F diff"),
}


def converted(figure: Figure, values: np.ndarray, units: str) -> tuple[str, np.ndarray]:
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
    of = PRESSURE_DIFFERENCE if figure.units == "Pa" and _is_difference(figure.name) else figure.units
    factor, unit = table.get(figure.shown, table.get(of, (1.0, figure.units)))
    return unit, factor * values


def _is_difference(name: str) -> bool:
    """Tell whether a figure of unit Pa is a difference of pressures, by its name: a loss, or of a pulsation."""
    words = name.split("_")
    return words[-1] in _LOST or "pulsation" in words


def as_figure(axis: Axis, units: str) -> Figure:
    """Return a varied path as a figure: its name, its unit, beside SI one of their own for differences, its meaning."""
    unit = cf_unit(axis.units)
    if units != SI:
        unit = _DIFFERENCES.get(_kind(axis), unit)
    return Figure(axis.path, unit or "1", axis.long_name)


def _kind(axis: Axis) -> str:
    """Return the kind of a varied path; of one of a user's own by its last word."""
    known = leaf_paths({name: effect.parameters for name, effect in catalogue().items()})
    for path in (axis.path, axis.path.partition(".")[2]):  # the latter of one of two stages
        if path in known:
            return known[path].kind
    last = axis.path.rpartition("_")[2].rpartition(".")[2]
    if axis.units == "K":
        return "temperature" if last == "temperature" else "temperature_difference"
    return "pressure_difference" if axis.units == "Pa" and last in _LOST else ""
