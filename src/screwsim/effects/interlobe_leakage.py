"""Interlobe leakage: the gap along the contact (sealing) line of the rotors, from compression to suction.

What: nozzle flow through gap × sealing-line length, M20. Across the sealing line of a compressing groove pair lies the
chamber that is filling in the same grooves, one revolution (z1 lobe pitches) behind it. On real rotors part of the line
runs over the male tip and leads to the chamber z1 + 1 pitches behind: `tip_length` states the length of that part, and
both parts then have angular windows of their own (M261, M262). With machine.volume.law: profile both lengths are
computed from the contact line by angle (docs/reference/rotors.md).
Source: ours. The length over the angle is a trapezium, full from 420° to 590° as is the sealing line computed from a
4/6 asymmetric profile with 300° wrap; that line is already 0.18 of its length at 330° and still 0.24 at 710°, where the
trapezium has 0 and 0.08. M261 and M262 are fitted to both parts of the lines of configs/rotors. The paper cites Amosov
et al. 1977.
Assumptions: quasi-steady nozzle with a flow coefficient; one mean clearance.
Parameters: gap, length (of the full sealing line) and tip_length (its part over the male tip; none with a profile),
flow_coefficient; area_file (of the path to the chamber z1 pitches behind).
"""

from dataclasses import dataclass
from math import pi

from screwsim.effects.base import Effect, Faults, FlowPath
from screwsim.effects.parts.gap import (
    AREA_TABLE,
    BIRTH,
    ClearanceParameters,
    check_formula,
    check_gap,
    gap_path,
    profile_paths,
    ramp,
)
from screwsim.effects.parts.gap_flow import numbers
from screwsim.effects.parts.usual import LEAK, Sized
from screwsim.inputs.declare import optional
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import CONTACT_GAP, LOBE, ROTORS, SPAN
from screwsim.numerics.kernel import kernel

TURN = 2.0 * pi
FULL = 60.0 / 360.0 * TURN  # the trailing (filling) chamber's angle at which the line reaches its full length
FALL = 230.0 / 360.0 * TURN  # … beyond which it shortens, to zero at 360°
BEGIN = -40.0 / 360.0 * TURN  # … at which the line on the flanks would begin, before the chamber exists
FLANK_FALL = 255.0 / 360.0 * TURN  # … beyond which the line on the flanks shortens, to zero at 360°
TIP_FALL = 690.0 / 360.0 * TURN  # the leading chamber's angle beyond which the line over the tip shortens


@dataclass(frozen=True)
class Parameters(ClearanceParameters):
    """Clearance and length of the full sealing line."""

    length: float | None = optional("length", "length of the full sealing line (no profile)")
    tip_length: float | None = optional(
        "length", "part of length that lies over the male tip (M261, M262; default: M20) (no profile)"
    )


@kernel
def area(phi, gap, length):
    """Return the interlobe area [m²] between chambers at phi and phi + 360° [rad] (M20)."""
    if phi >= TURN:
        return 0.0
    return gap * length * max(0.0, min(1.0, min(phi / FULL, (TURN - phi) / (TURN - FALL))))


@kernel
def flank_area(phi, gap, length):
    """Return the interlobe area [m²] on the flanks between chambers at phi and phi + 360° [rad] (M261)."""
    born = min(1.0, max(0.0, phi / BIRTH))
    line = max(0.0, min(1.0, min((phi - BEGIN) / (FULL - BEGIN), (TURN - phi) / (TURN - FLANK_FALL))))
    return gap * length * line * born * born * (3.0 - 2.0 * born)


@kernel
def tip_area(phi, gap, length, pitch):
    """Return the interlobe area [m²] over the male tip between chambers at phi and phi + 360° + pitch [rad] (M262)."""
    ahead = TURN + pitch
    return gap * length * ramp(phi, 0.0, BIRTH, TIP_FALL - ahead, 2.0 * TURN - ahead)


def build(parameters: Parameters, machine) -> list[FlowPath]:
    interfaces = machine.interfaces(CONTACT_GAP)
    if interfaces is not None and parameters.area_file is None:
        return profile_paths(parameters, interfaces, parameters.gap)
    gap, length, over_tip = parameters.gap, parameters.length or 0.0, parameters.tip_length
    if over_tip is None:
        values = {"gap": gap, "length": length}
        return [gap_path(parameters, area, values, breakpoints=(FULL, FALL, TURN), offset=machine.lobes)]
    ahead, bent = TURN + machine.pitch, (FULL, FLANK_FALL, TURN)
    corners = (0.0, BIRTH, TIP_FALL - ahead, 2.0 * TURN - ahead)
    flank, tip = {"gap": gap, "length": max(0.0, length - over_tip)}, {"gap": gap, "length": over_tip}
    return [
        gap_path(parameters, flank_area, flank, breakpoints=bent, corners=(BIRTH,), offset=machine.lobes),
        gap_path(parameters, tip_area, tip, breakpoints=(), corners=corners, offset=machine.lobes + 1, use_table=False),
    ]


def check(parameters: Parameters, facts) -> Faults:
    yield from check_gap("interlobe_leakage", parameters, facts, "length", "128 mm", "length of the full sealing line")
    over_tip, path = parameters.tip_length, "effects.interlobe_leakage.tip_length"
    if over_tip is not None:
        yield from check_formula(path, facts)
        if parameters.length is not None and over_tip > parameters.length:
            yield Fault(path, "is longer than length, of which it is a part (choose a shorter one)")


EFFECT = Effect(
    name="interlobe_leakage",
    title="gap along the rotors' contact line, to the chamber filling in the same grooves",
    equations=("M12", "M13", "M20", "M261", "M262"),
    source="ours, from the sealing line of a 4/6 profile",
    parameters=Parameters,
    build=build,
    check=check,
    numbers=numbers,
    needs=frozenset({CONTACT_GAP}),
    usual={ROTORS: LEAK},
    sizes=(
        Sized("gap", LOBE, 1.0, (0.0, 0.1)),
        Sized("length", SPAN, 30.0, (0.05, 3.0)),
        Sized("tip_length", SPAN, 30.0, (0.0, 2.0)),
        AREA_TABLE,
    ),
)
