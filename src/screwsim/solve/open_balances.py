"""Errors of the figures due to open balances of a closed life: gas, oil, its heat, dissolved gas, gap flows met twice.

Source: docs/model.md M41; docs/explanation/errors.md.
"""

from collections.abc import Iterator

import numpy as np

from screwsim.cycle import balances
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution
from screwsim.cycle.ways import way_of
from screwsim.effects.base import FlowPath
from screwsim.evaluate.evaluation import Evaluation
from screwsim.figures.errors import error_of, flow_errors
from screwsim.model import slots
from screwsim.model.trajectory import Trajectory
from screwsim.outputs import Figures, names_of

OIL_SHARE = 0.5  # share of carried oil left open beyond the bound by which its flow errs; measured: at most 0.4
FLASH_SHARE = 0.25  # share of a residual of dissolved gas by which flashed gas errs; measured: at most 0.2

OIL_OUT = "oil_discharge_temperature"
PIECES = 8  # of a step, over each of which the oil is taken to leave at its mean temperature
LEAST = 0.1  # share of the oil that flows out over which its heat counts at least
INSIDE = 1e-9  # share of a step by which its ends lie within it: the state may jump between two steps
SHARES = np.linspace(0.0, 1.0, PIECES + 1).clip(INSIDE, 1.0 - INSIDE)  # of a step, where its states are read


def open_balance_errors(of: Evaluation, cycle: CycleSolution) -> Iterator[Figures]:
    """Yield the errors of figures due to residuals of gas, carried oil, its heat and dissolved gas over a life.

    Errors in gaps between chambers that are open to the suction line are compensated by the line; the net flow,
    where it is taken later, and the injected oil do not see them. But oil is injected before a slide's slot has
    closed.
    """
    problem, found, q = of.problem, of.figures, cycle.q
    flow, oil = found["gas_mass_flow"], found.get("oil_mass_flow")
    if flow and not balances.meets_line_at_angle(problem):
        yield flow_errors(found, abs(balances.mass_in(problem.composition, q) * problem.rate / flow))
    if oil and problem.composition.carried:
        left = of.left or balances.residuals(problem, of.life.R, q)
        lost = left.oil_left * problem.rate / abs(oil)
        if not balances.exits_late(problem):  # little oil: its balance is held to the bound as a share of the gas alone
            lost = OIL_SHARE * max(0.0, lost - problem.scene.numerics.accuracy)
        yield flow_errors(found, lost, "by_oil")
    held, flashes = balances.dissolved_gas_residual(problem, q) * problem.rate, found.get("flash_mass_flow")
    if held and flashes:
        yield flow_errors(found, FLASH_SHARE * held / abs(flashes), "by_held")
    if problem.composition.carried and found.get(OIL_OUT) is not None and not way_of(cycle).whole:
        yield Figures({OIL_OUT: error_of(OIL_OUT, misread(problem, cycle.trajectory), found)})
    if balances.meets_line_at_angle(problem) and not way_of(cycle).whole:
        yield from _plenum_port_errors(of, cycle)


def _plenum_port_errors(of: Evaluation, cycle: CycleSolution) -> Iterator[Figures]:
    """Yield the errors of gap flows that a plenum's port compensates, as a line does."""
    problem, found = of.problem, of.figures
    parts, rate, streams = problem.parts, problem.rate, balances.streams_of(problem.composition, cycle.q)
    for name, path in parts.all(FlowPath):
        if path.to not in parts.plenums or not path.breakpoints:
            continue
        by_port, across = balances.gap_flow_compensation(
            problem, cycle.trajectory, min(path.breakpoints), max(path.breakpoints)
        )
        i, flow, about = 2 * parts.number(path.to), found["gas_mass_flow"], problem.scene.effects[name].effect.figures
        drawn = abs(float(streams[i, slots.OF_GAS] + streams[i + 1, slots.OF_GAS]))
        own = set(names_of(about))
        if drawn:
            errors = flow_errors(found, by_port / drawn, "by_port")
            yield Figures({each: size for each, size in errors.items() if each in own})
        if flow:
            yield flow_errors(found, across * rate / abs(flow))


def misread(problem: Problem, life: Trajectory) -> float:
    """Return the error of the temperature [K] of the oil that flows out over a life; 0 where none does.

    While a wide port holds the pressure, steps are long, and the stages that sum the flow through it err. The balance
    of a step sets the gas that leaves right, and its oil with it, but not at which temperature. Sums are no part of the
    error control, and finer lives take nearly the same steps there. So the sum is compared with the states within the
    steps.

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
