"""A scene of a slider-crank: its own fields, what it refuses, its canonical text, its sweeps."""

import pytest
from each_row import each_row

from screwsim.explain import explain
from screwsim.inputs.faults import SceneError
from screwsim.scene import case_count, loads

SCENE = """\
machine: {kind: slider_crank, bore: 50 mm, crank_radius: 20 mm, rod_length: 90 mm, clearance: 3 cm^3}
gas: {fluid: Air}
operation: {speed: 1500 rpm, suction: {pressure: 1 bar, temperature: 300 K}, discharge: {pressure: 4 bar}}
effects:
  check_valves: {suction_area: 2 cm^2, discharge_area: 1.5 cm^2}
"""


def fault(text: str) -> str:
    with pytest.raises(SceneError) as raised:
        loads(text)
    (line,) = raised.value.lines
    return line


def test_the_canonical_text_gives_the_same_scene():
    scene = loads(SCENE)
    again = loads(scene.text)
    assert again.machine == scene.machine
    assert again.text == scene.text


def test_a_path_of_the_machine_can_be_swept():
    scene = loads(SCENE + "sweep: {machine.clearance: [1 cm^3, 2 cm^3], effects.check_valves.suction_area: [1 cm^2]}")
    assert case_count(scene) == 2


@each_row(
    ("old", "new", "message"),
    [
        ("bore: 50 mm", "bore: 50 mm, male_lobes: 4", "machine.male_lobes: is not known"),
        ("kind: slider_crank", "kind: spiral", "choose from: twin_screw, slider_crank"),
        ("rod_length: 90 mm", "rod_length: 19 mm", "the crank cannot turn"),
        ("rod_length: 90 mm", "rod_length: 25 mm, offset: 8 mm", "are not below the rod length of 25 mm"),
        ("effects:", "oil: {density: 900 kg/m^3, heat_capacity: 2 kJ/(kg K)}\neffects:", "no oil is injected"),
        ("effects:\n", "effects:\n  blow_hole: {area: 1 mm^2}\n", "applies only to machine.kind: twin_screw"),
        ("effects:\n", "effects:\n  ring_leakage: {}\n", "effects.ring_leakage.gap: is missing"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(old, new, message):
    if "spiral" in new:
        with pytest.raises(SceneError) as raised:
            loads(SCENE.replace(old, new))
        assert message in "\n".join(raised.value.lines)
        return
    assert message in fault(SCENE.replace(old, new))


def test_the_kind_cannot_be_swept():
    assert "machine.kind" in fault(SCENE + "sweep: {machine.kind: [slider_crank]}")


def test_valves_belong_to_a_cylinder():
    text = "machine: {rotor_diameter: 160 mm, rotor_length: 176 mm, volume: {max: 600 cm^3, phi_A: 60 deg}}\n"
    assert "applies only to machine.kind: slider_crank" in fault(text + SCENE.partition("\n")[2])


def test_it_is_explained():
    text = " ".join(str(explain(loads(SCENE))).split())
    for words in ("crank and rod (S1, S5)", "mean piston speed 2 m/s", "one chamber", "opened by its valve"):
        assert words in text
    assert "lobe" not in text.partition("Left out")[0]
