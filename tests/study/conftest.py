"""Let the tests, and the workers they start, import the fakes and `true_error`, whatever the import mode."""

import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "results"), str(HERE.parent / "tools")]


@pytest.fixture
def quick(monkeypatch):
    """Solve the points of a fit without time, as the commands ask for them."""
    from fit_fakes import plane

    from screwsim.derivatives.solving import SceneDerivatives
    from screwsim.simulate import warm_up

    monkeypatch.setattr("screwsim.study.calibration.residuals.WarmSimulation", lambda: plane)
    monkeypatch.setattr(
        "screwsim.study.calibration.residuals.scene_derivatives", lambda *asked: SceneDerivatives({}, {}, "not asked")
    )
    monkeypatch.setattr(sys.modules[warm_up.__module__], "warm_up", lambda scene: None)
