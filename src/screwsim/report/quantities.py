"""Display of stored quantities in figures: symbol, customary unit, factor and offset from SI.

Temperatures are shown in °C, differences of temperature in K.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from screwsim.figures import declared
from screwsim.figures.curves import Reading
from screwsim.figures.engineering import figure_scales, shown_name
from screwsim.outputs import Figure
from screwsim.outputs.customary import RPM, ZERO_CELSIUS, scale
from screwsim.results import Results
from screwsim.results.read import STAGES
from screwsim.results.schema import Axis


class Display(NamedTuple):
    """Words, symbol (mathtext), customary unit ('' for none), factor from SI, and the offset added after it."""

    words: str
    symbol: str
    unit: str
    factor: float
    offset: float = 0.0

    def of(self, values: Any) -> Any:
        """Return values [SI] in the shown unit."""
        return values * self.factor + self.offset

    @property
    def label(self) -> str:
        """Return the label of an axis: words, symbol and unit."""
        return f"{self.words} {self.quantity}" if self.symbol else f"{self.words}{self._unit}"

    @property
    def quantity(self) -> str:
        """Return only symbol and unit, for narrow places."""
        return f"{self.symbol}{self._unit}" if self.symbol else self.label

    @property
    def _unit(self) -> str:
        return f" ({self.unit})" if self.unit else ""

    def value(self, number: float) -> str:
        """Return a value [SI] with symbol and unit: 'n = 3000 rpm'."""
        unit = f" {self.unit}" if self.unit not in ("", "kg/kg", "W/W") else ""
        return f"{self.symbol or self.words} = {short(self.of(number))}{unit}"


def celsius(words: str, symbol: str) -> Display:
    """Return the display of a temperature."""
    return Display(words, symbol, "°C", 1.0, -ZERO_CELSIUS)


DEGREE = 180.0 / math.pi

ANGLE = Display("male-rotor angle", r"$\varphi$", "°", 1.0)
CRANK_ANGLE = Display("crank angle", r"$\varphi$", "°", 1.0)
PRESSURE = Display("pressure", "$p$", "bar", 1e-5)
VOLUME = Display("chamber volume", "$V$", "cm³", 1e6)
TEMPERATURE = celsius("temperature", "$T$")
GAS_MASS = Display("gas mass", "$m$", "g", 1e3)
MASS_FLOW = Display("mass flow into the chamber", r"$\dot m$", "g/s", 1e3)
SPEED = Display("male-rotor speed", "$n$", "rpm", 1.0 / RPM)
RATIO = Display("oil-to-gas mass ratio", "$d$", "kg/kg", 1.0)
_RATIOS = {"oil_ratio": RATIO, "cop": Display("COP", "", "W/W", 1.0)}  # shown as a ratio of units

EFFICIENCIES = ("isothermal_efficiency", "isentropic_efficiency")  # the one with more values is shown
_SYMBOLS = {
    "isothermal_efficiency": r"$\eta_\mathrm{iso}$",
    "isentropic_efficiency": r"$\eta_s$",
    "volumetric_efficiency": r"$\lambda$",
    "shaft_power": "$P$",
    "cooling_capacity": r"$\dot Q_0$",
    "heating_capacity": r"$\dot Q_h$",
    "gas_mass_flow": r"$\dot m$",
    "discharge_temperature": "$T_d$",
}

_AXES = {
    "operation.speed": SPEED,
    "machine.built_in_volume_ratio": Display("built-in volume ratio", "", "", 1.0),
    "oil_supply.ratio": RATIO,
    "oil_supply.temperature": celsius("oil temperature", r"$T_\mathrm{oil}$"),
    "operation.suction.pressure": Display("suction pressure", "$p_s$", "bar", 1e-5),
    "operation.suction.temperature": celsius("suction temperature", "$T_s$"),
    "operation.discharge.pressure": Display("discharge pressure", "$p_d$", "bar", 1e-5),
    "operation.evaporating_temperature": celsius("evaporating temperature", "$T_e$"),
    "operation.condensing_temperature": celsius("condensing temperature", "$T_c$"),
    "operation.superheat": Display("superheat", r"$\Delta T_\mathrm{sh}$", "K", 1.0),
    "operation.subcooling": Display("subcooling", r"$\Delta T_\mathrm{sc}$", "K", 1.0),
}
_CUSTOMARY = {
    "Pa": ("bar", 1e-5),
    "rad/s": ("rpm", 1.0 / RPM),
    "rad": ("°", DEGREE),
    "Pa s": ("mPa s", 1e3),
    "m^3": ("cm³", 1e6),
    "J/(kg K)": ("kJ/(kg K)", 1e-3),
    "W/(m^2 K)": ("W/(m² K)", 1.0),
    "kg/m^3": ("kg/m³", 1.0),
    "1": ("", 1.0),
}


def shown_axis(axis: Axis) -> Display:
    """Return the display of a sweep's axis; paths without their own symbol show their last words.

    That of one of two stages has the stage behind its words, and no symbol.
    """
    stage, _, own = axis.path.partition(".")
    if stage in STAGES:
        alone = shown_axis(axis._replace(path=own))
        return alone._replace(words=f"{alone.words}, {stage} stage", symbol="")
    if axis.path in _AXES:
        return _AXES[axis.path]
    words = " ".join(axis.path.split(".")[-2:]).replace("_", " ")
    if axis.units == "K" and words.endswith("temperature"):
        return celsius(words, "")
    unit, factor = _CUSTOMARY.get(axis.units, (axis.units, 1.0))
    if axis.units in ("m", "m^2"):
        largest = float(np.max(np.abs(axis.values)))
        factor, unit = scale("m", largest) if axis.units == "m" else (1e6, "mm²") if largest < 1e-4 else (1e4, "cm²")
    return Display(words, "", unit, factor)


def shown_figure(results: Results, name: str) -> Display:
    """Return the display of a performance figure over all cases of a file: one unit, that of the largest value."""
    if name in _RATIOS:
        of_shaft = name == "cop" and "electrical_cop" in results.performance
        return _RATIOS[name]._replace(words="COP of the shaft power") if of_shaft else _RATIOS[name]
    words, symbol = shown_name(name), _SYMBOLS.get(name, "")
    values = results.performance[name]
    largest = float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0))
    return _shown(results.figure(name), words, symbol, largest)


def shown_curve(name: str, largest: float) -> Display:
    """Return the display of a curve of the cycle whose largest size [SI] is given."""
    if name == "pressure":
        return PRESSURE
    return _shown(declared(Reading(name, 0.0).figure), shown_name(name), "", largest)


def _shown(about: Figure, words: str, symbol: str, largest: float) -> Display:
    if about.units == "K":
        return celsius(words, symbol)
    factor, unit = next((factor, unit) for least, factor, unit in figure_scales(about) if largest >= least)
    return Display(words, symbol, unit, factor)


def short(number: float) -> str:
    """Return a number as written in a figure, with at most four digits: 5000, 0.25, 12."""
    rounded = float(f"{number:.4g}")
    return f"{rounded:.0f}" if 1e3 <= abs(rounded) < 1e6 else f"{rounded:g}".replace("-", "−")


def value_of(axis: Axis, index: int) -> str:
    """Return one value of an axis with its symbol and unit; a text is shown as such, joined values in a row."""
    if axis.joined:
        return ", ".join(value_of(inner, index) for inner in axis.joined)
    value = axis.values[index]
    return shown_axis(axis).value(float(value)) if is_numeric(axis) else f"{choice_words(axis)}: {value}"


def choice_words(axis: Axis) -> str:
    """Return the words of an axis of choices: the end of its path, and for `oil.name` what has the name."""
    first, _, last = axis.path.rpartition(".")
    return (first.rpartition(".")[2] if last == "name" else last).replace("_", " ")


def is_numeric(axis: Axis) -> bool:
    """Tell whether the values of an axis are numbers."""
    return axis.values.dtype.kind == "f"
