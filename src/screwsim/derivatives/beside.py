"""Rates at all nodes with several numbers: side by side in the lanes of a core, each lane with its own.

Lanes take as long to write as some thousand rates take one by one, so they are written where code is asked for speed,
taken where they are kept, and otherwise wait until that much has been asked.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from screwsim.codegen import modules
from screwsim.codegen.kinds import FLOAT, INTEGER, LANES, Kind
from screwsim.codegen.program import CannotCompile
from screwsim.derivatives.pitch import Numbers, Pitch
from screwsim.derivatives.slices import NODES
from screwsim.model.contexts import CoupledContext
from screwsim.model.run import Machinery
from screwsim.model.side_by_side import address, aligned

Array = np.ndarray
RATES = "slices__rates_at_all"
FEWEST = 5  # rates that lanes are worth
PATIENCE = 4.0  # [s] that rates run one by one before lanes are written: about what that takes
BESIDE = ("P", "R", "places", "work")  # of a context: laid side by side
_whole, _beside = Kind("v", (FLOAT,), 1), Kind("p", (FLOAT,), 1)
_CONTEXT = Kind(
    "c",
    tuple(_beside if name in BESIDE else _whole for name in CoupledContext._fields),
    names=CoupledContext._fields,
)
_ALL, _ROWS = Kind("a", (FLOAT,), 1), Kind("p", (FLOAT,), 2)
KINDS = (_whole, _ALL, Kind("a", (FLOAT,), 2), _CONTEXT, INTEGER, _ROWS, _ROWS)


class Asked(NamedTuple):
    """Numbers that rates are asked with, and edges [rad] of the slices; None for those of the pitch."""

    numbers: Numbers
    edges: Array | None


class _Waiting:
    """Of one module: how long rates ran one by one, and the entry of its lanes, once there."""

    def __init__(self) -> None:
        self.ran, self.entry, self.none = 0.0, None, False


_waiting: dict[str, _Waiting] = {}


def rates_of(pitch: Pitch, Y: Array, asked: Sequence[Asked]) -> tuple[Array, Array]:
    """Return rates of states and quadratures at the nodes (slices, NODES, …, asked); numbers stand as they stood."""
    found = [np.empty((pitch.count, NODES, size, len(asked))) for size in (pitch.N, pitch.q)]
    waiting = _waiting.setdefault(pitch.machinery.together.__name__, _Waiting())
    entry = _entry(pitch.machinery, waiting) if len(asked) >= FEWEST else None
    done = 0
    while entry is not None and len(asked) - done >= FEWEST:
        now = asked[done : done + LANES]
        for all_, rows in zip(found, _in_lanes(pitch, Y, now, entry), strict=True):
            all_[..., done : done + len(now)] = rows.reshape(*all_.shape[:-1], LANES)[..., : len(now)]
        done += len(now)
    started, at = time.perf_counter(), pitch.numbers
    for i, (numbers, edges) in enumerate(asked[done:], done):
        pitch.put(numbers)
        for all_, rates in zip(found, pitch.rates(Y, edges), strict=True):
            all_[..., i] = rates
    pitch.put(at)
    waiting.ran += time.perf_counter() - started
    return found[0], found[1]


def _entry(machinery: Machinery, waiting: _Waiting) -> Any:
    """Return the entry of the lanes, written where it is time; None where they wait or cannot be written."""
    if waiting.entry is None and not waiting.none:
        module = machinery.together
        if waiting.ran > PATIENCE or modules.hurried() or module.has_lanes(RATES, KINDS):
            try:
                with machinery.compiling("numbers"):
                    waiting.entry = module.of_lanes(RATES, KINDS)
            except CannotCompile:
                waiting.none = True
    return waiting.entry


def _in_lanes(pitch: Pitch, Y: Array, asked: Sequence[Asked], entry: Any) -> tuple[Array, Array]:
    """Return rates at the nodes (nodes, …, lanes), each lane with its own numbers."""
    machinery, slices = pitch.machinery, pitch.slices
    places, work = machinery.coupled_space()["spaces"]
    pitch.free()
    rows = {"places": aligned(len(places)), "work": aligned(len(work))}
    rows["places"][:], rows["work"][:] = places[:, None], work[:, None]
    for name in ("P", "R"):
        rows[name] = aligned(len(getattr(asked[0].numbers, name)))
        for lane, (numbers, _) in enumerate(asked):
            rows[name][:, lane] = getattr(numbers, name)
    by_lane = {
        "angles": [(slices if e is None else slices._replace(edges=e)).angles.ravel() for _, e in asked],
        "TAB": [np.ascontiguousarray(numbers.TAB) for numbers, _ in asked],
    }
    middles, y = np.repeat(slices.middles, NODES), np.ascontiguousarray(Y).reshape(-1, pitch.N)
    out = [aligned(len(y) * size).reshape(len(y), size, LANES) for size in (pitch.N, pitch.q)]
    words: list[int] = [(1 << len(asked)) - 1]

    def lanes(name: str) -> None:
        addresses = [address(each) for each in by_lane[name]]
        words.extend([*addresses, *[addresses[0]] * (LANES - len(addresses)), *by_lane[name][0].shape])

    lanes("angles")
    words.extend([address(middles), *middles.shape, address(y), *y.shape])
    for name in CoupledContext._fields:
        if name in rows:
            words.extend([address(rows[name]), len(rows[name])])
        else:
            lanes(name)
    words.append(machinery.composition.n_E_all)
    for each in out:
        words.extend([address(each), *each.shape[:2]])
    held = np.array(words, np.int64)  # as long as the call looks at it
    entry(held.ctypes.data, None)
    return out[0], out[1]
