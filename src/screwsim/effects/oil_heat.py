"""Oil heat: droplets exchange heat with the gas by convection.

What: Q = 3 α/(r ρ_o) m_oil (T_oil − T) into the gas (M3), and the same heat out of the oil (M4).
Source: Chernov et al. 2015, eqs. (1), (2). Its eq. (12) prints an extra factor d in the oil's equation, with which the
oil does not lose what the gas gains: `equation_12: printed` keeps that factor, to show its consequences.
Assumptions: equal spheres of radius r, uniform temperature inside, no heat to the walls. α and r enter only as α/r.
Parameters: droplet_radius, heat_transfer_coefficient, equation_12.
"""

from dataclasses import dataclass

from screwsim.effects.base import Effect, Faults, HeatRate
from screwsim.effects.parts.usual import OIL_HEAT, Sized
from screwsim.inputs.declare import choice, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import LOBE, OIL, ROTORS
from screwsim.numerics.kernel import kernel
from screwsim.outputs import HEATED


@dataclass(frozen=True)
class Parameters:
    """Radius of the droplets and their heat transfer coefficient."""

    droplet_radius: float = quantity("length", "radius r of the droplets", gt=0.0, hardly=(1e-7, 5e-3))
    heat_transfer_coefficient: float = quantity(
        "heat_transfer_coefficient", "coefficient alpha between droplet and gas", ge=0.0, le=1e9, hardly=(None, 1e5)
    )
    equation_12: str = choice(
        "corrected: the oil loses what the gas gains; printed: eq. (12) as in the paper, with its extra factor d",
        ("corrected", "printed"),
        "corrected",
    )


@kernel
def heat(T, T_oil, m_oil, droplet_radius, heat_transfer_coefficient, oil_density):
    """Return the heat [W] from the droplets to the gas (M3)."""
    return 3.0 * heat_transfer_coefficient / (droplet_radius * oil_density) * m_oil * (T_oil - T)


def build(parameters: Parameters, machine) -> list[HeatRate]:
    values = {
        "droplet_radius": parameters.droplet_radius,
        "heat_transfer_coefficient": parameters.heat_transfer_coefficient,
    }
    return [HeatRate(heat, values, "printed" if parameters.equation_12 == "printed" else "one")]


def check(parameters: Parameters, facts) -> Faults:
    if parameters.equation_12 == "printed" and facts.oil.carried:
        yield Fault("effects.oil_heat.equation_12", "the printed form has a constant d: it needs oil.transport: paper")


EFFECT = Effect(
    name="oil_heat",
    title="droplets of oil exchange heat with the gas",
    equations=("M3", "M4"),
    source="Chernov et al. 2015, eqs. (1), (2)",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    states=("T_oil",),
    check=check,
    needs=frozenset({OIL}),
    usual={ROTORS: OIL_HEAT},
    sizes=(Sized("droplet_radius", LOBE, 1e9, (0.0, 0.2)),),  # large droplets: the limit of no heat
    roles={HEATED[0]: ""},
)
