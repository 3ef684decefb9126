"""Rates at all nodes, computed side by side in the lanes of a core, each lane with its own numbers or its own nodes.

Kernels for lanes are compiled on first use, which takes seconds, and kept. The result in a lane does not depend on
earlier calls, so a scene always gives the same answer.
"""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple, Self

import numpy as np

from screwsim.codegen.kinds import FLOAT, INTEGER, LANES, Kind
from screwsim.codegen.program import CannotCompile
from screwsim.derivatives.node_rates import NodeRates
from screwsim.derivatives.radau import NODES
from screwsim.derivatives.rate_numbers import RateNumbers
from screwsim.model.run import Machinery
from screwsim.model.side_by_side import address, aligned
from screwsim.model.trajectory import CoupledContext
from screwsim.numerics.reused_arrays import empty

Array = np.ndarray
RATES = "slices__rates_at_all"
FEWEST_LANES = 4  # sets of rates from which on lanes pay
LANE_ARRAYS = ("P", "R", "port_states", "work")  # parts of a context that are interleaved by lane
_whole, _beside = Kind("v", (FLOAT,), 1), Kind("p", (FLOAT,), 1)
_CONTEXT = Kind(
    "c",
    tuple(_beside if name in LANE_ARRAYS else _whole for name in CoupledContext._fields),
    names=CoupledContext._fields,
)
_ROWS = Kind("p", (FLOAT,), 2)
KINDS = (_whole, _whole, Kind("v", (FLOAT,), 2), _CONTEXT, INTEGER, _ROWS, _ROWS)


class LaneRows(NamedTuple):
    """The addresses of each lane's rows, their shape, and the arrays that own the memory."""

    addresses: list[int]
    shape: tuple[int, ...]
    held: Any

    @classmethod
    def each(cls, arrays: Sequence[Array]) -> Self:
        """Return one array for each lane; unused lanes point to the first array."""
        first, *others = arrays = [np.ascontiguousarray(each) for each in arrays]
        at = address(first)
        addresses = [at, *(at if each is first else address(each) for each in others)]
        return cls([*addresses, *[at] * (LANES - len(addresses))], first.shape, arrays)

    @classmethod
    def parts(cls, whole: Array, part: int) -> Self:
        """Return rows of an array for each lane, `part` of them; missing rows at the end repeat the last one.

        Lanes take rows in turn: nodes side by side are near each other, so that the same ports are open in all.
        """
        rows = np.empty((part, LANES, *whole.shape[1:]))
        flat = rows.reshape(part * LANES, *whole.shape[1:])
        flat[: len(whole)], flat[len(whole) :] = whole, whole[-1]
        dealt = np.ascontiguousarray(rows.swapaxes(0, 1))
        at, step = address(dealt), dealt.strides[0]
        return cls([at + step * lane for lane in range(LANES)], dealt.shape[1:], dealt)


class Nodes(NamedTuple):
    """Where rates are evaluated: angles [rad], angles [rad] that select segments of the laws, states, a row each."""

    angles: LaneRows
    middles: LaneRows
    y: LaneRows


class RateRequest(NamedTuple):
    """The numbers for a set of rates, and the edges [rad] of the slices; None for those of the pitch."""

    numbers: RateNumbers
    edges: Array | None


_entries: dict[str, Any] = {}  # entries of compiled lanes by module; None where its text cannot be compiled so


def rates(of: NodeRates, Y: Array, edges: Array | None = None) -> tuple[Array, Array]:
    """Return the same as `NodeRates.at`, each lane computing a part of the nodes."""
    entry = _entry(of.machinery)
    if entry is None:
        return of.at(Y, edges)
    mesh, of_nodes = of.mesh if edges is None else of.mesh.with_edges(edges), of.mesh.of_nodes
    asked = mesh.angles.ravel(), mesh.middles[of_nodes], Y.reshape(len(of_nodes), -1)
    found, numbers = [], [RateNumbers.of(of.machinery)]
    for rows in of.held.runs(of_nodes):
        some = rows.stop - rows.start
        part = -(-some // LANES)
        nodes = Nodes(*(LaneRows.parts(each[rows], part) for each in asked))
        lanes = _in_lanes(of, nodes, numbers * LANES, entry)
        found.append([each.swapaxes(1, 2).reshape(LANES * part, -1)[:some] for each in lanes])
    f, g = _concatenated(found)
    return f.reshape(mesh.count, NODES, -1), g.reshape(mesh.count, NODES, -1)


def _concatenated(found: Sequence[Sequence[Array]]) -> Sequence[Array]:
    """Return the arrays of several runs of slices, concatenated."""
    return found[0] if len(found) == 1 else [np.concatenate(each) for each in zip(*found, strict=True)]


def rates_of(of: NodeRates, Y: Array, asked: Sequence[RateRequest]) -> Iterator[tuple[slice, Array, Array]]:
    """Yield ranges of `asked`, with their rates of states and quadratures at the nodes (slices, NODES, …, LANES).

    Each range has as many entries as there are lanes, or fewer at the end, where the other lanes are meaningless.
    The numbers of the machinery are left as they were.
    """
    at, mesh = RateNumbers.of(of.machinery), of.mesh
    for first in range(0, len(asked), LANES):
        now = asked[first : first + LANES]
        entry = _entry(of.machinery) if len(now) >= FEWEST_LANES else None
        if entry is not None:
            middles, y = np.repeat(mesh.middles, NODES), Y.reshape(-1, of.N)
            angles = mesh.angles.ravel()
            moved = [each.edges for each in now]
            own = [angles if e is None else mesh.with_edges(e).angles.ravel() for e in moved]
            lanes = []
            for rows in of.held.runs(mesh.of_nodes):
                laid = ([each[rows] for each in every] for every in (own, [middles] * len(now), [y] * len(now)))
                nodes = Nodes(*(LaneRows.each(every) for every in laid))
                lanes.append(_in_lanes(of, nodes, [each.numbers for each in now], entry))
            found = [each.reshape(mesh.count, NODES, -1, LANES) for each in _concatenated(lanes)]
        else:
            found = [empty(mesh.count, NODES, size, LANES) for size in (of.N, of.q)]
            for i, (numbers, edges) in enumerate(now):
                numbers.put(of.machinery)
                found[0][..., i], found[1][..., i] = rates(of, Y, edges)
            at.put(of.machinery)
        yield slice(first, first + len(now)), found[0], found[1]


def _entry(machinery: Machinery) -> Any:
    """Return the entry of the compiled lanes; None where they cannot be compiled."""
    module = machinery.together
    if module.__name__ not in _entries:
        try:
            with machinery.compiling("numbers"):
                _entries[module.__name__] = module.of_lanes(RATES, KINDS)
        except CannotCompile:
            _entries[module.__name__] = None
    return _entries[module.__name__]


def _room(size: int, _of: Any) -> Array:
    """Return an array of so many numbers, uninitialised."""
    return empty(size)


def _in_lanes(of: NodeRates, nodes: Nodes, numbers: Sequence[RateNumbers], entry: Any) -> tuple[Array, Array]:
    """Return the rates at the nodes (nodes, …, lanes) of each lane's numbers; all lanes have equally many nodes."""
    machinery = of.machinery
    port_states, work = machinery.coupled.port_states, machinery.coupled.work
    rows = {"port_states": aligned(len(port_states)), "work": aligned(len(work))}
    rows["port_states"][:], rows["work"][:] = port_states[:, None], work[:, None]
    alike = all(each is numbers[0] for each in numbers)
    for name in ("P", "R"):
        first = getattr(numbers[0], name)
        rows[name] = aligned(len(first))
        each_of = first[:, None] if alike else np.transpose([getattr(each, name) for each in numbers])
        rows[name][:, : len(numbers)] = each_of
    by_lane = {"TAB": LaneRows.each([numbers[0].TAB] if alike else [each.TAB for each in numbers])}
    out = [aligned(nodes.y.shape[0] * size, room=_room).reshape(-1, size, LANES) for size in (of.N, of.q)]
    words: list[int] = [(1 << len(numbers)) - 1]
    for each in nodes:
        words.extend([*each.addresses, *each.shape])
    for name in CoupledContext._fields:
        if name in rows:
            words.extend([address(rows[name]), len(rows[name])])
        else:
            words.extend([*by_lane[name].addresses, *by_lane[name].shape])
    words.append(machinery.composition.n_E_all)
    for each in out:
        words.extend([address(each), *each.shape[:2]])
    held = np.array(words, np.int64)  # keeps the memory alive during the call
    entry(held.ctypes.data, None)
    return out[0], out[1]
