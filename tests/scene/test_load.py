"""Rules of loading: values in SI, bases, overrides, own effects, curve files, canonical text."""

import math
import pickle
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from screwsim.inputs.faults import SceneError
from screwsim.scene import load, loads, scene_text, with_values


def test_values_arrive_in_si(example):
    scene = loads(example)
    assert scene.machine.rotor_diameter == 0.16
    assert scene.operation.speed == pytest.approx(100 * math.pi, rel=1e-15)
    assert scene.operation.suction.pressure == 1.5e5
    assert scene.machine.volume.max == 600e-6
    assert scene.effects["tip_leakage"].parameters.gap == 50e-6
    assert scene.oil_supply.ratio == 3.0


def test_what_is_left_out_has_its_default(example):
    scene = loads(example)
    assert scene.numerics.accuracy == 3e-4
    assert scene.output.keep == "performance"
    assert scene.effects["tip_leakage"].parameters.flow_coefficient == 0.7


def test_null_is_as_if_absent(example):
    text = example.replace("  viscosity: 20 mPa s", "  viscosity: null").replace("model: ideal", "model:")
    scene = loads(text)
    assert scene.oil.viscosity is None
    assert scene.gas.model == "ideal"


def test_effects_keep_the_order_of_the_catalogue(example):
    head, effects = example.split("effects:\n")
    start = effects.index("  mechanical")
    scene = loads(f"{head}effects:\n{effects[start:]}{effects[:start]}")
    assert list(scene.effects) == list(loads(example).effects)
    assert next(iter(scene.effects)) == "suction_port"


def test_an_alias_stands_for_its_anchor(example):
    text = example.replace("gap: 50 um}", "gap: &gap 60 um}", 1).replace("{gap: 50 um, length", "{gap: *gap, length")
    assert loads(text).effects["end_face_leakage"].parameters.gap == 60e-6


def test_numbers_of_yaml_1_2_are_numbers(example):
    assert loads(example + "numerics: {accuracy: 1e-3}\n").numerics.accuracy == 1e-3


def test_a_base_is_changed_path_by_path(example, scene_file):
    scene_file(example, "below/point.yaml")
    scene_file("base: below/point.yaml\noperation: {speed: 2000 rpm}\n", "middle.yaml")
    path = scene_file("base: middle.yaml\ntitle: top\neffects: {blow_hole: {area: 3 mm^2}}\n", "top.yaml")
    scene = load(path)
    assert scene.title == "top"
    assert scene.operation.speed == pytest.approx(2000 * math.pi / 30, rel=1e-15)
    assert scene.operation.suction.pressure == 1.5e5
    assert scene.effects["blow_hole"].parameters.area == 3e-6
    assert len(scene.effects) == 10


def test_off_takes_out_an_effect_of_the_base(example, scene_file):
    scene_file(example, "point.yaml")
    scene = load(scene_file("base: point.yaml\neffects: {oil_pump: off}\n", "top.yaml"))
    below = load(scene_file("base: point.yaml\n", "same.yaml"))
    assert "oil_pump" in below.effects
    assert list(scene.effects) == [name for name in below.effects if name != "oil_pump"]
    assert loads(scene.text, folder=scene.folder) == scene


def test_off_hides_no_unknown_effect(example, scene_file, monkeypatch, tmp_path):
    scene_file(example, "point.yaml")
    scene_file("base: point.yaml\neffects: {oil_pmp: off}\n", "top.yaml")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SceneError) as error:
        load("top.yaml")
    assert error.value.lines == ["top.yaml:2:11: effects.oil_pmp: is not known; did you mean 'oil_pump'?"]


def test_a_fault_in_a_base_is_located_in_the_base(example, scene_file, monkeypatch, tmp_path):
    scene_file(example.replace("160 mm", "160"), "below/point.yaml")
    scene_file("base: below/point.yaml\ngas: {fluid: 3}\n", "top.yaml")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SceneError) as error:
        load("top.yaml")
    assert [line.split(": ")[0] for line in error.value.lines] == ["top.yaml:2:14", "below/point.yaml:6:19"]


def test_a_cycle_of_bases_is_refused(scene_file, monkeypatch, tmp_path):
    scene_file("base: b.yaml\n", "a.yaml")
    scene_file("base: a.yaml\n", "b.yaml")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SceneError) as error:
        load("a.yaml")
    assert "b.yaml:1:7: base: 'a.yaml' is based on this file again (a chain of bases must end)" in error.value.lines


def test_a_base_that_is_not_there_is_one_line(example):
    with pytest.raises(SceneError) as error:
        loads(example.replace("title: example", "base: nix.yaml"), "x.yaml")
    assert error.value.lines == [
        "x.yaml:1:7: base: 'nix.yaml' does not exist "
        f"(name a scene file as seen from the folder of this one, {Path.cwd()})"
    ]


def test_an_override_replaces_one_path(example):
    scene = loads(example, overrides=["operation.speed=1000 rpm", "oil_supply.ratio=2", "title=a: b"])
    assert scene.operation.speed == pytest.approx(1000 * math.pi / 30, rel=1e-15)
    assert (scene.oil_supply.ratio, scene.title) == (2.0, "a: b")


def test_an_override_is_checked_like_the_file(example):
    with pytest.raises(SceneError) as error:
        loads(example, overrides=["operation.speed=abc", "machine.lobes=3", "oil_supply.ratio=[1"])
    assert error.value.lines == [
        "--set operation.speed=abc: operation.speed: 'abc' is not a speed (write e.g. '3000 rpm')",
        "--set machine.lobes=3: machine.lobes: is not known; there are male_lobes, female_lobes (write the whole name)",
        "--set oil_supply.ratio=[1: oil_supply.ratio: is not YAML: expected ',' or ']', but got '<stream end>' "
        "(close the [ that opens in line 1, column 1 with ], and separate what is inside by commas)",
    ]


def test_an_override_names_an_absent_effect(example):
    text = example.replace("  blow_hole: {area: 6 mm^2}\n", "")
    assert loads(text, overrides=["effects.blow_hole.area=6 mm^2"]) == loads(example)


def test_all_after_sweep_is_one_key(example):
    scene = loads(example, overrides=["sweep.oil_supply.ratio=[1, 2]"])
    assert scene.sweep == {"oil_supply.ratio": (1.0, 2.0)}


def test_without_removes_an_effect(example):
    assert "blow_hole" not in loads(example, without=["blow_hole"]).effects


OWN_EFFECT = """\
from dataclasses import dataclass
from screwsim.inputs.declare import quantity
from screwsim.effects.base import Effect

@dataclass(frozen=True)
class Parameters:
    width: float = quantity("length", "a width", gt=0.0)

def build(parameters, machine):
    return []

EFFECT = Effect("mine", "own", (), "own", Parameters, build)
"""


@pytest.fixture
def own_package(tmp_path, monkeypatch):
    """Give a package with an effect in the working folder."""
    for name in [each for each in sys.modules if each.partition(".")[0] == "own_effects_of_test"]:
        del sys.modules[name]  # of another test, whose folder is gone
    folder = tmp_path / "own_effects_of_test"
    folder.mkdir()
    (folder / "__init__.py").touch()
    (folder / "mine.py").write_text(OWN_EFFECT)
    (folder / "broken.py").write_text("1 / 0\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [entry for entry in sys.path if entry])
    return "own_effects_of_test"


def test_an_own_effect_is_found_in_the_working_folder(example, own_package):
    name = f"{own_package}.mine"
    text = example.replace("effects:\n", f"effects:\n  {name}: {{width: 3 mm}}\n")
    scene = loads(text, overrides=[f"effects.{name}.width=4 mm", f"sweep.effects.{name}.width=[1 mm]"])
    assert list(scene.effects)[-1] == name
    assert scene.effects[name].parameters.width == 4e-3
    assert with_values(scene, {f"effects.{name}.width": 0.5}).effects[name].parameters.width == 0.5
    assert loads(scene.text, folder=scene.folder) == scene


def test_an_own_effect_that_fails_on_import_is_a_fault(example, own_package):
    text = example.replace("effects:\n", f"effects:\n  {own_package}.broken:\n")
    with pytest.raises(SceneError) as error:
        loads(text, "x.yaml")
    assert error.value.lines == [
        "x.yaml:31:3: effects.own_effects_of_test.broken: fails on import "
        "(ZeroDivisionError: division by zero); fix that module"
    ]


TABLE = "volume: {law: table, max: 600 cm^3, file: v.csv}"


def table_scene(example):
    return example.replace("volume: {law: paper, max: 600 cm^3, phi_A: 60 deg}", TABLE)


def test_a_curve_file_is_found_beside_the_scene(example, scene_file, tmp_path):
    scene_file("angle_deg,volume_m3\n0,0\n360,6e-4\n720,0\n", "v.csv")
    scene = load(scene_file(table_scene(example)))
    assert scene.machine.volume.file == str(tmp_path / "v.csv")
    assert 'file: "v.csv"' in scene.text
    assert loads(scene.text, folder=scene.folder) == scene


def test_a_curve_file_of_a_base_is_found_beside_the_base(example, scene_file, tmp_path):
    scene_file("angle_deg,volume_m3\n0,0\n360,6e-4\n720,0\n", "below/v.csv")
    scene_file(table_scene(example), "below/x.yaml")
    scene = load(scene_file("base: below/x.yaml\n", "top.yaml"))
    assert scene.machine.volume.file == str(tmp_path / "below" / "v.csv")


@pytest.mark.parametrize(
    ("table", "what"),
    [
        (None, "'v.csv' is not a file in "),
        ("angle_deg,area_m2\n0,0\n", "'v.csv': needs the columns angle_deg and volume_m3 (found: angle_deg, area_m2)"),
        ("angle_deg,volume_m3\n0,x\n", "'v.csv': line 2: '0', 'x' are not two numbers"),
    ],
    ids=["missing", "columns", "numbers"],
)
def test_a_bad_curve_file_is_a_fault_at_its_name(example, scene_file, table, what):
    if table is not None:
        scene_file(table, "v.csv")
    path = scene_file(table_scene(example))
    with pytest.raises(SceneError) as error:
        load(path)
    (line,) = error.value.lines
    assert line.startswith(f"{path}:8:45: machine.volume.file: {what}")


def test_the_text_alone_gives_the_same_scene(example):
    changes = ["sweep.operation.speed={from: 1000 rpm, to: 3000 rpm, count: 7}", "sweep.oil.transport=[paper, carried]"]
    scene = loads(example, overrides=changes, without=["blow_hole"])
    assert loads(scene.text) == scene


LENGTHS, SHARES = st.floats(1e-6, 10.0), st.floats(1e-6, 1.0)


@settings(max_examples=50, deadline=None)
@given(
    diameter=LENGTHS,
    gap=SHARES,
    tips=st.floats(1e-3, 999.0),
    temperature=st.floats(40.0, 2500.0),
    ratio=st.floats(0.0, 1e20),
    title=st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0")),
    axis=st.lists(st.floats(1e-3, 1e3), min_size=1, max_size=5, unique=True),
)
def test_any_numbers_survive_the_text(example, diameter, gap, tips, temperature, ratio, title, axis):
    speed = min(2.0 * tips / diameter, 1e6)  # rad/s: no more than any machine has
    values = {
        "machine.rotor_diameter": diameter,
        "machine.rotor_length": 1.1 * diameter,
        "machine.volume.max": 0.1 * gap * diameter**3,
        "machine.suction_port.area": gap * diameter**2,
        "machine.discharge_port.area": 0.3 * gap * diameter**2,
        "effects.tip_leakage.gap": 0.2 * gap * diameter,
        "effects.interlobe_leakage.gap": 0.1 * gap * diameter,
        "effects.interlobe_leakage.length": diameter,
        "effects.blow_hole.area": 0.1 * gap * diameter**2,
        "effects.end_face_leakage.gap": 0.01 * diameter,
        "effects.end_face_leakage.length": 0.5 * diameter,
        "effects.oil_heat.droplet_radius": 0.1 * gap * diameter,
        "operation.speed": speed,
        "operation.suction.temperature": temperature,
        "oil_supply.ratio": ratio,
        "title": title,
        "sweep": {"oil_supply.ratio": tuple(axis), "operation.speed": (speed,)},
    }
    scene = with_values(loads(example), values)
    text = scene_text(scene)
    assert loads(text) == replace(scene, text=text)


def test_a_scene_travels_between_processes(example):
    scene = loads(example)
    assert pickle.loads(pickle.dumps(scene)) == scene


def test_null_for_an_effect_with_needed_parameters_says_how_to_leave_it_out(scene_file, example):
    scene_file(example, "point.yaml")
    with pytest.raises(SceneError) as error:
        load(scene_file("base: point.yaml\neffects: {tip_leakage: null}\n", "top.yaml"))
    (line,) = error.value.lines
    missing = "effects.tip_leakage.gap: is missing (write gap: … mm; clearance; or tip_leakage: off to leave it out)"
    assert line.endswith(missing)
