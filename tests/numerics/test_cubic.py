"""The cubic spline that leaves no knot: scipy's, where it is read at its points."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from screwsim.numerics import cubic

ROUNDING = 1e-11  # where a processor fuses operations; elsewhere every bit is the same


@pytest.mark.parametrize("rows", [4, 5, 6, 17, 96])
@pytest.mark.parametrize("even", [True, False])
def test_it_is_that_of_scipy(rows, even):
    drawn = np.random.default_rng(rows)
    for _ in range(10):
        x = np.linspace(-8.0, -1.0, rows) if even else np.sort(drawn.uniform(-5.0, 5.0, rows))
        y = drawn.normal(size=rows)
        theirs, ours = CubicSpline(x, y), cubic.coefficients(x, y)
        np.testing.assert_allclose(ours, theirs.c, rtol=ROUNDING, atol=ROUNDING)
        np.testing.assert_allclose(cubic.at_points(x, ours), theirs(x), rtol=ROUNDING, atol=ROUNDING)
        np.testing.assert_allclose(cubic.slopes_at_points(x, ours), theirs(x, 1), rtol=ROUNDING, atol=ROUNDING)
        np.testing.assert_allclose(
            cubic.at_points(x, cubic.integral(x, ours)), theirs.antiderivative()(x), rtol=ROUNDING, atol=ROUNDING
        )
