"""A result that closes on what no machine does says so: figures, ways of the gas, loads of the motor."""

from pathlib import Path
from types import SimpleNamespace

import pytest
from scenes import DROP, make, run

from screwsim.evaluate.plausible import _apart
from screwsim.fluid.oils import OILS
from screwsim.scene import load
from screwsim.scene.plausible import scene_warnings
from screwsim.simulate import simulate

CONFIGS = Path(__file__).parents[2] / "configs"
PLAIN = Path(__file__).parents[1] / "plain" / "r134a.yaml"


def told(result, words):
    return [warning for warning in result.warnings if words in warning]


def at(path, *overrides):
    return simulate(load(CONFIGS / path, overrides=overrides), trace=False)


SHIPPED = ("paper/point.yaml", "r134a/point.yaml", "r134a/compact.yaml", "expander/point.yaml")


@pytest.mark.parametrize("path", [*SHIPPED, PLAIN])
def test_a_plausible_machine_is_warned_of_nothing(path):
    result = at(path)
    assert result.status == "ok"
    assert result.warnings == ()


def test_oil_colder_than_the_gas_is_named_where_it_lifts_the_efficiencies_above_one():
    lossless = ("effects.mechanical.fraction=0", "effects.hydromechanical.acceleration_factor=0")
    result = at("paper/point.yaml", *lossless, "effects.oil_pump.pressure_loss=0 bar", "oil_supply.temperature=160 K")
    assert result.status == "ok"
    assert result.performance.isothermal_efficiency > 1.0
    (warning,) = told(result, "isothermal efficiency")
    assert "the oil comes in at -113.15 degC, colder than the suction gas of 5.85 degC" in warning
    (warning,) = told(result, "isentropic efficiency")
    assert "oil cools the gas during compression" in warning


def test_gaps_that_let_more_back_than_is_displaced_are_told():
    result = at("paper/point.yaml", "effects.tip_leakage.gap=20 mm")
    assert result.performance.volumetric_efficiency < -0.5
    assert told(result, "more flows back through leaks than the rotors displace")
    assert told(result, "effects.tip_leakage.gap: 20 mm is unusual")


def test_oil_that_leaves_hotter_than_its_properties_are_known_is_told():
    of_numbers = ("density", "heat_capacity", "viscosity")
    cooled = ["effects.separator.cooler.conductance=4 kW/K", "oil.name=mineral_46"]
    cooled += [f"oil.{name}=null" for name in of_numbers]
    little = at("air/fixed_speed_7.yaml", "oil_supply.orifice_diameter=2 mm", *cooled)
    hottest = OILS["mineral_46"].high
    assert little.status == "ok" and little.performance.oil_discharge_temperature > hottest
    (warning,) = told(little, "up to which mineral_46 is known")
    assert warning.startswith("the oil leaves at ") and "150 degC" in warning
    usual = at("air/fixed_speed_7.yaml", *cooled)
    assert usual.performance.mixture_discharge_temperature < hottest and not told(usual, "the oil leaves at")


def test_oil_that_leaves_an_expander_colder_than_its_properties_are_known_is_told():
    named = "oil={name: mineral_46, density: null, heat_capacity: null, viscosity: null}"
    cold = ["gas.fluid=Nitrogen", "operation.suction.temperature=-30 degC", "oil_supply.temperature=-10 degC", named]
    result = at("expander/oil.yaml", *cold)
    coldest = OILS["mineral_46"].low
    assert result.status == "ok" and result.performance.oil_discharge_temperature < coldest
    (warning,) = told(result, "from which mineral_46 is known")
    assert warning.startswith("the oil leaves at ") and "-20 degC" in warning and "warmer oil" in warning
    assert not told(at("expander/oil.yaml", named), "the oil leaves at")


def test_a_warning_of_the_scene_comes_before_all_others():
    result = run({"operation.speed": "30000 rpm", "effects.tip_leakage.gap": "1.5 mm"})
    assert result.warnings[0].startswith("effects.tip_leakage.gap: 1.5 mm is unusual")


def test_a_failed_point_keeps_the_warnings_of_its_scene():
    result = at(PLAIN, "effects.suction_port=off", "effects.tip_leakage.gap=1.5 mm")
    assert result.status == "failed"
    assert told(result, "effects.tip_leakage.gap: 1.5 mm")


def test_a_forgotten_suction_port_is_told_as_that():
    result = at(PLAIN, "effects.suction_port=off")
    assert result.status == "failed"
    assert "no port or valve leads from the suction line into the chambers (name effects.suction_port" in result.message
    assert "machine.suction_port is given, but only named effects are simulated" in result.message


@pytest.mark.parametrize("port", ["suction_port", "discharge_port"])
def test_a_chamber_with_no_way_in_or_out_is_warned_of(port):
    dry = {"oil": DROP, "oil_supply": DROP, "numerics.error": "none", "numerics.accuracy": 0.05}  # closes soon
    left = {"suction_port", "discharge_port"} - {port}
    result = run({**dry, "effects": {name: {} for name in left}})
    way = "from the suction line into" if port == "suction_port" else "to the discharge line out of"
    assert told(result, f"leads {way} the chambers (name effects.{port}") or f"name effects.{port}" in result.message


def test_an_expander_lacks_the_port_through_which_its_gas_comes_or_goes():
    result = at("expander/point.yaml", "effects.suction_port=off")
    words = " ".join((result.message, *result.warnings))
    assert "to the discharge line out of the chambers (name effects.suction_port" in words


@pytest.mark.parametrize(
    ("rated", "status", "words"),
    [
        ("75 kW", "ok", ""),
        ("10 kW", "ok", "times effects.motor.rated_power: it would not last"),
        ("2.65 kW", "failed", "no motor carries more than 3.5 times its rated power (choose a larger one)"),
    ],
)
def test_a_motor_that_is_too_small_is_told_or_does_not_turn(rated, status, words):
    scene = make({"effects.motor": {"rated_power": rated}, "operation.speed": "1000 rpm"})
    result = simulate(scene, trace=False)
    assert result.status == status
    assert words in result.message if status == "failed" else bool(told(result, "the motor's load")) == bool(words)
    if status == "failed":
        assert result.performance.shaft_power > 3.5 * 2650.0


def test_oil_on_which_a_real_gas_condenses_is_told_at_the_front():
    scene = load(PLAIN, overrides=("oil_supply.temperature=300 K",))
    words = "R134a condenses on it at the discharge pressure, 11.6 bar, below 45 degC (use warmer oil)"
    assert any(words in each and each.startswith("oil_supply.temperature: ") for each in scene_warnings(scene))
    assert not scene_warnings(load(PLAIN))
    dry = load(PLAIN, ("oil_supply.temperature=300 K",), without=("oil_heat",))
    assert not scene_warnings(dry)  # they exchange no heat


def test_gas_that_leaves_more_than_30_kelvin_above_its_mixture_with_the_oil_is_told():
    """Ammonia on cold oil left at 178 °C beside a mixture of 75 °C, with no word on it."""

    def words(gas, mixture, expands=False):
        found = {"discharge_temperature": gas, "mixture_discharge_temperature": mixture}
        doubts = [doubt for ask in (_apart,) for doubt in ask(SimpleNamespace(found=found, expands=expands))]
        return "".join(doubt.words for doubt in doubts)

    assert "451 degC" not in words(451.0, 348.0) and "70 K apart" in words(451.0, 348.0)
    assert words(378.0, 348.0) == words(451.0, None) == words(451.0, 348.0, expands=True) == ""
