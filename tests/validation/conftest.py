"""Modules of validation/ and docs/tools/, which are no part of the package."""

from pathlib import Path

import pytest

from screwsim.study.validation import sibling

ROOT = Path(__file__).parents[2]
VALIDATION = ROOT / "validation"


@pytest.fixture(scope="session")
def compare_of():
    """Return a function that gives the comparison module of a source."""
    return lambda name: sibling(VALIDATION / name / "compare.py")


@pytest.fixture(scope="session")
def page_script():
    """Return docs/tools/validation_page.py as a module."""
    return sibling(ROOT / "docs" / "tools" / "validation_page.py")


@pytest.fixture(scope="session")
def plain_tool():
    """Return tests/tools/plain_figures.py as a module."""
    return sibling(ROOT / "tests" / "tools" / "plain_figures.py")
