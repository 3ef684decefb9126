"""Packed curves: the shape-preserving spline of scipy, cubics of given slopes, what read_curve says of bad files."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from screwsim.inputs.faults import UsageError
from screwsim.numerics.spline import differences, pack_curve, read_curve, side_slopes, table_slope, table_value

ROUNDING = 1e-13


@pytest.fixture(scope="module")
def curve():
    """Return (x, y, TAB, index): an uneven curve with a plateau, packed behind another one."""
    x = np.array([0.0, 0.3, 0.4, 1.7, 2.0, 4.5, 6.0])
    y = np.array([0.0, 2.0, 2.0, 5.0, 1.0, 1.5, 0.0])
    before = pack_curve(np.array([0.0, 1.0, 2.0]), np.array([9.0, 8.0, 7.0]))
    return x, y, np.concatenate([before, pack_curve(x, y)]), float(len(before))


def test_values_are_those_of_pchip(curve):
    x, y, TAB, at = curve
    grid = np.linspace(x[0], x[-1], 500)
    np.testing.assert_allclose([table_value(a, TAB, at) for a in grid], PchipInterpolator(x, y)(grid), atol=ROUNDING)


def test_slopes_are_the_derivative_of_the_values(curve):
    x, y, TAB, at = curve
    grid = np.linspace(x[0], x[-1], 500)
    exact = PchipInterpolator(x, y).derivative()(grid)
    np.testing.assert_allclose([table_slope(a, TAB, at) for a in grid], exact, atol=10 * ROUNDING)


def test_the_curve_goes_through_its_points(curve):
    x, y, TAB, at = curve
    np.testing.assert_allclose([table_value(a, TAB, at) for a in x], y, atol=ROUNDING)


def test_the_slope_is_continuous_at_the_points(curve):
    x, _, TAB, at = curve
    jumps = [table_slope(a + 1e-12, TAB, at) - table_slope(a - 1e-12, TAB, at) for a in x[1:-1]]
    assert np.max(np.abs(jumps)) < 1e-8  # second derivatives reach 1e3, times 2e-12


def test_the_curve_is_constant_outside(curve):
    x, y, TAB, at = curve
    assert (table_value(x[0] - 1, TAB, at), table_value(x[-1] + 1, TAB, at)) == pytest.approx(
        (y[0], y[-1]), abs=ROUNDING
    )


def test_the_slope_is_zero_outside(curve):
    x, _, TAB, at = curve
    assert (table_slope(x[0] - 1, TAB, at), table_slope(x[-1] + 1, TAB, at)) == (0.0, 0.0)


def test_no_value_leaves_the_range_of_its_two_points(curve):
    x, y, TAB, at = curve
    for i in range(len(x) - 1):
        inside = [table_value(a, TAB, at) for a in np.linspace(x[i], x[i + 1], 50)]
        assert min(y[i : i + 2]) - ROUNDING <= min(inside)
        assert max(inside) <= max(y[i : i + 2]) + ROUNDING


# ---- reading ----


def file(tmp_path, text):
    path = tmp_path / "curve.csv"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_curve_is_read_in_radians(tmp_path):
    angles, values = read_curve(file(tmp_path, "# made by hand\nangle_deg,area_m2\n0,0\n180,1e-3\n360,0\n"), "area_m2")
    np.testing.assert_allclose(angles, [0.0, np.pi, 2 * np.pi])
    np.testing.assert_array_equal(values, [0.0, 1e-3, 0.0])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("angle,area\n0,0\n1,1\n2,0\n", "needs the columns angle_deg and area_m2"),
        ("", "needs the columns"),
        ("angle_deg,area_m2\n0,0\n1,x\n2,0\n", "line 3: '1', 'x' are not two numbers"),
        ("angle_deg,area_m2\n0,0\n1\n2,0\n", "line 3: has 1 cell, but the first line has 2"),
        ("angle_deg,area_m2\n0,0\n1,-1\n2,0\n", "not negative"),
        ("angle_deg,area_m2\n0,0\n1,nan\n2,0\n", "finite"),
        ("angle_deg,area_m2\n0,0\n2,1\n1,0\n", "angles must increase"),
        ("angle_deg,area_m2\n0,0\n1,1\n1,0\n", "angles must increase"),
        ("angle_deg,area_m2\n0,0\n1,1\n", "at least 3"),
    ],
)
def test_a_bad_curve_is_refused_with_its_fault(tmp_path, text, said):
    with pytest.raises(UsageError, match=said):
        read_curve(file(tmp_path, text), "area_m2")


def test_a_missing_file_is_refused_in_one_line(tmp_path):
    with pytest.raises(UsageError, match="cannot be read") as caught:
        read_curve(str(tmp_path / "none.csv"), "area_m2")
    assert "\n" not in str(caught.value)


KINK = 0.4


def bent(x):
    """Return a curve of two parabolas that meet at a kink, and its derivatives on the left and on the right of x."""
    left, right = 1.0 + 2.0 * x - 3.0 * x * x, 1.0 + 2.0 * KINK - 3.0 * KINK**2 + 5.0 * (x - KINK) + (x - KINK) ** 2
    before, after = 2.0 - 6.0 * x, 5.0 + 2.0 * (x - KINK)
    return np.where(x < KINK, left, right), np.where(x <= KINK, before, after), np.where(x < KINK, before, after)


def test_differences_of_parabolas_are_exact_on_both_sides_of_a_kink():
    x = np.sort(np.append(np.random.default_rng(3).random(30), KINK))
    y, left, right = bent(x)
    assert differences(x, y, [KINK]) == pytest.approx(np.column_stack([right[:-1], left[1:]]), abs=1e-9)


def test_cubics_with_given_slopes_are_exact_for_cubics_and_keep_their_kinks():
    x = np.sort(np.append(np.random.default_rng(4).random(30), KINK))
    y, left, right = bent(x)
    packed = pack_curve(x, y, np.column_stack([right[:-1], left[1:]]))
    at = np.linspace(x[0], x[-1], 333)
    assert [table_value(a, packed, 0) for a in at] == pytest.approx(bent(at)[0], rel=1e-12)
    inside = at[(np.abs(at - KINK) > 1e-9) & (at < x[-1])]
    assert [table_slope(a, packed, 0) for a in inside] == pytest.approx(bent(inside)[1], rel=1e-9)


def test_limited_slopes_make_no_new_extremes():
    x = np.linspace(0.0, 1.0, 21)
    y = np.where(x < 0.5, 0.0, 1.0) + 0.1 * x
    packed = pack_curve(x, y, side_slopes(x, y, []))
    values = [table_value(a, packed, 0) for a in np.linspace(0.0, 1.0, 2001)]
    assert np.all(np.diff(values) > 0.0)
