"""Loops of a user's own kernels end: what plainly does not is refused, what may not is bounded and told."""

import math

import pytest

from screwsim.codegen.modules import Module
from screwsim.numerics.kernel import HEADER, flatten, kernel
from screwsim.numerics.loops import MOST_ROUNDS


def never(x):
    i = 0
    while i < 3:
        x += 1.0
    return x


def for_ever(x):
    while True:
        x += 1.0
    return x


def until_a_bound(x):
    while True:
        x += 1.0
        if x > 3.0:
            return x


@kernel
def reaches_one(x, step):
    """Return x once it is one: never, where steps pass it."""
    while x != 1.0:
        x += step
    return x


@kernel
def several(x):
    while x < 10.0 * MOST_ROUNDS:
        x += 8.0
    return x, x


@pytest.mark.parametrize("function", [never, for_ever])
def test_a_loop_whose_condition_nothing_changes_is_refused(function):
    with pytest.raises(TypeError, match=rf"kernel {function.__name__}: its loop in line \d+ never ends"):
        kernel(function)


def test_a_loop_that_is_left_is_none_of_those():
    assert kernel(until_a_bound)(0.0) == 4.0


def test_a_loop_that_goes_on_is_told_and_compiled_returns_no_number():
    assert reaches_one(0.0, 0.5) == 1.0
    told = rf"kernel reaches_one: its loop in line \d+ goes round more than {MOST_ROUNDS} times"
    with pytest.raises(RuntimeError, match=told):
        reaches_one(0.0, 0.3)
    texts = flatten([reaches_one])
    compiled = getattr(Module("test", HEADER + "\n".join(texts.values()), checks=True), next(iter(texts)))
    assert compiled(0.0, 0.5) == 1.0
    assert math.isnan(compiled(0.0, 0.3))


def test_what_returns_several_takes_as_many_steps_as_it_likes():
    assert "rounds" not in several.source
