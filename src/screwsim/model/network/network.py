"""A machine as cells and connections: what a scene names, with the calls of its kernels as text.

Cells are the chambers, both lines and the plenums of effects. Connections are ports (a chamber and a line or plenum),
gaps (two chambers), oil ports, oil that gives off gas, heat rates and walls. What is not named is not there.
"""

import re
from dataclasses import dataclass, field, fields
from functools import cache
from operator import attrgetter
from typing import Any

from screwsim.model.slots import FIRST_OWN
from screwsim.numerics.kernel import Kernel

SYMBOLS = ("suction", "discharge")  # of the lines, in the texts; effects call them alike (`effects.base.LINES`)
PRESSURES = tuple(f"p_{line}" for line in SYMBOLS)  # of the lines, as kernels ask for them
QUANTITIES = ("mass", "energy", "oil", "oil_energy", "held")  # of a stream: as many of them as there are sums


@dataclass(frozen=True)
class Law:
    """A flow's own law: the call for its flux, and which numbers of both port states it asks for (`p_1` …)."""

    call: str
    asks: tuple[str, ...]


@dataclass(frozen=True)
class Port:
    """An opening between a chamber and a line or plenum."""

    index: int  # among the ports
    effect: str
    cell: str  # name of what lies beyond it, as an identifier
    number: int  # of that plenum (slots.PLENUM)
    width: str  # of the regularisation [Pa]
    opening: str = ""  # call for the open share (drop, width, held, states); none where it is open by the angle alone
    one_way: int = 0
    law: Law | None = None  # in place of the nozzle's
    narrow: bool = False

    @property
    def wide(self) -> bool:
        """Can it hold the chamber's pressure to that of a line?"""
        return self.number < FIRST_OWN and not self.narrow


@dataclass(frozen=True)
class Gap:
    """An opening between a chamber and the one `offset` lobe pitches ahead."""

    index: int  # among the gaps
    effect: str
    side: int  # index of its offset
    share: str = ""  # call for what passes of a nozzle's flux (flux, density, oil_ratio)
    film: str = ""  # call for the flux of oil beside it (drop, oil_ratio)
    drag: str = ""  # call for the flux of oil that a wall drags to the chamber behind (oil_ratio)
    law: Law | None = None


@dataclass(frozen=True)
class Heat:
    """Heat from the oil to the gas."""

    effect: str
    call: str  # heat [W] into the gas
    factor: str = ""  # of what the oil gives away


@dataclass(frozen=True)
class WallHeat:
    """A wall that exchanges heat with the gas."""

    effect: str
    call: str  # conductance [W/K]
    temperature: str


@dataclass(frozen=True)
class Stop:
    """Seat and stop of a state, and the one that is its speed."""

    position: str
    speed: str
    seat: str  # speed after over speed before an impact on it
    stop: str


@dataclass
class Network:
    """Cells and connections of one machine, and the calls of their kernels."""

    states: tuple[str, ...]
    own_states: tuple[str, ...]
    heated: bool
    carried: bool
    dissolves: bool
    roomed: bool
    varies: bool = False  # do the gas's exponent and choking vary with its state?
    supplied: bool = False  # is there oil?
    pumped: bool = False  # does a pump feed the oil port?
    positive: tuple[bool, ...] = ()  # are the own states, in their order?
    ports: list[Port] = field(default_factory=list)
    gaps: list[Gap] = field(default_factory=list)
    offsets: list[int] = field(default_factory=list)  # lobe pitches between neighbours that gaps join
    cells: list[str] = field(default_factory=list)  # lines and plenums by number, as identifiers; "" between
    heats: list[Heat] = field(default_factory=list)
    walls: list[WallHeat] = field(default_factory=list)
    rates: list[str] = field(default_factory=list)  # calls [1/s] for the own states
    gas: str = ""  # call for the state (phase, T, rho)
    entropy: str = ""
    phases: bool = False  # can the gas have two?
    inflow: str = ""  # call for oil through ports [kg/s] (phi, p, width)
    flash: tuple[str, str, str] | None = None  # share of oil that flashes (p), its enthalpy, its heat over c_oil
    flash_begins: str = ""  # the pressure [Pa] from which on none does
    release: str = ""  # call for (gas, enthalpy, heat over c_oil) that oil gives off (m_oil, w, s, h, T_oil)
    supply_holds: str = ""  # gas per oil that comes through ports
    gas_cell: str = ""  # plenum whose gas flashes or is given off
    stops: list[Stop] = field(default_factory=list)
    pulses: tuple[str, ...] = ()  # the lines whose pressure does, among `cells`
    across: bool = False
    chambers: int = 1
    slow: str = ""  # call for the factor of all that depends on time, where the speed changes over the pitch
    kernels: dict[str, Kernel] = field(default_factory=dict)  # by flat name, all that the texts call

    def __post_init__(self) -> None:
        self.kernels = dict(self.kernels)

    @property
    def lines(self) -> list[str]:
        """Suction and discharge line, among `cells`."""
        return self.cells[:2]

    @property
    def quantities(self) -> tuple[str, ...]:
        """Return what is summed of a stream."""
        return QUANTITIES[: 5 if self.dissolves else 4 if self.carried else 2]

    @property
    def pulsating(self) -> bool:
        """Does the pressure of a line pulsate?"""
        return bool(self.pulses)

    @property
    def ported(self) -> bool:
        """Does oil come through ports?"""
        return bool(self.inflow)

    @property
    def pushes(self) -> bool:
        """Do walls that drag oil along do work on it (M257)?"""
        return self.roomed and any(gap.drag for gap in self.gaps)

    def key(self) -> tuple[Any, ...]:
        """Return all that the texts depend on; `Network(*key)` is an equal network."""
        return tuple([_fixed(each) for each in _values(self)])


_values = attrgetter(*(each.name for each in fields(Network)))


def line_pressures(network: Network) -> dict[str, str]:
    """Return the text of each line's pressure [Pa], by the symbol that kernels ask for."""
    return {name: f"R[R_{cell} + PRESSURE]" for name, cell in zip(PRESSURES, network.lines, strict=True)}


def _fixed(value: Any) -> Any:
    return tuple(value.items()) if isinstance(value, dict) else tuple(value) if isinstance(value, list) else value


@cache
def identifier(name: str) -> str:
    """Return a name as part of an identifier."""
    return re.sub(r"\W", "_", name)
