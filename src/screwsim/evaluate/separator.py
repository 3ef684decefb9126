"""The oil's circuit: gas and oil of a cycle part in the separator, and the residual of the circuit.

Source: docs/model.md M281–M285.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from screwsim.build import open_temperatures, separator_effects
from screwsim.effects.base import Separator as SeparatorPart
from screwsim.evaluate.separator_inflow import separator_inflow
from screwsim.fluid.moist_air import MoistAir
from screwsim.fluid.separator import Separated, SeparatorInflow, separated
from screwsim.inputs.faults import UsageError

if TYPE_CHECKING:
    from screwsim.evaluate.evaluation import Evaluation

NONE_LEFT = (
    "no net gas is delivered to leave the separator (choose smaller leaks, a higher speed or a lower pressure ratio)"
)


class Circuit(NamedTuple):
    """The separation of a cycle's gas and oil, and the differences from the temperatures it was integrated with.

    `supply` and `separator` [K] are the differences of the two temperatures, 0 where they are stated or not needed;
    `open` is the power that they leave open, `residual` that of the whole circuit, both over the shaft power.
    `unclosed` [K] is the effect of the cycle's energy residual on the mixture's temperature. `parted` is the separation
    of what leaves the chambers. Temperatures that are found follow from what enters them, which a cycle that is not
    closed well states with a smaller error.
    """

    outflow: SeparatorInflow
    parted: Separated
    supply: float
    separator: float
    open: float
    residual: float
    unclosed: float


def circuit_of(of: Evaluation) -> Circuit | str | None:
    """Return the oil's circuit of an evaluated life.

    None where nothing needs it, a text where it cannot be found. It is needed with effects.separator, where the
    scene states the separator's temperature (to compare its balance), and with moist air (where water separates
    from the oil).
    """
    parts, scene = of.problem.parts, of.problem.scene
    part = next((part for _, part in parts.all(SeparatorPart)), None)
    asking = separator_effects(scene)
    if parts.oil is None or not (part or asking or isinstance(parts.gas, MoistAir)):
        return None
    outflow = separator_inflow(of)
    if not outflow.gas_flow > 0.0:
        return NONE_LEFT
    supply_open, separator_open = open_temperatures(scene)

    def separation(inflow: SeparatorInflow) -> Separated:
        return separated(inflow) if part is None else part.balance(inflow, supply_open)

    try:
        parted = separation(outflow)
        found = separation(outflow._replace(energy=outflow.supplied)) if supply_open or separator_open else parted
    except UsageError as error:
        return f"the separator does not separate gas and oil: {error}"
    used = asking[0].separator_temperature if asking and separator_open else None
    change = 0.0 if used is None else found.T_separator - used
    power = abs(of.powers.shaft)
    unexplained = _unexplained_power(outflow, parted)
    shares = [abs(each) / max(power, 1e-300) for each in (found.open, outflow.oil_capacity * change, unexplained)]
    unclosed = abs(unexplained) / max(outflow.oil_capacity + outflow.gas_flow * parts.gas.c_p, 1e-300)
    return Circuit(outflow, parted, found.supply, change, max(shares[:2]), max(shares), unclosed)


def _unexplained_power(outflow: SeparatorInflow, parted: Separated) -> float:
    """Return the power [W] that comes in beyond what gas, cooler, surroundings take (M285); 0 where gas condenses."""
    if parted.why:
        return 0.0
    comes = outflow.supplied + outflow.heating + outflow.friction
    goes = outflow.heat_of(parted.T_separator) + parted.duty + parted.ambient_loss + parted.lost_friction
    return comes - goes
