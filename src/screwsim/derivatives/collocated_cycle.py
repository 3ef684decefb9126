"""A closed cycle, collocated: what its derivatives start from."""

from typing import NamedTuple

import numpy as np

from screwsim.cycle.feedback import LineInflow
from screwsim.derivatives.mesh import Crossing
from screwsim.derivatives.node_rates import Slopes
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.rate_numbers import RateNumbers

Array = np.ndarray


class NotClosed(Exception):
    """The collocated cycle does not close."""


class Placed(NamedTuple):
    """Where slices end: edges [rad] without those around crossings, and the crossings."""

    edges: Array
    crossings: list[Crossing]


class CollocatedCycle(NamedTuple):
    """A collocated cycle: states at the start and the nodes, rates there, quadratures, numbers, unknowns, line flows.

    The flows `into` pulsating lines are None where these are read from a life; `placed` is known once slices are.
    """

    pitch: CollocatedPitch
    start: Array
    nodes: Array
    slopes: Slopes
    sums: Array
    at: RateNumbers
    unknowns_in: Array
    into: LineInflow | None
    placed: Placed | None = None
