"""Pressures that were measured beside a computed cycle: what is read, what is said, where the points lie."""

import numpy as np
import pytest

from screwsim.figures.indicated import Indicated, IndicatedVolumes, read_indicated
from screwsim.inputs.faults import UsageError
from screwsim.report.indicated import (
    at_angles,
    check_angles,
    check_volumes,
    deviation_in_words,
    draw_over_angle,
    draw_over_volume,
    shift_in_words,
)
from screwsim.report.trace import Trace

ANGLE = np.linspace(0.0, 720.0, 721)
TRACE = Trace("", ANGLE, {"pressure": 1e5 + 1e3 * ANGLE, "volume": 1e-6 * ANGLE}, {}, {})


def written(tmp_path, text):
    path = tmp_path / "p.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(("unit", "number"), [("bar", 2.0), ("kPa", 200.0), ("MPa", 0.2), ("Pa", 2e5), ("mbar", 2000)])
def test_pressures_are_read_in_the_unit_of_their_column_with_the_mark_of_excel(tmp_path, unit, number):
    found = read_indicated(written(tmp_path, f"\ufeffangle_deg,pressure_{unit}\n100,{number}\n200,{number}\n"))
    assert found.angle.tolist() == [100.0, 200.0]
    assert found.pressure == pytest.approx([2e5, 2e5], rel=1e-15)


def test_heads_may_have_their_unit_in_brackets(tmp_path):
    plain, brackets = (
        read_indicated(written(tmp_path, f"{head}\n100,2\n200,3\n"))
        for head in ("volume_cm3,pressure_kPa", "volume [cm³],pressure [kPa]")
    )
    assert isinstance(brackets, IndicatedVolumes)
    np.testing.assert_array_equal(plain, brackets)
    np.testing.assert_array_equal(read_indicated(written(tmp_path, "angle [°],pressure [bar]\n1,2\n")).angle, [1.0])


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("angle_deg\tpressure_bar\n1\t1,5\n", "is separated by tabs"),
        ("angle_deg,p\n1,2\n", r"needs angle_deg or one volume, and one pressure \(found: angle_deg, p; write"),
        ("angle_deg,pressure_bar,pressure_Pa\n1,2,3\n", "needs angle_deg or one volume, and one pressure"),
        ("volume_cm3,volume_l,pressure_bar\n1,2,3\n", "needs angle_deg or one volume, and one pressure"),
        ("angle_deg,pressure_bar\n", "has no points"),
        ("angle_deg,pressure_bar\n1,x\n", "line 2: 1, x are not two numbers"),
        ("angle_deg,pressure_bar\n1,-0.1\n", "line 2: -0.1 bar is not an absolute pressure"),
        ("angle_deg,pressure_bar\nnan,1\n", "line 2"),
        ("angle_deg,pressure_bar\n1,5,2\n", "write decimal points, not decimal commas"),
    ],
)
def test_what_cannot_be_read_is_told_in_one_line(tmp_path, text, what):
    with pytest.raises(UsageError, match=what):
        read_indicated(written(tmp_path, text))


def test_angles_are_taken_where_volumes_stand_beside_them(tmp_path):
    found = read_indicated(written(tmp_path, "angle_deg,volume_cm3,pressure_bar\n100,5,1\n200,9,2\n"))
    assert isinstance(found, Indicated) and found.angle.tolist() == [100.0, 200.0]


def test_what_is_said_is_the_difference_at_the_points():
    points = Indicated(np.array([100.0, 300.0]), np.array([2.0e5, 3.7e5]))  # the cycle has 2 and 4 bar there
    assert deviation_in_words(points, TRACE) == (
        "computed minus measured at 2 points: mean +0.15 bar, root mean square 0.212 bar, largest +0.3 bar at 300 deg"
    )


CURVED = Trace("", ANGLE, {"pressure": 1e5 * (1.0 + (ANGLE / 240.0) ** 3), "volume": 1e-6 * ANGLE}, {}, {})
PLACES = np.linspace(150.0, 650.0, 51)


def test_zeros_of_angle_and_transducer_are_found_from_points_that_they_moved():
    pressure = np.interp(PLACES, ANGLE, CURVED.values["pressure"]) + 0.2e5
    words = shift_in_words(Indicated(PLACES + 3.0, pressure), CURVED)
    assert words.startswith("points moved by -3 deg and -0.2 bar would lie within ")


def test_no_zeros_are_told_of_points_that_agree_or_scatter():
    pressure = np.interp(PLACES, ANGLE, CURVED.values["pressure"])
    assert shift_in_words(Indicated(PLACES, pressure), CURVED) == ""
    scattered = pressure + 1e4 * np.random.default_rng(1).normal(size=len(PLACES))
    assert shift_in_words(Indicated(PLACES, scattered), CURVED) == ""
    assert shift_in_words(Indicated(PLACES[:3], pressure[:3] + 1e5), CURVED) == ""


def test_angles_of_another_zero_are_refused():
    with pytest.raises(UsageError, match=r"^1 of the measured angles, as -30 deg, lie outside the cycle"):
        check_angles(Indicated(np.array([-30.0, 10.0]), np.array([1e5, 1e5])), TRACE)
    check_angles(Indicated(np.array([-3.0, 723.0]), np.array([1e5, 1e5])), TRACE)


def test_points_over_the_volume_stand_on_the_side_on_which_it_grows_or_falls(tmp_path):
    """A chamber that grows to 360 cm³ at 360° and falls again: 100 cm³ is passed at 100° and at 620°."""
    volume = 1e-6 * np.minimum(ANGLE, 720.0 - ANGLE)
    trace = TRACE._replace(values={"pressure": TRACE.values["pressure"], "volume": volume})
    rows = "100,1\n300,1\n360,1.2\n300,1.5\n100,4\n"
    read = read_indicated(written(tmp_path, f"volume_cm3,pressure_bar\n{rows}"))
    assert at_angles(read, trace).angle == pytest.approx([100.0, 300.0, 360.0, 420.0, 620.0], rel=1e-12)
    with pytest.raises(UsageError, match="as 400 cm3, are not of the chamber: above its largest, 360 cm3"):
        at_angles(read._replace(volume=np.array([400e-6, 1e-6, 2e-6, 3e-6, 4e-6])), trace)
    with pytest.raises(UsageError, match="are all the same"):
        at_angles(read_indicated(written(tmp_path, "volume_l,pressure_kPa\n0.1,200\n")), trace)


def test_a_diagram_over_the_swept_volume_alone_is_refused():
    """Of a cylinder with 10 cm³ of dead volume; to within 2 %, volumes of its own are taken."""
    volume = 1e-6 * (10.0 + np.minimum(ANGLE, 720.0 - ANGLE))
    trace = TRACE._replace(values={"pressure": TRACE.values["pressure"], "volume": volume})
    own = IndicatedVolumes(np.array([9.9e-6, 200e-6, 370e-6]), np.full(3, 1e5))
    assert at_angles(own, trace).angle == pytest.approx([0.0, 190.0, 360.0], abs=1e-9)
    with pytest.raises(UsageError, match=r"^2 of .*, as 0 cm3, .*below its least, 10 cm3 \(add its dead volume\)$"):
        at_angles(own._replace(volume=np.array([0.0, 5e-6, 360e-6])), trace)


def test_grooves_are_named_of_a_screw_alone():
    points = IndicatedVolumes(np.array([1e-6, 2e-3]), np.full(2, 1e5))
    with pytest.raises(UsageError, match=r"\(give those of one\)$"):
        check_volumes(points, TRACE)
    with pytest.raises(UsageError, match="male and female groove together"):
        check_volumes(points, TRACE._replace(male_lobes=5.0))


def test_points_stand_at_their_pressure_angle_and_computed_volume_and_none_is_cut_off():
    pyplot = pytest.importorskip("matplotlib.pyplot")
    points = Indicated(np.array([100.0, 300.0]), np.array([2e5, 30e5]))
    figure, both = pyplot.subplots(1, 2)
    draw_over_angle(both[0], points)
    draw_over_volume(both[1], points, TRACE)
    for axes, x in zip(both, ([100.0, 300.0], [100.0, 300.0]), strict=True):  # degrees, and cm³ of 1 cm³ a degree
        (line,) = axes.get_lines()
        assert line.get_xdata() == pytest.approx(x) and line.get_ydata() == pytest.approx([2.0, 30.0])
        assert axes.get_ylim()[1] > 30.0 and axes.get_legend() is not None
    pyplot.close(figure)
