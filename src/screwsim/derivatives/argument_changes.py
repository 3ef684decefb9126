"""The effect of small changes of the rates' arguments on the stage equations and the quadratures, by differences.

Rates for all changes are computed side by side. An event within a turn moves the edges of slices up to its neighbours
alone, so that every second event is moved at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from screwsim.derivatives import line_flows
from screwsim.derivatives.lane_rates import RateRequest, rates_of
from screwsim.derivatives.line_flows import LineMeans
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.radau import INTEGRALS, NODES
from screwsim.derivatives.rate_numbers import RateNumbers
from screwsim.derivatives.sweeps import compiled
from screwsim.effects.base import LINES
from screwsim.model.slots import P_GAP_WIDTH, P_OMEGA, P_PITCH, PORT_STATE, PRESSURE, R_RATIO

Array = np.ndarray
OF_WIDTH = 1e-5  # step of differences over the regularisation: a tenth of a node's distance from a turning ...
LEAST, MOST = 1e-10, 1e-9  # ... within these bounds


def step_along(change: ArgumentChange, at: RateNumbers, step: float) -> float:
    """Return the relative step of differences along a change: of central ones so that pressures move by `step` at most.

    A saturation temperature moves the pressure of its line ten times as far as itself, and nodes must not be moved
    beyond the turning of a flow.
    """
    if not change.both:
        return step
    lines = slice(PRESSURE, R_RATIO, PORT_STATE)
    moved = change.numbers.R[lines] / np.where(at.R[lines] > 0.0, at.R[lines], np.inf)
    return step / max(1.0, float(np.abs(moved).max()))


def step_of(pitch: CollocatedPitch) -> float:
    """Return the relative step of differences: small against the regularisation, far above rounding."""
    width = float(pitch.machinery.composition.P[P_GAP_WIDTH])
    return min(MOST, max(LEAST, OF_WIDTH * width))


class ArgumentChange(NamedTuple):
    """A direction: change of the numbers, and of the slices' edges [rad]; `side` is the sign of its differences.

    Where two breakpoints of the laws coincide and one of them moves, edges stay, and the differences are taken on
    the side where the nodes at the ends of slices remain in their segments; one sign for each slice where
    breakpoints move both ways.
    """

    numbers: RateNumbers
    edges: Array | None = None
    side: float | Array = 1.0

    @property
    def nothing(self) -> bool:
        """Whether no rate depends on it."""
        return self.numbers.nothing and self.edges is None

    @property
    def both(self) -> bool:
        """Whether differences must be central: for pressures of lines, in whose layers chambers may remain for long."""
        return bool(self.numbers.R[PRESSURE:R_RATIO:PORT_STATE].any())


def along(
    pitch: CollocatedPitch, Y: Array, at: RateNumbers, changes: Sequence[ArgumentChange], right: Array, first: int
) -> tuple[Array, Array]:
    """Return the change of the quadratures with changes of the rates' arguments, a column each, and of line flows.

    The latter are those into pulsating lines (`line_flows`). Changes of the stage equations are added to `right`
    (slices, NODES, N, …), from column `first` on.
    """
    sums = np.zeros((pitch.machinery.nq, len(changes)))
    sides = [(i, side) for i, each in enumerate(changes) if not each.nothing for side in _sides(pitch, each, at)]
    if not sides:
        return sums, line_flows.none(pitch, len(changes))
    flows, widths = np.zeros((pitch.count, NODES, len(LINES), len(changes))), pitch.mesh.widths
    own: list[Array] = []
    requests = [RateRequest(at, None), *(side.request for _, side in sides)]  # the unmoved rates come first
    for which, *found in rates_of(pitch.rates, Y, requests):
        f, g = (each.reshape(-1, *each.shape[2:]) for each in found)
        own = own or [f[..., 0].copy(), g[..., 0].copy()]
        lane = int(not which.start)  # the first one of a side
        of_lanes = sides[which.start + lane - 1 : which.stop - 1]
        there = _by_lane(side.weight * side.widths(widths) for _, side in of_lanes)
        here = _by_lane(side.weight * widths for _, side in of_lanes)  # cancels of two sides, and most rounding with it
        columns = np.array([i for i, _ in of_lanes])
        right_rows = right.reshape(-1, *right.shape[2:])
        compiled().sweeps__add_stages(f, own[0], lane, there, here, first + columns, right_rows)
        compiled().sweeps__add_sums(g, own[1], lane, there, here, columns, sums)
        if line_flows.pulsates(pitch):
            _add_flows(pitch, g, own[1], lane, there, here, columns, flows)
    return sums, _means_by(pitch, own[1], flows, changes)


class _Side(NamedTuple):
    """One side of a difference: its weight, of each slice or of all, and the rates that are asked for."""

    weight: float | Array
    request: RateRequest

    def widths(self, own: Array) -> Array:
        """Return the widths of the slices on this side [rad]; `own` are those of the mesh."""
        return own if self.request.edges is None else np.diff(self.request.edges)


def _sides(pitch: CollocatedPitch, change: ArgumentChange, at: RateNumbers) -> Iterator[_Side]:
    """Yield the sides of the difference along a change: both, or the one on which nodes keep their segments."""
    numbers, edges, side = change
    step = step_along(change, at, step_of(pitch))
    for sign in (side,) if isinstance(side, float) and not change.both else (1.0, -1.0):
        weight = sign / step * (0.5 if change.both else np.equal(side, sign))
        there = None if edges is None else pitch.mesh.edges + sign * step * edges
        yield _Side(weight, RateRequest(at.plus(sign * step, numbers), there))


def _by_lane(weights: Iterable[Array]) -> Array:
    """Return arrays by slice as one (slices, lanes)."""
    return np.ascontiguousarray(np.transpose(list(weights)))


def _add_flows(
    pitch: CollocatedPitch,
    rates: Array,
    own: Array,
    first: int,
    there: Array,
    here: Array,
    columns: Array,
    flows: Array,
) -> None:
    """Add to flows (slices, NODES, lines, …) the differences of those into lines, as `sweeps.add_sums` does to sums."""
    moved, unmoved = (line_flows.flows_of(pitch, each, 1).reshape(*flows.shape[:3], -1) for each in (rates, own))
    moved = there[:, None, None] * moved[..., first : first + len(columns)] - here[:, None, None] * unmoved
    for lane, column in enumerate(columns.tolist()):
        flows[..., column] += moved[..., lane]


def _means_by(pitch: CollocatedPitch, g: Array, flows: Array, changes: Sequence[ArgumentChange]) -> Array:
    """Return the change of the mean flows into lines with changes of the rates' arguments, a column each.

    `flows` (slices, NODES, lines, k) are the changes of the flows at the nodes, times widths; g are the rates of
    quadratures there.
    """
    if not line_flows.pulsates(pitch):
        return line_flows.none(pitch, len(changes))
    own = line_flows.flows_of(pitch, g, 1).reshape(flows.shape[:3])
    means, P = LineMeans.of(pitch.mesh.edges), pitch.machinery.composition.P
    found, here = means.through(flows), means.through(pitch.mesh.widths[:, None, None] * own)
    for j, change in enumerate(changes):
        numbers = change.numbers.P
        wider, faster = (float(numbers[at] / P[at]) for at in (P_PITCH, P_OMEGA))
        if change.edges is not None or wider:
            found[..., j] += means.as_edges_move(own, change.edges, wider)
        found[..., j] += (faster - wider) * here
    return found


def along_events(pitch: CollocatedPitch, Y: Array, right: Array) -> Array:
    """Return the change of the quadratures with the unknown of each event, a column each, by the edges that it moves.

    Changes of the stage equations are added to `right` (slices, NODES, N, events). They are those of every second event
    at once, each in the slices that it reaches, up to its neighbours.
    """
    at, edges, moves, step = pitch.numbers, pitch.mesh.edges, pitch.events.moves(pitch.mesh.edges), step_of(pitch)
    sums = np.zeros((pitch.machinery.nq, len(moves)))
    if not len(moves):
        return sums
    sides = [edges + step * moves[first::2].sum(axis=0) for first in (0, 1)]
    (_, *rates), *_ = rates_of(pitch.rates, Y, [RateRequest(at, None), *(RateRequest(at, each) for each in sides)])
    for event, move in enumerate(moves):
        reached = (move[:-1] != 0.0) | (move[1:] != 0.0)
        here, there = (np.diff(each)[reached, None, None] for each in (edges, sides[event % 2]))
        f, g = ((there * each[reached, ..., 1 + event % 2] - here * each[reached, ..., 0]) / step for each in rates)
        right[reached, ..., event] += INTEGRALS @ f
        sums[:, event] = np.einsum("j,kjq->q", INTEGRALS[-1], g)[: len(sums)]
    return sums
