"""Numbers for people: customary unit, digits and readable name of a stored quantity [SI].

The same table serves the screen, the figures and the page.
"""

import re

from screwsim.figures import declared
from screwsim.outputs import EFFICIENCY, Figure
from screwsim.outputs.customary import SCALES, ZERO_CELSIUS, digits, printed_celsius
from screwsim.outputs.display import si_unit


def shown_name(name: str) -> str:
    """Return the name of a figure as people write it."""
    words = " ".join("COP" if word == "cop" else word for word in name.split("_"))
    return words.replace("built in", "built-in")


def figure_scales(figure: Figure) -> tuple[tuple[float, float, str], ...]:
    """Return (smallest size, factor, unit) of a performance figure, largest size first; K stays K."""
    if figure.units == "1":
        return ((0.0, 100.0, "%"),) if figure.scale == EFFICIENCY else ((0.0, 1.0, ""),)
    return SCALES.get(figure.shown or figure.units) or ((0.0, 1.0, printed_unit(figure.units)),)


def printed_unit(units: str) -> str:
    """Return a unit in CF style as it is printed beside customary ones: 'W m-2' gives W/m²."""
    return re.sub(r"(?<=[A-Za-z])([23])\b", lambda found: "²³"[int(found[1]) - 2], si_unit(units))


def engineering(figure: Figure | str, value: float) -> tuple[str, str]:
    """Return a performance figure [SI] as number and unit for people: kW, bar, %, K with °C."""
    about = declared(figure) if isinstance(figure, str) else figure
    if about.units == "K":
        return f"{value:.2f}", f"K ({printed_celsius(value)} °C)"
    factor, unit = figure_unit(about, value)
    return digits(factor * value), unit


def figure_text(figure: Figure | str, value: float) -> str:
    """Return a performance figure [SI] with its unit, as written in a sentence: a temperature in °C."""
    about = declared(figure) if isinstance(figure, str) else figure
    if about.units == "K":
        return f"{printed_celsius(value)} °C"
    return " ".join(engineering(about, value)).strip()


def figure_unit(figure: Figure, size: float) -> tuple[float, str]:
    """Return the factor and unit in which people write a performance figure of a given size [SI]; K stays K."""
    found = ((factor, unit) for least, factor, unit in figure_scales(figure) if abs(size) >= least)
    return next(found, (1.0, printed_unit(figure.units)))


def difference_unit(figure: Figure, size: float) -> tuple[float, str]:
    """Return the factor and unit in which people write a difference of a figure of a size [SI]: points for a share."""
    factor, unit = figure_unit(figure, size)
    return factor, "points" if unit == "%" else unit


def reading_unit(figure: Figure, size: float) -> tuple[float, str, float]:
    """Return factor and unit in which people read a figure of a given size [SI], and the offset taken off: °C for K."""
    return (1.0, "°C", ZERO_CELSIUS) if figure.units == "K" else (*figure_unit(figure, size), 0.0)


def error_text(name: str, value: float, error: float) -> str:
    """Return the relative error of a figure; in its unit where it exceeds the figure, or the figure is in °C."""
    if declared(name).units == "K":
        return f"{error:.0e} K" if error < 1e-3 else f"{error:.1g} K"
    return f"{error / abs(value):.0e}" if error <= abs(value) > 0.0 else figure_text(name, error)
