"""What is composed of the parts of a scene: texts to be compiled, the numbers that go in, and what is where."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from screwsim.model.slots import P_PORT_WIDTH, Q_WALLS, R_SIZE
from screwsim.numerics.remembered import once


@dataclass(frozen=True)
class Recipe:
    """P as it was composed, and which of its numbers, by place and name, may be others while the structure stays."""

    P: np.ndarray
    places: list[int]
    names: list[str]  # of `writing.operating`
    held: tuple[Held, ...] | None = None  # where the rest of them stand in parts; None where some stand nowhere
    angles: tuple[Any, ...] = ()  # that the breakpoints follow from
    law: Any = None  # of the volume, as it was read: its file may be another by now, or gone


class Held(NamedTuple):
    """A number of P that parts hold: its place, in which of what holds numbers it stands, as what, and how."""

    place: int
    holder: int
    name: str
    by_key: bool  # is the holder a mapping


@dataclass(frozen=True)
class Composition:
    """A model ready to be compiled (`text`) and run (`P`, `TAB`, `breakpoints`)."""

    text: str
    together: Callable[[], str] = field(compare=False)  # the text of all chambers, written when it is asked for
    along: Callable[[], str] = field(compare=False)  # that with the change of their rates along one of their numbers
    P: np.ndarray
    TAB: np.ndarray
    breakpoints: np.ndarray  # of one chamber's life, neighbours' included [rad]
    states: tuple[str, ...]
    plenum_paths: tuple[str, ...]
    gap_paths: tuple[tuple[str, int], ...]  # effect, lobe offset
    ends: tuple[str, ...]  # of plenum paths and gaps: line or plenum to which what leaves through them goes
    heats: tuple[str, ...]  # the effect of each heat rate
    n_port_state: int  # columns of a history beyond the states
    n_sums: int
    n_E: int
    n_E_all: int
    chambers: int
    carried: bool
    recipe: Recipe
    width: int = 2  # sums of each category
    n_widths: int = 3  # of the regularisation, from P_PORT_WIDTH on
    n_R: int = R_SIZE
    ported: bool = False
    oil_room: bool = False
    walls: tuple[str, ...] = ()  # the effect of each wall
    made: tuple[int, ...] = ()  # where the numbers that the cycle makes stand in P
    speed_curve: int | None = None  # where in P the square of the speed over its mean begins (speed.slowness)
    own_states: tuple[str, ...] = ()  # the last of `states`: those that effects declare
    stops: tuple[tuple[int, int], ...] = ()  # columns of position and speed of what moves between seat and stop
    signed: tuple[int, ...] = ()  # columns of the states that may be zero or negative
    starts: tuple[float, ...] = ()  # of the own states
    pulsating: bool = False
    pushes: bool = False  # do walls that drag oil along do work on it?
    offsets: tuple[int, ...] = ()  # lobe pitches between neighbours that gaps join
    n_work_all: int = 0  # numbers that the functions of all chambers write aside

    @property
    def dissolves(self) -> bool:
        """Is what the oil holds dissolved a state?"""
        return self.width == 5

    @property
    def widths(self) -> slice:
        """Where the widths of the regularisation stand in P."""
        return slice(P_PORT_WIDTH, P_PORT_WIDTH + self.n_widths)

    @once
    def first_met(self) -> int:
        """Index of the gas from the chambers ahead and behind, by offset, among the quadratures of one chamber."""
        return Q_WALLS + 2 * len(self.walls)

    @once
    def first_stream(self) -> int:
        """Index of the first of the streams' sums among the quadratures."""
        return self.first_met + 2 * len(self.offsets) + self.pushes

    @property
    def n_quadratures(self) -> int:
        """Work, heat, those of the walls, gas from neighbours, what dragged oil gives the walls, the streams' sums."""
        return self.first_stream + self.n_sums
