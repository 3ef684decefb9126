"""An object written at once is what a frozen dataclass makes of the same values."""

from dataclasses import FrozenInstanceError, dataclass, field, replace

import pytest

from screwsim.numerics.frozen import fast_init


@fast_init
@dataclass(frozen=True)
class Quick:
    x: float
    y: float = 2.0
    names: list[str] = field(default_factory=list)

    def __post_init__(self):
        if self.x < 0.0:
            raise ValueError("x")


def test_values_and_defaults_are_those_stated():
    one = Quick(1.0, names=["a"])
    assert (one.x, one.y, one.names) == (1.0, 2.0, ["a"])
    assert replace(one, y=3.0) == Quick(1.0, 3.0, ["a"]) != one


def test_each_object_gets_a_default_of_its_own():
    assert Quick(1.0).names == [] and Quick(1.0).names is not Quick(1.0).names


def test_it_stays_frozen():
    with pytest.raises(FrozenInstanceError):
        Quick(1.0).x = 2.0


def test_it_is_looked_at_once_made():
    with pytest.raises(ValueError, match="x"):
        Quick(-1.0)


@pytest.mark.parametrize("wrong", [{}, {"x": 1.0, "z": 1.0}])
def test_a_missing_or_unknown_value_is_an_error(wrong):
    with pytest.raises(TypeError):
        Quick(**wrong)
