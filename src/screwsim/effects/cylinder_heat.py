"""Cylinder heat: between the gas and the walls of cylinder, head and piston, which have one temperature.

What: Q = α A (T_w − T) (S29). Nu = α D/λ = a Re^b Pr^c with bore D, mean piston speed and the gas's density (S30), or
with an equivalent diameter and a swirl velocity that follow the crank angle (S34).
Source: W. J. D. Annand, Proc. Inst. Mech. Eng. 177 (1963) 973: b 0.7, c 0, a between 0.35 and 0.8, here 0.575; Destoop
1986: a 0.6, b 0.8, c 0.6, for compressors; R. P. Adair, E. B. Qvale, J. T. Pearson, Proc. Int. Compressor Engineering
Conf., Purdue, 1972, paper 86: a 0.053, b 0.8, c 0.6. None of the originals was available: all are quoted from the
ThermoCycle library.
Assumptions: quasi-steady, one wall temperature; λ, μ, Pr of the gas constant, from CoolProp at suction pressure and the
warmer of suction gas and wall.
Parameters: wall_temperature, correlation, factor.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from screwsim.effects.base import Around, Effect, Faults, Wall
from screwsim.effects.parts.usual import WALLS
from screwsim.fluid.transport import transport
from screwsim.inputs.declare import choice, number, quantity
from screwsim.inputs.faults import Fault, UsageError
from screwsim.machine.protocol import CYLINDER
from screwsim.numerics.kernel import kernel
from screwsim.outputs import WALLED

ADAIR = "adair"
COEFFICIENTS = {"annand": (0.575, 0.7, 0.0), "destoop": (0.6, 0.8, 0.6), ADAIR: (0.053, 0.8, 0.6)}  # a, b, c
TURNING = math.radians(9.0)  # angle over which the swirl's two branches are blended, which would otherwise jump


@dataclass(frozen=True)
class Parameters:
    """The walls' temperature and the correlation."""

    wall_temperature: float = quantity(
        "temperature", "T_w of cylinder, head and piston", ge=50.0, le=2500.0, hardly=(150.0, 800.0)
    )
    correlation: str = choice("Nu = a Re^b Pr^c", tuple(COEFFICIENTS), "annand")
    factor: float = number("multiplies the heat transfer coefficient", 1.0, ge=0.0, le=1e4, hardly=(None, 10.0))


@kernel
def conductance(rho, V, bore, piston_area, mean_speed, a, b, c, gas_conductivity, gas_viscosity, prandtl):
    """Return α A [W/K] between the walls and the gas (S29, S30)."""
    reynolds = rho * mean_speed * bore / gas_viscosity
    alpha = a * reynolds**b * prandtl**c * gas_conductivity / bore
    return alpha * (2.0 * piston_area + 4.0 * V / bore)


@kernel
def swirl(phi):
    """Return the gas's swirl over the crank's angular speed, at the angle phi [rad] from top dead centre (S34)."""
    from_top = abs(phi - 2.0 * math.pi * math.floor(phi / (2.0 * math.pi) + 0.5))
    x = min(1.0, max(0.0, (from_top - 0.5 * math.pi) / TURNING + 0.5))
    return (2.0 - x * x * (3.0 - 2.0 * x)) * (1.04 + math.cos(2.0 * phi))


@kernel
def swirled_conductance(phi, rho, V, bore, piston_area, omega, a, b, c, gas_conductivity, gas_viscosity, prandtl):
    """Return α A [W/K] between the walls and the swirling gas (S29, S34)."""
    area = 2.0 * piston_area + 4.0 * V / bore
    diameter = 6.0 * V / area
    reynolds = rho * 0.5 * diameter * swirl(phi) * omega * diameter / gas_viscosity
    return a * reynolds**b * prandtl**c * gas_conductivity / diameter * area


def numbers(parameters: Parameters, around: Around) -> Mapping[str, float]:
    """Return λ [W/(m K)], μ [Pa s] and Pr of the gas, and the mean piston speed [m/s]. Raises UsageError."""
    T = max(around.T_s, parameters.wall_temperature)
    gas = transport(around.fluid, around.p_s, T)
    found = dict(zip(("gas_conductivity", "gas_viscosity", "prandtl"), gas, strict=True))
    return found | {"mean_speed": around.tip_speed}


def build(parameters: Parameters, machine) -> list[Wall]:
    a, b, c = COEFFICIENTS[parameters.correlation]
    values = {"a": parameters.factor * a, "b": b, "c": c}
    law = swirled_conductance if parameters.correlation == ADAIR else conductance
    return [Wall("walls of the cylinder", law, values, parameters.wall_temperature)]


def check(parameters: Parameters, facts) -> Faults:
    try:
        transport(facts.gas.name, 1e4, max(parameters.wall_temperature, 300.0))
    except UsageError as error:
        yield Fault("effects.cylinder_heat", f"{error} (remove the effect, or choose another wall temperature)")


EFFECT = Effect(
    name="cylinder_heat",
    title="heat between the gas and the walls of the cylinder",
    equations=("S29", "S30", "S34"),
    source="Annand 1963; Destoop 1986; Adair, Qvale and Pearson 1972",
    parameters=Parameters,
    build=build,
    check=check,
    numbers=numbers,
    needs=frozenset({CYLINDER}),
    usual={CYLINDER: WALLS},
    roles={WALLED[0]: ""},
)
