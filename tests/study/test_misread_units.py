"""A column of measured figures in another unit than its head says is named; a fit that is merely bad has no such hint.

Factors and zeros of units: NIST Special Publication 811, appendix B.
"""

import numpy as np
import pytest
from fit_fakes import GAP, HEAD, ONE_START, SCENE, plane, write_fit

import screwsim
from screwsim.printing.calibration import calibration_document, print_calibration
from screwsim.printing.diagnosis import diagnosis_document, print_diagnosis
from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.calibration.diagnosis import diagnose
from screwsim.study.calibration.fit import Measurement
from screwsim.study.calibration.misread_units import misread_units

AMBIENT = 101325.0
OURS = {"shaft_power": 5e4, "gas_mass_flow": 0.3, "discharge_temperature": 350.0, "discharge_pressure": 12e5}
SPREAD = np.array([0.8, 1.0, 1.3, 1.1])  # of the points


def told(figure, read, error=0.03):
    """Return what is said of a column whose values are read as `read` says, with an error of the model."""
    truth = OURS[figure] * SPREAD if figure != "discharge_temperature" else OURS[figure] + 40.0 * (SPREAD - 1.0)
    bend = 1.0 + error * np.array([1.0, -0.7, 0.4, -1.0])
    ours = truth * bend if figure != "discharge_temperature" else truth + 100.0 * (bend - 1.0)
    rows = [(figure, Measurement(read(x), 1e-4 * x), y) for x, y in zip(truth.tolist(), ours.tolist(), strict=True)]
    return misread_units(rows, AMBIENT)


@pytest.mark.parametrize(
    ("figure", "read", "words"),
    [
        (
            "shaft_power",
            lambda x: 1e3 * x,
            "times what the scene has before the fit at all 4 points, as of values in W",
        ),
        ("shaft_power", lambda x: 1e-3 * x, "values in kW under [W]"),
        ("shaft_power", lambda x: x / 0.7457, "values in hp under [kW]"),
        ("gas_mass_flow", lambda x: x / 0.45359237, "values in lb/h under [kg/h]"),
        ("gas_mass_flow", lambda x: 3600.0 * x, "values in kg/h under [kg/s]"),
        ("discharge_pressure", lambda x: 100.0 * x, "values in kPa under [bar]"),
        ("discharge_pressure", lambda x: 14.5038 * x, "values in psi under [bar]"),
        (
            "discharge_pressure",
            lambda x: x - AMBIENT,
            "bar on average at all 4 points, as of values in bar(g) under [bar]",
        ),
        ("discharge_pressure", lambda x: x + AMBIENT, "values in bar under [bar(g)]"),
        ("discharge_temperature", lambda x: 1.8 * (x - 273.15) + 32.0 + 273.15, "values in degF under [degC]"),
        ("discharge_temperature", lambda x: (x - 273.15 - 32.0) / 1.8 + 273.15, "values in degC under [degF]"),
        ("discharge_temperature", lambda x: x + 273.15, "values in K under [degC]"),
    ],
)
def test_a_column_in_another_unit_is_named(figure, read, words):
    error = 0.005 if "bar(g)" in words else 0.02  # more of 12 bar are a large part of the ambient pressure
    (line,) = told(figure, read, error)
    assert line.startswith(f"measured {figure.replace('_', ' ')} is ") and line.endswith("check its unit")
    assert words in line


@pytest.mark.parametrize("factor", [0.4, 0.5, 0.8, 0.9, 1.0, 1.15, 1.25, 1.5, 2.0, 4.0])
@pytest.mark.parametrize("figure", ["shaft_power", "gas_mass_flow", "discharge_temperature"])
def test_a_machine_that_is_merely_another_one_has_no_hint(figure, factor):
    offset = 0.2 if figure == "discharge_temperature" else 1.0
    assert told(figure, lambda x: x * (1.0 + offset * (factor - 1.0))) == ()


def test_numbers_that_are_off_by_different_factors_have_no_hint():
    factors = iter([900.0, 1000.0, 2.0, 1000.0])
    assert told("shaft_power", lambda x: next(factors) * x) == ()


def test_numbers_within_their_uncertainties_have_no_hint():
    rows = [("shaft_power", Measurement(1e3 * x, 1e3 * x), x) for x in (4e4, 5e4)]
    assert misread_units(rows, AMBIENT) == ()


def points(factor, bend=0.0):
    speeds = (1.0, 2.0, 3.0, 4.0)
    rows = [f"p{n},fit,{1e3 * n},{factor * (5.0 + 2.0 * n + bend * (-1) ** n)},0.01\n" for n in speeds]
    return HEAD + "".join(rows)


@pytest.mark.parametrize(("factor", "bend", "hint"), [(1e3, 0.0, True), (1.0, 3.0, False), (1.0, 0.0, False)])
def test_a_fit_and_a_diagnosis_name_the_column(factor, bend, hint, tmp_path, capsys):
    scene = screwsim.loads(SCENE).with_({GAP: "50 um", "oil.heat_capacity": "2 kJ/(kg K)"}).text
    file = write_fit(tmp_path, ONE_START, points(factor, bend), scene)
    found = calibrate(read_fit(file), jobs=1, simulate=plane)
    print_calibration(found)
    words = "as of values in W under [kW]"
    assert (words in " ".join(capsys.readouterr().out.split())) == hint
    assert len(calibration_document(found)["misread_units"]) == hint
    changed = diagnose(read_fit(file, fixed=False), simulate=plane, jobs=1)
    print_diagnosis(changed)
    assert (words in " ".join(capsys.readouterr().out.split())) == hint
    assert len(diagnosis_document(changed)["misread_units"]) == hint
