"""Performance figures of a cycle: flows, powers, efficiencies, and saturation temperatures of both lines.

A text in place of a figure's value is the reason why there is none.
Source: docs/model.md M25–M36, M43–M45, M151, M152, M410, M411, M491.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.cycle.cycle_figures import CycleFigures
from screwsim.cycle.problem import Inlet, Problem
from screwsim.effects.base import Given, Reading
from screwsim.fluid import constants
from screwsim.fluid.gas import Gas
from screwsim.fluid.models import condenses
from screwsim.fluid.reservoir import Reservoir
from screwsim.inputs.faults import UsageError, checked_own_number
from screwsim.model.parts import Parts
from screwsim.numerics.frozen import with_changes
from screwsim.scene.lines import Lines, suction_enthalpy
from screwsim.scene.types import Scene

WET = "the intake is wet"
QUALITY = "discharge_quality"
MOTOR_POWER = "motor_power"
NO_POWER = "the shaft power is not positive"
NONE_LEAVES = "nothing flows out to the discharge line"
NONE_DELIVERED = "no net gas is delivered: the machine leaks more than it takes in"


def efficiencies(
    gas: Gas, lines: Lines, inlet: Inlet, flow: float, shaft_power: float, drawn: Sequence[tuple[float, Reservoir]] = ()
) -> Given:
    """Return isothermal and isentropic efficiency (M35, M36).

    `drawn` holds the net flow [kg/s] and the state of each own plenum: their ideal powers add to that of the suction
    gas (M101).
    """
    names = ("isothermal_efficiency", "ideal_isothermal_efficiency", "isentropic_efficiency")
    if flow <= 0.0 or shaft_power <= 0.0:
        return dict.fromkeys(names, NONE_DELIVERED if flow <= 0.0 else NO_POWER)
    wet = None if lines.quality is None else inlet.enthalpy
    works, obstacle = _ideal_works(gas, lines.p_s, lines.p_d, lines.T_s, wet, wet is not None)
    powers = [None if work is None else flow * work for work in works]
    for net, state in drawn:
        others, reason = _ideal_works(gas, state.p, lines.p_d, state.T, state.h)
        powers = [None if a is None or b is None else a + net * b for a, b in zip(powers, others, strict=True)]
        obstacle = obstacle or reason
    return {name: obstacle if power is None else power / shaft_power for name, power in zip(names, powers, strict=True)}


@lru_cache(maxsize=128)
def _ideal_works(
    gas: Gas, p: float, p_d: float, T: float, h: float | None, wet: bool = False
) -> tuple[tuple[float | None, float, float], str | None]:
    """Return isothermal, ideal isothermal and isentropic work [J/kg] (M49), and why there is no isothermal one.

    They are those from p [Pa] and T [K] to p_d; the isentropic one starts from the enthalpy h [J/kg] where it is given.
    """
    ideal = gas.ideal_isothermal_work(p, p_d, T)
    isentropic = gas.isentropic_work(p, p_d, T) if h is None else gas.isentropic_work_of_enthalpy(p, p_d, h)
    if wet:
        return (None, ideal, isentropic), WET
    return (gas.isothermal_work(p, p_d, T), ideal, isentropic), gas.isothermal_obstacle(p, p_d, T)


def parted(given: Given) -> tuple[dict[str, Any], dict[str, str]]:
    """Return figures with None in place of each text, and these texts: the reasons why there is no value."""
    reasons = {name: value for name, value in given.items() if isinstance(value, str)}
    return {**given, **dict.fromkeys(reasons)}, reasons


def refrigeration(found: Mapping[str, Any], rho_s: float, effect: float | None) -> Given:
    """Return specific power and the figures of cooling (M43–M45).

    `rho_s` is the gas model's density in the suction line [kg/m³], `effect` the refrigerating effect [J/kg], None
    where the scene calls for no figures of cooling.
    """
    flow, power = found["gas_mass_flow"], found["shaft_power"]
    names = ("specific_power", *(("cooling_capacity", "cop", "volumetric_cooling_capacity") if effect else ()))
    if flow <= 0.0:
        return dict.fromkeys(names, NONE_DELIVERED)
    specific = {"specific_power": power * rho_s / flow}
    if effect is None:
        return specific
    cop = flow * effect / power if power > 0.0 else NO_POWER
    return specific | dict(zip(names[1:], (flow * effect, cop, rho_s * effect), strict=True))


def beyond_suction_gas(scene: Scene, h_s: float, drawn: Sequence[tuple[float, Reservoir]]) -> float | str:
    """Return the heat [W] that gas of own plenums gives off beyond as much suction gas (M410), or why it is unknown.

    `h_s` is the enthalpy of the suction gas by the gas model [J/kg], `drawn` as in `efficiencies`. Nothing for a model
    that has the real fluid's enthalpies.
    """
    if not drawn or condenses(scene.gas):
        return 0.0
    try:
        sucked = suction_enthalpy(scene)
        real = [constants.vapour_enthalpy(scene.gas.name, state.p, state.T) - sucked for _, state in drawn]
    except UsageError as error:
        return str(error)
    return sum(net * (rise - (state.h - h_s)) for (net, state), rise in zip(drawn, real, strict=True))


def heating(found: Mapping[str, Any], condensed: float, rejected: float | str, beyond: float | str = 0.0) -> Given:
    """Return the heat given off in the condenser [W] and its ratio to the shaft power (M410).

    `condensed` [kg/s] is all gas that reaches the condenser, `rejected` the heat given off by a kilogram of suction gas
    [J/kg], `beyond` [W] what gas of own plenums gives off beyond that; each may be the reason why there is none.
    """
    power, names = found["shaft_power"], ("heating_capacity", "heating_cop")
    if isinstance(rejected, str) or isinstance(beyond, str):
        return dict.fromkeys(names, rejected if isinstance(rejected, str) else beyond)
    if condensed <= 0.0:
        return dict.fromkeys(names, NONE_DELIVERED)
    capacity = condensed * rejected + beyond
    return dict(zip(names, (capacity, capacity / power if power > 0.0 else NO_POWER), strict=True))


def effect_figures(given: Given, effect: str, why: str = "", finite: bool = True) -> Given:
    """Return the figures that an effect gives, with a reason for each that it gives neither a value nor a reason.

    Raises Impossible for a figure that is not a number, unless `finite` is False.
    """
    none = why or f"effects.{effect} finds no value in this cycle"
    found = {name: value or none if isinstance(value, str | None) else value for name, value in given.items()}
    for name, value in found.items():
        if finite:
            checked_own_number(effect, f"its figure {name}", 0.0 if isinstance(value, str) else value)
    return found


def readings(parts: Parts, known: CycleFigures, found: Mapping[str, Any]) -> Given:
    """Return the figures that effects read from the closed cycle; all other figures are known by then."""
    given: dict[str, float | str | None] = {}
    of_motor_first = sorted(parts.all(Reading), key=lambda each: MOTOR_POWER not in each[1].figures)  # others read it
    for name, part in of_motor_first:
        values, _ = parted(given)
        read = part.read(with_changes(known, found={**found, **values}))
        given |= effect_figures(read, name, finite=bool(np.isfinite(known.indicated_power)))
    return given


def judge_readings(parts: Parts, known: CycleFigures, found: Mapping[str, Any]) -> tuple[str, tuple[str, ...]]:
    """Return why effects that read the cycle reject it (empty: none does), and their warnings."""
    complete = with_changes(known, found=found)
    told = [part.judge(complete) for _, part in parts.all(Reading) if part.judge is not None]
    return next((why for why, _ in told if why), ""), tuple(each for _, warnings in told for each in warnings)


NO_MEANING = {
    "isothermal_efficiency": "it applies to compression only",
    "ideal_isothermal_efficiency": "it applies to compression only",
    "volumetric_efficiency": "an expander is filled at the pressure of its inlet: see filling_factor",
    "specific_power": "an expander consumes no power",
    "peak_pressure": "an expander's pressure is highest at its inlet",
}


def figures_of_expander(found: Mapping[str, Any], isentropic_power: float, filled: float | None) -> Given:
    """Return the figures of an expander in place of a compressor's.

    `isentropic_power` [W], negative, of the net gas flow, of what own plenums add (M151) and of oil that comes with the
    gas (M491); `filled` [kg/s]: flow that fills the chambers where the inlet closes, None without an inlet port.
    """
    flow, shaft = float(found["gas_mass_flow"]), float(found["shaft_power"])
    changed: dict[str, float | str] = {**NO_MEANING, "output_power": -shaft}
    if flow <= 0.0:
        none = "no net gas flows through the expander"
        return changed | dict.fromkeys(("isentropic_efficiency", "filling_factor"), none)
    no_port = "the machine has no port whose closing ends the filling (name machine.discharge_port)"
    changed["filling_factor"] = no_port if filled is None else flow / filled
    no_power = "the shaft gives no power: the losses exceed what the gas gives"
    if isentropic_power >= 0.0:
        no_power = "gas pushed back into plenums takes more than the rest can give"
    gives = shaft < 0.0 and isentropic_power < 0.0
    changed["isentropic_efficiency"] = shaft / isentropic_power if gives else no_power
    return changed


def saturation_figures(problem: Problem, found: Mapping[str, Any], leaving: float | None) -> Given:
    """Return saturation temperatures and superheats [K] and the quality at discharge, as called for.

    `found` has the discharge temperature; `leaving` is the mean enthalpy [J/kg] of what flows out, None for nothing.
    """
    if "suction_superheat" not in problem.called:
        return {}
    lines, fluid = problem.lines, problem.scene.gas.name
    dew_s, bubble_s, why_s = _saturated(fluid, lines.p_s)
    dew_d, bubble_d, why_d = _saturated(fluid, lines.p_d)
    T_d, blend = found["discharge_temperature"], "condensing_bubble_temperature" in problem.called
    at_suction = WET if lines.quality is not None else why_s if dew_s is None else lines.T_s - dew_s
    values: dict[str, float | str] = {
        "evaporating_temperature": dew_s or why_s,
        "condensing_temperature": (dew_d if blend else bubble_d) or why_d,
        "suction_superheat": at_suction,
        "discharge_superheat": why_d if dew_d is None else NONE_LEAVES if T_d is None else T_d - dew_d,
    }
    if QUALITY in problem.called:
        none = why_d if dew_d is None else NONE_LEAVES
        values[QUALITY] = none if dew_d is None or leaving is None else _quality(fluid, lines.p_d, leaving)
    if blend:
        values["evaporating_bubble_temperature"] = bubble_s or why_s
        values["condensing_bubble_temperature"] = bubble_d or why_d
    return values


def _quality(fluid: str, p: float, h: float) -> float:
    """Return the mass share of vapour of a pure fluid at p [Pa] and an enthalpy h [J/kg] (M411); at most 1."""
    liquid, vapour = (constants.wet_enthalpy(fluid, p, share) for share in (0.0, 1.0))
    return min((h - liquid) / (vapour - liquid), 1.0)


@lru_cache(maxsize=64)
def _saturated(fluid: str, p: float) -> tuple[float | None, float | None, str]:
    """Return dew and bubble point [K] at a pressure [Pa] (equal unless the fluid glides), or why there are none."""
    try:
        known = constants.limits(fluid)
        if known is not None and (known.gas_only or p < known.p_critical):
            return constants.saturation_temperature(fluid, p), constants.boiling_temperature(fluid, p), ""
    except UsageError as error:
        return None, None, str(error)
    return None, None, f"{fluid} at {p / 1e5:.4g} bar is above its critical pressure"
