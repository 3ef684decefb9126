"""Numbers that the cycle makes and that act back on it, and numbers that an effect leaves open to be found with it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf, sqrt
from typing import Any, NamedTuple

from screwsim.effects.parts.plenums import Site
from screwsim.numerics.made import Entry

AT_END = 1e-6  # [K]


class LineFlow(NamedTuple):
    """What the chambers give a line over one pitch, at even angles from the youngest chamber's 0° on (SI units).

    `flow` [kg/s] is that of all chambers into the line, its mean that of the turn; `open_volume` [m³] the mean volume
    of what is open to it; p, ρ, and k of isentropic compression are those of the line, without what pulsates.
    """

    flow: Any
    open_volume: float
    p: float
    rho: float
    k: float

    @property
    def sound(self) -> float:
        """Speed of sound [m/s] in the line's gas."""
        return sqrt(self.k * self.p / self.rho)


class Turn(NamedTuple):
    """What a turn of the chambers tells of itself (SI units), of the whole machine and averaged over time.

    `held` are the numbers that the cycle makes, by name, as the turn was integrated with them, `made` the same with
    this turn's images of those declared before. `heat` [W] goes from each wall into the gas, over `conductance` [W/K].
    `gaps` [m] are the stated clearances of the scene's effects, `T_0` is the ambient temperature [K]; `line` tells of
    the flow to a line, `omega` [rad/s] and `pitch` [rad] how fast it repeats. `two_lines`: suction and discharge alone
    give the chambers gas, or take it.
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
    """A number that the cycle makes and that acts back on it, found together with it (docs/explanation/closing.md).

    Any kernel of the scene can ask for it by the name of its `entry`. `guess` is where it begins; `image` returns what
    a turn makes of it, in plain Python; its fixed point is the answer. It is held at `least`; a cycle that closes there
    has failed, and `beyond` says why and what to do.
    """

    entry: Entry
    guess: Callable[[Site], float]
    image: Callable[[Turn], float]
    least: float = -inf
    beyond: str = ""


@dataclass(frozen=True)
class Pulsation:
    """The pressure of a line over the angle, made by the cycle: an offset and harmonics of the lobe frequency (M185).

    `to` is 'suction' or 'discharge'; `offset` and `harmonics` name `Made` numbers, over the line's pressure: a_1, b_1,
    a_2 … of cosines and sines, declared one after the other. `shut` tells whether a turn finds the line shut by a check
    valve: nothing passes then, in the mean or ever; `stuck` says why a cycle with that does not close,
    `idle` (with {nothing} for what) what comes of one that does, `swings` that the pressure would fall below none.
    `open_question` returns what the scene leaves open of a cycle, which closed or did not, and what to do; empty where
    it leaves nothing open.
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
