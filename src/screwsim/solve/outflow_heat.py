"""By how much a closed life misreads heat and dissolved gas that flow out, from the states within its steps.

While a wide port holds the pressure, steps are long, and the stages that sum the flow through it have errors. The
balance of a step sets the gas that leaves right, and its oil with it, but not the temperature at which it left, nor
what the oil held dissolved. Stages
may also alternate between flowing out and flowing back: more gas seems to pass both ways than does, and counts in the
mean of what flows out. Sums are no part of the error control, and finer lives take nearly the same steps there.
Source: docs/model.md M41; docs/explanation/errors.md.
"""

from typing import NamedTuple

import numpy as np

from screwsim.cycle.balances import outflow_of, streams_of
from screwsim.cycle.problem import Problem
from screwsim.effects.base import DISCHARGE
from screwsim.model import slots
from screwsim.model.trace import SAMPLED
from screwsim.model.trajectory import Trajectory

PIECES = 8  # of a step, over each of which the oil is taken to leave at its mean temperature
LEAST = 0.1  # share of the oil that flows out over which its heat counts at least
INSIDE = 1e-9  # share of a step by which its ends lie within it: the state may jump between two steps
SHARES = np.linspace(0.0, 1.0, PIECES + 1).clip(INSIDE, 1.0 - INSIDE)  # of a step, where its states are read
RETURNS = 0.9  # share of the gas that flows out that flows back, above which its heat is read again
NODES = np.array([0.25, 0.75])  # shares of a step at which flows of gas are read
PRESSURE, GAS_RATE, TEMPERATURE = SAMPLED.index("pressure"), SAMPLED.index("mass_rate"), len(SAMPLED) + slots.S_T


class OilMisread(NamedTuple):
    """The errors of the temperature [K] of the oil that flows out over a life, and of what it holds dissolved [kg/kg].

    The latter is 0 where that is no state.
    """

    temperature: float
    held: float


def misread_of_oil(problem: Problem, life: Trajectory) -> OilMisread:
    """Return by how much the sums misread the oil that flows out over a life; zeros where none does.

    The life's steps have sums of their own (not those of all chambers together). What flows back brings oil that flowed
    out before, misread as much: both count over the oil that stays in the line. Where no gas is delivered, what flows
    back is the line's own, too, and they count over all that flows out.
    """
    c = problem.composition
    first, last = (c.stream(each) for each in (slots.DISCHARGE_IN, slots.DISCHARGE_OUT + 1))
    sums = np.diff(life.quads[: life.steps, first:last], axis=0, prepend=0.0)
    back, out = sums[:, : c.width], sums[:, c.width :]
    steps, flowed = np.flatnonzero(out[:, slots.OF_OIL] < 0.0), -float(out[:, slots.OF_OIL].sum())
    if not flowed > 0.0:
        return OilMisread(0.0, 0.0)
    delivers = float(out[:, slots.OF_GAS].sum() + back[:, slots.OF_GAS].sum()) < 0.0
    stays = max(LEAST * flowed, flowed - float(back[:, slots.OF_OIL].sum())) if delivers else flowed
    begun, ended = life.times[steps, None], life.times[steps + 1, None]
    angles = begun + SHARES * (ended - begun)
    shape, angles = angles.shape, angles.ravel()
    states = life.states_at(angles)
    rho, ratio = states[:, slots.S_RHO], states[:, slots.S_X_OIL]
    oil = (ratio * rho * problem.gas_share(rho, ratio) * life.volumes(angles)).reshape(shape)
    T = (states[:, slots.S_T_OIL] + problem.oil_pressure_term(1.0) * states[:, -1]).reshape(shape)
    left = out[steps, slots.OF_OIL]
    others = (oil[:, -1] - oil[:, 0] - left) / PIECES  # oil that comes and goes on other ways, taken as even
    leaves = np.maximum(others[:, None] - (oil[:, 1:] - oil[:, :-1]), 0.0)
    amount = leaves.sum(axis=1)

    def misread(values: np.ndarray, column: int) -> float:
        """Return by how much what leaves at the values of a state differs from its sum, over the oil that stays."""
        mean = (leaves * (values[:, 1:] + values[:, :-1])).sum(axis=1) / np.maximum(2.0 * amount, 1e-300)
        return abs(float(np.where(amount > 0.0, left * mean - out[steps, column], 0.0).sum())) / stays

    held = misread(states[:, slots.HELD].reshape(shape), slots.OF_HELD) if c.dissolves else 0.0
    return OilMisread(misread(T, slots.OF_OIL_HEAT), held)


def misread_of_gas(problem: Problem, life: Trajectory, q: np.ndarray) -> float:
    """Return the error of the mean enthalpy [J/kg] of the gas that flows out over a life with quadratures q.

    The port's flow is read a second time, from the change of the chamber's gas within steps less what others bring. It
    is 0 where less than `RETURNS` of that gas flows back, where more than one port leads to the discharge line, for a
    gas whose two phases are followed, and where a state lies outside the gas's equation.
    """
    c, streams = problem.composition, streams_of(problem.composition, q)
    back, out = streams[slots.DISCHARGE_IN : slots.DISCHARGE_OUT + 1, slots.OF_GAS]
    ports = [i for i, end in enumerate(c.ends[: len(c.ports)]) if end == DISCHARGE]
    if back < RETURNS * -out or len(ports) != 1 or problem.scene.gas.equilibrium:
        return 0.0
    mean = outflow_of(streams)
    if mean is None or problem.parts.gas.first_outside(*life.ends) is not None:
        return 0.0
    times, (port,) = life.times[: life.steps + 1], ports
    widths = np.diff(times)[:, None] * np.ones(len(NODES))
    angles = (times[:-1, None] + NODES * widths).ravel()
    sampled, flows = life.sample(angles)
    through = problem.parts.omega * sampled[:, GAS_RATE] - (flows.sum(axis=1) - flows[:, port])
    leaves = np.where(flows[:, port] != 0.0, np.maximum(-through, 0.0), 0.0)  # where the port is open
    leaves = (leaves + _beyond_the_last(problem, angles, flows)) * widths.ravel()
    some = np.flatnonzero(leaves)
    if not len(some):
        return 0.0
    states = zip(sampled[some, PRESSURE].tolist(), sampled[some, TEMPERATURE].tolist(), strict=True)
    enthalpy = np.array([problem.parts.gas.enthalpy(p, T) for p, T in states])
    return abs(float(leaves[some] @ enthalpy / leaves[some].sum()) - mean.enthalpy)


def _beyond_the_last(problem: Problem, angles: np.ndarray, flows: np.ndarray) -> np.ndarray:
    """Return the gas [kg/s] that flows out through gaps ahead whose other side is beyond the last chamber."""
    c, geometry, found = problem.composition, problem.parts.geometry, np.zeros(len(angles))
    for i, (_, offset) in enumerate(c.gaps):
        beyond = angles > geometry.life - offset * geometry.pitch
        found += np.where(beyond, np.maximum(-flows[:, c.flow_through(i, slots.AHEAD)], 0.0), 0.0)
    return found
