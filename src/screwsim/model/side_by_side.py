"""Turns of several points of one structure in one call: each in a lane, with its own angle, step and tolerance.

Small arrays are interleaved for the call and copied back after it; histories and tables stay in place.
"""

import ctypes
import threading
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from screwsim.codegen.kinds import FLOAT, FLOATS, INTEGER, INTEGERS, LANES, Kind
from screwsim.model.run import Machinery
from screwsim.model.trajectory import ChamberContext

Array = np.ndarray
TURN = "rodas__integrate_one"
LANE_ARRAYS = ("P", "R", "kept", "hints", "state", "own")  # arrays of a context that are interleaved
WHOLE = ("kept", "hints")  # integer arrays


def _kind(name: str, of: Kind, axes: int) -> Kind:
    """Return the kind of an argument that is an array."""
    return Kind(name, (of,), axes)


AXES = {"d_old": 3, "d_new": 3}
_CONTEXT = Kind(
    "c",
    tuple(
        _kind("p" if name in LANE_ARRAYS else "v", INTEGER if name in WHOLE else FLOAT, AXES.get(name, 1))
        for name in ChamberContext._fields
    ),
    names=ChamberContext._fields,
)
KINDS = (
    *(_kind("v", FLOAT, 1), INTEGERS),  # breakpoints, and how many
    *(_kind("p", FLOAT, 1), _kind("p", FLOAT, 1)),  # y, q
    *(_CONTEXT, FLOATS, FLOATS, INTEGER),  # tolerance, first step, size of the surroundings
    *(_kind("v", FLOAT, 1), _kind("v", FLOAT, 3), _kind("v", FLOAT, 2)),  # the history that is written
    *(_kind("p", INTEGER, 1), _kind("p", INTEGER, 1)),  # kept, counts
)


class TurnRequest(NamedTuple):
    """A turn to be integrated: machinery, initial state (changed in place), tolerance and first step."""

    machinery: Machinery
    y: Array
    rtol: float
    h: float


Answer = tuple[int, float, Array]  # as returned by `Machinery.turn`


def arrays_of(each: TurnRequest) -> dict[str, Array]:
    """Return all arrays that a turn reads and writes, by name; its quadratures are new."""
    machinery = each.machinery
    more = {"y": each.y, "q": np.zeros(machinery.nq), "counts": machinery.counts}
    more |= {"breakpoints": machinery.composition.breakpoints, "quads": machinery.lives.histories[1][2]}
    return more | dict(zip(ChamberContext._fields, machinery.context, strict=True))


class Lanes:
    """Turns of one structure side by side."""

    def __init__(self, like: Machinery) -> None:
        self.entry = like.module.of_lanes(TURN, KINDS)
        arrays = arrays_of(TurnRequest(like, np.empty(like.n), 0.0, 0.0))
        self._rows = {
            name: aligned(len(arrays[name]), arrays[name].dtype) for name in ("y", "q", "counts", *LANE_ARRAYS)
        }
        self._out = np.zeros(3 * LANES)
        self._n_E = like.composition.n_E
        self._alone = threading.Lock()  # serialises two threads of a worker

    def turns(self, requests: Sequence[TurnRequest]) -> list[Answer]:
        """Integrate a life of each, at most as many as there are lanes: interleave their arrays, copy them back."""
        named = [arrays_of(each) for each in requests]
        with self._alone:
            for name, rows in self._rows.items():
                for lane, arrays in enumerate(named):
                    rows[:, lane] = arrays[name]
            self._out[:] = 0.0
            words = self._words(requests, named)  # keeps the memory alive during the call
            self.entry(words.ctypes.data, self._out.ctypes.data)
            for name, rows in self._rows.items():
                for lane, arrays in enumerate(named):
                    arrays[name][:] = rows[:, lane]
            status, angles = self._out[:LANES].view(np.int64), self._out[LANES : 2 * LANES]
            return [(int(status[i]), float(angles[i]), named[i]["q"]) for i in range(len(requests))]

    def _words(self, requests: Sequence[TurnRequest], named: Sequence[dict[str, Array]]) -> Array:
        """Return the arguments of the call in words of 64 bits; idle lanes repeat those of the first."""
        words: list[float | int] = [(1 << len(requests)) - 1]
        idle = LANES - len(requests)

        def each(numbers: Sequence[Any]) -> None:
            words.extend(numbers)
            words.extend([numbers[0]] * idle)

        def floats(numbers: Sequence[float]) -> None:
            each(np.array(numbers).view(np.int64).tolist())

        def array(name: str) -> None:
            shape = named[0][name].shape if name not in self._rows else self._rows[name].shape[:1]
            if name in self._rows:
                words.append(self._rows[name].ctypes.data)
            else:
                each([address(arrays[name]) for arrays in named])
                shape = (min(len(arrays[name]) for arrays in named), *shape[1:])
            words.extend(shape)

        array("breakpoints")
        each([len(arrays["breakpoints"]) for arrays in named])
        for name in ("y", "q", *ChamberContext._fields):
            array(name)
        floats([one.rtol for one in requests])
        floats([one.h for one in requests])
        words.append(self._n_E)
        for name in ("t_new", "d_new", "quads", "kept", "counts"):
            array(name)
        return np.array(words, np.int64)


def aligned(rows: int, of: Any = float, room: Callable[..., Array] = np.zeros) -> Array:
    """Return rows of lanes, each in one cache line; `room` makes an array of a size and type."""
    raw = room((rows + 1) * LANES, of)
    skip = -raw.ctypes.data % 64 // raw.itemsize
    return raw[skip : skip + rows * LANES].reshape(rows, LANES)


def address(table: Array) -> int:
    """Return the memory address of a table's numbers."""
    if table.flags.writeable and table.size:
        return ctypes.addressof(ctypes.c_char.from_buffer(table))  # type: ignore[arg-type]
    return table.ctypes.data  # the same, slower
