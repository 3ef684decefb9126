"""Oil: none of it changes nothing, the displacement supply gives what its orifice gives, heat cools the gas."""

from math import pi

import numpy as np
import pytest
from scenes import DROP, GAS_FIGURES, run

from screwsim.fluid.orifice import orifice_flow

DISPLACEMENT = {
    "oil_supply": {"kind": "displacement", "temperature": "293 K", "orifice_diameter": "6 mm"},
    "effects.oil_pump": DROP,
}


def displaced(speed):
    return run({**DISPLACEMENT, "operation.speed": f"{speed} rpm"})


def test_no_oil_is_as_no_oil_heat():
    none, without = run({"oil_supply.ratio": 0}), run({"oil_supply.ratio": 0, "effects.oil_heat": DROP})
    for name in GAS_FIGURES:
        # both at the default accuracy; they differ in the steps that the idle oil temperature asks for
        assert none.performance[name] == pytest.approx(without.performance[name], rel=3e-4), name


def test_carried_no_oil_closes():
    assert run({"oil_supply.ratio": 0, "oil.transport": "carried"}).status == "ok"


@pytest.mark.parametrize("transport", ["paper", "carried"])
def test_the_pump_gives_the_ratio_it_is_told(transport):
    result = run({"oil.transport": transport})
    assert result.performance.oil_ratio == pytest.approx(3.0, rel=1e-12)  # an input


def test_more_oil_makes_the_gas_leave_cooler():
    temperatures = [run({"oil_supply.ratio": d}).performance.discharge_temperature for d in (0, 1, 3, 8)]
    assert temperatures == sorted(temperatures, reverse=True)


@pytest.mark.parametrize("speed", [3000, 1000])
def test_displacement_gives_the_orifices_flow(speed):
    """d = ṁ_oil · (time of one pitch)/(trapped gas), by hand from the result's own figures (M30)."""
    result = displaced(speed)
    p = result.performance
    oil = orifice_flow(12e5 - p.injection_pressure, 1000.0, 0.02, 6e-3, 12e-3, 1.0)
    per_life = oil * 60.0 / (4 * speed)
    assert p.oil_ratio == pytest.approx(per_life / p.trapped_mass, rel=1e-10)  # algebra only


@pytest.mark.parametrize("speed", [3000, 1000])
def test_displacement_flow_is_the_orifices(speed):
    p = displaced(speed).performance
    oil = orifice_flow(12e5 - p.injection_pressure, 1000.0, 0.02, 6e-3, 12e-3, 1.0)
    assert p.oil_mass_flow == pytest.approx(oil, rel=1e-10)  # one chamber faces the port at any time


def stretched(**bore):
    """Return the warnings about the bore of a machine with displaced oil."""
    supply = DISPLACEMENT["oil_supply"] | bore
    found = run({**DISPLACEMENT, "oil_supply": supply})
    assert found.status == "ok"
    return [warning for warning in found.warnings if "formula for the oil flow" in warning]


@pytest.mark.parametrize(("length", "words"), [("11 mm", "1.83 diameters long"), ("66 mm", "11 diameters long")])
def test_a_bore_outside_the_fitted_lengths_is_warned_of(length, words):
    (warning,) = stretched(orifice_length=length)
    assert words in warning and "2 to 10" in warning and "oil_supply.orifice_length" in warning


@pytest.mark.parametrize("length", ["12 mm", "60 mm"])
def test_a_bore_at_the_ends_of_the_fitted_lengths_is_not_warned_of(length):
    assert stretched(orifice_length=length) == []


def test_a_bore_in_which_oil_creeps_is_warned_of():
    (warning,) = stretched(orifice_diameter="3 um")
    assert "Reynolds number" in warning and "above 10" in warning


def test_displacement_gives_less_oil_per_gas_the_faster_it_turns():
    ratios = [displaced(speed).performance.oil_ratio for speed in (1000, 3000, 5000)]
    assert ratios == sorted(ratios, reverse=True)


def test_oil_is_heated_by_what_cools_the_gas():
    """Over 361°–595° with the ports shut: oil warms while the gas is hotter."""
    cycle = run().cycle
    inside = slice(480, 596)
    assert np.all(cycle["gas_temperature"][inside] > cycle["oil_temperature"][inside])
    assert np.all(np.diff(cycle["oil_temperature"][inside]) > 0.0)


def test_oil_mass_is_the_ratio_times_the_gas_with_the_papers_transport():
    cycle = run().cycle
    np.testing.assert_allclose(cycle["oil_mass"][360:], 3.0 * cycle["gas_mass"][360:], rtol=1e-12)  # its definition


def test_carried_oil_mass_jumps_at_the_injection_to_the_ratio():
    cycle = run({"oil.transport": "carried"}).cycle
    assert cycle["oil_mass"][360] == pytest.approx(3.0 * cycle["gas_mass"][360], rel=1e-6)  # angles are 1e-9 apart


def test_the_pump_of_a_sump_pays_the_rise_to_the_chamber():
    """P = V̇ (p_injection − p_s)/η (M31)."""
    p = run({"oil_supply.source": "suction"}).performance
    expected = p.oil_mass_flow / 1000.0 * (p.injection_pressure - 1.5e5) / 0.6
    assert p.oil_pump_power == pytest.approx(expected, rel=1e-10)  # algebra only


def test_lift_power_is_the_oils_way_up():
    p = run().performance
    assert p.oil_lift_power == pytest.approx(p.oil_mass_flow / 1000.0 * (12e5 - p.injection_pressure), rel=1e-12)


def test_acceleration_takes_the_torque_that_gives_oil_its_angular_momentum():
    """Euler: ṁ u r times ω."""
    p = run().performance
    radius, omega = 0.08, 3000 * 2 * pi / 60
    torque = p.oil_mass_flow * (omega * radius) * radius
    assert p.hydromechanical_power == pytest.approx(torque * omega, rel=1e-12)
