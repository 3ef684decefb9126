"""By how much a closed life misreads the heat of gas that flows out through the discharge port, where most flows back.

While a wide port holds the pressure, the stages of a step alternate between flowing out and flowing back. Their sum is
right, as the balance of the step sets it, but not each of the two: more seems to pass both ways than does, and weighs
in the mean of what flows out. With finer steps that ends slowly, so that finer solutions have most of it, too. The
port's flow is read a second time, of the change of the chamber's gas within steps less what other paths bring.
Source: docs/model.md M41; docs/explanation/errors.md.
"""

import numpy as np

from screwsim.cycle.balances import outflow_of, streams_of
from screwsim.cycle.problem import Problem
from screwsim.effects.base import DISCHARGE
from screwsim.model import slots
from screwsim.model.trace import SAMPLED
from screwsim.model.trajectory import Trajectory

RETURNS = 0.9  # share of the gas that flows out that flows back, above which it is read again
NODES = np.array([0.25, 0.75])  # shares of a step at which flows are read
PRESSURE, GAS_RATE, TEMPERATURE = SAMPLED.index("pressure"), SAMPLED.index("mass_rate"), len(SAMPLED) + slots.S_T


def misread(problem: Problem, life: Trajectory, q: np.ndarray) -> float:
    """Return the error of the mean enthalpy [J/kg] of the gas that flows out over a life with quadratures q.

    It is 0 where less than `RETURNS` of that gas flows back, where more than one port leads to the discharge line, and
    for a gas whose two phases are followed.
    """
    c, streams = problem.composition, streams_of(problem.composition, q)
    mean, (back, out) = outflow_of(streams), streams[slots.DISCHARGE_IN : slots.DISCHARGE_OUT + 1, slots.OF_GAS]
    ports = [i for i, end in enumerate(c.ends[: len(c.plenum_paths)]) if end == DISCHARGE]
    if mean is None or len(ports) != 1 or back < RETURNS * -out or problem.scene.gas.equilibrium:
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
    ports = len(c.plenum_paths)
    for i, (_, offset) in enumerate(c.gap_paths):
        if c.ends[ports + i] == DISCHARGE:
            beyond = angles > geometry.life - offset * geometry.pitch
            found += np.where(beyond, np.maximum(-flows[:, ports + 2 * i], 0.0), 0.0)
    return found
