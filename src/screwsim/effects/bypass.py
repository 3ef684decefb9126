"""Bypass: gas returns to suction, from the discharge line or from a chamber that has begun to compress.

What: `discharge`: gas of the discharge line expands to p_s and mixes with the suction gas, which warms it; it makes up
the share y of the gas that the machine sucks (M161). `chamber`: nozzle flow to the suction line through a valve's bore
while the chamber passes it (M12, M13).
Source: isenthalpic mixing (textbook); one of the four ways of capacity control that Chernov et al. 2015 name.
Assumptions: discharge: the returned gas is hot, as delivered, and free of oil; a steady mixture. Chamber: the suction
line keeps its state, as with any gas that flows back into it.
Parameters: source, share, or area, opens, passage, flow_coefficient.
"""

from dataclasses import dataclass
from math import pi

from screwsim.effects.base import SUCTION, Effect, Faults, FlowPath, SuctionChange
from screwsim.effects.parts.gap import flow_coefficient, ramp
from screwsim.effects.parts.usual import Sized
from screwsim.inputs.declare import choice, number, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import SHELL, WIDEST
from screwsim.numerics.kernel import kernel
from screwsim.outputs import CHANGED

RAMP = 10.0 * pi / 180.0  # angle over which the bore opens, and over which it closes
_OF_SOURCE = {"discharge": ("share",), "chamber": ("area", "opens", "passage")}
_EXAMPLES = {"share": "0.3", "area": "5 cm^2", "opens": "400 deg", "passage": "90 deg"}


@dataclass(frozen=True)
class Parameters:
    """Where the gas comes from, and how much."""

    source: str = choice(
        "discharge: from the line; chamber: from a bore in the housing", ("discharge", "chamber"), "discharge"
    )
    share: float | None = number(
        "y: share of the intake that is gas returned from the discharge line (source: discharge)", None, ge=0.0, lt=1.0
    )
    area: float | None = quantity("area", "area of the bore (source: chamber)", None, ge=0.0)
    opens: float | None = quantity("angle", "angle at which a chamber reaches the bore (source: chamber)", None, ge=0.0)
    passage: float | None = quantity(
        "angle", "angle from first to last contact with the bore (source: chamber)", None, gt=2.0 * RAMP
    )
    flow_coefficient: float = flow_coefficient("the bore (source: chamber)", 0.7)


@kernel
def area(phi, size, opens, full, falls, closes):
    """Return the open area [m²] of the bore for a chamber at phi [rad]."""
    return size * ramp(phi, opens, full, falls, closes)


def window(size: float, opens: float, closes: float, flow_coefficient: float) -> FlowPath:
    """Return a path to the suction line that is open between two angles [rad], with C1 ramps at both ends."""
    angles = {"opens": opens, "full": opens + RAMP, "falls": closes - RAMP, "closes": closes}
    values, breakpoints = {"size": size, **angles}, tuple(angles.values())
    return FlowPath(SUCTION, area, values, breakpoints, flow_coefficient=flow_coefficient, beside=True)


def build(parameters: Parameters, machine) -> list[FlowPath | SuctionChange]:
    if parameters.source == "discharge":
        return [SuctionChange(returned=parameters.share or 0.0)]
    opens = parameters.opens or 0.0
    closes = opens + (parameters.passage or 0.0)
    return [window(parameters.area or 0.0, opens, closes, parameters.flow_coefficient)]


def check(parameters: Parameters, facts) -> Faults:
    path = "effects.bypass"
    for source, names in _OF_SOURCE.items():
        for name in names:
            given = getattr(parameters, name) is not None
            if source == parameters.source and not given:
                example = f"{name}: {_EXAMPLES[name]}"
                yield Fault(f"{path}.{name}", f"is missing (source: {source} needs it, e.g. {example})")
            elif source != parameters.source and given:
                yield Fault(f"{path}.{name}", f"applies only to source: {source} (remove it)")
    if parameters.source == "discharge" and facts.operation.discharge.temperature is not None:
        what = "is given, but the returned gas has the temperature of the outflow (remove it, or the bypass)"
        yield Fault("operation.discharge.temperature", what)


def check_geometry(parameters: Parameters, geometry) -> Faults:
    closes = (parameters.opens or 0.0) + (parameters.passage or 0.0)
    if closes > geometry.life + 1e-9:
        end, life = (f"{angle * 180.0 / pi:.6g} deg" for angle in (closes, geometry.life))
        what = f"ends at {end}, beyond the chamber's life of {life} (choose an earlier bore or a shorter passage)"
        yield Fault("effects.bypass.passage", what)


EFFECT = Effect(
    name="bypass",
    title="gas returned to suction",
    equations=("M12", "M13", "M100", "M161", "M163"),
    source="isenthalpic mixing",
    parameters=Parameters,
    build=build,
    check=check,
    check_geometry=check_geometry,
    sizes=(Sized("area", SHELL, WIDEST, (0.0, 0.2)),),
    roles={CHANGED[0]: ".share"},
    in_expander="never",
)
