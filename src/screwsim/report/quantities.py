"""How a stored quantity is shown in a figure: symbol, customary unit, factor from SI."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from screwsim.results.schema import Axis


class Shown(NamedTuple):
    """Words, symbol (mathtext), customary unit ('' for none) and factor from SI."""

    words: str
    symbol: str
    unit: str
    factor: float

    @property
    def label(self) -> str:
        """Return the label of an axis: words, symbol and unit."""
        return f"{self.words} {self.quantity}" if self.symbol else f"{self.words}{self._unit}"

    @property
    def quantity(self) -> str:
        """Return symbol and unit alone, for narrow places."""
        return f"{self.symbol}{self._unit}" if self.symbol else self.label

    @property
    def _unit(self) -> str:
        return f" ({self.unit})" if self.unit else ""

    def value(self, number: float) -> str:
        """Return a value [SI] with symbol and unit: 'n = 3000 rpm'."""
        unit = f" {self.unit}" if self.unit not in ("", "kg/kg") else ""
        return f"{self.symbol or self.words} = {short(number * self.factor)}{unit}"


RPM = 30.0 / math.pi
DEGREE = 180.0 / math.pi

ANGLE = Shown("male-rotor angle", r"$\varphi$", "°", 1.0)
PRESSURE = Shown("pressure", "$p$", "bar", 1e-5)
VOLUME = Shown("chamber volume", "$V$", "cm³", 1e6)
TEMPERATURE = Shown("temperature", "$T$", "K", 1.0)
GAS_MASS = Shown("gas mass", "$m$", "g", 1e3)
MASS_FLOW = Shown("mass flow into the chamber", r"$\dot m$", "g/s", 1e3)
SPEED = Shown("male-rotor speed", "$n$", "rpm", RPM)
RATIO = Shown("oil-to-gas mass ratio", "$d$", "kg/kg", 1.0)

FIGURES = {
    "isothermal_efficiency": Shown("isothermal efficiency", r"$\eta_\mathrm{iso}$", "%", 100.0),
    "isentropic_efficiency": Shown("isentropic efficiency", r"$\eta_s$", "%", 100.0),
    "volumetric_efficiency": Shown("volumetric efficiency", r"$\lambda$", "%", 100.0),
    "oil_ratio": RATIO,
    "shaft_power": Shown("shaft power", "$P$", "kW", 1e-3),
    "cooling_capacity": Shown("cooling capacity", r"$\dot Q_0$", "kW", 1e-3),
    "cop": Shown("coefficient of performance", r"$\mathrm{COP}$", "", 1.0),
    "gas_mass_flow": Shown("gas mass flow", r"$\dot m$", "g/s", 1e3),
    "discharge_temperature": Shown("gas at discharge", "$T_d$", "K", 1.0),
}

_AXES = {
    "operation.speed": SPEED,
    "oil_supply.ratio": RATIO,
    "oil_supply.temperature": Shown("oil temperature", r"$T_\mathrm{oil}$", "K", 1.0),
    "operation.suction.pressure": Shown("suction pressure", "$p_s$", "bar", 1e-5),
    "operation.suction.temperature": Shown("suction temperature", "$T_s$", "K", 1.0),
    "operation.discharge.pressure": Shown("discharge pressure", "$p_d$", "bar", 1e-5),
    "operation.evaporating_temperature": Shown("evaporating temperature", "$T_e$", "K", 1.0),
    "operation.condensing_temperature": Shown("condensing temperature", "$T_c$", "K", 1.0),
    "operation.superheat": Shown("superheat", r"$\Delta T_\mathrm{sh}$", "K", 1.0),
    "operation.subcooling": Shown("subcooling", r"$\Delta T_\mathrm{sc}$", "K", 1.0),
}
_CUSTOMARY = {
    "Pa": ("bar", 1e-5),
    "rad/s": ("rpm", RPM),
    "rad": ("°", DEGREE),
    "Pa s": ("mPa s", 1e3),
    "m^3": ("cm³", 1e6),
    "J/(kg K)": ("kJ/(kg K)", 1e-3),
    "W/(m^2 K)": ("W/(m² K)", 1.0),
    "kg/m^3": ("kg/m³", 1.0),
    "1": ("", 1.0),
}


def shown_axis(axis: Axis) -> Shown:
    """Return how an axis of a sweep is shown; paths without a symbol of their own show their last words."""
    if axis.path in _AXES:
        return _AXES[axis.path]
    words = " ".join(axis.path.split(".")[-2:]).replace("_", " ")
    unit, factor = _CUSTOMARY.get(axis.units, (axis.units, 1.0))
    if axis.units in ("m", "m^2"):
        unit, factor = _length(axis)
    return Shown(words, "", unit, factor)


def _length(axis: Axis) -> tuple[str, float]:
    """Return the unit of lengths or areas: µm below 1 mm, mm² below 1 cm²."""
    largest = float(np.max(np.abs(axis.values)))
    if axis.units == "m":
        return ("µm", 1e6) if largest < 1e-3 else ("mm", 1e3)
    return ("mm²", 1e6) if largest < 1e-4 else ("cm²", 1e4)


def short(number: float) -> str:
    """Return a number as people write it in a figure, at most four digits: 5000, 0.25, 12."""
    rounded = float(f"{number:.4g}")
    return f"{rounded:.0f}" if 1e3 <= abs(rounded) < 1e6 else f"{rounded:g}".replace("-", "−")


def value_of(axis: Axis, index: int) -> str:
    """Return one value of an axis with its symbol and unit; a text stands for itself."""
    value = axis.values[index]
    return shown_axis(axis).value(float(value)) if is_numeric(axis) else f"{axis.path.split('.')[-1]}: {value}"


def is_numeric(axis: Axis) -> bool:
    """Return whether the values of an axis are numbers."""
    return axis.values.dtype.kind == "f"
