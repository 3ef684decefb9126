"""The ledger: where the shaft power goes, as exergy destroyed by each effect (docs/model.md M50–M59).

Shaft power = exergy rise of the gas + exergy rise of the oil + T_0 Σ entropy generated + residue. Every effect of the
scene has an entry, and so has what the model itself destroys or gives: the oil's supply, its injection, the lines.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from math import log
from typing import Any

import numpy as np

from screwsim.dissolved import Held
from screwsim.effects.base import Intake, OilGas, PowerLoss, Pulsation, Reading
from screwsim.fluid.reservoir import Reservoir
from screwsim.intake import Suction
from screwsim.model import ledger as kernels
from screwsim.model.close import Array, discharge_enthalpy
from screwsim.model.parts import OilPart
from screwsim.model.run import Machinery
from screwsim.model.slots import (
    DENSITY,
    ENTHALPY,
    FIRST_OWN,
    OIL_TEMPERATURE,
    P_INJECTION,
    PLACE,
    PRESSURE,
    R_DISCHARGE,
    R_INJECTED,
    R_OIL_BEFORE,
    R_RATIO,
    R_SUCTION,
)
from screwsim.outputs import Figures
from screwsim.performance import CycleFigures, Lines, oil_lift

OIL_INJECTION, OIL_SUPPLY = "oil_injection", "oil_supply"
SUCTION_LINE, DISCHARGE_LINE, NOT_CONSERVED = "suction_line", "discharge_line", "oil_not_conserved"


@dataclass(frozen=True)
class State:
    """A state of the gas, relative to nothing: T [K], ρ [kg/m³], h [J/kg], s [J/(kg K)]."""

    T: float
    rho: float
    h: float
    s: float

    def generated(self, mass: float, enthalpy: float, entropy: float) -> float:
        """Return the entropy [J/K] generated where gas with these sums comes to this state, at its pressure (M52)."""
        return (enthalpy - mass * self.h) / self.T - (entropy - mass * self.s)


@dataclass
class Entry:
    """One line of the ledger [SI]: gas moved, energy moved, entropy generated and the shaft power that it costs."""

    gas_moved: float | None = None
    energy_moved: float | None = None
    entropy_generated: float = 0.0
    exergy_destroyed: float = 0.0


@dataclass
class _Book:
    """The entries while they are written, in rates; T_0 [K]."""

    T_0: float
    entries: dict[str, Entry] = field(default_factory=dict)

    def add(
        self,
        name: str,
        *,
        entropy: float | None = None,
        exergy: float | None = None,
        gas: float | None = None,
        energy: float | None = None,
    ) -> None:
        """Add to an entry: entropy generated [W/K], or exergy destroyed [W], which stands for entropy at T_0."""
        entry = self.entries.setdefault(name, Entry())
        if gas is not None:
            entry.gas_moved = (entry.gas_moved or 0.0) + gas
        if energy is not None:
            entry.energy_moved = (entry.energy_moved or 0.0) + energy
        destroyed = exergy if exergy is not None else self.T_0 * (entropy or 0.0)
        entry.exergy_destroyed += destroyed
        entry.entropy_generated += destroyed / self.T_0


@dataclass(frozen=True)
class Cycle:
    """What the ledger asks of a closed cycle.

    `streams` are the sums over one chamber's life (model.close.Balances.streams); `line_given` tells that the state of
    the discharge line is not that of the outflow.
    """

    parts: Any
    lines: Lines
    machinery: Machinery
    streams: Array
    known: CycleFigures
    shaft_power: float
    T_0: float
    line_given: bool
    intake: Suction

    def pressed(self, p: float) -> float:
        """Return p/(ρ_oil c_oil) [K] where the oil takes room, else 0 (M108)."""
        oil = self.parts.oil
        return p / (oil.density * oil.heat_capacity) if oil is not None and self.parts.oil_room else 0.0

    @property
    def rate(self) -> float:
        """Return chamber lives per second."""
        return self.parts.omega / self.parts.geometry.pitch

    def state(self, T: float, rho: float, h: float) -> State:
        """Return a state of the gas with its entropy."""
        c = self.machinery.composition
        return State(T, rho, h, float(self.machinery.module.gas_entropy(T, rho, c.P, c.TAB)))

    def behind(self, to: str, line: State) -> State:
        """Return the mean state that the chambers meet in a line: throttled where its pressure has an offset (M184)."""
        for part in self.parts.pulsations:
            if part.to == to:
                c, gas = self.machinery.composition, self.parts.gas
                p = float(self.machinery.R[self.parts.number(to) * PLACE + PRESSURE])
                p *= 1.0 + float(c.P[c.made[list(self.parts.made).index(part.offset)]])
                return self.state(gas.temperature(p, line.h), gas.place_of_enthalpy(p, line.h)[1], line.h)
        return line

    def at_discharge(self, h: float) -> State:
        """Return the state at discharge pressure of enthalpy h [J/kg]."""
        gas, p_d = self.parts.gas, self.lines.p_d
        return self.state(gas.temperature(p_d, h), gas.place_of_enthalpy(p_d, h)[1], h)


def ledger(cycle: Cycle) -> Figures:
    """Return the ledger of a closed cycle: its totals, and the entries as `<quantity>_<effect>` (outputs.LEDGER)."""
    R = cycle.machinery.R
    place = cycle.intake.place(float(R[R_DISCHARGE + ENTHALPY]))
    T_suction = cycle.intake.temperature(place, cycle.lines.T_s)
    suction = cycle.state(T_suction, float(R[R_SUCTION + DENSITY]), float(R[R_SUCTION + ENTHALPY]))
    line = cycle.at_discharge(float(R[R_DISCHARGE + ENTHALPY]))
    mean = discharge_enthalpy(cycle.streams)
    discharge = line if mean is None else cycle.at_discharge(mean[0])
    sucked, given = cycle.behind("suction", suction), cycle.behind("discharge", discharge)
    paths, heats, oil = (
        cycle.rate * sums for sums in cycle.machinery.account(sucked.s, cycle.behind("discharge", line).s)
    )
    _at_their_lines(cycle, paths)
    book = _Book(cycle.T_0, {name: Entry() for name in _acting(cycle)})
    _paths(book, cycle, paths, sucked, given)
    _pulsations(book, cycle, (suction, sucked), (given, discharge), line)
    gas_rise = _gas(book, cycle, suction, line, discharge)
    if cycle.intake.changed:
        gas_rise = _intake(book, cycle, gas_rise, discharge)
    warmed = len(cycle.machinery.composition.heats)
    _walls(book, cycle, heats[warmed:])
    oil_rise = None
    if cycle.parts.oil is not None:
        oil_rise = _oil(book, cycle, suction, paths, heats[:warmed], oil)
    _losses(book, cycle)
    return _figures(book, cycle, gas_rise, oil_rise)


def _acting(cycle: Cycle) -> Iterator[str]:
    """Yield the effects that do more than read the cycle."""
    for name, items in cycle.parts.effects.items():
        if not (items and all(isinstance(part, Reading) for part in items)):
            yield name


def _figures(book: _Book, cycle: Cycle, gas_rise: float, oil_rise: float | None) -> Figures:
    destroyed = sum(entry.exergy_destroyed for entry in book.entries.values())
    residue = cycle.shaft_power - gas_rise - (oil_rise or 0.0) - destroyed
    found: dict[str, Any] = {
        "ambient_temperature": cycle.T_0,
        "shaft_power": cycle.shaft_power,
        "gas_exergy_rise": gas_rise,
        "oil_exergy_rise": oil_rise,
        "exergy_destroyed": destroyed,
        "residue": residue,
        "relative_residue": residue / abs(cycle.shaft_power) if cycle.shaft_power != 0.0 else None,
    }
    for name, entry in book.entries.items():
        found |= zip(_titles(name), vars(entry).values(), strict=True)
    return Figures(found)


@cache
def _titles(name: str) -> tuple[str, ...]:
    """Return what the figures of an entry are called."""
    return tuple(f"{quantity}_{name}" for quantity in vars(Entry()))


def _names(cycle: Cycle) -> list[str]:
    c = cycle.machinery.composition
    return [*c.plenum_paths, *(name for name, _ in c.gap_paths)]


def _pressure(cycle: Cycle, end: str) -> float:
    """Return the pressure [Pa] of a line or plenum."""
    pressures = {"suction": cycle.lines.p_s, "discharge": cycle.lines.p_d}
    return pressures[end] if end in pressures else cycle.parts.plenums[end].p


def _at_their_lines(cycle: Cycle, paths: Array) -> None:
    """Let oil that takes room have the temperature to which throttling to its line brings it, in place (M109)."""
    if not cycle.parts.oil_room:
        return
    for row, end in zip(paths, cycle.machinery.composition.ends, strict=True):
        row[kernels.OUT_OIL_T] -= row[kernels.OUT_OIL] * cycle.pressed(_pressure(cycle, end))


def _paths(book: _Book, cycle: Cycle, paths: Array, suction: State, discharge: State) -> None:
    """Enter every flow path: what its gas generates where it arrives, in a chamber or in a line (M50–M52)."""
    states = {"suction": suction, "discharge": discharge} | {
        name: State(own.T, own.rho, own.h, own.s) for name, own in cycle.parts.plenums.items()
    }
    for name, end, row in zip(_names(cycle), cycle.machinery.composition.ends, paths.tolist(), strict=True):
        target = states[end]
        left = target.generated(row[kernels.OUT_MASS], row[kernels.OUT_ENTHALPY], row[kernels.OUT_ENTROPY])
        moved = row[kernels.MOVED]
        energy = row[kernels.CARRIES] - moved * suction.h
        book.add(name, gas=moved, energy=energy, entropy=row[kernels.GENERATED] + left)
        if end != "discharge" and row[kernels.OUT_MASS] > 0.0:
            # the line stays at T_s: what the gas brings above that leaves as heat at T_s (M54)
            heat = row[kernels.OUT_ENTHALPY] - row[kernels.OUT_MASS] * target.h
            entry = SUCTION_LINE if end == "suction" else f"{end}_plenum"
            book.add(entry, energy=heat, exergy=heat * (1.0 - cycle.T_0 / target.T))


def _gas(book: _Book, cycle: Cycle, suction: State, line: State, discharge: State) -> float:
    """Return the exergy rise of the gas [W] (M55), and enter what keeps the discharge line at a given state (M54)."""

    def exergy(state: State) -> float:
        return state.h - suction.h - cycle.T_0 * (state.s - suction.s)

    back, out = (float(cycle.streams[row, 0]) * cycle.rate for row in (2, 3))
    if cycle.line_given:
        heat = back * (discharge.h - line.h)
        book.add(DISCHARGE_LINE, energy=heat, exergy=back * (exergy(discharge) - exergy(line)))
    return -(out + back) * exergy(discharge) - sum(
        net * exergy(State(own.T, own.rho, own.h, own.s)) for net, own in _drawn(cycle)
    )


def _pulsations(
    book: _Book, cycle: Cycle, suction: tuple[State, State], discharge: tuple[State, State], line: State
) -> None:
    """Enter what lines that pulsate cost (M187): throttling, and what gas that comes in takes of the pulsation.

    The gas is throttled from the first to the second of two states.
    """
    for name, part in cycle.parts.all(Pulsation):
        row = 2 * cycle.parts.number(part.to)
        before, after = suction if part.to == "suction" else discharge
        sums = cycle.rate * cycle.streams[row : row + 2]
        h = before.h if part.to == "suction" else line.h
        pulsation = float(sums[0, 1] - sums[0, 0] * h)
        throttled = abs(float(sums[:, 0].sum())) * (after.s - before.s)
        book.add(name, gas=abs(float(sums[:, 0].sum())), energy=-pulsation, exergy=cycle.T_0 * throttled - pulsation)


def _drawn(cycle: Cycle) -> Iterator[tuple[float, Reservoir]]:
    """Yield the net flow [kg/s] from each own plenum, and its state."""
    for i, own in enumerate(cycle.parts.plenums.values(), FIRST_OWN):
        yield float(cycle.streams[2 * i, 0] + cycle.streams[2 * i + 1, 0]) * cycle.rate, own


def _intake(book: _Book, cycle: Cycle, gas_rise: float, discharge: State) -> float:
    """Return the exergy rise of the delivered gas from the line's state [W]; enter bypass and throttle (M163)."""
    intake, T_s = cycle.intake, cycle.lines.T_s
    h_d = float(cycle.machinery.R[R_DISCHARGE + ENTHALPY])
    drawn = list(_drawn(cycle))
    flow = -float(cycle.streams[2, 0] + cycle.streams[3, 0]) * cycle.rate - sum(net for net, _ in drawn)

    def exergy(state: State) -> float:
        return state.h - cycle.T_0 * state.s

    line, mixed = (
        exergy(cycle.state(intake.temperature(place, T_s), place[DENSITY], place[ENTHALPY]))
        for place in (intake.line, intake.mixed(h_d))
    )
    share, out = intake.returned, exergy(discharge)
    delivered = (1.0 - share) * flow * (out - line)
    delivered += sum(net * (out - exergy(State(own.T, own.rho, own.h, own.s))) for net, own in drawn)
    returned = flow * (share * out + (1.0 - share) * line - mixed)
    for name, part in cycle.parts.all(Intake):
        if part.returned > 0.0:
            energy = share * flow * (discharge.h - intake.line[ENTHALPY])
            book.add(name, gas=share * flow, energy=energy, exergy=returned)
        if part.pressure_ratio < 1.0:
            book.add(name, gas=flow, exergy=gas_rise - delivered - returned)
    return delivered


def _walls(book: _Book, cycle: Cycle, heats: Array) -> None:
    """Enter the heat between walls and gas, and what leaves the walls at their temperature (M171)."""
    c = cycle.machinery.composition
    for (name, wall), (heat, generated) in zip(cycle.parts.walls, heats.tolist(), strict=True):
        held = wall.temperature
        T = float(c.P[c.made[list(cycle.parts.made).index(held)]]) if isinstance(held, str) else held
        book.add(name, energy=heat, exergy=cycle.T_0 * generated - heat * (1.0 - cycle.T_0 / T))


# ---- oil ---------------------------------------------------------------------------------------------------------


def _oil(book: _Book, cycle: Cycle, suction: State, paths: Array, heats: Array, sums: Array) -> float:
    """Return the exergy rise of the oil [W] (M56), and enter its heat, injection, supply and what is not conserved."""
    c, known = cycle.machinery.composition, cycle.known
    for name, row in zip(c.heats, heats, strict=True):
        book.add(name, energy=float(row[kernels.HEAT]), entropy=float(row[kernels.HEAT_GENERATED]))
    lift = oil_lift(cycle.parts, cycle.lines, known)
    book.add(OIL_SUPPLY, energy=lift, exergy=known.oil_volume_flow * _throttled(cycle) + _kept(cycle))
    if c.ported:
        book.add(OIL_INJECTION, entropy=float(sums[kernels.PORT_GENERATED]))
    dissolved = _flash(book, cycle, suction, paths, sums)
    mechanical = known.oil_volume_flow * (cycle.lines.p_d - known.oil_source_pressure)
    if c.carried:
        return dissolved + mechanical + _carried(book, cycle, paths)
    if c.heats:
        return mechanical + _not_carried(book, cycle, paths, sums)
    return mechanical


def _flash(book: _Book, cycle: Cycle, suction: State, paths: Array, sums: Array) -> float:
    """Enter the gas that flashes out of the oil; return the exergy [W] by which it is less than that gas (M197)."""
    content, flashed = cycle.parts.oil_content, float(sums[kernels.FLASH_MASS])
    if content is None:
        return 0.0
    if cycle.parts.dissolves:
        return _released(book, cycle, suction, paths, sums)
    for name, _ in cycle.parts.all(OilGas):
        generated = float(sums[kernels.FLASH_GENERATED])
        book.add(name, gas=flashed, energy=flashed * content.latent, entropy=generated)
    return flashed * content.latent * (1.0 - cycle.T_0 / cycle.parts.oil.temperature)


def _released(book: _Book, cycle: Cycle, suction: State, paths: Array, sums: Array) -> float:
    """Enter the gas that oil gives off over time; return the rise [W] of what it holds, and of that gas (M234)."""
    held, ends = Held(cycle, suction), {}
    for name, end, row in zip(_names(cycle), cycle.machinery.composition.ends, paths.tolist(), strict=True):
        entry = {"discharge": "", "suction": SUCTION_LINE}.get(end, f"{end}_plenum")
        ends.setdefault(entry, []).append((name, row))
    held.at_lines(ends, book.add)
    gas, energy = float(sums[kernels.FLASH_MASS]), float(sums[kernels.RELEASED])
    rise = held.rise()
    for name, part in cycle.parts.all(OilGas):
        book.add(name, gas=gas, energy=energy, entropy=float(sums[kernels.FLASH_GENERATED]))
        i = 2 * cycle.parts.number(part.plenum)
        net = float(cycle.streams[i : i + 2, 0].sum()) * cycle.rate
        rise += held.of_gas(net, cycle.parts.plenums[part.plenum])
    return rise


def _throttled(cycle: Cycle) -> float:
    """Return the pressure [Pa] that the oil loses between its source and the chamber, dissipated at T_0 (M58).

    Where the oil takes room, what it loses in the chamber heats it instead: left is the loss of the line, and what
    lifts oil from a source below the chamber's pressure.
    """
    known, port = cycle.known, cycle.parts.oil_port
    if not cycle.parts.oil_room:
        return known.oil_source_pressure - known.injection_pressure
    return (
        port.loss(known.oil_source_pressure)
        if port is not None
        else min(0.0, known.oil_source_pressure - known.injection_pressure)
    )


def _thermal(cycle: Cycle, mass: float, mass_T: float, mass_log: float) -> float:
    """Return the exergy [W] of oil above that of injected oil at equal pressure, from Σ ṁ, Σ ṁ T, Σ ṁ ln T (M56)."""
    oil: OilPart = cycle.parts.oil
    T = oil.temperature
    return oil.heat_capacity * ((mass_T - mass * T) - cycle.T_0 * (mass_log - mass * log(T)))


def _mixed(mass: float, mass_T: float) -> tuple[float, float, float]:
    """Return Σ ṁ, Σ ṁ T, Σ ṁ ln T of oil mixed to one temperature."""
    return mass, mass_T, mass * log(mass_T / mass) if mass > 0.0 else 0.0


def _mixing(book: _Book, cycle: Cycle, paths: Array, T_mean: float) -> None:
    """Enter the mixing of the oil that leaves to the discharge line to its mean temperature there (M53)."""
    c_oil = cycle.parts.oil.heat_capacity
    for name, end, row in zip(_names(cycle), cycle.machinery.composition.ends, paths.tolist(), strict=True):
        mass, mass_T, mass_log = (row[i] for i in (kernels.OUT_OIL, kernels.OUT_OIL_T, kernels.OUT_OIL_LOG))
        if mass > 0.0 and end == "discharge":
            book.add(name, entropy=c_oil * ((mass_T / T_mean - mass) - (mass_log - mass * log(T_mean))))


def _carried(book: _Book, cycle: Cycle, paths: Array) -> float:
    """Return the thermal exergy rise of carried oil [W]; enter its injection and what the suction line takes."""
    oil: OilPart = cycle.parts.oil
    out, out_T = (-float(cycle.streams[3, i]) * cycle.rate for i in (2, 3))
    out_T -= out * cycle.pressed(cycle.lines.p_d)
    back = float(cycle.streams[2, 2]) * cycle.rate
    if out > 0.0:
        _mixing(book, cycle, paths, out_T / out)
    lost = 0.0
    columns, ends = slice(kernels.OUT_OIL, kernels.OUT_OIL_LOG + 1), cycle.machinery.composition.ends
    for end in dict.fromkeys(end for end in ends if end != "discharge"):
        rows = [i for i, other in enumerate(ends) if other == end]
        taken = paths[rows, columns].sum(axis=0).tolist()
        rise = taken[0] / oil.density * (cycle.lines.p_d - cycle.known.oil_source_pressure)
        lost += rise
        if taken[0] > 0.0:
            p = _pressure(cycle, end) if cycle.parts.oil_room else cycle.lines.p_d
            pressure = taken[0] / oil.density * (p - cycle.known.oil_source_pressure)
            energy = oil.heat_capacity * (taken[1] - taken[0] * oil.temperature)
            entry = SUCTION_LINE if end == "suction" else f"{end}_plenum"
            book.add(entry, energy=energy, exergy=_thermal(cycle, taken[0], taken[1], taken[2]) + pressure)
    if not cycle.machinery.composition.ported:
        book.add(OIL_INJECTION, entropy=cycle.rate * _injection(cycle))
    T_line = float(cycle.machinery.R[R_DISCHARGE + OIL_TEMPERATURE]) - cycle.pressed(cycle.lines.p_d)
    return _thermal(cycle, *_mixed(out, out_T)) - _thermal(cycle, *_mixed(back, back * T_line)) - lost


def _injection(cycle: Cycle) -> float:
    """Return the entropy [J/K] that one injection generates by mixing with the oil that is there (M53)."""
    oil, R = cycle.parts.oil, cycle.machinery.R
    before, injected = float(R[R_OIL_BEFORE]), float(R[R_INJECTED])
    times, dense, _, steps = cycle.machinery.last()
    i = int(np.searchsorted(times[: steps + 1], cycle.machinery.composition.P[P_INJECTION] + 1e-9)) - 1
    T_before, T_after = float(dense[i - 1, 1, 2]), float(dense[i, 0, 2])
    mixed = injected * log(T_after / oil.temperature)
    return oil.heat_capacity * (mixed + (before * log(T_after / T_before) if before > 0.0 else 0.0))


def _not_carried(book: _Book, cycle: Cycle, paths: Array, sums: Array) -> float:
    """Return the thermal exergy rise of oil at a constant ratio [W], and enter what appears and vanishes (M57)."""
    oil, R = cycle.parts.oil, cycle.machinery.R
    out, out_T = (float(paths[:, column].sum()) for column in (kernels.OUT_OIL, kernels.OUT_OIL_T))
    T_mean = out_T / out if out > 0.0 else oil.temperature
    _mixing(book, cycle, paths, T_mean)
    injected = cycle.known.oil_mass_flow
    times, dense, _, steps = cycle.machinery.last()
    c = cycle.machinery.composition
    volume = float(cycle.machinery.module.volume_at(times[steps], c.P, c.TAB))
    rest = cycle.rate * float(R[R_RATIO] * dense[steps - 1, 1, 1]) * volume
    rise = _thermal(cycle, *_mixed(injected, injected * T_mean))
    entry = _thermal(cycle, *_mixed(rest, rest * float(dense[steps - 1, 1, 2])))
    entry -= _thermal(cycle, sums[kernels.MADE], sums[kernels.MADE_T], sums[kernels.MADE_LOG])
    entry += _thermal(cycle, *_mixed(out, out_T)) - rise
    entry += float(sums[kernels.LOST] - cycle.T_0 * sums[kernels.LOST_OVER_T])
    book.add(NOT_CONSERVED, exergy=float(entry))
    return rise


# ---- losses ------------------------------------------------------------------------------------------------------


def _kept(cycle: Cycle) -> float:
    """Return the power [W] that losses leave in the oil as pressure."""
    return sum(float(part.kept(cycle.known)) for _, part in cycle.parts.all(PowerLoss) if part.kept is not None)


def _losses(book: _Book, cycle: Cycle) -> None:
    """Enter every power beside the gas work: dissipated at T_0, but for what stays in the oil as pressure (M58)."""
    for name, part in cycle.parts.all(PowerLoss):
        power = float(part.power(cycle.known))
        kept = float(part.kept(cycle.known)) if part.kept is not None else 0.0
        book.add(name, energy=power, exergy=power - kept)


def entropy_residue(book: Figures, least_power: float = 0.0) -> float | None:
    """Return the residue of the ledger over the shaft power and all that is destroyed; None without a ledger.

    Given that energy closes, it is the residue of the entropy balance times T_0 (docs/model.md M59). Powers [W] below
    the least one are rounding, as in the energy balance.
    """
    if not book:
        return None
    destroyed = sum([abs(value) for name, value in book.items() if value and name.startswith("exergy_destroyed_")])
    return abs(book["residue"]) / max(abs(book["shaft_power"]) + destroyed, least_power, 1e-300)
