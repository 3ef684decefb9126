"""The pages of all keys and all results are those that the code makes, and the index names every page."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SPEC = importlib.util.spec_from_file_location("reference_pages", ROOT / "scripts" / "reference_pages.py")
made = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(made)


@pytest.mark.parametrize("name", made.PAGES)
def test_a_page_is_as_made(name):
    assert (made.FOLDER / name).read_text(encoding="utf-8") == made.PAGES[name]()


def test_every_page_is_in_the_index():
    index = ROOT / "docs" / "README.md"
    linked = {(index.parent / target).resolve() for target in re.findall(r"\]\(([^)#]+)", index.read_text("utf-8"))}
    assert {page.resolve() for page in (ROOT / "docs").glob("**/*.md")} - {index.resolve()} <= linked
