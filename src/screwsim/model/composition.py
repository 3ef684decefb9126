"""The result of composing the parts of a scene: texts with the layout that they fix, and the numbers that go in."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from screwsim.model.own_cells import OwnCells, own_cells
from screwsim.model.slots import OF_GAS, P_PORT_WIDTH, Q_WALLS
from screwsim.numerics.identity_cache import once


class StoredNumber(NamedTuple):
    """A number of P that is stored in parts: its index, which holder has it, under which name, and how."""

    place: int
    holder: int
    name: str
    by_key: bool  # whether the holder is a mapping


@dataclass(frozen=True)
class NumbersRecipe:
    """P as composed, and which of its numbers may change, by index and name, while the structure stays."""

    P: np.ndarray
    places: list[int]
    names: list[str]  # as in `numbers.operating`
    held: tuple[StoredNumber, ...] | None = None  # where the other numbers are stored in parts; None where some are not
    angles: tuple[Any, ...] = ()  # from which the breakpoints follow
    law: Any = None  # of the volume, as read: its file may have changed since


@dataclass(frozen=True)
class Structure:
    """The texts of a model and the layout that they fix: the same for scenes that differ in numbers only."""

    text: str
    together: Callable[[], str] = field(compare=False)  # writes the text of all chambers on demand
    states: tuple[str, ...]
    own_states: tuple[str, ...]  # the last of `states`: those that effects declare
    signed: tuple[int, ...]  # columns of states that may be zero or negative
    stops: tuple[tuple[int, int], ...]  # columns of position and speed of what moves between seat and stop
    ports: tuple[str, ...]  # effects of the paths to lines and plenums
    gaps: tuple[tuple[str, int], ...]  # effect, lobe offset
    offsets: tuple[int, ...]  # lobe pitches between neighbours that gaps connect
    heats: tuple[str, ...]  # effects of the heat rates
    walls: tuple[str, ...]  # effects of the walls
    chambers: int
    carried: bool
    ported: bool
    pulsating: bool
    pushes: bool  # whether walls that drag oil along do work on it
    width: int  # sums in each category
    n_sums: int
    n_port_state: int  # columns of a history beyond the states
    n_films: int  # flows of oil beside the gas into a chamber: ahead and behind of each gap, then through ports
    n_widths: int  # of the regularisation, from P_PORT_WIDTH on
    n_R: int
    n_E: int
    n_E_all: int
    n_work_all: int  # size of the working array for all chambers

    @property
    def dissolves(self) -> bool:
        """Whether the gas dissolved in oil is a state."""
        return self.width == 5

    @property
    def widths(self) -> slice:
        """The slice of P with the widths of the regularisation [Pa; gaps: a share]."""
        return slice(P_PORT_WIDTH, P_PORT_WIDTH + self.n_widths)

    @once
    def own(self) -> OwnCells:
        """Where a chamber keeps what it has beside its states."""
        return own_cells(len(self.ports), len(self.stops))

    @property
    def n_flows(self) -> int:
        """Number of flows into a chamber: through each port, then each gap ahead and behind."""
        return len(self.ports) + 2 * len(self.gaps)

    def flow_through(self, gap: int, side: int) -> int:
        """Return the column, among the flows into a chamber, of a gap's side (AHEAD or BEHIND)."""
        return len(self.ports) + 2 * gap + side

    @once
    def all_met(self) -> slice:
        """The quadratures of the gas from chambers ahead and behind, by offset."""
        first = Q_WALLS + 2 * len(self.walls)
        return slice(first, first + 2 * len(self.offsets))

    def met(self, offset: int, side: int) -> int:
        """Return the quadrature of the gas from the chamber ahead or behind, for the number of an offset."""
        return self.all_met.start + 2 * offset + side

    @once
    def first_stream(self) -> int:
        """Index, among the quadratures, of the first of the streams' sums."""
        return self.all_met.stop + self.pushes

    def stream(self, category: int) -> int:
        """Return the quadrature of the gas of a stream (`slots.SUCTION_IN` …)."""
        return self.first_stream + self.width * category + OF_GAS

    @property
    def n_quadratures(self) -> int:
        """Number of quadratures: work, heat, walls, gas from neighbours, work on dragged oil, the streams' sums."""
        return self.first_stream + self.n_sums


@dataclass(frozen=True)
class Composition(Structure):
    """A model ready to be compiled (`text`) and run (`P`, `TAB`, `breakpoints`)."""

    P: np.ndarray
    TAB: np.ndarray
    breakpoints: np.ndarray  # of one chamber's life, including neighbours' [rad]
    recipe: NumbersRecipe
    ends: tuple[str, ...]  # of ports and gaps: the line or plenum that outflow goes to
    made: tuple[int, ...]  # indices in P of unknowns that the cycle determines
    speed_curve: int | None  # index in P of the squared relative speed's table (speed.slowness)
    starts: tuple[float, ...]  # initial values of the own states
