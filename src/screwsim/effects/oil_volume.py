"""Oil volume: the oil takes up space in the chambers, V_gas = V − m_oil/ρ_oil.

What: the gas has the volume that the oil leaves (M106). The oil's flow work is part of its enthalpy (M108), so that the
indicated work includes lifting the oil to discharge and P_lift is zero. Gas flows through its share of an opening, and
oil with it (M107); oil that is injected at one angle displaces gas (M110). A chamber that fills with oil is locked: the
result is `failed` and names the angle (M111).
Source: ours, from the first law; Chernov et al. 2015 leave the oil's volume out.
Assumptions: incompressible oil; no slip: oil leaves a chamber in the ratio in which it lies there, at the gas's speed.
Parameters: none.
"""

from dataclasses import dataclass

from screwsim.effects.base import Effect, Faults, OilRoom
from screwsim.effects.parts.usual import OIL_ROOM
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import OIL


@dataclass(frozen=True)
class Parameters:
    """None."""


def build(parameters: Parameters, machine) -> list[OilRoom]:
    return [OilRoom("leave out effects.oil_volume")]


def check(parameters: Parameters, facts) -> Faults:
    if not facts.oil.carried:
        yield Fault("effects.oil_volume", "needs oil.transport: carried (write that, or remove the effect)")


EFFECT = Effect(
    name="oil_volume",
    title="oil takes up volume in the chambers",
    equations=("M106", "M107", "M108", "M109", "M110", "M111"),
    source="ours",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    states=("T_oil", "x_oil"),
    check=check,
    needs=frozenset({OIL}),
    roles={OIL_ROOM: ""},
)
