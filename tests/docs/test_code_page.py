"""The page of the code names each package, from the top down as imports go, and files that exist."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "explanation" / "code.md").read_text(encoding="utf-8")


def test_packages_stand_in_the_order_of_imports():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    layers = next(each["layers"] for each in contracts if each["id"] == "layers")
    level = {name.strip(): i for i, layer in enumerate(layers) for name in layer.split("|")}
    named = re.findall(r"`(\w+)`", " ".join(re.findall(r"^\| (`.+?) \|", PAGE, re.M)))
    assert sorted(named) == sorted(level)
    assert [level[name] for name in named] == sorted(level.values())


def test_files_that_it_names_exist():
    named = re.findall(r"`([a-z_]+(?:/[a-z_]+)*\.py)`", PAGE)
    assert len(named) > 12
    assert [name for name in named if not (ROOT / "src" / "screwsim" / name).is_file()] == []
