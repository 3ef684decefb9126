"""Suction port: flow between the suction plenum and the chamber.

What: nozzle flow (M12) through the port area over the angle, law (17) or a table, in both directions.
Source: Chernov et al. 2015, eqs. (3), (4), (17); choking added (docs/model.md M13).
Assumptions: the suction plenum keeps the state of the suction line; gas that flows back into it is counted, and fresh
gas of the line's state comes in again.
Parameters: flow_coefficient.
"""

from screwsim.effects.base import SUCTION, Effect, Faults, FlowPath
from screwsim.effects.parts.gap import PortParameters, check_port, port_path
from screwsim.effects.parts.usual import WAY_IN
from screwsim.machine.protocol import PORTS

NAME = "suction_port"


def build(parameters: PortParameters, machine) -> list[FlowPath]:
    return [port_path(parameters, machine.suction_law(), SUCTION)]


def check(parameters: PortParameters, facts) -> Faults:
    return check_port(NAME, facts)


EFFECT = Effect(
    name=NAME,
    title="flow between the suction line and the chamber",
    equations=("M12", "M13", "M17"),
    source="Chernov et al. 2015, eqs. (3), (4), (17)",
    parameters=PortParameters,
    build=build,
    check=check,
    needs=frozenset({PORTS}),
    roles={WAY_IN: ""},
)
