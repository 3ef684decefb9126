"""Least errors of figures by what a chamber misses of its neighbours within its steps, while it is closed.

A chamber meets its neighbours at the stages of its own steps. An event of a neighbour that takes a few degrees (the
end of its life, where its last gas is squeezed out) may lie between two stages of one step. No error of the states
shows that, and a finer life may step over it as well. But the neighbour sums the same flow with its many steps. Where
the two sums differ, the step is read again at the ends of all their steps; the departure δ of ln m that it leaves is
then followed as the flows let it decay.
Source: ours; docs/explanation/errors.md.
"""

from typing import NamedTuple

import numpy as np

from screwsim.cycle.problem import Problem
from screwsim.evaluate.evaluation import Evaluation
from screwsim.figures.errors import relative_errors
from screwsim.model import slots
from screwsim.model.trace import SAMPLED
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.quadrature import gauss
from screwsim.outputs import Figures
from screwsim.solve.sums_met_twice import EQUAL, MetTwice

Array = np.ndarray
SOME = 0.1  # wanted accuracies: departure of ln m that is left alone
DOUBTFUL = 0.2  # share of that by which the two sums of a step may differ
GAIN = 1.5  # change of ln p over that of ln m, as the gas comes from a hotter chamber: 0.8 to 1.7 in eight scenes
DENSER = 1e-7  # relative change of the density by which slopes of flows are found
NODES, WEIGHTS = gauss(2)  # between two ends of steps: four change what is missed by a fiftieth at most
PEAK = "peak_pressure"
VOLUME, RHO = SAMPLED.index("volume"), len(SAMPLED) + slots.S_RHO


class Departures(NamedTuple):
    """Departure of ln p of a life at the ends of its steps, with their angles [rad] and pressures [Pa]."""

    angles: Array
    pressure: Array
    of_pressure: Array


def missed_neighbour_errors(of: Evaluation, finer: Trajectory, met: MetTwice, known: Figures) -> Figures:
    """Return the errors of the peak pressure and of the figures of the work that a finer life still has; empty if few.

    It is the life, finer than the evaluated one, by which the errors of the figures are `known`; where these are None,
    there is none. `met` are the sums of flows that differ in it.
    """
    found = departures(of.problem, finer, met)
    if found is None:
        return Figures()
    excess, q = found.pressure * found.of_pressure, of.q.copy()
    q[slots.Q_WORK] -= float(0.5 * (excess[1:] + excess[:-1]) @ np.diff(finer.volumes(found.angles)))
    errors = relative_errors(of.figures, Evaluation(of.problem, of.life, q).figures, *of.least)
    errors[PEAK] = abs(float(found.of_pressure[found.pressure.argmax()]))
    return Figures({name: size for name, size in errors.items() if size is not None and known.get(name) is not None})


def departures(problem: Problem, life: Trajectory, met: MetTwice) -> Departures | None:
    """Return how a life departs from one that meets all of its neighbours; None where that is less than `SOME`."""
    geometry, ends = problem.parts.geometry, life.times[: life.steps + 1]
    left, opens = problem.parted or geometry.injection_angle, geometry.discharge_opens or geometry.life
    closed = (ends[met.step] > left - EQUAL) & (ends[met.step + 1] < opens + EQUAL)
    steps = np.unique(met.step[closed])
    differ = np.bincount(met.step[closed], met.differ[closed], life.steps)[steps]
    last = life.dense[: life.steps, 1]
    rho, ratio = last[steps, slots.S_RHO], last[steps, slots.S_X_OIL] if problem.composition.carried else 0.0
    gas = problem.gas_mass(rho, ratio, life.volumes(ends[steps + 1]))
    some = SOME * problem.scene.numerics.accuracy
    differ = np.abs(differ) / gas
    doubtful = differ > DOUBTFUL * some
    if not differ[doubtful].sum() > some:
        return None
    steps, gas = steps[doubtful], gas[doubtful]
    first, shares = int(steps[0]), np.zeros(life.steps)
    shares[steps] = _missed_gas(problem, life, steps) / gas
    if np.abs(shares).sum() <= some:
        return None
    passed = np.maximum(_decay(problem, life, first) * np.diff(ends)[first:], 1e-12)
    added = shares[first:] * (-np.expm1(-passed) / passed)  # missed evenly over the step
    departure, of_mass = 0.0, np.empty(len(passed))
    for i, (more, remains) in enumerate(zip(added.tolist(), np.exp(-passed).tolist(), strict=True)):
        of_mass[i] = departure = departure * remains + more
    if np.abs(of_mass).max() <= some:
        return None
    return Departures(ends[first + 1 :], last[first:, len(life.composition.states)], GAIN * of_mass)


def _missed_gas(problem: Problem, life: Trajectory, steps: Array) -> Array:
    """Return the gas [kg] that steps sum through gaps beyond what flows by the dense output of all chambers."""
    c, geometry, ends = problem.composition, problem.parts.geometry, life.times[: life.steps + 1]
    every = np.unique(np.concatenate([ends + k * offset * geometry.pitch for offset in c.offsets for k in (0, 1, -1)]))
    low, high = every.searchsorted(ends[steps]), every.searchsorted(ends[steps + 1])
    parts = np.concatenate([np.arange(a, b) for a, b in zip(low.tolist(), high.tolist(), strict=True)])
    widths = (every[parts + 1] - every[parts])[:, None]
    angles = every[parts, None] + widths * NODES
    _, flows = life.sample(angles.ravel())
    found = np.zeros(angles.size)
    for i, (_, offset) in enumerate(c.gaps):
        among = angles.ravel() < geometry.life - offset * geometry.pitch  # beyond, gas comes from the line
        ahead, behind = (flows[:, c.flow_through(i, side)] for side in (slots.AHEAD, slots.BEHIND))
        found += np.where(among, ahead, 0.0) + behind
    flowed = (found.reshape(angles.shape) * widths) @ WEIGHTS / problem.parts.omega
    sums = np.diff(life.quads[: life.steps, c.all_met].sum(axis=1), prepend=0.0)
    return sums[steps] - np.bincount(np.repeat(np.arange(len(steps)), high - low), flowed, len(steps))


def _decay(problem: Problem, life: Trajectory, first: int) -> Array:
    """Return the rate [1/rad] at which flows let a departure of ln m decay in the steps from `first` on."""
    ends = life.times[first : life.steps + 1]
    angles = 0.5 * (ends[:-1] + ends[1:])
    sampled, flows = life.sample(angles)
    _, more = life.denser(DENSER).sample(angles)
    slope = (more - flows).sum(axis=1) / DENSER
    return -slope / (problem.parts.omega * sampled[:, VOLUME] * sampled[:, RHO])
