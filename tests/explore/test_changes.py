"""What a page asks for becomes the scene that `--set` would give, and a page names no file, module or text."""

import shlex

import pytest
from each_row import each_row
from explore_line import PAPER

from screwsim.explore.changes import (
    MOST_CHANGES,
    Changes,
    open_base,
    overrides_of,
    python_text,
    read_changes,
    scene_of,
    shell_command,
    yaml_text,
)
from screwsim.inputs.faults import SceneError
from screwsim.scene import load
from screwsim.scene.units import Refused

VALUES = {"operation.speed": "2000.5 rpm", "oil_supply.ratio": 0.1, "effects.tip_leakage.gap": "31 um"}
EFFECTS = {"blow_hole": False, "gas_torque": True}


@pytest.fixture(scope="module")
def base():
    """Return the paper's machine as a command names it with an override and an effect left out."""
    return open_base(PAPER, ["oil_supply.temperature=290 K"], ["mechanical"])


def overrides(base, values=VALUES, effects=EFFECTS):
    return overrides_of(base, Changes(values, effects))


def test_the_scene_is_that_of_the_overrides(base):
    scene = scene_of(base, overrides(base))
    assert scene.operation.speed == pytest.approx(2000.5 * 3.141592653589793 / 30, rel=1e-15)
    assert scene.oil_supply.temperature == 290.0
    assert "gas_torque" in scene.effects and not {"blow_hole", "mechanical"} & set(scene.effects)


def test_the_command_gives_the_same_scene(base):
    words = shlex.split(shell_command(base, overrides(base)))
    assert words[:3] == ["screwsim", "run", PAPER]
    options = list(zip(words[3::2], words[4::2], strict=True))
    assert {option for option, _ in options} == {"--set"}
    again = load(PAPER, [value for _, value in options])
    assert again.text == scene_of(base, overrides(base)).text


def test_the_command_sets_a_path_once(base):
    """One that the page's own command set as well: `--set` takes no path twice."""
    wanted = overrides(base, {"oil_supply.temperature": "310 K"}, {"blow_hole": False})
    assert "oil_supply.temperature=290 K" in base.overrides
    words = shlex.split(shell_command(base, wanted))[4::2]
    assert sorted(words) == ["effects.blow_hole=off", "effects.mechanical=off", "oil_supply.temperature=310 K"]
    assert scene_of(base, wanted).oil_supply.temperature == 310.0


def test_the_python_gives_the_same_scene(base):
    text = python_text(base, overrides(base)).partition("result =")[0]
    names = {}
    exec(text, names)
    assert names["scene"].text == scene_of(base, overrides(base)).text


@pytest.mark.parametrize("effects", [EFFECTS, {"mechanical": True}, {"tip_leakage": False}, {}])
def test_the_yaml_gives_the_same_scene(base, tmp_path, effects):
    wanted = overrides(base, VALUES, effects)
    (tmp_path / "x.yaml").write_text(yaml_text(base, wanted), encoding="utf-8")
    assert load(tmp_path / "x.yaml").text == scene_of(base, wanted).text


def test_an_effect_that_the_command_left_out_comes_back_with_its_parameters(base):
    scene = scene_of(base, overrides(base, {}, {"mechanical": True}))
    assert scene.effects["mechanical"].parameters == load(PAPER).effects["mechanical"].parameters


def test_values_of_an_effect_that_is_off_are_left_aside(base):
    assert overrides(base, {"effects.tip_leakage.gap": "31 um"}, {"tip_leakage": False}) == ["effects.tip_leakage=off"]


@each_row(
    "path",
    [
        "machine.volume.file",
        "effects.tip_leakage.area_file",
        "machine.profile.file",
        "gas.fluid",
        "title",
        "base",
        "machine.kind",
        "sweep.operation.speed",
        "effects.my_package.my_effect.gap",
        "effects.tip_leakage",
        "effects",
        "operation.speed.x",
        "",
        "a" * 5000,
    ],
)
def test_a_page_changes_numbers_and_choices_and_nothing_else(base, path):
    with pytest.raises(Refused) as refusal:
        overrides(base, {path: "x"}, {})
    assert len(str(refusal.value)) < 300


@each_row("name", ["os", "my_package.my_effect", "../x", "cylinder_heat", ""])
def test_a_page_switches_effects_of_its_machine_and_no_module(base, name):
    with pytest.raises(Refused):
        overrides(base, {}, {name: True})


@each_row(
    ("path", "value"),
    [
        ("operation.speed", "{base: /etc/passwd}"),
        ("operation.speed", "3000 rpm\ntitle: x"),
        ("operation.speed", 3000),
        ("operation.speed", "9**9**9 rpm"),
        ("operation.speed", "3000 rpm" + " " * 100),
        ("oil_supply.ratio", "3"),
        ("oil_supply.ratio", True),
        ("oil_supply.ratio", 1e999),
        ("oil_supply.ratio", [3]),
        ("oil_supply.kind", "os.system"),
        ("numerics.integrator", "my_package.my_integrator"),
        ("machine.male_lobes", 4.5),
    ],
)
def test_a_value_is_one_of_its_field(base, path, value):
    with pytest.raises(Refused):
        overrides(base, {path: value}, {})


@each_row(
    "raw",
    [
        None,
        [],
        {"set": []},
        {"effects": {"blow_hole": "off"}},
        {"overrides": ["base=x"]},
        {"set": {str(i): 1 for i in range(MOST_CHANGES + 1)}},
        {"set": {"\ud800": 1}},
        {"effects": {"a\nb": True}},
    ],
)
def test_settings_are_mappings_of_a_size_whose_names_can_be_told(raw):
    with pytest.raises(Refused) as told:
        read_changes(raw)
    assert str(told.value).encode().isascii()


def test_values_that_fit_no_scene_are_told_at_their_path(base):
    with pytest.raises(SceneError, match=r"operation.discharge\.pressure|operation\.suction\.pressure"):
        scene_of(base, overrides(base, {"operation.discharge.pressure": "1 bar"}, {}))


def test_a_moved_value_keeps_its_tolerance_and_its_group():
    gap, other = "effects.tip_leakage.gap", "effects.interlobe_leakage.gap"
    both = [f"{gap}=27 um ± 5 um", f"{other}=29 um ± 10 %", f"uncertainty.correlated=[[{gap}, {other}]]"]
    base = open_base(PAPER, both)
    found = scene_of(base, overrides(base, {gap: "40 um", other: "40 um"}, {}))
    assert found.correlated == ((gap, other),)
    assert [found.uncertain[path].size for path in (gap, other)] == pytest.approx([5e-6, 4e-6])
