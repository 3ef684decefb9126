"""Suction line: gas and oil that flow back into it stay there, mix with the suction gas and are sucked in again.

What: the flow from the chambers to the suction line (slide valve, bypass bore, leaks, the port itself) returns its heat
and its oil: gas and oil have one temperature by the energy balance (M271), oil in the ratio of both flows, and the gas
that the oil holds dissolved is in equilibrium (M272). Without this effect the suction line keeps its state whatever
flows back, and heat and oil that leave to it are lost (M10, M54).
Source: adiabatic mixing (textbook).
Assumptions: a steady mixture between line (behind throttle and bypass) and port, without heat to the surroundings; gas
and oil have time to reach one temperature, and the oil to reach solubility equilibrium. Oil whose dissolved gas is not
tracked in the chamber (`refrigerant_solubility` without `flash_time`) releases nothing. Where more flows back than is
sucked in, the rest leaves by the line, with the mixture's state.
Parameters: none.
"""

from dataclasses import dataclass

from screwsim.effects.base import Effect, Faults, SuctionLine
from screwsim.effects.parts.usual import SUCTION_BACK, SUCTION_RETURN
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import ROTORS
from screwsim.outputs import CHANGED, HEATED, POWER, Figure, over

FIGURES = (
    Figure("returned_gas_flow", "kg s-1", "gas that returns to the suction line", over("gas_mass_flow")),
    Figure("returned_oil_flow", "kg s-1", "oil that returns to the suction line", over("oil_mass_flow"), needs=HEATED),
    Figure("returned_heat", "W", "heat from the returned gas and oil to the gas that is sucked in", POWER),
)


@dataclass(frozen=True)
class Parameters:
    """None: the state follows from the balances."""


def build(parameters: Parameters, machine) -> list[SuctionLine]:
    return [SuctionLine()]


def check(parameters: Parameters, facts) -> Faults:
    if facts.oil is not None and not facts.oil.carried:
        what = "mixes in returned oil, which oil.transport: paper does not follow (write oil.transport: carried)"
        yield Fault("effects.suction_line", what)


EFFECT = Effect(
    name="suction_line",
    title="gas and oil that flow back to suction mix with what is sucked in",
    equations=("M270", "M271", "M272", "M273"),
    source="adiabatic mixing",
    parameters=Parameters,
    build=build,
    check=check,
    figures=FIGURES,
    usual={ROTORS: SUCTION_RETURN},
    roles={CHANGED[0]: "", SUCTION_BACK: ""},
    in_expander="dry",
)
