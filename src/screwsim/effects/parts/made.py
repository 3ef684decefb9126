"""Feedback unknowns, which the cycle determines and which act back on it, and parameters to be found with the cycle.

A feedback unknown ("made" number) is the fixed point of a map: a turn that is integrated with one value of it yields a
new value, its "image".
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf, sqrt
from typing import Any, NamedTuple

from screwsim.effects.parts.readings import Site
from screwsim.numerics.feedback_unknowns import FeedbackUnknown

AT_END = 1e-6  # [K] distance from an end of a span that counts as being there


class LineFlow(NamedTuple):
    """Flow from the chambers into a line over one pitch, at even angles from the youngest chamber's 0° on (SI units).

    `flow` [kg/s] is that of all chambers into the line; its mean is that of the turn. `open_volume` [m³] is the mean
    volume of the chambers open to the line; p, ρ and the isentropic exponent k are those of the line without the
    pulsation. `net` [kg/s] is the mean that follows from what chambers hold as they leave the suction line: the line
    makes good what gaps between chambers open to it leave open, and the mean of `flow` has that, too.
    """

    flow: Any
    open_volume: float
    p: float
    rho: float
    k: float
    net: float

    @property
    def sound(self) -> float:
        """Speed of sound [m/s] in the line's gas."""
        return sqrt(self.k * self.p / self.rho)


class Turn(NamedTuple):
    """What a turn of the chambers yields for feedback unknowns (SI units), of the whole machine, averaged over time.

    `held` are the feedback unknowns, by name, with which the turn was integrated; `made` are the same, with this turn's
    images for those declared earlier. `heat` [W] is that from each wall into the gas, `conductance` [W/K] that between
    them. `gaps` [m] are the stated clearances of the scene's effects, `T_0` is the ambient temperature [K]. `line`
    returns the flow to a line; `omega` [rad/s] and `pitch` [rad] give its period. `two_lines`: the chambers exchange
    gas with suction and discharge only.
    """

    held: Mapping[str, float]
    made: Mapping[str, float]
    heat: Mapping[str, float]
    conductance: Mapping[str, float]
    gaps: Mapping[str, float]
    T_0: float
    line: Callable[[str], LineFlow]
    omega: float
    pitch: float
    two_lines: bool


@dataclass(frozen=True)
class Made:
    """A feedback unknown: a number that the cycle determines and that acts back on it (docs/explanation/closing.md).

    Any kernel of the scene can take it by the name of its `entry`. `guess` returns the starting value; `image` returns
    the value that a turn yields, in plain Python; the solution is the fixed point of `image`. The value is kept at or
    above `least`; a cycle that closes at that bound has failed, and `beyond` says why, with a remedy.
    """

    entry: FeedbackUnknown
    guess: Callable[[Site], float]
    image: Callable[[Turn], float]
    least: float = -inf
    beyond: str = ""


@dataclass(frozen=True)
class Pulsation:
    """Pressure of a line over the angle, found with the cycle: an offset and harmonics of the lobe frequency (M185).

    `to` is 'suction' or 'discharge'. `offset` and `harmonics` name `Made` numbers, relative to the line's pressure:
    a_1, b_1, a_2 … of cosines and sines, declared one after the other. `shut` says whether a check valve shuts the line
    during a turn, so that nothing passes. Texts: `stuck` says why a cycle with a shut valve does not close, `idle`
    (with {nothing} to fill in) describes one that does, `swings` says that the pressure would fall below zero.
    `open_question` returns what the scene does not determine about a cycle, closed or not, with a remedy; empty where
    it determines everything.
    """

    to: str
    offset: str
    harmonics: tuple[str, ...]
    shut: Callable[[Turn], bool] | None = None
    open_question: Callable[[Turn, bool], str] | None = None
    stuck: str = ""
    idle: str = ""
    swings: str = ""


class Span(NamedTuple):
    """Range of a search coordinate [K]."""

    low: float
    high: float

    def kept(self, x: float) -> float:
        """Return a coordinate, limited to the span."""
        return min(max(x, self.low), self.high)

    def at_end(self, x: float) -> bool:
        """Tell whether a coordinate is at an end of the span."""
        return min(x - self.low, self.high - x) <= AT_END


class Sought:
    """Parameters of an effect that may leave one of them open, as a coordinate [K] to be found with the cycle.

    Newton's method finds it together with other such numbers (`solve.circuit`), whose changes should be of similar
    size: a coordinate is scaled so that one kelvin of it matters about as much as one kelvin of oil temperature.
    """

    @property
    def is_open(self) -> bool:
        """Whether one of the parameters is to be found."""
        return False

    @property
    def stands(self) -> float | None:
        """Current value of the coordinate [K]; None where it has none yet."""
        return None

    def span(self, facts: Any, suction_pressure: Callable[[], float]) -> Span:
        """Return the coordinate's range in a scene; the suction pressure [Pa] is computed only where it is needed."""
        raise NotImplementedError

    def first(self, span: Span) -> float:
        """Return a first guess of the coordinate."""
        raise NotImplementedError

    def cautious(self, span: Span) -> float:
        """Return another first guess, for a machine that has no net flow with the first."""
        return self.first(span)

    def placed(self, x: float) -> dict[str, Any]:
        """Return the parameters that a coordinate stands for, by name, as values that are `Found`."""
        raise NotImplementedError

    def off(self, figures: Mapping[str, Any], oil_follows: bool) -> tuple[float, float] | None:
        """Return the approximate error of the coordinate [K], and its change [K] that makes a factor e of its flow.

        None where a figure that it needs has no value. `oil_follows`: the oil's temperature moves with that of the
        discharge, so that the oil does not hold the discharge temperature.
        """
        raise NotImplementedError

    def idle(self, figures: Mapping[str, Any], x: float, lowest: bool) -> str:
        """Return a text on the coordinate being at its lowest or highest end; empty where nothing can be said."""
        raise NotImplementedError
