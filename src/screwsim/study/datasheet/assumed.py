"""Limits that a sheet assumes of compressors whose oil leaves with the gas, where `--limit` states none.

Makers state others for each machine. Source: of the hottest mixture the lower end of usual cut-outs, 110 to 120 °C
(UNITEC-D, diagnostic guide "screw compressor: high discharge temperature"); of the oil, which shall be no colder than
refrigerant condenses and have at least 10 mm²/s, LG, operation and maintenance manual of water-cooled screw chillers
RCWW, p. 47. A result warns of a larger difference between gas and mixture (`evaluate.plausible.APART`).
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from screwsim.evaluate.plausible import gas_over_mixture
from screwsim.fluid.models import condenses
from screwsim.fluid.oils import OILS
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.scene import Scene
from screwsim.study.asked.figures import figures_of
from screwsim.study.asked.goals import Bound
from screwsim.study.datasheet.units import Units

GAS, MIXTURE, SUPPLY = "discharge_temperature", "mixture_discharge_temperature", "oil_supply_temperature"
SUPERHEAT = "discharge_superheat"
HOTTEST = ZERO_CELSIUS + 110.0  # [K] of gas and oil
APART = 30.0  # [K] of the gas over its mixture with the oil; below 27 K in all scenes of configs/
THINNEST = 10e-6  # [m²/s] of the oil, as it enters
MILLIKELVIN = 3  # digits to which differences of temperatures are known
SOURCE = "assumed"
ABOUT = "at discharge, and of oil as it enters; usual of makers (--limit states this machine's)"

Figures = Mapping[str, Any]


@dataclass(frozen=True)
class Assumed:
    """A limit of what follows from figures: its name for programs, its words, its value [SI] and how that is shown.

    Where figures do not have it, as above a critical pressure, it is within the limit.
    """

    figure: str
    words: str
    sign: str
    value: float
    shown: str
    of: Callable[[Figures], float | None]

    def excess_in(self, found: Figures) -> float:
        """Return by how much [SI] figures exceed it; negative within it."""
        value = self.of(found)
        if value is None:
            return -float("inf")
        return value - self.value if self.sign == "<" else self.value - value

    def in_words(self, units: Units) -> str:
        """Return the limit in words."""
        if self.shown == "degrees":
            text = units.degrees(self.value)
        else:
            text = units.difference(self.value) if self.shown == "kelvin" else f"{1e6 * self.value:.4g} mm²/s"
        return f"{self.words} {self.sign} {text}"


def assumed_limits(scene: Scene, stated: Iterable[Bound]) -> Iterator[Assumed]:
    """Yield the limits assumed of a scene; a stated limit of a discharge temperature replaces those of temperatures.

    What gas and oil have mixed, only a separator tells.
    """
    supply = scene.oil_supply
    if supply is None or scene.oil is None or scene.machine.expands:
        return
    if MIXTURE in figures_of(scene) and not {bound.figure for bound in stated} & {GAS, MIXTURE}:
        yield Assumed(MIXTURE, "mixture", "<", HOTTEST, "degrees", _mixture)
        yield Assumed("gas_over_mixture", "gas over mixture", "<", APART, "kelvin", gas_over_mixture)
    own = stated_temperature(scene)
    if condenses(scene.gas):
        above_dew = partial(_oil_over_dew_point, own)
        yield Assumed("oil_over_dew_point", "oil over dew point", ">", 0.0, "kelvin", above_dew)
    if scene.oil.name is not None:
        viscosity = partial(oil_viscosity, scene.oil.name, own)
        yield Assumed("oil_viscosity", "oil viscosity", ">", THINNEST, "viscosity", viscosity)


def stated_temperature(scene: Scene) -> float | None:
    """Return the temperature [K] that a scene states of its oil; None where it follows from the cycle."""
    supply = scene.oil_supply
    return supply.temperature if supply is not None and isinstance(supply.temperature, float) else None


def _mixture(found: Figures) -> float | None:
    return found.get(MIXTURE)


def _oil_over_dew_point(stated: float | None, found: Figures) -> float | None:
    """Return by how much [K] the oil enters warmer than the gas condenses at discharge; None where it does not."""
    oil, gas, superheat = found.get(SUPPLY, stated), found.get(GAS), found.get(SUPERHEAT)
    if oil is None or gas is None or superheat is None:
        return None
    return round(oil - (gas - superheat), MILLIKELVIN)


def oil_viscosity(name: str, stated: float | None, found: Figures) -> float | None:
    """Return the kinematic viscosity [m²/s] of a stored oil as it enters, without dissolved gas."""
    T, oil = found.get(SUPPLY, stated), OILS[name]
    return None if T is None else oil.viscosity_at(T) / oil.density_at(T)
