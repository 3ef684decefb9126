"""Discharge port: flow between the discharge plenum and the chamber.

What: nozzle flow (M12) through the port area over the angle, law (18) or a table, in both directions. With Chisholm's
exponent the gas has to accelerate the oil that it carries, which costs pressure: separated flow through an orifice
(M430).
Source: Chernov et al. 2015, eqs. (3), (4), (18); the middle branch of (18) is corrected: its printed form is
discontinuous (docs/model.md M18). With oil: J. W. Murdock, Two-phase flow measurement with orifices, J. Basic Eng. 84
(1962) 419; D. Chisholm, Two-phase flow through sharp-edged orifices, J. Mech. Eng. Sci. 19 (1977) 128.
Assumptions: the discharge plenum keeps the pressure of the discharge line; gas that flows back has the given
temperature, or else the flow-weighted mean of the outflow, found together with the cycle. With oil: it approaches the
port at rest, as the gas does; oil that the rotors throw through the port is not modelled.
Parameters: flow_coefficient, chisholm_exponent.
"""

from dataclasses import dataclass, replace

from screwsim.effects.base import DISCHARGE, Effect, Faults, FlowPath, Law
from screwsim.effects.parts.gap import PortParameters, check_port, port_path
from screwsim.effects.parts.oil import oil_in_chambers
from screwsim.effects.parts.usual import WAY_OUT
from screwsim.fluid.wet_nozzle import wet_flux
from screwsim.inputs.declare import number
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import PORTS

NAME = "discharge_port"


@dataclass(frozen=True)
class Parameters(PortParameters):
    """Parameters of the discharge port."""

    chisholm_exponent: float | None = number(
        "n: gas carries its oil through the port; 0.25 for orifices (Chisholm 1977), 0.5 for a mixture without slip "
        "(absent: oil does not slow the gas)",
        None,
        ge=0.0,
        le=0.5,
    )


def build(parameters: Parameters, machine) -> list[FlowPath]:
    path, exponent = port_path(parameters, machine.discharge_law(), DISCHARGE), parameters.chisholm_exponent
    if exponent is None:
        return [path]
    values = {**path.values, "chisholm_exponent": exponent}
    flow = Law(wet_flux, title=f"with its oil, Chisholm's n = {exponent:g} (M430)")
    return [replace(path, values=values, flow=flow)]


def check(parameters: Parameters, facts) -> Faults:
    yield from check_port(NAME, facts)
    if parameters.chisholm_exponent is None:
        return
    path = f"effects.{NAME}.chisholm_exponent"
    if facts.oil is None:
        yield Fault(path, "needs oil (write an oil section, or remove it)")
    elif not facts.oil.carried:
        yield Fault(path, "needs oil.transport: carried (write that, or remove it)")
    elif not oil_in_chambers(facts.effects):
        yield Fault(path, "needs oil in the chambers (add e.g. effects.oil_heat)")


EFFECT = Effect(
    name=NAME,
    title="flow between the discharge line and the chamber",
    equations=("M12", "M13", "M18", "M430"),
    source="Chernov et al. 2015, eqs. (3), (4), (18); Chisholm 1977",
    parameters=Parameters,
    build=build,
    check=check,
    needs=frozenset({PORTS}),
    roles={WAY_OUT: ""},
)
