"""Each field of the page shows the scene's value, in a unit that reads back to it, on a slider that holds it."""

import json

import pytest
from folders import CONFIGS

from screwsim.explore.changes import Changes, SceneArguments, open_base, overrides_of, scene_of
from screwsim.explore.controls import document
from screwsim.explore.machine import document as drawn
from screwsim.scene import value_at

pytestmark = pytest.mark.around
SCENES = (
    "paper/point.yaml",
    "everything.yaml",
    "rotors/c.yaml",
    "slider_crank/air.yaml",
    "expander/point.yaml",
    "air/variable_speed_7.yaml",
    "co2/transcritical.yaml",
)


@pytest.fixture(scope="module", params=SCENES)
def base(request) -> SceneArguments:
    return open_base(str(CONFIGS / request.param))


def controls_of(base):
    found = document(base)
    every = [*found["groups"], *found["effects"]]
    return found, [control for group in every for control in group["controls"]]


def as_sent(control):
    return (
        control["value"]
        if control["kind"] == "choice" or not control["unit"]
        else f"{control['value']} {control['unit']}"
    )


def test_what_is_shown_reads_back_to_the_scene(base):
    """To the last digits of the float: an address that names a value as the scene has it changes nothing."""
    _, controls = controls_of(base)
    given = [c for c in controls if c["value"] is not None and value_at_or_none(base.scene, c["path"]) is not None]
    assert len(given) > 10
    values = {c["path"]: int(as_sent(c)) if c["kind"] == "count" else as_sent(c) for c in given}
    scene = scene_of(base, overrides_of(base, Changes(values, {})))
    for control in given:
        here, there = (value_at(each, control["path"]) for each in (base.scene, scene))
        assert here == there if isinstance(here, str) else there == pytest.approx(here, rel=1e-11)


def value_at_or_none(scene, path):
    effect = path.split(".")[1] if path.startswith("effects.") else None
    return None if effect is not None and effect not in scene.effects else value_at(scene, path)


def test_a_slider_holds_its_value_and_ends_inside_the_limits(base):
    for control in controls_of(base)[1]:
        if control["kind"] == "choice":
            continue
        assert control["low"] < control["high"], control
        if control["value"] is not None:
            assert control["low"] <= control["value"] <= control["high"], control
        assert not control["log"] or control["low"] > 0.0, control
        ends = {}
        for end in ("low", "high"):
            value = round(control[end]) if control["kind"] == "count" else control[end]
            ends[control["path"]] = f"{value} {control['unit']}" if control["unit"] else value
            on = {control["path"].split(".")[1]: True} if control["path"].startswith("effects.") else {}
            overrides_of(base, Changes(ends, on))  # raises where an end is beyond what the field can be


def test_presets_are_scenes(base):
    for preset in document(base)["presets"]:
        scene_of(base, overrides_of(base, Changes(preset["set"], preset["effects"])))


def test_everything_is_json_of_a_bounded_size(base):
    text = json.dumps({**document(base), "machine": drawn(base.scene.machine)}, allow_nan=False)
    assert len(text) < 400_000


def test_the_effects_are_those_that_the_machine_can_have(base):
    found = {effect["name"]: effect["on"] for effect in document(base)["effects"]}
    assert {name for name, on in found.items() if on} == set(base.scene.effects)
    assert ("cylinder_heat" in found) == (base.scene.machine.kind == "slider_crank")


def test_a_value_with_a_tolerance_shows_it_in_its_own_unit():
    sure = open_base(
        str(CONFIGS / "paper" / "point.yaml"),
        ["effects.tip_leakage.gap=27.5 um ± 5 um", "effects.oil_heat.droplet_radius=9.5 um ×/÷ 2"],
    )
    _, controls = controls_of(sure)
    told = {each["path"]: each["tolerance"] for each in controls if "tolerance" in each}
    assert told == {"effects.tip_leakage.gap": "± 5", "effects.oil_heat.droplet_radius": "×/÷ 2"}


def test_what_is_found_with_the_cycle_is_shown_as_left_open():
    """As the search begins at 0 K, the page showed -273.15 degC, on a slider that began there."""
    port = "{temperature: auto, area: 100 mm^2, opens: 455 deg, closes: 545 deg}"
    base = open_base(str(CONFIGS / "r134a" / "point.yaml"), [f"effects.economizer={port}"])
    assert value_at(base.scene, "effects.economizer.temperature") == 0.0
    control = next(c for c in controls_of(base)[1] if c["path"] == "effects.economizer.temperature")
    assert control["value"] is None and not control["needed"]
    assert -60.0 < control["low"] < control["high"] < 100.0
