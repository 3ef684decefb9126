"""Errors by what a chamber misreads of the gas that it takes in, while a line holds its pressure.

Steps are long there. What the stages of a step make of the port's flow fits the gas, but its heat may be wrong:

- stages may alternate between flowing in and flowing back, which exchanges gas of the chamber for gas of the line;
- a neighbour that is squeezed, or meets its own line, within the step is missed, and the port makes good the gas that
  it gives or takes, at another temperature.

A chamber that is too cold holds too much gas. No error of the states shows it, and finer lives take nearly the same
steps. Where the flow is read at that port, what the port makes good is an error of the flow itself.
Source: ours; docs/explanation/errors.md.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from screwsim.cycle.balances import meets_line_at_angle
from screwsim.cycle.problem import Problem
from screwsim.effects.base import SUCTION
from screwsim.evaluate.evaluation import Evaluation
from screwsim.figures.errors import flow_errors
from screwsim.model import slots
from screwsim.model.trace import SAMPLED
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.quadrature import gauss
from screwsim.outputs import Figures
from screwsim.solve.missed_neighbours import EQUAL, shifts_to_neighbours, sums_met_twice

Array = np.ndarray
SOME = 0.05  # wanted accuracies: what is misread of the trapped gas that is left alone
NODES, WEIGHTS = gauss(2)  # of a step
GAS_RATE = SAMPLED.index("mass_rate")
TRAPPED = "trapped_mass"


class Misread(NamedTuple):
    """Gas [kg/life] by which a life's chamber holds too much, and by which its port takes in too much."""

    held: float
    drawn: float


def misread_intake_errors(of: Evaluation, finer: Trajectory) -> Iterator[Figures]:
    """Yield the errors of figures that a finer life than the evaluated one still has by what it misreads."""
    problem, found = of.problem, of.figures
    flow, trapped = found.get("gas_mass_flow"), found.get(TRAPPED)
    if not trapped:
        return
    held, drawn = map(abs, misread_intake(problem, finer))
    some = SOME * problem.scene.numerics.accuracy * trapped
    if held > some:
        yield Figures({TRAPPED: held / trapped})
        if problem.parts.oil is not None and "ratio" in problem.parts.oil.supply:
            yield flow_errors(found, held / trapped, "by_oil")
    lost = held if meets_line_at_angle(problem) else drawn
    if flow and lost > some:
        yield flow_errors(found, lost * problem.rate / abs(flow))


def misread_intake(problem: Problem, life: Trajectory) -> Misread:
    """Return what a life misreads while it is open to the line that it takes gas in from.

    At a held pressure p V stays, and so does the sum of m T: gas at T that is taken in, in place of gas of the line at
    T_s, leaves room for less by T/T_s - 1 of itself. What flows out later takes its part of the error with it.
    """
    c, geometry, ends = problem.composition, problem.parts.geometry, life.times[: life.steps + 1]
    until = geometry.inlet_closes if geometry.expands else problem.parted or geometry.injection_angle
    steps = np.flatnonzero(ends[1:] < (until or geometry.injection_angle) + EQUAL)
    sums = np.diff(life.quads[: life.steps], axis=0, prepend=0.0)[steps]
    into, back = (sums[:, c.first_stream + row * c.width] for row in (slots.SUCTION_IN, slots.SUCTION_OUT))
    T_s, T = problem.lines.T_s, life.dense[steps, :2, slots.S_T].mean(axis=1)
    exchanged = _exchanged(problem, life, steps, np.minimum(into, -back) * (T / T_s - 1.0))
    more = exchanged * (T / T_s - 1.0)
    step, column, differ = sums_met_twice(problem, life, steps)
    drawn = -float(differ[(into - back)[step] > 0.0].sum())
    if len(step):
        gives = sums[step, c.first_met + column] < 0.0
        at = 0.5 * (ends[step] + ends[step + 1]) + shifts_to_neighbours(problem)[column]
        order = at.argsort()
        T_met = np.empty(len(at))
        T_met[order] = life.states_at(at[order])[:, slots.S_T]
        T_from, T_port = np.where(gives, T[step], T_met), np.where((into + back)[step] > 0.0, T_s, T[step])
        more = more - np.bincount(step, differ * (T_from / T_port - 1.0), len(steps))
    return Misread(float(more @ _kept(problem, life, steps, sums)), drawn)


def _exchanged(problem: Problem, life: Trajectory, steps: Array, at_most: Array) -> Array:
    """Return the gas [kg] in each step that its stages exchange with the line beyond what flows back.

    `at_most` is what that would make of the gas in the chamber if all of it were misread; next to nothing is not read.
    Neither is it for a gas whose two phases are followed, nor where oil gives off gas (that is no flow of a path).
    """
    c, found = problem.composition, np.zeros(len(steps))
    some = SOME * problem.scene.numerics.accuracy * float(life.R[slots.R_TRAPPED])
    if problem.scene.gas.equilibrium or c.dissolves or not np.abs(at_most).sum() > some:
        return found
    alternate = np.flatnonzero(at_most != 0.0)
    ports = [i for i, end in enumerate(c.ends[: len(c.plenum_paths)]) if end == SUCTION]
    begun, widths = life.times[steps[alternate], None], np.diff(life.times[: len(steps) + 1])[alternate, None]
    sampled, flows = life.sample((begun + widths * NODES).ravel())
    through = flows[:, ports].sum(axis=1)
    balanced = problem.parts.omega * sampled[:, GAS_RATE] - (flows.sum(axis=1) - through)
    back = (np.minimum(balanced, 0.0).reshape(-1, len(NODES)) * widths) @ WEIGHTS / problem.parts.omega
    column = c.first_stream + c.width * slots.SUCTION_OUT
    summed = np.diff(life.quads[: life.steps, column], prepend=0.0)[steps[alternate]]
    found[alternate] = np.maximum(back - summed, 0.0)
    return found


def _kept(problem: Problem, life: Trajectory, steps: Array, sums: Array) -> Array:
    """Return the share of an error in each step that is left after the later ones, of which gas flows out."""
    c = problem.composition
    last = life.dense[steps, 1]
    rho, ratio = last[:, slots.S_RHO], last[:, slots.S_X_OIL] if c.carried else 0.0
    gas = rho * problem.gas_share(rho, ratio) * life.volumes(life.times[steps + 1])
    met = np.minimum(sums[:, c.first_met : c.first_met + 2 * len(c.offsets)], 0.0).sum(axis=1)
    out = -sums[:, c.first_stream + c.width * slots.SUCTION_OUT] - met
    leaves = np.append(np.minimum(out / gas, 1.0)[1:], 0.0)
    return np.cumprod((1.0 - leaves)[::-1])[::-1]
