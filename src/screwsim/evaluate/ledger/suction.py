"""The suction line in the ledger, where what flows back stays in it, and leaks beside the chambers (M273, M274).

What flows back mixes to its mean state, by path; that, what leaks beside the chambers and fresh gas mix to what is
sucked in: the entry `suction_line`. Throttling of the leak is the leak's own entry.
"""

from dataclasses import dataclass

from screwsim.cycle import suction_line
from screwsim.cycle.suction_line import Stream
from screwsim.effects.base import SUCTION, LineLeak, SuctionHeat
from screwsim.evaluate.ledger.book import SUCTION_LINE, Book, Cycle, Rows, State
from screwsim.model import ledger as kernels
from screwsim.model.slots import ENTHALPY, OIL_TEMPERATURE, R_DISCHARGE, R_SUCTION, SUCTION_IN


@dataclass(frozen=True)
class Streams:
    """What meets in the suction line, in rates: fresh gas [kg/s], what comes from the chambers, a leak, what is sucked.

    Oil temperatures [K] are those at the pressure of the intake.
    """

    fresh: float
    back: Stream
    leak: Stream
    sucked: Stream
    T_back: float
    T_leak: float
    T_sucked: float

    @property
    def oil_lost(self) -> float:
        """Oil [kg/s] that leaves by the line: where more flows back than is sucked."""
        return self.back.oil + self.leak.oil - self.sucked.oil


def line_streams(cycle: Cycle, paths: Rows) -> Streams:
    """Return what meets in the suction line; what comes back is that of the ledger's own sums."""
    problem, R, rate = cycle.problem, cycle.R, cycle.rate
    rows = [row for row, end in zip(paths, cycle.composition.ends, strict=True) if end == SUCTION]
    columns = (kernels.OUT_MASS, kernels.OUT_ENTHALPY, kernels.OUT_OIL, kernels.OUT_OIL_T, kernels.OUT_HELD)
    back = Stream(*(sum(row[column] for row in rows) for column in columns))
    leak = suction_line.leak(problem, R).times(rate)
    sucked = Stream(*cycle.streams[SUCTION_IN].tolist()).times(rate)
    pressed = problem.pressed(problem.suction.pressure)
    T_back = back.oil_heat / back.oil if back.oil > 0.0 else 0.0
    T_leak = float(R[R_DISCHARGE + OIL_TEMPERATURE]) - pressed
    T_sucked = float(R[R_SUCTION + OIL_TEMPERATURE]) - pressed
    fresh = rate * suction_line.fresh(problem, R, cycle.streams)
    return Streams(fresh, back, leak, sucked, T_back, T_leak, T_sucked)


def mean_back(cycle: Cycle, met: Streams, sucked: State) -> State:
    """Return the mean state of the gas that flows back, at the pressure that it comes to; else that which is sucked."""
    if not met.back.gas > 0.0:
        return sucked
    return cycle.at(cycle.pressure_behind(SUCTION) or cycle.suction.pressure, met.back.enthalpy / met.back.gas)


def enter_line(
    book: Book, cycle: Cycle, of_gas: float, met: Streams, states: tuple[State, State, State], discharge: State
) -> float:
    """Enter mixing and leak of the gas; return the exergy rise [W] of the fresh gas that is delivered.

    `states`: what is sucked in at the pressure before the port, the same as chambers meet it, and what flows back.
    """
    before, sucked, back = states

    def exergy(state: State) -> float:
        return state.h - cycle.T_0 * state.s

    h_d = float(cycle.R[R_DISCHARGE + ENTHALPY])
    p = cycle.suction.pressure
    fresh, leaked = cycle.at(p, cycle.suction.port_state(h_d)[ENTHALPY]), cycle.at(p, h_d)
    warmed = _warmed(book, cycle, met, fresh)
    of_fresh = met.fresh * (exergy(fresh) - exergy(before))
    of_leak = met.leak.gas * (exergy(leaked) - exergy(before))
    throttled = met.leak.gas * (exergy(discharge) - exergy(leaked))
    mixed = met.fresh * (exergy(warmed) - exergy(before)) + of_leak + met.back.gas * (exergy(back) - exergy(sucked))
    book.add(SUCTION_LINE, gas=met.back.gas + met.leak.gas, energy=met.fresh * (before.h - warmed.h), exergy=mixed)
    for name, _ in cycle.parts.all(LineLeak):
        book.add(name, gas=met.leak.gas, energy=met.leak.gas * (h_d - fresh.h), exergy=throttled)
    return of_gas - of_fresh - of_leak - throttled


def _warmed(book: Book, cycle: Cycle, met: Streams, fresh: State) -> State:
    """Return the fresh gas with the heat that it takes up on its way; enter what that brings, which no shaft gives."""
    found = fresh
    for name, part in cycle.parts.all(SuctionHeat):
        if met.fresh > 0.0:
            heat = part.power(cycle.shaft_power, cycle.parts.omega)
            after = cycle.at(cycle.suction.pressure, found.h + heat / met.fresh)
            rise = after.h - found.h - cycle.T_0 * (after.s - found.s)
            book.add(name, energy=heat, exergy=-met.fresh * rise)
            found = after
    return found
