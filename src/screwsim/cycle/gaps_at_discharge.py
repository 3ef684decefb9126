"""What chambers that are open to the discharge line give through gaps to those that are open to the suction line.

While the discharge port holds the pressure, steps are long. Where the area of a gap changes much within one of them,
its stages misread what passes, which the port makes good: no state errs by it, and no finer life shows it. The chamber
behind sums the same flow with other steps. Where the two sums differ by much of the net flow, the flow is read a third
time, from the states within the steps.
Source: ours; docs/explanation/errors.md.
"""

from collections.abc import Sequence

import numpy as np

from screwsim.cycle.problem import Problem
from screwsim.model import slots
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.quadrature import gauss

Array = np.ndarray
DIFFER = 0.25  # wanted accuracies of the net flow by which the two sums may differ
LEAST_NET = 0.1  # share of the trapped gas: least net flow that this is relative to
FROM_SUCTION = slots.SUCTION_IN, slots.SUCTION_OUT  # streams of the suction line
NODES, WEIGHTS = gauss(8)  # of a step


def misread_at_discharge(problem: Problem, life: Trajectory, at: float, sums: Sequence[tuple[float, float]]) -> float:
    """Return the error [kg/life] of the gas that chambers open to the discharge line sum as given to those behind.

    0 where both sides agree within `DIFFER` accuracies of the net flow. `at` [rad] is where chambers leave the suction
    line; `sums` [kg/life] are, by offset, what chambers got from those ahead until then, and what these gave, each as
    it sums it, positive into itself.
    """
    c, pitch, opens = problem.composition, problem.parts.geometry.pitch, problem.parts.geometry.discharge_opens
    if opens is None or at + max(c.offsets) * pitch <= opens:
        return 0.0
    given, differ = 0.0, 0.0
    until: dict[int, float] = {}
    for i, (offset, (got, gave)) in enumerate(zip(c.offsets, sums, strict=True)):
        shift = offset * pitch
        if at + shift > opens:
            until[offset] = at + shift
            by_ahead = gave - life.sum_until(opens, c.met(i, slots.BEHIND))
            given += by_ahead
            differ += by_ahead + got - life.sum_until(opens - shift, c.met(i, slots.AHEAD))
    if not differ:  # nor where a life has no sums up to an angle
        return 0.0
    port = sum(float(life.quads[life.steps - 1, c.stream(row)]) for row in FROM_SUCTION)
    net = abs(port + sum(got + gave for got, gave in sums))
    least = LEAST_NET * float(life.R[slots.R_TRAPPED])
    if abs(differ) <= DIFFER * problem.scene.numerics.accuracy * max(net, least):
        return 0.0
    return given - _read(problem, life, opens, until)


def _read(problem: Problem, life: Trajectory, begin: float, until: dict[int, float]) -> float:
    """Return the gas [kg/life] from chambers behind by the states within steps, up to an angle [rad] by offset."""
    c = problem.composition
    ends = life.times[: life.steps + 1]
    edges = np.unique([begin, *until.values(), *ends[(ends > begin) & (ends < max(until.values()))]])
    widths = np.diff(edges)[:, None]
    angles = (edges[:-1, None] + widths * NODES).ravel()
    _, flows = life.sample(angles)
    shares, found = (widths * WEIGHTS).ravel() / problem.parts.omega, 0.0
    for i, (_, offset) in enumerate(c.gaps):
        if offset in until:
            behind = flows[:, c.flow_through(i, slots.BEHIND)]
            found += float(np.where(angles < until[offset], shares, 0.0) @ behind)
    return found
