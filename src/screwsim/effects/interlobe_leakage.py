"""Interlobe leakage: the gap along the contact (sealing) line of the rotors, from compression to suction.

What: nozzle flow through gap × sealing-line length, M20. Across the sealing line of a compressing groove pair lies
the chamber that is filling in the same grooves, one revolution (z1 lobe pitches) behind it.
With machine.volume.law: profile the length is that of the contact line by angle, and its part over the male tip leads
to the chamber z1 + 1 pitches behind (docs/reference/rotors.md).
Source: ours. The length over the angle is a trapezium, full from 420° to 590° as is the sealing line computed from a
4/6 asymmetric profile with 300° wrap; that line is already 0.18 of its length at 330° and still 0.24 at 710°, where
the trapezium has 0 and 0.08. The paper cites Amosov et al. 1977.
Assumptions: quasi-steady nozzle with a flow coefficient; one mean clearance.
Parameters: gap, length (of the full sealing line; none with a profile), flow_coefficient; area_file.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from screwsim.declare import quantity
from screwsim.effects.base import Effect, Faults, FlowPath
from screwsim.effects.gap import ClearanceParameters, check_gap, gap_path, profile_paths
from screwsim.effects.gap_flow import numbers
from screwsim.machine.protocol import CONTACT_GAP
from screwsim.numerics.kernel import kernel

TURN = 2.0 * pi
FULL = 60.0 / 360.0 * TURN  # the trailing (filling) chamber's angle at which the line is whole
FALL = 230.0 / 360.0 * TURN  # … from which on it gets shorter, down to nothing at 360°


@dataclass(frozen=True)
class Parameters(ClearanceParameters):
    """Clearance and length of the full sealing line."""

    length: float | None = quantity("length", "length of the full sealing line (no profile)", None, gt=0.0)


@kernel
def area(phi, gap, length):
    """Return the interlobe area [m²] between chambers at phi and phi + 360° [rad] (M20)."""
    if phi >= TURN:
        return 0.0
    return gap * length * max(0.0, min(1.0, min(phi / FULL, (TURN - phi) / (TURN - FALL))))


def build(parameters: Parameters, machine) -> list[FlowPath]:
    interfaces = machine.interfaces("interlobe_leakage")
    if interfaces is not None and parameters.area_file is None:
        return profile_paths(parameters, interfaces, parameters.gap)
    values = {"gap": parameters.gap, "length": parameters.length or 0.0}
    return [gap_path(parameters, area, values, breakpoints=(FULL, FALL, TURN), offset=machine.lobes)]


def check(parameters: Parameters, facts) -> Faults:
    return check_gap("interlobe_leakage", parameters, facts, "length", "128 mm", "length of the full sealing line")


EFFECT = Effect(
    name="interlobe_leakage",
    title="gap along the rotors' contact line, to the chamber filling in the same grooves",
    equations=("M12", "M13", "M20"),
    source="ours, from the sealing line of a 4/6 profile",
    parameters=Parameters,
    build=build,
    check=check,
    numbers=numbers,
    needs=frozenset({CONTACT_GAP}),
)
