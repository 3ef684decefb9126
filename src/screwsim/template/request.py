"""The request for a new scene: what the command line states; each kind chooses the rest."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from screwsim.fluid import constants, names
from screwsim.fluid.oils import OILS
from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import did_you_mean
from screwsim.outputs.customary import HOUR, MINUTE, NORMAL_STATE, RPM, in_bar
from screwsim.outputs.us_units import CFM, STANDARD_STATE
from screwsim.scene.units import NUMBER, gauge_pressures_over, is_gauge, parse_quantity, refused_at
from screwsim.template import sizes

SPEED = 2950.0 * RPM  # [rad/s] of screws
ATMOSPHERE = 1e5  # [Pa] of a template's surroundings, as in ISO 1217
R = 8.314462618  # [J/(mol K)], CODATA 2018
NORMAL_DENSITY, STANDARD_DENSITY = (p / (R * T) for T, p in (NORMAL_STATE, STANDARD_STATE))  # [mol/m³] of an ideal gas
# [mol/s] of gas in one of each flow at a standard state, as an ideal gas; units in lower case without blanks and ^
STANDARD_FLOWS = {
    **dict.fromkeys(("nm3/h", "nm³/h"), NORMAL_DENSITY / HOUR),
    **dict.fromkeys(("nm3/min", "nm³/min"), NORMAL_DENSITY / MINUTE),
    "scfm": STANDARD_DENSITY * CFM,
    "mmscfd": STANDARD_DENSITY * CFM * 1e6 / (24.0 * 60.0),
}
_PAIR = re.compile(rf"\s*({NUMBER})\s*([^/,]*?)\s*/\s*({NUMBER})\s*([^,]*?)\s*(?:,\s*(.+?)\s*)?")


@dataclass(frozen=True)
class Condition:
    """Two lines: `low` and `high` in SI and as written with their units, and the text after the comma."""

    low: float
    high: float
    low_text: str
    high_text: str
    beside: str = ""


@dataclass(frozen=True)
class Stage:
    """What a machine is told as one stage of two: whether it is the `second`, and of a package what both share.

    `ambient` [Pa] is the reference of gauge pressures, `coolant` and its temperature [K] what cools the second stage,
    which draws in warm gas, and `motors` [W] the rated powers of both, by which the first states the fan. `condenses`:
    in one of both gas may condense, so that both follow its phases.
    """

    second: bool
    ambient: float = ATMOSPHERE
    coolant: str = ""
    T_coolant: float = 0.0
    motors: float | None = None
    condenses: bool = False


@dataclass(frozen=True)
class SceneRequest:
    """Values that the command states, in SI units; None where the kind is to choose."""

    fluid: str | None = None
    flow: float | None = None  # displacement, [m^3/s]
    speed: float | None = None
    ratio: float | None = None  # built-in
    oil: str | None = None
    condition: str | None = None
    diameter: float | None = None  # of the male rotor; determines the flow
    motor: float | None = None  # rated power, [W]
    free_air: float | None = None  # delivered by an air package or booster, at its inlet, [m^3/s]: its size is sought
    capacity: float | None = None  # cooling of a refrigeration machine, heating of a heat pump, [W]: likewise
    economizer: bool = False
    slide: bool = False  # a slide valve
    variable: bool = False  # with an inverter, and speeds to sweep
    sought: str = ""  # option for which the flow was sought with the cycle
    load: float | None = None  # of the motor, found with that flow, [W]
    molar: float | None = None  # delivered by a booster, [mol/s], of a flow at a standard state: its size is sought
    flow_text: str = ""  # what is to be delivered, as stated
    motor_text: str = ""  # the rated power, as stated
    stage: Stage | None = None  # of two in series

    @property
    def by_sheet(self) -> bool:
        """Whether the size is to be sought, from what the machine delivers or what its motor takes."""
        delivered = (self.free_air, self.molar, self.capacity)
        return any(each is not None for each in delivered) or (self.flow is None and self.motor is not None)


def request_of(
    *,
    fluid: str | None = None,
    displacement: str | None = None,
    diameter: str | None = None,
    vi: float | None = None,
    speed: str | None = None,
    oil: str | None = None,
    condition: str | None = None,
    motor: str | None = None,
    free_air: str | None = None,
    pressure: str | None = None,
    capacity: str | None = None,
    economizer: bool = False,
    slide: bool = False,
    variable: bool = False,
) -> SceneRequest:
    """Return the request; raise UsageError, in one line, for one that is impossible.

    `motor`, `free_air` and `pressure` are those on the sheet of an air package, the pressure that of its outlet;
    `motor` and `free_air` also those of a booster, whose flow may be at a standard state; `capacity` is the cooling of
    a refrigeration machine, or the heating of a heat pump.
    """
    condition = _by_pressure(condition, pressure)
    _check_names(fluid, oil)
    if vi is not None and not 1.0 < vi <= 12.0:
        raise UsageError(f"--vi {vi:g}: a built-in volume ratio is above 1 and at most 12 (write e.g. --vi 3)")
    flow = _quantity("--displacement", "displacement", displacement, "600 m^3/h")
    turns = _quantity("--speed", "speed", speed, "2950 rpm")
    rated = _quantity("--motor", "power", motor, "45 kW")
    molar = _standard_flow(free_air)
    delivered = _quantity("--flow", "volume_flow", free_air, "7.5 m^3/min") if molar is None else None
    duty = _quantity("--capacity", "power", capacity, "300 kW")
    for option, sought in (("--flow", free_air), ("--capacity", duty)):
        _refuse_both(option, sought, {"--displacement": displacement, "--diameter": diameter}, "the size")
    _refuse_both("--diameter", diameter, {"--displacement": displacement})
    rotor = _quantity("--diameter", "length", diameter, "204 mm")
    if rotor is not None:
        if not sizes.SMALLEST <= rotor <= sizes.LARGEST:
            ends = f"{sizes.mm(sizes.SMALLEST)} to {sizes.mm(sizes.LARGEST)}"
            raise UsageError(f"--diameter {diameter}: screws are made from {ends} (choose one within)")
        flow = sizes.displaced(rotor, turns or SPEED)
    return SceneRequest(
        fluid, flow, turns, vi, oil, condition, rotor, rated, delivered, duty, economizer, slide, variable,
        molar=molar, flow_text=free_air or "", motor_text=(motor or "").strip(),
    )  # fmt: skip


def _standard_flow(text: str | None) -> float | None:
    """Return a flow at a standard state [mol/s], such as '2000 Nm^3/h'; None for other texts."""
    match = re.fullmatch(rf"\s*({NUMBER})\s*(\S.*?)\s*", text or "")
    unit = "" if match is None else match[2].lower().replace("^", "").replace(" ", "")
    if match is None or unit not in STANDARD_FLOWS:
        return None
    if not float(match[1]) > 0.0:
        raise UsageError(f"--flow {text}: is not above zero (write e.g. --flow '2000 Nm^3/h')")
    return float(match[1]) * STANDARD_FLOWS[unit]


def _check_names(fluid: str | None, oil: str | None) -> None:
    """Raise UsageError for a fluid or an oil that is not known."""
    if fluid is not None and constants.limits(fluid) is None:
        lacks = names.why_no_blend(fluid)
        if lacks is not None:
            raise UsageError(f"--fluid {lacks}")
        if any(sign in fluid for sign in "/&,[{:"):
            what = "write a blend of your own as 'Methane/Ethane (0.9/0.1)' by mass, or '(mole 0.9/0.1)'"
            raise UsageError(f"--fluid {fluid}: is not a fluid of CoolProp ({what})")
        other, blend = names.same_fluid(fluid), names.suggested_blend(fluid)
        hint = f"; did you mean {other}?" if other else f"; {blend}" if blend else ""
        hint = hint or " (write one of its names, e.g. R134a, R454B or CO2)"
        raise UsageError(f"--fluid {fluid}: is not a fluid or blend of CoolProp{hint}")
    if oil is not None and oil not in OILS:
        raise UsageError(f"--oil {oil}: is not a stored oil{did_you_mean(oil, OILS)} (known: {', '.join(OILS)})")


def _refuse_both(option: str, value: Any, others: Mapping[str, Any], what: str = "it") -> None:
    """Raise UsageError where an option is given together with another that states the same."""
    other = next((name for name, given in others.items() if given is not None), None)
    if value is not None and other is not None:
        raise UsageError(f"{option}: is given together with {other}, which also states {what} (remove one of the two)")


def _by_pressure(condition: str | None, pressure: str | None) -> str | None:
    """Return both lines of a package that draws in ambient air and delivers it at a pressure."""
    if pressure is None:
        return condition
    _refuse_both("--pressure", pressure, {"--condition": condition})
    with gauge_pressures_over(ATMOSPHERE):
        found = _quantity("--pressure", "pressure", pressure, "7.5 bar(g)")
    if found is not None and found <= ATMOSPHERE:
        raise UsageError(f"--pressure {pressure}: is not above the ambient 1 bar (write e.g. --pressure '7.5 bar(g)')")
    return f"0 bar(g)/{pressure.strip()}"


def note_on_pressure(pressure: str | None) -> str:
    """Return that a package's outlet pressure is absolute, with its gauge pressure; empty for gauge pressures."""
    if pressure is None or is_gauge(pressure.strip()):
        return ""
    p = parse_quantity(KINDS["pressure"], pressure)
    gauge = f"for that as a gauge pressure write '{in_bar(p)}(g)'"
    return f"note: --pressure {pressure.strip()} is absolute, {in_bar(p - ATMOSPHERE)}(g) ({gauge})"


def _quantity(option: str, kind: str, text: str | None, example: str) -> float | None:
    """Return the value [SI] of an option, which must be positive; None where it is not given."""
    if text is None:
        return None
    with refused_at(f"{option} {text}"):
        found = parse_quantity(KINDS[kind], text)
    if not found > 0.0:
        raise UsageError(f"{option} {text}: is not above zero (write e.g. {option} '{example}')")
    return found


def condition_of(text: str, kind: str, example: str, ambient: float = ATMOSPHERE) -> Condition:
    """Return two temperatures or pressures `LOW/HIGH UNIT`; the first without a unit has that of the second.

    Gauge pressures are relative to the ambient one [Pa], which the scene then states.
    """
    match = _PAIR.fullmatch(text)
    if match is None:
        raise UsageError(f"--condition {text}: is not a pair of {kind}s (write e.g. --condition '{example}')")
    low, unit, high, last, beside = match.groups()
    if not last:
        raise UsageError(f"--condition {text}: has no unit (write e.g. --condition '{example}')")
    texts = [f"{low} {unit or last}", f"{high} {last}"]
    with refused_at(f"--condition {text}"), gauge_pressures_over(ambient):
        first, second = (parse_quantity(KINDS[kind], each) for each in texts)
    return Condition(first, second, texts[0], texts[1], beside or "")


def quantity_after_comma(condition: Condition, kind: str, default: str) -> tuple[str, float]:
    """Return the quantity after the comma of a condition: its text and its value [SI]."""
    text = condition.beside or default
    with refused_at(f"--condition …, {text}"):
        return text, parse_quantity(KINDS[kind], text)


def refuse_option(option: str, asked: Any, why: str) -> None:
    """Raise UsageError if an option was given that a kind does not have."""
    if asked is not None:
        raise UsageError(f"{option}: {why}")
