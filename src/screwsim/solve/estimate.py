"""Estimate the errors of the figures of a closed cycle (docs/model.md M41).

The errors follow from the changes of the figures in finer solutions (`solve.estimate_protocol`): one more life after
the closed cycle, with a finer tolerance and a narrower regularisation; two lives, the first moved by Newton's
correction to the limit of all that follow; or the cycle closed again, finer. A further estimate is a function as
`solve.estimate_protocol.Estimate` says, an entry in `ESTIMATES`, and one in `numerics.settings`. Errors due to open
balances of a closed life are added: gas, oil, its heat, dissolved gas, gap flows met twice.
Source: docs/explanation/errors.md.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from screwsim.cycle import balances
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import ClosingCriteria, CorrectedState, CycleSolution
from screwsim.cycle.ways import way_of
from screwsim.effects.base import FlowPath
from screwsim.evaluate.evaluation import Evaluation
from screwsim.figures.errors import error_of, flow_errors, relative_errors
from screwsim.model import slots
from screwsim.model.run import Machinery
from screwsim.model.trajectory import Trajectory
from screwsim.model.turn_scheduler import reach_station
from screwsim.numerics.settings import AGAIN, CHAMBERS, ERRORS, LIVES
from screwsim.outputs import Figures, names_of
from screwsim.solve.estimate_protocol import (
    BARELY_DELIVERS,
    NARROWER,
    NO_SOLUTIONS,
    Estimate,
    EstimateRequest,
    FinerSolutions,
)
from screwsim.solve.finer_solutions import chambers_together, changes, closed_again, finer_lives, repeated_share
from screwsim.solve.swings import Curves, curves_of, swing_errors

WHOLE = 1.0 / (1.0 - NARROWER**0.5)  # error over the change, where the error is the regularisation's, going as ε^½
LEAKY_BELOW = 0.5  # volumetric efficiency below which an error of waveform relaxation persists for many turns
LEAKY_FACTOR = 1.5  # factor by which it then exceeds what two turns show
NO_DELIVERY_FACTOR = 2.0  # the same for a machine that delivers nothing: its chambers hold only leaks
LARGEST_RATIO = 0.9  # largest ratio of successive lives' changes that is extrapolated
LEAST_DELIVERY_ERROR = 0.3  # of the trapped gas's error: least error of a small delivered amount
OIL_SHARE = 0.5  # share of carried oil left open beyond the bound by which its flow errs; measured: at most 0.4
FLASH_SHARE = 0.25  # share of a residual of dissolved gas by which flashed gas errs; measured: at most 0.2
OIL_OUT = "oil_discharge_temperature"
PIECES = 8  # of a step, over each of which the oil is taken to leave at its mean temperature
LEAST = 0.1  # share of the oil that flows out over which its heat counts at least
INSIDE = 1e-9  # share of a step by which its ends lie within it: the state may jump between two steps
SHARES = np.linspace(0.0, 1.0, PIECES + 1).clip(INSIDE, 1.0 - INSIDE)  # of a step, where its states are read
ESTIMATES: dict[str, Estimate] = {CHAMBERS: chambers_together, LIVES: finer_lives, AGAIN: closed_again}


def estimated_errors(
    of: Evaluation, machinery: Machinery, criteria: ClosingCriteria, cycle: CycleSolution
) -> tuple[Figures, CorrectedState | CycleSolution | None]:
    """Return the estimated relative error of every figure of a closed cycle, which the machinery holds.

    The second value is where finer lives have led, if the machinery now stands there, or the finer cycle that a
    search closed; otherwise None.
    """
    found, curves = of.figures, curves_of(of)
    reach_station()
    narrower = replace(criteria, widths=tuple(NARROWER * width for width in criteria.widths))
    request = EstimateRequest(of, machinery, narrower, cycle)
    finer = _finer_solutions(request)
    if not finer.figures:
        return Figures(dict.fromkeys(found)), None
    reach_station()
    errors = _errors_shown(of, finer, curves)
    c = of.problem.composition
    told = c.chambers == 1 or way_of(cycle).whole or finer.left is not None  # feedback through other chambers seen
    among_leaks = not told and request.filling < LEAKY_BELOW  # leaks dominate: errors pass from turn to turn
    whole = WHOLE * ((LEAKY_FACTOR if request.filling > 0.0 else NO_DELIVERY_FACTOR) if among_leaks else 1.0)
    left = cycle.left if len(finer.figures) == 1 else 0.0  # a second life shows it
    for name, size in errors.items():
        errors[name] = whole * size + left if size is not None else None
    lost_flow = {"by_flow": whole * finer.flow} if finer.flow else {}
    if request.hidden and request.filling > 0.0:
        lost_flow["by_flow"] = LEAST_DELIVERY_ERROR * (errors.get("trapped_mass") or 0.0) / request.filling
    if _closed_on_noise(request):
        lost_flow["by_flow"] = max(lost_flow.get("by_flow", 0.0), cycle.change / request.filling)
    lost_now = [flow_errors(found, lost, by) for by, lost in lost_flow.items()]
    for each in (*lost_now, *open_balance_errors(of, cycle)):
        for name, size in each.items():
            errors[name] = (errors[name] or 0.0) + (size or 0.0)
    of_squares(found, errors)
    return errors, finer.corrected_state or finer.cycle


def _closed_on_noise(request: EstimateRequest) -> bool:
    """Return whether pitches of a machine that barely delivers still changed by more than asked when they stalled.

    What they change of the gas in the chambers is much of the little that is delivered, in finer pitches as well.
    """
    barely = way_of(request.cycle).whole and 0.0 < request.filling < BARELY_DELIVERS
    return barely and request.cycle.change > request.criteria.tolerance


def of_squares(found: Figures, errors: Figures) -> None:
    """Raise the errors of figures that go with the square of swings to twice the largest error of these."""
    for name, about in found.about.items():
        if about.curve and errors.get(name) is not None:
            errors[name] = max(errors[name] or 0.0, *(2.0 * (errors[each] or 0.0) for each in about.curve))


def _finer_solutions(request: EstimateRequest) -> FinerSolutions:
    """Return the finer solutions of the first estimate that suffices, else of the last that found any.

    In the latter case they are not a place to continue from.
    """
    found = NO_SOLUTIONS
    for name in ERRORS[request.problem.scene.numerics.error].by:
        finer = ESTIMATES[name](request)
        if finer.enough:
            return finer
        found = finer if finer.figures else found
    return found._replace(corrected_state=None)


def _errors_shown(of: Evaluation, finer: FinerSolutions, curves: Curves) -> Figures:
    """Return the error of each figure as finer solutions show it: their largest change, plus those of further lives.

    Two lives may agree with the closed one by chance, each in another figure, so the largest change counts; a swing
    changes by no less than its curve among `curves` does. Later lives continue the last one's change as a geometric
    series with the ratio of the last two changes. A corrected life is at the limit of all lives, up to what its
    correction left; earlier lives are only on the way there.
    """
    lives, left = finer.figures, finer.left
    solutions = [*zip([of.figures, *lives], [curves, *(finer.curves or [{}] * len(lives))], strict=True)]
    errors = _distances(of, solutions[0], solutions[-1])
    for each in solutions[1:-1] if left is None else ():
        for name, size in _distances(of, solutions[0], each).items():
            if size is not None and errors[name] is not None:
                errors[name] = max(errors[name], size)
    if len(lives) > 1:
        again = min(repeated_share(changes(of, lives)) if left is None else left, LARGEST_RATIO)
        for name, size in _distances(of, *solutions[-2:]).items():
            if size is not None and errors[name] is not None:
                errors[name] += size * again / (1.0 - again)
    return errors


def _distances(of: Evaluation, found: tuple[Figures, Curves], better: tuple[Figures, Curves]) -> Figures:
    """Return the relative errors of the figures beside better ones; those of swings are no less than their curves'."""
    sizes = relative_errors(found[0], better[0], *of.least)
    for name, size in swing_errors(*found, better[1]).items():
        if sizes.get(name) is not None:
            sizes[name] = max(sizes[name], size)
    return sizes


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
