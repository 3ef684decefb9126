"""Efficiency classes of motors: the printed efficiencies, what a scene makes of a class, and what is refused."""

from pathlib import Path

import pytest
from each_row import each_row

import screwsim
from screwsim.effects import motor
from screwsim.effects.parts.motor_classes import CLASSES, class_efficiency
from screwsim.inputs.faults import SceneError
from screwsim.scene import with_values

POINT = Path(__file__).parents[2] / "configs" / "paper" / "point.yaml"
POWERS = (0.75, 1.1, 1.5, 2.2, 3, 4, 5.5, 7.5, 11, 15, 18.5, 22, 30, 37, 45, 55, 75, 90, 110, 132, 160, 200)  # kW
NOMINAL = {  # percent, Regulation (EU) 2019/1781, annex I, tables 1 to 3
    (
        "IE2",
        2,
    ): "77.4 79.6 81.3 83.2 84.6 85.8 87.0 88.1 89.4 90.3 90.9 91.3 92.0 92.5 92.9 93.2 93.8 94.1 94.3 94.6 94.8 95",
    (
        "IE2",
        4,
    ): "79.6 81.4 82.8 84.3 85.5 86.6 87.7 88.7 89.8 90.6 91.2 91.6 92.3 92.7 93.1 93.5 94.0 94.2 94.5 94.7 94.9 95.1",
    (
        "IE2",
        6,
    ): "75.9 78.1 79.8 81.8 83.3 84.6 86.0 87.2 88.7 89.7 90.4 90.9 91.7 92.2 92.7 93.1 93.7 94.0 94.3 94.6 94.8 95",
    (
        "IE3",
        2,
    ): "80.7 82.7 84.2 85.9 87.1 88.1 89.2 90.1 91.2 91.9 92.4 92.7 93.3 93.7 94.0 94.3 94.7 95.0 95.2 95.4 95.6 95.8",
    (
        "IE3",
        4,
    ): "82.5 84.1 85.3 86.7 87.7 88.6 89.6 90.4 91.4 92.1 92.6 93.0 93.6 93.9 94.2 94.6 95.0 95.2 95.4 95.6 95.8 96.0",
    (
        "IE3",
        6,
    ): "78.9 81.0 82.5 84.3 85.6 86.8 88.0 89.1 90.3 91.2 91.7 92.2 92.9 93.3 93.7 94.1 94.6 94.9 95.1 95.4 95.6 95.8",
    (
        "IE4",
        2,
    ): "83.5 85.2 86.5 88.0 89.1 90.0 90.9 91.7 92.6 93.3 93.7 94.0 94.5 94.8 95.0 95.3 95.6 95.8 96.0 96.2 96.3 96.5",
    (
        "IE4",
        4,
    ): "85.7 87.2 88.2 89.5 90.4 91.1 91.9 92.6 93.3 93.9 94.2 94.5 94.9 95.2 95.4 95.7 96.0 96.1 96.3 96.4 96.6 96.7",
    (
        "IE4",
        6,
    ): "82.7 84.5 85.9 87.4 88.6 89.5 90.5 91.3 92.3 92.9 93.4 93.7 94.2 94.5 94.8 95.1 95.4 95.6 95.8 96.0 96.2 96.3",
}


@each_row(("name", "poles"), NOMINAL)
def test_polynomials_meet_the_printed_efficiencies_within_half_of_their_last_digit(name, poles):
    printed = [float(each) for each in NOMINAL[name, poles].split()]
    found = [100.0 * class_efficiency(name, poles, 1e3 * power) for power in POWERS]
    assert found == pytest.approx(printed, abs=0.0501)


@pytest.mark.parametrize("poles", [2, 4, 6])
def test_a_better_class_loses_less_and_a_motor_above_200_kW_is_as_good_as_one_of_200(poles):
    for power in POWERS:
        rising = [class_efficiency(name, poles, 1e3 * power) for name in CLASSES]
        assert rising == sorted(rising)
    assert class_efficiency("IE3", poles, 900e3) == class_efficiency("IE3", poles, 200e3)


def test_a_class_is_the_efficiency_that_it_states_whatever_the_rated_power_becomes():
    scene = screwsim.load(POINT, ["effects.motor={rated_power: 110 kW, efficiency_class: IE4, poles: 2}"])
    assert scene.effects["motor"].parameters.efficiency == class_efficiency("IE4", 2, 110e3)
    larger = with_values(scene, {"effects.motor.rated_power": 250e3})
    assert larger.effects["motor"].parameters.efficiency == class_efficiency("IE4", 2, 250e3)
    stated = scene.text
    assert "efficiency_class: IE4" in stated and screwsim.loads(stated).effects["motor"].parameters == (
        scene.effects["motor"].parameters
    )
    assert motor.Parameters(rated_power=75e3).efficiency == 0.95


def test_a_default_efficiency_stays_one_in_the_text_of_a_scene_and_a_class_may_replace_it():
    scene = screwsim.load(POINT, ["effects.motor={rated_power: 15 kW}"])
    again = screwsim.loads(scene.text, folder=scene.folder)
    told = [screwsim.simulate(each, trace=False).warnings for each in (scene, again)]
    assert "constant_share: 0.4" in scene.text and "effects.motor.efficiency is not stated" in " ".join(told[0])
    assert told[0] == told[1]
    of_class = scene.with_({"effects.motor.efficiency_class": "IE3"})
    assert of_class.effects["motor"].parameters.efficiency == class_efficiency("IE3", 4, 15e3)


@each_row(
    ("stated", "words"),
    [
        (
            "efficiency_class: IE3, efficiency: 0.95",
            r"motor\.efficiency: is given as well as .* or --set effects\.motor\.efficiency=null\)",
        ),
        ("efficiency_class: IE3, poles: 8", r"motor\.poles: 8 is not covered, only 2, 4 and 6 are"),
        ("efficiency: 0.95, poles: 8", r"motor\.poles: 8 is not covered, only 2, 4 and 6 are"),
        ("poles: 2", r"motor\.poles: needs the efficiency of such a motor \(write efficiency_class: IE3, or "),
        ("efficiency_class: IE33", "is not an option"),
        ("efficiency_class: IE3, rated_power: 1200 kW", r"1200 kW: classes cover 0\.75 kW to 1000 kW"),
    ],
)
def test_what_a_class_does_not_know_is_refused(stated, words):
    power = "" if "rated_power" in stated else "rated_power: 110 kW, "
    with pytest.raises(SceneError, match=words):
        screwsim.load(POINT, [f"effects.motor={{{power}{stated}}}"])


def test_poles_stand_beside_a_stated_efficiency_and_leave_it_as_it_is():
    motor = screwsim.load(POINT, ["effects.motor={rated_power: 110 kW, efficiency: 0.94, poles: 6}"])
    parameters = motor.effects["motor"].parameters
    assert (parameters.efficiency, parameters.poles) == (0.94, 6)
