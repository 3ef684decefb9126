"""By how much a closed life misreads the gas that flows back to a suction line, from the balance within its steps.

Chambers that are open to the line hold its pressure within a few pascals. The stages of a step may alternate between
flowing in and flowing back: both sums are then too large by the same, which no balance shows and finer steps remove
slowly. They also misread what gaps pass meanwhile, which the port makes good.
Source: ours; docs/explanation/errors.md.
"""

import numpy as np

from screwsim.cycle.balances import streams_of
from screwsim.cycle.problem import Problem
from screwsim.effects.base import SUCTION
from screwsim.model import slots
from screwsim.model.trace import SAMPLED
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.quadrature import gauss

Array = np.ndarray
NODES, WEIGHTS = gauss(4)  # of a step
GAS_RATE = SAMPLED.index("mass_rate")


def misread_return(problem: Problem, life: Trajectory, q: Array) -> float:
    """Return the gas [kg/life] by which a life with quadratures q sums too much or too little back to suction.

    The flow through the ports is read a second time, from the change of the chamber's gas less what other paths bring.
    It is 0 for a gas whose two phases are followed, and where oil gives off gas (that is no flow of a path).
    """
    c = problem.composition
    if problem.scene.gas.equilibrium or c.dissolves:
        return 0.0
    ports = [i for i, end in enumerate(c.ends[: len(c.plenum_paths)]) if end == SUCTION]
    ends, column = life.times[: life.steps + 1], c.first_stream + c.width * slots.SUCTION_OUT + slots.OF_GAS
    backward = np.diff(life.quads[: life.steps, column], prepend=0.0) < 0.0  # all chambers together keep no such sums
    steps = np.flatnonzero(backward) if backward.any() else np.arange(life.steps)
    begun, widths = ends[steps, None], (ends[steps + 1] - ends[steps])[:, None]
    sampled, flows = life.sample((begun + widths * NODES).ravel())
    through = flows[:, ports].sum(axis=1)
    balanced = problem.parts.omega * sampled[:, GAS_RATE] - (flows.sum(axis=1) - through)
    back = np.where(through != 0.0, np.minimum(balanced, 0.0), 0.0).reshape(-1, len(NODES))
    read = float(((back * widths) @ WEIGHTS).sum()) / problem.parts.omega
    return abs(read - float(streams_of(c, q)[slots.SUCTION_OUT, slots.OF_GAS]))
