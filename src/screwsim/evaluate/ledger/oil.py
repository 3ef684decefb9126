"""The oil in the ledger: its exergy rise, injection and supply, the heat of its droplets, the gas dissolved in it.

With effects.separator gas and oil mix there, and the oil returns through its cooler (M286). Without it the ledger ends
where gas and oil leave the chambers, unmixed, and the oil's supply is given.
"""

from collections.abc import Sequence
from functools import partial
from math import log
from typing import NamedTuple

import numpy as np

from screwsim.cycle.powers import kept_in_oil
from screwsim.effects.base import DISCHARGE, SUCTION, LineLeak, OilGas, OilSolution, Pulsation, Separator
from screwsim.evaluate.evaluation import Evaluation
from screwsim.evaluate.ledger.book import (
    NOT_CONSERVED,
    OIL_INJECTION,
    OIL_SUPPLY,
    SUCTION_LINE,
    FlowEnd,
    LedgerCycle,
    Rows,
    State,
    exergy_over,
)
from screwsim.evaluate.ledger.gas import DissolvedGas, Streams
from screwsim.evaluate.separator import Circuit
from screwsim.model import ledger as kernels
from screwsim.model import slots
from screwsim.model.trajectory import Array
from screwsim.model.turn_scheduler import reach_station

COOLER = "oil_cooler"


def cool_at_lines(cycle: LedgerCycle, paths: Rows) -> None:
    """Set oil that takes room to its temperature after throttling to its line [in place] (M109)."""
    if not cycle.parts.oil_room:
        return
    for row, end in zip(paths, cycle.composition.ends, strict=True):
        row[kernels.OUT_OIL_T] -= row[kernels.OUT_OIL] * cycle.problem.oil_pressure_term(cycle.pressure(end))


class OilSums(NamedTuple):
    """Sums over a life, as rates: by flow path, with the end of each, and those of the oil (`model.ledger`).

    `met` are the streams in a suction line that keeps backflow.
    """

    paths: Rows
    ends: Sequence[FlowEnd]
    oil: Array
    met: Streams | None


def oil_rise(cycle: LedgerCycle, sums: OilSums, heats: Array, suction: State) -> float:
    """Return the exergy rise of the oil [W] (M56); enter its heat, injection, supply and what is not conserved."""
    c, known = cycle.composition, cycle.known
    for name, row in zip(c.heats, heats, strict=True):
        cycle.add(name, energy=float(row[kernels.HEAT]), entropy=float(row[kernels.HEAT_GENERATED]))
    kept = kept_in_oil(cycle.parts, known)
    cycle.add(OIL_SUPPLY, energy=cycle.powers.lift, exergy=known.oil_volume_flow * _throttled(cycle) + kept)
    for name, part in cycle.parts.all(Pulsation):
        if part.to == DISCHARGE and not cycle.parts.oil_room:  # loss of the oil on its way to the line (M187)
            through = known.oil_volume_flow + known.leaked_oil_flow
            cycle.add(name, exergy=through * (known.plenum_pressure - cycle.lines.p_d))
    if c.ported:
        cycle.add(OIL_INJECTION, entropy=float(sums.oil[kernels.PORT_GENERATED]))
    reach_station()
    dissolved = _flash(cycle, sums, suction)
    mechanical = known.oil_volume_flow * (cycle.lines.p_d - known.oil_source_pressure)
    if c.carried:
        return dissolved + mechanical + _carried(cycle, sums)
    if c.heats:
        return mechanical + _not_carried(cycle, sums)
    return mechanical


def _flash(cycle: LedgerCycle, sums: OilSums, suction: State) -> float:
    """Enter the gas that flashes out of the oil; return the exergy [W] by which dissolved gas falls short of it (M197).

    Where gas is released over time, return what `_released` does.
    """
    content, flashed = cycle.parts.oil_content, float(sums.oil[kernels.FLASH_MASS])
    if content is None:
        return 0.0
    if isinstance(content, OilSolution):
        return _released(cycle, sums, suction)
    for name, _ in cycle.parts.all(OilGas):
        generated = float(sums.oil[kernels.FLASH_GENERATED])
        cycle.add(name, gas=flashed, energy=flashed * content.latent, entropy=generated)
    return flashed * content.latent * (1.0 - cycle.T_0 / cycle.oil.temperature)


def _released(cycle: LedgerCycle, sums: OilSums, suction: State) -> float:
    """Enter gas that oil gives off over time; return the exergy rise [W] of the dissolved and of that gas (M234)."""
    held, coming, met = DissolvedGas(cycle, suction), {end: [] for end in sums.ends}, sums.met
    for name, end, row in zip(cycle.paths, sums.ends, sums.paths, strict=True):
        coming[end].append((name, row))
    held.at_lines(coming)
    gas, energy = float(sums.oil[kernels.FLASH_MASS]), float(sums.oil[kernels.RELEASED])
    rise = held.rise()
    if met is not None:
        of_suction = [each for end, some in coming.items() if end.name == SUCTION for each in some]
        held.mix(of_suction, met.back)
        leaked = held.of_stream(met.leak)
        cycle.add(SUCTION_LINE, exergy=held.of_stream(met.back) + leaked - held.of_stream(met.sucked))
        rise -= leaked
    for name, part in cycle.parts.all(OilGas):
        cycle.add(name, gas=gas, energy=energy, entropy=float(sums.oil[kernels.FLASH_GENERATED]))
        i = 2 * cycle.parts.number(part.plenum)
        net = float(cycle.streams[i : i + 2, slots.OF_GAS].sum()) * cycle.rate
        rise += held.of_gas(net, cycle.parts.plenums[part.plenum])
    return rise


def _throttled(cycle: LedgerCycle) -> float:
    """Return the pressure [Pa] that the oil loses between source and chamber, dissipated at T_0 (M58).

    Where the oil takes room, its loss in the chamber heats it instead; what remains is the loss of the line, and
    what lifts oil from a source below the chamber's pressure.
    """
    known, port = cycle.known, cycle.parts.oil_port
    if not cycle.parts.oil_room:
        return known.oil_source_pressure - known.injection_pressure
    if port is None or cycle.parts.pumped:
        return known.oil_source_pressure - known.delivery_pressure
    return port.loss(known.oil_source_pressure)


def _thermal(cycle: LedgerCycle, mass: float, mass_T: float, mass_log: float) -> float:
    """Return the exergy [W] of oil relative to injected oil at equal pressure, from Σ ṁ, Σ ṁ T, Σ ṁ ln T (M56)."""
    oil = cycle.oil
    T = oil.temperature
    return oil.heat_capacity * ((mass_T - mass * T) - cycle.T_0 * (mass_log - mass * log(T)))


def _mixed(mass: float, mass_T: float) -> tuple[float, float, float]:
    """Return Σ ṁ, Σ ṁ T, Σ ṁ ln T of oil mixed to one temperature."""
    return mass, mass_T, mass * log(mass_T / mass) if mass > 0.0 else 0.0


def _mixing(cycle: LedgerCycle, paths: Rows, T_mean: float, line: str = DISCHARGE) -> None:
    """Enter the mixing of the oil that leaves to a line, to its mean temperature there (M53)."""
    c_oil = cycle.oil.heat_capacity
    for name, end, row in zip(cycle.paths, cycle.composition.ends, paths, strict=True):
        mass, mass_T, mass_log = row[kernels.OUT_OIL], row[kernels.OUT_OIL_T], row[kernels.OUT_OIL_LOG]
        if mass > 0.0 and end == line:
            cycle.add(name, entropy=c_oil * ((mass_T / T_mean - mass) - (mass_log - mass * log(T_mean))))


def _carried(cycle: LedgerCycle, sums: OilSums) -> float:
    """Return the thermal exergy rise of carried oil [W]; enter its injection and what the suction line takes."""
    oil, (paths, ends, _, met) = cycle.oil, sums
    out, out_T = (-float(cycle.streams[slots.DISCHARGE_OUT, i]) * cycle.rate for i in (slots.OF_OIL, slots.OF_OIL_HEAT))
    pressed = cycle.problem.oil_pressure_term(cycle.lines.p_d)
    out_T -= out * pressed
    back = float(cycle.streams[slots.DISCHARGE_IN, slots.OF_OIL]) * cycle.rate
    if out > 0.0:
        _mixing(cycle, paths, out_T / out)
    lost = 0.0
    columns = slice(kernels.OUT_OIL, kernels.OUT_OIL_LOG + 1)
    for end in dict.fromkeys(end for end in ends if not end.kept):
        rows = [row[columns] for row, other in zip(paths, ends, strict=True) if other is end]
        taken = [sum(column) for column in zip(*rows, strict=True)]
        returns = end.name == SUCTION and cycle.parts.geometry.expands  # to where it came from: its flow is net (M490)
        source = cycle.lines.p_d if returns else cycle.known.oil_source_pressure
        lost += taken[0] / oil.density * (cycle.lines.p_d - source)
        if taken[0] > 0.0:
            p = cycle.pressure(end.name) if cycle.parts.oil_room and not returns else cycle.lines.p_d
            pressure = taken[0] / oil.density * (p - source)
            energy = oil.heat_capacity * (taken[1] - taken[0] * oil.temperature)
            cycle.add(end.entry, energy=energy, exergy=_thermal(cycle, taken[0], taken[1], taken[2]) + pressure)
    if not (cycle.composition.ported or cycle.parts.geometry.expands):
        cycle.add(OIL_INJECTION, entropy=cycle.rate * _injection(cycle))
    T_line = float(cycle.R[slots.R_DISCHARGE + slots.OIL_TEMPERATURE]) - pressed
    rise = _thermal(cycle, *_mixed(out, out_T)) - _thermal(cycle, *_mixed(back, back * T_line)) - lost
    return rise if met is None else rise - _line(cycle, paths, met, T_line)


def _line(cycle: LedgerCycle, paths: Rows, met: Streams, T_line: float) -> float:
    """Enter the oil's part in the suction line and its leak; return the part of its exergy rise that leaks or leaves.

    T_line [K] is the oil's temperature in the discharge line.
    """
    oil, room = cycle.oil, cycle.parts.oil_room
    p_i, p_d, source = cycle.suction.pressure, cycle.lines.p_d, cycle.known.oil_source_pressure
    if met.back.oil > 0.0:
        _mixing(cycle, paths, met.T_back, SUCTION)
    leaked, before = (_thermal(cycle, *_mixed(met.leak.oil, met.leak.oil * T)) for T in (met.T_leak, T_line))
    mixed = _thermal(cycle, *_mixed(met.back.oil, met.back.oil * met.T_back)) + leaked
    mixed -= _thermal(cycle, *_mixed(met.sucked.oil, met.sucked.oil * met.T_sucked))
    cycle.add(SUCTION_LINE, exergy=mixed + met.oil_lost / oil.density * ((p_i if room else p_d) - source))
    for name, _ in cycle.parts.all(LineLeak):
        cycle.add(name, exergy=met.leak.oil / oil.density * (p_d - p_i) + before - leaked)
    return before + met.oil_lost / oil.density * (p_d - source)


def _injection(cycle: LedgerCycle) -> float:
    """Return the entropy [J/K] generated when one injection mixes with the oil in the chamber (M53)."""
    oil, R = cycle.oil, cycle.R
    before, injected = float(R[slots.R_OIL_BEFORE]), float(R[slots.R_INJECTED])
    times, dense, steps = cycle.life.rows
    i = int(np.searchsorted(times[: steps + 1], cycle.composition.P[slots.P_INJECTION] + 1e-9)) - 1
    T_before, T_after = float(dense[i - 1, 1, slots.S_T_OIL]), float(dense[i, 0, slots.S_T_OIL])
    mixed = injected * log(T_after / oil.temperature)
    return oil.heat_capacity * (mixed + (before * log(T_after / T_before) if before > 0.0 else 0.0))


def _not_carried(cycle: LedgerCycle, sums: OilSums) -> float:
    """Return the thermal exergy rise of oil at a constant ratio [W]; enter the oil that appears and vanishes (M57)."""
    oil, R = cycle.oil, cycle.R
    out, out_T = (sum([row[column] for row in sums.paths]) for column in (kernels.OUT_OIL, kernels.OUT_OIL_T))
    T_mean = out_T / out if out > 0.0 else oil.temperature
    _mixing(cycle, sums.paths, T_mean)
    injected = cycle.known.oil_mass_flow
    times, dense, steps = cycle.life.rows
    c = cycle.composition
    volume = float(cycle.life.module.volume_at(times[steps], c.P, c.TAB))
    rest = cycle.rate * float(R[slots.R_RATIO] * dense[steps - 1, 1, slots.S_RHO]) * volume
    rise = _thermal(cycle, *_mixed(injected, injected * T_mean))
    entry = _thermal(cycle, *_mixed(rest, rest * float(dense[steps - 1, 1, slots.S_T_OIL])))
    entry -= _thermal(cycle, sums.oil[kernels.MADE], sums.oil[kernels.MADE_T], sums.oil[kernels.MADE_LOG])
    entry += _thermal(cycle, *_mixed(out, out_T)) - rise
    entry += float(sums.oil[kernels.LOST] - cycle.T_0 * sums.oil[kernels.LOST_OVER_T])
    cycle.add(NOT_CONSERVED, exergy=float(entry))
    return rise


def through_circuit(cycle: LedgerCycle, of: Evaluation, of_gas: float, of_oil: float) -> tuple[float, float]:
    """Return the exergy rises [W] of gas that has left the separator and of oil that is back; enter what lies between.

    Without a separator these are `of_gas` and `of_oil` unchanged.
    """
    circuit, names = of.circuit, [name for name, _ in cycle.parts.all(Separator)]
    if not (isinstance(circuit, Circuit) and names) or circuit.parted.why:
        return of_gas, of_oil
    outflow, parted, T_0 = circuit.outflow, circuit.parted, cycle.T_0
    line, T = cycle.suction.line, parted.T_separator
    sucked = cycle.state(cycle.suction.temperature(line, cycle.lines.T_s), line[slots.DENSITY], line[slots.ENTHALPY])
    exergy = partial(exergy_over, at=sucked, T_0=T_0)
    gas = outflow.gas
    left = cycle.state(T, gas.density(outflow.p, T), gas.enthalpy(outflow.p, T))
    flashing = "" if cycle.parts.oil_gas is None else cycle.parts.oil_gas.plenum
    of_parted = outflow.gas_flow * exergy(left) - cycle.from_plenums(exergy, flashing)
    cooled = outflow.oil_capacity * (T - outflow.T_supply - T_0 * log(T / outflow.T_supply))
    heat = outflow.heating + outflow.friction - parted.lost_friction - parted.ambient_loss
    cycle.add(names[0], gas=outflow.gas_flow, energy=heat, exergy=of_gas + of_oil - of_parted - cooled)
    cycle.add(COOLER, energy=outflow.oil_capacity * (T - outflow.T_supply), exergy=cooled)
    return of_parted, 0.0
