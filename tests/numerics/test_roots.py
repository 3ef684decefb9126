"""Our search for a zero takes the steps of scipy's brentq."""

import math
from functools import partial

import numpy as np
import pytest
from scipy import optimize

from screwsim.numerics.roots import brentq

FUNCTIONS = {
    "cubic": lambda a, x: x**3 - a,
    "exponential": lambda a, x: math.exp(a * x) - abs(a) - 0.1,
    "threefold": lambda a, x: 1e-3 * (x - a) ** 3,
    "jump": lambda a, x: math.copysign(1.0, x - a),
    "with a flat place": lambda a, x: 0.0 if abs(x - a) < 1e-3 else x - a,
}


def answer(search, f, asked):
    """Return the zero, how often the function was asked, or which error."""
    seen = []

    def noted(x):
        seen.append(x)
        return f(x)

    try:
        return search(noted, *asked[:2], xtol=asked[2], rtol=asked[3]), len(seen)
    except (ValueError, RuntimeError) as error:
        return type(error), len(seen)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_zero_and_the_steps_to_it_are_those_of_scipy(name):
    random, found = np.random.default_rng(1), []
    for _ in range(300):
        a, low, high = float(random.normal()), -float(random.uniform(0.1, 5.0)), float(random.uniform(0.1, 5.0))
        asked = low, high, 10.0 ** float(random.uniform(-14.0, -2.0)), 1e-12
        ours, theirs = (answer(search, partial(FUNCTIONS[name], a), asked) for search in (brentq, optimize.brentq))
        assert ours == (pytest.approx(theirs[0], rel=1e-13) if isinstance(theirs[0], float) else theirs[0], theirs[1])
        found.append(theirs[0])
    assert sum(isinstance(each, float) for each in found) > 100


def test_ends_of_one_sign_are_refused():
    with pytest.raises(ValueError, match="different signs"):
        brentq(lambda x: x * x + 1.0, -1.0, 1.0)
