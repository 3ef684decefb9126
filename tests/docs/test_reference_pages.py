"""The pages of all keys and all results are those that the code makes, and the index names every page."""

import re
import sys

import pytest
from folders import ROOT

from screwsim.study.validation import sibling

made = sibling(ROOT / "docs" / "tools" / "reference_pages.py")
equations = sys.modules["equations_page"]


@pytest.mark.parametrize(
    "name", [pytest.param(each, marks=[pytest.mark.around] if each == "equations.md" else []) for each in made.PAGES]
)
def test_a_page_is_as_made(name):
    assert (made.FOLDER / name).read_text(encoding="utf-8") == made.PAGES[name]()


def test_every_page_is_in_the_index():
    index = ROOT / "docs" / "README.md"
    linked = {(index.parent / target).resolve() for target in re.findall(r"\]\(([^)#]+)", index.read_text("utf-8"))}
    assert {page.resolve() for page in (ROOT / "docs").glob("**/*.md")} - {index.resolve()} <= linked


def test_every_equation_is_in_the_code_and_every_number_of_the_code_is_an_equation():
    found, cited = set(equations.equations()), set(equations.places())
    assert cited <= found
    assert found - cited == set(equations.WITHOUT_CODE)  # each of these with its reason


def test_an_equation_without_code_has_a_test():
    for number, why in equations.WITHOUT_CODE.items():
        assert len(why.split()) > 3 and equations.tests_of(number), number


@pytest.mark.around
def test_a_page_of_equations_knows_ranges_and_owners():
    assert equations.cited("M20–M22, S1-S2 and M7") == {"M20", "M21", "M22", "S1", "S2", "M7"}
    page = made.PAGES["equations.md"]()
    (tips,) = [each for each in page.split("\n## ") if each.startswith("M19 ")]
    assert "`src/screwsim/effects/tip_leakage.py` (Parameters, all_tips)" in tips and "- effects: `tip_leakage`" in tips
