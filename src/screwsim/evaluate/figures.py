"""The performance figures of a closed cycle that its scene calls for."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.build import build_site
from screwsim.cycle import suction_line
from screwsim.cycle.balances import flow_past_suction_port, heat_flowing_back, outflow_dissolved_gas, outflow_of
from screwsim.cycle.cycle_figures import brought_by_oil, oil_lift
from screwsim.cycle.problem import Problem
from screwsim.effects import having
from screwsim.effects.base import DISCHARGE, SUCTION, Drawn, FlowPath, Given, Plenum, Separator, Turn
from screwsim.effects.parts.usual import SLIDES
from screwsim.evaluate import humidity, performance
from screwsim.evaluate.separator import Circuit
from screwsim.figures import Performance, figures_declared_elsewhere
from screwsim.fluid.reservoir import Reservoir
from screwsim.machine.settings import TURN
from screwsim.model import slots
from screwsim.model.parts import Parts
from screwsim.model.turn_scheduler import reach_station
from screwsim.outputs import Figure

if TYPE_CHECKING:
    from screwsim.evaluate.evaluation import Evaluation

Read = tuple[Performance, dict[str, str]]  # figures, and the reasons for those that are None
OF_SEPARATOR = "mixture_discharge_temperature", "separator_temperature", "oil_cooler_duty"
OF_SEPARATOR = (*OF_SEPARATOR, "oil_circuit_residual", "oil_flow_volume", "oil_cooler_load")
NO_LOAD = "no oil flows, or the coolant is not colder than what the cooler is to keep"
NO_REASON = "this cycle has none"
WHY_NONE = {
    "discharge_temperature": performance.NONE_LEAVES,
    "built_in_volume_ratio": "the machine has no discharge port whose opening marks the end of it",
    "oil_flow_ratio": "no net gas is delivered",
    "oil_discharge_temperature": "hardly any oil flows out to the discharge line",
}


def figures_of(of: Evaluation) -> Read:
    """Return the performance figures of an evaluated life, and the reasons for those that are None."""
    problem, life, known, streams = of.problem, of.life, of.known, of.streams
    about: dict[str, Figure] = dict(problem.called)  # joined by figures whose declaration an effect borrows
    parts, rate = problem.parts, problem.rate
    delivered = 0.0 if _shut(problem, known.turn) else 1.0 - problem.suction.returned  # share not returned (M163)
    sucked = suction_line.fresh_gas(problem, life.R, streams) + flow_past_suction_port(problem, life)
    flow = delivered * (sucked * rate) + 0.0  # + 0.0 turns −0 into 0
    lift = oil_lift(parts, known) if parts.oil is not None else None
    shaft = known.indicated_power + (lift or 0.0) + sum(of.losses.values())
    reach_station()
    drawn = performance.plenum_products(parts, streams, rate)
    mean = outflow_of(streams)
    leaving = None if mean is None else mean.enthalpy
    found: dict[str, Any] = {**of.losses, **_of_machine(of, leaving, flow)}
    found |= {"indicated_power": known.indicated_power, "shaft_power": shaft, "shaft_torque": shaft / parts.omega}
    notes = dict(WHY_NONE)

    def take(given: Given) -> None:
        own, reasons = performance.parted(given)
        found.update(own)
        notes.update(reasons)

    take(performance.efficiencies(parts.gas, problem.lines, problem.inlet, flow, shaft, drawn))
    reach_station()
    if parts.oil is not None:
        found |= _of_oil(of, flow) | {"oil_lift_power": lift}
    if of.circuit is not None and parts.all(Separator):
        take(_of_circuit(problem, of.circuit))
    if parts.dissolves:
        found["discharge_dissolved_gas_ratio"] = outflow_dissolved_gas(streams)
    take(_of_plenums(of, sucked, about))
    reach_station()
    take(humidity.figures(of, found))
    take(performance.refrigeration(found, problem.inlet.density, _refrigerating_effect(problem, found)))
    if problem.refrigerating_effect is not None:
        condensed, rejected = flow + sum(net for net, _ in drawn), _condenser_heat(of, leaving)
        beyond = performance.beyond_suction_gas(problem.scene, problem.inlet.enthalpy, drawn)
        lacking = sum(found.get(part.lacking) or 0.0 for _, part in parts.all(Plenum))
        beyond = beyond if isinstance(beyond, str) else beyond - lacking
        take(performance.heating(found, condensed, rejected, beyond))
    take(performance.saturation_figures(problem, found, leaving))
    if "intake_pressure" in problem.called:
        found["intake_pressure"] = problem.suction.pressure
        found["intake_temperature"] = _intake_temperature(of)
    if parts.suction_line:
        found |= _of_suction_line(of, suction_line.suction_heat(problem, shaft))
    if parts.geometry.expands:
        take(_of_expander(of, found, drawn))
        T_oil = problem.lines.T_s if parts.oil is None else parts.oil.temperature
        back = 0.0 if parts.suction_line else heat_flowing_back(problem, streams, T_oil)  # the line brings it again
        found["inlet_backflow_heat"] = back
    if parts.walls:
        found["wall_heat"] = float(of.q[slots.Q_WALLS : slots.Q_WALLS + 2 * len(parts.walls) : 2].sum()) * rate
    take(performance.readings(parts, known, found))
    values = dict(zip(about, map(found.get, about), strict=True))
    none = {name: notes.get(name, NO_REASON) for name, value in values.items() if value is None}
    return Performance(values, about), none


def _of_machine(of: Evaluation, leaving: float | None, flow: float) -> dict[str, float | None]:
    """Return the figures that every machine has, besides powers and efficiencies.

    `leaving` is the mean enthalpy [J/kg] of the outflow to discharge, None without one; `flow` the net gas flow
    [kg/s].
    """
    problem, life, geometry = of.problem, of.life, of.problem.parts.geometry
    parts, lines, rate = problem.parts, problem.lines, problem.rate
    return {
        "volumetric_efficiency": flow / (problem.inlet.density * geometry.swept_volume * rate),
        "gas_mass_flow": flow,
        "discharge_temperature": None if leaving is None else parts.gas.temperature(lines.p_d, leaving),
        "peak_pressure": life.peak_pressure(geometry.life if geometry.expands else geometry.widest_discharge()),
        "work_per_cycle": float(of.q[slots.Q_WORK]),
        "trapped_mass": float(life.R[slots.R_TRAPPED]),
        "suction_pressure": lines.p_s,
        "suction_temperature": lines.T_s,
        "discharge_pressure": lines.p_d,
        "pressure_ratio": lines.p_s / lines.p_d if geometry.expands else lines.p_d / lines.p_s,
        "displacement": geometry.swept_volume * TURN / geometry.pitch,
        "displacement_flow": geometry.swept_volume * rate,
        "built_in_volume_ratio": _volume_ratio(parts, life.volume),
    }


def _volume_ratio(parts: Parts, volume_at: Callable[[float], float]) -> float | None:
    """Return the built-in volume ratio: the machine's own, or with the edges of a slide that an effect states (M162).

    `volume_at` returns a chamber's volume [m³] at an angle [rad].
    """
    geometry = parts.geometry
    names = [key.split(".")[1] for key in having(SLIDES)]
    slide = [part for name in names for part in parts.effects.get(name, ()) if isinstance(part, FlowPath)]
    edges = [path for path in slide if path.values.get("size", 1.0) > 0.0]
    if not edges or geometry.profile is not None:  # whose own slide moves the machine's ports
        return geometry.built_in_volume_ratio(volume_at)
    at: dict[str, list[float]] = {SUCTION: [geometry.injection_angle], DISCHARGE: []}
    at[DISCHARGE] += [] if geometry.discharge_opens is None else [geometry.discharge_opens]
    for path in edges:
        at[path.to] += path.breakpoints
    return volume_at(max(at[SUCTION])) / volume_at(min(at[DISCHARGE])) if at[DISCHARGE] else None


def _refrigerating_effect(problem: Problem, found: Mapping[str, Any]) -> float | None:
    """Return the heat [J/kg] that a kilogram of suction gas takes up in the evaporator, with the gain by plenums."""
    gain = sum(found.get(part.gain) or 0.0 for _, part in problem.parts.all(Plenum))
    effect = problem.refrigerating_effect
    return None if effect is None else effect * (1.0 + gain)


def _of_expander(of: Evaluation, found: dict[str, Any], drawn: Sequence[tuple[float, Reservoir]]) -> Given:
    """Return the figures that an expander has in place of a compressor's; `drawn` as in `performance.efficiencies`."""
    problem, geometry, closes = of.problem, of.problem.parts.geometry, of.problem.parts.geometry.inlet_closes
    filled = None if closes is None else problem.inlet.density * of.life.volume(closes)  # where the inlet closes
    filled = None if filled is None else filled * problem.parts.omega / geometry.pitch
    own = float(found["gas_mass_flow"]) * (problem.h_isentropic - problem.inlet.enthalpy)
    work = problem.parts.gas.isentropic_work_of_enthalpy  # of what own plenums add; negative for what expands (M101)
    power = own + sum(net * work(state.p, problem.lines.p_d, state.h) for net, state in drawn)
    if problem.parts.oil is not None:
        power -= brought_by_oil(problem, of.known)
    return performance.figures_of_expander(found, power, filled)


def _of_oil(of: Evaluation, flow: float) -> dict[str, float | None]:
    """Return the figures of the oil; its ratio is that at the injection angle, or at the end of a port's injection."""
    parts, life, known = of.problem.parts, of.life, of.known
    ratio, port = known.oil_mass_flow / flow if flow > 0.0 else math.inf, parts.oil_port
    d = life.R[slots.R_RATIO] if port is None else life.states_at(np.array([port.closes]))[0, slots.S_X_OIL]
    known_by_gas = parts.geometry.expands and not of.problem.composition.carried
    return {
        "oil_mass_flow": known.oil_mass_flow,
        "oil_ratio": parts.arriving_oil if known_by_gas else float(d),
        "oil_flow_ratio": ratio if math.isfinite(ratio) else None,
        "oil_discharge_temperature": known.oil_discharge_temperature,
        "injection_pressure": known.injection_pressure,
    }


def _intake_temperature(of: Evaluation) -> float:
    """Return the temperature [K] of the gas at the suction port, the line's own where nothing changes it."""
    problem, life, suction = of.problem, of.life, of.problem.suction
    if problem.parts.suction_line:
        return problem.parts.gas.temperature(suction.pressure, float(life.R[slots.R_SUCTION + slots.ENTHALPY]))
    return suction.temperature(suction.port_state(float(life.R[slots.R_DISCHARGE + slots.ENTHALPY])), problem.lines.T_s)


def _of_suction_line(of: Evaluation, heat: float) -> dict[str, float]:
    """Return the flows back to the suction line, and the leaks to it that bypass the chambers (M270, M274).

    `heat` [W] is what the fresh gas takes up before the line.
    """
    problem, rate, R = of.problem, of.problem.rate, of.life.R
    back, leak = suction_line.backflow(problem, R, of.streams), suction_line.leak(problem, R)
    fresh = suction_line.fresh_gas(problem, R, of.streams)
    warmed = (
        float(R[slots.R_SUCTION + slots.ENTHALPY])
        - problem.suction.port_state(float(R[slots.R_DISCHARGE + slots.ENTHALPY]))[slots.ENTHALPY]
    )
    return {
        "returned_gas_flow": back.gas * rate,
        "returned_oil_flow": back.oil * rate,
        "returned_heat": fresh * warmed * rate - heat if fresh > 0.0 else 0.0,
        "shaft_leakage_gas_flow": leak.gas * rate,
        "shaft_leakage_oil_flow": leak.oil * rate,
    }


def _condenser_heat(of: Evaluation, leaving: float | None) -> float | str:
    """Return the heat that a kilogram of gas gives off in the condenser [J/kg] (M410), or why there is none.

    The gas comes from the separator, or without one from the chambers, with the enthalpy `leaving`.
    """
    problem, circuit = of.problem, of.circuit
    effect, parted = problem.refrigerating_effect, problem.parts.all(Separator)
    if isinstance(circuit, str) and parted:
        return circuit
    if leaving is None or effect is None:
        return performance.NONE_LEAVES
    h = leaving
    if isinstance(circuit, Circuit) and parted:
        if circuit.parted.why:
            return circuit.parted.why
        h = problem.parts.gas.enthalpy(problem.lines.p_d, circuit.parted.T_separator)
    return effect + h - problem.inlet.enthalpy


def _of_circuit(problem: Problem, circuit: Circuit | str) -> Given:
    """Return the figures of separator and oil cooler, or the reason why there are none (M280–M285)."""
    oil = problem.scene.oil
    assert problem.parts.oil is not None and oil is not None
    T = problem.parts.oil.temperature
    found = {"oil_supply_temperature": float(T)}
    if isinstance(circuit, str):
        return found | dict.fromkeys(OF_SEPARATOR, circuit)
    parted, volume = circuit.parted, circuit.outflow.oil_flow / oil.at(T).density
    load = NO_LOAD if parted.load is None else parted.load
    values = parted.T_mixture, parted.T_separator, parted.duty, circuit.residual, volume, load
    return found | dict(zip(OF_SEPARATOR, values, strict=True))


def _shut(problem: Problem, turn: Turn | None) -> bool:
    """Return whether a check valve stays shut, so that nothing comes in from the suction line but rounding.

    A shut discharge line has that effect where the gas has no other way out.
    """
    lines = [part for part in problem.parts.pulsations if part.to == SUCTION or not problem.parts.plenums]
    return turn is not None and any(part.shut is not None and part.shut(turn) for part in lines)


def _of_plenums(of: Evaluation, sucked: float, about: dict[str, Figure]) -> Given:
    """Return the figures of effects with own plenums; `sucked` [kg/life], net."""
    found, problem, parts = {}, of.problem, of.problem.parts
    gas, energy = of.streams[:, slots.OF_GAS], of.streams[:, slots.OF_ENERGY]
    suction = sucked * problem.rate * (1.0 - problem.suction.returned)
    why = "" if suction > 0.0 else performance.NONE_DELIVERED
    for name, plenum in parts.all(Plenum):
        if plenum.figures is None:
            continue
        i, state = 2 * parts.number(plenum.name), parts.plenums[plenum.name]
        site = build_site(problem.scene, parts.gas)
        brought = float(gas[i + 1] * state.h - energy[i + 1]) * problem.rate
        drawn = Drawn(float(gas[i] + gas[i + 1]) * problem.rate, suction, state, site, brought)
        given = performance.effect_figures(plenum.figures(drawn), name, why)
        about |= figures_declared_elsewhere(name, problem.scene.effects[name].effect, given)
        found |= given
    return found
