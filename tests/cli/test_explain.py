"""`explain` tells what is simulated and what is not."""

import re

import pytest
from folders import CONFIGS

import screwsim
import screwsim.explain
from screwsim.effects import catalogue
from screwsim.explain import explain
from screwsim.machine.kinds import MACHINES
from screwsim.scene.fields import leaf_paths


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


def test_oil_of_an_expander_is_not_injected_and_drives_it():
    text = str(explain(screwsim.load(CONFIGS / "expander" / "oil.yaml")))
    assert "the indicated work contains its flow work (M491)" in " ".join(text.split())
    assert "\n  injection" not in text and "discharge pressure" not in text


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


def test_the_code_of_an_equation_is_that_of_the_functions_that_state_it(command, folder):
    whole = command("explain", "oiled.yaml", "--code").out
    part = command("explain", "oiled.yaml", "--code", "M3", "nozzle__flow").out
    functions = re.findall(r"^def (\w+)", part, re.M)
    assert {"oil_heat__heat", "nozzle__flow"} <= set(functions) < set(re.findall(r"^def (\w+)", whole, re.M))
    assert len(functions) == len(set(functions)) and all(block in whole for block in part.strip().split("\n\ndef "))
    assert command("explain", "oiled.yaml", "--code", "flow").out.count("def nozzle__flow(") == 1
    for name, told in {
        "M999": "M999: no function of this scene's code names it (use one of M1, ",
        "oil_heat": "oil_heat: is neither an equation nor a function of this scene's code (write oil_heat__heat)",
        "nozle_flow": "nozle_flow: is neither an equation nor a function of this scene's code",
    }.items():
        answer = command("explain", "oiled.yaml", "--code", name)
        assert answer.code == 2 and answer.err.startswith(told) and answer.err.count("\n") == 1
    assert "write screwsim explain oiled.yaml --code M3)" in command("explain", "oiled.yaml", "M3").err


def test_parameters_tell_every_key_also_of_effects_left_out(command, folder):
    scene = screwsim.load("small.yaml")
    words = " ".join(command("explain", "small.yaml", "--parameters").out.split())
    for name, effect in catalogue().items():
        if effect.fits(MACHINES["twin_screw"]):
            state = "simulated" if name in scene.effects else "left out"
            assert f"effects.{name} ({state}): {effect.title}" in words
    parameters = {name: effect.parameters for name, effect in catalogue().items()}
    for path, leaf in leaf_paths(parameters).items():
        fits = not path.startswith("effects.") or catalogue()[path.split(".")[1]].fits(MACHINES["twin_screw"])
        assert " ".join(leaf.doc.split()) in words or not fits or path == "title", path


@pytest.mark.parametrize(
    ("name", "first", "key"),
    [
        (
            "oil_supply.ratio",
            "oil_supply (not in this scene)",
            "ratio d: oil-to-gas mass ratio in the chamber at 360 deg (pump; expander: in the gas",
        ),
        (
            "effects.economizer.area",
            "effects.economizer (left out): vapour",
            "area area of the port; unit: cm^2; default:",
        ),
    ],
)
def test_parameters_of_one_key_are_that_key_alone(name, first, key, command, folder):
    lines = command("explain", "small.yaml", "--parameters", name).out.splitlines()
    assert lines[0].startswith(first)
    assert " ".join(" ".join(lines[1:]).split()).startswith(key)
    assert sum(line[2:3].strip() != "" for line in lines[1:]) == 1


def test_parameters_of_an_effect_are_its_unit_default_range_meaning_and_value(command, folder):
    words = " ".join(command("explain", "small.yaml", "--parameters", "tip_leakage").out.split())
    assert words.startswith("effects.tip_leakage (simulated): gaps between lobe tips and housing, to both neighbours")
    told = "gap clearance; unit: mm; default: required; range: > 0 mm; usual 0.001 mm to 1 mm; usual ≤ 0.1 of the"
    assert f"{told} height of a lobe; here: 0.05 mm" in words
    assert "effects.blow_hole" not in words


def test_a_name_that_is_no_effect_is_told_with_what_is_meant(command, folder):
    asked = {
        (
            "small.yaml",
            "--parameters",
            "tip_lekage",
        ): "--parameters tip_lekage: is not known; did you mean 'tip_leakage'?",
        (
            "small.yaml",
            "--parameters",
            "tip_leakage.gapp",
        ): "--parameters tip_leakage.gapp: is not known; did you mean 'gap'?",
        (
            "small.yaml",
            "--parameters",
            "ring_leakage",
        ): "--parameters ring_leakage: is not an effect of a twin_screw (screwsim explain lists the possible ones)",
        **{
            (
                str(CONFIGS / "expander" / file),
                "--parameters",
                name,
            ): f"--parameters {name}: is not an effect of {whose} (screwsim explain lists the possible ones)"
            for file, name, whose in (
                ("point.yaml", "slide_valve", "an expander"),
                ("oil.yaml", "plenums", "an expander with oil"),
            )
        },
        ("small.yaml", "tip_leakage"): "tip_leakage: only --parameters and --code take a name (write screwsim "
        "explain small.yaml --parameters tip_leakage)",
    }
    for arguments, told in asked.items():
        answer = command("explain", *arguments)
        assert (answer.code, answer.err.strip()) == (2, told)


def test_leaks_that_are_not_simulated_are_told_in_one_line(folder):
    words = " ".join(str(explain(screwsim.load("small.yaml"))).split())
    lacking = "interlobe_leakage, blow_hole, end_face_leakage and shaft_leakage"
    assert f"leaks simulated: tip only; typical scenes name {lacking}, too" in words
    assert "leaks" not in str(explain(screwsim.load(CONFIGS / "r134a" / "point.yaml"))).partition("Left out")[0].split()
    none = " ".join(str(explain(screwsim.load("small.yaml", without=["tip_leakage"]))).split())
    assert "leaks simulated: none; typical scenes name tip_leakage, interlobe_leakage" in none


def test_gauge_pressure_displacement_and_tip_speed_are_told_as_stated(folder):
    changes = ["operation.discharge.pressure=11 bar(g)", "operation.speed=null", "operation.tip_speed=25 m/s"]
    changes += ["machine.volume.max=null", "machine.displacement={flow: 600 m^3/h, at: 2950 rpm}"]
    words = " ".join(str(explain(screwsim.load("small.yaml", changes))).split())
    assert "discharge line 12.0132 bar (11 bar(g) above ambient 1.01325 bar)" in words
    assert "speed 2984.155183 rpm (tips at 25 m/s)" in words
    assert "displacement 600 m³/h at 2950 rpm, from which the chambers' volume follows" in words
    assert "max 847.458 cm³ (follows)" in words


def test_a_blend_that_is_known_as_a_gas_only_says_from_which_temperature_on(folder):
    fluid = (
        "{fluid: [Methane, Ethane, CO2], mole_fractions: [0.93, 0.05, 0.02], model: real, isentropic_exponent: null}"
    )
    lines = "operation.suction={pressure: 1 bar, temperature: 30 degC}", "operation.discharge={pressure: 8 bar}"
    text = str(explain(screwsim.load("small.yaml", overrides=[f"gas={fluid}", *lines])))
    assert "known as a gas only, from -56.558 °C on (M317)" in " ".join(text.split())
