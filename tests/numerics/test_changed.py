"""An object with other values is that of `dataclasses.replace`, and has nothing else of the one before."""

from dataclasses import dataclass, field, replace
from typing import Protocol

import pytest
from each_row import each_row

from screwsim.numerics.frozen import fast_init, with_changes
from screwsim.numerics.identity_cache import once


@dataclass(frozen=True)
class Plain:
    a: float
    b: tuple[int, ...] = ()

    @once
    def double(self) -> float:
        return 2.0 * self.a


class Kind(Protocol):
    a: float


@dataclass(frozen=True)
class OfProtocol(Kind):
    a: float
    more: dict[str, float] = field(default_factory=dict)


@fast_init
@dataclass(frozen=True)
class Checked:
    a: float

    def __post_init__(self):
        if self.a < 0.0:
            raise ValueError("negative")


@dataclass(frozen=True, slots=True)
class Slotted:
    a: float


@dataclass(frozen=True)
class Derived:
    a: float
    b: float = field(init=False, default=3.0)


EVERY = [Plain(1.0, (2,)), OfProtocol(1.0, {"x": 2.0}), Checked(1.0), Slotted(1.0), Derived(1.0)]


@each_row("of", EVERY, ids=lambda of: type(of).__name__)
def test_another_value_gives_what_replacing_does(of):
    found = with_changes(of, a=5.0)
    assert found == replace(of, a=5.0)
    assert type(found) is type(of)
    assert of.a == 1.0


def test_what_was_found_of_the_other_is_found_anew():
    of = Plain(1.0)
    assert of.double == 2.0
    assert with_changes(of, a=4.0).double == 8.0


def test_what_is_checked_is_checked_again():
    with pytest.raises(ValueError, match="negative"):
        with_changes(Checked(1.0), a=-1.0)


def test_an_unknown_field_is_told():
    with pytest.raises(TypeError, match="c"):
        with_changes(Plain(1.0), c=2.0)
