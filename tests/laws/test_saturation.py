"""Laws of the saturation temperatures and superheats of both lines, against CoolProp; which gases have some."""

import pytest
from CoolProp.CoolProp import PropsSI
from folders import CONFIGS
from scenes import run

from screwsim.fluid import constants
from screwsim.inputs.faults import UsageError
from screwsim.scene import case, case_count, load, loads
from screwsim.simulate import simulate, simulate_many
from screwsim.study.asked.goals import read_bounds
from screwsim.template import new_scene, request_of

NAMES = {"evaporating_temperature", "condensing_temperature", "suction_superheat", "discharge_superheat"}
BUBBLES = {"evaporating_bubble_temperature", "condensing_bubble_temperature"}
PRESSURES = {
    "gas": {"fluid": "R134a", "model": "real"},
    "operation": {
        "speed": "3000 rpm",
        "suction": {"pressure": "3 bar", "temperature": "283 K"},
        "discharge": {"pressure": "11 bar"},
    },
    "oil_supply.temperature": "330 K",
}


@pytest.fixture(scope="module")
def result():
    found = run(PRESSURES)
    assert found.status == "ok"
    return found


def test_pressures_alone_have_their_saturation(result):
    p = result.performance
    low, high = (PropsSI("T", "P", pressure, "Q", 1, "R134a") for pressure in (3e5, 11e5))
    assert p.evaporating_temperature == pytest.approx(low, abs=1e-6)
    assert p.condensing_temperature == pytest.approx(high, abs=1e-6)
    assert p.suction_superheat == pytest.approx(283.0 - low, abs=1e-6)
    assert p.discharge_superheat == pytest.approx(p.discharge_temperature - high, abs=1e-6)
    assert not BUBBLES & {*p}


def test_the_quality_at_discharge_closes_the_energy_of_steam_that_expands_wet():
    """h_1 less the indicated power over the flow is that of liquid and vapour in this share; dry gas has 1."""
    scene = loads(new_scene("expander", request_of(fluid="Water", condition="6/1 bar, 170 degC")))
    result = simulate(scene, trace=False)
    p, h = result.performance, [PropsSI("H", "P", 1e5, "Q", share, "Water") for share in (0, 1)]
    left = PropsSI("H", "P", 6e5, "T", 443.15, "Water") + p.indicated_power / p.gas_mass_flow
    assert 0.9 < p.discharge_quality < 0.98
    assert p.discharge_quality == pytest.approx((left - h[0]) / (h[1] - h[0]), abs=5e-4)
    dry = {**PRESSURES, "gas": {**PRESSURES["gas"], "two_phase": "equilibrium"}}
    assert run(dry).performance.discharge_quality == 1.0


def test_what_is_stated_comes_back():
    scene = load(CONFIGS / "r454b" / "point.yaml")
    p = simulate(scene, trace=False).performance
    assert p.evaporating_temperature == pytest.approx(scene.operation.evaporating_temperature, abs=1e-6)
    assert p.condensing_temperature == pytest.approx(scene.operation.condensing_temperature, abs=1e-6)
    assert p.suction_superheat == pytest.approx(scene.operation.superheat, abs=1e-6)
    assert p.condensing_bubble_temperature == pytest.approx(
        constants.condensed("R454B", scene.operation.condensing_temperature), abs=1e-9
    )
    assert 0.5 < p.evaporating_temperature - p.evaporating_bubble_temperature < 2.5  # its glide, some 1.5 K


def test_the_error_of_a_superheat_is_that_of_its_temperature(result):
    """A superheat of a few kelvin is as exact as 300 K: its own size would call for ever finer cycles."""
    error = result.error
    assert error.discharge_superheat == pytest.approx(error.discharge_temperature, rel=1e-9)
    assert error.suction_superheat == error.condensing_temperature == 0.0


def test_an_ideal_gas_and_one_above_its_critical_temperature_have_none():
    assert not NAMES & {*run().performance}
    nitrogen = {**PRESSURES, "gas": {"fluid": "nitrogen", "model": "real"}}
    found = run(nitrogen)
    assert found.status == "ok" and not (NAMES | BUBBLES) & {*found.performance, *found.notes}


def test_above_the_critical_pressure_only_the_suction_line_has_some():
    found = simulate(load(CONFIGS / "co2" / "transcritical.yaml"), trace=False)
    p, why = found.performance, "CO2 at 90 bar is above its critical pressure"
    assert p.evaporating_temperature == pytest.approx(263.15, abs=1e-6)
    assert p.condensing_temperature is None and p.discharge_superheat is None
    assert found.notes["condensing_temperature"] == found.notes["discharge_superheat"] == why


def test_wet_suction_has_no_superheat():
    wet = {**PRESSURES, "gas": {"fluid": "R134a", "model": "real", "two_phase": "equilibrium"}}
    wet["operation"] = {**wet["operation"], "suction": {"pressure": "3 bar", "quality": 0.95}}
    found = run({**wet, "oil.transport": "carried", "oil_supply.temperature": "325 K"})
    assert found.performance.suction_superheat is None
    assert found.notes["suction_superheat"] == "the intake is wet"


def test_points_of_a_sweep_have_their_own():
    text = f"base: {CONFIGS}/co2/transcritical.yaml\nsweep: {{operation.gas_cooler.pressure: [70 bar, 78 bar]}}\n"
    swept = loads(text)
    low, high = simulate_many((case(swept, index) for index in range(case_count(swept))), trace=False)
    assert low.performance.condensing_temperature == pytest.approx(PropsSI("T", "P", 70e5, "Q", 1, "CO2"), abs=1e-4)
    assert high.performance.condensing_temperature is None


def test_a_limit_of_a_superheat_is_written_in_kelvin():
    (bound,) = read_bounds(load(CONFIGS / "r134a" / "point.yaml"), ["discharge_superheat>15 K"])
    assert bound.value == 15.0
    with pytest.raises(UsageError, match=r"has no unit 'degC' \(write one of K\)$"):
        read_bounds(load(CONFIGS / "r134a" / "point.yaml"), ["discharge_superheat>15 degC"])
