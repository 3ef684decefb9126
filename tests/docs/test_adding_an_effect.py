"""The page on adding an effect is true: its code runs as it stands, in the scene that it names."""

import importlib.util
import re
import sys
from pathlib import Path

import pytest
from scenes import balanced

from screwsim import scene as scenes
from screwsim.build import build_parts
from screwsim.explain import explain
from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import SceneError
from screwsim.model.compose import compose
from screwsim.simulate import simulate

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "adding-an-effect.md").read_text(encoding="utf-8")
NAME = "my_effects.suction_leak"
POINT = Path(__file__).parents[2] / "configs" / "paper" / "point.yaml"
MACHINE = """\
machine:
  rotor_diameter: 160 mm
  rotor_length: 176 mm
  volume: {law: paper, max: 600 cm^3, phi_A: 60 deg}
  suction_port: {law: paper, area: 40 cm^2, phi_B: 60 deg}
  discharge_port: {law: paper, area: 12 cm^2, opens: 600 deg, phi_C: 640 deg}
gas: {fluid: R134a, model: ideal}
operation:
  speed: 3000 rpm
  suction: {pressure: 2 bar, temperature: 283 K}
  discharge: {pressure: 8 bar}
"""


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Lay out what the page shows: the effect, a scene that names it, its test."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "my_effects").mkdir()
    effect, vessel, heat, slit, test = blocks("python")
    yaml, heated = blocks("yaml")
    (folder / "my_effects" / "suction_leak.py").write_text(effect, encoding="utf-8")
    (folder / "my_effects" / "vessel.py").write_text(vessel, encoding="utf-8")
    (folder / "my_effects" / "wet_slit.py").write_text(slit, encoding="utf-8")
    (folder / "my_effects" / "droplet_heat.py").write_text(heat, encoding="utf-8")
    (folder / "heated.yaml").write_text(f"base: {POINT}\n{heated}", encoding="utf-8")
    scene = f"{MACHINE}{yaml.rstrip()}\n  suction_port:\n  discharge_port:\n"
    (folder / "scene.yaml").write_text(scene, encoding="utf-8")
    (folder / "page_test.py").write_text(test, encoding="utf-8")
    sys.path.insert(0, str(folder))
    yield folder
    sys.path.remove(str(folder))
    for name in [name for name in sys.modules if name.partition(".")[0] == "my_effects"]:
        del sys.modules[name]


@pytest.fixture(scope="module")
def page_test(folder):
    spec = importlib.util.spec_from_file_location("page_test", folder / "page_test.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_test_of_the_page_passes(page_test):
    tests = [value for name, value in vars(page_test).items() if name.startswith("test_")]
    assert len(tests) == 3
    for test in tests:
        test()


def test_result_names_the_effect(page_test):
    assert NAME in page_test.WITH.effects
    assert NAME not in page_test.WITHOUT.effects
    assert f"mass_flow_{NAME}" in page_test.WITH.cycle
    assert f"mass_flow_{NAME}" not in page_test.WITHOUT.cycle


def test_the_ledger_has_its_entry_and_closes(page_test):
    ledger = page_test.WITH.ledger
    assert ledger[f"gas_moved_{NAME}"] > 0.0
    assert ledger[f"exergy_destroyed_{NAME}"] > 0.0
    assert abs(ledger.relative_residue) < 1e-3  # as the shipped scenes
    assert f"exergy_destroyed_{NAME}" not in page_test.WITHOUT.ledger


def test_explanation_names_the_effect(folder):
    text = str(explain(scenes.load(folder / "scene.yaml")))
    assert NAME in text
    assert "hole in the housing, to the suction line" in text
    assert "passage 120 deg" in text


def test_scene_without_the_effect_has_no_kernel_of_it(folder):
    texts = [
        compose(build_parts(scenes.load(folder / "scene.yaml", without=without))).text for without in ((), (NAME,))
    ]
    assert "suction_leak__area" in texts[0]
    assert "suction_leak" not in texts[1]


def test_a_vessel_of_ones_own_gives_gas_and_the_balances_close(folder):
    name = "my_effects.vessel"
    own = {"opens": "400 deg", "closes": "500 deg", "area": "1 cm^2", "temperature": "300 K"}
    sets = [f"effects.{name}={own}", f"effects.{NAME}=off"]
    scene = scenes.load(folder / "scene.yaml", sets)
    result = balanced(simulate(scene))
    assert result.performance.vessel_mass_flow > 0.0
    assert result.ledger[f"gas_moved_{name}"] >= result.performance.vessel_mass_flow
    assert "my vessel plenum (5 bar, 26.85 °C" in " ".join(str(explain(scene)).split())


def test_a_law_of_heat_of_ones_own_is_that_of_droplets_where_its_numbers_are(folder):
    name, prandtl = "my_effects.droplet_heat", 0.8
    factor = f"effects.{name}.factor={0.6 * prandtl ** (1.0 / 3.0)!r}"
    own = simulate(scenes.load(folder / "heated.yaml", [factor]))
    droplets = {"diameter": "40 um", "slip": 0.1, "gas_conductivity": "0.012 W/(m K)", "gas_viscosity": "11 uPa s"}
    sets = [f"effects.droplets={droplets | {'size': 'fixed', 'prandtl': prandtl}}", "effects.oil_heat=off"]
    ours = simulate(scenes.load(POINT, sets))
    assert own.status == ours.status == "ok"
    for figure in ("shaft_power", "gas_mass_flow", "oil_discharge_temperature"):
        assert own.performance[figure] == pytest.approx(ours.performance[figure], rel=1e-9), figure  # rounding
    assert own.ledger[f"energy_moved_{name}"] == pytest.approx(ours.ledger.energy_moved_droplets, rel=1e-9)


def test_a_law_of_heat_of_ones_own_does_not_count_the_same_heat_twice(folder):
    with pytest.raises(SceneError, match=r"droplet_heat: is the heat of effects\.oil_heat, too"):
        scenes.load(
            folder / "heated.yaml", ["effects.oil_heat={droplet_radius: 9 um, heat_transfer_coefficient: 1 W/(m^2 K)}"]
        )


def test_the_page_lists_every_kind_of_quantity():
    listed = re.search(r"The kinds of `quantity` are(.*?)\.\n", PAGE, re.S)[1]
    words = re.sub(r"\([^)]*\)", "", listed).replace(" and ", ", ")
    assert [word.strip() for word in words.split(",")] == list(KINDS)


def test_oil_passes_a_slit_of_ones_own_beside_the_gas(folder):
    name = "my_effects.wet_slit"
    sets = [
        "oil={density: 950 kg/m^3, heat_capacity: 2 kJ/(kg K), transport: carried}",
        "oil_supply={kind: pump, temperature: 300 K, ratio: 5}",
        "effects.oil_heat={droplet_radius: 50 um, heat_transfer_coefficient: 500 W/(m^2 K)}",
        f"effects={{{name}: {{height: 80 um, width: 0.1 m, length: 20 mm}}}}",
    ]
    result = balanced(simulate(scenes.load(folder / "scene.yaml", sets)), "oil_mass")
    assert result.cycle[f"oil_flow_{name}_trailing"].min() < 0.0 and result.cycle[f"oil_flow_{name}"].min() < 0.0
    assert result.ledger[f"entropy_generated_{name}"] > 0.0


def test_schema_allows_it_by_its_dotted_name():
    effects = scenes.schema()["properties"]["effects"]
    assert NAME not in effects["properties"]
    assert any(re.search(pattern, NAME) for pattern in effects["patternProperties"])
