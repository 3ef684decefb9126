"""A change is one change: --set, `Scene.with_` and an axis of one value give the same scene."""

from dataclasses import replace

import pytest
from folders import CONFIGS

from screwsim.scene import case, load, scene_text

OF_ALL = {"operation.speed": "1700 rpm", "numerics.accuracy": "1e-5"}
CHANGES = {  # what else, by scene: sizes that others follow from, states of lines, numbers of effects
    "paper/point": {"machine.rotor_diameter": "150 mm", "operation.discharge.pressure": "9.3 bar", "gas.fluid": "R32"},
    "r134a/compact": {"machine.profile.wrap_angle": "290 deg", "operation.condensing_temperature": "41 degC"},
    "air/bearing_life": {"operation.suction.temperature": "12 degC", "effects.bearings.shaft_diameter": "100 mm"},
    "co2/transcritical": {"machine.bore": "31 mm", "operation.gas_cooler.pressure": "95 bar"},
    "two_stage/high": {"oil_supply.ratio": "1.7", "operation.superheat": "3 K", "effects.motor.rated_power": "66 kW"},
    "expander/oil": {"oil_supply.temperature": "360 K", "effects.tip_leakage.gap": "33 um"},
}


@pytest.mark.parametrize(("name", "changes"), CHANGES.items())
def test_an_override_a_change_in_python_and_an_axis_of_one_value_give_one_scene(name, changes):
    file = CONFIGS / f"{name}.yaml"
    base = load(file)
    for path, value in (OF_ALL | changes).items():
        wanted = load(file, [f"{path}={value}"])
        swept = case(load(file, [f"sweep={{{path}: [{value}]}}"]), 0)
        assert wanted.text != base.text
        assert base.with_({path: value}).text == wanted.text, path
        assert scene_text(replace(swept, sweep={}, joints=())) == wanted.text, path
