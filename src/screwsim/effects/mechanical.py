"""Mechanical loss: bearings, seals and gears as a share of the indicated power.

What: P = f |P_ind| (M33).
Source: Giuffrida, Appl. Therm. Eng. 93 (2016) 813: 26.5 % of the theoretical power for a small machine (f = 0.265);
we take the indicated power in place of the theoretical one.
Assumptions: proportional to the indicated power at every speed.
Parameters: fraction.
"""

from dataclasses import dataclass

from screwsim.effects.base import Effect, PowerLoss
from screwsim.effects.parts.usual import FRICTION
from screwsim.inputs.declare import number
from screwsim.machine.protocol import CYLINDER, ROTORS
from screwsim.outputs import power_figure


@dataclass(frozen=True)
class Parameters:
    """Share of the indicated power."""

    fraction: float = number(
        "f: mechanical loss over indicated power (Giuffrida: 0.265)", ge=0.0, le=100.0, hardly=(None, 0.5)
    )


def build(parameters: Parameters, machine) -> list[PowerLoss]:
    def power(figures) -> float:
        """Return the mechanical loss [W] (M33)."""
        return parameters.fraction * abs(figures.indicated_power)

    return [PowerLoss("mechanical_power", power, friction=True)]


EFFECT = Effect(
    name="mechanical",
    title="bearings, seals and gears",
    equations=("M33",),
    source="Giuffrida 2016",
    parameters=Parameters,
    build=build,
    figures=(power_figure("mechanical_power", "mechanical loss"),),
    usual={ROTORS: FRICTION, CYLINDER: FRICTION},
)
