"""Errors of the figures due to open balances of a closed life: gas, oil, its heat, dissolved gas, gap flows met twice.

Source: docs/model.md M41; docs/explanation/errors.md.
"""

from collections.abc import Iterator

from screwsim.cycle import balances
from screwsim.cycle.backflow import MOST_TURNS, later_warming
from screwsim.cycle.feedback import AT_RATIO, AT_TEMPERATURE, line_unknowns
from screwsim.cycle.problem import LEAST_OIL
from screwsim.cycle.solution import CycleSolution
from screwsim.cycle.ways import way_of
from screwsim.effects.base import FlowPath
from screwsim.evaluate.evaluation import Evaluation
from screwsim.figures.errors import error_of, flow_errors
from screwsim.model.slots import DISCHARGE_IN, DISCHARGE_OUT, OF_GAS, OF_OIL, SUCTION_OUT
from screwsim.outputs import Figures, names_of
from screwsim.solve.misread_intake import misread_return
from screwsim.solve.outflow_heat import misread_of_gas, misread_of_oil

OIL_SHARE = 0.5  # share of carried oil left open beyond the bound by which its flow errs; measured: at most 0.4
FLASH_SHARE = 0.25  # share of a residual of dissolved gas by which flashed gas errs; measured: at most 0.2

GAS_OUT, OVER_DEW = "discharge_temperature", "discharge_superheat"
OIL_OUT, HELD_OUT = "oil_discharge_temperature", "discharge_dissolved_gas_ratio"


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
        misread = misread_of_oil(problem, cycle.trajectory)
        sizes = {OIL_OUT: misread.temperature, HELD_OUT: misread.held}
        yield Figures({name: error_of(name, size, found) for name, size in sizes.items() if found.get(name)})
    yield _unclosed_oil_errors(of)
    yield _gas_heat_errors(of, cycle)
    yield _returned_errors(of, cycle)
    if balances.meets_line_at_angle(problem) and not way_of(cycle).whole:
        yield from _plenum_port_errors(of, cycle)


def later_warming_errors(of: Evaluation, cycle: CycleSolution) -> Figures:
    """Return the errors of what flows out, by what later turns still warm it, of a cycle whose turns showed no pace.

    Its guess was good, or corrections led it; a finer life shows what it warms itself, not what all do.
    """
    problem, found = of.problem, of.figures
    if way_of(cycle).whole:
        return Figures()
    taken = line_unknowns(problem, of.life.R)
    later = abs(later_warming(problem, cycle.q, taken, of.image[: len(taken)]))
    return Figures({name: error_of(name, later, found) for name in (GAS_OUT, OIL_OUT) if later and found.get(name)})


def _unclosed_oil_errors(of: Evaluation) -> Figures:
    """Return the error of the temperature of outflowing oil that is too little for the line's to be closed.

    What flows back is at the line's temperature. Were it what flows out that does, its share s of what flows out would
    change that by s/(1 − s) of how far both are apart.
    """
    problem, found = of.problem, of.figures
    if not problem.composition.carried or found.get(OIL_OUT) is None:
        return Figures()
    taken, out = line_unknowns(problem, of.life.R), -float(of.streams[DISCHARGE_OUT, OF_OIL])
    made = of.image[: len(taken)]
    if made[AT_RATIO] >= LEAST_OIL or not out > 0.0:
        return Figures()
    share = min(float(of.streams[DISCHARGE_IN, OF_OIL]) / out, MOST_TURNS / (1.0 + MOST_TURNS))
    apart = abs(float(made[AT_TEMPERATURE] - taken[AT_TEMPERATURE]))
    return Figures({OIL_OUT: error_of(OIL_OUT, share / (1.0 - share) * apart, found)})


def _gas_heat_errors(of: Evaluation, cycle: CycleSolution) -> Figures:
    """Return the errors of temperatures of the gas that flows out, by what the sums misread of its heat."""
    problem, found = of.problem, of.figures
    T, misread = found.get(GAS_OUT), misread_of_gas(problem, cycle.trajectory, cycle.q)
    if T is None or misread == 0.0:
        return Figures()
    gas, p_d = problem.parts.gas, problem.lines.p_d
    lost = misread / (gas.enthalpy(p_d, T + 1.0) - gas.enthalpy(p_d, T))  # by that of a kelvin
    return Figures({name: error_of(name, lost, found) for name in (GAS_OUT, OVER_DEW) if found.get(name) is not None})


def _returned_errors(of: Evaluation, cycle: CycleSolution) -> Figures:
    """Return the errors of what returns to the suction line, by what the sums misread of it."""
    problem, found, out = of.problem, of.figures, of.streams[SUCTION_OUT]
    if not problem.parts.suction_line or not out[OF_GAS] < 0.0:
        return Figures()
    lost = misread_return(problem, cycle.trajectory, cycle.q) * problem.rate
    oil = lost * float(out[OF_OIL] / out[OF_GAS]) if problem.composition.carried else 0.0
    by_name = {"returned_gas_flow": lost, "returned_oil_flow": oil}
    return Figures({name: error_of(name, size, found) for name, size in by_name.items() if found.get(name)})


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
        drawn = abs(float(streams[i, OF_GAS] + streams[i + 1, OF_GAS]))
        own = set(names_of(about))
        if drawn:
            errors = flow_errors(found, by_port / drawn, "by_port")
            yield Figures({each: size for each, size in errors.items() if each in own})
        if flow:
            yield flow_errors(found, across * rate / abs(flow))
