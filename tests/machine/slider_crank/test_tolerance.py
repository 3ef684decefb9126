"""Tolerances of a slider-crank: three transfer functions, the printed table, deviations, ISO 286."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from each_row import each_row

from screwsim.inputs.faults import UsageError
from screwsim.machine.slider_crank import kinematics
from screwsim.machine.slider_crank import tolerance as law

DATA = Path(__file__).parents[3] / "validation" / "slider_crank"
NOMINAL = law.links_of(4.4, 12.0, 4.5, 0.015)
TURN = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)


def rows(name):
    with (DATA / name).open(encoding="utf-8") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def angle(text):
    over, _, under = text.partition("/")
    return math.pi * float(over) / float(under or 1)


TABLE = [(angle(row["angle_over_pi"]), row["value"]) for row in rows("transfer_function.csv")]
ALPHA = np.array([alpha for alpha, _ in TABLE])
PRINTED = np.array([float(value) for _, value in TABLE])
DEVIATIONS = rows("deviations.csv")


def test_right_function_is_the_slope_of_the_position():
    found = [kinematics.slope(alpha, *NOMINAL) for alpha in ALPHA]
    np.testing.assert_allclose(law.right(ALPHA, NOMINAL), found, atol=1e-16)


def test_links_are_those_of_the_source():
    assert NOMINAL == pytest.approx((0.0916666667, 0.4125, 0.015), rel=1e-9)


def test_there_are_32_printed_values_and_10_deviations_with_a_limit():
    assert (len(TABLE), len(DEVIATIONS)) == (32, 11)


@each_row(("alpha", "text"), TABLE)
def test_printed_value_is_that_of_the_third_function(alpha, text):
    half = 0.5 * 10.0 ** -len(text.partition(".")[2])
    assert abs(law.tabulated(np.array(alpha), NOMINAL) - float(text)) <= half


def test_printed_table_is_neither_the_derivative_nor_the_printed_formula():
    half = 0.0005
    for function, agreeing in ((law.right, 0), (law.printed, 2)):  # −π and π, where the sine is zero
        assert np.sum(np.abs(function(ALPHA, NOMINAL) - PRINTED) <= half) == agreeing


def test_second_term_of_the_printed_formula_has_another_dimension():
    """Lengths in mm must give mm: the derivative does, the printed formula does not."""
    large = law.Links(*(1e3 * length for length in NOMINAL))
    np.testing.assert_allclose(law.right(ALPHA, large), 1e3 * law.right(ALPHA, NOMINAL), rtol=1e-12)
    assert np.max(np.abs(law.printed(ALPHA, large) - 1e3 * law.printed(ALPHA, NOMINAL))) > 10.0


def test_three_functions_agree_where_they_must():
    """At ± π/2 the second term is zero; the signs of the first term are opposite."""
    quarter = np.array([math.pi / 2, -math.pi / 2])
    np.testing.assert_allclose(law.right(quarter, NOMINAL), law.printed(quarter, NOMINAL), atol=1e-15)
    np.testing.assert_allclose(law.tabulated(quarter, NOMINAL), -law.printed(quarter, NOMINAL), atol=1e-15)


@each_row("row", DEVIATIONS[:-1], ids=lambda row: f"{row['crank_percent']},{row['rod_percent']}")
def test_printed_deviations_are_of_our_size(row):
    """The source's way is not known: from its printed values and its function ours lie within a quarter of its own."""
    changed = NOMINAL.scaled(*(1.0 + 0.01 * float(row[key]) for key in ("crank_percent", "rod_percent")))
    found = law.deviation(law.tabulated, ALPHA, NOMINAL, changed, PRINTED)
    assert found == pytest.approx(float(row["deviation"]), rel=0.25)


def test_limit_of_the_source_lies_between_plus_and_minus_5_percent():
    low, high = sorted(law.spread(s * law.tabulated(ALPHA, NOMINAL) - PRINTED) for s in (1.05, 0.95))
    assert low < float(DEVIATIONS[-1]["deviation"]) < high


def test_deviation_of_nothing_is_nothing_and_of_a_shift_too():
    assert law.deviation(law.right, TURN, NOMINAL, NOMINAL) == 0.0
    assert law.spread(np.full(7, 3.0)) == 0.0


def test_scaling_the_whole_mechanism_scales_the_law():
    """All lengths 5 % larger: the law is 5 % larger, its deviation is the plane's."""
    larger = law.Links(*(1.05 * length for length in NOMINAL))
    found = law.deviation(law.right, TURN, NOMINAL, larger)
    assert found == pytest.approx(law.plane(law.right, TURN, NOMINAL), rel=1e-12)


def test_without_offset_crank_and_rod_share_the_scale():
    central = NOMINAL._replace(offset=0.0)
    both = law.deviation(law.right, TURN, central, central.scaled(1.01, 1.01))
    assert both == pytest.approx(law.plane(law.right, TURN, central, 0.01), rel=1e-12)


def test_deviation_of_a_long_central_rod_is_that_of_the_harmonic():
    """σ = r (r/l)/(4 √2) · δl/l for small errors: the term r²/(2 l) sin 2α."""
    links = law.Links(0.05, 1.0, 0.0)
    found = law.deviation(law.right, TURN, links, links.scaled(1.0, 1.0001))
    assert found == pytest.approx(0.05**2 / 2.0 / math.sqrt(2.0) * 1e-4, rel=2e-3)  # next term (r/l)²


def test_surface_is_zero_in_its_middle_and_largest_at_a_corner():
    errors = np.linspace(-0.05, 0.05, 11)
    found = law.surface(law.right, TURN, NOMINAL, errors)
    assert found[5, 5] == 0.0
    assert found.max() == max(found[0, 0], found[0, -1], found[-1, 0], found[-1, -1])
    assert found[6, 5] == pytest.approx(law.deviation(law.right, TURN, NOMINAL, NOMINAL.scaled(1.01, 1.0)))


def test_rod_weighs_four_times_as_much_in_the_tables_function():
    weight = {
        name: law.deviation(f, TURN, NOMINAL, NOMINAL.scaled(1.0, 1.01))
        / law.deviation(f, TURN, NOMINAL, NOMINAL.scaled(1.01, 1.0))
        for name, f in law.FUNCTIONS.items()
    }
    assert weight["tabulated"] > 4.0 * weight["right"]
    assert weight["tabulated"] == pytest.approx(weight["printed"], rel=1e-12)


@each_row(
    ("size", "number", "table"),
    [
        *((0.1, 6, 22), (0.1, 7, 35), (0.1, 11, 220), (0.1, 15, 1400)),
        *((0.45, 7, 63), (0.45, 12, 630), (0.45, 16, 4000), (0.7, 7, 80)),
        *((0.02, 7, 21), (0.02, 9, 52), (0.05, 7, 25), (0.002, 8, 14)),
    ],
)
def test_tolerances_are_those_of_iso_286(size, number, table):
    """Values [µm] of the standard's table, which rounds the formula."""
    assert 1e6 * law.tolerance(size, number) == pytest.approx(table, rel=0.04)


def test_five_grades_are_a_factor_of_ten():
    for number in range(6, 14):
        assert law.tolerance(0.1, number + 5) == pytest.approx(10.0 * law.tolerance(0.1, number), rel=1e-12)


@pytest.mark.parametrize(("size", "number", "words"), [(0.1, 4, "choose IT5"), (5.0, 7, "choose a length")])
def test_no_tolerance_without_a_remedy(size, number, words):
    with pytest.raises(UsageError, match=words):
        law.tolerance(size, number)


def test_coarsest_grade_is_kept_and_the_next_is_not():
    found = law.coarsest(law.right, TURN, NOMINAL, 0.01)
    assert found is not None
    assert found.error <= 0.01 < law.grade(law.right, TURN, NOMINAL, found.crank + 1, found.rod + 1).error
    assert law.coarsest(law.right, TURN, NOMINAL, 1e-9) is None
