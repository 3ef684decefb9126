"""Broyden's update reproduces the change along a step, and is the least one that does."""

import numpy as np
import pytest

from screwsim.numerics import broyden

JACOBIAN, STEP, ACROSS = np.array([[1.0, 2.0], [0.0, -3.0]]), np.array([0.5, 0.5]), np.array([1.0, -1.0])


def test_an_update_gives_the_change_it_learns_and_keeps_slopes_across_it():
    change = np.array([4.0, 7.0])
    learnt = broyden.updated(JACOBIAN, change, STEP)
    assert learnt @ STEP == pytest.approx(change)
    assert learnt @ ACROSS == pytest.approx(JACOBIAN @ ACROSS)


def test_a_row_is_updated_as_in_its_jacobian():
    change = np.array([4.0, 7.0])
    whole = broyden.updated(JACOBIAN, change, STEP, 0.3)
    for row, slope, value in zip(whole, JACOBIAN, change.tolist(), strict=True):
        assert broyden.updated(slope, value, STEP, 0.3) == pytest.approx(row)


def test_of_a_change_that_is_half_trusted_half_of_what_was_missed_is_learnt():
    change = np.array([4.0, 7.0])
    learnt = broyden.updated(JACOBIAN, change, STEP, 0.5)
    assert learnt @ STEP == pytest.approx(0.5 * (change + JACOBIAN @ STEP))
