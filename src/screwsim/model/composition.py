"""The result of composing the parts of a scene: module texts, the numbers that go in, and the layout of both."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from screwsim.model.slots import P_PORT_WIDTH, Q_WALLS
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
class Composition:
    """A model ready to be compiled (`text`) and run (`P`, `TAB`, `breakpoints`)."""

    text: str
    together: Callable[[], str] = field(compare=False)  # writes the text of all chambers on demand
    P: np.ndarray
    TAB: np.ndarray
    breakpoints: np.ndarray  # of one chamber's life, including neighbours' [rad]
    states: tuple[str, ...]
    plenum_paths: tuple[str, ...]
    gap_paths: tuple[tuple[str, int], ...]  # effect, lobe offset
    ends: tuple[str, ...]  # of plenum paths and gaps: the line or plenum that outflow goes to
    heats: tuple[str, ...]  # effects of the heat rates
    n_port_state: int  # columns of a history beyond the states
    n_sums: int
    n_E: int
    n_E_all: int
    chambers: int
    carried: bool
    recipe: NumbersRecipe
    width: int  # sums in each category
    n_widths: int  # of the regularisation, from P_PORT_WIDTH on
    n_R: int
    ported: bool
    oil_room: bool
    walls: tuple[str, ...]  # effects of the walls
    made: tuple[int, ...]  # indices in P of unknowns that the cycle determines
    speed_curve: int | None  # index in P of the squared relative speed's table (speed.slowness)
    own_states: tuple[str, ...]  # the last of `states`: those that effects declare
    stops: tuple[tuple[int, int], ...]  # columns of position and speed of what moves between seat and stop
    signed: tuple[int, ...]  # columns of states that may be zero or negative
    pulsating: bool
    pushes: bool  # whether walls that drag oil along do work on it
    offsets: tuple[int, ...]  # lobe pitches between neighbours that gaps connect
    n_work_all: int  # size of the working array for all chambers
    starts: tuple[float, ...] = ()  # initial values of the own states

    @property
    def dissolves(self) -> bool:
        """Whether the gas dissolved in oil is a state."""
        return self.width == 5

    @property
    def widths(self) -> slice:
        """The slice of P with the widths of the regularisation [Pa; gaps: a share]."""
        return slice(P_PORT_WIDTH, P_PORT_WIDTH + self.n_widths)

    @once
    def first_met(self) -> int:
        """Index, among a chamber's quadratures, of the gas from chambers ahead and behind, by offset."""
        return Q_WALLS + 2 * len(self.walls)

    @once
    def first_stream(self) -> int:
        """Index, among the quadratures, of the first of the streams' sums."""
        return self.first_met + 2 * len(self.offsets) + self.pushes

    @property
    def n_quadratures(self) -> int:
        """Number of quadratures: work, heat, walls, gas from neighbours, work on dragged oil, the streams' sums."""
        return self.first_stream + self.n_sums
