"""What is asked of a new scene: its kind, and what the command line states of it; the rest is the kind's own."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from screwsim.fluid import constants, names
from screwsim.fluid.oils import OILS
from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import UsageError
from screwsim.inputs.near import nearest
from screwsim.scene.units import NUMBER, Refused, over, parse_quantity
from screwsim.template import sizes

SPEED = 2950.0 * math.pi / 30.0  # [rad/s] of screws
ATMOSPHERE = 1e5  # [Pa] of the surroundings of a template, as ISO 1217 has it
_PAIR = re.compile(rf"\s*({NUMBER})\s*([^/,]*?)\s*/\s*({NUMBER})\s*([^,]*?)\s*(?:,\s*(.+?)\s*)?")


@dataclass(frozen=True)
class Condition:
    """Two lines: `low` and `high` as they are written with their unit, in SI, and what stands behind the comma."""

    low: float
    high: float
    low_text: str
    high_text: str
    beside: str = ""


@dataclass(frozen=True)
class Asked:
    """What the command states, in SI units; None of what the kind is to choose."""

    fluid: str | None = None
    flow: float | None = None  # displacement, [m^3/s]
    speed: float | None = None
    ratio: float | None = None  # built-in
    oil: str | None = None
    condition: str | None = None
    diameter: float | None = None  # of the male rotor, from which the flow follows


def asked_of(
    fluid: str | None,
    displacement: str | None,
    vi: float | None,
    speed: str | None,
    oil: str | None,
    condition: str | None,
    diameter: str | None = None,
) -> Asked:
    """Return what is asked for; raise UsageError, in one line, for what cannot be."""
    if fluid is not None and constants.limits(fluid) is None:
        other, blend = names.same_fluid(fluid), names.blend(fluid)
        hint = f"; did you mean '{other}'?" if other else f"; {blend}" if blend else ""
        hint = hint or " (write one of its names, e.g. R134a, R454B or CO2)"
        raise UsageError(f"--fluid {fluid}: is no fluid or blend of CoolProp{hint}")
    if oil is not None and oil not in OILS:
        near = nearest(oil, OILS)
        hint = f"; did you mean '{near}'?" if near else ""
        raise UsageError(f"--oil {oil}: is no stored oil{hint} (there are: {', '.join(OILS)})")
    if vi is not None and not 1.0 < vi <= 12.0:
        raise UsageError(f"--vi {vi:g}: a built-in volume ratio lies above 1 and at most at 12 (write e.g. --vi 3)")
    flow = None if displacement is None else _quantity("--displacement", "displacement", displacement, "600 m^3/h")
    at = None if speed is None else _quantity("--speed", "speed", speed, "2950 rpm")
    if diameter is None:
        return Asked(fluid, flow, at, vi, oil, condition)
    if flow is not None:
        raise UsageError("--diameter: is given beside --displacement, which states it, too (remove one of the two)")
    rotor = _quantity("--diameter", "length", diameter, "204 mm")
    if not sizes.SMALLEST <= rotor <= sizes.LARGEST:
        ends = f"{sizes.mm(sizes.SMALLEST)} to {sizes.mm(sizes.LARGEST)}"
        raise UsageError(f"--diameter {diameter}: screws are cut from {ends} (choose one within)")
    return Asked(fluid, sizes.displaced(rotor, at or SPEED), at, vi, oil, condition, rotor)


def _quantity(option: str, kind: str, text: str, example: str) -> float:
    """Return the value [SI] of an option; it is above nothing."""
    try:
        found = parse_quantity(KINDS[kind], text)
    except Refused as refusal:
        raise UsageError(f"{option} {text}: {refusal}") from None
    if not found > 0.0:
        raise UsageError(f"{option} {text}: is not above nothing (write e.g. {option} '{example}')")
    return found


def condition_of(text: str, kind: str, example: str) -> Condition:
    """Return two temperatures or pressures `LOW/HIGH UNIT`, the unit of the first that of the second if it has none.

    Gauge pressures are over `ATMOSPHERE`, which the scene then states.
    """
    match = _PAIR.fullmatch(text)
    if match is None:
        raise UsageError(f"--condition {text}: is no pair of {kind}s (write e.g. --condition '{example}')")
    low, unit, high, last, beside = match.groups()
    if not last:
        raise UsageError(f"--condition {text}: has no unit (write e.g. --condition '{example}')")
    texts = [f"{low} {unit or last}", f"{high} {last}"]
    try:
        with over(ATMOSPHERE):
            first, second = (parse_quantity(KINDS[kind], each) for each in texts)
    except Refused as refusal:
        raise UsageError(f"--condition {text}: {refusal}") from None
    return Condition(first, second, texts[0], texts[1], beside or "")


def beside_of(condition: Condition, kind: str, default: str) -> tuple[str, float]:
    """Return what stands behind the comma of a condition, as a quantity: its text and its value [SI]."""
    text = condition.beside or default
    try:
        return text, parse_quantity(KINDS[kind], text)
    except Refused as refusal:
        raise UsageError(f"--condition …, {text}: {refusal}") from None


def refused(option: str, asked: Any, why: str) -> None:
    """Raise UsageError where an option was given that a kind does not have."""
    if asked is not None:
        raise UsageError(f"{option}: {why}")
