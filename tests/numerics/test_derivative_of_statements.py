"""Derivatives of what a user's kernel may say (loops, branches, tuples, calls of kernels), against differences."""

import math
import random

import numpy as np
import pytest
from each_row import each_row
from random_kernels import LARGEST, kernel_of

from screwsim.numerics.derivative import tangent
from screwsim.numerics.kernel import Kernel, kernel

STEP = 1e-6  # of differences of kernels written here, which err by its square and by rounding over it
SMALL = 1e-7  # of random ones, whose values jump


@kernel
def pair(a, b):
    return a * b, a + 2.0 * b


@kernel
def swapped_pair(a, b):
    return pair(b, a)


@kernel
def cube(x):
    return x * x * x


@kernel
def three(a, b, a_b):
    return a * b * b + a_b * a_b


@kernel
def unpacks_a_call_of_itself(x, y):
    a, b = x, x * y
    a, b = pair(a, b)
    for _ in range(3):
        b, a = swapped_pair(a, 0.3 * b)
    return a - b * b


@kernel
def goes_over_values(x, y):
    s = 0.0
    for t in (x, x * y, 2.0):
        s += t * t
        if s > 7.0:
            break
    for a, b in ((x, y), (y * y, s), (1.0, x)):
        if a > 1.9:
            continue
        s += a * a * b
    for a, b in (pair(x, y), pair(s, x)):
        s += a - b
    return s * t


@kernel
def goes_over_its_arguments(x, y):
    s = y
    for x in (x * y, x, s):  # noqa: B020 - as a user may write it
        s = s + x * y
    return s * x


@kernel
def counts_with_a_state(x, y):
    z = x * x
    s = z * y
    for z in range(3):
        s += z * x
        if s > 4.0:
            z = z * y
            break
    for x in range(4):
        s += x * y
    return s * z + x


@kernel
def reads_the_counter(x, y):
    for i in range(20):  # noqa: B007 - read behind the loop
        x = x * 1.1 + 0.05
        if x > 3.0:
            break
    return x * i * y


@kernel
def turns_while(x, y):
    n = 0
    while x < 5.0:
        x = x * 1.3 + 0.1 * y
        n += 1
        if n > 7:
            break
    while True:
        y *= 1.5
        if y > 10.0:
            return x + n * y


@kernel
def takes_what_decides(x, y):
    a = x and y
    b = (x > y and x * y) or y * y
    c = not x
    return a * a + b * x + c * y


@kernel
def branches(x, y):
    z, w = 0.0, 1.0
    if x > y:
        z = x * y
        if x > 1.5:
            w = z
    elif y > 1.0:
        w, z = y * y, x
    else:
        z += x
    u = v = z * w
    v *= y
    return u * v + (x * x if z > w else y * z) * (1.0 if y > 1.0 else x)


@kernel
def pairs_or_constants(x, y):
    if x > y:
        return swapped_pair(x, y)
    return pair(1.0, 2.0)


@kernel
def larger_first(a, b):
    return pair(a, b) if a > b else (swapped_pair(a, b) if a > 0.0 else (b, a * b))


@kernel
def chooses_between_pairs(x, y):
    a, b = larger_first(x, y)
    b, a = larger_first(b, a * y)
    return a * b + larger_first(y, -x)[1]


@kernel
def unpacks_one_of_two(x, y):
    a, b = (x, y) if x > y else (y, x * y)
    a, b = (b, a) if a > 1.0 else pair(b, a) if b > 0.0 else (a, 2.0)
    for k in range(3):
        b, a = (0.5 * a, b) if k != 1 else swapped_pair(a, x)
    return a * b - a


@kernel
def calls(x, y):
    a, b = swapped_pair(x * x, y)
    one = three(x, y, 2.0) + three(1.0, 0.5, x) * three(0.3, y, y)
    return cube(a) * b + cube(y) * one + pair(x, y)[1] * swapped_pair(y, x)[0]


@kernel
def has_names_of_derivatives(x, y):
    z__x = 3.0 * y
    z = x * x * z__x
    z_by_x = z * y
    return z * z__x + z_by_x


@kernel
def powers(x, y):
    s = x**y + (x * y) ** (y - 0.3) + 2.0**x + y**3 + y**-2
    for k in range(4):
        s += y * (x - 1.2) ** k
    return s + (-x) ** 2.0


@kernel
def functions(x, y):
    return math.atan2(x, y) * math.hypot(y, x * y) + math.cbrt(x) + math.atan2(x, 2.0) - math.hypot(0.5, y)


@kernel
def ends(x, y):
    return max(x, y, x * y) - min(y, x, 1.1) + abs(x - y) + math.fabs(y - 1.0)


KERNELS = [each for name, each in list(globals().items()) if isinstance(each, Kernel) and each.arguments == ("x", "y")]


def values(found) -> np.ndarray:
    return np.atleast_1d(np.array(found, float))


@each_row("item", KERNELS)
def test_a_kernel_has_the_derivatives_that_differences_give(item):
    rng, both, compared = np.random.default_rng(1), tangent(item, ("x", "y")), 0
    for _ in range(60):
        at = rng.uniform(0.5, 2.0, 2)
        plain, found = values(item(*at)), values(both(*at))
        slopes = found[len(plain) :].reshape(2, -1)
        assert found[: len(plain)].tolist() == plain.tolist()
        for k, step in enumerate(STEP * np.eye(2)):
            right = (values(item(*(at + step))) - plain) / STEP
            left = (plain - values(item(*(at - step)))) / STEP
            smooth = np.abs(right - left) < 1e-4 * (1.0 + np.abs(right))
            compared += int(smooth.sum())
            assert slopes[k][smooth] == pytest.approx((0.5 * (right + left))[smooth], rel=1e-5, abs=1e-5)
    assert compared > 60


def test_at_a_tie_the_slope_is_that_of_the_first():
    """As the value is: max and min give the first of equal ones; abs is taken to rise at nothing."""
    of_max, of_min, of_abs, of_fabs = (1.0, 0.0), (0.0, 1.0), (1.0, -1.0), (0.0, 1.0)
    slopes = np.array(of_max) - of_min + of_abs + of_fabs
    assert tangent(ends, ("x", "y"))(1.0, 1.0)[1:] == tuple(slopes)


@kernel
def series(x):
    s = 0.0
    for k in range(4):
        s += (k + 1) * x**k
    return s


def test_a_series_has_a_slope_at_nothing():
    """The power of exponent zero is one there, and does not change."""
    assert tangent(series, ("x",))(0.0) == (1.0, 2.0)


@kernel
def logarithm(x):
    return math.log(x, 10.0)


def test_a_logarithm_to_a_base_is_refused():
    with pytest.raises(TypeError, match=r"cannot be differentiated: it has 'math.log\(x, 10.0\)'"):
        tangent(logarithm, ("x",))


@pytest.mark.parametrize("seed", range(12))
def test_random_kernels_have_the_derivatives_that_differences_give(seed):
    """Compared where three differences agree: elsewhere a kernel jumps or turns."""
    item, rng, compared = kernel_of(random.Random(seed)), np.random.default_rng(seed), 0
    both = tangent(item, ("x", "y"))
    for at in rng.uniform(-2.0, 3.0, (30, 2)):
        plain, found = item(*at), both(*at)
        assert found[0] == plain
        for k, step in enumerate(SMALL * np.eye(2)):
            moved = [item(*(at + n * step)) for n in (-1.0, 1.0, 2.0)]
            left, right, next_one = np.diff([moved[0], plain, moved[1], moved[2]]) / SMALL
            bound = 1e-4 * (1.0 + abs(right))
            if abs(right - left) < bound and abs(next_one - right) < bound and abs(plain) < LARGEST:
                compared += 1
                assert found[1 + k] == pytest.approx(0.5 * (left + right), rel=1e-3, abs=1e-3)
    assert compared > 30
