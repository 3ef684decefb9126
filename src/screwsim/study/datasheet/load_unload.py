"""Load and unload control of an air package with a receiver: how often it switches, and its mean power (M471)."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import ceil, exp, floor, inf, log, log10
from typing import Any, NamedTuple, Self

from screwsim.effects.air_package import FREE_AIR, INPUT_POWER, Unloaded
from screwsim.inputs.declare import KINDS, Kind
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import in_bar
from screwsim.outputs.us_units import GALLON
from screwsim.scene.lines import Lines
from screwsim.scene.units import parse_quantity, refused_at
from screwsim.study.datasheet.units import METRIC, Units

OPTION, BAND_OPTION = "--receiver", "--band"
BAND = 0.7e5  # [Pa], usual: 10 psi (Marshall, processnpower.com, 2014)
PATH = "effects.air_package.unloaded"
VENTING = 40.0  # [s], usual (the United States DOE's sourcebook on compressed air, and its tool's default)


class Receiver(NamedTuple):
    """A plant's receiver [m³], and the band [Pa] between the pressures at which its package loads and unloads."""

    volume: float
    band: float = BAND
    assumed: bool = False  # the band

    def free_air(self, inlet_pressure: float) -> float:
        """Return the free air [m³] that it holds within its band, at one temperature, by the pressure [Pa] of inlet."""
        return self.volume * self.band / inlet_pressure

    def in_words(self, units: Units) -> str:
        """Return its size and band in words."""
        band = units.pressure_difference(self.band) + (" (assumed)" if self.assumed else "")
        return f"a receiver of {_size(self.volume, units)} and a band of {band}"

    def larger(self, factor: float, units: Units) -> str:
        """Return in words that one larger by a factor suffices: the time off load grows with its size."""
        unit = 1.0 if units == METRIC else GALLON
        step = unit * 10.0 ** (floor(log10(factor * self.volume / unit)) - 1)  # two digits, rounded up
        least = step * ceil(factor * self.volume / step)
        return f"a receiver of {_size(least, units)} would do, or a wider {BAND_OPTION}"


def _size(volume: float, units: Units) -> str:
    """Return a volume [m³] in words."""
    return f"{volume:.4g} m³" if units == METRIC else f"{volume / GALLON:.4g} gal"


class Cycle(NamedTuple):
    """Mean power [W] of a demand met by loading and unloading, share of the time on load, and cycles per second."""

    power: float
    loaded: float
    rate: float


def read_receiver(volume: str | None, band: str | None) -> Receiver | None:
    """Return the receiver of the options; raise UsageError in one line."""
    if volume is None:
        if band is not None:
            raise UsageError(f"{BAND_OPTION}: is the band of a receiver (add {OPTION}, e.g. {OPTION} '2 m^3')")
        return None
    return Receiver(
        _above_zero(OPTION, replace(KINDS["volume"], example="2 m^3"), volume),
        BAND if band is None else _above_zero(BAND_OPTION, KINDS["pressure_difference"], band),
        band is None,
    )


def check_receiver(receiver: Receiver, inlet: float, outlet: float, unloaded: Unloaded | None = None) -> None:
    """Raise UsageError where a band, or the separator off load, does not lie below the outlet's pressure [Pa]."""
    if receiver.band >= outlet - inlet:
        what = (
            f"{in_bar(receiver.band)} is not below the {in_bar(outlet - inlet)} of the package's outlet over its inlet"
        )
        raise UsageError(f"{BAND_OPTION}: {what} (choose a narrower one, e.g. 0.7 bar)")
    if unloaded is not None and unloaded.separator_pressure >= outlet:
        what = f"{in_bar(unloaded.separator_pressure)} is not below the {in_bar(outlet)} of the outlet"
        raise UsageError(f"{PATH}.separator_pressure: {what}, so nothing is vented (lower it)")


def _above_zero(option: str, kind: Kind, text: str) -> float:
    with refused_at(option):
        value = parse_quantity(kind, text)
    if not value > 0.0:
        raise UsageError(f"{option}: {text!r} is not above 0 (write e.g. '{kind.example}')")
    return value


@dataclass(frozen=True)
class LoadUnload:
    """What a package takes on load and off it, and what its receiver and its separator hold (M471)."""

    flow: float  # free air delivered on load [m³/s]
    power: float  # input power on load [W]
    stored: float  # free air between the ends of the receiver's band [m³]
    shut: float = 0.0  # input power with the inlet valve shut, before the separator is vented [W]
    idle: float = 0.0  # the same when it has been vented; 0 where the package stops [W]
    held: float = 1.0  # pressure of the separator before it is vented [Pa]
    vented: float = 1.0  # and after [Pa]
    venting: float = VENTING  # time that this takes [s]
    refill: float = 0.0  # free air that a pascal more in the separator takes [m³/Pa]
    words: str = ""  # how it vents and refills

    @classmethod
    def vents(
        cls, receiver: Receiver, at: Lines, loaded: Mapping[str, Any], unloaded: Unloaded, shut: float, idle: float
    ) -> Self:
        """Return that of a package by figures on load, and by its powers [W] off load before and after venting."""
        hot = loaded.get("mixture_discharge_temperature", loaded["discharge_temperature"])
        time, volume = unloaded.venting_time, unloaded.separator_volume
        vents = f"its separator is vented in {VENTING:g} s (assumed; {PATH}.venting_time)"
        vents = vents if time is None else f"its separator is vented in {time:g} s"
        refills = f"refilling it is not counted ({PATH}.separator_volume)"
        refills = refills if volume is None else "and refilled at the power on load"
        return cls(
            flow=loaded[FREE_AIR],
            power=loaded[INPUT_POWER],
            stored=receiver.free_air(at.p_s),
            shut=shut,
            idle=idle,
            held=at.p_d,
            vented=unloaded.separator_pressure,
            venting=VENTING if time is None else time,
            refill=(volume or 0.0) * at.T_s / (hot * at.p_s),
            words=f"{vents}, {refills}",
        )

    def cycle(self, demand: float) -> Cycle:
        """Return how a demand [m³/s] of free air below `flow` is met."""
        off = self.stored / demand if demand > 0.0 else inf
        if off == inf:
            return Cycle(self.idle, 0.0, 0.0)
        pressure, taken = self._off_load(off)
        refilling = self.refill * (self.held - pressure) / self.flow
        on = (self.stored + demand * refilling) / (self.flow - demand)
        period = off + refilling + on
        return Cycle((taken + self.power * (refilling + on)) / period, (refilling + on) / period, 1.0 / period)

    def _off_load(self, time: float) -> tuple[float, float]:
        """Return the pressure [Pa] in the separator after a time [s] off load, and the energy [J] taken."""
        fall = log(self.held / self.vented)
        if not fall > 0.0:
            return self.vented, self.idle * time
        vents, decay = min(time, self.venting), self.venting / fall
        pressure = self.held * exp(-vents / decay)
        above = decay * (self.held - pressure) - self.vented * vents  # [Pa s]
        return pressure, self.idle * time + (self.shut - self.idle) * above / (self.held - self.vented)
