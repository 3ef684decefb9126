"""By how much a closed life misreads the heat of the oil that flows out: its sum beside the states within its steps.

While a wide port holds the pressure, steps are long, and the stages that sum the flow through it err. The balance of a
step sets the gas that leaves right, and its oil with it, but not at which temperature. Sums are no part of the error
control, and finer lives take nearly the same steps there.
Source: docs/model.md M41; docs/explanation/errors.md.
"""

import numpy as np

from screwsim.cycle.problem import Problem
from screwsim.model import slots
from screwsim.model.trajectory import Trajectory

PIECES = 8  # of a step, over each of which the oil is taken to leave at its mean temperature
LEAST = 0.1  # share of the oil that flows out over which its heat counts at least
INSIDE = 1e-9  # share of a step by which its ends lie within it: the state may jump between two steps
SHARES = np.linspace(0.0, 1.0, PIECES + 1).clip(INSIDE, 1.0 - INSIDE)  # of a step, where its states are read


def misread(problem: Problem, life: Trajectory) -> float:
    """Return the error of the temperature [K] of the oil that flows out over a life; 0 where none does.

    The life's steps have sums of their own (not those of all chambers together). What flows back brings oil that flowed
    out before, misread as much: the heat counts over the oil that stays in the line. Where no gas is delivered, what
    flows back is the line's own, too, and the heat counts over all that flows out.
    """
    c, n = problem.composition, life.steps
    first, last = (c.first_stream + c.width * stream for stream in (slots.DISCHARGE_IN, slots.DISCHARGE_OUT + 1))
    sums = life.quads[:n, first:last].copy()
    sums[1:] -= life.quads[: n - 1, first:last]
    back, out = sums[:, : c.width], sums[:, c.width :]
    steps, flowed = np.flatnonzero(out[:, slots.OF_OIL] < 0.0), -float(out[:, slots.OF_OIL].sum())
    if not flowed > 0.0:
        return 0.0
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
    mean = (leaves * (T[:, 1:] + T[:, :-1])).sum(axis=1) / np.maximum(2.0 * amount, 1e-300)
    heat = np.where(amount > 0.0, left * mean - out[steps, slots.OF_OIL_HEAT], 0.0)
    return abs(float(heat.sum())) / stays
