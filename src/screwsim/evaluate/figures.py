"""The performance figures of a closed cycle that its scene calls for."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.build import build_site
from screwsim.cycle import suction_line
from screwsim.cycle.balances import heat_flowing_back, outflow_dissolved_gas, walls_of
from screwsim.cycle.powers import brought_by_oil
from screwsim.cycle.problem import Problem
from screwsim.effects import having
from screwsim.effects.base import DISCHARGE, SUCTION, Drawn, FlowPath, Given, Plenum, Separator
from screwsim.effects.parts.usual import SLIDES
from screwsim.evaluate import humidity, performance
from screwsim.evaluate.package import without_delivery
from screwsim.evaluate.separator import Circuit
from screwsim.figures import Performance, figures_declared_elsewhere
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
    problem, parts, shaft = of.problem, of.problem.parts, of.powers.shaft
    about: dict[str, Figure] = dict(problem.called)  # joined by figures whose declaration an effect borrows
    reach_station()
    found: dict[str, Any] = {**of.powers.losses, **_of_machine(of)}
    found |= {"indicated_power": of.powers.gas, "shaft_power": shaft, "shaft_torque": shaft / parts.omega}
    notes = dict(WHY_NONE)

    def take(given: Given) -> None:
        own, reasons = performance.parted(given)
        found.update(own)
        notes.update(reasons)

    take(performance.efficiencies(parts.gas, problem.lines, problem.inlet, of.gas_flow, shaft, of.products))
    reach_station()
    if parts.oil is not None:
        found |= _of_oil(of) | {"oil_lift_power": of.powers.lift}
    if of.circuit is not None and parts.all(Separator):
        take(_of_circuit(problem, of.circuit))
    if parts.dissolves:
        found["discharge_dissolved_gas_ratio"] = outflow_dissolved_gas(of.streams)
    take(_of_plenums(of, about))
    reach_station()
    take(humidity.figures(of, found))
    take(performance.refrigeration(found, problem.inlet.density, _refrigerating_effect(problem, found)))
    if problem.refrigerating_effect is not None:
        take(_of_condenser(of, found))
    leaving = None if of.outflow is None else of.outflow.enthalpy
    take(performance.saturation_figures(problem, found, leaving))
    if "intake_pressure" in problem.called:
        found |= {"intake_pressure": problem.suction.pressure, "intake_temperature": _intake_temperature(of)}
    if parts.suction_line:
        found |= _of_suction_line(of)
    if parts.geometry.expands:
        take(_of_expander(of, found))
    if parts.walls:
        found["wall_heat"] = float(walls_of(problem.composition, of.q)[:, 0].sum()) * problem.rate
    take(performance.readings(parts, of.known, found))
    take(without_delivery(problem))
    values = dict(zip(about, map(found.get, about), strict=True))
    none = {name: notes.get(name, NO_REASON) for name, value in values.items() if value is None}
    return Performance(values, about), none


def _of_machine(of: Evaluation) -> dict[str, float | None]:
    """Return the figures that every machine has, besides powers and efficiencies."""
    problem, life, geometry = of.problem, of.life, of.problem.parts.geometry
    parts, lines, rate = problem.parts, problem.lines, problem.rate
    return {
        "volumetric_efficiency": of.gas_flow / (problem.inlet.density * geometry.swept_volume * rate),
        "gas_mass_flow": of.gas_flow,
        "discharge_temperature": None if of.outflow is None else parts.gas.temperature(lines.p_d, of.outflow.enthalpy),
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


def _of_expander(of: Evaluation, found: dict[str, Any]) -> Given:
    """Return the figures that an expander has in place of a compressor's."""
    problem, geometry, closes = of.problem, of.problem.parts.geometry, of.problem.parts.geometry.inlet_closes
    filled = None if closes is None else problem.inlet.density * of.life.volume(closes)  # where the inlet closes
    filled = None if filled is None else filled * problem.parts.omega / geometry.pitch
    own = of.gas_flow * (problem.h_isentropic - problem.inlet.enthalpy)
    work = problem.parts.gas.isentropic_work_of_enthalpy  # of what own plenums add; negative for what expands (M101)
    power = own + sum(net * work(state.p, problem.lines.p_d, state.h) for net, state in of.products)
    if problem.parts.oil is not None:
        power -= brought_by_oil(problem, of.known)
    T_oil = problem.lines.T_s if problem.parts.oil is None else problem.parts.oil.temperature
    kept = problem.parts.suction_line  # the line brings the heat again
    back = {"inlet_backflow_heat": 0.0 if kept else heat_flowing_back(problem, of.streams, T_oil)}
    return {**performance.figures_of_expander(found, power, filled), **back}


def _of_oil(of: Evaluation) -> dict[str, float | None]:
    """Return the figures of the oil; its ratio is that at the injection angle, or at the end of a port's injection."""
    parts, life, known = of.problem.parts, of.life, of.known
    flow, port = of.gas_flow, parts.oil_port
    ratio = known.oil_mass_flow / flow if flow > 0.0 else math.inf
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
    problem, suction = of.problem, of.problem.suction
    if problem.parts.suction_line:
        return problem.parts.gas.temperature(suction.pressure, float(of.life.R[slots.R_SUCTION + slots.ENTHALPY]))
    return suction.temperature(suction.port_state(of.h_d), problem.lines.T_s)


def _of_suction_line(of: Evaluation) -> dict[str, float]:
    """Return the flows back to the suction line, and the leaks to it that bypass the chambers (M270, M274)."""
    problem, rate, R = of.problem, of.problem.rate, of.life.R
    back, leak = suction_line.backflow(problem, R, of.streams), of.leak
    heat = suction_line.suction_heat(problem, of.powers.shaft)
    warmed = float(R[slots.R_SUCTION + slots.ENTHALPY]) - problem.suction.port_state(of.h_d)[slots.ENTHALPY]
    return {
        "returned_gas_flow": back.gas * rate,
        "returned_oil_flow": back.oil * rate,
        "returned_heat": of.fresh_gas * warmed * rate - heat if of.fresh_gas > 0.0 else 0.0,
        "shaft_leakage_gas_flow": leak.gas * rate,
        "shaft_leakage_oil_flow": leak.oil * rate,
    }


def _of_condenser(of: Evaluation, found: Mapping[str, Any]) -> Given:
    """Return the heat that all gas gives off in the condenser, and its ratio to the shaft power (M410)."""
    problem = of.problem
    condensed = of.gas_flow + sum(net for net, _ in of.products)
    beyond = performance.beyond_suction_gas(problem.scene, problem.inlet.enthalpy, of.products)
    if not isinstance(beyond, str):
        beyond -= sum(found.get(part.lacking) or 0.0 for _, part in problem.parts.all(Plenum))
    return performance.heating(found, condensed, _condenser_heat(of), beyond)


def _condenser_heat(of: Evaluation) -> float | str:
    """Return the heat that a kilogram of gas gives off in the condenser [J/kg] (M410), or why there is none.

    The gas comes from the separator, or without one from the chambers.
    """
    problem, circuit = of.problem, of.circuit
    effect, parted = problem.refrigerating_effect, problem.parts.all(Separator)
    if isinstance(circuit, str) and parted:
        return circuit
    if of.outflow is None or effect is None:
        return performance.NONE_LEAVES
    h = of.outflow.enthalpy
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


def _of_plenums(of: Evaluation, about: dict[str, Figure]) -> Given:
    """Return the figures of effects with own plenums; add the declarations that they borrow to `about`."""
    found, problem, parts = {}, of.problem, of.problem.parts
    why = "" if of.gas_flow > 0.0 else performance.NONE_DELIVERED
    for name, plenum in parts.all(Plenum):
        if plenum.figures is None:
            continue
        back, state = of.streams[2 * parts.number(plenum.name) + 1], parts.plenums[plenum.name]
        brought = float(back[slots.OF_GAS] * state.h - back[slots.OF_ENERGY]) * problem.rate
        site = build_site(problem.scene, parts.gas)
        drawn = Drawn(of.drawn[plenum.name], of.gas_flow, state, site, brought)
        given = performance.effect_figures(plenum.figures(drawn), name, why)
        about |= figures_declared_elsewhere(name, problem.scene.effects[name].effect, given)
        found |= given
    return found
