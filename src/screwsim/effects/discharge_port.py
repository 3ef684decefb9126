"""Discharge port: flow between the discharge plenum and the chamber.

What: nozzle flow (M12) through the port area over the angle, law (18) or a table. Both directions.
Source: Chernov et al. 2015, eqs. (3), (4), (18); the middle branch of (18) is corrected: its printed form is
discontinuous (docs/model.md M18).
Assumptions: the discharge plenum keeps the pressure of the discharge line; what flows back has the given
temperature, or else the flow-weighted mean of the outflow, found together with the cycle.
Parameters: flow_coefficient.
"""

from screwsim.effects.base import DISCHARGE, Effect, Faults, FlowPath
from screwsim.effects.gap import PortParameters, check_port, port_path
from screwsim.effects.parts.roles import WAY_OUT
from screwsim.machine.protocol import PORTS

NAME = "discharge_port"


def build(parameters: PortParameters, machine) -> list[FlowPath]:
    return [port_path(parameters, machine.discharge_law(), DISCHARGE)]


def check(parameters: PortParameters, facts) -> Faults:
    return check_port(NAME, facts)


EFFECT = Effect(
    name=NAME,
    title="flow between the discharge line and the chamber",
    equations=("M12", "M13", "M18"),
    source="Chernov et al. 2015, eqs. (3), (4), (18)",
    parameters=PortParameters,
    build=build,
    check=check,
    needs=frozenset({PORTS}),
    roles={WAY_OUT: ""},
)
