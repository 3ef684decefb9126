"""The gas in the ledger: its exergy rise, and what flow paths, lines and walls destroy (M50–M57, M163, M187).

And the gas dissolved in oil, where that is a state of the chambers: its exergy rise, its mixing, what a line takes of
it (M233, M234).

In a suction line that keeps backflow (M273, M274), the backflow first mixes to its mean state, by path; then it mixes
with leaks that bypass the chambers and with fresh gas: the entry `suction_line`. Throttling of the leak is the leak's
own entry.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import log
from typing import NamedTuple

from screwsim.cycle.cycle_figures import chamber_end_pressure
from screwsim.cycle.suction_line import Stream
from screwsim.effects.base import DISCHARGE, SUCTION, LineLeak, OilSolution, Pulsation, SuctionChange, SuctionHeat
from screwsim.evaluate.ledger.book import DISCHARGE_LINE, SUCTION_LINE, FlowEnd, LedgerCycle, Rows, State, exergy_over
from screwsim.fluid.reservoir import Reservoir
from screwsim.model import ledger as kernels
from screwsim.model import slots
from screwsim.model.slots import DISCHARGE_IN, DISCHARGE_OUT, DISSOLVED, OF_HELD, OF_OIL, PORT_OIL, R_DISCHARGE
from screwsim.model.trajectory import Array


def enter_paths(cycle: LedgerCycle, paths: Rows, ends: Sequence[FlowEnd], suction: State) -> None:
    """Enter every flow path: the entropy its gas generates where it arrives, in a chamber or at its end (M50–M52)."""
    for name, end, row in zip(cycle.paths, ends, paths, strict=True):
        target = end.state
        left = target.generated(row[kernels.OUT_MASS], row[kernels.OUT_ENTHALPY], row[kernels.OUT_ENTROPY])
        moved = row[kernels.MOVED]
        energy = row[kernels.CARRIES] - moved * suction.h
        cycle.add(name, gas=moved, energy=energy, entropy=row[kernels.GENERATED] + left)
        if not end.kept and row[kernels.OUT_MASS] > 0.0:
            # the line stays at T_s: enthalpy above that leaves as heat at T_s (M54)
            heat = row[kernels.OUT_ENTHALPY] - row[kernels.OUT_MASS] * target.h
            cycle.add(end.entry, energy=heat, exergy=heat * (1.0 - cycle.T_0 / target.T))


def gas_rise(cycle: LedgerCycle, suction: State, line: State, discharge: State) -> float:
    """Return the exergy rise of the gas [W] (M55); enter what holds the discharge line at a given state (M54)."""
    exergy = partial(exergy_over, at=suction, T_0=cycle.T_0)
    back, out = (
        float(cycle.streams[row, slots.OF_GAS]) * cycle.rate for row in (slots.DISCHARGE_IN, slots.DISCHARGE_OUT)
    )
    if cycle.line_given:
        heat = back * (discharge.h - line.h)
        cycle.add(DISCHARGE_LINE, energy=heat, exergy=back * (exergy(discharge) - exergy(line)))
    return -(out + back) * exergy(discharge) - cycle.from_plenums(exergy)


class Throttled(NamedTuple):
    """The states before and after the throttling in a line's plenum, and that of the line, the source of inflow."""

    before: State
    after: State
    line: State


def enter_pulsations(cycle: LedgerCycle, of_lines: Mapping[str, Throttled]) -> None:
    """Enter what pulsating lines cost (M187): throttling, and the pulsation work that entering gas takes up."""
    for name, part in cycle.parts.all(Pulsation):
        row = 2 * cycle.parts.number(part.to)
        before, after, line = of_lines[part.to]
        sums = cycle.rate * cycle.streams[row : row + 2]
        pulsation = float(sums[0, slots.OF_ENERGY] - sums[0, slots.OF_GAS] * line.h)
        passed = abs(float(sums[:, slots.OF_GAS].sum()))
        throttled = passed * (after.s - before.s)
        cycle.add(name, gas=passed, energy=-pulsation, exergy=cycle.T_0 * throttled - pulsation)


def enter_intake(cycle: LedgerCycle, of_gas: float, discharge: State) -> float:
    """Return the exergy rise of the delivered gas from the line's state [W]; enter bypass and throttles (M163)."""
    intake, T_s = cycle.suction, cycle.lines.T_s
    h_d = cycle.of.h_d
    flow, exergy = cycle.of.fresh_gas * cycle.rate, cycle.exergy
    line, mixed, port = (
        exergy(cycle.state(intake.temperature(port_state, T_s), port_state[slots.DENSITY], port_state[slots.ENTHALPY]))
        for port_state in (intake.line, intake.mixed(h_d), intake.port_state(h_d))
    )
    share, out = intake.returned, exergy(discharge)
    returned = flow * (share * out + (1.0 - share) * line - mixed)
    throttled = flow * (mixed - port)
    for name, part in cycle.parts.all(SuctionChange):
        if part.returned > 0.0:
            energy = share * flow * (discharge.h - intake.line[slots.ENTHALPY])
            cycle.add(name, gas=share * flow, energy=energy, exergy=returned)
        if intake.ratio_of(part) < 1.0:  # each of several throttles has its share of the drop
            share_of = log(intake.ratio_of(part)) / log(intake.pressure_ratio)
            cycle.add(name, gas=flow, exergy=share_of * throttled)
    return of_gas - returned - throttled


def enter_walls(cycle: LedgerCycle, heats: Array) -> None:
    """Enter the heat between walls and gas, and the exergy that leaves the walls at their temperature (M171)."""
    c = cycle.composition
    for (name, wall), (heat, generated) in zip(cycle.parts.walls, heats.tolist(), strict=True):
        held = wall.temperature
        T = float(c.P[c.made[list(cycle.parts.made).index(held)]]) if isinstance(held, str) else held
        cycle.add(name, energy=heat, exergy=cycle.T_0 * generated - heat * (1.0 - cycle.T_0 / T))


@dataclass(frozen=True)
class Streams:
    """The streams in the suction line, as rates: fresh gas [kg/s], backflow from the chambers, a leak, what is sucked.

    Oil temperatures [K] are those at the intake pressure.
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
        """Oil [kg/s] that leaves through the line, where more flows back than is sucked."""
        return self.back.oil + self.leak.oil - self.sucked.oil


def line_streams(cycle: LedgerCycle, paths: Rows) -> Streams:
    """Return the streams in the suction line; the backflow is that of the ledger's own sums."""
    problem, R, rate = cycle.problem, cycle.R, cycle.rate
    rows = [row for row, end in zip(paths, cycle.composition.ends, strict=True) if end == SUCTION]
    columns = (kernels.OUT_MASS, kernels.OUT_ENTHALPY, kernels.OUT_OIL, kernels.OUT_OIL_T, kernels.OUT_HELD)
    back = Stream(*(sum(row[column] for row in rows) for column in columns))
    leak = cycle.of.leak.times(rate)
    sucked = Stream(*cycle.streams[slots.SUCTION_IN].tolist()).times(rate)
    pressed = problem.oil_pressure_term(problem.suction.pressure)
    T_back = back.oil_heat / back.oil if back.oil > 0.0 else 0.0
    T_leak = float(R[slots.R_DISCHARGE + slots.OIL_TEMPERATURE]) - pressed
    T_sucked = float(R[slots.R_SUCTION + slots.OIL_TEMPERATURE]) - pressed
    return Streams(rate * cycle.of.fresh_gas, back, leak, sucked, T_back, T_leak, T_sucked)


def mean_back(cycle: LedgerCycle, met: Streams, sucked: State) -> State:
    """Return the mean state of the gas that flows back, at the pressure where it arrives; without backflow `sucked`."""
    if not met.back.gas > 0.0:
        return sucked
    p = chamber_end_pressure(cycle.problem, cycle.life, SUCTION) or cycle.suction.pressure
    return cycle.at(p, met.back.enthalpy / met.back.gas)


def enter_line(
    cycle: LedgerCycle, of_gas: float, met: Streams, states: tuple[State, State, State], discharge: State
) -> float:
    """Enter mixing and leak of the gas; return the exergy rise [W] of the fresh gas that is delivered.

    `states`: the sucked gas at the pressure before the port, the same at the chambers' end, and the backflow.
    """
    (before, sucked, back), exergy = states, cycle.exergy
    h_d = cycle.of.h_d
    p = cycle.suction.pressure
    fresh, leaked = cycle.at(p, cycle.suction.port_state(h_d)[slots.ENTHALPY]), cycle.at(p, h_d)
    warmed = _warmed_fresh_gas(cycle, met, fresh)
    of_fresh = met.fresh * (exergy(fresh) - exergy(before))
    of_leak = met.leak.gas * (exergy(leaked) - exergy(before))
    throttled = met.leak.gas * (exergy(discharge) - exergy(leaked))
    mixed = met.fresh * (exergy(warmed) - exergy(before)) + of_leak + met.back.gas * (exergy(back) - exergy(sucked))
    cycle.add(SUCTION_LINE, gas=met.back.gas + met.leak.gas, energy=met.fresh * (before.h - warmed.h), exergy=mixed)
    for name, _ in cycle.parts.all(LineLeak):
        cycle.add(name, gas=met.leak.gas, energy=met.leak.gas * (h_d - fresh.h), exergy=throttled)
    return of_gas - of_fresh - of_leak - throttled


def _warmed_fresh_gas(cycle: LedgerCycle, met: Streams, fresh: State) -> State:
    """Return the fresh gas as warmed on its way; enter the exergy this adds, which is not from the shaft."""
    found = fresh
    for name, part in cycle.parts.all(SuctionHeat):
        if met.fresh > 0.0:
            heat = part.power(cycle.powers.shaft, cycle.parts.omega)
            after = cycle.at(cycle.suction.pressure, found.h + heat / met.fresh)
            rise = after.h - found.h - cycle.T_0 * (after.s - found.s)
            cycle.add(name, energy=heat, exergy=-met.fresh * rise)
            found = after
    return found


class DissolvedGas:
    """The gas dissolved in oil: entropy and exergy (M233, M234) over gas at the state (h, s) of the suction line."""

    def __init__(self, cycle: LedgerCycle, suction: State) -> None:
        self.cycle, self.suction = cycle, suction
        assert isinstance(cycle.parts.oil_content, OilSolution)  # `Parts.dissolves`
        self.content = cycle.parts.oil_content

    def entropies(self, w: float) -> tuple[float, float]:
        """Return the entropy of the dissolved gas [J/(kg K)] in oil that holds w, and the total per kilogram of oil."""
        c = self.cycle.composition
        s, total = self.cycle.life.module.solution_entropy(w, c.P, c.TAB)
        return float(s), float(total)

    def exergy(self, held: float, entropy: float) -> float:
        """Return the exergy [W] of dissolved gas [kg/s] with an entropy [W/K]."""
        h, s, T_0 = self.suction.h, self.suction.s, self.cycle.T_0
        return held * (self.content.enthalpy - h) - T_0 * (entropy - held * s)

    def of_oil(self, oil: float, w: float) -> float:
        """Return the exergy [W] of the gas dissolved in oil [kg/s], w per kilogram of oil."""
        return self.exergy(oil * w, oil * self.entropies(w)[1])

    def of_stream(self, stream: Stream) -> float:
        """Return the exergy [W] of the gas dissolved in the oil of a stream, uniform in all its oil."""
        return self.of_oil(stream.oil, stream.held / stream.oil) if stream.oil > 0.0 else 0.0

    def mix(self, paths: list[tuple[str, list[float]]], stream: Stream) -> None:
        """Enter the mixing of oil from several paths to the mean content of the whole stream (M233)."""
        w = stream.held / stream.oil if stream.oil > 0.0 else 0.0
        s, total = self.entropies(w)
        for name, row in paths:
            oil, gas, entropy = (row[i] for i in (kernels.OUT_OIL, kernels.OUT_HELD, kernels.OUT_HELD_ENTROPY))
            if oil > 0.0:
                self.cycle.add(name, entropy=oil * total + s * (gas - oil * w) - entropy)

    def of_gas(self, gas: float, state: Reservoir) -> float:
        """Return the exergy [W] of gas [kg/s] of a state."""
        return gas * exergy_over(state, self.suction, self.cycle.T_0)

    def at_lines(self, ends: Mapping[FlowEnd, list[tuple[str, list[float]]]]) -> None:
        """Enter the mixing of the oil that leaves to the discharge line, by path, and what other ends take (M234).

        `ends` holds the paths that lead to each end, with their sums.
        """
        out, held = self.flow_out()
        leaving = [each for end, some in ends.items() if end.name == DISCHARGE for each in some]
        self.mix(leaving, Stream(oil=out, held=held))
        for end, paths in ends.items():
            for _, row in paths if not end.kept else ():
                if row[kernels.OUT_OIL] > 0.0:
                    self.cycle.add(end.entry, exergy=self.exergy(row[kernels.OUT_HELD], row[kernels.OUT_HELD_ENTROPY]))

    def flow_out(self) -> tuple[float, float]:
        """Return the oil [kg/s] that leaves to the discharge line, and the gas [kg/s] dissolved in it."""
        out = self.cycle.streams[DISCHARGE_OUT]
        return -self.cycle.rate * float(out[OF_OIL]), -self.cycle.rate * float(out[OF_HELD])

    def rise(self) -> float:
        """Return the exergy [W] of what leaves to the discharge line, less that of what comes with the oil."""
        cycle = self.cycle
        out, held = self.flow_out()
        back, supplied = (cycle.rate * float(cycle.streams[row, OF_OIL]) for row in (DISCHARGE_IN, PORT_OIL))
        w_line = float(cycle.R[R_DISCHARGE + DISSOLVED])
        found = self.of_oil(out, held / out) if out > 0.0 else 0.0
        return found - self.of_oil(back, w_line) - self.of_oil(supplied, self.content.supply)
