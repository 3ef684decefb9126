"""Arrays compared at once are near each other where pytest finds them so, element by element."""

import numpy as np
import pytest
from near_arrays import assert_near


def is_near(found, wanted, **within):
    try:
        assert_near(found, wanted, **within)
    except AssertionError:
        return False
    return True


def test_arrays_are_near_where_pytest_finds_them_so():
    draw, answers = np.random.default_rng(1), []
    for size in 10.0 ** draw.integers(-14, 3, 200):
        wanted = size * draw.normal(size=3)
        found = wanted * (1.0 + 10.0 ** draw.integers(-8, -3) * draw.normal(size=3)) + 1e-10 * draw.normal(size=3)
        if draw.random() < 0.2:
            found[0] = wanted[0] = draw.choice([np.inf, np.nan])
        answers.append(is_near(found, wanted, rel=1e-5, abs=1e-10))
        assert answers[-1] == (found == pytest.approx(wanted, rel=1e-5, abs=1e-10))
    assert 20 < sum(answers) < 180


def test_arrays_of_other_shapes_are_not_near():
    assert not is_near(np.ones(3), np.ones((3, 1)))
