"""A value that is found when it is first asked for, and not again."""

from dataclasses import dataclass

from screwsim.numerics.identity_cache import once


@dataclass(frozen=True)
class Square:
    side: float
    asked: list[float]

    @once
    def area(self) -> float:
        """Area [m²]."""
        self.asked.append(self.side)
        return self.side**2


def test_the_value_is_found_once_for_each_object():
    asked: list[float] = []
    one, other = Square(2.0, asked), Square(3.0, asked)
    assert (one.area, one.area, other.area, one.area) == (4.0, 4.0, 9.0, 4.0)
    assert asked == [2.0, 3.0]


def test_it_keeps_the_text_of_what_finds_it():
    assert Square.area.__doc__ == "Area [m²]."
