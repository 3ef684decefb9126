"""Histories: sides of a jump, reading, and exact combination of cubics on different steps."""

from itertools import pairwise

import numpy as np
import pytest
from each_row import each_row

from screwsim.numerics.history import add_history, locate, read, states_at

CUBICS = np.array([[1.0, -2.0, 0.5, 0.3], [4.0, 0.7, -1.1, 0.2]])  # of two states, constant term first


def cubic(phi):
    return np.array([np.polyval(c[::-1], phi) for c in CUBICS])


def dense_of(times):
    """Return the dense form of the cubics on steps: y0, y1, c3, c4 of y0(1−θ) + θ(y1 + (1−θ)(c3 + θ c4))."""
    pieces = []
    for a, b in pairwise(times):
        h = b - a
        y0, y1 = cubic(a), cubic(b)
        slope0 = h * np.array([np.polyval(np.polyder(c[::-1]), a) for c in CUBICS])
        slope1 = h * np.array([np.polyval(np.polyder(c[::-1]), b) for c in CUBICS])
        c3 = slope0 - y1 + y0  # y'(0) = −y0 + y1 + c3;  y'(1) = y1 − y0 − c3 − c4
        pieces.append((y0, y1, c3, y1 - y0 - c3 - slope1))
    return np.array(pieces)


def value(phi, times, dense, step):
    out = np.empty(2)
    read(phi, times, dense, step, out)
    return out


TIMES = np.array([0.0, 0.7, 1.0, 2.5, 3.0])
OTHERS = np.array([0.0, 0.2, 1.4, 1.6, 3.0])


def test_a_cubic_is_read_back_exactly():
    dense = dense_of(TIMES)
    for phi in np.linspace(0.0, 3.0, 31):
        step = locate(phi, phi + 0.1 if phi < 3 else 2.9, TIMES, 4, 0)
        np.testing.assert_allclose(value(phi, TIMES, dense, step), cubic(phi), rtol=1e-13)


def test_combining_cubics_on_different_steps_is_exact():
    out = 0.25 * dense_of(TIMES)
    add_history(TIMES, 4, OTHERS, dense_of(OTHERS), 4, 0.75, out)
    # the pieces of both are the same cubics, so any weights of sum 1 must give them back; rounding through 1/3 and 13.5
    np.testing.assert_allclose(out, dense_of(TIMES), atol=1e-12)


def test_a_jump_at_a_step_keeps_its_two_sides_when_combined():
    jumped = dense_of(TIMES)
    jumped[2:, :2] += 10.0  # both values of all later steps: a constant on top, so the curvature stays
    out = np.zeros_like(jumped)
    add_history(TIMES, 4, TIMES, jumped, 4, 1.0, out)
    np.testing.assert_allclose(out, jumped, atol=1e-12)


@pytest.mark.parametrize(("middle", "step"), [(0.9, 1), (1.1, 2)])
def test_at_a_boundary_the_side_of_the_segment_is_chosen(middle, step):
    assert locate(1.0, middle, TIMES, 4, 0) == step


@each_row("hint", range(5))
def test_the_step_found_does_not_depend_on_the_hint(hint):
    found = [locate(phi, phi + 1e-3, TIMES, 4, hint) for phi in (0.0, 0.3, 0.8, 2.0, 2.9)]
    assert found == [0, 0, 1, 2, 3]


def test_states_are_read_at_increasing_angles():
    out, angles = np.empty((3, 2)), np.array([0.1, 1.0, 2.7])
    states_at(angles, TIMES, dense_of(TIMES), 4, out)
    np.testing.assert_allclose(out, [cubic(phi) for phi in angles], rtol=1e-13)
