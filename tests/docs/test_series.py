"""Pages with their own series of equations: no gaps, each with formula and source, and what the code cites is there."""

import re

import pytest
from folders import ROOT

SERIES = {
    "S": ("slider-crank.md", "src/screwsim/machine/slider_crank"),
    "K": ("coupling.md", "src/screwsim/machine/drive"),
}


def page(letter: str) -> str:
    return (ROOT / "docs" / "reference" / SERIES[letter][0]).read_text(encoding="utf-8")


def sections(letter: str) -> dict[str, str]:
    pattern = rf"^#### ({letter}\d+) .+?\n(.*?)(?=^#{{2,4}} |\Z)"
    return dict(re.findall(pattern, page(letter), flags=re.MULTILINE | re.DOTALL))


@pytest.mark.parametrize("letter", SERIES)
def test_numbers_run_without_gap_or_repetition(letter):
    numbers = [int(number) for number in re.findall(rf"^#### {letter}(\d+) ", page(letter), flags=re.MULTILINE)]
    assert len(numbers) > 10
    assert sorted(numbers) == list(range(1, len(numbers) + 1))


@pytest.mark.parametrize("letter", SERIES)
def test_every_equation_has_a_formula_and_a_source(letter):
    for name, text in sections(letter).items():
        assert "$$" in text, name
        assert re.search(r"^Source: ", text, flags=re.MULTILINE), name


@pytest.mark.parametrize("letter", SERIES)
def test_everything_cited_in_the_code_is_there(letter):
    files = sorted((ROOT / SERIES[letter][1]).glob("*.py"))
    found = {name for path in files for name in re.findall(rf"\b{letter}\d+\b", path.read_text(encoding="utf-8"))}
    assert found
    assert found <= set(sections(letter))
