"""Tip leakage: gaps between the lobe tips and the housing, to the chambers ahead and behind.

What: nozzle flow through S_tip(φ) = 9.83 h D (φ/360° up to 360°, then 2 − φ/360°), M19. One area an interface: that
of the trailing chamber's angle is its leading tip; its trailing tip is the next interface.
Source: Chernov et al. 2015, eq. (19). The length 9.83 D is the paper's, empirical: the tip helices of both rotors
together are 11.8 D at L/D = 1.1 by geometry. With machine.volume.law: profile the length is that of the male and the
female tip that seal on the bores at an angle (docs/reference/rotors.md).
Assumptions: quasi-steady nozzle with a flow coefficient; no oil film in the gap.
Parameters: gap, flow_coefficient; area_file.
"""

from __future__ import annotations

from math import pi

from screwsim.effects.base import Effect, Faults, FlowPath
from screwsim.effects.gap import ClearanceParameters, check_gap, gap_path, profile_paths
from screwsim.effects.gap_flow import numbers
from screwsim.machine.protocol import TIP_GAP
from screwsim.numerics.kernel import kernel

TIP_LENGTH = 9.83  # tip length over rotor diameter, eq. (19)
TURN = 2.0 * pi


@kernel
def area(phi, gap, rotor_diameter):
    """Return the tip area [m²] of the interface ahead of a chamber at phi [rad] (M19)."""
    x = phi / TURN
    return TIP_LENGTH * gap * rotor_diameter * max(0.0, x if x <= 1.0 else 2.0 - x)


def build(parameters: ClearanceParameters, machine) -> list[FlowPath]:
    interfaces, slides = machine.interfaces("tip_leakage"), machine.wall_speed("tip_leakage")
    if interfaces is not None and parameters.area_file is None:
        return profile_paths(parameters, interfaces, parameters.gap, slides=slides)
    return [gap_path(parameters, area, {"gap": parameters.gap}, breakpoints=(TURN,), offset=1, slides=slides)]


def check(parameters: ClearanceParameters, facts) -> Faults:
    return check_gap("tip_leakage", parameters, facts)


EFFECT = Effect(
    name="tip_leakage",
    title="gaps between lobe tips and housing, to both neighbours",
    equations=("M12", "M13", "M19"),
    source="Chernov et al. 2015, eq. (19)",
    parameters=ClearanceParameters,
    build=build,
    check=check,
    numbers=numbers,
    needs=frozenset({TIP_GAP}),
)
