"""Check valves: massless plates between cylinder and lines, opened by the pressure difference.

What: nozzle flow (M12) through the port's area, open while the pressure difference is along the flow (S22). An
integration step ends wherever a valve opens or shuts.
Source: ours; the limit of a valve without mass or spring.
Assumptions: the plate lifts at once; no leakage when shut. Flow near equal pressures is regularised as that of the
line's openings is (docs/explanation/integrator.md), which counts in the estimated error of every figure. scipy's
integrators cannot end a step at such an event: for them the opening rises by a C1 cubic over the regularisation width.
Parameters: suction_area, discharge_area, flow_coefficient.
"""

from dataclasses import dataclass

from screwsim.effects.base import DISCHARGE, SUCTION, Effect, Faults, FlowPath, Reading
from screwsim.effects.parts.gap import flow_coefficient
from screwsim.effects.parts.usual import WAY_IN, WAY_OUT, Sized
from screwsim.effects.parts.valves import SIDES, VALVE_LOSSES, port_area, stated_once, valve_losses
from screwsim.inputs.declare import quantity
from screwsim.machine.protocol import CYLINDER, PISTON
from screwsim.numerics.kernel import kernel

LOOSE = -2.0  # value of `held` when a stored cycle is read, whose pressures carry integration errors
NEARLY = 0.1  # adverse pressure difference, in regularisation widths, up to which a valve then counts as open


@dataclass(frozen=True)
class Parameters:
    """Areas of both ports."""

    suction_area: float = quantity("area", "area of the suction valve's port", gt=0.0)
    discharge_area: float = quantity("area", "area of the discharge valve's port", gt=0.0)
    flow_coefficient: float = flow_coefficient("both", 1.0)


@kernel
def opening(held, drop, width, sign):
    """Return the open share of a check valve for a pressure difference `drop` into the cylinder [Pa] (S22).

    `held` ≥ 0 is a state fixed for the step (1 open, 0 shut); `LOOSE` and other negative values derive it from `drop`.
    """
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
    yield from stated_once("check_valves", "reed_valves", facts)


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
