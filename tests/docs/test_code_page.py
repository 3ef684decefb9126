"""The page of the code names each package, from the top down as imports go, and files that exist."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "explanation" / "code.md").read_text(encoding="utf-8")


def level_by_name(contract: str) -> dict[str, int]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    layers = next(each["layers"] for each in contracts if each["id"] == contract)
    return {name.strip(): i for i, layer in enumerate(layers) for name in layer.split("|")}


def names_in_table(head: str) -> list[str]:
    table = PAGE.split(f"\n| {head} | purpose |\n")[1].split("\n\n")[0]
    return re.findall(r"`(\w+)`", " ".join(re.findall(r"^\| (`.+?) \|", table, re.M)))


def test_packages_stand_in_the_order_of_imports():
    level, named = level_by_name("layers"), names_in_table("package")
    assert sorted(named) == sorted(level)
    assert [level[name] for name in named] == sorted(level.values())


def test_packages_of_studies_stand_in_the_order_of_imports():
    study = ROOT / "src" / "screwsim" / "study"
    level = {name: i for name, i in level_by_name("study-layers").items() if (study / name).is_dir()}
    named = names_in_table("package of `study`")
    assert sorted(named) == sorted(level)
    assert [level[name] for name in named] == sorted(level.values())


def test_files_that_it_names_exist():
    named = re.findall(r"`([a-z_]+(?:/[a-z_]+)*\.py)`", PAGE)
    assert len(named) > 12
    assert [name for name in named if not (ROOT / "src" / "screwsim" / name).is_file()] == []
