"""A number that an effect leaves open: found with the cycle, of which one figure tells it."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

AT_END = 1e-6  # [K]


class Span(NamedTuple):
    """Ends of a coordinate [K]."""

    low: float
    high: float

    def kept(self, x: float) -> float:
        """Return the nearest coordinate between both ends."""
        return min(max(x, self.low), self.high)

    def at_end(self, x: float) -> bool:
        """Tell whether a coordinate stands at an end."""
        return min(x - self.low, self.high - x) <= AT_END


class Sought:
    """Parameters of an effect that may leave one of them open, as a coordinate [K] to be found with the cycle.

    Newton's method looks for it beside other such numbers (`solve.circuit`), whose changes are to be of about one size:
    a coordinate is scaled so that a kelvin of it matters as much as one of the oil.
    """

    @property
    def is_open(self) -> bool:
        """Is one of the parameters found?"""
        return False

    @property
    def stands(self) -> float | None:
        """Where the coordinate stands [K]; None where it has no value yet."""
        return None

    def span(self, facts: Any, suction_pressure: Callable[[], float]) -> Span:
        """Return the ends of the coordinate in a scene, whose suction pressure [Pa] is found where it is asked for."""
        raise NotImplementedError

    def first(self, span: Span) -> float:
        """Return a first guess of the coordinate."""
        raise NotImplementedError

    def placed(self, x: float) -> dict[str, Any]:
        """Return the parameters that a coordinate tells, by name, as values that are `Found`."""
        raise NotImplementedError

    def off(self, figures: Mapping[str, Any], oil_follows: bool) -> tuple[float, float] | None:
        """Return by how much the coordinate is about wrong [K], and how much of it is a factor e of its flow.

        None where a figure has no value. `oil_follows` tells that the temperature of the oil goes with that of the
        discharge, which it then does not hold.
        """
        raise NotImplementedError

    def idle(self, figures: Mapping[str, Any], x: float, lowest: bool) -> str:
        """Return in words that the coordinate stands at an end, its lowest or highest; empty where nothing is known."""
        raise NotImplementedError
