"""What holds the house together: shipped scenes load, one version, names of results written once."""

import ast
import importlib.util
import re
import sys
import tomllib
from pathlib import Path

import pytest
from each_row import each_row

import screwsim
from screwsim import outputs
from screwsim.version import version_of

ROOT = Path(__file__).parents[2]
NO_SCENES = (".fit.yaml", ".stages.yaml")
CONFIGS = sorted(path for path in (ROOT / "configs").glob("**/*.yaml") if not path.name.endswith(NO_SCENES))

COMPARISONS = sorted((ROOT / "validation").glob("*/*.py"))
MODULES = sorted((ROOT / "src").rglob("*.py"))
LONGEST = 380  # lines
PROGRAMS = sorted(path for folder in ("scripts", "benchmarks", "docs/tools") for path in (ROOT / folder).glob("*.py"))


@each_row("path", COMPARISONS, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_what_a_comparison_asks_of_the_package_is_there(path):
    """Some of them take minutes, and no test runs them."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("screwsim"):
            exec(ast.unparse(node), {})


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.name)
def test_what_a_program_asks_of_the_package_is_there(path, monkeypatch):
    monkeypatch.syspath_prepend(str(path.parent))
    spec = importlib.util.spec_from_file_location(f"program_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)
    spec.loader.exec_module(module)
    assert module.__doc__


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: str(path.relative_to(ROOT)))
def test_shipped_scene_loads(path):
    scene = screwsim.load(path)
    again = screwsim.loads(scene.text, folder=scene.folder)
    assert again.text == scene.text


def test_files_of_tests_that_are_to_come_first_are_there():
    text = (ROOT / "tests" / "conftest.py").read_text()
    names = re.findall(r'^    "([\w/]+\.py)",$', text, flags=re.MULTILINE)
    assert len(names) > 10
    assert [name for name in names if not (ROOT / name).exists()] == []


def test_no_module_beside_tests_is_called_as_a_script_is():
    """Both are imported by their bare name, and the first one imported would be taken for the other."""
    scripts = {path.stem for folder in ("scripts", "docs/tools") for path in (ROOT / folder).glob("*.py")}
    beside = {path.stem for path in (ROOT / "tests").glob("*/*.py")}
    assert len(scripts) > 10 and len(beside) > 100
    assert scripts & beside == set()


def test_version_has_one_source():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert project["project"]["dynamic"] == ["version"]
    assert project["tool"]["hatch"]["version"]["path"] == "src/screwsim/version.py"
    assert screwsim.__version__ == version_of(ROOT)
    heading = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(), flags=re.MULTILINE)
    assert heading and f"\nversion: {heading[1]}\n" in (ROOT / "CITATION.cff").read_text()


def test_every_dependency_is_pinned():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = project["dependencies"] + [name for extra in project["optional-dependencies"].values() for name in extra]
    names = {re.split(r"[\[<>=~ ]", item)[0].lower() for item in wanted} - {"screwsim"}
    lines = [line for line in (ROOT / "constraints.txt").read_text().splitlines() if not line.startswith("#")]
    assert all(re.fullmatch(r"[A-Za-z0-9_.-]+==[A-Za-z0-9_.+-]+", line) for line in lines)
    assert names <= {line.partition("==")[0].lower() for line in lines}


def test_every_result_has_unit_and_meaning():
    for table in (
        outputs.PERFORMANCE,
        outputs.BALANCE,
        outputs.NUMERICS,
        outputs.CYCLE,
        outputs.LEDGER,
        outputs.LEDGER_ENTRY,
        outputs.STAGES,
        outputs.KNOCK_OUT,
    ):
        assert all(about.units and about.long_name for about in table.values())


def test_no_module_must_be_scrolled_for_long():
    sizes = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8").count("\n") for path in MODULES}
    assert {name: size for name, size in sizes.items() if size > LONGEST} == {}
