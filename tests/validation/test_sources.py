"""The sources of this checkout: their interface, exact cases, the plain equations, and the page of stored results."""

import ast
import json
import re

import pytest
from each_row import each_row
from folders import ROOT

import screwsim
from screwsim.scene import load
from screwsim.study.validation import names_of
from screwsim.study.validation.record import KINDS, VERDICTS

VALIDATION = ROOT / "validation"
STORED = json.loads((VALIDATION / "results.json").read_text(encoding="utf-8"))
SOURCES = names_of(VALIDATION)


def rows(name):
    return STORED["sources"][name]["rows"]


@each_row("name", SOURCES)
def test_source_has_its_interface(compare_of, name):
    module = compare_of(name)
    assert callable(module.compare)
    assert module.TITLE
    assert module.CITATION
    assert STORED["sources"][name]["about"] == module.ABOUT  # which the page of validation shows


@each_row(
    "path",
    sorted(path for path in VALIDATION.glob("*/*.yaml") if not path.name.endswith(".fit.yaml")),
    ids=lambda path: f"{path.parent.name}/{path.name}",
)
def test_scene_loads(path):
    assert screwsim.load(path).title


@each_row("path", sorted(VALIDATION.glob("*/*.csv")), ids=lambda path: f"{path.parent.name}/{path.name}")
def test_data_say_where_they_come_from(path):
    assert path.read_text(encoding="utf-8").startswith("# ")


def test_results_of_every_source_are_stored():
    assert sorted(STORED["sources"]) == SOURCES
    assert all(source["status"] == "ok" for source in STORED["sources"].values())


def test_what_new_cylinders_were_fitted_to_is_no_evidence():
    """Their clearance and reeds are fitted to λ of two machines at all speeds; a third has no part in it."""
    lambdas = [row for row in rows("varispeed") if row["quantity"].startswith("new, ") and ": λ, " in row["quantity"]]
    kinds = {
        others: {row["kind"] for row in lambdas if ("4CE-6.F1" in row["quantity"]) is not others}
        for others in (True, False)
    }
    assert kinds == {True: {"calibrated"}, False: {"published"}}


def test_stored_rows_have_known_kinds_and_verdicts():
    every = [row for source in STORED["sources"].values() for row in source["rows"]]
    assert {row["kind"] for row in every} <= set(KINDS)
    assert {row["verdict"] for row in every} <= set(VERDICTS)
    for verdict, count in STORED["verdicts"].items():
        assert sum(row["verdict"] == verdict for row in every) == count


def test_the_page_is_that_of_the_stored_results(page_script):
    assert page_script.PAGE.read_text(encoding="utf-8") == page_script.page(STORED)


def test_every_failing_row_stands_on_the_page(page_script):
    text = page_script.PAGE.read_text(encoding="utf-8")
    failing = [row for source in STORED["sources"].values() for row in source["rows"] if row["verdict"] == "fails"]
    assert failing
    assert len(re.findall(r"\| \*\*fails\*\* \|", text)) == len(failing)


@each_row("name", [name for name in SOURCES if STORED["sources"][name]["panels"]])
def test_the_page_has_the_figure(name):
    assert (ROOT / "docs" / "figures" / f"validation_{name}.png").exists()


def test_exact_cases_hold_to_their_tolerance(compare_of):
    found = compare_of("exact").compare(VALIDATION / "exact").rows
    assert {row.kind for row in found} == {"exact"}
    assert [row.quantity for row in found if row.verdict != "holds"] == []


@pytest.mark.parametrize("name", ["plain.py", "cylinder.py", "chamber.py", "flooded.py"])
def test_plain_equations_import_nothing_of_the_package(name):
    tree = ast.parse((VALIDATION / "plain" / name).read_text(encoding="utf-8"))
    modules = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    modules |= {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert {module.partition(".")[0] for module in modules} <= {
        "CoolProp",
        "__future__",
        "collections",
        "dataclasses",
        "functools",
        "itertools",
        "math",
        "typing",
        "numpy",
        "scipy",
    }


@pytest.fixture(scope="module")
def kept_plain(plain_tool):
    return json.loads(plain_tool.KEPT.read_text(encoding="utf-8"))


def test_plain_equations_agree_with_the_package_to_1e_6(compare_of, plain_tool, kept_plain):
    """The point whose oil is carried: all figures kept of plain.py; all points: as stored. The package is run now."""
    module = compare_of("plain")
    points = module.points(VALIDATION / "plain")
    stored = [row for row in rows("plain") if "difference" in row["quantity"] and "d = " in row["quantity"]]
    assert module.TOLERANCE == 1e-6 and len(points) == len(stored) == 3
    for point, row in zip(points, stored, strict=True):
        ours = dict(module.solved(*point.asked).performance)
        assert row["quantity"].startswith(f"{point.name}: ") and row["ours"] <= 1e-6
        there = float(row["note"].split()[-2])  # of the plain equations, to eight digits
        assert ours["isothermal_efficiency"] == pytest.approx(there, rel=1e-6)
    carried = plain_tool.carried(module)
    assert plain_tool.digest(module.machine_of(load(*carried.asked))) == kept_plain["digest"], plain_tool.REMEDY
    now = module.compared(carried, kept_plain["figures"])
    # both are integrated to 1e-8 or better a step, at the same width of the root
    assert now.ours <= 1e-6


def test_a_cylinder_of_plain_equations_agrees_with_the_package_to_1e_6(compare_of):
    """That with ideal valves is solved anew, the one with reeds as stored: 40 impacts are seconds of plain Python."""
    module = compare_of("plain")
    stored = [row for row in rows("plain") if row["quantity"].startswith("cylinder")]
    reeds, ideal = points = module.cylinder_points(VALIDATION / "plain")
    assert len(stored) == len(points) and all(row["ours"] <= module.TOLERANCE for row in stored)
    there = float(stored[0]["note"].split()[-2])
    assert dict(module.solved(*reeds.asked).performance)["volumetric_efficiency"] == pytest.approx(there, rel=1e-6)
    machine = module.cylinder_of(load(*ideal.asked))
    assert module.compared(ideal, module.cylinder_figures(machine)).ours <= module.TOLERANCE


def as_stored(module, begins, points, figure_of):
    """Assert that the package, run now, has a figure of each point as its row stores it of the plain equations."""
    stored = [row for row in rows("plain") if row["quantity"].startswith(begins)]
    for point, row in zip(points, stored, strict=True):
        there = float(row["note"].split()[-2])  # to eight digits
        assert row["quantity"].startswith(f"{point.name}: ") and row["ours"] <= module.TOLERANCE
        ours = dict(module.solved(*point.asked).performance)
        assert ours[figure_of(row)] == pytest.approx(there, rel=1e-6)


def test_a_chamber_of_plain_equations_on_a_real_fluid_agrees_with_the_package_to_1e_6(compare_of):
    """The package is run now, the plain equations are as stored: each point takes them seconds."""
    module = compare_of("plain")
    points = module.chamber_points(VALIDATION / "plain")
    assert len(points) == 4
    as_stored(module, "tight chamber", points, lambda row: "_".join(row["note"].split()[2:4]))


@pytest.mark.around
def test_a_chamber_of_plain_equations_solved_now_is_that_of_the_package(compare_of):
    module = compare_of("plain")
    for point in module.chamber_points(VALIDATION / "plain"):
        assert module.compared(point, module.chamber_figures(load(*point.asked))).ours <= module.TOLERANCE


def test_a_flooded_screw_of_plain_equations_agrees_with_the_package_to_1e_6(compare_of):
    """The package is run now, the plain equations are as stored: each point takes them a minute."""
    module = compare_of("plain")
    points = module.flooded_points(VALIDATION / "plain")
    assert len(points) == 2
    as_stored(module, "flooded", points, lambda row: "isothermal_efficiency")


@pytest.mark.around
def test_a_flooded_screw_of_plain_equations_solved_now_is_that_of_the_package(compare_of):
    module = compare_of("plain")
    for point in module.flooded_points(VALIDATION / "plain"):
        theirs = module.flooded_figures(VALIDATION / "plain", load(*point.asked))
        assert module.compared(point, theirs).ours <= module.TOLERANCE


@pytest.mark.around
def test_kept_figures_are_those_of_the_plain_equations_solved_now(compare_of, plain_tool, kept_plain):
    now = plain_tool.solved_now(compare_of("plain"))
    assert now["digest"] == kept_plain["digest"], plain_tool.REMEDY
    assert now["figures"] == pytest.approx(kept_plain["figures"], rel=5e-7), plain_tool.REMEDY  # of any processor
