"""What a state of the collocated cycle leaves open of its equations: stages, feedback unknowns, events."""

from typing import NamedTuple

import numpy as np

from screwsim.cycle.feedback import LineInflow
from screwsim.derivatives.lane_rates import rates
from screwsim.derivatives.line_flows import line_inflow
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.radau import INTEGRALS
from screwsim.derivatives.rate_numbers import SMALL
from screwsim.derivatives.shifted_life import ShiftedLife
from screwsim.derivatives.unknowns import coordinates_of, image, unknowns_of

Array = np.ndarray


class Residual(NamedTuple):
    """The residuals of the stage equations (slices, NODES, N), of the unknowns in coordinates, and of events.

    Then what they were computed with: states at the start, quadratures, flows into pulsating lines.
    """

    stages: Array
    unknowns: Array
    events: Array
    start: Array
    sums: Array
    into: LineInflow | None

    def size(self, Y: Array) -> float:
        """Return the largest of all, of states Y relative to these."""
        of_unknowns, of_events = (float(np.abs(each).max(initial=0.0)) for each in (self.unknowns, self.events))
        return max(size_of(self.stages, Y), of_unknowns, of_events)


def residual_of(pitch: CollocatedPitch, Y: Array) -> Residual:
    """Return the residual at states at the nodes; this sets the run-time cells."""
    start, (f, g) = pitch.period.start(Y), rates(pitch.rates, Y)
    sums, into = pitch.sums(g), line_inflow(pitch, g)
    life = ShiftedLife.of(pitch, lambda: pitch.install(start, Y))
    of_unknowns = image(pitch, sums, life, into) - coordinates_of(pitch, unknowns_of(pitch))
    return Residual(stage_residual(pitch, Y, start, f), of_unknowns, pitch.open_events(Y), start, sums, into)


def stage_residual(pitch: CollocatedPitch, Y: Array, start: Array, f: Array) -> Array:
    """Return the residual Y − y₀ − h A f of the stage equations (slices, NODES, N), for rates f at the nodes."""
    return Y - pitch.begins(start, Y)[:, None] - pitch.mesh.widths[:, None, None] * (INTEGRALS @ f)


def size_of(stages: Array, Y: Array) -> float:
    """Return the largest residual of the stage equations, relative to the states."""
    return float(largest_by_slice(stages, Y).max())


def largest_by_slice(change: Array, Y: Array) -> Array:
    """Return the largest relative change, or residual, of the states in each slice (slices,)."""
    return (np.abs(change) / np.maximum(np.abs(Y), SMALL)).max(axis=(1, 2))
