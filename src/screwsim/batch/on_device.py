"""Turns of many points of one structure on a GPU, each in its own thread, in double precision.

The text is that of a single point, compiled for the device by the same compiler (`codegen.device_library`). What a turn
reads and writes is copied there in one block; everything between turns stays on the processor, as with lanes
(`batch.tasks`).
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from itertools import accumulate
from typing import Any

import numpy as np

from screwsim.batch.driver import Driver
from screwsim.codegen.kinds import FLOAT, INTEGER, Kind, array, words_of
from screwsim.inputs.faults import UsageError
from screwsim.model.run import Machinery
from screwsim.model.side_by_side import AXES, TURN, WHOLE, Answer, TurnRequest, arrays_of
from screwsim.model.trajectory import ChamberContext
from screwsim.numerics.rodas import TOO_MANY_STEPS

Array = np.ndarray
STEPS = 512  # steps of a turn for which the device has room, at first ...
MOST_STEPS = 8192  # ... and at most
NO_ROOM = "the GPU has no memory for {} points at once; use fewer (screwsim.batch.together with in_flight={})"
_FIELDS = ChamberContext._fields
CONTEXT = Kind("c", tuple(array(INTEGER if n in WHOLE else FLOAT, AXES.get(n, 1)) for n in _FIELDS), names=_FIELDS)
GIVEN: dict[str, Kind] = {
    "breakpoints": array(FLOAT, 1),
    "n_breakpoints": INTEGER,
    "y": array(FLOAT, 1),
    "q": array(FLOAT, 1),
    "context": CONTEXT,
    "rtol": FLOAT,
    "h": FLOAT,
    "n_E": INTEGER,
    "times": array(FLOAT, 1),
    "dense": array(FLOAT, 3),
    "quads": array(FLOAT, 2),
    "kept": array(INTEGER, 1),
    "counts": array(INTEGER, 1),
}
KINDS = tuple(GIVEN.values())
N_E = tuple(GIVEN).index("n_E")
OWN = ("y", "q", "P", "R", "state", "own", "counts", "kept", "hints")  # arrays copied there and back, one row per point
NEW = {"t_new": "times", "d_new": "dense", "quads": "quads"}  # arrays of the new history: in a context, here


class DeviceTurns:
    """Turns of one structure on a device, any number in one call."""

    def __init__(self, like: Machinery, device: Driver) -> None:
        self.device, self.steps = device, STEPS  # steps of a turn for which there is room
        self._turns = device.turns(*turns_arguments(like))
        self._room, self._size = 0, 0  # allocated on the device: address and words
        self._alone = threading.Lock()

    def turns(self, asked: Sequence[TurnRequest]) -> list[Answer]:
        """Integrate a life of each; store each result where `Machinery.turn` would.

        A turn with too many steps for the allocated room is integrated by the processor; the next call
        allocates more.
        """
        with self._alone:
            call = _Call(asked, self.steps)
            self._make_room(call)
            results = call.run(self.device, self._turns, self._room)
            answers = [self._answer(each, call, i, results[i]) for i, each in enumerate(asked)]
            most = max(int(each.machinery.lives.kept[0]) for each in asked)
            if most > self.steps:
                self.steps = min(MOST_STEPS, 2 * most)
            return answers

    def _answer(self, each: TurnRequest, call: _Call, i: int, result: Array) -> Answer:
        """Return the result of a turn, integrating it here if the device had too little room."""
        status = int(result[:1].view(np.int64)[0])
        if status == TOO_MANY_STEPS and self.steps < each.machinery.lives.max_steps:
            return each.machinery.own_turn(each.y, each.rtol, each.h)
        return status, float(result[1]), call.put(each, i)

    def _make_room(self, call: _Call) -> None:
        """Allocate memory for a call where there is not enough."""
        if call.size <= self._size:
            return
        if self._size:
            self.device.free(self._room)
            self._size = 0
        try:
            self._room = self.device.room(call.size)
        except MemoryError:
            raise UsageError(NO_ROOM.format(call.count, max(1, call.count // 2))) from None
        self._size = call.size


def turns_arguments(like: Machinery) -> tuple[Any, str, tuple[Kind, ...], dict[int, int]]:
    """Return the arguments of `Driver.turns`: module, function, kinds of arguments, known arguments."""
    return like.module, TURN, KINDS, {N_E: like.composition.n_E}


def ptx_of(like: Machinery) -> bytes:
    """Return the PTX of a structure's turns, compiled or from the cache; no device is needed."""
    module, *asked = turns_arguments(like)
    return module.of_device(*asked)


class _Call:
    """The memory layout of a call: contiguous blocks with one row for each point, in words of 8 bytes."""

    def __init__(self, asked: Sequence[TurnRequest], steps: int) -> None:
        self.asked, self.count, self.steps = asked, len(asked), steps
        like = asked[0].machinery
        self.arrays = [arrays_of(each) for each in asked]
        first = self.arrays[0]
        lengths = [len(first[name]) for name in OWN]
        self.columns: dict[str, int] = dict(zip(OWN, accumulate(lengths, initial=0), strict=False))
        self.own_size = sum(lengths)
        self.old = [each.machinery.lives.last() for each in asked]
        self.most_old = max(1, *(steps for *_, steps in self.old))
        tables = {id(each.machinery.composition.TAB): each.machinery.composition.TAB for each in asked}
        self.tables = list(tables.values())
        self.which = [list(tables).index(id(each.machinery.composition.TAB)) for each in asked]
        self.breakpoints = [each.machinery.composition.breakpoints for each in asked]
        _, dense, quads = like.lives.histories[1]
        self.shapes: dict[str, tuple[int, ...]] = {  # of one row of each block
            "own": (self.own_size,),
            "breakpoints": (max(map(len, self.breakpoints)),),
            "tables": (max(map(len, self.tables)),),
            "t_old": (self.most_old + 1,),
            "d_old": (self.most_old, *dense.shape[1:]),
            "words": (sum(map(words_of, KINDS)),),
            "results": (3,),
            "t_new": (steps + 1,),
            "d_new": (steps, *dense.shape[1:]),
            "quads": (steps, quads.shape[1]),
        }
        rows = {name: len(self.tables) if name == "tables" else self.count for name in self.shapes}
        sizes = [rows[name] * int(np.prod(shape)) for name, shape in self.shapes.items()]
        self.at = dict(zip(self.shapes, accumulate(sizes, initial=0), strict=False))
        self.size = sum(sizes)
        self.given = np.zeros(self.at["results"])  # the part that is copied to the device
        self.blocks = {
            name: self.given[self.at[name] : self.at[name] + rows[name] * int(np.prod(shape))].reshape(-1, *shape)
            for name, shape in self.shapes.items()
            if self.at[name] < len(self.given)
        }
        self.own = {name: self._of(name) for name in OWN}

    def run(self, device: Driver, turns: Any, room: int) -> Array:
        """Copy everything there, run the turns, and copy back what they wrote; return a row of results for each."""
        self._fill()
        self._write_words(room)
        device.up(room, self.given)
        at = {name: room + 8 * first for name, first in self.at.items()}
        device.run(turns, at["words"], at["results"], self.count)
        results = np.empty((self.count, 3))
        device.down(results, at["results"], 3)
        device.down(self.blocks["own"], at["own"], self.own_size)
        most = int(self.own["kept"][:, 0].max())
        self.new = {}
        for name, (steps, *others) in ((name, self.shapes[name]) for name in NEW):
            rows = np.empty((self.count, most + (name == "t_new"), *others))
            if rows.size:
                device.down(rows, at[name], steps * int(np.prod(others)))
            self.new[name] = rows
        return results

    def _of(self, name: str) -> Array:
        """Return the columns of one array in the rows of all points."""
        end = [*self.columns.values(), self.own_size][OWN.index(name) + 1]
        found = self.blocks["own"][:, self.columns[name] : end]
        return found.view(np.int64) if name in ("counts", *WHOLE) else found

    def _fill(self) -> None:
        """Write the arrays of all points into the blocks."""
        blocks = self.blocks
        for i, arrays in enumerate(self.arrays):
            for name, column in self.own.items():
                column[i] = arrays[name]
        for i, (angles, (times, dense, _, steps)) in enumerate(zip(self.breakpoints, self.old, strict=True)):
            blocks["breakpoints"][i, : len(angles)] = angles
            blocks["t_old"][i, : steps + 1], blocks["d_old"][i, :steps] = times[: steps + 1], dense[:steps]
        for row, table in zip(blocks["tables"], self.tables, strict=True):
            row[: len(table)] = table

    def _write_words(self, room: int) -> None:
        """Write the arguments of each thread: addresses and sizes of arrays, and numbers."""
        words = self.blocks["words"].view(np.int64)
        rows, column = np.arange(self.count), 0

        def add(*numbers: Any) -> None:
            nonlocal column
            for each in numbers:
                words[:, column] = each
                column += 1

        def add_array(name: str) -> None:
            if name in self.columns:
                first, stride, shape = self.columns[name], self.own_size, (self.own[name].shape[1],)
                add(room + 8 * (self.at["own"] + first + rows * stride), *shape)
                return
            block = "tables" if name == "TAB" else name
            of = np.array(self.which) if name == "TAB" else rows
            add(room + 8 * (self.at[block] + of * int(np.prod(self.shapes[block]))), *self.shapes[block])

        new = {other: name for name, other in NEW.items()}
        for name in GIVEN:
            match name:
                case "n_breakpoints":
                    add([len(angles) for angles in self.breakpoints])
                case "context":
                    for field in ChamberContext._fields:
                        add_array(field)
                case "rtol" | "h":
                    add(np.array([getattr(each, name) for each in self.asked]).view(np.int64))
                case "n_E":
                    add(self.asked[0].machinery.composition.n_E)
                case _:
                    add_array(new.get(name, name))

    def put(self, each: TurnRequest, i: int) -> Array:
        """Store a point's numbers and history in its machinery; return its quadratures."""
        for name, column in self.own.items():
            self.arrays[i][name][:] = column[i]
        steps = int(each.machinery.lives.kept[0])
        times, dense, quads = each.machinery.lives.histories[1]
        times[: steps + 1] = self.new["t_new"][i, : steps + 1]
        dense[:steps], quads[:steps] = self.new["d_new"][i, :steps], self.new["quads"][i, :steps]
        return self.arrays[i]["q"]
