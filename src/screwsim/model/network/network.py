"""A machine as cells and connections: what a scene names, with the calls of its kernels as text.

Cells are the chambers, both lines and the plenums of effects. Connections are ports (a chamber and a line or plenum),
gaps (two chambers), oil ports, oil that releases gas, heat rates and walls. Anything a scene does not name is absent.
"""

import re
from dataclasses import dataclass, field, fields
from functools import cache
from operator import attrgetter
from typing import Any

from screwsim.model.slots import FIRST_OWN
from screwsim.numerics.kernel import Kernel
from screwsim.numerics.path_stream import OIL, PathStream

SYMBOLS = ("suction", "discharge")  # of the lines, in the texts; effects use the same names (`effects.base.LINES`)
PRESSURES = tuple(f"p_{line}" for line in SYMBOLS)  # of the lines, as kernels ask for them
WHOSE = ("own", "leading")  # under which a stream may name a chamber's own port state
QUANTITIES = ("mass", "energy", "oil", "oil_energy", "held")  # of a stream; the first of them, as many as sums


@dataclass(frozen=True)
class Opening:
    """A port or a gap, with the streams through it as text (`effects.parts.flow_kinds`)."""

    index: int  # among the ports, or among the gaps
    effect: str
    streams: tuple[PathStream, ...] = field(default=(), kw_only=True)

    @property
    def gas(self) -> PathStream:
        """The stream of gas."""
        return self.streams[0]

    @property
    def film(self) -> PathStream | None:
        """The stream of oil that pressure differences drive."""
        return next((each for each in self.streams if each.of == OIL and not each.driven), None)

    @property
    def drag(self) -> PathStream | None:
        """The stream of oil that a wall drags along."""
        return next((each for each in self.streams if each.of == OIL and each.driven), None)

    @property
    def oily(self) -> bool:
        """Whether oil passes beside the gas."""
        return len(self.streams) > 1

    def asks(self, number: str) -> bool:
        """Return whether a stream uses a number of a chamber's own port state."""
        return any(f"{{{whose}.{number}}}" in line for whose in WHOSE for line in self.text)

    @property
    def text(self) -> list[str]:
        """The text of all streams."""
        return [line for each in self.streams for line in (*each.before, each.flux)]


@dataclass(frozen=True)
class Port(Opening):
    """An opening between a chamber and a line or plenum."""

    cell: str  # the line or plenum, as an identifier
    number: int  # of that plenum
    width: str  # of the regularisation [Pa]
    opening: str = ""  # call for the open share (drop, width, held, states); empty: the angle alone decides
    one_way: int = 0
    narrow: bool = False

    @property
    def wide(self) -> bool:
        """Whether it can hold the chamber's pressure to that of a line."""
        return self.number < FIRST_OWN and not self.narrow


@dataclass(frozen=True)
class Gap(Opening):
    """An opening between a chamber and the one `offset` lobe pitches ahead."""

    side: int  # index of its offset


@dataclass(frozen=True)
class Heat:
    """Heat from the oil to the gas."""

    effect: str
    call: str  # heat [W] into the gas
    factor: str = ""  # on what the oil loses


@dataclass(frozen=True)
class WallHeat:
    """A wall that exchanges heat with the gas."""

    effect: str
    call: str  # conductance [W/K]
    temperature: str


@dataclass(frozen=True)
class Stop:
    """The seat and stop of a state, and the state that is its speed."""

    position: str
    speed: str
    seat: str  # ratio of speeds after and before an impact on it
    stop: str


@dataclass(frozen=True)
class OilInflow:
    """Oil that enters a chamber through ports."""

    call: str  # oil [kg/s] (phi, p, width)
    pumped: bool  # whether a pump feeds them


@dataclass(frozen=True)
class Flash:
    """Gas that flashes out of oil as it enters."""

    cell: str  # the plenum that has its state
    share: str  # call for the gas per oil (p)
    enthalpy: str
    heat: str  # that it takes from the oil, over c_oil
    begins: str  # the pressure [Pa] above which none flashes


@dataclass(frozen=True)
class Solution:
    """Gas dissolved in oil, which gives it off over time."""

    cell: str  # the plenum among whose streams it counts
    release: str  # call for gas, its enthalpy and its heat over c_oil (m_oil, w, s, h, T_oil)
    in_supply: str  # per oil through ports


@dataclass
class Network:
    """Cells and connections of one machine, and the calls of their kernels."""

    states: tuple[str, ...]
    own_states: tuple[str, ...]
    heated: bool
    carried: bool
    dissolves: bool
    roomed: bool
    varies: bool = False  # whether the gas's exponent and choking vary with its state
    supplied: bool = False  # whether there is oil
    positive: tuple[bool, ...] = ()  # for each own state, whether it is positive
    ports: list[Port] = field(default_factory=list)
    gaps: list[Gap] = field(default_factory=list)
    offsets: list[int] = field(default_factory=list)  # lobe pitches between neighbours that gaps connect
    cells: list[str] = field(default_factory=list)  # lines and plenums by number, as identifiers; "" between
    heats: list[Heat] = field(default_factory=list)
    walls: list[WallHeat] = field(default_factory=list)
    rates: list[str] = field(default_factory=list)  # calls [1/s] for the own states
    gas: str = ""  # call for the state (phase, T, rho)
    entropy: str = ""
    phases: bool = False  # whether the gas can have two
    inflow: OilInflow | None = None
    flash: Flash | None = None
    solution: Solution | None = None
    stops: list[Stop] = field(default_factory=list)
    pulses: tuple[str, ...] = ()  # the lines that pulsate, among `cells`
    across: bool = False
    chambers: int = 1
    slow: str = ""  # call for the factor on quantities per time, where the speed varies over the pitch
    kernels: dict[str, Kernel] = field(default_factory=dict)  # all kernels that the texts call, by flat name

    def __post_init__(self) -> None:
        self.kernels = dict(self.kernels)

    @property
    def lines(self) -> list[str]:
        """Suction and discharge line, among `cells`."""
        return self.cells[:2]

    @property
    def quantities(self) -> tuple[str, ...]:
        """The quantities that are summed for a stream."""
        return QUANTITIES[: 5 if self.dissolves else 4 if self.carried else 2]

    @property
    def pulsating(self) -> bool:
        """Whether the pressure of a line pulsates."""
        return bool(self.pulses)

    @property
    def ported(self) -> bool:
        """Whether oil enters through ports."""
        return self.inflow is not None

    @property
    def openings(self) -> list[Port | Gap]:
        """All ports, then all gaps."""
        return [*self.ports, *self.gaps]

    @property
    def oily(self) -> bool:
        """Whether oil passes an opening beside the gas."""
        return any(each.oily for each in self.openings)

    @property
    def pushes(self) -> bool:
        """Whether walls that drag oil along do work on it (M257)."""
        return self.roomed and any(each.drag for each in self.openings)

    def key(self) -> tuple[Any, ...]:
        """Return everything that the texts depend on; `Network(*key)` is an equal network."""
        return tuple([_fixed(each) for each in _values(self)])


_values = attrgetter(*(each.name for each in fields(Network)))


def line_pressures(network: Network) -> dict[str, str]:
    """Return the text of each line's pressure [Pa], by the name that kernels ask for."""
    return {name: f"R[R_{cell} + PRESSURE]" for name, cell in zip(PRESSURES, network.lines, strict=True)}


def _fixed(value: Any) -> Any:
    """Return a hashable form of a field."""
    return tuple(value.items()) if isinstance(value, dict) else tuple(value) if isinstance(value, list) else value


@cache
def identifier(name: str) -> str:
    """Return a name as part of an identifier."""
    return re.sub(r"\W", "_", name)
