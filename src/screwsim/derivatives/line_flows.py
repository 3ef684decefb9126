"""The flow of all chambers into pulsating lines over a pitch, and its change: both linear in the rates at the nodes.

A line's pressure follows from the means of the flow around even angles (docs/model.md M184). From a life they are read
by `cycle.feedback.into_lines`, which takes as long as a turn. Here the flow between the nodes of a slice is the
polynomial through the rates there, whose integral over the slice is that of the quadratures. So means and quadratures
change together, and the response of the lines to any number of changes costs next to nothing.
"""

from typing import NamedTuple, Self

import numpy as np

from screwsim.cycle.feedback import LINE_POINTS, LineInflow
from screwsim.cycle.problem import Problem
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.radau import INTEGRALS, SHARES
from screwsim.effects.base import LINES
from screwsim.model import slots
from screwsim.numerics.quadrature import gauss

Array = np.ndarray
WITHIN, WEIGHTS = gauss(8)  # of a segment of the laws, for open volumes
THROUGH = np.linalg.inv(np.vander(SHARES, increasing=True))  # maps values at the nodes to coefficients of a polynomial
POWERS = np.arange(len(SHARES))


class LineMeans(NamedTuple):
    """The borders of intervals around even angles of a pitch: their slice, and where in it they are.

    `values` and `integrals` (LINE_POINTS, NODES) are the weights of the rates at the nodes of that slice for the flow
    at a border, and for its integral from the start of the slice, over the width of the slice; `width` is that of an
    interval [rad].
    """

    slices: Array
    shares: Array
    values: Array
    integrals: Array
    width: float

    @classmethod
    def of(cls, edges: Array) -> Self:
        """Return the borders in slices with given edges [rad], of a whole pitch."""
        width = float(edges[-1]) / LINE_POINTS
        borders = width * (np.arange(LINE_POINTS) + 0.5)
        at = np.searchsorted(edges, borders, "right") - 1
        shares = (borders - edges[at]) / np.diff(edges)[at]
        powers = shares[:, None] ** POWERS
        return cls(at, shares, powers @ THROUGH, (powers * shares[:, None] / (POWERS + 1)) @ THROUGH, width)

    def through(self, changes: Array, jumps: Array | float = 0.0) -> Array:
        """Return the means (lines, LINE_POINTS, …) of flows at the nodes (slices, NODES, lines, …), times widths.

        `jumps` (slices, lines, …), flows times angles, are added at the ends of slices.
        """
        before = np.zeros((len(changes) + 1, *changes.shape[2:]))
        np.cumsum(np.einsum("j,kj...->k...", INTEGRALS[-1], changes) + jumps, axis=0, out=before[1:])
        reached = before[self.slices] + np.einsum("pj,pj...->p...", self.integrals, changes[self.slices])
        return self._between(reached, before[-1])

    def _between(self, reached: Array, whole: Array | float) -> Array:
        """Return the means between borders, from integrals up to these and over the whole pitch."""
        first = (reached[-1] - whole)[None]
        return np.moveaxis(np.diff(reached, axis=0, prepend=first) / self.width, 0, 1)

    def as_edges_move(self, flow: Array, edges: Array | None, wider: float) -> Array:
        """Return the change of means (lines, LINE_POINTS) with edges at fixed rates, but for that of the widths.

        `flow` (slices, NODES, lines) are the rates, `edges` the movement of the edges [rad], `wider` that of the pitch,
        over itself: what flows between where a border was in its slice and where it is now changes sides.
        """
        moved = -wider * self.width * (np.arange(LINE_POINTS) + 0.5)
        if edges is not None:
            before, after = edges[self.slices], edges[self.slices + 1]
            moved = moved + before + self.shares * (after - before)
        at = np.einsum("pj,pjl->pl", self.values, flow[self.slices])
        return self._between(-at * moved[:, None], 0.0)


def pulsates(pitch: CollocatedPitch) -> bool:
    """Return whether lines pulsate whose flow is read from the nodes: not that of a single chamber, with events."""
    return pitch.machinery.composition.pulsating and not pitch.alone


def none(pitch: CollocatedPitch, columns: int) -> Array:
    """Return no change of the means (lines, LINE_POINTS, columns); with no points where they are not known."""
    return np.zeros((len(LINES), LINE_POINTS if pulsates(pitch) else 0, columns))


def flows_of(pitch: CollocatedPitch, g: Array, axis: int = 2) -> Array:
    """Return the flows [kg/s] into suction and discharge line by the rates of quadratures, which lie along an axis."""
    c = pitch.machinery.composition
    rows = slice(c.first_stream + slots.OF_GAS, None, c.width)
    streams = np.moveaxis(g, axis, 0)[rows]  # gas to the chambers: suction in, out, discharge in, out, others
    of_lines = streams[: 2 * len(LINES)].reshape(len(LINES), 2, *streams.shape[1:]).sum(axis=1)
    return np.moveaxis(of_lines, 0, axis) * -float(c.P[slots.P_OMEGA])


def line_inflow(pitch: CollocatedPitch, g: Array) -> LineInflow | None:
    """Return the flow into pulsating lines by the rates of quadratures at the nodes; None where it is not known so."""
    if not pulsates(pitch):
        return None
    flows = LineMeans.of(pitch.mesh.edges).through(pitch.mesh.widths[:, None, None] * flows_of(pitch, g))
    return LineInflow(flows, open_volumes(pitch.problem, pitch))


def open_volumes(problem: Problem, pitch: CollocatedPitch) -> Array:
    """Return the mean volumes [m³] of the chambers that are open to suction and discharge line, by the laws' areas."""
    c, module, life = problem.composition, pitch.machinery.module, problem.parts.geometry.life
    ends = np.unique(np.clip([0.0, *c.breakpoints, life], 0.0, life))
    widths = np.diff(ends)[:, None]
    angles = (ends[:-1, None] + widths * WITHIN).ravel()
    volumes, area, is_open = np.empty(angles.size), np.empty(angles.size), np.zeros((len(LINES), angles.size), bool)
    module.trace__volumes(angles, c.P, c.TAB, volumes)
    for i, (_, path) in enumerate(problem.parts.ports):
        number = problem.parts.number(path.to)
        if number < len(LINES):
            module.trace__areas_along(angles, i, c.P, c.TAB, area)
            is_open[number] |= area > 0.0
    return is_open @ (volumes * (widths * WEIGHTS).ravel()) / problem.parts.geometry.pitch


def by_states(pitch: CollocatedPitch, slopes: Array, nodes: Array, jumps: Array | float) -> Array:
    """Return the change of the means with changes at the nodes (slices, NODES, N, k), by the slopes of quadratures."""
    if not pulsates(pitch):
        return none(pitch, nodes.shape[-1])
    of_lines = pitch.mesh.widths[:, None, None, None] * flows_of(pitch, slopes)
    return LineMeans.of(pitch.mesh.edges).through(of_lines @ nodes, jumps)
