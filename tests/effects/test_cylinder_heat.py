"""Laws of the heat from the cylinder's walls: coefficients, equivalent diameter, swirl."""

import math
import re

import pytest
from cylinder_scenes import SHUT, cylinder
from each_row import each_row
from scenes import balanced
from scipy.integrate import quad

from screwsim.effects import cylinder_heat
from screwsim.scene import loads
from screwsim.simulate import simulate, simulate_many
from screwsim.template import new_scene, request_of

BORE = 0.05
AREA = math.pi / 4.0 * BORE**2
GAS = {"gas_conductivity": 0.03, "gas_viscosity": 2e-5, "prandtl": 0.7}
OMEGA = 150.0
WALL = "effects.cylinder_heat.wall_temperature"


def swirled(phi: float, rho: float, V: float) -> float:
    a, b, c = cylinder_heat.COEFFICIENTS["adair"]
    return cylinder_heat.swirled_conductance.function(phi, rho, V, BORE, AREA, OMEGA, a, b, c, **GAS)


def test_a_cylinder_as_long_as_wide_has_its_bore_as_diameter():
    # Re = ρ (D/2) ω_g D/μ at the top dead centre, where ω_g = 2 · 2.04 ω
    reynolds = 3.0 * 0.5 * BORE**2 * 4.08 * OMEGA / GAS["gas_viscosity"]
    alpha = 0.053 * reynolds**0.8 * GAS["prandtl"] ** 0.6 * GAS["gas_conductivity"] / BORE
    surface = 2.0 * AREA + math.pi * BORE * BORE
    assert swirled(0.0, 3.0, AREA * BORE) == pytest.approx(alpha * surface)


@each_row(
    ("degrees", "expected"),
    [(0, 4.08), (60, 1.08), (120, 0.54), (180, 2.04), (240, 0.54), (300, 1.08), (360, 4.08), (90, 0.06), (270, 0.06)],
)
def test_the_swirl_follows_the_crank(degrees, expected):
    assert cylinder_heat.swirl.function(math.radians(degrees)) == pytest.approx(expected)


def test_the_blend_of_both_branches_moves_the_mean_swirl_by_a_thousandth_at_most():
    def printed(phi):
        return (2.0 if abs(phi) < 0.5 * math.pi else 1.0) * (1.04 + math.cos(2.0 * phi))

    found, wanted = (
        2.0 * quad(law, 0.0, math.pi, points=[0.5 * math.pi])[0] for law in (cylinder_heat.swirl.function, printed)
    )
    assert found == pytest.approx(wanted, rel=1e-3)


def test_annand_and_destoop_are_powers_of_the_mean_speed():
    for name, exponent in (("annand", 0.7), ("destoop", 0.8)):
        a, b, c = cylinder_heat.COEFFICIENTS[name]
        assert b == exponent
        one, two = (
            cylinder_heat.conductance.function(3.0, AREA * BORE, BORE, AREA, speed, a, b, c, **GAS)
            for speed in (2.0, 4.0)
        )
        assert two / one == pytest.approx(2.0**exponent)


def test_walls_with_a_swirl_close_the_balances():
    text = SHUT + "effects:\n  cylinder_heat: {wall_temperature: 350 K, correlation: adair}\n"
    found = balanced(simulate(cylinder(text)))
    # what is shut in gives the walls what the piston does on it, and is warmer or colder than they by turns
    assert found.performance.wall_heat == pytest.approx(-found.performance.indicated_power, rel=1e-3)


def test_a_gas_without_transport_properties_at_a_point_fails_that_point_alone():
    """A sweep ended there with an error of usage, without any of its results."""
    scene = new_scene("reciprocating", request_of(fluid="Propylene", condition="-60/-20 degC"))
    cold = loads(scene, overrides=[f"{path}=-140 degC" for path in (WALL, "operation.evaporating_temperature")])
    results = list(simulate_many([cold, loads(scene)], trace=False))
    assert [result.status for result in results] == ["failed", "ok"]
    told = r"effects\.cylinder_heat: CoolProp has no transport properties of Propylene at .* leave out effects\.cyl"
    assert re.match(told, results[0].message), results[0].message


def test_walls_warmed_from_outside_the_machine_are_told():
    """Warm suction gas and a low lift: the machine gives off more than it takes in, by heat that nothing supplies."""
    written = new_scene("reciprocating", request_of(fluid="CO2", condition="-10/35 degC"))
    made = loads(written, overrides=["effects.mechanical={fraction: 0.08}"])  # more of it covers what walls bring
    warm = {"operation.evaporating_temperature": "0 degC", "operation.gas_cooler.pressure": "76 bar"}
    found, own = simulate(made.with_(warm), trace=False), simulate(made, trace=False)
    p = found.performance
    assert p.heating_capacity - p.cooling_capacity > 1.05 * p.electrical_power
    (told,) = found.warnings
    share = (p.wall_heat - p.mechanical_power) / p.shaft_power
    assert f"{share:.1%} of the shaft power comes in from outside the machine (state colder walls in effects." in told
    assert own.warnings == ()
