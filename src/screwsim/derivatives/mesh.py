"""The mesh of a pitch: slices, each with the nodes of Radau's method (`radau`).

Slices end on the breakpoints of the laws and are at first as dense as the integrator's steps of the closed cycle, of
all chambers; those with too large an error are divided. Where a flow turns round, its slope over the pressures is
steepest, in a layer as wide as the regularisation; there the response to a small change is decided, of which the error
of the states shows nothing. So slices end there and are as short as that layer around it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, Self

import numpy as np

from screwsim.derivatives.radau import NODES, SHARES
from screwsim.effects.base import FlowPath
from screwsim.model.all_chambers import pitch_breakpoints
from screwsim.model.parts import Parts
from screwsim.model.run import Machinery
from screwsim.model.slots import P_PITCH

Array = np.ndarray
CORNER = 1e-6  # rad: corners nearer than this to a breakpoint or to each other are merged
LEAST_GAP = 1e-7  # rad: ends of steps nearer than this to each other are merged
OF_WIDTH = 1e-6  # share of a segment: ends of steps so near to its ends are ignored
LEAST = 1e-9  # rad: shortest slice ...
LONGEST = math.radians(1.0)  # ... and longest one: errors of the states do not show a law that moves
MOST = 4  # parts into which one refinement divides a slice
POWER = 0.25  # of the error of a slice, in choosing its width: that of the estimate
FIRST_RING = 0.3  # first slices on both sides of a turning flow, in widths of its layer ...
AROUND_PEAK = 2e-4  # rad: half the width of the slice around the highest pressure
RING_GROWTH = 2.5  # ... and ratio of each slice to the one before
SHARE_BEFORE = 1e-4  # widths of a layer by which a slice ends before the flow turns, to keep its last node on that side
NEAR = 0.25  # of that: a node of the slice behind may be no nearer to the turning; otherwise that slice ends ...
BEHIND = 2.0  # ... so much of that behind it
DROP_BEFORE = 1e-9  # of the pressure: least difference at that node, ten times the shortest step of differences
CORNER_LAYER = 1e-2  # rad: layer assumed for a corner or jump of a rate; the slice before it ends 1e-6 rad from it


class Crossing(NamedTuple):
    """Where a flow turns round or a rate jumps [rad of the pitch], and the width of its layer [rad].

    Where the response of the states jumps, the slice behind is as short as `jump` [rad], as polynomials cannot
    follow. A slice ends `share` of the layer before it.
    """

    angle: float
    layer: float
    jump: float = 0.0
    share: float = SHARE_BEFORE


@dataclass(frozen=True, eq=False)
class Mesh:
    """Slices of a pitch: edges (slices + 1,) [rad], and middles (slices,) [rad] that select a side at breakpoints."""

    edges: Array
    middles: Array

    @classmethod
    def between(cls, edges: Array) -> Self:
        """Return the mesh of slices between edges [rad]."""
        return cls(edges, 0.5 * (edges[:-1] + edges[1:]))

    def with_edges(self, edges: Array) -> Self:
        """Return the mesh with edges [rad] moved a little: nodes move, their segments of the laws stay."""
        return type(self)(edges, self.middles)

    @property
    def count(self) -> int:
        """The number of slices."""
        return len(self.middles)

    @property
    def widths(self) -> Array:
        """Widths of the slices [rad]."""
        return np.diff(self.edges)

    @property
    def angles(self) -> Array:
        """Angles of the nodes (slices, NODES) [rad]."""
        found = self.edges[:-1, None] + self.widths[:, None] * SHARES
        found[:, -1] = self.edges[1:]
        return found

    @property
    def of_nodes(self) -> Array:
        """The slice of each node (slices NODES,)."""
        return np.repeat(np.arange(self.count), NODES)


def fixed_edges(machinery: Machinery, parts: Parts) -> Array:
    """Return the angles in a pitch [rad] where slices always end: breakpoints, and corners of gap areas.

    A number that moves such a corner has a derivative with a corner itself, which within a slice would lower the
    order.
    """
    found, pitch = pitch_breakpoints(machinery), float(machinery.composition.P[P_PITCH])
    for at in sorted(at % pitch for _, path in parts.all(FlowPath) for at in path.corners):
        if np.abs(found - at).min() > CORNER:
            found = np.sort(np.append(found, at))
    return found


def edges_of(machinery: Machinery, seams: Array, steps: float, longest: float) -> Array:
    """Return edges of slices of a pitch, each as long as `steps` steps of the last history, of all chambers.

    None is longer than `longest` [rad].
    """
    c, (times, _, _, count) = machinery.composition, machinery.lives.last()
    ends = np.sort(np.mod(times[1:count], float(c.P[P_PITCH])))
    ends = ends[np.diff(ends, prepend=-1.0) > LEAST_GAP]  # chambers integrated together share their steps
    edges = [np.zeros(1)]
    for low, high in pairwise(seams.tolist()):
        near = OF_WIDTH * (high - low)
        inside = np.concatenate([[low], ends[(ends > low + near) & (ends < high - near)], [high]])
        wanted = max(1, int(np.ceil((len(inside) - 1) / steps)), int(np.ceil((high - low) / longest)))
        edges.append(np.interp(np.linspace(0.0, len(inside) - 1.0, wanted + 1), np.arange(len(inside)), inside)[1:])
    return np.concatenate(edges)


def refined(edges: Array, errors: Array, tolerance: float) -> Array:
    """Return edges of slices, with those whose error exceeds the tolerance divided."""
    parts = np.clip(np.ceil((errors / tolerance) ** POWER), 1, MOST).astype(int)
    of, first = np.repeat(np.arange(len(parts)), parts), np.cumsum(parts) - parts
    found = edges[of] + np.diff(edges)[of] * (np.arange(len(of)) - first[of]) / parts[of]
    return np.append(found, edges[-1])


def share_before(width: float) -> float:
    """Return the widths of a layer by which slices end before flows turn, from that width over the pressure."""
    return max(SHARE_BEFORE, DROP_BEFORE / width)


def _end_behind(ends: Array, at: float) -> int:
    """Return the index of the first end at or behind an angle [rad], not that of the first one."""
    return min(max(int(ends.searchsorted(at)), 1), len(ends) - 1)


def with_rings(
    edges: Array, seams: Array, crossings: Sequence[Crossing], growth: tuple[float, float], peak: float
) -> Array:
    """Return edges with rings around crossings in place of others nearby; slices grow with distance from the crossing.

    `growth` are factors on `FIRST_RING` and on `RING_GROWTH`. Where the pressure is highest [rad], if known, a slice is
    short: the highest pressure is read inside it, where polynomials are less accurate than at their ends.
    """
    kept, added = edges[~(np.abs(edges - peak) < AROUND_PEAK)], [seams]
    if math.isfinite(peak):
        around = np.array([peak - AROUND_PEAK, peak + AROUND_PEAK])
        added.append(around[(around > edges[0] + LEAST) & (around < edges[-1] - LEAST)])
    for angle, layer, jump, share in crossings:
        at, first, wider = angle - share * layer, growth[0] * FIRST_RING * layer, growth[1] * RING_GROWTH
        after = _end_behind(edges, at)
        room = float(edges[after] - edges[after - 1])
        count = max(0, int(np.ceil(np.log(max(0.5 * room / first, 1e-300)) / np.log(wider))))
        reach = first * wider ** np.arange(count)
        segment = _end_behind(seams, at)
        low, high = seams[segment - 1] + LEAST, seams[segment] - LEAST
        ring = np.concatenate([at - reach[::-1], [at, *([at + jump] if jump else [])], at + reach])
        ring = ring[(ring > low) & (ring < high)]
        if len(ring):
            kept = kept[(kept < ring[0]) | (kept > max(ring[-1], angle + BEHIND * share * layer))]
            added.append(ring)
    found = np.unique(np.concatenate([kept, *added]))
    near = np.diff(found, prepend=-1.0) < LEAST
    marked = np.isin(found, seams)
    near[:-1] |= marked[1:] & ~marked[:-1] & (np.diff(found) < LEAST)  # a seam stays, edges near it go
    return _nodes_apart(found[~near | marked], crossings)


def _nodes_apart(edges: Array, crossings: Sequence[Crossing]) -> Array:
    """Return edges with one behind each crossing to which a node of its slice is so near that differences pass it."""
    more = []
    for angle, layer, jump, share in crossings:
        behind = int(edges.searchsorted(angle))
        if jump or not 0 < behind < len(edges):
            continue
        nodes = edges[behind - 1] + SHARES * (edges[behind] - edges[behind - 1])
        at = angle + BEHIND * share * layer
        if np.abs(nodes - angle).min() < NEAR * share * layer and at < edges[behind] - LEAST:
            more.append(at)
    return np.sort(np.append(edges, more)) if more else edges
