"""The worked examples of configs/calibration: a known machine is found again, and what cannot be found is said."""

from dataclasses import replace

import numpy as np
import pytest
from folders import CONFIGS, ROOT

from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.calibration.diagnosis import diagnose
from screwsim.study.calibration.residuals import Objective
from screwsim.study.validation import sibling

pytestmark = pytest.mark.around

FOLDER = CONFIGS / "calibration"


def example():
    """Return docs/tools/calibration_example.py as a module."""
    return sibling(ROOT / "docs" / "tools" / "calibration_example.py")


@pytest.mark.parametrize(
    "path", sorted([*FOLDER.glob("*.fit.yaml"), *ROOT.glob("validation/*/*.fit.yaml")]), ids=lambda path: path.name
)
def test_shipped_fit_is_read(path):
    assert read_fit(path).points


def test_the_data_are_those_of_the_script():
    module = example()
    texts = {
        module.POINTS: module.text(),
        module.LATER: module.text(module.GROWN, None),
        module.LESS: module.text(module.LITTLE_OIL, None),
        module.STUCK: module.text(module.STILL, None, module.CONTROL),
        module.SHEET.with_suffix(".csv"): module.sheet_text(),
    }
    for file, text in texts.items():
        stored = [line.split(",") for line in file.read_text(encoding="utf-8").splitlines()]
        made = [line.split(",") for line in text.splitlines()]
        for one, other in zip(stored[2:], made[2:], strict=True):
            # figures are written to five digits, solved to 1e-5
            assert [float(cell) for cell in one[2:]] == pytest.approx([float(cell) for cell in other[2:]], rel=1e-4)


def test_a_known_machine_is_found_within_its_standard_errors():
    module = example()
    fit = replace(read_fit(FOLDER / "leakage.fit.yaml"), starts=1)
    found = calibrate(fit, jobs=1)
    assert found.status == "ok"
    assert set(found.values) == set(module.TRUTH)
    for parameter, error in zip(fit.parameters, found.certainty.errors, strict=True):
        # seed 1; two thirds of seeds lie within one error each
        assert abs(found.values[parameter.path] - module.TRUTH[parameter.path]) <= error, parameter.path
    assert found.certainty.open == ()


def test_the_pressures_are_those_of_the_script():
    for file, text in example().indicator_texts().items():
        stored, made = file.read_text(encoding="utf-8").splitlines(), text.splitlines()
        if file.name == "indicator.csv":
            assert stored == made
            continue
        assert stored[:2] == made[:2]
        pairs = [[[float(cell) for cell in line.split(",")] for line in lines[2:]] for lines in (stored, made)]
        assert np.array(pairs[0]) == pytest.approx(np.array(pairs[1]), abs=2e-3)  # written to 1e-3 bar, solved to 1e-5


def test_the_gap_and_the_port_of_an_indicated_machine_are_found():
    module = example()
    fit = replace(read_fit(FOLDER / "indicator.fit.yaml"), starts=1)
    found = calibrate(fit, jobs=1)
    assert found.status == "ok"
    for (path, true), error in zip(module.THROTTLED.items(), found.certainty.errors, strict=True):
        assert abs(found.values[path] - true) <= error, path  # seed 1, as above


@pytest.mark.parametrize(
    ("file", "data", "paths", "truth"),
    [
        ("slide.fit.yaml", None, ("effects.slide_valve.position", "effects.mechanical.fraction"), 0.15),
        ("fault.fit.yaml", "less_oil.csv", ("oil_supply.ratio", "effects.tip_leakage.gap"), 2.0),
    ],
    ids=["a stuck slide", "less oil"],
)
def test_a_fault_that_was_made_is_the_most_probable_and_its_size_is_found(file, data, paths, truth):
    fit = read_fit(FOLDER / file, data=data and FOLDER / data, fixed=False)
    parameters = tuple(each for each in fit.parameters if each.path in paths)
    found = diagnose(replace(fit, parameters=parameters, points=fit.points[::3]), jobs=1)
    best = found.hypotheses[0]
    # the rest is that the other has changed beside it, of which two or three points leave a few percent
    assert best.path == paths[0] and best.probability > 0.95 and found.changed[paths[0]] > 0.999
    was = found.unchanged[paths[0]]
    assert was + best.low < truth < was + best.high
    assert sum(each.probability for each in found.hypotheses) == pytest.approx(1.0, abs=1e-12)


def test_two_faults_that_were_made_are_the_most_probable_pair():
    gap, ratio = "effects.tip_leakage.gap", "oil_supply.ratio"
    fit = read_fit(FOLDER / "fault.fit.yaml", data=FOLDER / "both.csv", fixed=False)
    parameters = tuple(each for each in fit.parameters if each.path in (gap, ratio, "effects.mechanical.fraction"))
    found = diagnose(replace(fit, parameters=parameters, points=fit.points[::2]), jobs=2)
    best = found.hypotheses[0]
    assert best.paths == (gap, ratio) and best.probability > 0.9 and best.linear == ""
    for change, truth in zip(best.changes, (37.5e-6, 2.0), strict=True):
        was = found.unchanged[change.path]
        assert was + change.low < truth < was + change.high


def test_droplet_radius_and_heat_transfer_are_said_not_to_be_told_apart():
    fit = read_fit(FOLDER / "droplets.fit.yaml")
    only = tuple(each for each in fit.parameters if each.path.startswith("effects.oil_heat."))
    found = calibrate(replace(fit, starts=1, parameters=only), jobs=1)
    (combination,) = found.certainty.open
    assert set(combination.paths) == {each.path for each in only}
    assert "the data fix only their quotient" in combination.says


def test_exact_slopes_are_those_of_differences_and_take_fewer_solutions():
    """Residuals of the worked example over all three places, halfway between their bounds."""
    fit = read_fit(CONFIGS / "calibration" / "leakage.fit.yaml")
    fit = replace(fit, points=tuple(point for point in fit.points if point.fitted)[:2])
    places = np.full(len(fit.parameters), 0.5)
    exact, differences = Objective(replace(fit, slopes="exact")), Objective(fit)
    assert exact.slopes(places) == pytest.approx(
        differences.slopes(places), rel=0.02, abs=0.05
    )  # curvature over their step
    assert set(exact.methods.values()) == {""} and all(differences.methods.values())
    assert (exact.solutions, differences.solutions) == (4, 2 + 2 * 2 * len(fit.parameters))
