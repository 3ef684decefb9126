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

from screwsim.cycle.balances import meets_line_at_angle, streams_of
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


def misread_intake_errors(of: Evaluation, finer: Trajectory, q: Array | None) -> Iterator[Figures]:
    """Yield the errors of figures that a finer life than the evaluated one still has by what it misreads.

    `q` are its quadratures if all chambers were integrated together; None if its steps have sums of their own.
    """
    problem, found = of.problem, of.figures
    flow, trapped = found.get("gas_mass_flow"), found.get(TRAPPED)
    if not trapped:
        return
    held, drawn = map(abs, misread_intake(problem, finer, q))
    some = SOME * problem.scene.numerics.accuracy * trapped
    if held > some:
        yield Figures({TRAPPED: held / trapped})
        if problem.parts.oil is not None and "ratio" in problem.parts.oil.supply:
            yield flow_errors(found, held / trapped, "by_oil")
    lost = held if meets_line_at_angle(problem) else drawn
    if flow and lost > some:
        yield flow_errors(found, lost * problem.rate / abs(flow))


def misread_intake(problem: Problem, life: Trajectory, q: Array | None = None) -> Misread:
    """Return what a life misreads while it is open to the line that it takes gas in from.

    At a held pressure p V stays, and so does the sum of m T: gas at T that is taken in, in place of gas of the line at
    T_s, leaves room for less by T/T_s - 1 of itself. What flows out later takes its part of the error with it. For `q`
    see `misread_intake_errors`.
    """
    geometry, ends = problem.parts.geometry, life.times[: life.steps + 1]
    until = geometry.inlet_closes if geometry.expands else problem.parted
    steps = np.flatnonzero(ends[1:] < (until or geometry.injection_angle) + EQUAL)
    if q is not None:
        return Misread(_exchanged_by_all(problem, life, steps, q), 0.0)
    c, P = problem.composition, life.dense[steps]
    sums = np.diff(life.quads[: life.steps], axis=0, prepend=0.0)[steps]
    into, back = (sums[:, c.first_stream + row * c.width] for row in (slots.SUCTION_IN, slots.SUCTION_OUT))
    T = P[:, :2, slots.S_T].mean(axis=1)
    warmer = T / problem.lines.T_s - 1.0
    more = _exchanged(problem, life, steps, np.minimum(into, -back) * warmer, back) * warmer
    step, column, differ = sums_met_twice(problem, life, steps)
    drawn = -float(differ[(into - back)[step] > 0.0].sum())
    if len(step):
        at = 0.5 * (ends[step] + ends[step + 1]) + shifts_to_neighbours(problem)[column]
        order, T_met = at.argsort(), np.empty(len(at))
        T_met[order] = life.states_at(at[order])[:, slots.S_T]
        T_from = np.where(sums[step, c.first_met + column] < 0.0, T[step], T_met)
        T_port = np.where((into + back)[step] > 0.0, problem.lines.T_s, T[step])
        more = more - np.bincount(step, differ * (T_from / T_port - 1.0), len(steps))
    met = np.minimum(sums[:, c.first_met : c.first_met + 2 * len(c.offsets)], 0.0).sum(axis=1)
    return Misread(float(more @ _kept(problem, life, steps, -(met + back))), drawn)


def _exchanged(problem: Problem, life: Trajectory, steps: Array, at_most: Array, summed: Array) -> Array:
    """Return the gas [kg] in each step that its stages exchange with the line beyond what flows back.

    `at_most` is what that would make of the gas in the chamber if all of it were misread, `summed` the gas that flows
    back (negative) as steps sum it. Next to nothing is not read.
    """
    found = np.zeros(len(steps))
    some = SOME * problem.scene.numerics.accuracy * float(life.R[slots.R_TRAPPED])
    if _not_read(problem) or not np.abs(at_most).sum() > some:
        return found
    alternate = np.flatnonzero(at_most != 0.0)
    back, _ = _flows_read(problem, life, steps[alternate])
    found[alternate] = np.maximum(back - summed[alternate], 0.0)
    return found


def _exchanged_by_all(problem: Problem, life: Trajectory, steps: Array, q: Array) -> float:
    """Return the gas [kg/life] by which a chamber holds too much, where all were integrated together.

    Steps then have no sums: what is exchanged is taken to be spread as what flows back, or evenly where nothing does.
    """
    out = -float(streams_of(problem.composition, q)[slots.SUCTION_OUT, slots.OF_GAS])
    warmer = life.dense[steps, 1, slots.S_T] / problem.lines.T_s - 1.0
    some = SOME * problem.scene.numerics.accuracy * float(life.R[slots.R_TRAPPED])
    if _not_read(problem) or not out * float(np.abs(warmer).max(initial=0.0)) > some:
        return 0.0
    back, met = _flows_read(problem, life, steps)
    exchanged = max(out + float(back.sum()), 0.0)
    spread = back / back.sum() if back.any() else np.full(len(steps), 1.0 / len(steps))
    return exchanged * float((spread * warmer) @ _kept(problem, life, steps, -(back + met)))


def _not_read(problem: Problem) -> bool:
    """Return whether flows cannot be read from the dense output: two phases are followed, or oil gives off gas."""
    return problem.scene.gas.equilibrium or problem.composition.dissolves


def _flows_read(problem: Problem, life: Trajectory, steps: Array) -> tuple[Array, Array]:
    """Return the gas [kg] in each step that flows back to the line, and to other chambers, by the dense output."""
    c, omega = problem.composition, problem.parts.omega
    ports = [i for i, end in enumerate(c.ends[: len(c.plenum_paths)]) if end == SUCTION]
    begun, widths = life.times[steps, None], (life.times[steps + 1] - life.times[steps])[:, None]
    sampled, flows = life.sample((begun + widths * NODES).ravel())
    through = flows[:, ports].sum(axis=1)
    balanced = omega * sampled[:, GAS_RATE] - (flows.sum(axis=1) - through)
    gaps = np.minimum(flows[:, len(c.plenum_paths) :], 0.0).sum(axis=1)

    def summed(flow: Array) -> Array:
        """Return the integral over each step."""
        return (flow.reshape(-1, len(NODES)) * widths) @ WEIGHTS / omega

    return summed(np.where(through != 0.0, np.minimum(balanced, 0.0), 0.0)), summed(gaps)


def _kept(problem: Problem, life: Trajectory, steps: Array, out: Array) -> Array:
    """Return the share of an error in each step that is left after the later ones, from which gas flows out [kg]."""
    last = life.dense[steps, 1]
    rho, ratio = last[:, slots.S_RHO], last[:, slots.S_X_OIL] if problem.composition.carried else 0.0
    gas = rho * problem.gas_share(rho, ratio) * life.volumes(life.times[steps + 1])
    leaves = np.append(np.minimum(out / gas, 1.0)[1:], 0.0)
    return np.cumprod((1.0 - leaves)[::-1])[::-1]
