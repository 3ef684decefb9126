"""Hydromechanical loss: oil is accelerated to the rotor's tip speed and sheared in the gaps.

What: P = f ṁ_oil u_tip² + C V_sw ω² μ (M32): the power that the rotor transfers to oil which it accelerates to its tip
speed, times a factor f, and Giuffrida's viscous term with V_sw = z1 V_max.
Source: acceleration: Euler's turbine equation, the factor f is fitted; viscous: Giuffrida, Appl. Therm. Eng. 93 (2016)
813, C = 134.5. Chernov et al. 2015 name the loss without a formula.
Assumptions: all oil comes without swirl and reaches the male tip speed, once. The loss heats nothing that the chamber
model sees: neither the half dissipated on the way to tip speed, nor the kinetic energy, which is lost behind the port.
Parameters: acceleration_factor, viscous_coefficient.
"""

from dataclasses import dataclass

from screwsim.effects.base import Effect, Faults, PowerLoss
from screwsim.effects.parts.usual import OIL_FRICTION
from screwsim.inputs.declare import number
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import ROTORS
from screwsim.outputs import power_figure

GIUFFRIDA = 134.5  # coefficient of V_sw ω² μ


@dataclass(frozen=True)
class Parameters:
    """Factors of the two terms."""

    acceleration_factor: float = number(
        "f: 1 is the whole power to bring oil from rest to tip speed, ṁ u²; 0.5 its kinetic energy alone",
        1.0,
        ge=0.0,
        le=1e4,
        hardly=(None, 10.0),
    )
    viscous_coefficient: float = number(
        "C of the viscous term (Giuffrida: 134.5; 0: none)", 0.0, ge=0.0, le=1e8, hardly=(None, 1e4)
    )


def build(parameters: Parameters, machine) -> list[PowerLoss]:
    def power(figures) -> float:
        """Return the hydromechanical loss [W] (M32)."""
        acceleration = parameters.acceleration_factor * figures.oil_mass_flow * figures.tip_speed**2
        swept = machine.lobes * machine.swept_volume
        T_oil = figures.oil_temperature
        viscosity = None if T_oil is None else figures.film_viscosity_at(T_oil)
        shear = parameters.viscous_coefficient * swept * figures.omega**2 * (viscosity or 0.0)
        return acceleration + shear

    return [PowerLoss("hydromechanical_power", power)]


def check(parameters: Parameters, facts) -> Faults:
    if parameters.viscous_coefficient > 0.0 and facts.oil is not None and not facts.oil.knows_viscosity:
        yield Fault("oil.viscosity", "is missing (effects.hydromechanical.viscous_coefficient needs it)")


EFFECT = Effect(
    name="hydromechanical",
    title="oil accelerated to tip speed and sheared in gaps",
    equations=("M32",),
    source="Euler's turbine equation; Giuffrida 2016",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    check=check,
    needs=frozenset({ROTORS}),
    figures=(power_figure("hydromechanical_power", "hydromechanical loss"),),
    usual={ROTORS: OIL_FRICTION},
)
