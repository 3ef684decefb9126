"""A map of the paper's machine, made once; what compiles C is left out where nothing does."""

from pathlib import Path

import pytest

from screwsim.export.source import map_of

ROOT = Path(__file__).parents[2]
POINT = str(ROOT / "configs" / "paper" / "point.yaml")
RANGES = ("operation.speed=2000 rpm..4000 rpm", "operation.discharge.pressure=8 bar..14 bar")


@pytest.fixture(scope="session")
def point():
    """Return the scene's file of which the map is made."""
    return POINT


@pytest.fixture(scope="session")
def table():
    """Return a map over speed and discharge pressure whose error is below 1 %."""
    return map_of(POINT, RANGES, wanted=0.01, jobs=1)
