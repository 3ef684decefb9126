"""An error that returns from turn to turn: one life changes far less than what is to come, and estimates tell it."""

from pathlib import Path

import pytest
from effects_space import STRUCTURES
from known_figures import known_finer
from true_error import JUDGED

from screwsim.figures.errors import relative_errors
from screwsim.scene import load, with_values
from screwsim.simulate import simulate

HOT = (
    "operation.speed=994.81315 rpm",
    "operation.suction={pressure: 2.6220042 bar, temperature: 309.09867 K}",
    "operation.discharge.pressure=31.242869 bar",
    "machine.volume.min=0.029513508 cm^3",
    "machine.suction_port.area=70.511169 cm^2",
    "machine.discharge_port={area: 9.4161349 cm^2, opens: 656.23576 deg, phi_C: 672.04619 deg}",
    "oil_supply={ratio: 0.87022633, temperature: 301.9036 K}",
    "effects.tip_leakage.gap=47.864806 um",
    "effects.interlobe_leakage.gap=42.626849 um",
    "effects.end_face_leakage.gap=5.88576396 um",
    "effects.blow_hole.area=1.7237543 mm^2",
    "effects.oil_heat.droplet_radius=106.95964 um",
    "effects.wall_heat={nusselt_factor: 0.12959365, rotor_cooling: 57.546737 W}",
    "effects.thermal_clearances.rotor_expansion=9.4670758 um/(m K)",
    "effects.oil_pump.efficiency=0.37140332",
    "effects.hydromechanical.acceleration_factor=0.86150726",
    "effects.mechanical.fraction=0.048982531",
)


SLOW = (
    "operation.speed=404.9734 rpm",
    "operation.suction={pressure: 1.0003452 bar, temperature: 294.7451 K}",
    "operation.discharge.pressure=1.6595506 bar",
    "machine.volume.min=0.34747952 cm^3",
    "machine.suction_port.area=73.129533 cm^2",
    "machine.discharge_port={area: 98.879375 cm^2, opens: 673.95968 deg, phi_C: 692.02533 deg}",
    "oil_supply={ratio: 0.011814568, temperature: 303.36629 K}",
    "effects.tip_leakage.gap=16.382474 um",
    "effects.interlobe_leakage.gap=5.8870088 um",
    "effects.end_face_leakage.gap=27.517312 um",
    "effects.blow_hole.area=37.252148 mm^2",
    "effects.oil_heat.droplet_radius=17.02386 um",
    "effects.oil_pump.efficiency=0.64517437",
    "effects.hydromechanical.acceleration_factor=0.58730339",
    "effects.mechanical.fraction=0.11395604",
)
PAPER = str(Path(__file__).resolve().parents[2] / "configs" / "paper" / "point.yaml")
SEEN = "gas_mass_flow", "trapped_mass", "discharge_temperature", "shaft_power", "specific_power"


@pytest.mark.parametrize(
    ("structure", "numbers"), [("walls", HOT), ("gaps with friction", SLOW)], ids=["hot rotors", "slow turns"]
)
def test_figures_are_as_near_as_told_where_most_of_an_error_returns(structure, numbers):
    """Hot rotors close the gaps that cool them: 0.06 accuracies were told of a flow off by 4.7.

    A slow machine whose corrections missed 0.3 of what they predicted: one life told 0.5 of a power off by 2.2.
    """
    scene = load(PAPER, [*STRUCTURES[structure].sets, *numbers])
    accuracy = scene.numerics.accuracy
    finer = {"numerics.accuracy": accuracy / 300.0, "numerics.closing": "coupled", "numerics.error": "none"}
    found = simulate(scene, trace=False)
    assert found.status == "ok", found.message
    off = relative_errors(found.performance, known_finer(with_values(scene, finer), 0.1 * accuracy))
    for name in SEEN:
        assert off[name] <= found.error[name] + JUDGED * accuracy, name
        assert off[name] <= accuracy, name
