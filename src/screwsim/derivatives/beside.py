"""Rates at all nodes with several numbers: side by side in the lanes of a core, each lane with its own.

Lanes are written when they are first asked for, in seconds, and kept: what runs in them does not depend on what ran
before, so that one scene has one answer.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from screwsim.codegen.kinds import FLOAT, INTEGER, LANES, Kind
from screwsim.codegen.program import CannotCompile
from screwsim.derivatives.pitch import Numbers, Pitch
from screwsim.derivatives.slices import NODES
from screwsim.model.contexts import CoupledContext
from screwsim.model.run import Machinery
from screwsim.model.side_by_side import address, aligned

Array = np.ndarray
RATES = "slices__rates_at_all"
FEWEST = 4  # rates that lanes are worth
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


_entries: dict[str, Any] = {}  # of lanes by module; None where its text cannot be so compiled


def rates_of(pitch: Pitch, Y: Array, asked: Sequence[Asked]) -> Iterator[tuple[slice, Array, Array]]:
    """Yield which of those asked, their rates of states and quadratures at the nodes (slices, NODES, …, LANES).

    As many at a time as there are lanes; behind the last ones the rest of them is nothing; numbers stand as they stood.
    """
    at, shape = pitch.numbers, (pitch.count, NODES)
    for first in range(0, len(asked), LANES):
        now = asked[first : first + LANES]
        entry = _entry(pitch.machinery) if len(now) >= FEWEST else None
        if entry is not None:
            found = [each.reshape(*shape, -1, LANES) for each in _in_lanes(pitch, Y, now, entry)]
        else:
            found = [np.zeros((*shape, size, LANES)) for size in (pitch.N, pitch.q)]
            for i, (numbers, edges) in enumerate(now):
                pitch.put(numbers)
                found[0][..., i], found[1][..., i] = pitch.rates(Y, edges)
            pitch.put(at)
        yield slice(first, first + len(now)), found[0], found[1]


def _entry(machinery: Machinery) -> Any:
    """Return the entry of the lanes; None where they cannot be written."""
    module = machinery.together
    if module.__name__ not in _entries:
        try:
            with machinery.compiling("numbers"):
                _entries[module.__name__] = module.of_lanes(RATES, KINDS)
        except CannotCompile:
            _entries[module.__name__] = None
    return _entries[module.__name__]


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
