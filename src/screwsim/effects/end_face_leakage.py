"""End-face leakage: the gap between the rotors' discharge end faces and the housing.

What: nozzle flow through gap × length, M22: a share to the chamber filling in the same grooves (across the contact
line, z1 pitches behind), the rest to the chamber one pitch behind (across a lobe).
Source: ours (the paper cites Amosov et al. 1977). Lengths are given by the user; the gap acts while the chamber
lies against the discharge end face under pressure, 360° to 720° of its angle, with cubic ramps of 20°. With
machine.volume.law: profile lengths and neighbours are those of the lobes by angle, on both faces
(docs/reference/rotors.md).
Assumptions: quasi-steady nozzle with a flow coefficient; one mean clearance.
Parameters: gap, length and suction_share (not with a profile), flow_coefficient; area_file (of the path to the next
chamber).
"""

from dataclasses import dataclass
from math import pi

from screwsim.effects.base import Effect, Faults, FlowPath
from screwsim.effects.parts.gap import (
    AREA_TABLE,
    ClearanceParameters,
    check_defaults,
    check_gap,
    gap_path,
    profile_paths,
    ramp,
)
from screwsim.effects.parts.gap_flow import numbers
from screwsim.effects.parts.usual import LEAK, Sized
from screwsim.inputs.declare import number, optional
from screwsim.machine.protocol import END_GAP, LOBE, ROTORS, SPAN
from screwsim.numerics.kernel import kernel

TURN = 2.0 * pi
RAMP = 20.0 * pi / 180.0


@dataclass(frozen=True)
class Parameters(ClearanceParameters):
    """Clearance, total length and how it is shared."""

    length: float | None = optional(
        "length", "length of the end-face gap of one chamber, both paths together (no profile)"
    )
    suction_share: float = number("share of the length towards the filling chamber (no profile)", 0.25, ge=0.0, le=1.0)


@kernel
def area(phi, gap, width, shift):
    """Return the end-face area [m²] between chambers at phi and phi + shift [rad] (M22)."""
    return gap * width * ramp(phi + shift, TURN, TURN + RAMP, 2.0 * TURN - RAMP, 2.0 * TURN)


def build(parameters: Parameters, machine) -> list[FlowPath]:
    interfaces, slides = machine.interfaces(END_GAP), machine.wall_speed(END_GAP)
    if interfaces is not None and parameters.area_file is None:
        return profile_paths(parameters, interfaces, parameters.gap, slides=slides)
    paths, length = [], parameters.length or 0.0
    for share, offset in ((1.0 - parameters.suction_share, 1), (parameters.suction_share, machine.lobes)):
        shift = offset * machine.pitch
        values = {"gap": parameters.gap, "width": share * length, "shift": shift}
        next_one = offset == 1
        corners = [at - shift for at in (TURN, TURN + RAMP, 2.0 * TURN - RAMP, 2.0 * TURN)]
        others = {"offset": offset, "use_table": next_one, "slides": slides if next_one else None}
        paths.append(gap_path(parameters, area, values, breakpoints=(), corners=corners, **others))
    return paths


def check(parameters: Parameters, facts) -> Faults:
    what = "length of the end-face gap of one chamber, both paths together"
    yield from check_gap("end_face_leakage", parameters, facts, "length", "128 mm", what, tabled=False)
    yield from check_defaults("end_face_leakage", parameters, facts, "suction_share")


EFFECT = Effect(
    name="end_face_leakage",
    title="gap at the discharge end face, to the next chamber and to the filling one",
    equations=("M12", "M13", "M22"),
    source="ours",
    parameters=Parameters,
    build=build,
    check=check,
    numbers=numbers,
    needs=frozenset({END_GAP}),
    usual={ROTORS: LEAK},
    sizes=(Sized("gap", LOBE, 1.0, (0.0, 0.1)), Sized("length", SPAN, 30.0, (0.01, 3.0)), AREA_TABLE),
)
