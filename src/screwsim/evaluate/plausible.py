"""Implausible figures, and scenes that lead nowhere: warnings on results that closed.

A cycle may close, and balance, on values that no machine has. `scene.plausible` checks what the scene says; this module
checks the figures, by the list of functions `DOUBTS`, and whether gas can enter and leave the chambers.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from screwsim.effects.base import LINES, FlowPath, HeatRate, Plenum, Wall
from screwsim.effects.parts.usual import WAY_IN, WAY_OUT
from screwsim.fluid.oils import OILS
from screwsim.model.parts import Parts
from screwsim.outputs import Figures
from screwsim.outputs.customary import in_bar, in_celsius
from screwsim.scene.left_out import suitable_effects
from screwsim.scene.lines import Lines
from screwsim.scene.types import Scene

DELIVERED = 1e-3  # volumetric efficiency above which a machine counts as one that delivers
ROUNDING = 1e-3  # tolerated excess of an efficiency above 1, besides its estimated error
RAM_FILLING = 0.05  # overfilling of a chamber, relative to its volume, that gas in motion may cause
LARGEST_LEAKAGE = 0.5  # of the displacement: leakage beyond the delivered flow above which gaps are implausible
APART = 70.0  # [K] of the gas over its mixture with the oil: drops that take up little leave up to 64 K
HOTTEST = 700.0  # [K], more than oil, seals and rotors endure
LARGEST_PRESSURE = 20.0  # times the higher line's pressure
NO_MACHINE = "so that it is impossible (check its effects)"


class Doubt(NamedTuple):
    """An implausibility in words, and the figure that no machine can have; None where a machine may have it."""

    words: str
    figure: str | None = None


@dataclass(frozen=True)
class CheckedCycle:
    """A closed cycle as it is checked: scene, parts, lines, figures and their errors."""

    scene: Scene
    parts: Parts
    lines: Lines
    found: Figures
    error: Figures

    @property
    def expands(self) -> bool:
        """Whether the machine is an expander."""
        return self.parts.geometry.expands

    def above(self, name: str, limit: float) -> float | None:
        """Return a figure that exceeds a limit by more than its error, else None."""
        value = self.found.get(name)
        slack = ROUNDING + (self.error.get(name) or 0.0)
        return value if value is not None and value > limit + slack * max(1.0, abs(limit)) else None


def _isothermal(checked: CheckedCycle) -> Iterator[Doubt]:
    eta = checked.above("isothermal_efficiency", 1.0)
    if eta is None or checked.expands:
        return
    words = f"the isothermal efficiency of {eta:.4g} is above 1"
    oil, T_s = checked.parts.oil, checked.lines.T_s
    if oil is not None and oil.temperature < T_s and checked.parts.all(HeatRate):
        yield Doubt(
            f"{words}: the oil comes in at {in_celsius(oil.temperature)}, colder than the suction gas of "
            f"{in_celsius(T_s)}, while the ideal of that figure is isothermal at the gas's temperature; the cooling "
            "of the oil is not counted"
        )
    elif checked.parts.all(Wall) or any(plenum.evaporates for _, plenum in checked.parts.all(Plenum)):
        yield Doubt(
            f"{words}: that requires walls, or evaporating liquid, colder than the suction gas; is that intended?"
        )
    else:
        what = f"{words}: nothing in the scene is colder than the suction gas, {NO_MACHINE}"
        yield Doubt(what, "isothermal_efficiency")


def _isentropic(checked: CheckedCycle) -> Iterator[Doubt]:
    eta = checked.above("isentropic_efficiency", 1.0)
    if eta is None:
        return
    words = f"the isentropic efficiency of {eta:.4g} is above 1"
    ideal = "the gas during compression, while the ideal of that figure has no cooling"
    if checked.expands and checked.parts.all(HeatRate):
        yield Doubt(f"{words}: oil warms the gas during expansion, while the ideal of that figure has no heat")
    elif checked.expands:
        yield Doubt(f"{words}: no expander gives more than the ideal one (check its effects)", "isentropic_efficiency")
    elif checked.parts.all(HeatRate):
        yield Doubt(f"{words}: oil cools {ideal}")
    elif checked.parts.all(Wall) or any(plenum.evaporates for _, plenum in checked.parts.all(Plenum)):
        yield Doubt(f"{words}: walls or liquid cool {ideal}")
    else:
        yield Doubt(f"{words}: nothing in the scene cools the gas, {NO_MACHINE}", "isentropic_efficiency")


def _volumetric(checked: CheckedCycle) -> Iterator[Doubt]:
    name = "volumetric_efficiency"
    filled, found = checked.above(name, 1.0 + RAM_FILLING), checked.found.get(name)
    if checked.expands:
        return
    if filled is not None:
        yield Doubt(
            f"the volumetric efficiency of {filled:.4g} is above 1: the chambers take in more gas than fills them at "
            "the state of the suction line; colder oil, or the inertia of the gas, can add a few percent"
        )
    elif found is not None and found < -LARGEST_LEAKAGE:
        yield Doubt(
            f"the volumetric efficiency is {found:.4g}: more flows back through leaks than the rotors displace; no "
            "machine has gaps or areas so wide (check gaps and speed)",
            name,
        )


def _driven(checked: CheckedCycle) -> Iterator[Doubt]:
    power, filled = checked.found.get("shaft_power"), checked.found.get("volumetric_efficiency")
    if not (checked.expands or power is None or filled is None or power > 0.0 or filled < DELIVERED):
        what = f"the shaft power is {power:.4g} W: no compressor that delivers gas produces power (check its effects)"
        yield Doubt(what, "shaft_power")


def _carnot(checked: CheckedCycle) -> Iterator[Doubt]:
    operation, cop = checked.scene.operation, checked.found.get("cop")
    T_e, T_c = operation.evaporating_temperature, operation.condensing_temperature
    if not (cop is None or T_e is None or T_c is None or T_c <= T_e or cop <= T_e / (T_c - T_e)):
        yield Doubt(
            f"the COP of {cop:.4g} is above Carnot's {T_e / (T_c - T_e):.4g} between the two temperatures: subcooling "
            "or oil removes heat that no figure counts (check operation.subcooling and oil_supply.temperature)",
            "cop",
        )


def _hot(checked: CheckedCycle) -> Iterator[Doubt]:
    T = checked.found.get("discharge_temperature")
    if not (T is None or T <= HOTTEST or checked.expands):
        words = f"the gas leaves at {in_celsius(T)}, and no machine withstands {in_celsius(HOTTEST)}"
        yield Doubt(f"{words} (use more or cooler oil, or a lower pressure ratio)", "discharge_temperature")


def gas_over_mixture(found: Mapping[str, Any]) -> float | None:
    """Return by how much [K] the gas leaves hotter than mixed with its oil; None without either."""
    gas, mixture = (found.get(name) for name in ("discharge_temperature", "mixture_discharge_temperature"))
    return None if gas is None or mixture is None else gas - mixture


def _apart(checked: CheckedCycle) -> Iterator[Doubt]:
    found, over = checked.found, gas_over_mixture(checked.found)
    if not (over is None or over <= APART or found["discharge_temperature"] > HOTTEST or checked.expands):
        gas, mixture = (in_celsius(found[name]) for name in ("discharge_temperature", "mixture_discharge_temperature"))
        words = f"the gas leaves at {gas}, and mixed with its oil at {mixture}"
        why = f"more than {APART:g} K apart, so that the oil hardly cools the gas"
        yield Doubt(f"{words}: {why} (use more oil, or warmer oil where gas condenses on it)")


def _oil_known(checked: CheckedCycle) -> Iterator[Doubt]:
    oil = checked.scene.oil
    if oil is None or oil.name is None:
        return
    names, of = ("oil_discharge_temperature", "mixture_discharge_temperature"), OILS[oil.name]
    seen = [T for T in map(checked.found.get, names) if T is not None]
    T, left = max(seen, default=0.0), "the oil leaves at"
    if of.high < T <= HOTTEST:
        words = f"{left} {in_celsius(T)}, above the {in_celsius(of.high)} up to which {oil.name} is known"
        yield Doubt(f"{words} (use more or cooler oil)")
    if seen and min(seen) < of.low:
        words = f"{left} {in_celsius(min(seen))}, below the {in_celsius(of.low)} from which {oil.name} is known"
        yield Doubt(f"{words} (use more or warmer oil)")


def _burst(checked: CheckedCycle) -> Iterator[Doubt]:
    peak, line = checked.found.get("peak_pressure"), max(checked.lines.p_s, checked.lines.p_d)
    if not (peak is None or peak <= LARGEST_PRESSURE * line):
        what = f"the chamber reaches {in_bar(peak)}, {peak / line:.3g} times the higher line's pressure"
        yield Doubt(f"{what}, which no housing withstands (open the discharge port earlier or wider)", "peak_pressure")


DOUBTS = (_isothermal, _isentropic, _volumetric, _driven, _carnot, _hot, _apart, _oil_known, _burst)


def lines_met(parts: Parts) -> set[str]:
    """Return the lines and plenums to which ports or valves lead."""
    return {path.to for _, path in parts.all(FlowPath) if not path.beside}


def blocked_paths(scene: Scene, parts: Parts) -> tuple[str, ...]:
    """Return messages where nothing leads from the suction line into a chamber, or from it to the discharge line."""
    found, leads = [], lines_met(parts)
    roles = WAY_IN, WAY_OUT
    ways = "from the suction line into", "to the discharge line out of"
    for line, role, way in zip(LINES, reversed(roles) if parts.geometry.expands else roles, ways, strict=True):
        if line in leads:
            continue
        named = [name for name, effect in suitable_effects(scene).items() if role in effect.roles]
        remedy = f"name {' or '.join(f'effects.{name}' for name in named) or 'an effect that opens one'}"
        given = [f"machine.{name}" for name in named if getattr(scene.machine, name, None) is not None]
        beside = f"; {given[0]} is given, but only named effects are simulated" if given else ""
        found.append(f"no port or valve leads {way} the chambers ({remedy}{beside})")
    return tuple(found)
