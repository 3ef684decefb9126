"""LU with partial pivoting against LAPACK."""

import numpy as np
from each_row import each_row

from screwsim.numerics.linear import lu_factor, lu_solve


def solve(M, b):
    M, x, pivots = M.copy(), b.copy(), np.zeros(len(b), np.int64)
    lu_factor(M, pivots, len(b))
    lu_solve(M, pivots, x, len(b))
    return x


@each_row("n", [1, 2, 3, 4, 8, 16, 32])
def test_random_systems_are_solved_as_by_lapack(n):
    rng = np.random.default_rng(n)
    M, b = rng.normal(size=(n, n)), rng.normal(size=n)
    # backward stable: the error is the condition number times rounding
    np.testing.assert_allclose(solve(M, b), np.linalg.solve(M, b), rtol=1e-14 * np.linalg.cond(M) * n, atol=1e-13)


def test_zeros_on_the_diagonal_are_pivoted_away():
    M = np.array([[0.0, 2.0, 0.0], [0.0, 0.0, 3.0], [5.0, 0.0, 0.0]])
    np.testing.assert_array_equal(solve(M, np.array([2.0, 3.0, 5.0])), [1.0, 1.0, 1.0])


def test_a_tiny_pivot_costs_no_digits():
    M = np.array([[1e-20, 1.0], [1.0, 1.0]])
    np.testing.assert_allclose(solve(M, np.array([1.0, 2.0])), [1.0, 1.0], rtol=1e-15)  # without pivoting: 0 and 1


def test_columns_in_other_units_change_nothing():
    """States of very different size: solving in other units gives the same in those units."""
    rng = np.random.default_rng(0)
    M, b, units = rng.normal(size=(6, 6)), rng.normal(size=6), 2.0 ** np.arange(-30, 30, 10)
    # powers of two and pivots within a column: the same operations, bit for bit
    np.testing.assert_array_equal(solve(M * units, b) * units, solve(M, b))


def test_a_singular_matrix_leaves_no_finite_answer():
    with np.errstate(all="ignore"):
        assert not np.all(np.isfinite(solve(np.array([[1.0, 2.0], [2.0, 4.0]]), np.array([1.0, 1.0]))))
