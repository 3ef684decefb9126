"""Customary units and digits of numbers [SI]: one table for screen, figures and pages."""

import math
import re

ZERO_CELSIUS = 273.15  # [K]
NORMAL_STATE = ZERO_CELSIUS, 101325.0  # [K], [Pa] of a normal cubic metre (DIN 1343)
RPM = math.pi / 30.0  # [rad/s]
MINUTE, HOUR = 60.0, 3600.0  # [s]
# SI unit -> (smallest size, factor, unit), largest size first
SCALES = {
    "W": ((1e3, 1e-3, "kW"), (0.0, 1.0, "W")),
    "J": ((1e3, 1e-3, "kJ"), (0.0, 1.0, "J")),
    "m": ((1e-3, 1e3, "mm"), (0.0, 1e6, "µm")),
    "N": ((1e3, 1e-3, "kN"), (0.0, 1.0, "N")),
    "N m": ((0.0, 1.0, "N m"),),
    "m3": ((0.1, 1.0, "m³"), (0.0, 1e6, "cm³")),
    "m3 s-1": ((0.0, 3600.0, "m³/h"),),
    "m3 min-1": ((0.0, 60.0, "m³/min"),),  # from m3 s-1, for figures shown in this unit
    "L min-1": ((0.0, 60000.0, "L/min"),),
    "kelvin": ((0.0, 1.0, "K"),),
    "rad": ((0.0, 180.0 / math.pi, "°"),),
    "rad s-1": ((0.0, 1.0 / RPM, "rpm"),),
    "Pa": ((0.0, 1e-5, "bar"),),
    "Pa s": ((0.0, 1e3, "mPa s"),),
    "kg": ((0.1, 1.0, "kg"), (0.0, 1e3, "g")),
    "kg s-1": ((0.0, 1.0, "kg/s"),),
    "kg h-1": ((0.0, 3600.0, "kg/h"),),  # from kg s-1, for figures shown in this unit
    "s": ((0.0, 1.0, "s"),),
    "h": ((0.0, 1.0 / 3600.0, "h"),),  # from s, for figures shown in this unit
    "W s m-3": ((0.0, 1e-3 / 60.0, "kW/(m³/min)"),),
    "J m-3": ((0.0, 1e-3, "kJ/m³"),),
}


def scale(units: str, size: float) -> tuple[float, str]:
    """Return factor and customary unit of a quantity [SI unit] of a given size; an unknown unit stays."""
    for least, factor, unit in SCALES.get(units, ()):
        if size >= least:
            return factor, unit
    return 1.0, units


def printed_celsius(T: float) -> str:
    """Return a temperature [K] in degrees Celsius as printed in results, to a hundredth, without the unit."""
    return f"{T - ZERO_CELSIUS:z.2f}"


def engineering_temperature(T: float) -> str:
    """Return a temperature [K] in kelvin and degrees Celsius."""
    return f"{T:.2f} K ({printed_celsius(T)} °C)"


def celsius(T: float) -> str:
    """Return a temperature [K] in degrees Celsius as a scene states it."""
    return f"{T - ZERO_CELSIUS:z.1f} degC"


def in_celsius(T: float) -> str:
    """Return a temperature [K] in degrees Celsius to a millikelvin, for messages that compare temperatures."""
    return f"{round(T - ZERO_CELSIUS, 3) + 0.0:g} degC"


def in_bar(p: float) -> str:
    """Return a pressure [Pa] in bar with six digits."""
    return f"{p / 1e5:.6g} bar"


def quantity(units: str, value: float) -> str:
    """Return a quantity [SI] with its unit and four digits."""
    factor, unit = scale(units, abs(value))
    return f"{factor * value:.4g} {unit}"


def digits(value: float) -> str:
    """Return a number with five digits."""
    return f"{value:.5g}"


def small_number_text(value: float | None) -> str:
    """Return an error or a residual as text; empty where there is none."""
    return "" if value is None else f"{value:.1e}"


def with_printed_units(text: str) -> str:
    """Return a text with units as they are printed: cm³, W/(m² K), °C. Scenes write cm^3 and degC."""
    text = re.sub(r"\bdegC\b", "°C", text)
    return re.sub(r"(?<=[a-z])\^([23])(?![0-9])", lambda found: "²³"[int(found[1]) - 2], text)
