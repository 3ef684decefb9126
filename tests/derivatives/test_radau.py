"""Radau's method IIA of three stages satisfies the conditions of its orders."""

import numpy as np
import pytest

from screwsim.derivatives.radau import EIGENVALUE, EMBEDDED, INTEGRALS, NODES, SHARES

ROUNDING = 1e-13


@pytest.mark.parametrize("k", [1, 2, 3])
def test_integrals_to_the_nodes_are_exact_for_parabolas(k):
    assert INTEGRALS @ SHARES ** (k - 1) == pytest.approx(SHARES**k / k, rel=ROUNDING)


@pytest.mark.parametrize("k", [1, 2, 3, 4, 5])
def test_the_integral_over_a_slice_is_exact_up_to_the_fourth_power(k):
    assert INTEGRALS[-1] @ SHARES ** (k - 1) == pytest.approx(1.0 / k, rel=ROUNDING)
    assert SHARES[-1] == 1.0  # the last node is the end


def test_the_method_damps_what_is_infinitely_stiff():
    """R(∞) = 1 − bᵀ A⁻¹ 1 = 0."""
    assert 1.0 - INTEGRALS[-1] @ np.linalg.solve(INTEGRALS, np.ones(NODES)) == pytest.approx(0.0, abs=ROUNDING)


def test_the_estimate_has_the_real_eigenvalue_of_the_inverse():
    eigenvalues = np.linalg.eigvals(np.linalg.inv(INTEGRALS))
    assert np.abs(eigenvalues - EIGENVALUE).min() == pytest.approx(0.0, abs=1e-12)
    assert np.sum(np.abs(eigenvalues.imag) < 1e-9) == 1


@pytest.mark.parametrize(("k", "slope"), [(1, 1.0), (2, 0.0), (3, 0.0)])
def test_the_estimate_is_zero_for_cubics(k, slope):
    """With y = tᵏ over a slice of width 1, f(y₀) + e (Y − y₀) = 0."""
    assert slope + EMBEDDED @ SHARES**k == pytest.approx(0.0, abs=1e-12)


def test_the_estimate_shows_a_fourth_power():
    assert abs(EMBEDDED @ SHARES**4) > 0.01
