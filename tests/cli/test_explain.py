"""`explain` tells what is simulated and what is not."""

import re
from pathlib import Path

import screwsim
import screwsim.explain
from screwsim.effects import catalogue
from screwsim.explain import explain
from screwsim.machine.kinds import MACHINES

CONFIGS = Path(__file__).parents[2] / "configs"


def test_active_and_left_out_are_the_effects_that_the_machine_can_have(folder):
    found = explain(screwsim.load("small.yaml"))
    of_screws = {name for name, effect in catalogue().items() if effect.fits(MACHINES["twin_screw"])}
    assert set(found.active) | set(found.left_out) == of_screws
    assert not set(found.active) & set(found.left_out)
    assert "oil_heat" in found.left_out


def test_effects_are_counted_of_the_kind_and_in_all(folder):
    every = catalogue().values()
    screws, cylinders = (sum(effect.fits(kind) for effect in every) for kind in MACHINES.values())
    text = str(explain(screwsim.load("small.yaml")))
    assert f"Active effects (3 of the {screws} of a twin_screw; {len(every)} in all)" in text
    cylinder = screwsim.load(CONFIGS / "slider_crank" / "air.yaml")
    active = len(cylinder.effects)
    assert f"Active effects ({active} of the {cylinders} of a slider_crank; {len(every)} in all)" in str(
        explain(cylinder)
    )


def test_effects_of_your_own_are_counted_apart(folder, monkeypatch):
    monkeypatch.syspath_prepend(str(CONFIGS.parent / "tests" / "laws"))
    own = screwsim.load("oiled.yaml", ["oil.transport=carried", "effects={own_effects.warm_wall: {conductance: 5}}"])
    assert "in all; 1 of your own)" in str(explain(own))


def test_the_readme_counts_the_effects_as_explain_does():
    every = catalogue().values()
    screws = sum(effect.fits(MACHINES["twin_screw"]) for effect in every)
    readme = " ".join((CONFIGS.parent / "README.md").read_text(encoding="utf-8").split())
    assert f"({len(every)} in all, {screws} of them of twin screws)" in readme


def test_every_active_effect_shows_title_equations_and_source(folder):
    scene = screwsim.load("oiled.yaml")
    words = " ".join(str(explain(scene)).split())
    for active in scene.effects.values():
        for text in (active.effect.title, ", ".join(active.effect.equations), active.effect.source):
            assert text in words


def test_states_follow_the_effects(folder, command):
    assert explain(screwsim.load("small.yaml")).states == ("T", "rho")
    assert explain(screwsim.load("oiled.yaml")).states == ("T", "rho", "T_oil")
    carried = screwsim.load("oiled.yaml", ["oil.transport=carried"])
    assert explain(carried).states == ("T", "rho", "T_oil", "x_oil")
    answer = command("explain", "oiled.yaml", "--without", "oil_heat")
    assert answer.code == 0
    assert "oil_heat" in answer.out.partition("Left out")[2]


def test_parameters_come_in_customary_units_with_defaults_marked(folder):
    text = str(explain(screwsim.load("small.yaml")))
    assert "flow_coefficient 0.7 (default), gap 0.05 mm" in text


def test_text_fits_a_terminal(folder):
    for name in ("small.yaml", "swept.yaml", "oiled.yaml"):
        assert max(map(len, str(explain(screwsim.load(name))).splitlines())) <= 80


def test_sweep_is_counted(folder):
    assert "Sweep (2 cases)" in str(explain(screwsim.load("swept.yaml")))


def test_a_design_is_told_with_its_paths(folder):
    over = "{operation.speed: {from: 1000 rpm, to: 2000 rpm}, operation.suction.temperature: [280 K, 290 K]}"
    sample = f"sweep.sample={{kind: sobol, count: 8, seed: 3, over: {over}}}"
    text = str(explain(screwsim.load("small.yaml", overrides=[sample])))
    told = [line.strip() for line in text.partition("Sweep (8 cases)")[2].splitlines() if line.strip()]
    assert told == ["sample: 8 values (sobol, seed 3) of", "operation.speed", "operation.suction.temperature"]


def test_the_code_is_the_text_that_is_compiled_and_names_its_equations(command, folder):
    """What an effect states is there with its equation where the scene names the effect, and not elsewhere."""
    scene = screwsim.load("small.yaml")
    answer = command("explain", "small.yaml", "--code")
    assert answer.out.rstrip("\n") == screwsim.explain.code(scene).rstrip("\n")
    names: dict[str, object] = {}
    exec(answer.out, names)  # it runs as it is printed
    assert callable(names["rodas__integrate_one"])
    with_oil = command("explain", "oiled.yaml", "--code").out
    assert {"M12", "M15"} <= set(re.findall(r"M\d+", answer.out))
    assert "def oil_heat__" in with_oil and "def oil_heat__" not in answer.out
