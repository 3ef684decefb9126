"""Fits without time, files of one moment, and a sweep that nothing disturbs."""

import sys
from datetime import datetime
from functools import partial

import pytest


@pytest.fixture
def quick(monkeypatch):
    """Solve the points of a fit without time, as the commands ask for them."""
    from fit_fakes import plane

    from screwsim.derivatives.solving import SceneDerivatives
    from screwsim.simulate import warm_up

    monkeypatch.setattr("screwsim.study.calibration.residuals.WarmSimulation", lambda trace: plane)
    monkeypatch.setattr(
        "screwsim.study.calibration.residuals.scene_derivatives", lambda *asked: SceneDerivatives({}, {}, "not asked")
    )
    monkeypatch.setattr(sys.modules[warm_up.__module__], "warm_up", lambda scene: None)


@pytest.fixture
def plant(tmp_path):
    """Write two stages into a folder, with what they are called with; return the path of their file."""
    from scenes import two_stages

    return partial(two_stages, tmp_path, title="plant")


class OneMoment:
    """A clock that stands."""

    @staticmethod
    def now(zone) -> datetime:
        return datetime(2026, 1, 1, tzinfo=zone)


@pytest.fixture(scope="module")
def one_moment():
    """Write all files of a module's tests at one moment: HDF5's checksums go with the moment that a file tells.

    Equal files then have equal bytes, and need not be read to be compared.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("screwsim.results.schema.datetime", OneMoment)
        yield


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """Return the file of a sweep that nothing disturbs."""
    from sweep_fakes import chained, grid_scene

    from screwsim.study.sweep import run_sweep

    output = tmp_path_factory.mktemp("reference") / "one.h5"
    run_sweep(grid_scene(), output, jobs=1, simulate_many=chained)
    return output
