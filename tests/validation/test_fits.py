"""Stored fits are what their commands give: the points, the fitted machine, the machines of the paper."""

import csv
import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.validation import read_table, sibling

pytestmark = pytest.mark.around
ROOT = Path(__file__).parents[2]
BITZER, PAPER = ROOT / "validation" / "bitzer", ROOT / "validation" / "paper"
STORED = json.loads((BITZER / "fitted" / "fit.json").read_text(encoding="utf-8"))


def test_the_points_of_the_fit_are_those_of_the_regressions():
    made = sibling(BITZER / "points.py").rows()
    stored = list(csv.reader((BITZER / "fit.csv").read_text(encoding="utf-8").splitlines()[2:]))
    assert [row[:2] for row in stored] == [row[:2] for row in made]
    numbers = [[[float(cell) for cell in row[2:]] for row in rows] for rows in (stored, made)]
    assert np.array(numbers[0]) == pytest.approx(np.array(numbers[1]), abs=1e-3)  # temperatures to 1e-4 °C


def test_the_fit_of_bitzer_is_of_three_points_and_has_its_bounds():
    fit = read_fit(BITZER / "machine.fit.yaml")
    assert [point.name for point in fit.points if point.fitted] == ["2/45", "5/35", "-10/40"]
    for parameter in fit.parameters:
        told = STORED["parameters"][parameter.path]
        assert (told["from"], told["to"]) == (parameter.low, parameter.high)
        assert parameter.low < told["value"] < parameter.high
    assert len(STORED["starts"]) == fit.starts


@pytest.mark.slow
@pytest.mark.parametrize(("name", "folder"), [("machine", "fitted"), ("ends", "ends_fitted")])
def test_the_fits_of_bitzer_stay_where_they_are_stored(name, folder):
    fit = read_fit(BITZER / f"{name}.fit.yaml")
    stored = json.loads((BITZER / folder / "fit.json").read_text(encoding="utf-8"))
    began = tuple(replace(each, start=stored["parameters"][each.path]["value"]) for each in fit.parameters)
    points = tuple(point for point in fit.points if point.fitted)
    found = calibrate(replace(fit, parameters=began, points=points, starts=1), jobs=1)
    # the solver's noise of 1e-4 in figures that count with 1e-2
    assert found.chi_squared == pytest.approx(stored["chi_squared"], rel=0.01)
    for each in fit.parameters:
        told = stored["parameters"][each.path]
        assert abs(found.values[each.path] - told["value"]) < 0.1 * told["standard_error"]


@pytest.mark.slow
def test_the_best_fit_of_the_paper_meets_its_conditions(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    script = sibling(ROOT / "scripts" / "fit_paper.py")
    admissible = sys.modules["admissible"]
    row = read_table(PAPER / "fits.csv")[0]
    x = np.array([float(row[item.name]) for item in admissible.OPEN])
    low, high = script.SPEEDS
    u = np.append(admissible.to_unit(x), np.log(float(row["speed_rpm"]) / low) / np.log(high / low))
    assert np.all((u >= 0.0) & (u <= 1.0))
    left = script.Paper().residuals(u)
    # values are stored with six digits, solved to 1e-3: a fifth of what counts as one
    assert np.max(np.abs(left)) < 0.5
