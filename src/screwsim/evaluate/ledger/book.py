"""The entries of the ledger while they are being added up, and the quantities of a closed cycle that it uses."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from screwsim.cycle.cycle_figures import chamber_end_pressure
from screwsim.effects.base import DISCHARGE, SUCTION
from screwsim.evaluate.evaluation import Evaluation
from screwsim.fluid.reservoir import Reservoir
from screwsim.model.parts import OilPart
from screwsim.model.slots import DISCHARGE_IN, DISCHARGE_OUT, OF_GAS
from screwsim.numerics.identity_cache import once

OIL_INJECTION, OIL_SUPPLY = "oil_injection", "oil_supply"
SUCTION_LINE, DISCHARGE_LINE, NOT_CONSERVED = "suction_line", "discharge_line", "oil_not_conserved"

Rows = list[list[float]]  # sums of model.ledger as rates, one row for each flow path


class State(NamedTuple):
    """A state of the gas: T [K], h [J/kg], s [J/(kg K)]."""

    T: float
    h: float
    s: float

    def generated(self, mass: float, enthalpy: float, entropy: float) -> float:
        """Return the entropy [J/K] generated where gas with these sums comes to this state, at its pressure (M52)."""
        return (enthalpy - mass * self.h) / self.T - (entropy - mass * self.s)


def exergy_over(state: State | Reservoir, at: State, T_0: float) -> float:
    """Return the flow exergy [J/kg] of a state over that of another (M55); T_0 [K] is the ambient temperature."""
    return state.h - at.h - T_0 * (state.s - at.s)


class FlowEnd(NamedTuple):
    """A line or plenum to which gas and oil leave the chambers.

    Gas that arrives is brought to `state`; `entry` names the entry for what the end takes. `kept`: the arriving gas
    stays and mixes to its mean; otherwise the end does not change, and anything brought beyond its state is lost.
    """

    name: str
    state: State
    entry: str
    kept: bool


@dataclass
class Entry:
    """One line of the ledger [SI]: gas moved, energy moved, entropy generated and the shaft power that it costs."""

    gas_moved: float | None = None
    energy_moved: float | None = None
    entropy_generated: float = 0.0
    exergy_destroyed: float = 0.0


class LedgerCycle:
    """A closed cycle, and the entries of its ledger as they are added up, as rates; T_0 [K].

    `line_given`: the discharge line's state is not the outflow's.
    """

    def __init__(self, of: Evaluation) -> None:
        self.of, self.problem, self.life, self.streams, self.known = of, of.problem, of.life, of.streams, of.known
        self.powers = of.powers
        self.parts, self.lines, self.suction = of.problem.parts, of.problem.lines, of.problem.suction
        self.composition, self.R, self.rate = of.life.composition, of.life.R, of.problem.rate
        operation = of.problem.scene.operation
        self.T_0 = operation.ambient_temperature
        delivers = of.streams[DISCHARGE_IN, OF_GAS] + of.streams[DISCHARGE_OUT, OF_GAS] < 0.0
        self.line_given = operation.discharge.temperature is not None or not delivers
        self.entries: dict[str, Entry] = {}

    def add(
        self,
        name: str,
        *,
        entropy: float | None = None,
        exergy: float | None = None,
        gas: float | None = None,
        energy: float | None = None,
    ) -> None:
        """Add to an entry: entropy generated [W/K], or exergy destroyed [W], which counts as entropy at T_0."""
        entry = self.entries.setdefault(name, Entry())
        if gas is not None:
            entry.gas_moved = (entry.gas_moved or 0.0) + gas
        if energy is not None:
            entry.energy_moved = (entry.energy_moved or 0.0) + energy
        destroyed = exergy if exergy is not None else self.T_0 * (entropy or 0.0)
        entry.exergy_destroyed += destroyed
        entry.entropy_generated += destroyed / self.T_0

    @property
    def oil(self) -> OilPart:
        """The oil; only for machines that have one."""
        assert self.parts.oil is not None
        return self.parts.oil

    def state(self, T: float, rho: float, h: float) -> State:
        """Return a state of the gas with its entropy."""
        c = self.composition
        return State(T, h, float(self.life.module.gas_entropy(T, rho, c.P, c.TAB)))

    def exergy(self, state: State) -> float:
        """Return the flow exergy [J/kg] of a state, up to a constant."""
        return state.h - self.T_0 * state.s

    def behind(self, to: str, line: State) -> State:
        """Return the mean state at the chambers' end of a line: throttled where its pressure has an offset (M184)."""
        p = chamber_end_pressure(self.problem, self.life, to)
        return line if p is None else self.at(p, line.h)

    def at(self, p: float, h: float) -> State:
        """Return the state at a pressure [Pa] and an enthalpy h [J/kg]."""
        gas = self.parts.gas
        return self.state(gas.temperature(p, h), gas.port_state_of_enthalpy(p, h)[1], h)

    @once
    def paths(self) -> list[str]:
        """Return the names of the effects of all flow paths, in the order of their sums."""
        c = self.composition
        return [*c.ports, *[name for name, _ in c.gaps]]

    def pressure(self, end: str) -> float:
        """Return the pressure [Pa] of a line or plenum."""
        pressures = {SUCTION: self.suction.pressure, DISCHARGE: self.lines.p_d}
        return pressures[end] if end in pressures else self.parts.plenums[end].p

    def ends(self, back: State, discharge: State) -> list[FlowEnd]:
        """Return the end of each path; gas that flows back to suction is brought to the state `back`."""
        found = {
            SUCTION: FlowEnd(SUCTION, back, SUCTION_LINE, kept=self.parts.suction_line),
            DISCHARGE: FlowEnd(DISCHARGE, discharge, DISCHARGE_LINE, kept=True),
        }
        for name, own in self.parts.plenums.items():
            found[name] = FlowEnd(name, State(own.T, own.h, own.s), f"{name}_plenum", kept=False)
        return [found[end] for end in self.composition.ends]

    def from_plenums(self, exergy: Callable[[Reservoir], float], without: str = "") -> float:
        """Return the flow exergy [W] of gas from own plenums, but that of one name."""
        drawn = self.of.drawn.items()
        return sum(flow * exergy(self.parts.plenums[name]) for name, flow in drawn if name != without)
