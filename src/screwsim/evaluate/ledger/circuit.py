"""The oil's circuit in the ledger: gas and oil mix in the separator, the oil goes back through its cooler (M286).

Without effects.separator the ledger ends where gas and oil leave the chambers, unmixed, and the oil's supply is given.
"""

from math import log

from screwsim.effects.base import Separator
from screwsim.evaluate.evaluation import Evaluation
from screwsim.evaluate.ledger.book import Book, Cycle, State
from screwsim.evaluate.separator import Circuit
from screwsim.model.slots import DENSITY, ENTHALPY

COOLER = "oil_cooler"


def through_circuit(book: Book, cycle: Cycle, of: Evaluation, of_gas: float, of_oil: float) -> tuple[float, float]:
    """Return the exergy rises [W] of gas that has left the separator and of oil that is back; enter what lies between.

    As they stand, `of_gas` and `of_oil`, where a scene has no separator.
    """
    circuit, names = of.circuit, [name for name, _ in cycle.parts.all(Separator)]
    if not (isinstance(circuit, Circuit) and names) or circuit.parted.why:
        return of_gas, of_oil
    outflow, parted, T_0 = circuit.outflow, circuit.parted, cycle.T_0
    line, T = cycle.suction.line, parted.T_separator
    sucked = cycle.state(cycle.suction.temperature(line, cycle.lines.T_s), line[DENSITY], line[ENTHALPY])

    def exergy(state: State) -> float:
        return state.h - sucked.h - T_0 * (state.s - sucked.s)

    gas = outflow.gas
    left = cycle.state(T, gas.density(outflow.p, T), gas.enthalpy(outflow.p, T))
    flashing = "" if cycle.parts.oil_gas is None else cycle.parts.oil_gas.plenum
    others = zip(cycle.parts.plenums, cycle.drawn(), strict=True)
    drawn = sum(net * exergy(State(own.T, own.rho, own.h, own.s)) for name, (net, own) in others if name != flashing)
    of_parted = outflow.gas_flow * exergy(left) - drawn
    cooled = outflow.oil_capacity * (T - outflow.T_supply - T_0 * log(T / outflow.T_supply))
    heat = outflow.heating + outflow.friction - parted.lost_friction - parted.ambient_loss
    book.add(names[0], gas=outflow.gas_flow, energy=heat, exergy=of_gas + of_oil - of_parted - cooled)
    book.add(COOLER, energy=outflow.oil_capacity * (T - outflow.T_supply), exergy=cooled)
    return of_parted, 0.0
