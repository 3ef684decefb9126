"""M158: bearings carry what the gas on the rotors' surfaces and their contact load each of them with."""

import math
from dataclasses import replace

import numpy as np
import pytest
from each_row import each_row
from folders import CONFIGS

from screwsim import load, simulate
from screwsim.export.rotor_loads import Supports, loads_of, pressures_of
from screwsim.inputs.faults import SceneError

MU, BORE, SHAFT = 0.0018, 0.06, 0.05
BEARINGS = {"load": "rotors", "friction_coefficient": MU, "bore": f"{BORE} m", "shaft_diameter": f"{SHAFT} m"}


STATED = ("evaporating_temperature", "condensing_temperature", "superheat", "subcooling")
EXPANDER = [
    "machine.mode=expander",
    *(f"operation.{name}=null" for name in STATED),
    "operation.suction={pressure: 20 bar, temperature: 100 degC}",
    "operation.discharge.pressure=7 bar",
]


def of_rotors(name: str, **changes):
    return load(CONFIGS / "rotors" / f"{name}.yaml").with_({"effects.bearings": BEARINGS} | changes)


def expander_of_rotors(name: str):
    """Return the dry expander of these rotors, on R134a from 20 to 7 bar."""
    oiled = ["oil_heat", "oil_pump", "hydromechanical", "mechanical"]
    scene = load(CONFIGS / "rotors" / f"{name}.yaml", [*EXPANDER, "oil=null", "oil_supply=null"], without=oiled)
    return scene.with_({"effects.bearings": BEARINGS})


def test_an_expander_presses_on_its_rotors_as_a_compressor_with_its_pressures_run_backwards():
    """M150: the forces are those of the pressures on the same surfaces; torques count in the machine's direction."""
    scene = expander_of_rotors("b")
    result = simulate(scene)
    pressures = pressures_of(scene.machine, result)
    angle, columns = loads_of(pressures)
    there = loads_of(replace(pressures, backwards=False))[1]
    back = (-np.arange(len(angle))) % len(angle)  # the place of the same rotors when they turn the other way
    for name, values in columns.items():
        sign = -1.0 if "torque" in name else 1.0
        np.testing.assert_allclose(values, sign * there[name][back], atol=1e-9 * np.abs(values).max(), err_msg=name)
    own, other = (columns[f"{rotor}_torque_by_virtual_work"].mean() for rotor in ("male", "female"))
    power = scene.operation.speed * (own + scene.machine.male_lobes / scene.machine.female_lobes * other)
    assert power == pytest.approx(result.performance.indicated_power, rel=0.003) and power < 0.0
    assert np.abs(columns["male_torque"] - columns["male_torque_by_virtual_work"]).max() < 0.015 * abs(own)


def test_a_balance_piston_of_an_expander_is_pushed_from_the_inlet():
    """M480: between the inlet's pressure, behind the opening where a compressor discharges, and the outlet's."""
    held = {"suction": {"distance": "50 mm"}, "discharge": {"distance": "60 mm"}}
    free, pushed = (
        simulate(expander_of_rotors("b").with_({"effects.bearings.male": each})).performance
        for each in (held, held | {"balance_piston": {"area": "20 cm^2"}})
    )
    assert free.male_axial_load - pushed.male_axial_load == pytest.approx(20e-4 * (20e5 - 7e5), rel=1e-3)


@pytest.mark.parametrize("scene", [of_rotors("a"), of_rotors("b"), expander_of_rotors("b")], ids=["a", "b", "expander"])
def test_bearings_carry_the_loads_that_are_exported(scene):
    result = simulate(scene)
    columns = loads_of(pressures_of(scene.machine, result), Supports(shafts=(SHAFT, SHAFT)))[1]
    found, power = result.performance, 0.0
    speeds = scene.operation.speed * np.array([1.0, scene.machine.male_lobes / scene.machine.female_lobes])
    for rotor, speed in zip(("male", "female"), speeds, strict=True):
        ways = [columns[f"{rotor}_force_{way}"] + columns[f"{rotor}_contact_force_{way}"] for way in "xy"]
        radial, thrust = np.hypot(*ways), columns[f"{rotor}_thrust_bearing"]
        size = np.hypot(radial, thrust).mean()  # at 48 angles, from traces a degree apart
        assert abs(found[f"{rotor}_radial_load"] - radial.mean()) < 0.005 * size
        assert abs(found[f"{rotor}_axial_load"] + thrust.mean()) < 0.005 * size
        power += speed * 0.5 * MU * BORE * size
    assert found.bearing_power == pytest.approx(power, rel=0.005)


def test_loads_are_less_than_the_upper_limit_of_a_groove_s_area():
    """M146 with 0.27 D² adds all chambers up as if they pressed in one direction."""
    scene = of_rotors("b")
    area = 1e4 * 0.27 * scene.machine.rotor_diameter**2
    limit = {"load": "gas", "shaft_diameter": None, "radial_area": f"{area} cm^2", "axial_area": "0 cm^2"}
    of_surfaces, above = (
        simulate(each).performance for each in (scene, of_rotors("b", **{"effects.bearings": BEARINGS | limit}))
    )
    assert 1.3 * of_surfaces.bearing_power < above.bearing_power < 4.0 * of_surfaces.bearing_power
    assert "male_radial_load" not in above
    assert of_surfaces.indicated_power == above.indicated_power


def test_a_shaft_takes_thrust_off_the_discharge_ends():
    """The gas presses with the discharge end's mean pressure at least, and at most with the discharge pressure."""
    thin, thick = (
        simulate(of_rotors("b", **{"effects.bearings.shaft_diameter": size})).performance for size in ("1 mm", "60 mm")
    )
    off = thin.male_axial_load - thick.male_axial_load
    area = 0.25 * math.pi * (0.06**2 - 0.001**2)
    assert 0.1 < off / (area * (thin.discharge_pressure - thin.suction_pressure)) < 1.0
    assert thick.male_radial_load == pytest.approx(thin.male_radial_load, rel=1e-9)


@each_row(
    ("changes", "words"),
    [
        ({"shaft_diameter": "120 mm"}, "effects.bearings.shaft_diameter: 120 mm is not less than 96 mm, the male"),
        ({"count": 4}, "effects.bearings.count: applies only to friction: two_term (remove it)"),
        ({"female_load": 1.0}, "effects.bearings.female_load: is found by load: rotors (remove it)"),
        ({"radial_area": "1 cm^2"}, "effects.bearings.radial_area: applies only to gas, and rotors is chosen"),
        ({"load": "stated"}, "effects.bearings.shaft_diameter: applies only to rotors, and stated is chosen"),
    ],
)
def test_a_fault_is_found_with_its_remedy(changes, words):
    with pytest.raises(SceneError) as caught:
        of_rotors("b", **{"effects.bearings": BEARINGS | changes})
    assert words in str(caught.value)


def test_rotors_without_a_profile_have_no_surfaces():
    with pytest.raises(SceneError, match="load: rotors needs rotors with a profile"):
        load(CONFIGS / "paper" / "point.yaml").with_({"effects.bearings": BEARINGS})
