"""Arguments of the rates besides states and angle, and what an event does to small changes of these and of states."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol, Self

import numpy as np

Array = np.ndarray


class RateNumbers(NamedTuple):
    """Arguments of rates besides states and angle, or a change of these: parameters, tables and run-time cells."""

    P: Array
    TAB: Array
    R: Array

    def plus(self, by: float, change: Self) -> Self:
        """Return these plus a multiple of a change."""
        return self._make(one + by * more for one, more in zip(self, change, strict=True))

    def times(self, by: float) -> Self:
        """Return a multiple of these."""
        return self._make(by * one for one in self)

    @property
    def nothing(self) -> bool:
        """Whether this change is zero."""
        return not any(each.any() for each in self)


Changes = Sequence[tuple[int, RateNumbers]]  # of the numbers, by their columns


class LinearEvent(Protocol):
    """An event at the end of a slice, linearised (`turn`): its condition, and the jump of the states behind it."""

    @property
    def slice(self) -> int: ...

    def condition(self, now: Array, numbers: Changes) -> Array:
        """Return the changes (k,) of its condition by those of the states before it (N, k), and of some numbers."""

    def jumped(self, now: Array, numbers: Changes) -> Array:
        """Return the changes of the states after it (N, k)."""
