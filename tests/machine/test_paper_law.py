"""The paper's laws (16)–(18): one C1 bump, its symmetry, its integral, and the misprint of (18)."""

from math import pi

import numpy as np
import pytest
from each_row import each_row
from scipy.integrate import quad

from screwsim.machine import paper_law as law

TURN, DEG = 2 * pi, pi / 180
CS = (0.05, 1 / 6, 0.5, 0.9, 1.0)
NEAR = 1e-9


@each_row("c", CS)
def test_bump_is_continuous_at_its_joints(c):
    for x in {0.0, c, 1.0, 2.0 - c, 2.0}:
        assert law.bump(x - NEAR, c) == pytest.approx(law.bump(x + NEAR, c), abs=1e-8)  # slope at most 2, times 2 NEAR


@each_row("c", CS)
def test_slope_of_the_bump_is_continuous_inside(c):
    """C1 where the branches meet, the middle of c = 1 excepted."""
    for x in {c, 2.0 - c} if c < 1.0 else set():
        assert law.bump_slope(x - NEAR, c) == pytest.approx(law.bump_slope(x + NEAR, c), abs=1e-6)  # curvature ≤ 40


@each_row("c", CS)
def test_bump_is_symmetric(c):
    x = np.linspace(0.0, 1.0, 101)
    np.testing.assert_allclose([law.bump(a, c) for a in x], [law.bump(2 - a, c) for a in x], atol=1e-13)


@each_row("c", CS)
def test_bump_is_one_at_its_middle_and_nowhere_more(c):
    assert law.bump(1.0, c) == pytest.approx(1.0, abs=1e-15)
    assert max(law.bump(x, c) for x in np.linspace(0.0, 2.0, 2001)) <= 1.0 + 1e-15


@pytest.mark.parametrize("x", [-1.0, 0.0, 2.0, 3.0])
def test_bump_is_zero_outside(x):
    assert (law.bump(x, 0.5), law.bump_slope(x, 0.5)) == (0.0, 0.0)


def test_bump_without_middle_branch_is_two_parabolas():
    x = np.linspace(0.01, 1.99, 199)
    np.testing.assert_allclose([law.bump(a, 1.0) for a in x], np.minimum(x, 2 - x) ** 2, rtol=1e-13)


@each_row("c", CS)
def test_slope_is_the_derivative_of_the_bump(c):
    # points off the joints, where a central difference is exact for parabolas: rounding over the step is left
    for x in np.linspace(0.0123, 1.9877, 41):
        difference = (law.bump(x + 1e-6, c) - law.bump(x - 1e-6, c)) / 2e-6
        if min(abs(x - joint) for joint in (c, 1.0, 2 - c)) > 2e-6:
            assert law.bump_slope(x, c) == pytest.approx(difference, abs=1e-8)


def test_volume_is_the_integral_of_its_slope():
    V_max, V_min, phi_A = 6e-4, 6e-8, 60 * DEG
    breakpoints = [0.0, phi_A, 300 * DEG]
    parts = [
        quad(law.volume_slope, a, b, args=(V_max, phi_A), epsrel=1e-12)[0]
        for a, b in zip(breakpoints, [*breakpoints[1:], TURN], strict=True)
    ]
    assert V_min + sum(parts) == pytest.approx(law.volume(TURN, V_max, V_min, phi_A), rel=1e-12)


def test_volume_is_dead_volume_at_both_ends_and_all_in_the_middle():
    volumes = [law.volume(phi, 6e-4, 6e-8, 1.0) for phi in (0.0, TURN, 2 * TURN)]
    assert volumes == pytest.approx([6e-8, 6e-4 + 6e-8, 6e-8], rel=1e-12)


def test_suction_port_is_shut_from_one_turn_on():
    assert [law.suction_area(phi, 1e-3, 1.0) for phi in (TURN, 1.5 * TURN, 2 * TURN)] == [0.0, 0.0, 0.0]


@each_row("phi", [0.0, 300.0, 599.999, 600.0, 720.0])
def test_discharge_port_is_shut_before_it_opens_and_at_the_end(phi):
    assert law.discharge_area(phi * DEG, 1e-3, 600 * DEG, 640 * DEG) == pytest.approx(0.0, abs=1e-18)


@pytest.mark.parametrize(("opens", "phi_C"), [(600, 640), (570, 600), (480, 481), (650, 685)])
def test_corrected_discharge_area_is_continuous_at_phi_C(opens, phi_C):
    below, above = (law.discharge_area((phi_C + s) * DEG, 1.0, opens * DEG, phi_C * DEG) for s in (-1e-9, 1e-9))
    assert below == pytest.approx(above, abs=1e-8)  # slope at most 2/degree, times 2e-9 degrees


def printed_middle_branch(phi, opens, phi_B):
    """Return the middle branch of (18) as printed, degrees: the factor (720+φ_dis)/(720+φ_dis), and φ_B."""
    middle = (opens + 720.0) / 2.0
    factor = (720.0 + opens) / (720.0 + opens)
    return 1.0 + factor * (phi / middle - 1.0) ** 2 / (phi_B / middle - 1.0)


@pytest.mark.parametrize("angle", ["phi_B = phi_C", "phi_B = 60"])
def test_the_printed_middle_branch_is_not_continuous_at_phi_C(angle):
    """The finding behind the correction: with φ_B read as φ_C or as an angle of (17), (18) jumps at φ_C."""
    opens, phi_C = 600.0, 640.0
    first = 2.0 / (720.0 - opens) * (phi_C - opens) ** 2 / (phi_C - opens)
    jump = printed_middle_branch(phi_C, opens, phi_C if angle == "phi_B = phi_C" else 60.0) - first
    assert abs(jump) > 0.3  # of the largest area


def test_the_corrected_middle_branch_is_the_printed_one_with_720_minus():
    opens, phi_C = 600.0, 640.0
    for phi in (641.0, 660.0, 679.0):
        printed = printed_middle_branch(phi, opens, phi_C)
        mended = 1.0 + (printed - 1.0) * (720.0 + opens) / (720.0 - opens)
        assert law.discharge_area(phi * DEG, 1.0, opens * DEG, phi_C * DEG) == pytest.approx(mended, rel=1e-12)
