"""docs/model.md is the one list of equations: what code and effects cite stands there, with formula and source."""

import re
from itertools import pairwise

from each_row import each_row
from folders import ROOT

from screwsim.effects import catalogue

PAGE = (ROOT / "docs" / "model.md").read_text(encoding="utf-8")
CRANK = (ROOT / "docs" / "reference" / "slider-crank.md").read_text(encoding="utf-8")


def sections(page: str, letter: str) -> dict[str, str]:
    """Return {number: text} of the equations of a page."""
    pattern = rf"^#### ({letter}\d+) .+?\n(.*?)(?=^#{{2,4}} |\Z)"
    return dict(re.findall(pattern, page, flags=re.MULTILINE | re.DOTALL))


SECTIONS = sections(PAGE, "M") | sections(CRANK, "S")
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))]


def cited(text: str) -> set[str]:
    """Return the numbers in a text, ranges such as M20–M22 included."""
    found = set(re.findall(r"\bM\d+\b", text))
    for first, last in re.findall(r"\bM(\d+)–M(\d+)\b", text):
        found |= {f"M{number}" for number in range(int(first), int(last) + 1)}
    return found


def test_numbers_rise_over_the_page_without_gap_in_each_block():
    numbers = [int(number) for number in re.findall(r"^#### M(\d+) ", PAGE, flags=re.MULTILINE)]
    assert numbers[0] == 1
    assert all(b == a + 1 or (b > a and b % 10 == 0) for a, b in pairwise(numbers))  # a block begins at a ten


@each_row("name", SECTIONS)
def test_equation_has_a_formula_and_a_source(name):
    assert "$$" in SECTIONS[name]
    assert re.search(r"^Source: ", SECTIONS[name], flags=re.MULTILINE)


def test_everything_cited_in_the_code_is_there():
    files = sorted((ROOT / "src").glob("**/*.py"))
    missing = {(path.name, name) for path in files for name in cited(path.read_text(encoding="utf-8")) - set(SECTIONS)}
    assert files
    assert not missing


@each_row("page", PAGES, ids=lambda path: path.name)
def test_everything_cited_in_the_docs_is_there(page):
    assert cited(page.read_text(encoding="utf-8")) <= set(SECTIONS)


@each_row("name", catalogue())
def test_effect_cites_equations_that_are_there(name):
    equations = catalogue()[name].equations
    assert equations
    assert set(equations) <= set(SECTIONS)


@each_row("page", PAGES, ids=lambda path: path.name)
def test_links_between_pages_lead_somewhere(page):
    def anchors(text: str) -> set[str]:
        heads = re.findall(r"^#+ (.+)$", re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S), flags=re.MULTILINE)
        return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}

    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        name, _, anchor = target.partition("#")
        file = page.parent / name if name else page
        assert file.exists(), target
        assert not anchor or anchor in anchors(file.read_text(encoding="utf-8")), target
