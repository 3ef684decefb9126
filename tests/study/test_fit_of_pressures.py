"""Curves at angles among the data of a fit, mostly chamber pressures: what is read, refused, computed and printed."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from screwsim.figures import declared
from screwsim.figures.curves import Reading, reading_of, with_readings
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import Result
from screwsim.printing.fitted_points import lines_of_points, pictures
from screwsim.study.calibration import read_fit
from screwsim.study.calibration.indicator import pressures_of
from screwsim.study.calibration.machine import points_of
from screwsim.study.calibration.posterior import refuse_curves
from screwsim.study.calibration.residuals import Objective
from screwsim.study.calibration.solve import ComparedMeasurement

POINT = Path(__file__).parents[2] / "configs" / "paper" / "point.yaml"
FIT = f"""
scene: {POINT}
data: points.csv
parameters:
  effects.tip_leakage.gap: {{from: 10 um, to: 80 um}}
starts: 1
"""
HEAD = "operation.speed [rpm],indicator,indicator_uncertainty [mbar] (k=2)"
PLENUM = "discharge_plenum_pressure"
OF_PLENUM = f"operation.speed [rpm],indicator_of_{PLENUM},indicator_of_{PLENUM}_uncertainty [mbar]"
OF_600 = "pressure_at_600_deg [bar],pressure_at_600_deg_uncertainty [bar]"
PRESSURES = "angle_deg,pressure_kPa\n500,200\n600.5,600\n"


def fit_of(folder, points, pressures=PRESSURES, scene=POINT):
    (folder / "points.csv").write_text(points, encoding="utf-8")
    (folder / "p.csv").write_text(pressures, encoding="utf-8")
    (folder / "own.fit.yaml").write_text(FIT.replace(str(POINT), str(scene)), encoding="utf-8")
    return read_fit(folder / "own.fit.yaml")


def with_plenum(folder):
    """Return the file of the scene with a plenum behind its discharge port."""
    plenum = "effects:\n  plenums: {discharge_volume: 5 l, discharge_area: 20 cm^2}\n"
    text = POINT.read_text(encoding="utf-8").replace("effects:\n", plenum, 1)
    (folder / "plenum.yaml").write_text(text, encoding="utf-8")
    return folder / "plenum.yaml"


def result(last=720.0):
    angle = np.arange(0.0, last + 1.0)
    return Result("ok", cycle={"angle": angle, "pressure": 1e5 + 1e3 * angle})


def test_a_file_beside_the_data_gives_each_pressure_with_its_standard_uncertainty(tmp_path, monkeypatch):
    monkeypatch.chdir("/")
    (point,) = fit_of(tmp_path, f"{HEAD}\n1000,p.csv,40\n").points
    assert list(point.measured) == ["pressure_at_500_deg", "pressure_at_600.5_deg"]
    assert [tuple(each) for each in point.measured.values()] == [(2e5, 2e3), (6e5, 2e3)]


def test_pressures_are_also_columns_and_gauge_ones_count_from_ambient(tmp_path):
    text = "pressure_at_600_deg [bar(g)],pressure_at_600_deg_uncertainty [mbar]\n5,20\n"
    (point,) = fit_of(tmp_path, text).points
    value, uncertainty = point.measured["pressure_at_600_deg"]
    assert (value, uncertainty) == (pytest.approx(5e5 + 101325.0, abs=200.0), pytest.approx(2e3))


def test_a_point_may_have_no_indicator_beside_others_that_have_one(tmp_path):
    text = f"{HEAD},shaft_power [kW],shaft_power_uncertainty [kW]\n1000,p.csv,40,12,0.1\n2000,,,24,0.2\n"
    one, other = fit_of(tmp_path, text).points
    assert len(one.measured) == 3 and list(other.measured) == ["shaft_power"]


@pytest.mark.parametrize(
    ("points", "pressures", "what"),
    [
        ("indicator\np.csv\n", PRESSURES, "needs a column indicator_uncertainty"),
        ("indicator_uncertainty [bar]\n1\n", PRESSURES, "points.csv:1:1: indicator: needs a column indicator "),
        ("indicator,indicator_uncertainty\np.csv,1\n", PRESSURES, "points.csv:1:11: indicator_uncertainty: unit ''"),
        (f"{HEAD}\n1000,p.csv,0\n", PRESSURES, "indicator: 0 is out of range"),
        (f"{HEAD}\n1000,p.csv,1e-9\n", PRESSURES, "smaller than any measurement achieves"),
        ("indicator [bar],indicator_uncertainty [bar]\np.csv,1\n", PRESSURES, "write indicator without [bar]"),
        (f"{HEAD},{OF_600}\n1000,p.csv,40,6,0.1\n", "angle_deg,pressure_bar\n600,2\n", "pressure_at_600_deg, too"),
        (
            OF_600.replace("600", "0600") + "\n6,0.1\n",
            PRESSURES,
            "is not known (write pressure_at_600_deg_uncertainty)",
        ),
        (f"{HEAD}\n1000,p.csv,\n", PRESSURES, "points.csv:2:1: indicator: needs an uncertainty"),
        (f"{HEAD}\n1000,none.csv,40\n", PRESSURES, "'none.csv' is not a file"),
        (f"{HEAD}\n1000,p.csv,40\n", "volume_cm3,pressure_bar\n9,1\n8,2\n", "'p.csv' has volumes"),
        (f"{HEAD}\n1000,p.csv,40\n", "angle_deg,pressure_bar\n9,1\n9,2\n", "'p.csv' has 9 deg twice"),
        (f"{HEAD}\n1000,p.csv,40\n", "angle_deg,pressure_bar\n-9,1\n", "'p.csv' has -9 deg"),
        (f"{HEAD}\n1000,p.csv,40\n", "angle_deg,pressure_bar\n9,-1\n", "is not an absolute pressure"),
        (f"{HEAD}\n1000,p.csv,40\n", "angle_deg,pressure_bar\n" + "9,1\n" * 2001, "at most 2000"),
        (f"{HEAD.replace('indicator', 'indicator_of_gas_temperature')}\n1000,p.csv,40\n", PRESSURES, "is not known"),
        (f"{HEAD.replace('indicator', 'indicator_of_pressure')}\n1000,p.csv,40\n", PRESSURES, "is not known"),
        (f"{OF_PLENUM}\n1000,p.csv,40\n", PRESSURES, "is a curve of effects.plenums, which the scene lacks"),
        ("heat_at_600_deg [W],heat_at_600_deg_uncertainty [W]\n1,1\n", PRESSURES, "heat_at_600_deg: is not known"),
        (
            f"{HEAD}\n1000,p.csv,40\n",
            "angle_deg,pressure_bar\n9,1\n730,8\n740,8\n",
            "points.csv:2:1: line 2: 2 angles beyond the 720 deg of a chamber's life (from 730 deg on) (leave them "
            "out; angles count from where the chamber begins to grow)",
        ),
        (OF_600.replace("600", "721") + "\n6,0.1\n", PRESSURES, "1 angle beyond the 720 deg of a chamber's life"),
        ("pressure_at_600_deg [K],pressure_at_600_deg_uncertainty [bar]\n1,1\n", PRESSURES, "'K' is not one"),
    ],
)
def test_what_does_not_suit_a_fit_is_refused_in_its_line(tmp_path, points, pressures, what):
    with pytest.raises(SceneError) as refused:
        fit_of(tmp_path, points, pressures)
    assert what in str(refused.value)


def test_a_pressure_is_linear_between_samples_and_has_a_reason_outside_the_cycle():
    found = with_readings(result(), ["pressure_at_100.25_deg", "pressure_at_721_deg", "shaft_power"])
    assert found.performance == {"pressure_at_100.25_deg": 200250.0, "pressure_at_721_deg": None}
    assert found.why_not(["pressure_at_721_deg"]).endswith("721 deg is outside the cycle's 0 to 720 deg")


def test_any_declared_curve_is_read_and_what_has_no_value_there_has_a_reason():
    cycle = result().cycle
    gas = np.where(cycle["angle"] < 10.0, np.nan, 300.0 + cycle["angle"])
    names = [Reading(*each).figure for each in (("gas_temperature", 100.5), ("gas_temperature", 5.0), (PLENUM, 5.0))]
    found = with_readings(Result("ok", cycle=cycle | {"gas_temperature": gas}), names)
    assert found.performance == {names[0]: 400.5, names[1]: None, names[2]: None}
    assert found.why_not(names[1:2]).endswith("gas_temperature has no value at 5 deg")
    assert found.why_not(names[2:]).endswith(f"the cycle has no {PLENUM}")


def test_a_temperature_at_an_angle_is_a_column_with_its_unit(tmp_path):
    name = Reading("gas_temperature", 600.0).figure
    (point,) = fit_of(tmp_path, f"{name} [degC],{name}_uncertainty [K]\n80,2\n").points
    assert point.measured[name] == (pytest.approx(353.15), 2.0) and point.traced
    assert declared(name).long_name == "gas temperature at 600 degrees"


def test_a_file_may_hold_the_pressure_of_a_plenum(tmp_path):
    (point,) = fit_of(tmp_path, f"{OF_PLENUM}\n1000,p.csv,40\n", scene=with_plenum(tmp_path)).points
    assert {name: tuple(each) for name, each in point.measured.items()} == {
        Reading(PLENUM, 500.0).figure: (2e5, 4e3),
        Reading(PLENUM, 600.5).figure: (6e5, 4e3),
    }


def test_a_result_that_is_not_asked_for_pressures_has_none():
    assert with_readings(result(), ["shaft_power"]).performance == {}


def test_a_single_pressure_at_zero_is_beside_those_of_a_file(tmp_path):
    text = f"{HEAD},{OF_600.replace('600', '0')}\n1000,p.csv,40,1,0.1\n"
    (point,) = fit_of(tmp_path, text).points
    assert point.measured["pressure_at_0_deg"] == (1e5, 1e4) and point.measured["pressure_at_500_deg"] == (2e5, 2e3)


@pytest.mark.parametrize("angle", ["-0.0", "0.00001", "1e11"])
def test_a_fit_has_a_figure_at_any_angle_of_a_file(tmp_path, angle):
    (tmp_path / "p.csv").write_text(f"angle_deg,pressure_kPa\n{angle},200\n", "utf-8")
    (name,) = pressures_of("pressure", "p.csv", str(tmp_path), 1e3)
    assert declared(name).units == "Pa" and reading_of(name) == ("pressure", float(angle))


def test_future_measurements_are_of_no_indicator(tmp_path):
    fit = fit_of(tmp_path, f"{HEAD}\n1000,p.csv,40\n")
    (tmp_path / "further.csv").write_text("operation.speed [rpm],indicator_uncertainty [bar]\n1000,1\n", "utf-8")
    with pytest.raises((SceneError, UsageError), match="nothing is measured here yet"):
        points_of(fit, tmp_path / "further.csv", "--further", "points")


@pytest.mark.parametrize("angle", [0.0, 0.5, 360.0, 719.25])
def test_the_name_of_a_pressure_has_its_angle(angle):
    name = Reading("pressure", angle).figure
    assert reading_of(name) == ("pressure", angle) and declared(name).units == "Pa"
    assert reading_of("peak_pressure") is None


def test_a_fit_reads_the_cycle_of_its_points(tmp_path):
    fit = fit_of(tmp_path, f"{HEAD}\n3000,p.csv,40\n")
    asked = Objective(fit)
    figures = asked.solved(fit.points[0], {"effects.tip_leakage.gap": 40e-6}).performance
    tight = asked.solved(fit.points[0], {"effects.tip_leakage.gap": 10e-6}).performance
    names = list(fit.points[0].measured)
    assert 1.23e5 < figures[names[0]] < figures[names[1]] < 11.5e5
    # what leaks in from chambers ahead raises the pressure of the closed chamber
    assert all(figures[name] > tight[name] for name in names)


def compared(fit, count):
    point = fit.points[0]
    pairs = list(point.measured.items())[:count]
    return [ComparedMeasurement(point, name, each, each.value + 2.0 * each.uncertainty) for name, each in pairs]


def test_few_pressures_have_a_line_each_and_many_one_with_root_mean_squares(tmp_path):
    rows = "".join(f"{angle},200\n" for angle in range(500, 560, 5))
    fit = fit_of(tmp_path, f"{HEAD}\n1000,p.csv,40\n", f"angle_deg,pressure_kPa\n{rows}")
    few = lines_of_points(compared(fit, 3))
    assert len(few) == 5 and "pressure at 505 deg" in few[3]  # below two lines of heads
    many = [" ".join(line.split()) for line in lines_of_points(compared(fit, 12))]
    assert many[2:] == [
        "line 2 12 pressures, 500 … 555 deg 0.02 0.04 bar 2.00",
        "of pressures: root mean squares of fitted minus measured, and of the residuals",
    ]


def test_curves_are_told_and_drawn_apart(tmp_path):
    rows = "".join(f"{angle},200\n" for angle in range(500, 560, 5))
    both = HEAD + OF_PLENUM.removeprefix("operation.speed [rpm]")
    file = f"angle_deg,pressure_kPa\n{rows}"
    fit = fit_of(tmp_path, f"{both}\n1000,p.csv,40,p.csv,40\n", file, with_plenum(tmp_path))
    found = compared(fit, 24)
    lines = [" ".join(line.split()) for line in lines_of_points(found)]
    assert lines[2:] == [
        "line 2 12 pressures, 500 … 555 deg 0.02 0.04 bar 2.00",
        "line 2 12 discharge plenum pressures, 500 … 555 deg 0.04 0.08 bar 2.00",
        "of pressures and discharge plenum pressures: root mean squares of fitted minus measured, and of the residuals",
    ]
    plans = pictures(SimpleNamespace(fit=fit, compared=found))
    assert list(plans) == ["pressures", "discharge_plenum_pressures"]
    assert plans["discharge_plenum_pressures"]().axes[0].get_ylabel() == "discharge plenum pressure (bar)"


def test_a_posterior_refuses_pressures(tmp_path):
    with pytest.raises(UsageError, match="values of one cycle miss the model together"):
        refuse_curves(fit_of(tmp_path, f"{HEAD}\n1000,p.csv,40\n"))


def drawn(tmp_path, number):
    """Return the pictures of a fit of `number` points with two pressures each, the last one predicted alone."""
    rows = "".join(f"p{i},{'fit' if i < number - 1 else 'check'},{1000 + i},p.csv,40\n" for i in range(number))
    fit = fit_of(tmp_path, f"name,use,{HEAD}\n{rows}")
    found = [
        ComparedMeasurement(point, name, each, each.value + 1e4)
        for point in fit.points
        for name, each in point.measured.items()
    ]
    return pictures(SimpleNamespace(fit=fit, compared=found))


def test_pressures_are_drawn_beside_the_fitted_ones_and_predicted_points_are_told(tmp_path):
    plans = drawn(tmp_path, 2)
    assert list(plans) == ["pressures"]  # no figure beside them has a residual to draw
    figure = plans["pressures"]()
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == ["p0", "p1 *"]
    line = next(each for each in figure.axes[0].get_lines() if each.get_label() == "fitted")
    np.testing.assert_allclose(line.get_xdata(), [500.0, 600.5])
    np.testing.assert_allclose(line.get_ydata(), [2.1, 6.1])
    assert any("*: not fitted, only predicted" in text.get_text() for text in figure.texts)


def test_more_points_than_panels_are_counted(tmp_path):
    figure = drawn(tmp_path, 14)["pressures"]()
    assert sum(bool(axes.get_title()) for axes in figure.axes) == 12
    assert any("2 more points" in text.get_text() for text in figure.texts)
