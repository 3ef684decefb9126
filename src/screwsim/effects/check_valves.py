"""Check valves: massless plates between cylinder and lines, which open where the pressure difference opens them.

What: nozzle flow (M12) through the port's area, open while the pressure difference is along the flow (S22). Steps of
the integration end where a valve opens or shuts.
Source: ours; the limit of a valve without mass or spring.
Assumptions: no lift to be passed through, no leakage when shut. The flow near equal pressures is regularised as that of
the openings of the line (docs/explanation/integrator.md), which counts in the estimated error of every figure. scipy's
integrators know no such ends of steps: for them the opening rises by a C1 cubic over the width of the regularisation.
Parameters: suction_area, discharge_area, flow_coefficient.
"""

from dataclasses import dataclass

from screwsim.effects.base import DISCHARGE, SUCTION, Effect, Faults, FlowPath, Reading
from screwsim.effects.parts.gap import flow_coefficient
from screwsim.effects.parts.roles import WAY_IN, WAY_OUT
from screwsim.effects.parts.usual import Sized
from screwsim.effects.parts.valves import SIDES, VALVE_LOSSES, port_area, valve_losses
from screwsim.inputs.declare import quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import CYLINDER, PISTON
from screwsim.numerics.kernel import kernel

LOOSE = -2.0  # of `held`: a stored cycle is read, whose pressure errs
NEARLY = 0.1  # widths of the regularisation against the flow at which a valve then still counts as open


@dataclass(frozen=True)
class Parameters:
    """Areas of both ports."""

    suction_area: float = quantity("area", "area of the suction valve's port", gt=0.0)
    discharge_area: float = quantity("area", "area of the discharge valve's port", gt=0.0)
    flow_coefficient: float = flow_coefficient("both", 1.0)


@kernel
def opening(held, drop, width, sign):
    """Return the open share of a check valve at a pressure difference into the cylinder (S22)."""
    if held >= 0.0:
        return held
    x = sign * drop / width
    if held == LOOSE:
        return 1.0 if x > -NEARLY else 0.0
    if x <= 0.0:
        return 0.0
    return x * x * (3.0 - 2.0 * x) if x < 1.0 else 1.0


def build(parameters: Parameters, machine) -> list[FlowPath | Reading]:
    areas = {SUCTION: parameters.suction_area, DISCHARGE: parameters.discharge_area}
    of_both = {"flow_coefficient": parameters.flow_coefficient, "opening": opening}
    paths = [
        FlowPath(side, port_area, {"area": areas[side], "sign": sign}, one_way=round(sign), **of_both)
        for side, sign in SIDES.items()
    ]
    return [*paths, valve_losses()]


def check(parameters: Parameters, facts) -> Faults:
    if "reed_valves" in facts.effects:
        yield Fault("effects.check_valves", "are simulated beside reed_valves, the same valves twice (remove one)")


EFFECT = Effect(
    name="check_valves",
    title="ideal check valves between cylinder and both lines",
    equations=("M12", "M13", "S22", "S24"),
    source="ours",
    parameters=Parameters,
    build=build,
    check=check,
    needs=frozenset({CYLINDER}),
    roles={WAY_IN: "", WAY_OUT: ""},
    figures=VALVE_LOSSES,
    sizes=(Sized("suction_area", PISTON, 100.0, (0.0, 1.0)), Sized("discharge_area", PISTON, 100.0, (0.0, 1.0))),
)
