"""Ratings of semi-hermetic reciprocating compressors on R404A (validation/energyplus), as isentropic efficiencies."""

from __future__ import annotations

from pathlib import Path

from CoolProp.CoolProp import PropsSI

from screwsim.study.validation import read_table

RATINGS = Path(__file__).parents[1] / "energyplus" / "reciprocating.csv"
SUCTION = 291.45  # [K] at which they are rated
POINTS = (
    ("-10/40", 28.3),
    ("-17.8/40", 36.1),
    ("-6.7/48.9", 25),
)  # °C, and superheat [K] of the suction gas of 18.3 °C


def ratings(evaporating: float, condensing: float) -> list[float]:
    """Return the isentropic efficiencies of the electrical power by the ratings, at saturation temperatures [K]."""
    values: dict[str, dict[str, float]] = {}
    x, y = evaporating - 273.15, condensing - 273.15
    terms = (1.0, x, x * x, y, y * y, x * y, x**3, y**3, x * x * y, x * y * y)
    for each in read_table(RATINGS):
        watts = sum(float(each[f"c{i}"]) * term for i, term in enumerate(terms))
        values.setdefault(each["model"], {})[each["figure"]] = watts
    low, high = (PropsSI("P", "T", T, "Q", 1, "R404A") for T in (evaporating, condensing))
    h, s = (PropsSI(name, "T", SUCTION, "P", low, "R404A") for name in "HS")
    rise = PropsSI("H", "P", high, "S", s, "R404A") - h
    cooling = h - PropsSI("H", "T", condensing, "Q", 0, "R404A")
    return [each["capacity"] / cooling * rise / each["power"] for each in values.values()]
