"""Ring leakage: gas past the piston rings, between cylinder and crankcase.

What: nozzle flow (M12) through the rings' gap, both directions (S28).
Source: nozzle through an equivalent area, as usual for ring packs (textbook).
Assumptions: the crankcase is at the suction line's pressure, as in a hermetic shell or a vented crankcase, and what
leaks into it comes back as suction gas of the line's state; one equivalent gap stands for the pack.
Parameters: gap (of the joints and flanks, around the bore), or area; flow_coefficient.
"""

import math
from dataclasses import dataclass

from screwsim.effects.base import SUCTION, Effect, Faults, FlowPath
from screwsim.effects.parts.gap import GAP_FLOW_COEFFICIENT, flow_coefficient
from screwsim.effects.parts.usual import LEAK, Sized
from screwsim.effects.parts.valves import port_area
from screwsim.inputs.declare import optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import BORE, CYLINDER, PISTON


@dataclass(frozen=True)
class Parameters:
    """The equivalent gap of the ring pack."""

    gap: float | None = quantity("length", "equivalent radial gap around the bore", None, gt=0.0, hardly=(None, 5e-4))
    area: float | None = optional("area", "equivalent area, instead of gap")
    flow_coefficient: float = flow_coefficient("the gap", GAP_FLOW_COEFFICIENT)


def build(parameters: Parameters, machine) -> list[FlowPath]:
    around = math.pi * machine.settings.bore * (parameters.gap or 0.0)
    area, coefficient = around if parameters.area is None else parameters.area, parameters.flow_coefficient
    return [FlowPath(SUCTION, port_area, {"area": area}, flow_coefficient=coefficient, narrow=True)]


def check(parameters: Parameters, facts) -> Faults:
    if parameters.gap is None and parameters.area is None:
        yield Fault("effects.ring_leakage.gap", "is missing (write e.g. gap: 3 um, or an area)")
    if parameters.gap is not None and parameters.area is not None:
        yield Fault("effects.ring_leakage.area", "is given as well as gap (remove one of the two)")


EFFECT = Effect(
    name="ring_leakage",
    title="gas past the piston rings, to the crankcase at suction pressure",
    equations=("M12", "M13", "S28"),
    source="equivalent nozzle (textbook)",
    parameters=Parameters,
    build=build,
    check=check,
    needs=frozenset({CYLINDER}),
    usual={CYLINDER: LEAK},
    sizes=(Sized("gap", BORE, 0.5, (0.0, 0.01)), Sized("area", PISTON, 1.0, (0.0, 0.01))),
)
