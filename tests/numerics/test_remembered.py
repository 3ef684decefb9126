"""What follows from the same objects is found once, and never that of others."""

import pytest

from screwsim.numerics.identity_cache import IdentityCache


class Section:
    """Equal to every other one: only where it stands tells it."""

    def __init__(self, value):
        self.value = value

    def __eq__(self, other):
        return True

    __hash__ = None


def test_the_same_objects_are_asked_once_and_equal_ones_anew():
    asked = []
    found = IdentityCache(lambda *parts: asked.append(parts) or sum(part.value for part in parts))
    one, other = Section(1), Section(2)
    assert [found(one, other), found(one, other), found(other, one), found(one, one)] == [3, 3, 3, 2]
    assert len(asked) == 3


def test_objects_that_go_leave_nothing_to_those_in_their_place():
    found = IdentityCache(lambda part: part.value, most=4)
    assert [found(Section(number)) for number in range(100)] == list(range(100))


def test_what_is_raised_is_raised_each_time():
    def fails(_part):
        raise ValueError("asked")

    found = IdentityCache(fails)
    for _ in range(2):
        with pytest.raises(ValueError, match="asked"):
            found(Section(1))
