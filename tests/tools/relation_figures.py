"""Identities and bounds of one result's figures: sums, quotients, properties by CoolProp, the second law.

Each law yields how far a figure is off over what may be. `relations.py` asks them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import CoolProp.CoolProp as coolprop
from relating import Case, NotAsked, Pair, exponent, law
from relation_laws import LOSSES

from screwsim.outputs import Result

EXACT = 1e-6  # relative difference of an identity: its terms are rounded, or iterated with their sum
PROPERTY = 1e-5  # the same where one side is CoolProp's
BOUND = 1.0  # of the wanted accuracy: by which a bound may be passed
R = 8.314462618
GIVERS = "wall_heat", "cylinder_heat", "motor"  # of heat that is no shaft power
FITTED = "R404A", "R407C", "R410A", "R507A"  # whose curves of a blend are fitted as those of one fluid (M411)
INFLOW = "suction_throttle", "bypass", "air_package"
FRICTION = "hydromechanical_power", "mechanical_power", "oil_drag_power", "bearing_power"
LAWLESS = "oil_not_conserved"
WARMING = ("separator", "hydromechanical", "mechanical", "oil_pump", "oil_drag", "bearings", "oil_lift", "oil_supply")


def identity(result: Result, what: str, found: Any, own: Any, of: float | None = None, may: float = EXACT) -> Pair:
    """Return how far a figure is from what others make of it, relative to it or to `of`."""
    size = max(abs(own), abs(found)) if of is None else abs(of)
    off = 0.0 if found == own else abs(found - own) / max(size, 1e-300)
    return Pair(f"{what} {found:.9g}, not {own:.9g}", result, result, broken=off / may)


@law
def sums_and_quotients(case: Case) -> Iterator[Pair]:
    """Figures that are sums or quotients of others are that."""
    result, scene = case.result, case.scene
    p = {name: value for name, value in result.performance.items() if value is not None}
    speed = p.get("mean_speed", scene.operation.speed)
    shaft, flow = p["shaft_power"], p["gas_mass_flow"]
    parts = ["indicated_power", "oil_lift_power", *LOSSES.values()]
    sum_of = sum(p.get(name, 0.0) for name in parts)
    yield identity(result, "shaft_power", shaft, sum_of, max(abs(shaft), abs(p["indicated_power"])))
    chambers = p["displacement_flow"] / p["displacement"]
    if scene.machine.kind == "twin_screw":
        chambers = scene.machine.male_lobes * speed / (2.0 * math.pi)
        yield identity(result, "indicated_power", p["indicated_power"], p["work_per_cycle"] * chambers)
    yield identity(result, "shaft_torque", p["shaft_torque"] * speed, shaft)
    yield identity(result, "displacement_flow", p["displacement_flow"], p["displacement"] * speed / (2.0 * math.pi))
    ratio = p["discharge_pressure"] / p["suction_pressure"]
    ratio = 1.0 / ratio if scene.machine.mode == "expander" else ratio
    if "air_package" not in scene.effects:
        yield identity(result, "pressure_ratio", p["pressure_ratio"], ratio)
    quotients = (
        ("cop", "cooling_capacity", "shaft_power"),
        ("heating_cop", "heating_capacity", "shaft_power"),
        ("electrical_cop", "cooling_capacity", "electrical_power"),
        ("electrical_heating_cop", "heating_capacity", "electrical_power"),
        ("oil_flow_ratio", "oil_mass_flow", "gas_mass_flow"),
        ("economizer_flow_ratio", "economizer_mass_flow", "gas_mass_flow"),
        ("liquid_injection_flow_ratio", "liquid_injection_mass_flow", "gas_mass_flow"),
        ("flash_flow_ratio", "flash_mass_flow", "gas_mass_flow"),
        ("package_specific_power", "package_input_power", "free_air_delivered"),
    )
    for name, above, below in quotients:
        if {name, above, below} <= p.keys() and p[below]:
            yield identity(result, name, p[name] * p[below], p[above], max(abs(p[above]), 1e-4 * abs(p[below])))
    if "specific_power" in p and "volumetric_efficiency" in p:
        volume = p["volumetric_efficiency"] * p["displacement_flow"]
        yield identity(result, "specific_power × flow", p["specific_power"] * volume, shaft)
    if "electrical_power" in p:
        electrical = p.get("motor_power", shaft)
        yield identity(result, "electrical_power", p["electrical_power"], electrical + p["motor_loss"])
    if "package_input_power" in p:
        whole = p["electrical_power"] + p.get("fan_power", 0.0)
        yield identity(result, "package_input_power", p["package_input_power"], whole)
        outlet = p["package_discharge_pressure"] + p["package_pressure_loss"]
        yield identity(result, "package_pressure_loss", outlet, p["discharge_pressure"])
    if "output_power" in p:
        yield identity(result, "output_power", p["output_power"], -shaft)
    if {"water_flow", "vapour_flow", "condensate_flow"} <= p.keys():
        whole = p["vapour_flow"] + p["condensate_flow"]
        yield identity(result, "water_flow", whole, p["water_flow"], may=1e-4)
    for start in ("suction", "discharge"):
        if f"{start}_pulsation_peak_to_peak" in p:
            harmonics = [p[f"{start}_pulsation_harmonic_{k}"] for k in (1, 2, 3, 4)]
            most = 0.5 * p[f"{start}_pulsation_peak_to_peak"] * math.sqrt(2.0)
            yield Pair(
                f"{start} harmonics", result, result, broken=_above(math.hypot(*harmonics), most, flow * 0 + most)
            )
    if "gas_torque_mean" in p and "drive" not in scene.effects:
        mean = p["indicated_power"] / speed
        yield identity(result, "gas_torque_mean", p["gas_torque_mean"], mean, may=3.0 * scene.numerics.accuracy)
        if "female_gas_torque" in p:
            z = scene.machine.male_lobes / scene.machine.female_lobes
            both = p["male_gas_torque"] + p["female_gas_torque"] * z
            yield identity(
                result, "torques of the rotors", both, p["gas_torque_mean"], may=3.0 * scene.numerics.accuracy
            )


def _above(found: float, most: float, size: float) -> float:
    return max(found - most, 0.0) / max(1e-3 * abs(size), 1e-300)


@law
def properties(case: Case) -> Iterator[Pair]:
    """Flows, efficiencies and capacities are those of the gas's density and enthalpies by CoolProp."""
    result, scene = case.result, case.scene
    p = {name: value for name, value in result.performance.items() if value is not None}
    fluid = scene.gas.fluid
    if not isinstance(fluid, str) or scene.gas.relative_humidity is not None or case.value("operation.suction.quality"):
        raise NotAsked("no pure gas")
    flow, shaft, T, low, high = (
        p[name]
        for name in ("gas_mass_flow", "shaft_power", "suction_temperature", "suction_pressure", "discharge_pressure")
    )
    try:
        own = R / coolprop.PropsSI("molar_mass", fluid)
    except ValueError:
        raise NotAsked("no pure fluid of CoolProp") from None
    if "ideal_isothermal_efficiency" in p and "economizer" not in scene.effects:
        ideal = flow * own * T * math.log(high / low)
        yield identity(result, "ideal_isothermal", p["ideal_isothermal_efficiency"] * shaft, ideal, may=PROPERTY)
    if scene.gas.model == "ideal":
        density = low / (own * T)
    else:
        try:
            density = _vapour(fluid, low, T).rhomass()
        except ValueError:
            raise NotAsked("CoolProp has no such state") from None
    if "volumetric_efficiency" in p:
        volume = flow / (density * p["displacement_flow"])
        yield identity(result, "volumetric_efficiency", p["volumetric_efficiency"], volume, may=PROPERTY)
    if scene.gas.model == "real" and "isentropic_efficiency" in p and "economizer" not in scene.effects:
        state = _vapour(fluid, low, T)
        h, s = state.hmass(), state.smass()
        try:
            state.update(coolprop.PSmass_INPUTS, high, s)
        except ValueError:
            raise NotAsked("CoolProp finds no such state") from None
        lossless = flow * (state.hmass() - h)
        pair = (lossless, shaft) if scene.machine.mode != "expander" else (-shaft, -lossless)
        yield identity(result, "isentropic_efficiency", p["isentropic_efficiency"] * pair[1], pair[0], may=PROPERTY)
    if "condensing_temperature" in p:
        for name, pressure in (("evaporating", low), ("condensing", high)):
            if f"{name}_temperature" in p and f"{name}_bubble_temperature" not in p and fluid not in FITTED:
                T_sat = coolprop.PropsSI("T", "P", pressure, "Q", 1, fluid)
                yield identity(result, name, p[f"{name}_temperature"], T_sat, may=PROPERTY)
    yield from _capacities(case, p, fluid)


def _vapour(fluid: str, pressure: float, T: float) -> Any:
    state = coolprop.AbstractState("HEOS", fluid)
    state.specify_phase(coolprop.iphase_gas if T < state.T_critical() else coolprop.iphase_supercritical_gas)
    state.update(coolprop.PT_INPUTS, pressure, T)
    return state


def _capacities(case: Case, p: dict[str, float], fluid: str) -> Iterator[Pair]:
    """Yield how far capacities are from flows times differences of enthalpies."""
    if "cooling_capacity" not in p or "economizer" in case.scene.effects:
        return
    low, high, T = p["suction_pressure"], p["discharge_pressure"], p["suction_temperature"]
    operation = case.scene.operation
    try:
        if operation.gas_cooler is not None:
            liquid = coolprop.PropsSI("H", "P", high, "T", operation.gas_cooler.outlet_temperature, fluid)
        else:
            liquid = coolprop.PropsSI("H", "P", high, "Q", 0, fluid)
            if case.value("operation.subcooling"):
                T_c = coolprop.PropsSI("T", "P", high, "Q", 0, fluid) - case.value("operation.subcooling")
                liquid = coolprop.PropsSI("H", "P", high, "T", T_c, fluid)
        vapour = _vapour(fluid, low, T).hmass()
    except ValueError:
        raise NotAsked("CoolProp has no such state") from None
    own = p["gas_mass_flow"] * (vapour - liquid)
    yield identity(case.result, "cooling_capacity", p["cooling_capacity"], own, may=PROPERTY)
    T_d = p.get("separator_temperature")
    if "heating_capacity" in p and T_d is not None and case.scene.gas.model == "real":
        try:
            hot = coolprop.PropsSI("H", "P", high, "T", T_d, fluid)
        except ValueError:
            return
        dissolved = {"refrigerant_solubility", "liquid_injection"} & case.scene.effects.keys()
        if not dissolved:
            gives = p["gas_mass_flow"] * (hot - liquid)
            yield identity(case.result, "heating_capacity", p["heating_capacity"], gives, may=3e-4)


@law
def first_law(case: Case) -> Iterator[Pair]:
    """What a cycle takes up and is driven by, it gives off; so does an air package."""
    result, scene = case.result, case.scene
    p = {name: value for name, value in result.performance.items() if value is not None}
    own = scene.effects.get("separator")
    if own is None:
        raise NotAsked("no separator")
    may = 3.0 * scene.numerics.accuracy
    friction = sum(p.get(name, 0.0) for name in FRICTION)
    lost = own.parameters.ambient_loss + (1.0 - own.parameters.friction_share) * friction
    if {"heating_capacity", "oil_cooler_duty"} <= p.keys() and not {
        "wall_heat",
        "cylinder_heat",
    } & scene.effects.keys():
        motor = p["motor_loss"] if case.value("effects.motor.cooling") == "suction_gas" else 0.0
        given = p["heating_capacity"] + p["oil_cooler_duty"] + lost
        given += sum(p.get(name, 0.0) for name in ("economizer_heat_loss", "liquid_injection_heat_loss"))
        taken = p["cooling_capacity"] + p["shaft_power"] + motor
        yield identity(result, "heat given off", given, taken, p["shaft_power"], may)
    if "package_heat" in p and scene.gas.relative_humidity is None and scene.gas.model == "ideal":
        k = exponent(scene, result)
        c_p = R / coolprop.PropsSI("molar_mass", scene.gas.fluid) * k / (k - 1.0)
        rise = p["gas_mass_flow"] * c_p * (p["package_discharge_temperature"] - p["suction_temperature"])
        heat = p["package_input_power"] - rise
        yield identity(result, "package_heat", p["package_heat"], heat, p["package_input_power"], may)


@law
def packages(case: Case) -> Iterator[Pair]:
    """An air package's flow, isentropic efficiency and specific power are those of ISO 1217."""
    result, scene = case.result, case.scene
    p = {name: value for name, value in result.performance.items() if value is not None}
    if (
        "free_air_delivered" not in p
        or scene.gas.relative_humidity is not None
        or "package_isentropic_efficiency" not in p
    ):
        raise NotAsked("no package of dry air that delivers")
    low, high, T = p["suction_pressure"], p["package_discharge_pressure"], p["suction_temperature"]
    density = low / (R / coolprop.PropsSI("molar_mass", scene.gas.fluid) * T)
    yield identity(result, "free_air_delivered", p["free_air_delivered"] * density, p["gas_mass_flow"], may=1e-4)
    k = 1.4
    work = low * p["free_air_delivered"] * k / (k - 1.0) * ((high / low) ** ((k - 1.0) / k) - 1.0)
    own = p["package_isentropic_efficiency"] * p["package_input_power"]
    yield identity(result, "package_isentropic_efficiency", own, work, may=1e-4)


@law
def second_law(case: Case) -> Iterator[Pair]:
    """Balances close, every effect destroys exergy, and no machine is better than a reversible one."""
    result, scene = case.result, case.scene
    accuracy, ledger = scene.numerics.accuracy, result.ledger
    for name in ("mass", "energy", "oil_mass", "entropy"):
        yield Pair(name, result, result, broken=abs(result.balance.get(name) or 0.0) / result.balance.bound / BOUND)
    T_0 = ledger["ambient_temperature"]
    start = "exergy_destroyed_"
    entries = {name.removeprefix(start): x or 0.0 for name, x in ledger.items() if name.startswith(start)}
    size = abs(ledger["shaft_power"]) + sum(map(abs, entries.values()))
    yield identity(result, "sum of the ledger", ledger["exergy_destroyed"], sum(entries.values()), size, accuracy)
    rises = (ledger["gas_exergy_rise"] or 0.0) + (ledger["oil_exergy_rise"] or 0.0)
    whole = rises + ledger["exergy_destroyed"] + ledger["residue"]
    yield identity(result, "ledger", whole, ledger["shaft_power"], size, EXACT)
    yield Pair("residue", result, result, broken=abs(ledger["residue"]) / (accuracy * size))
    for name, x in entries.items():
        generated = ledger.get(f"entropy_generated_{name}")
        if generated is not None and x and name not in GIVERS and scene.effects.get(name) is not None:
            if name in ("separator", "economizer", "liquid_injection", "plenums", "suction_line"):
                continue  # heat leaves with them, or comes
            yield identity(result, f"exergy of {name}", x, T_0 * generated, size, accuracy)
    if "separator" in entries:  # losses have booked the heat that it gets from them as dissipated (M286)
        entries["separator and losses"] = sum(entries.pop(name, 0.0) for name in WARMING)
    p_flow = result.performance.gas_mass_flow or 0.0
    for name, x in entries.items():
        may_gain = name in GIVERS or name.endswith("_plenum") or name == LAWLESS
        if name in (*INFLOW, "discharge_line") and p_flow <= 0.0:
            continue  # for inflow alone, as a warning says
        if name == "oil_cooler" and (result.performance.get("oil_supply_temperature") or T_0) < T_0:
            continue  # its coolant is colder than the surroundings
        if not may_gain and not (name == "suction_line" and name not in scene.effects):
            words = f"{name} destroys {x:.6g} W of {size:.6g}"
            yield Pair(words, result, result, broken=max(-x, 0.0) / (accuracy * size * BOUND))


@law
def bounds(case: Case) -> Iterator[Pair]:
    """Efficiencies, COPs, pressures and temperatures lie within what physics allows."""
    result, scene = case.result, case.scene
    p = {name: value for name, value in result.performance.items() if value is not None}
    accuracy = 3.0 * scene.numerics.accuracy
    dry = (
        scene.oil is None
        and not {"liquid_injection", "cylinder_heat", "wall_heat", "economizer"} & scene.effects.keys()
    )
    if dry and "isentropic_efficiency" in p and p["gas_mass_flow"] > 0.0:
        most = 1.0
        yield _bound(result, "isentropic_efficiency", p["isentropic_efficiency"], most, accuracy)
    if "motor_efficiency" in p:
        yield _bound(result, "motor_efficiency", p["motor_efficiency"], 1.0, 1e-9)
    if {"cop", "evaporating_temperature", "condensing_temperature"} <= p.keys():
        cold, warm = p["evaporating_temperature"], p["condensing_temperature"]
        oil = case.value("oil_supply.temperature") or warm
        if min(oil, warm) > cold and "separator" not in scene.effects:
            sink = min(oil, warm) if scene.oil is not None else warm
            carnot = max(cold, p["suction_temperature"]) / max(1e-9, sink - max(cold, p["suction_temperature"]))
            if sink > p["suction_temperature"]:
                yield _bound(result, "cop", p["cop"], carnot, accuracy * carnot)
    if p["gas_mass_flow"] > 0.0 and scene.machine.mode == "compressor" and "peak_pressure" in p:
        least = min(p["suction_pressure"], p["discharge_pressure"])
        yield _bound(result, "peak_pressure", least * 0.2, p["peak_pressure"], accuracy * least)


def _bound(result: Result, what: str, found: float, most: float, may: float) -> Pair:
    return Pair(f"{what} {found:.9g}, at most {most:.9g}", result, result, broken=max(found - most, 0.0) / may)
