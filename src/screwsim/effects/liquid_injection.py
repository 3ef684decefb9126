"""Liquid injection: condensate enters the closed chamber through a bore and cools the gas by evaporating.

What: flow of liquid (M12 with the liquid's stiffness, which is √(2 ρ Δp); M100) from the condenser's liquid line into
the chamber; its enthalpy mixes with the chamber's gas in equilibrium at once (M103).
Source: ours; orifice coefficient 0.61 of a sharp edge: textbook.
Assumptions: the liquid does not flash inside the bore; in the chamber it evaporates without delay. With gas.two_phase:
refuse the chamber has to stay dry, else the result is `failed` with the angle; equilibrium follows it wet.
Parameters: opens, closes, area, flow_coefficient.
"""

from __future__ import annotations

from dataclasses import dataclass

from screwsim.declare import quantity
from screwsim.effects.base import Drawn, Effect, Faults, FlowPath, Plenum, Site
from screwsim.effects.gap import flow_coefficient
from screwsim.effects.port_window import WindowParameters, check_window, window_path
from screwsim.faults import Fault
from screwsim.fluid.reservoir import Reservoir
from screwsim.machine.protocol import HOLES
from screwsim.outputs import Figure

NAME = "liquid_injection"
SHARP_EDGE = 0.61
FIGURES = (
    Figure("liquid_injection_mass_flow", "kg s-1", "net flow of injected liquid"),
    Figure("liquid_injection_flow_ratio", "1", "injected liquid over net suction flow"),
)


@dataclass(frozen=True)
class Parameters(WindowParameters):
    """The bore."""

    area: float = quantity("area", "area of the bore", gt=0.0)
    flow_coefficient: float = flow_coefficient("the bore (sharp edge: 0.61)", SHARP_EDGE)


def build(parameters: Parameters, machine) -> list[FlowPath | Plenum]:
    def state(site: Site) -> Reservoir:
        """Return the liquid behind the condenser."""
        return site.gas.liquid(site.p_d, site.liquid_enthalpy)

    def figures(drawn: Drawn) -> dict[str, float | None]:
        return {"liquid_injection_mass_flow": drawn.flow, "liquid_injection_flow_ratio": drawn.ratio}

    return [window_path(NAME, parameters), Plenum(NAME, state, figures)]


def check(parameters: Parameters, facts) -> Faults:
    yield from check_window(NAME, parameters, facts)
    if facts.gas.model != "real":
        yield Fault(f"effects.{NAME}", "an ideal gas has no liquid (write gas.model: real, or remove it)")
    if facts.operation.condensing_temperature is None or facts.machine.mode == "expander":
        what = "needs the liquid of a condenser (state a compressor's lines by evaporating and condensing temperature)"
        yield Fault(f"effects.{NAME}", what)


EFFECT = Effect(
    name=NAME,
    title="condensate, through a bore into the closed chamber",
    equations=("M12", "M13", "M100", "M101", "M103"),
    source="ours",
    parameters=Parameters,
    build=build,
    check=check,
    needs=frozenset({HOLES}),
    figures=FIGURES,
)
