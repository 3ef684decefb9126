"""Flows of a cycle into the separator, the residual of the oil's circuit, and the losses of a package.

Source: docs/model.md M280–M285, M343.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from screwsim.build import open_temperatures, package_of, separator_effects
from screwsim.cycle import suction_line
from screwsim.cycle.balances import incoming_oil, injection_pressure, walls_of
from screwsim.cycle.cycle_figures import brought_by_oil, oil_lift
from screwsim.cycle.problem import Problem
from screwsim.effects.base import OilSolution, PowerLoss
from screwsim.effects.base import Separator as SeparatorPart
from screwsim.fluid.moist_air import MoistAir
from screwsim.fluid.separator import Separated, SeparatorInflow, separated
from screwsim.inputs.faults import UsageError
from screwsim.model import slots
from screwsim.model.numbers import oil_places

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
    problem, parts, scene = of.problem, of.problem.parts, of.problem.scene
    part = next((part for _, part in parts.all(SeparatorPart)), None)
    asking = separator_effects(scene)
    if parts.oil is None or not (part or asking or isinstance(parts.gas, MoistAir)):
        return None
    lift = oil_lift(parts, of.known)
    outflow = _outflow(of, lift)
    brought = brought_by_oil(problem, of.known) if parts.geometry.expands else 0.0  # an expander's oil (M490)
    outflow = outflow._replace(heating=outflow.heating + brought)
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
    power = abs(problem.rate * float(of.q[slots.Q_WORK]) + lift + sum(of.losses.values()))
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


def _outflow(of: Evaluation, lift: float) -> SeparatorInflow:
    """Return the flows of a life into the separator (M280, M282); `lift` [W] is the power that lifts the oil."""
    problem, life, q, losses = of.problem, of.life, of.q, of.losses
    parts, c, rate, h_ref = problem.parts, problem.composition, problem.rate, problem.inlet.enthalpy
    oil = parts.oil
    assert oil is not None
    streams = rate * of.streams
    gas = streams[:, slots.OF_GAS]
    beyond = (streams[:, slots.OF_ENERGY] - h_ref * gas).tolist()  # [W], relative to gas of the suction line
    leak = suction_line.leak(problem, life.R).times(rate)
    out = -float(gas[slots.DISCHARGE_IN] + gas[slots.DISCHARGE_OUT]) - leak.gas
    energy = -(beyond[slots.DISCHARGE_IN] + beyond[slots.DISCHARGE_OUT]) - (leak.enthalpy - h_ref * leak.gas)
    returned = problem.suction.returned * suction_line.fresh_gas(problem, life.R, streams / rate) * rate
    sent_back = returned * (float(life.R[slots.R_DISCHARGE + slots.ENTHALPY]) - h_ref)
    flashing = {parts.number(parts.oil_gas.plenum)} if parts.oil_gas is not None else set()
    own = range(slots.FIRST_OWN, slots.FIRST_OWN + len(parts.plenums))
    supplied = beyond[slots.SUCTION_IN] + beyond[slots.SUCTION_OUT] - sent_back + rate * float(q[slots.Q_WORK])
    supplied += sum(beyond[2 * i] + beyond[2 * i + 1] for i in own if i not in flashing)
    supplied += rate * float(walls_of(c, q)[:, 0].sum())
    absorbed = sum(float(gas[2 * i] + gas[2 * i + 1]) for i in flashing)
    taken_up = sum(beyond[2 * i] + beyond[2 * i + 1] for i in flashing)
    if c.carried:
        p_in = max(oil.source_pressure, injection_pressure(problem, life.R))
        T_in = oil.temperature + problem.oil_pressure_term(p_in)
        T_in = float(c.P[oil_places(parts)["P_H_PORT"]]) if c.ported else T_in

        def heat(oil_heat: Any, oil_flow: Any) -> float:
            """Return the heat [W] of oil above that of oil at `T_in`."""
            return oil.heat_capacity * float(np.sum(oil_heat - T_in * oil_flow))

        if c.ported:
            taken_up += heat(streams[slots.PORT_OIL, slots.OF_OIL_HEAT], streams[slots.PORT_OIL, slots.OF_OIL])
        line = parts.suction_line or parts.geometry.expands  # to which oil flows back, and not to the separator
        of_line = (slots.SUCTION_IN, slots.SUCTION_OUT) if line else ()
        lines = [row for row in range(len(streams)) if row not in (slots.BETWEEN, slots.PORT_OIL, *of_line)]
        energy -= heat(streams[lines, slots.OF_OIL_HEAT], streams[lines, slots.OF_OIL])
        if line:
            # oil that circulates through the suction line, and the leak to it, which leaves before the separator
            back = streams[slots.SUCTION_IN] + streams[slots.SUCTION_OUT]
            leaked = heat(leak.oil_heat, leak.oil)
            energy -= leaked
            supplied += heat(back[slots.OF_OIL_HEAT], back[slots.OF_OIL]) - leaked - (leak.enthalpy - h_ref * leak.gas)
        if isinstance(parts.oil_content, OilSolution) and parts.suction_line:
            held = streams[:, slots.OF_HELD]
            flashed = leak.held - float(held[slots.SUCTION_IN] + held[slots.SUCTION_OUT])  # M272
            absorbed += flashed
            taken_up += flashed * (parts.oil_content.enthalpy - h_ref)
            supplied -= flashed * (parts.oil_content.enthalpy - h_ref)
    else:
        energy -= rate * float(q[slots.Q_HEAT])
    friction = sum(losses[name] for name in {part.figure for _, part in parts.all(PowerLoss) if part.friction})
    return SeparatorInflow(
        parts.gas,
        p=problem.lines.p_d,
        gas_flow=out - returned - absorbed,
        h_ref=h_ref,
        oil_flow=rate * incoming_oil(problem, life.R, q),
        oil_heat_capacity=oil.heat_capacity,
        T_supply=oil.temperature,
        T_inlet=problem.lines.T_s,
        energy=energy - sent_back - taken_up,
        heating=(0.0 if parts.oil_room else lift) + sum(losses.values()) - friction,
        friction=friction,
        supplied=supplied + (lift if parts.oil_room else 0.0),
    )


class Package(NamedTuple):
    """The difference between the losses with which a cycle was integrated and those at its flow.

    `before` and `behind` [Pa] are the changes needed, `open` is the larger one over its line's pressure.
    """

    before: float
    behind: float
    open: float


def package_residual(problem: Problem, flow: float | None) -> Package | None:
    """Return the difference between a problem's losses and those at a mass flow [kg/s]; None without a package."""
    package, posed = package_of(problem.scene), problem.scene.losses
    if package is None or posed is None:
        return None
    outlet = problem.lines.p_d - posed.behind
    found = package.losses(max(flow or 0.0, 0.0) / problem.inlet.density, problem.lines.p_s, outlet)
    before, behind = found.before - posed.before, found.behind - posed.behind
    return Package(before, behind, max(abs(before) / problem.lines.p_s, abs(behind) / outlet))
