"""Numbers that a cycle makes: how they are compared, and mixed in coordinates."""

import numpy as np
import pytest

from screwsim.numerics.feedback_unknowns import FeedbackUnknown, FeedbackUnknowns

ENTRIES = FeedbackUnknowns(
    [
        FeedbackUnknown("h"),
        FeedbackUnknown("x", floor=1e-4),
        FeedbackUnknown("T", of="x"),
        FeedbackUnknown("shift", scale=0.5),
    ]
)


def test_changes_are_relative_or_over_the_scale():
    old = np.array([100.0, 1.0, 300.0, -1.0])
    assert ENTRIES.change(old * [1.01, 1.0, 1.0, 1.0], old) == pytest.approx(0.01)
    assert ENTRIES.change(old + np.array([0.0, 0.0, 0.0, 0.25]), old) == pytest.approx(0.5)


def test_the_temperature_of_next_to_nothing_does_not_count():
    old = np.array([100.0, 1e-5, 300.0, 0.0])
    assert ENTRIES.change(np.array([100.0, 1e-5, 600.0, 0.0]), old) == 0.0
    assert ENTRIES.change(np.array([100.0, 1e-3, 600.0, 0.0]), old) > 0.5


@pytest.mark.parametrize("ratio", [1e-5, 0.3])
def test_coordinates_lead_back(ratio):
    values = np.array([4e5, ratio, 310.0, -3.0])
    assert ENTRIES.values(ENTRIES.coordinates(values), values) == pytest.approx(values)


def test_amounts_too_small_to_count_are_the_same_point():
    one, other = (
        ENTRIES.coordinates(np.array([1.0, 1e-5, 300.0, 0.0])),
        ENTRIES.coordinates(np.array([1.0, 1e-9, 9.0, 0])),
    )
    assert np.array_equal(one, other)


def test_only_what_goes_in_its_logarithm_must_be_positive():
    found = ENTRIES.possible(np.array([-1.0, 0.0, 300.0, -2.0]))
    assert (found[:3] > 0.0).all()
    assert found[3] == -2.0


def test_a_number_above_its_least_changes_by_what_it_is_above():
    entries = FeedbackUnknowns([FeedbackUnknown("offset", shift=1.0), FeedbackUnknown("swing", scale=1.0)])
    old = np.array([-0.99, 0.5])
    assert entries.change(np.array([-0.98, 0.5]), old) == pytest.approx(1.0)
    assert entries.values(entries.coordinates(old), old) == pytest.approx(old)
    assert entries.possible(np.array([-1.5, 0.5]))[0] >= -1.0
