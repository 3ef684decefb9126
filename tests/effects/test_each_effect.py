"""Every effect alone on the paper's machine: it closes, is explained and accounted for, and vanishes in its limit."""

import pickle
import re
import shutil
import subprocess
import sys
from functools import cache

import pytest
from each_row import each_row
from folders import ROOT
from scenes import balanced

from screwsim.build import build_parts
from screwsim.effects import catalogue
from screwsim.effects.base import Reading
from screwsim.explain import explain
from screwsim.figures import called_for
from screwsim.machine.kinds import MACHINES
from screwsim.simulate import simulate
from screwsim.study.validation import sibling

each = sibling(ROOT / "docs" / "tools" / "each_effect.py")
LIMITS = [name for name, row in each.ROWS.items() if not row.whole]
PAGE = (ROOT / "docs" / "reference" / "effects.md").read_text(encoding="utf-8")


@cache
def found(name):
    return simulate(each.with_it(name))


def test_every_effect_of_a_screw_has_a_row():
    of_screws = {name for name, effect in catalogue().items() if effect.fits(MACHINES["twin_screw"])}
    # valves, rings and the cylinder's walls are those of a piston machine
    assert of_screws == {each.effect_of(name) for name in each.ROWS}


@each_row("name", catalogue())
def test_an_effect_that_went_to_another_process_and_back_equals_the_one_that_was_sent(name):
    effect = catalogue()[name]
    assert pickle.loads(pickle.dumps(effect)) == effect


def test_the_page_has_every_row_as_the_script_has_it():
    lines = {cells[1].strip(): cells for line in PAGE.splitlines() if len(cells := line.split("|")) == 10}
    for name, row in each.ROWS.items():
        assert [cell.strip() for cell in lines[name][2:5]] == [row.scene, row.says, row.source], name


@pytest.mark.slow
@pytest.mark.parametrize("name", each.ROWS)
def test_mass_energy_and_entropy_close_with_the_effect_alone(name):
    result = balanced(found(name))
    assert abs(result.ledger.relative_residue) < 1e-3


@pytest.mark.slow
@each_row("name", each.ROWS)
def test_it_stands_in_explain_and_in_the_ledger(name):
    scene, effect = each.with_it(name), each.effect_of(name)
    text = " ".join(str(explain(scene)).split())
    assert catalogue()[effect].title in text
    assert ", ".join(catalogue()[effect].equations) in text
    parts = build_parts(scene).effects[effect]
    reads = bool(parts) and all(isinstance(part, Reading) for part in parts)  # acts on nothing
    assert (f"exergy_destroyed_{effect}" in found(name).ledger) != reads


@pytest.mark.slow
@each_row("name", each.ROWS)
def test_it_gives_what_it_is_called_for_or_says_why_not(name):
    scene, result = each.with_it(name), found(name)
    assert list(result.performance) == list(result.error) == list(called_for(scene, build_parts(scene)))
    assert {figure for figure, value in result.performance.items() if value is None} == set(result.notes)
    given = [figure.name for figure in catalogue()[each.effect_of(name)].figures if figure.name in result.performance]
    assert set(each.ROWS[name].own) <= set(result.performance)
    assert all(result.performance[figure] is not None for figure in given)


@pytest.mark.slow
@pytest.mark.parametrize("name", LIMITS)
def test_it_vanishes_in_its_limit(name):
    """Within the wanted accuracy; efficiencies of the flow of a machine that delivers next to nothing are not asked."""
    row = each.ROWS[name]
    limit, none = simulate(each.with_it(name, row.limit)), simulate(each.without_it(name, row.limit))
    assert limit.status == none.status == "ok", (limit.message, none.message)
    for figure in each.SEEN:
        assert limit.performance[figure] == pytest.approx(none.performance[figure], rel=3e-4), figure
    for figure in row.zero:
        assert abs(limit.performance[figure]) < 3e-4, figure


WITHOUT_FILES = """
import json, sys
from screwsim.effects import catalogue
from screwsim.scene import load
from screwsim.simulate import simulate
result = simulate(load(sys.argv[1]))
print(json.dumps([len(catalogue()), result.performance, result.numerics.rhs_evaluations, result.balance]))
"""


def _used(package):
    """Return the modules of effects that the program itself imports by name, and what those import, with the base."""
    kept, open_names = set(), {"base", "gap", "port_window", "valves", "gap_flow", "gas_transport", "line_valve"}
    for path in package.rglob("*.py"):
        if path.parent.name != "effects":
            text = path.read_text(encoding="utf-8")
            open_names |= set(re.findall(r"screwsim\.effects\.(\w+)", text))
            open_names |= {
                name
                for many in re.findall(r"from screwsim\.effects import (.+)", text)
                for name in re.findall(r"\w+", many)
                if (package / "effects" / f"{name}.py").exists()
            }
    while open_names:
        name = open_names.pop()
        file = package / "effects" / f"{name}.py"
        if name in kept or not file.exists():
            continue
        kept.add(name)
        text = file.read_text(encoding="utf-8")
        open_names |= set(re.findall(r"screwsim\.effects\.(\w+)", text))
        open_names |= {
            word
            for many in re.findall(r"from screwsim\.effects import (.+)", text)
            for word in re.findall(r"\w+", many)
        }
    return kept


@pytest.mark.parametrize("config", ["configs/paper/point.yaml", "tests/plain/r134a.yaml"])
def test_a_scene_gives_the_same_bits_where_the_files_of_other_effects_are_not_there(config, tmp_path):
    """As before those effects were written: the same figures bit for bit, at the same number of evaluations."""
    import json

    from screwsim.scene import load

    package = tmp_path / "screwsim"
    shutil.copytree(ROOT / "src" / "screwsim", package, ignore=shutil.ignore_patterns("__pycache__"))
    path = ROOT / config
    scene = load(path)
    keep = _used(package) | set(scene.effects) | {"__init__"}
    gone = [file for file in (package / "effects").glob("*.py") if file.stem not in keep]
    for file in gone:
        file.unlink()
    assert {"economizer", "oil_volume", "wall_heat", "droplets", "oil_injection"} <= {file.stem for file in gone}
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT_FILES, str(path)],
        capture_output=True,
        text=True,
        env={**__import__("os").environ, "PYTHONPATH": str(tmp_path)},
    )
    assert run.returncode == 0, run.stderr[-800:]
    count, figures, evaluations, balance = json.loads(run.stdout)
    ours = simulate(scene)
    assert count < len(catalogue()) - 5
    assert figures == dict(ours.performance)
    assert evaluations == ours.numerics.rhs_evaluations
    assert balance == dict(ours.balance)
