"""Tip leakage: gaps between the lobe tips and the housing, to the chambers ahead and behind.

What: nozzle flow through S_tip(φ) = 9.83 h D (φ/360° up to 360°, then 2 − φ/360°), M19, read as the area of all tips of
one chamber: an interface of two chambers has half of it, at the middle of their angles (M260). `reading: interface`
takes M19 for the area of every interface, by the angle of its trailing chamber; a chamber's tips then count twice.
Source: Chernov et al. 2015, eq. (19); M260: ours. An interface of the rotors of configs/rotors (L/D 1.1) is within 0.51
D of M260 over the 360° around its trailing chamber's largest volume, and 1 to 3 % shorter in the mean. With
machine.volume.law: profile the length is that of the male and the female tip that seal on the bores at an angle
(docs/reference/rotors.md).
Assumptions: quasi-steady nozzle with a flow coefficient; no oil film in the gap.
Parameters: gap, reading (not with a profile), flow_coefficient; area_file.
"""

from dataclasses import dataclass
from math import pi

from screwsim.effects.base import Effect, Faults, FlowPath
from screwsim.effects.parts.gap import AREA_TABLE, BIRTH, ClearanceParameters, check_gap, gap_path, profile_paths
from screwsim.effects.parts.gap_flow import numbers
from screwsim.effects.parts.usual import LEAK, Sized
from screwsim.inputs.declare import choice
from screwsim.machine.protocol import LOBE, ROTORS, TIP_GAP
from screwsim.numerics.kernel import kernel

TIP_LENGTH = 9.83  # tip length over rotor diameter, eq. (19)
TURN = 2.0 * pi


@dataclass(frozen=True)
class Parameters(ClearanceParameters):
    """Clearance, and whose area eq. (19) is."""

    reading: str = choice(
        "what the area of eq. (19) counts: all tips of a chamber (M260), or those of each interface (M19) (no profile)",
        ("chamber", "interface"),
        "chamber",
    )


@kernel
def all_tips(phi, gap, rotor_diameter):
    """Return the area [m²] of the paper's eq. (19) at phi [rad] (M19)."""
    x = phi / TURN
    return TIP_LENGTH * gap * rotor_diameter * max(0.0, x if x <= 1.0 else 2.0 - x)


@kernel
def area(phi, gap, rotor_diameter, pitch):
    """Return the tip area [m²] of the interface between chambers at phi and phi + pitch [rad] (M260)."""
    born = min(1.0, max(0.0, phi / BIRTH))
    return 0.5 * all_tips(phi + 0.5 * pitch, gap, rotor_diameter) * born * born * (3.0 - 2.0 * born)


def build(parameters: Parameters, machine) -> list[FlowPath]:
    interfaces, slides = machine.interfaces(TIP_GAP), machine.wall_speed(TIP_GAP)
    if interfaces is not None and parameters.area_file is None:
        return profile_paths(parameters, interfaces, parameters.gap, slides=slides)
    law, widest = (all_tips, TURN) if parameters.reading == "interface" else (area, TURN - 0.5 * machine.pitch)
    breakpoints = (widest, widest + TURN)
    others = {"breakpoints": breakpoints, "corners": (BIRTH,) if law is area else (), "offset": 1, "slides": slides}
    return [gap_path(parameters, law, {"gap": parameters.gap}, **others)]


def check(parameters: Parameters, facts) -> Faults:
    return check_gap("tip_leakage", parameters, facts)


EFFECT = Effect(
    name="tip_leakage",
    title="gaps between lobe tips and housing, to both neighbours",
    equations=("M12", "M13", "M19", "M260"),
    source="Chernov et al. 2015, eq. (19)",
    parameters=Parameters,
    build=build,
    check=check,
    numbers=numbers,
    needs=frozenset({TIP_GAP}),
    usual={ROTORS: LEAK},
    sizes=(Sized("gap", LOBE, 1.0, (0.0, 0.1)), AREA_TABLE),
)
