"""What a cycle delivers to its separator: gas and oil with their heat, and the losses that heat them on the way.

Source: docs/model.md M280, M282, M285, M491.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from screwsim.cycle.balances import incoming_oil_temperature, walls_of
from screwsim.cycle.powers import brought_by_oil
from screwsim.effects.base import DISCHARGE, SUCTION, OilSolution, PowerLoss
from screwsim.fluid.separator import SeparatorInflow
from screwsim.model import slots
from screwsim.model.numbers import oil_places

if TYPE_CHECKING:
    from screwsim.evaluate.evaluation import Evaluation

Array = np.ndarray


def separator_inflow(of: Evaluation) -> SeparatorInflow:
    """Return the flows of a cycle into its separator (M280), and the powers that heat them (M282) and enter (M285)."""
    problem, parts, known = of.problem, of.problem.parts, of.known
    assert parts.oil is not None
    streams = MachineStreams(of)
    leaving, returned, absorbed = streams.leaving, streams.returned, streams.absorbed
    lift, losses = of.powers.lift, of.powers.losses
    friction = sum(losses[name] for name in {part.figure: None for _, part in parts.all(PowerLoss) if part.friction})
    brought = brought_by_oil(problem, known) if parts.geometry.expands else 0.0
    return SeparatorInflow(
        parts.gas,
        p=problem.lines.p_d,
        gas_flow=leaving.gas - returned.gas - absorbed.gas,
        h_ref=problem.inlet.enthalpy,
        oil_flow=known.oil_mass_flow,
        oil_heat_capacity=parts.oil.heat_capacity,
        T_supply=parts.oil.temperature,
        T_inlet=problem.lines.T_s,
        energy=leaving.heat - returned.heat - absorbed.heat,
        heating=(0.0 if parts.oil_room else lift) + sum(losses.values()) - friction + brought,
        friction=friction,
        supplied=streams.supplied + (lift if parts.oil_room else 0.0),
    )


class Flow(NamedTuple):
    """A flow of gas [kg/s] and heat [W]."""

    gas: float = 0.0
    heat: float = 0.0

    def plus(self, other: Flow) -> Flow:
        """Return the sum of two flows."""
        return Flow(self.gas + other.gas, self.heat + other.heat)


class MachineStreams:
    """The streams of a life as rates, through the chambers and of the leak beside them: rows as in `slots.OF_GAS` ….

    Their heats [W] count over gas of the suction line and over oil as it comes in, at `T_oil` [K] with its flow work.
    """

    def __init__(self, of: Evaluation) -> None:
        self.of, self.parts, self.composition, self.rate = of, of.problem.parts, of.problem.composition, of.problem.rate
        self.rows, self.leak = self.rate * of.streams, np.array(of.leak.times(self.rate))
        if self.composition.ported:
            self.T_oil = float(self.composition.P[oil_places(self.parts)["P_H_PORT"]])
        else:
            self.T_oil = incoming_oil_temperature(of.problem, of.life.R)

    def gas_heat(self, row: Array) -> float:
        """Return the heat [W] of the gas of a stream."""
        return float(row[slots.OF_ENERGY] - self.of.problem.inlet.enthalpy * row[slots.OF_GAS])

    def oil_heat(self, rows: Array) -> float:
        """Return the heat [W] of the oil of one stream or several."""
        assert self.parts.oil is not None
        above = rows[..., slots.OF_OIL_HEAT] - self.T_oil * rows[..., slots.OF_OIL]
        return self.parts.oil.heat_capacity * float(np.sum(above))

    def net_from(self, name: str) -> Flow:
        """Return the net gas from a line or plenum."""
        into, back = self.rows[2 * self.parts.number(name) :][:2]
        return Flow(float(into[slots.OF_GAS] + back[slots.OF_GAS]), self.gas_heat(into) + self.gas_heat(back))

    @property
    def oil_comes_back(self) -> bool:
        """Whether oil that flows back to the suction line stays there, in place of coming to the separator."""
        return self.composition.carried and bool(self.parts.suction_line or self.parts.geometry.expands)

    @property
    def leaving(self) -> Flow:
        """What leaves to the discharge line less the leak out of it: gas, with the heat of gas and oil."""
        net, leak = self.net_from(DISCHARGE), self.leak
        heat = -net.heat - self.gas_heat(leak) - self._oil_heat_into_chambers() - self.oil_heat(leak)
        return Flow(-net.gas - float(leak[slots.OF_GAS]), heat)

    def _oil_heat_into_chambers(self) -> float:
        """Return the heat [W] that oil brings to the chambers, net; with transport: paper what it gives to the gas."""
        if not self.composition.carried:
            return self.rate * float(self.of.q[slots.Q_HEAT])
        others = [slots.BETWEEN, slots.PORT_OIL]
        others += [slots.SUCTION_IN, slots.SUCTION_OUT] if self.oil_comes_back else []
        return self.oil_heat(self.rows[[row for row in range(len(self.rows)) if row not in others]])

    @property
    def returned(self) -> Flow:
        """The gas that a bypass returns from the discharge line to suction (M161)."""
        gas = self.of.problem.suction.returned * (self.of.fresh_gas * self.rate)
        return Flow(gas, gas * (self.of.h_d - self.of.problem.inlet.enthalpy))

    @property
    def absorbed(self) -> Flow:
        """The gas that the oil gave off and takes up again, with what it took from the oil (M195, M196, M232)."""
        flashed = Flow() if self.parts.oil_gas is None else self.net_from(self.parts.oil_gas.plenum)
        cooled = self.oil_heat(self.rows[slots.PORT_OIL]) if self.composition.ported else 0.0
        return flashed.plus(Flow(0.0, cooled)).plus(self.released_in_line)

    @property
    def released_in_line(self) -> Flow:
        """The gas that oil gives off in the suction line (M272)."""
        content = self.parts.oil_content
        if not (isinstance(content, OilSolution) and self.parts.suction_line):
            return Flow()
        held = self.rows[:, slots.OF_HELD]
        gas = float(self.leak[slots.OF_HELD]) - float(held[slots.SUCTION_IN] + held[slots.SUCTION_OUT])
        return Flow(gas, gas * (content.enthalpy - self.of.problem.inlet.enthalpy))

    @property
    def supplied(self) -> float:
        """The power [W] that enters the chambers: work, heat of walls, of gas and oil from elsewhere (M285)."""
        found = self.net_from(SUCTION).heat - self.returned.heat + self.rate * float(self.of.q[slots.Q_WORK])
        flashing = None if self.parts.oil_gas is None else self.parts.oil_gas.plenum
        found += sum(self.net_from(name).heat for name in self.parts.plenums if name != flashing)
        found += self.rate * float(walls_of(self.composition, self.of.q)[:, 0].sum())
        suction = self.rows[slots.SUCTION_IN] + self.rows[slots.SUCTION_OUT]
        of_oil = self.oil_heat(suction) if self.oil_comes_back else 0.0
        found += of_oil - self.oil_heat(self.leak) - self.gas_heat(self.leak)
        return found - self.released_in_line.heat
