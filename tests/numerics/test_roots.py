"""Our search for a zero takes the steps of scipy's brentq."""

import math
from functools import partial

import numpy as np
import pytest
from scipy import optimize

from screwsim.numerics.roots import bisected, bracketed, brentq

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


def test_many_zeros_at_once_lie_where_brentq_finds_them_and_are_none_where_none_is():
    random = np.random.default_rng(2)
    a, low, high = random.normal(size=200), -5.0 * random.uniform(0.1, 1.0, 200), 5.0 * random.uniform(0.1, 1.0, 200)

    def steep(x):
        return np.tanh(1e3 * (x - a)) + 1e-2 * (x - a) ** 3

    found = bracketed(steep, low, high, 1e-10, np.zeros(200))
    inside = (low < a) & (a < high)
    assert (np.isfinite(found) == inside).all()
    assert np.abs(found - a)[inside].max() < 1e-10 * 10.0


def test_a_zero_is_good_enough_where_the_function_is_as_small_as_asked():
    calls = []

    def cubic(x):
        calls.append(x)
        return x**3 - 2.0

    found = bracketed(cubic, np.zeros(1), np.full(1, 2.0), 1e-14, np.full(1, 1e-3))
    assert abs(cubic(found)[0]) <= 1e-3
    assert len(calls) < 10


def test_an_interval_is_halved_to_a_relative_width():
    seen = []
    low, high = bisected(lambda x: seen.append(x) or x < math.pi, 3.0, 4.0, 1e-6)
    assert low < math.pi <= high and high - low <= 1e-6 * high < 2.0 * (high - low)
    assert len(seen) == 19  # 2⁻¹⁹ is the first power below 1e-6 π
    assert sum(bisected(lambda x: x < math.pi, 3.0, 4.0)) == pytest.approx(2.0 * math.pi, rel=1e-15)
