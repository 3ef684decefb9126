"""Suction throttle: a valve between suction line and machine, which reduces capacity by lowering the gas's density.

What: the machine sucks at p_s' = π p_s with the enthalpy of the line (M160); figures refer to the line's state.
Source: isenthalpic throttling (textbook); one of the four ways of capacity control that Chernov et al. 2015 name.
Assumptions: a steady pressure behind the valve, no heat; gas that flows back into the suction stays behind the valve.
Parameters: pressure_ratio.
"""

from dataclasses import dataclass

from screwsim.effects.base import Effect, SuctionChange
from screwsim.inputs.declare import number
from screwsim.outputs import CHANGED


@dataclass(frozen=True)
class Parameters:
    """Opening of the valve, as the pressure that it leaves."""

    pressure_ratio: float = number("pressure after the valve, over that of the suction line (1: open)", gt=0.0, le=1.0)


def build(parameters: Parameters, machine) -> list[SuctionChange]:
    return [SuctionChange(pressure_ratio=parameters.pressure_ratio)]


EFFECT = Effect(
    name="suction_throttle",
    title="valve between suction line and machine",
    equations=("M160", "M163"),
    source="isenthalpic throttling",
    parameters=Parameters,
    build=build,
    roles={CHANGED[0]: ""},
    in_expander="dry",
)
