"""A map of the paper's machine, made once; what compiles C is left out where nothing does."""

from pathlib import Path

import pytest

from screwsim.export.source import map_of
from screwsim.results import open_results
from screwsim.scene import load
from screwsim.study.sweep import run_sweep

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


@pytest.fixture(scope="session")
def swept_blend(tmp_path_factory):
    """Return the results of a small sweep over both temperatures of the R454B machine."""
    axes = {
        "sweep.operation.evaporating_temperature": ["-10 degC", "-5 degC", "0 degC", "5 degC"],
        "sweep.operation.condensing_temperature": ["30 degC", "35 degC", "40 degC", "45 degC"],
    }
    path = tmp_path_factory.mktemp("blend") / "blend.h5"
    run_sweep(load(ROOT / "configs" / "r454b" / "point.yaml").with_(axes), path, jobs=1)
    return open_results(path)


@pytest.fixture(scope="session")
def swept_map(tmp_path_factory):
    """Return the results of a small sweep over both temperatures of the R134a machine, oil uncooled."""
    scene = load(ROOT / "configs" / "r134a" / "map.yaml")
    axes = {
        "sweep.operation.evaporating_temperature": ["-10 degC", "-5 degC", "0 degC", "5 degC"],
        "sweep.operation.condensing_temperature": ["35 degC", "40 degC", "45 degC", "50 degC"],
    }
    path = tmp_path_factory.mktemp("map") / "map.h5"
    run_sweep(scene.without("motor").with_(axes), path, jobs=1)
    return open_results(path)
