"""Cylinder heat: between the gas and the walls of cylinder, head and piston, which have one temperature.

What: Q = α A (T_w − T) (S29), Nu = α D/λ = a Re^b Pr^c with bore D, mean piston speed and the gas's density (S30).
Source: W. J. D. Annand, Proc. Inst. Mech. Eng. 177 (1963) 973: b 0.7, c 0, a between 0.35 and 0.8, here 0.575; Destoop
1986: a 0.6, b 0.8, c 0.6, for compressors. Both as the ThermoCycle library has them.
Assumptions: quasi-steady, one wall temperature; λ, μ, Pr of the gas constant, from CoolProp at suction pressure and the
warmer of suction gas and wall.
Parameters: wall_temperature, correlation, factor.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from screwsim.declare import choice, number, quantity
from screwsim.effects.base import Around, Effect, Wall
from screwsim.faults import Fault, UsageError
from screwsim.fluid.constants import transport
from screwsim.machine.kinds import SLIDER_CRANK
from screwsim.numerics.kernel import kernel

COEFFICIENTS = {"annand": (0.575, 0.7, 0.0), "destoop": (0.6, 0.8, 0.6)}  # a, b, c


@dataclass(frozen=True)
class Parameters:
    """The walls' temperature and the correlation."""

    wall_temperature: float = quantity("temperature", "T_w of cylinder, head and piston", gt=0.0)
    correlation: str = choice("Nu = a Re^b Pr^c", tuple(COEFFICIENTS), "annand")
    factor: float = number("multiplies the heat transfer coefficient", 1.0, ge=0.0)


@kernel
def conductance(rho, V, bore, piston_area, mean_speed, a, b, c, gas_conductivity, gas_viscosity, prandtl):
    """Return α A [W/K] between the walls and the gas (S29, S30)."""
    reynolds = rho * mean_speed * bore / gas_viscosity
    alpha = a * reynolds**b * prandtl**c * gas_conductivity / bore
    return alpha * (2.0 * piston_area + 4.0 * V / bore)


def numbers(parameters: Parameters, around: Around) -> Mapping[str, float]:
    """Return the gas's λ, μ, Pr and the mean piston speed. Raises UsageError."""
    T = max(around.T_s, parameters.wall_temperature)
    gas = transport(around.fluid, around.p_s, T)
    found = dict(zip(("gas_conductivity", "gas_viscosity", "prandtl"), gas, strict=True))
    return found | {"mean_speed": around.tip_speed}


def build(parameters: Parameters, machine) -> list[Wall]:
    a, b, c = COEFFICIENTS[parameters.correlation]
    values = {"a": parameters.factor * a, "b": b, "c": c}
    return [Wall("walls of the cylinder", conductance, values, parameters.wall_temperature)]


def check(parameters: Parameters, facts) -> list[Fault]:
    try:
        transport(facts.gas.fluid, 1e4, max(parameters.wall_temperature, 300.0))
    except UsageError as error:
        return [Fault("effects.cylinder_heat", f"{error} (remove the effect, or choose another wall temperature)")]
    return []


EFFECT = Effect(
    name="cylinder_heat",
    title="heat between the gas and the walls of the cylinder",
    equations=("S29", "S30"),
    source="Annand 1963; Destoop 1986",
    parameters=Parameters,
    build=build,
    check=check,
    numbers=numbers,
    machines=(SLIDER_CRANK,),
)
