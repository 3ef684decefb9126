"""Thermal clearances: gaps are those of warm rotors in a warm housing, found together with the cycle.

What: a clearance is stated cold, at the temperature of the drawing; rotors and housing expand linearly with their own
temperatures (M180), across the radius for the tips (M181), the axes' distance for the interlobe gap (M182) and the
length between thrust bearing and end face for the end gap (M183), which a bearing at the discharge end lets grow with
the rotors. All areas of a gap are multiplied by warm over cold clearance, and so is the clearance in its flow model
(M190 to M193, M251) and in the drag of its oil (M141, M142).
Source: linear expansion (textbook); that clearances of screw compressors follow the temperatures of rotors and casing:
D. Buckney, Clearance management in twin screw compressors, thesis, City, University of London 2017.
Assumptions: one temperature of the rotors and one of the housing, those of effects.wall_heat or stated ones; no
bending, no deformation by pressure, no play of the bearings; both rotors are of one material.
Parameters: reference_temperature, rotor_expansion, housing_expansion, axis_distance, bearing_distance, thrust_bearing;
rotor_temperature, housing_temperature.
"""

from collections.abc import Callable
from dataclasses import dataclass

from screwsim.effects.base import Effect, Faults, FeedbackUnknown, Made, Reading, Scaled, Site, Turn
from screwsim.effects.parts.usual import Sized
from screwsim.effects.wall_heat import LUMPS, fixed_temperature
from screwsim.effects.wall_heat import NAME as WALLS
from screwsim.inputs.declare import choice, optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import DIAMETER, ROTORS, SPAN
from screwsim.outputs import Figure, names_of

NAME = "thermal_clearances"
GAPS = {"tip_leakage": "tip_gap", "interlobe_leakage": "interlobe_gap", "end_face_leakage": "end_face_gap"}
MEANINGS = ("between tips and housing", "between the rotors", "of the discharge end faces")
FIGURES = tuple(
    Figure(name, "m", f"clearance {meaning}, warm", needs=(f"effects.{effect}",))
    for (effect, name), meaning in zip(GAPS.items(), MEANINGS, strict=True)
)
ENDS = DISCHARGE_END, SUCTION_END = "discharge", "suction"  # of the rotors, where the thrust bearing holds them
CLOSED = 0.02  # warm over cold clearance at which the parts count as touching


@dataclass(frozen=True)
class Parameters:
    """Materials, lengths that expand, and temperatures where no other effect finds them."""

    reference_temperature: float = quantity(
        "temperature",
        "temperature at which the stated gaps are measured",
        293.15,
        ge=50.0,
        le=1000.0,
        hardly=(250.0, 350.0),
    )
    rotor_expansion: float = quantity(
        "thermal_expansion", "thermal expansion of the rotors (steel)", 11.5e-6, ge=0.0, le=1e-3, hardly=(None, 5e-5)
    )
    housing_expansion: float = quantity(
        "thermal_expansion",
        "thermal expansion of the housing (grey cast iron)",
        10.5e-6,
        ge=0.0,
        le=1e-3,
        hardly=(None, 5e-5),
    )
    axis_distance: float | None = optional(
        "length", "distance of the rotors' axes (with interlobe_leakage; default: machine.profile.centre_distance)"
    )
    bearing_distance: float = quantity(
        "length", "distance from the thrust bearing to the discharge end face", 0.0, ge=0.0
    )
    thrust_bearing: str = choice(
        "end of the rotors at which it lies: from one at discharge warm rotors grow away from the end face's wall, "
        "from one at suction towards it",
        ENDS,
        DISCHARGE_END,
    )
    rotor_temperature: float | None = fixed_temperature(f"from effects.{WALLS}")
    housing_temperature: float | None = fixed_temperature(f"from effects.{WALLS}")


def growth(parameters: Parameters, rotor: float, housing: float) -> float:
    """Return the growth of a gap per length of its parts [1] at temperatures [K] of rotors and housing (M180)."""
    warm = parameters.housing_expansion * (housing - parameters.reference_temperature)
    return warm - parameters.rotor_expansion * (rotor - parameters.reference_temperature)


def lengths(parameters: Parameters, machine) -> dict[str, float]:
    """Return {effect: length [m] over which the parts of its gap expand} (M181 to M183).

    It is negative where the gap grows with the rotors.
    """
    profile = machine.settings.profile
    own = profile.centre_distance if profile is not None else 0.0
    along = 1.0 if parameters.thrust_bearing == SUCTION_END else -1.0
    return {
        "tip_leakage": 0.5 * machine.settings.rotor_diameter,
        "interlobe_leakage": parameters.axis_distance or own,
        "end_face_leakage": along * parameters.bearing_distance,
    }


def build(parameters: Parameters, machine) -> list[Made | Scaled | Reading]:
    stated = {lump: getattr(parameters, f"{lump}_temperature") for lump in LUMPS}

    def widening(effect: str, length: float) -> Callable[[Turn], float]:
        def widened(turn: Turn) -> float:
            """Return the warm gap over the cold one."""
            rotor, housing = (stated[lump] or turn.made[f"{lump}_temperature"] for lump in LUMPS)
            return 1.0 + growth(parameters, rotor, housing) * length / turn.gaps[effect]

        return widened

    def none(site: Site) -> float:
        return 1.0

    parts: list[Made | Scaled | Reading] = []
    for effect, length in lengths(parameters, machine).items():
        name = f"{effect}_widening"
        what, cooler = ("warm rotors touch", "them") if length >= 0.0 else ("the warm housing touches", "it")
        beyond = (
            f"{what}: {GAPS[effect].replace('_', ' ')} closes (choose a wider effects.{effect}.gap, or cool {cooler} "
            "more)"
        )
        parts += [
            Made(FeedbackUnknown(name), none, widening(effect, length), CLOSED, beyond),
            Scaled(effect, name, True),
        ]

    def read(figures) -> dict[str, float | None]:
        """Return the warm gaps [m]."""
        turn = figures.turn
        cold = {
            effect: turn.gaps[effect] for effect in GAPS if effect in turn.gaps
        }  # effects of users may have gaps, too
        return {GAPS[effect]: gap * turn.made[f"{effect}_widening"] for effect, gap in cold.items()}

    return [*parts, Reading(names_of(FIGURES), read)]


def check(parameters: Parameters, facts) -> Faults:
    path = f"effects.{NAME}"
    for lump in LUMPS:
        given = getattr(parameters, f"{lump}_temperature") is not None
        if given and WALLS in facts.effects:
            yield Fault(
                f"{path}.{lump}_temperature", f"is given as well as effects.{WALLS}, which finds it (remove it)"
            )
        elif not given and WALLS not in facts.effects:
            remedy = f"write e.g. {lump}_temperature: 330 K, or name effects.{WALLS}, which finds it"
            yield Fault(f"{path}.{lump}_temperature", f"is missing ({remedy})")
    profiled = facts.machine.profile is not None
    if profiled and parameters.axis_distance is not None:
        yield Fault(f"{path}.axis_distance", "is given as well as machine.profile.centre_distance (remove it)")
    if "interlobe_leakage" in facts.effects and not profiled and parameters.axis_distance is None:
        yield Fault(f"{path}.axis_distance", "is missing (effects.interlobe_leakage needs it, e.g. 120 mm)")
    least = facts.machine.rotor_length or 0.0
    if parameters.thrust_bearing == SUCTION_END and parameters.bearing_distance <= least:
        what = f"{1e3 * parameters.bearing_distance:.4g} mm: a thrust bearing behind the suction end is farther away"
        remedy = f"write e.g. {1e3 * max(1.2 * least, 0.1):.3g} mm, or thrust_bearing: {DISCHARGE_END}"
        yield Fault(f"{path}.bearing_distance", f"{what} than the rotors are long ({remedy})")
    if not any(name in facts.effects for name in GAPS):
        yield Fault(path, f"has no gap to change (name one of {', '.join(GAPS)}, or remove it)")


EFFECT = Effect(
    name=NAME,
    title="gaps between warm rotors and a warm housing",
    equations=("M180", "M181", "M182", "M183"),
    source="linear expansion",
    parameters=Parameters,
    build=build,
    check=check,
    needs=frozenset({ROTORS}),
    figures=FIGURES,
    sizes=(Sized("axis_distance", DIAMETER, 10.0, (0.5, 1.2)), Sized("bearing_distance", SPAN, 100.0, (0.0, 2.0))),
)
