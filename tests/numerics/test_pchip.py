"""Our shape-preserving cubic is scipy's."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from screwsim.numerics.pchip import Pchip, coefficients

ROUNDING = 1e-12  # where a processor fuses operations; elsewhere every bit is the same
SHAPES = {
    "any": lambda y: y,
    "rising": lambda y: np.cumsum(np.abs(y)),
    "with steps": np.round,
    "flat": np.zeros_like,
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("points", [2, 3, 4, 30])
def test_values_and_coefficients_are_those_of_scipy(points, shape):
    random = np.random.default_rng(points)
    for _ in range(30):
        x, y = np.cumsum(random.uniform(1e-3, 1.0, points)), SHAPES[shape](random.normal(size=points))
        theirs, ours = PchipInterpolator(x, y), Pchip(x, y)
        np.testing.assert_allclose(coefficients(x, y), theirs.c[::-1].T, rtol=ROUNDING, atol=ROUNDING)
        for at in (*x, *random.uniform(x[0] - 0.2, x[-1] + 0.2, 10)):
            assert ours(float(at)) == pytest.approx(float(theirs(at)), rel=ROUNDING, abs=ROUNDING)


@pytest.mark.parametrize(
    ("x", "y"), [([1.0], [1.0]), ([0.0, 1.0, 1.0], [0.0, 1.0, 2.0]), ([0.0, 1.0], [0.0, np.nan]), ([0.0, 1.0], [0.0])]
)
def test_what_is_no_curve_is_refused(x, y):
    with pytest.raises(ValueError, match="curve"):
        Pchip(np.array(x), np.array(y))
