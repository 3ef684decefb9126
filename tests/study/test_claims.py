"""The paper's sweeps: every point closes, and the claims come out as docs/explanation/paper.md says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from screwsim.results import open_results
from screwsim.scene import load
from screwsim.study.claims import DisplacementCurve, claims, curve_optimum, displaced_point, main, table, value_at
from screwsim.study.sweep import run_sweep

PAPER = Path(__file__).resolve().parents[2] / "configs" / "paper"


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    """Return the stored sweeps of Fig. 1 and Fig. 2."""
    folder = tmp_path_factory.mktemp("paper")
    for name in ("fig1", "fig2"):
        run_sweep(load(str(PAPER / f"{name}.yaml")), str(folder / f"{name}.h5"))
    return str(folder / "fig1.h5"), str(folder / "fig2.h5")


@pytest.mark.parametrize("figure", [0, 1])
def test_every_point_of_the_paper_closes_to_the_wanted_accuracy(figures, figure):
    data = open_results(figures[figure])
    assert set(np.unique(data.status)) == {"ok"}
    assert np.max(data.balance["mass"]) < 3e-4  # numerics.accuracy of the scenes
    assert np.max(data.balance["energy"]) < 3e-4


def test_claims_come_out_as_documented(figures):
    verdicts = {claim.name: claim.verdict for claim in claims(*figures)}
    shapes = dict.fromkeys(("A1", "A2", "A3", "A4"), "holds")
    assert verdicts == shapes | {"A5": "calibrated", "A6": "calibrated", "A7": "in part"}


def test_table_names_every_claim(figures):
    text = table(claims(*figures))
    assert [line[:2] for line in text.splitlines() if not line.startswith(" ")] == [f"A{i}" for i in range(1, 8)]
    assert max(map(len, text.splitlines())) <= 80


def test_optimum_of_a_parabola_in_the_logarithm_is_its_vertex():
    ratio = np.geomspace(0.1, 10.0, 41)
    best = curve_optimum(ratio, 0.7 - 0.02 * np.log(ratio / 1.3) ** 2)
    assert best is not None and best.interior
    assert best.ratio == pytest.approx(1.3, rel=1e-9)
    assert best.efficiency == pytest.approx(0.7, rel=1e-12)
    assert best.curvature == pytest.approx(0.04 / 0.7, rel=1e-9)
    # drop at a third and at three times: 0.02 ln(3)²/0.7; linear interpolation between points errs by 1e-3 of it
    assert best.drop == pytest.approx(0.02 * np.log(3.0) ** 2 / 0.7, rel=5e-3)


def test_optimum_at_an_end_is_not_interior():
    best = curve_optimum(np.geomspace(0.1, 10.0, 20), np.linspace(0.3, 0.6, 20))
    assert best is not None and not best.interior


def test_value_outside_the_curve_is_none():
    assert value_at(np.array([1.0, 2.0]), np.array([0.5, 0.6]), 3.0) is None


def test_the_point_of_displaced_oil_is_told_with_its_bore():
    speeds, ratio, efficiency = (np.array(each) for each in ([500.0, 1e3, 2e3], [6.0, 3.0, 1.5], [0.5, 0.44, 0.3]))
    claim = displaced_point(DisplacementCurve(2.5e-3, speeds, ratio, efficiency))
    assert claim.found == "bore 2.5 mm: 44.0% at 1000 rpm, where d = 3, 44.0% at 1000 rpm, where d = 3.00"
    assert claim.verdict == "calibrated"


def test_files_that_are_not_both_sweeps_are_told(figures, capsys):
    one, other = figures
    for files in ([], [one], [other, one], [one, "nothing.h5"]):
        assert main(files) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1
    assert main([one, other]) == 0
