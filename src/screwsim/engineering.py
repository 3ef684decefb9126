"""Numbers for people: the customary unit of a stored quantity [SI], its digits, its name in words.

One table for the screen, the figures and the page.
"""

from __future__ import annotations

import math

from screwsim.figures import declared
from screwsim.outputs import EFFICIENCY, Figure
from screwsim.scene.units import ZERO_CELSIUS

# SI unit -> (from this size on, factor, unit), largest first
SCALES = {
    "W": ((1e3, 1e-3, "kW"), (0.0, 1.0, "W")),
    "J": ((1e3, 1e-3, "kJ"), (0.0, 1.0, "J")),
    "m": ((1e-3, 1e3, "mm"), (0.0, 1e6, "µm")),
    "N": ((1e3, 1e-3, "kN"), (0.0, 1.0, "N")),
    "N m": ((0.0, 1.0, "N m"),),
    "m3": ((0.1, 1.0, "m³"), (0.0, 1e6, "cm³")),
    "m3 s-1": ((0.0, 3600.0, "m³/h"),),
    "m3 min-1": ((0.0, 60.0, "m³/min"),),  # of m3 s-1, where a figure is shown so
    "L min-1": ((0.0, 60000.0, "L/min"),),
    "rad": ((0.0, 180.0 / math.pi, "°"),),
    "rad s-1": ((0.0, 30.0 / math.pi, "rpm"),),
    "Pa": ((0.0, 1e-5, "bar"),),
    "kg": ((0.1, 1.0, "kg"), (0.0, 1e3, "g")),
    "kg s-1": ((0.0, 1.0, "kg/s"),),
    "kg h-1": ((0.0, 3600.0, "kg/h"),),  # of kg s-1, where a figure is shown so
    "W s m-3": ((0.0, 1e-3 / 60.0, "kW/(m³/min)"),),
    "J m-3": ((0.0, 1e-3, "kJ/m³"),),
}


def shown_name(name: str) -> str:
    """Return the name of a figure as a person writes it."""
    words = " ".join("COP" if word == "cop" else word for word in name.split("_"))
    return words.replace("built in", "built-in")


def scale(units: str, size: float) -> tuple[float, str]:
    """Return factor and customary unit of a quantity [SI unit] of that size; an unknown unit stays."""
    for least, factor, unit in SCALES.get(units, ()):
        if size >= least:
            return factor, unit
    return 1.0, units


def figure_scales(figure: Figure) -> tuple[tuple[float, float, str], ...]:
    """Return (from this size on, factor, unit) of a performance figure, largest first; K stays K."""
    if figure.units == "1":
        return ((0.0, 100.0, "%"),) if figure.scale == EFFICIENCY else ((0.0, 1.0, ""),)
    return SCALES.get(figure.shown or figure.units, ((0.0, 1.0, figure.units),))


def engineering(figure: Figure | str, value: float) -> tuple[str, str]:
    """Return a performance figure [SI] as number and unit for people: kW, bar, %, K with °C."""
    about = declared(figure) if isinstance(figure, str) else figure
    if about.units == "K":
        return f"{value:.2f}", f"K ({value - ZERO_CELSIUS:.2f} °C)"
    scales = figure_scales(about)
    factor, unit = next(((f, u) for least, f, u in scales if abs(value) >= least), (1.0, about.units))
    return digits(factor * value), unit


def engineering_temperature(T: float) -> str:
    """Return a temperature [K] with its degrees Celsius."""
    return f"{T:.2f} K ({T - ZERO_CELSIUS:.2f} °C)"


def quantity(units: str, value: float) -> str:
    """Return a quantity [SI] with its unit, four digits."""
    factor, unit = scale(units, abs(value))
    return f"{factor * value:.4g} {unit}"


def digits(value: float) -> str:
    """Return a number with five digits."""
    return f"{value:.5g}"


def small(value: float | None) -> str:
    """Return an error or a residual; nothing where there is none."""
    return "" if value is None else f"{value:.1e}"
