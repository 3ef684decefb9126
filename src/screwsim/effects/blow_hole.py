"""Blow-hole: the opening at the housing cusp between a chamber and the one behind it.

What: nozzle flow through a constant area while the separating lobe crosses the cusp, M21. With `model: homogeneous` gas
and oil of the chamber pass as one fluid: the oil's inertia slows the gas (M192 of an opening without depth).
Source: ours. By geometry (4/6 asymmetric profile, 300° wrap) the lobe behind a chamber crosses the cusp from about 383°
to 683° of that chamber's angle; the area is constant between, with cubic ramps of 20° at both ends. `suction_area` adds
the blow-hole at the suction cusp, which is still open when suction closes: the chamber that begins to compress leaks
through it into the chamber behind, which is still filling (M263). With machine.volume.law: profile the area by angle is
computed from the profile, at both cusps (docs/reference/rotors.md); a given `area` rescales the curve at the
high-pressure cusp to that largest value.
Assumptions: quasi-steady nozzle, past which oil goes without slowing the gas, or with it at one speed; without a
profile and without suction_area the compression-side blow-hole only.
Parameters: area (one blow-hole), opens, closes, suction_area, suction_closes (angles of the leading chamber; these
four not with a profile), flow_coefficient, model; area_file (in place of the high-pressure cusp's area, or of both
curves of a profile).
"""

from dataclasses import dataclass
from math import pi

from screwsim.effects.base import Effect, Faults, FlowPath, Resistance
from screwsim.effects.parts import gap_flow
from screwsim.effects.parts.gap import (
    AREA_TABLE,
    GapParameters,
    check_defaults,
    check_formula,
    check_gap,
    check_unused,
    gap_path,
    profile_paths,
    ramp,
)
from screwsim.effects.parts.usual import LEAK, Sized
from screwsim.inputs.declare import choice, optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.profile_law import sized_holes
from screwsim.machine.protocol import BLOW_HOLE, ROTORS, SQUARE
from screwsim.numerics.kernel import kernel

DEGREE = pi / 180.0
TURN = 2.0 * pi
RAMP = 20.0 * DEGREE
SHUTTING = 40.0 * DEGREE  # angle over which the lobe closes the blow-hole at the suction cusp


@dataclass(frozen=True)
class Parameters(GapParameters):
    """Area of one blow-hole and the angles of the leading chamber between which it exists."""

    area: float | None = optional("area", "area of one blow-hole (default with a profile: from the profile)")
    opens: float = quantity(
        "angle", "angle of the leading chamber at which it opens (no profile)", 373.0 * DEGREE, ge=0.0
    )
    closes: float = quantity(
        "angle", "angle of the leading chamber at which it closes (no profile)", 693.0 * DEGREE, le=4 * pi
    )
    suction_area: float | None = optional(
        "area", "area of the blow-hole at the suction cusp (M263; default: none) (no profile)"
    )
    suction_closes: float = quantity(
        "angle",
        "angle of the leading chamber at which that one closes (no profile)",
        420.0 * DEGREE,
        ge=TURN + SHUTTING,
        le=2.0 * TURN,
    )
    model: str | None = choice(
        "flow model (M190): homogeneous: gas and oil as one fluid (M192); default: nozzle, of the gas alone",
        tuple(gap_flow.HOLES),
        None,
    )

    def resistance(self, slides: float | None = None) -> Resistance | None:
        return gap_flow.HOLES[self.model or gap_flow.NOZZLE]


@kernel
def area(phi, size, pitch, opens, closes):
    """Return the blow-hole area [m²] between chambers at phi and phi + pitch [rad] (M21)."""
    leading = phi + pitch
    return size * ramp(leading, opens, opens + RAMP, closes - RAMP, closes)


@kernel
def suction_side(phi, size, pitch, closes):
    """Return the area [m²] of the suction cusp's blow-hole between chambers at phi and phi + pitch [rad] (M263)."""
    return size * ramp(phi + pitch, TURN - RAMP, TURN, closes - SHUTTING, closes)


def build(parameters: Parameters, machine) -> list[FlowPath]:
    interfaces = machine.interfaces(BLOW_HOLE)
    if interfaces is not None and parameters.area_file is None:
        return profile_paths(parameters, sized_holes(interfaces, parameters.area))
    opens, closes = parameters.opens, parameters.closes
    values = {"size": parameters.area or 0.0, "opens": opens, "closes": closes}
    corners = [at - machine.pitch for at in (opens, opens + RAMP, closes - RAMP, closes)]
    paths = [gap_path(parameters, area, values, breakpoints=(), corners=corners, offset=1)]
    if interfaces is None and parameters.suction_area is not None:
        values = {"size": parameters.suction_area, "closes": parameters.suction_closes}
        shuts = parameters.suction_closes
        corners = [at - machine.pitch for at in (TURN - RAMP, TURN, shuts - SHUTTING, shuts)]
        others = {"breakpoints": (), "corners": corners, "offset": 1, "use_table": False}
        paths.append(gap_path(parameters, suction_side, values, **others))
    return paths


def check(parameters: Parameters, facts) -> Faults:
    yield from check_gap("blow_hole", parameters, facts, "area", "6 mm^2", "area of one blow-hole")
    if parameters.suction_area is not None:
        yield from check_formula("effects.blow_hole.suction_area", facts)
    yield from check_defaults("blow_hole", parameters, facts, "opens", "closes", "suction_closes")
    profiled = bool(facts.machine.finds_gaps)
    if parameters.area_file is not None:
        what = "is stated as well as area_file, whose table says where the area is open (remove one of the two)"
        yield from check_unused("blow_hole", parameters, what, "opens", "closes", *(["suction_closes"] * profiled))
    if parameters.suction_area is None and not profiled:
        what = "has no meaning without suction_area, whose end it is (state that, or remove this)"
        yield from check_unused("blow_hole", parameters, what, "suction_closes")
    if parameters.model and parameters.resistance() is not None:
        yield from gap_flow.oil_faults("effects.blow_hole", parameters.model, facts, viscous=False)
    if parameters.closes - parameters.opens < 2.0 * RAMP:
        yield Fault("effects.blow_hole.closes", "must lie at least 40 deg after opens (choose a later angle)")


EFFECT = Effect(
    name="blow_hole",
    title="opening at the housing cusp, to the trailing chamber",
    equations=("M12", "M13", "M21", "M192", "M263"),
    source="ours, window from the geometry of a 4/6 profile",
    parameters=Parameters,
    build=build,
    check=check,
    needs=frozenset({BLOW_HOLE}),
    usual={ROTORS: LEAK},
    sizes=(Sized("area", SQUARE, 0.2, (0.0, 0.02)), Sized("suction_area", SQUARE, 0.2, (0.0, 0.04)), AREA_TABLE),
)
