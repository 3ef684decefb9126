"""What a scene says of the humidity of its air, and what cannot be."""

import pytest
from folders import CONFIGS

from screwsim.build import build_gas
from screwsim.fluid.moist_air import MoistAir
from screwsim.inputs.faults import SceneError
from screwsim.scene import load, loads

CONFIG = CONFIGS / "air" / "moist.yaml"


@pytest.mark.parametrize(
    ("overrides", "what"),
    [
        (("gas.relative_humidity=60",), "60 is out of range (it must be at least 0 and at most 1; 60 % is 0.6)"),
        (("gas.relative_humidity=1.01",), "1.01 is out of range (it must be at least 0 and at most 1)"),
        (("gas.relative_humidity=-0.1",), "-0.1 is out of range (it must be at least 0 and at most 1)"),
        (
            ("gas.fluid=R134a",),
            "gas.relative_humidity: applies only to air, and the gas is R134a (remove it, or write fluid: air; "
            "null drops a base's value)",
        ),
        (
            ("gas.fluid=Air.mix",),
            "gas.relative_humidity: applies only to air, and the gas is Air.mix (remove it, or write fluid: air; "
            "null drops a base's value)",
        ),
        (
            ("gas.model=real", "gas.two_phase=equilibrium"),
            "gas.two_phase: applies only to a pure fluid; the water of moist air always condenses in equilibrium "
            "(remove it, or write refuse)",
        ),
        (
            ("operation.suction.temperature=105degC",),
            "gas.relative_humidity: has no meaning at 1 bar and 378.15 K, where water boils (choose a lower "
            "operation.suction.temperature, or a higher pressure)",
        ),
        (
            ("gas.relative_humidity=null",),
            "operation.aftercooler_temperature: needs gas.relative_humidity (write e.g. relative_humidity: 0.6 there, "
            "or remove this)",
        ),
        (
            ("gas.relative_humidity=null", "operation.aftercooler_temperature=null", "gas.dew_point_margin=3 K"),
            "gas.dew_point_margin: needs gas.relative_humidity (write e.g. relative_humidity: 0.6 there, "
            "or remove this)",
        ),
        (("operation.aftercooler_temperature=-3 degC",), "is out of range"),
        (
            ("operation.discharge.pressure=120 bar",),
            "gas.relative_humidity: is modelled up to 100 bar, not at 120 bar (remove it, or lower the pressure)",
        ),
        (
            ("gas.relative_humidity=1", "operation.suction.temperature=95degC", "operation.discharge.pressure=60 bar"),
            "gas.relative_humidity: brings so much water that it condenses above 226.85 degC at 60 bar, where "
            "that is not modelled (choose drier or colder air, or a lower pressure)",
        ),
    ],
)
def test_what_cannot_be_is_told_in_one_line(overrides, what):
    with pytest.raises(SceneError) as caught:
        load(CONFIG, overrides=overrides)
    (line,) = str(caught.value).splitlines()
    assert what in line


def test_the_shipped_scene_states_moist_air_and_writes_it_back():
    scene = load(CONFIG)
    gas = build_gas(scene)
    assert isinstance(gas, MoistAir) and gas.humidity_ratio == pytest.approx(0.01206, abs=1e-5)
    assert build_gas(loads(scene.text)) == gas


def test_the_gas_follows_the_suction_line():
    states = "operation.suction.temperature=35 degC", "operation.suction.pressure=0.9 bar", "gas.relative_humidity=0.7"
    ratios = [build_gas(load(CONFIG, overrides=[each])).humidity_ratio for each in states]
    assert all(ratio > build_gas(load(CONFIG)).humidity_ratio for ratio in ratios)


def test_no_stage_of_two_may_have_humid_air(tmp_path):
    from screwsim.study.stages.read import read_stages

    for name in ("low", "high"):
        (tmp_path / f"{name}.yaml").write_text(f"base: {CONFIG}\n", encoding="utf-8")
    plant = tmp_path / "plant.stages.yaml"
    plant.write_text("stages: [low.yaml, high.yaml]\nintercooler: {kind: cooler, outlet_temperature: 35 degC}\n")
    with pytest.raises(SceneError, match="the water that condenses between the stages is not modelled"):
        read_stages(plant)
