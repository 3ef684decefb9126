"""Units in which a sheet is printed: the program's customary ones, or those of the United States.

Pressures are absolute but where it says over the inlet. Volume flows of air are those delivered, at inlet conditions
(ISO 1217; acfm); standard flows those of the ideal gas at the stated conditions. A sheet's document is in SI units.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from screwsim.outputs import customary
from screwsim.outputs.customary import HOUR, MINUTE, NORMAL_STATE, ZERO_CELSIUS
from screwsim.outputs.us_units import (
    BTU,
    CFM,
    FOOT,
    GALLON,
    HORSEPOWER,
    INCH,
    POUND,
    POUND_FORCE,
    PSI,
    STANDARD_STATE,
    TON,
)


class Measure(NamedTuple):
    """A unit and the factor to it from SI."""

    factor: float
    unit: str


class Standard(NamedTuple):
    """Conditions of a standard volume flow [K, Pa], its unit with the factor from m³/s, and the conditions in words."""

    T: float
    p: float
    flow: Measure
    words: str


@dataclass(frozen=True)
class Units:
    """The units of a sheet; `other` are those of quantities in words, by their SI unit, where they differ."""

    power: Measure
    heat: Measure
    cooling: Measure
    mass_flow: Measure
    pressure: Measure
    swept: Measure
    oil: Measure
    force: Measure
    standard: Standard
    degree: str
    other: Mapping[str, Measure]

    def quantity(self, si: str, value: float) -> str:
        """Return a quantity [SI] with its unit and four digits."""
        if si not in self.other:
            return customary.quantity(si, value)
        factor, unit = self.other[si]
        return f"{factor * value:.4g} {unit}"

    def pressure_difference(self, value: float, si: str = "Pa") -> str:
        """Return a difference of pressures [SI] with its unit, which is not that of absolute ones in every system."""
        return self.quantity(si, value).replace("psia", "psi")

    def temperature(self, T: float) -> float:
        """Return a temperature [K] in °C or °F, without the rounding of 273.15."""
        found = round(T - ZERO_CELSIUS, 6) + 0.0
        return found if self.degree == "°C" else 32.0 + 1.8 * found

    def difference(self, kelvin: float) -> str:
        """Return a difference of temperatures [K] with its unit."""
        return f"{kelvin:.4g} K" if self.degree == "°C" else f"{1.8 * kelvin:.4g} °F"

    def degrees(self, T: float, digits: str = ".4g") -> str:
        """Return a temperature [K] with its unit."""
        return f"{self.temperature(T):{digits}} {self.degree}"


METRIC = Units(
    power=Measure(1e-3, "kW"),
    heat=Measure(1e-3, "kW"),
    cooling=Measure(1e-3, "kW"),
    mass_flow=Measure(HOUR, "kg/h"),
    pressure=Measure(1e-5, "bar"),
    swept=Measure(HOUR, "m³/h"),
    oil=Measure(1e3 * MINUTE, "L/min"),
    force=Measure(1e-3, "kN"),
    standard=Standard(*NORMAL_STATE, Measure(HOUR, "Nm³/h"), "0 °C and 1.01325 bar"),
    degree="°C",
    other={},
)
US = Units(
    power=Measure(1.0 / HORSEPOWER, "hp"),
    heat=Measure(1e-3 * HOUR / BTU, "MBH"),
    cooling=Measure(1.0 / TON, "tons"),
    mass_flow=Measure(HOUR / POUND, "lb/h"),
    pressure=Measure(1.0 / PSI, "psia"),
    swept=Measure(1.0 / CFM, "cfm"),
    oil=Measure(MINUTE / GALLON, "gpm"),
    force=Measure(1.0 / POUND_FORCE, "lbf"),
    standard=Standard(*STANDARD_STATE, Measure(1.0 / CFM, "scfm"), "60 °F and 14.696 psia"),
    degree="°F",
    other={
        "W": Measure(1.0 / HORSEPOWER, "hp"),
        "Pa": Measure(1.0 / PSI, "psia"),
        "m3 s-1": Measure(1.0 / CFM, "cfm"),
        "m3 min-1": Measure(1.0 / CFM, "cfm"),
        "L min-1": Measure(MINUTE / GALLON, "gpm"),
        "kg s-1": Measure(HOUR / POUND, "lb/h"),
        "kg h-1": Measure(HOUR / POUND, "lb/h"),
        "W s m-3": Measure(100.0 * CFM / HORSEPOWER, "hp/(100 cfm)"),
        "m": Measure(12.0 / FOOT, "in"),
        "m3": Measure(1.0 / INCH**3, "in³"),
        "kg": Measure(1.0 / POUND, "lb"),
        "N": Measure(1.0 / POUND_FORCE, "lbf"),
        "N m": Measure(1.0 / (POUND_FORCE * FOOT), "lbf ft"),
        "J": Measure(1.0 / (POUND_FORCE * FOOT), "ft lbf"),
        "J m-3": Measure(FOOT**3 / BTU, "Btu/ft³"),
    },
)
BY_NAME = {"metric": METRIC, "us": US}
