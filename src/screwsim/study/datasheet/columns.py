"""Columns of a sheet: figures in a unit, with the decimals that suit them."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from screwsim.study.datasheet.units import METRIC, Measure, Units

KW, PERCENT, BAR = 1e-3, 100.0, 1e-5
NONE = "–"
GAS_OUT, MIXTURE = "discharge_temperature", "mixture_discharge_temperature"
MEASURES = {"kW": "power", "bar": "pressure", "kg/h": "mass_flow", "m³/h": "swept", "L/min": "oil"}


class Column(NamedTuple):
    """A figure in a sheet: its name, its title with the unit, factor from SI, decimals.

    With `celsius` it is a temperature, in the degrees of `units`.
    """

    figure: str
    title: str
    factor: float
    decimals: int
    celsius: bool = False
    units: Units = METRIC

    def value(self, found: Mapping[str, Any]) -> float | None:
        """Return the column's value among figures [SI], None where it has none."""
        value = found.get(self.figure)
        if value is None:
            return None
        return self.units.temperature(value) if self.celsius else self.factor * value + 0.0

    @property
    def unit(self) -> str:
        """The unit in its title; '' without one."""
        return self.title.partition("[")[2].removesuffix("]")

    def cell(self, found: Mapping[str, Any]) -> str:
        """Return the column's value as text."""
        value = self.value(found)
        return NONE if value is None else f"{value + 0.0:.{self.decimals}f}"


def decimals_of(size: float) -> int:
    """Return the decimals of a column, from the size of its value at the scene's own point."""
    return next((decimals for decimals, least in enumerate((1000.0, 20.0, 2.0)) if size >= least), 3)


def measured(figure: str, title: str, measure: Measure, own: float, most: int = 3) -> Column:
    """Return the column of a figure in a unit; its decimals, `most` at the most, suit the size `own` [SI]."""
    factor, unit = measure
    return Column(figure, f"{title} [{unit}]", factor, min(decimals_of(abs(factor) * own), most))


def in_units(column: Column, units: Units) -> Column:
    """Return a column of metric units in others; its unit is in brackets, or the last word of its title."""
    own = column.unit or column.title.rpartition(" ")[2]
    if units == METRIC or not (column.celsius or own in MEASURES):
        return column
    if column.celsius:
        return column._replace(title=column.title.replace(own, units.degree), units=units)
    factor, unit = units.heat if column.figure.endswith("duty") else getattr(units, MEASURES[own])
    decimals = max(column.decimals - round(math.log10(factor / column.factor)), 0)
    return column._replace(title=column.title.replace(own, unit), factor=factor, decimals=decimals)


def temperatures(figure: str, title: str, units: Units) -> Column:
    """Return the column of a temperature."""
    return Column(figure, f"{title} [{units.degree}]", 1.0, 1, True, units)


def outlet_temperatures(own: Mapping[str, Any], oiled: bool, what: str, units: Units) -> tuple[Column, ...]:
    """Return the columns of the temperature behind a machine: of gas and oil mixed, which is measured, and of the gas.

    `own` are the figures at the scene's own point, `what` begins the titles.
    """
    gas = temperatures(GAS_OUT, f"{what} temperature, the gas alone" if oiled else f"{what} temperature", units)
    if own.get(MIXTURE) is None:
        return (gas,)
    return temperatures(MIXTURE, f"{what} temperature, gas and oil mixed", units), gas
