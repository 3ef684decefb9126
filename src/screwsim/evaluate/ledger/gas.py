"""The gas in the ledger: its exergy rise; what flow paths, lines and walls destroy (M50–M57, M163, M187)."""

from collections.abc import Mapping, Sequence
from math import log
from typing import NamedTuple

from screwsim.cycle import suction_line
from screwsim.effects.base import Pulsation, SuctionChange
from screwsim.evaluate.ledger.book import DISCHARGE_LINE, Book, Cycle, End, Rows, State
from screwsim.model import ledger as kernels
from screwsim.model.slots import DENSITY, DISCHARGE_IN, DISCHARGE_OUT, ENTHALPY, OF_ENERGY, OF_GAS, R_DISCHARGE
from screwsim.model.trajectory import Array


def enter_paths(book: Book, cycle: Cycle, paths: Rows, ends: Sequence[End], suction: State) -> None:
    """Enter every flow path: what its gas generates where it arrives, in a chamber or at its end (M50–M52)."""
    for name, end, row in zip(cycle.paths, ends, paths, strict=True):
        target = end.state
        left = target.generated(row[kernels.OUT_MASS], row[kernels.OUT_ENTHALPY], row[kernels.OUT_ENTROPY])
        moved = row[kernels.MOVED]
        energy = row[kernels.CARRIES] - moved * suction.h
        book.add(name, gas=moved, energy=energy, entropy=row[kernels.GENERATED] + left)
        if not end.kept and row[kernels.OUT_MASS] > 0.0:
            # the line stays at T_s: what the gas brings above that leaves as heat at T_s (M54)
            heat = row[kernels.OUT_ENTHALPY] - row[kernels.OUT_MASS] * target.h
            book.add(end.entry, energy=heat, exergy=heat * (1.0 - cycle.T_0 / target.T))


def gas_rise(book: Book, cycle: Cycle, suction: State, line: State, discharge: State) -> float:
    """Return the exergy rise of the gas [W] (M55), and enter what keeps the discharge line at a given state (M54)."""

    def exergy(state: State) -> float:
        return state.h - suction.h - cycle.T_0 * (state.s - suction.s)

    back, out = (float(cycle.streams[row, OF_GAS]) * cycle.rate for row in (DISCHARGE_IN, DISCHARGE_OUT))
    if cycle.line_given:
        heat = back * (discharge.h - line.h)
        book.add(DISCHARGE_LINE, energy=heat, exergy=back * (exergy(discharge) - exergy(line)))
    return -(out + back) * exergy(discharge) - sum(
        net * exergy(State(own.T, own.rho, own.h, own.s)) for net, own in cycle.drawn()
    )


class Throttled(NamedTuple):
    """The states before and after a line's plenum, and that of the line, from which gas comes into the chambers."""

    before: State
    after: State
    line: State


def enter_pulsations(book: Book, cycle: Cycle, of_lines: Mapping[str, Throttled]) -> None:
    """Enter what lines that pulsate cost (M187): throttling, and what gas that comes in takes of the pulsation."""
    for name, part in cycle.parts.all(Pulsation):
        row = 2 * cycle.parts.number(part.to)
        before, after, line = of_lines[part.to]
        sums = cycle.rate * cycle.streams[row : row + 2]
        pulsation = float(sums[0, OF_ENERGY] - sums[0, OF_GAS] * line.h)
        passed = abs(float(sums[:, OF_GAS].sum()))
        throttled = passed * (after.s - before.s)
        book.add(name, gas=passed, energy=-pulsation, exergy=cycle.T_0 * throttled - pulsation)


def enter_intake(book: Book, cycle: Cycle, of_gas: float, discharge: State) -> float:
    """Return the exergy rise of the delivered gas from the line's state [W]; enter bypass and throttle (M163)."""
    intake, T_s = cycle.suction, cycle.lines.T_s
    h_d = float(cycle.R[R_DISCHARGE + ENTHALPY])
    flow = suction_line.fresh(cycle.problem, cycle.R, cycle.streams) * cycle.rate

    def exergy(state: State) -> float:
        return state.h - cycle.T_0 * state.s

    line, mixed, port = (
        exergy(cycle.state(intake.temperature(port_state, T_s), port_state[DENSITY], port_state[ENTHALPY]))
        for port_state in (intake.line, intake.mixed(h_d), intake.port_state(h_d))
    )
    share, out = intake.returned, exergy(discharge)
    returned = flow * (share * out + (1.0 - share) * line - mixed)
    throttled = flow * (mixed - port)
    for name, part in cycle.parts.all(SuctionChange):
        if part.returned > 0.0:
            energy = share * flow * (discharge.h - intake.line[ENTHALPY])
            book.add(name, gas=share * flow, energy=energy, exergy=returned)
        if intake.ratio_of(part) < 1.0:  # of several throttles each has its share of the drop
            share_of = log(intake.ratio_of(part)) / log(intake.pressure_ratio)
            book.add(name, gas=flow, exergy=share_of * throttled)
    return of_gas - returned - throttled


def enter_walls(book: Book, cycle: Cycle, heats: Array) -> None:
    """Enter the heat between walls and gas, and what leaves the walls at their temperature (M171)."""
    c = cycle.composition
    for (name, wall), (heat, generated) in zip(cycle.parts.walls, heats.tolist(), strict=True):
        held = wall.temperature
        T = float(c.P[c.made[list(cycle.parts.made).index(held)]]) if isinstance(held, str) else held
        book.add(name, energy=heat, exergy=cycle.T_0 * generated - heat * (1.0 - cycle.T_0 / T))
