"""The ledger: where the shaft power goes, as exergy destroyed by each effect (docs/model.md M50–M59).

Shaft power = exergy rise of the gas + exergy rise of the oil + T_0 Σ entropy generated + residual. Every effect of the
scene has an entry, and so has what the model itself destroys or adds: the oil's supply, its injection, the lines. The
control volume is the machine, from the suction line to gas and oil as they leave the chambers, with the oil's supply;
with effects.separator it is machine, separator and oil cooler, up to the gas that leaves the separator (M286).
"""

import math
from dataclasses import dataclass
from typing import Any

from screwsim.effects.base import DISCHARGE, SUCTION, PowerLoss, Reading
from screwsim.evaluate.evaluation import Evaluation
from screwsim.evaluate.ledger import gas
from screwsim.evaluate.ledger.book import Entry, LedgerCycle, State
from screwsim.evaluate.ledger.oil import OilSums, cool_at_lines, oil_rise, through_circuit
from screwsim.inputs.faults import checked_own_number
from screwsim.model.slots import DENSITY, ENTHALPY, R_SUCTION
from screwsim.model.turn_scheduler import reach_station
from screwsim.outputs import Figures


@dataclass(frozen=True)
class Ledger:
    """The balance of a closed cycle's shaft power [W]: exergy rise of gas and oil (None: no oil), and the entries."""

    entries: dict[str, Entry]
    T_0: float
    shaft_power: float
    of_gas: float
    of_oil: float | None

    @property
    def destroyed(self) -> float:
        """The exergy destroyed by all entries [W]."""
        return sum([entry.exergy_destroyed for entry in self.entries.values()])

    @property
    def residual(self) -> float:
        """The power that no entry explains [W]."""
        return self.shaft_power - self.of_gas - (self.of_oil or 0.0) - self.destroyed

    @property
    def finite(self) -> bool:
        """Whether every number is finite."""
        values = [value for entry in self.entries.values() for value in vars(entry).values() if value is not None]
        return math.isfinite(self.residual) and all(map(math.isfinite, values))

    def entropy_residual(self, least_power: float = 0.0) -> float:
        """Return the residual over the sum of shaft power, all exergy destroyed and all energy moved, as magnitudes.

        If energy closes, it is the residual of the entropy balance times T_0 (docs/model.md M59). It contains
        the energy residual, so it is related to no less than that is. Powers [W] below the least one are
        rounding, as in the energy balance.
        """
        size = abs(self.shaft_power)
        for entry in self.entries.values():
            size += abs(entry.exergy_destroyed) + abs(entry.energy_moved or 0.0)
        return abs(self.residual) / max(size, least_power, 1e-300)

    def figures(self) -> Figures:
        """Return the totals, and the entries as `<quantity>_<effect>` (outputs.LEDGER)."""
        residual = self.residual
        found: dict[str, Any] = {
            "ambient_temperature": self.T_0,
            "shaft_power": self.shaft_power,
            "gas_exergy_rise": self.of_gas,
            "oil_exergy_rise": self.of_oil,
            "exergy_destroyed": self.destroyed,
            "residue": residual,
            "relative_residue": residual / abs(self.shaft_power) if self.shaft_power != 0.0 else None,
        }
        for name, entry in self.entries.items():
            found |= {f"{quantity}_{name}": value for quantity, value in vars(entry).items()}
        return Figures(found)


def ledger(of: Evaluation) -> Ledger:
    """Return the ledger of a closed cycle's shaft power (contract: ledger)."""
    cycle = LedgerCycle(of)
    suction = _intake_state(cycle)
    line = cycle.at(cycle.lines.p_d, of.h_d)
    discharge = line if of.outflow is None else cycle.at(cycle.lines.p_d, of.outflow.enthalpy)
    sucked, given = cycle.behind(SUCTION, suction), cycle.behind(DISCHARGE, discharge)
    reach_station()
    moved, heats, oil = (cycle.rate * sums for sums in cycle.life.account(sucked.s, cycle.behind(DISCHARGE, line).s))
    reach_station()
    paths = moved.tolist()
    cool_at_lines(cycle, paths)
    reach_station()
    for name, items in cycle.parts.effects.items():
        if not items or not all(isinstance(part, Reading) for part in items):  # effects that only read have no entry
            cycle.entries[name] = Entry()
    met = gas.line_streams(cycle, paths) if cycle.parts.suction_line else None
    back = sucked if met is None else gas.mean_back(cycle, met, sucked)
    ends = cycle.ends(back, given)
    gas.enter_paths(cycle, paths, ends, sucked)
    throttled = {SUCTION: gas.Throttled(suction, sucked, suction), DISCHARGE: gas.Throttled(given, discharge, line)}
    gas.enter_pulsations(cycle, throttled)
    of_gas = gas.gas_rise(cycle, suction, line, discharge)
    if met is not None:
        of_gas = gas.enter_line(cycle, of_gas, met, (suction, sucked, back), discharge)
    if cycle.suction.changed:
        of_gas = gas.enter_intake(cycle, of_gas, discharge)
    warmed = len(cycle.composition.heats)
    gas.enter_walls(cycle, heats[warmed:])
    of_oil = None
    reach_station()
    if cycle.parts.oil is not None:
        of_oil = oil_rise(cycle, OilSums(paths, ends, oil, met), heats[:warmed], suction)
        of_gas, of_oil = through_circuit(cycle, of, of_gas, of_oil)
    _losses(cycle)
    return Ledger(cycle.entries, cycle.T_0, cycle.powers.shaft, of_gas, of_oil)


def _intake_state(cycle: LedgerCycle) -> State:
    """Return the state of the gas before the suction port: the line's, unless mixed or throttled."""
    h, rho = (float(cycle.R[R_SUCTION + at]) for at in (ENTHALPY, DENSITY))
    if cycle.parts.suction_line or cycle.parts.arriving_oil:  # oil that takes room is in the line's own density
        return cycle.at(cycle.suction.pressure, h)
    port_state = cycle.suction.port_state(cycle.of.h_d)
    return cycle.state(cycle.suction.temperature(port_state, cycle.lines.T_s), rho, h)


def _losses(cycle: LedgerCycle) -> None:
    """Enter every power besides the gas work: dissipated at T_0, except for what stays in the oil as pressure (M58)."""
    for name, part in cycle.parts.all(PowerLoss):
        power = float(part.power(cycle.known))
        given = part.kept(cycle.known) if part.kept is not None else 0.0
        if math.isfinite(cycle.known.indicated_power):
            checked_own_number(name, f"what the oil keeps of {part.figure} [W]", given, 0.0)
        kept = float(given)
        cycle.add(name, energy=power, exergy=power - kept)
