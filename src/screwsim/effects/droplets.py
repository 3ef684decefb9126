"""Droplets: heat between oil and gas with coefficient and size of the droplets from correlations.

What: Q = 6 α/(d ρ_o) m_oil (T_oil − T), α = Nu λ/d, Nu = 2 + 0.6 Re^½ Pr^⅓ (M154), Re with a slip between droplet and
gas that is a stated share of the tip speed; d stated, or the Sauter diameter of a jet (M155, M156).
Source: W. E. Ranz, W. R. Marshall, Chem. Eng. Prog. 48 (1952) 141; A. C. Merrington, E. G. Richardson, Proc. Phys.
Soc. 59 (1947) 1; K. S. Varde, D. M. Popa, L. K. Varde, SAE 841055 (1984).
Assumptions: equal spheres of the Sauter diameter, uniform temperature inside, neither coalescence nor break-up by the
rotors; the formulas of both jets differ tenfold, and that of diesel sprays (M156) is extrapolated. λ, μ, Pr of the gas
are constant, from CoolProp: at the stated reference state, else at suction pressure and the warmer of suction gas and
injected oil.
Parameters: size, diameter, or orifice_diameter, jet_pressure, surface_tension; slip; reference state or λ, μ, Pr.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from screwsim.effects.base import Around, Effect, Faults, HeatRate, Reading
from screwsim.effects.parts.gas_transport import (
    declared_gas_conductivity,
    declared_gas_viscosity,
    gas_faults,
    gas_numbers,
)
from screwsim.effects.parts.usual import OIL_HEAT, Sized
from screwsim.inputs.declare import choice, number, optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import DIAMETER, LOBE, OIL, ROTORS
from screwsim.numerics.kernel import kernel
from screwsim.outputs import HEATED, Figure

STATED, MERRINGTON, VARDE = "fixed", "merrington_richardson", "varde"  # what `size` says
_OF_SIZE = {
    STATED: ("diameter",),
    MERRINGTON: ("orifice_diameter", "jet_pressure"),
    VARDE: ("orifice_diameter", "jet_pressure", "surface_tension"),
}
_EXAMPLES = {"diameter": "50 um", "orifice_diameter": "3 mm", "jet_pressure": "5 bar", "surface_tension": "30 mN/m"}


@dataclass(frozen=True)
class Parameters:
    """Size of the droplets, their slip, and the gas around them."""

    size: str = choice(
        "fixed: diameter is stated; otherwise the correlation for the Sauter diameter of a jet", tuple(_OF_SIZE), STATED
    )
    diameter: float | None = quantity(
        "length", "d: Sauter diameter of the droplets (size: fixed)", None, gt=0.0, hardly=(1e-7, 1e-2)
    )
    orifice_diameter: float | None = optional("length", "D: diameter of the bore that the oil jet leaves")
    jet_pressure: float | None = quantity(
        "pressure_difference", "pressure drop across that bore: u = sqrt(2 dp/rho_o)", None, gt=0.0, hardly=(None, 1e7)
    )
    surface_tension: float | None = quantity(
        "surface_tension", "sigma: surface tension of the oil (size: varde)", None, gt=0.0, le=1.0, hardly=(5e-3, 0.1)
    )
    slip: float = number(
        "slip speed between droplet and gas, over the male tip speed", 0.0, ge=0.0, le=1e3, hardly=(None, 2.0)
    )
    reference_pressure: float | None = optional("pressure", "pressure at which lambda, mu, Pr of the gas are evaluated")
    reference_temperature: float | None = optional("temperature", "temperature at which they are evaluated")
    gas_conductivity: float | None = declared_gas_conductivity()
    gas_viscosity: float | None = declared_gas_viscosity()
    prandtl: float | None = number("Pr of the gas (default: from CoolProp)", None, gt=0.0, le=1e3, hardly=(0.1, 10.0))

    @property
    def jets(self) -> bool:
        """Whether the droplets come from a jet, whose droplet size depends on the oil's viscosity."""
        return self.size != STATED


@kernel
def heat_transfer_coefficient(rho, speed, diameter, gas_conductivity, gas_viscosity, prandtl):
    """Return α [W/(m² K)] of a sphere in a gas stream by Ranz and Marshall (M154); `speed` is the slip [m/s]."""
    reynolds = rho * speed * diameter / gas_viscosity
    return (2.0 + 0.6 * math.sqrt(reynolds) * prandtl ** (1.0 / 3.0)) * gas_conductivity / diameter


@kernel
def heat(T, T_oil, m_oil, rho, slip, tip_speed, diameter, gas_conductivity, gas_viscosity, prandtl, oil_density):
    """Return the heat [W] from the droplets to the gas (M154)."""
    alpha = heat_transfer_coefficient(rho, slip * tip_speed, diameter, gas_conductivity, gas_viscosity, prandtl)
    return 6.0 * alpha / (diameter * oil_density) * m_oil * (T_oil - T)


def merrington_richardson(bore: float, kinematic_viscosity: float, speed: float) -> float:
    """Return the Sauter diameter [m] of a jet's droplets (M155); all arguments in SI units."""
    return 500.0 * bore**1.2 * kinematic_viscosity**0.2 / speed


def varde(bore: float, density: float, viscosity: float, surface_tension: float, speed: float) -> float:
    """Return the Sauter diameter [m] of a jet's droplets from Re and We of the liquid (M156); arguments in SI units."""
    reynolds, weber = density * speed * bore / viscosity, density * speed**2 * bore / surface_tension
    return 8.7 * bore * (reynolds * weber) ** -0.28


def sauter_diameter(parameters: Parameters, density: float, viscosity: float | None) -> float:
    """Return d [m] for oil of a density [kg/m³] and a viscosity [Pa s]; a stated diameter needs neither."""
    if not parameters.jets:
        return parameters.diameter or 0.0
    bore, mu = parameters.orifice_diameter or 0.0, viscosity or 0.0
    speed = math.sqrt(2.0 * (parameters.jet_pressure or 0.0) / density)
    if parameters.size == MERRINGTON:
        return merrington_richardson(bore, mu / density, speed)
    return varde(bore, density, mu, parameters.surface_tension or 0.0, speed)


def numbers(parameters: Parameters, around: Around) -> Mapping[str, float]:
    """Return values that the kernel needs from the scene: diameter [m], and λ, μ, Pr of the gas. Raises UsageError."""
    assert around.oil is not None  # needs_oil
    diameter = sauter_diameter(parameters, around.oil.density, around.oil.viscosity)
    return {"diameter": diameter, **gas_numbers(parameters, around)}


def build(parameters: Parameters, machine) -> list[HeatRate | Reading]:
    def read(figures) -> dict[str, float | None]:
        """Return the diameter of the droplets [m]."""
        density = figures.oil_density_at(figures.oil_temperature)
        return {"droplet_diameter": sauter_diameter(parameters, density, figures.oil_viscosity)}

    return [HeatRate(heat, {"slip": parameters.slip}), Reading(("droplet_diameter",), read)]


def check(parameters: Parameters, facts) -> Faults:
    path, needed = "effects.droplets", _OF_SIZE[parameters.size]
    if "oil_heat" in facts.effects:
        yield Fault(path, "is simulated together with effects.oil_heat, the same heat twice (remove one of the two)")
    for name, example in _EXAMPLES.items():
        given = getattr(parameters, name) is not None
        if name in needed and not given:
            yield Fault(f"{path}.{name}", f"is missing (size: {parameters.size} needs it, e.g. {example})")
        elif given and name not in needed:
            yield Fault(f"{path}.{name}", f"has no meaning with size: {parameters.size} (remove it)")
    if parameters.jets and facts.oil is not None and not facts.oil.knows_viscosity:
        yield Fault("oil.viscosity", f"is missing (effects.droplets.size: {parameters.size} needs it, or oil.name)")
    yield from gas_faults(path, parameters, facts.gas.name)


EFFECT = Effect(
    name="droplets",
    title="droplets sized by a correlation exchange heat with the gas",
    equations=("M4", "M154", "M155", "M156"),
    source="Ranz and Marshall 1952; Merrington and Richardson 1947; Varde et al. 1984",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    states=("T_oil",),
    check=check,
    numbers=numbers,
    needs=frozenset({OIL}),
    figures=(Figure("droplet_diameter", "m", "Sauter diameter of the oil droplets"),),
    usual={ROTORS: OIL_HEAT},
    sizes=(  # the bounds are wide: very large droplets are the limit of no heat exchange
        Sized("diameter", LOBE, 1e9, (0.0, 0.3)),
        Sized("orifice_diameter", DIAMETER, 1e9, (0.0, 0.2)),
    ),
    roles={HEATED[0]: ""},
)
