"""Errors by what a chamber misreads of the gas that it takes in or gives back, while a line holds its pressure.

Steps are long there. What the stages of a step make of the port's flow fits the gas, but its heat may be wrong:

- stages may alternate between flowing in and flowing back, which exchanges gas of the chamber for gas of the line;
- a neighbour that is squeezed, or meets its own line, within the step is missed, and the port makes good the gas that
  it gives or takes, at another temperature.

A chamber that is too cold holds too much gas. No error of the states shows it, and finer lives take nearly the same
steps. Where the flow is read at that port, what the port makes good is an error of the flow itself. Sums of what flows
back to a suction line err by the same stages, which no balance shows and finer steps remove slowly.
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
from screwsim.solve.sums_met_twice import EQUAL, MetTwice, shifts_to_neighbours

Array = np.ndarray
SOME = 0.05  # wanted accuracies: what is misread of the trapped gas that is left alone
NODES, WEIGHTS = gauss(2)  # of a step
RETURN_NODES, RETURN_WEIGHTS = gauss(4)  # the same for what returns to a line
GAS_RATE = SAMPLED.index("mass_rate")
TRAPPED = "trapped_mass"


class Misread(NamedTuple):
    """Gas [kg/life] by which a life's chamber holds too much, and by which its port takes in too much."""

    held: float
    drawn: float


NOTHING = Misread(0.0, 0.0)


def misread_intake_errors(of: Evaluation, misread: Misread) -> Iterator[Figures]:
    """Yield the errors of figures that a finer life than the evaluated one still has by what it misreads."""
    problem, found = of.problem, of.figures
    flow, trapped = found.get("gas_mass_flow"), found.get(TRAPPED)
    if not trapped:
        return
    held, drawn = map(abs, misread)
    some = SOME * problem.scene.numerics.accuracy * trapped
    if held > some:
        yield Figures({TRAPPED: held / trapped})
        if problem.parts.oil is not None and "ratio" in problem.parts.oil.supply:
            yield flow_errors(found, held / trapped, "by_oil")
    lost = held if meets_line_at_angle(problem) else drawn
    if flow and lost > some:
        yield flow_errors(found, lost * problem.rate / abs(flow))


def misread_intake(problem: Problem, life: Trajectory, met: MetTwice) -> Misread:
    """Return what a life misreads while it is open to the line that it takes gas in from.

    `met` are the sums of flows that differ in it. At a held pressure the sum of m T is fixed: gas taken in at T instead
    of the line's T_s displaces T/T_s - 1 of itself. What flows out later takes its part of the error with it.
    """
    c, ends = problem.composition, life.times[: life.steps + 1]
    steps, T_s = _steps(problem, life), problem.lines.T_s
    if not len(steps):
        return NOTHING
    into, back = (_sums(life, steps, c.stream(row)) for row in (slots.SUCTION_IN, slots.SUCTION_OUT))
    T = life.dense[: len(steps), :2, slots.S_T].mean(axis=1)
    warmer = T / T_s - 1.0
    more = _exchanged(problem, life, steps, np.minimum(into, -back) * warmer, back) * warmer
    some = SOME * problem.scene.numerics.accuracy * float(life.R[slots.R_TRAPPED])
    at = np.flatnonzero(met.step < len(steps))
    step, column, differ = (each[at] for each in met)
    drawn = -float(differ[(into - back)[step] > 0.0].sum())
    hottest = float(life.dense[: life.steps, 1, slots.S_T].max())
    if float(np.abs(differ).sum()) * (hottest / T_s - 1.0) > some:
        middles = 0.5 * (ends[step] + ends[step + 1]) + shifts_to_neighbours(problem)[column]
        order, T_met = middles.argsort(), np.empty(len(at))
        T_met[order] = life.states_at(middles[order])[:, slots.S_T]
        sums = _sums(life, steps, c.all_met)
        T_from = np.where(sums[step, column] < 0.0, T[step], T_met)
        T_port = np.where((into + back)[step] > 0.0, T_s, T[step])
        more = more - np.bincount(step, differ * (T_from / T_port - 1.0), len(steps))
    if not float(np.abs(more).sum()) > some:
        return Misread(0.0, drawn)
    given = np.minimum(_sums(life, steps, c.all_met), 0.0).sum(axis=1)
    return Misread(float(more @ _kept(problem, life, steps, -(given + back))), drawn)


def misread_by_all(problem: Problem, life: Trajectory, q: Array) -> Misread:
    """Return what is misread where all chambers were integrated together, with quadratures q.

    They evaluate a flow between two of them once, but exchange gas with the line as well. Steps have no sums then: what
    is exchanged is taken to be spread as what flows back, or evenly where nothing does.
    """
    steps = _steps(problem, life)
    out = -float(streams_of(problem.composition, q)[slots.SUCTION_OUT, slots.OF_GAS])
    warmer = life.dense[: len(steps), 1, slots.S_T] / problem.lines.T_s - 1.0
    some = SOME * problem.scene.numerics.accuracy * float(life.R[slots.R_TRAPPED])
    if _not_read(problem) or not out * float(np.abs(warmer).max(initial=0.0)) > some:
        return NOTHING
    back, given = _flows_read(problem, life, np.arange(life.steps))  # a bore may lead to the line later, too
    exchanged = max(out + float(back.sum()), 0.0)
    back, given = back[: len(steps)], given[: len(steps)]
    spread = back / back.sum() if back.any() else np.full(len(steps), 1.0 / len(steps))
    return Misread(exchanged * float((spread * warmer) @ _kept(problem, life, steps, -(back + given))), 0.0)


def misread_return(problem: Problem, life: Trajectory, q: Array) -> float:
    """Return the gas [kg/life] by which a life with quadratures q sums too much or too little back to suction.

    The flow through the ports is read a second time, from the change of the chamber's gas less what other paths bring.
    It is 0 for a gas whose two phases are followed, and where oil gives off gas (that is no flow of a path).
    """
    if _not_read(problem):
        return 0.0
    c, widths = problem.composition, np.diff(life.times[: life.steps + 1])
    column = c.stream(slots.SUCTION_OUT)
    backward = np.diff(life.quads[: life.steps, column], prepend=0.0) < 0.0  # all chambers together keep no such sums
    steps = np.flatnonzero(backward) if backward.any() else np.arange(life.steps)
    back, _ = _flows_at(problem, life, steps, RETURN_NODES)
    read = float(((back * widths[steps, None]) @ RETURN_WEIGHTS).sum()) / problem.parts.omega
    return abs(read - float(streams_of(c, q)[slots.SUCTION_OUT, slots.OF_GAS]))


def _steps(problem: Problem, life: Trajectory) -> Array:
    """Return the numbers of the steps, the first ones, in which a chamber is open to that line."""
    geometry = problem.parts.geometry
    until = (geometry.inlet_closes if geometry.expands else problem.parted) or geometry.injection_angle
    return np.arange(int(life.times[1 : life.steps + 1].searchsorted(until + EQUAL)))


def _sums(life: Trajectory, steps: Array, columns: int | slice) -> Array:
    """Return what the first steps sum in columns of the quadratures, each by itself."""
    return np.diff(life.quads[: len(steps), columns], axis=0, prepend=0.0)


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


def _not_read(problem: Problem) -> bool:
    """Return whether flows cannot be read from the dense output: two phases are followed, or oil gives off gas."""
    return problem.scene.gas.equilibrium or problem.composition.dissolves


def _flows_read(problem: Problem, life: Trajectory, steps: Array) -> tuple[Array, Array]:
    """Return the gas [kg] in each step that flows back to the line, and to other chambers, by the dense output."""
    widths = (life.times[steps + 1] - life.times[steps])[:, None]
    back, gaps = ((flow * widths) @ WEIGHTS / problem.parts.omega for flow in _flows_at(problem, life, steps, NODES))
    return back, gaps


def _flows_at(problem: Problem, life: Trajectory, steps: Array, nodes: Array) -> tuple[Array, Array]:
    """Return the flows [kg/s] back to the line, and to other chambers, at nodes of steps (steps, nodes)."""
    c = problem.composition
    ports = [i for i, end in enumerate(c.ends[: len(c.ports)]) if end == SUCTION]
    begun, widths = life.times[steps, None], (life.times[steps + 1] - life.times[steps])[:, None]
    sampled, flows = life.sample((begun + widths * nodes).ravel())
    through = flows[:, ports].sum(axis=1)
    balanced = problem.parts.omega * sampled[:, GAS_RATE] - (flows.sum(axis=1) - through)
    back = np.where(through != 0.0, np.minimum(balanced, 0.0), 0.0)
    gaps = np.minimum(flows[:, len(c.ports) :], 0.0).sum(axis=1)
    return back.reshape(-1, len(nodes)), gaps.reshape(-1, len(nodes))


def _kept(problem: Problem, life: Trajectory, steps: Array, out: Array) -> Array:
    """Return the share of an error in each step that is left after the later ones, from which gas flows out [kg]."""
    last = life.dense[steps, 1]
    rho, ratio = last[:, slots.S_RHO], last[:, slots.S_X_OIL] if problem.composition.carried else 0.0
    gas = problem.gas_mass(rho, ratio, life.volumes(life.times[steps + 1]))
    leaves = np.append(np.minimum(out / gas, 1.0)[1:], 0.0)
    return np.cumprod((1.0 - leaves)[::-1])[::-1]
