"""The page of the code names each package, from the top down as imports go, and files that exist."""

import re
import tomllib

from folders import ROOT

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


def text_of(path: str) -> str:
    return (ROOT / "src" / "screwsim" / path).read_text(encoding="utf-8")


def test_functions_that_a_point_passes_exist_and_call_each_other():
    """Each line of the diagram names a function that the text of the one above it, by indentation, names."""
    chain: list[tuple[int, str, str]] = []  # indentation, text of its module, name
    followed = re.findall(
        r"^( *)([a-z_]+(?:\.\w+)+)", PAGE.split("```text\nsimulate.simulate")[1].split("```")[0], re.M
    )
    for blanks, dotted in [("", "simulate.simulate"), *followed]:
        parts = dotted.split(".")
        last = len(parts) - (2 if parts[-2][0].isupper() else 1)
        text = text_of("/".join(parts[:last]) + ".py")
        assert all(re.search(rf"^ *(def|class) {name}\b", text, re.M) for name in parts[last:]), dotted
        while chain and chain[-1][0] >= len(blanks):
            chain.pop()
        if chain and dotted != "simulate._solved":  # by way of `_simulate`
            assert re.search(rf"\b{parts[-1]}\b", chain[-1][1]), (dotted, chain[-1][2])
        chain.append((len(blanks), text, dotted))
    assert len(followed) > 15


def test_functions_that_a_flow_passes_exist():
    rows = re.findall(r"^\| .+ \| (`.+`.*) \|$", PAGE.split("### One flow, followed")[1].split("\n\nWhere")[0], re.M)
    assert len(rows) > 8
    for row in rows:
        text = "".join(text_of(path) for path in re.findall(r"`([a-z_]+(?:/[a-z_]+)*\.py)`", row))
        for name in re.findall(r"`((?:\w+\.)?\w+)`", row):
            if not name.endswith("py"):
                assert re.search(rf"\b{name.split('.')[-1]}\b", text), (name, row)
