"""What the pages state as names and numbers is what the code has."""

import dataclasses
import importlib
import re
from pathlib import Path

import pytest
from each_row import each_row

import screwsim
from screwsim.build import regularisation
from screwsim.cycle.balances import LEAST_WORK
from screwsim.cycle.cycle_figures import CycleFigures
from screwsim.cycle.solution import closing_criteria
from screwsim.machine.geometry import Geometry
from screwsim.machine.kinds import kind_of
from screwsim.model.numbers import symbols_of
from screwsim.model.parts import OilPart, Parts
from screwsim.model.writing import HEAT_SYMBOLS, OPENING_SYMBOLS, PUSH_SYMBOLS, STATE_SYMBOLS
from screwsim.scene import loads

DOCS = Path(__file__).parents[2] / "docs"
PAGES = (DOCS / "explanation" / "errors.md", DOCS / "reference" / "constants.md")
NUMERICS = "".join(page.read_text(encoding="utf-8") for page in PAGES)
NOMENCLATURE = (DOCS / "reference" / "nomenclature.md").read_text(encoding="utf-8")
CONSTANTS = re.findall(r"^\| `([\w.]+)\.([A-Z_]+)` \| ([\d.e-]+) \|", NUMERICS, flags=re.MULTILINE)
NAMED = re.findall(r"^\| `([\w.]+)\.([A-Z_]+`(?:, `[A-Z_]+`)*) \|", NUMERICS, flags=re.MULTILINE)
SCENE = """\
machine: {rotor_diameter: 160 mm, rotor_length: 176 mm, volume: {max: 600 cm^3, phi_A: 60 deg}}
gas: {fluid: R134a}
operation:
  speed: 3000 rpm
  suction: {pressure: 2 bar, temperature: 283 K}
  discharge: {pressure: 8 bar}
numerics: {accuracy: 1e-3}
"""


@each_row(("module", "name", "value"), CONSTANTS)
def test_constant_is_that_of_the_code(module, name, value):
    assert float(value) == getattr(importlib.import_module(f"screwsim.{module}"), name)


def test_the_page_lists_constants():
    assert len(CONSTANTS) >= 5


@each_row(("module", "names"), NAMED)
def test_constants_of_the_page_are_in_the_code_whatever_their_units(module, names):
    assert set(re.findall(r"[A-Z][A-Z_]+", names)) <= vars(importlib.import_module(f"screwsim.{module}")).keys()


def test_tolerances_follow_from_the_accuracy_as_stated():
    scene = loads(SCENE)
    wanted = closing_criteria(scene.numerics, regularisation(scene))
    assert "| 0.3 · accuracy, or `numerics.rtol` |" in NUMERICS
    assert wanted.rtol == pytest.approx(0.3e-3)
    assert "openings to the suction line | `WIDTH` · accuracy · p_s |" in NUMERICS
    assert "openings to the discharge line | `WIDTH` · accuracy · p_d |" in NUMERICS
    assert "gaps | `WIDTH` · accuracy · (p₁ + p₂)/2, the pressures at their ends |" in NUMERICS
    assert regularisation(scene) == pytest.approx((0.25e-3 * 2e5, 0.25e-3 * 8e5, 0.25e-3))
    assert "| 0.2 · accuracy |" in NUMERICS
    assert wanted.tolerance == pytest.approx(0.2e-3)
    assert wanted.bound == 1e-3


def test_the_floor_of_the_energy_scale_is_that_of_the_model_page():
    assert r"10^{-6}\,m_{360}\,p_s/\rho_s" in (DOCS / "model.md").read_text(encoding="utf-8")
    assert LEAST_WORK == 1e-6


def test_every_symbol_of_a_kernel_is_listed():
    oil = OilPart(1000.0, 2000.0, 300.0, True, {"ratio": 1.0})
    parts = Parts(Geometry(loads(SCENE).machine), None, omega=300.0, widths=(1.0, 1.0, 1.0), effects={}, oil=oil)
    table = NOMENCLATURE.partition("## Names that a kernel may ask for")[2]
    for name in (*HEAT_SYMBOLS, *symbols_of(parts), "TAB"):
        assert f"`{name}`" in table, name


def test_every_symbol_of_a_cylinder_is_listed():
    machine = "machine: {kind: slider_crank, bore: 5 cm, crank_radius: 2 cm, rod_length: 9 cm, clearance: 3 cm^3}\n"
    cylinder = loads(machine + SCENE.partition("\n")[2]).machine
    geometry = kind_of(cylinder).geometry(cylinder)
    parts = Parts(geometry, None, omega=300.0, widths=(1.0, 1.0, 1.0), effects={}, oil=None)
    table = NOMENCLATURE.partition("## Names that a kernel may ask for")[2]
    for name in (*symbols_of(parts), *STATE_SYMBOLS, *OPENING_SYMBOLS, *PUSH_SYMBOLS):
        assert f"`{name}`" in table, name


def test_every_figure_that_a_power_loss_gets_is_listed():
    table = NOMENCLATURE.partition("A power loss is no kernel")[2]
    of_found = {name for name, each in vars(CycleFigures).items() if isinstance(each, property)}
    for name in {field.name for field in dataclasses.fields(CycleFigures)} | of_found:
        assert f"`{name}`" in table, name


METHOD = tuple(DOCS / "explanation" / f"{name}.md" for name in ("errors", "integrator", "closing"))
SOURCE = "\n".join(path.read_text(encoding="utf-8") for path in sorted(Path(screwsim.__file__).parent.rglob("*.py")))
ASSIGNED = {
    name
    for names in re.findall(r"^((?:[A-Z][A-Z_]+, )*[A-Z][A-Z_]+)(?:: [^=\n]+)? = ", SOURCE, flags=re.MULTILINE)
    for name in names.split(", ")
}
OF_A_USER = "INTEGRATOR"  # which a module of one's own assigns


@pytest.mark.parametrize("page", METHOD, ids=lambda page: page.stem)
def test_constants_that_a_page_of_the_method_names_are_there(page):
    text = page.read_text(encoding="utf-8")
    placed = re.findall(r"`([a-z_.]+)\.([A-Z][A-Z_]+)`", text)
    assert placed
    for module, name in placed:
        assert hasattr(importlib.import_module(f"screwsim.{module}"), name), f"{module}.{name}"
    bare = {*re.findall(r"`([A-Z][A-Z_]+)`", text)}
    assert bare
    assert bare - ASSIGNED - {OF_A_USER} == set()
