"""A screw compressor of a refrigeration plant or a heat pump: that of configs/r134a/compact.yaml in another size."""

import math
from dataclasses import replace
from typing import NamedTuple

from screwsim.build import build_parts
from screwsim.fluid import constants
from screwsim.fluid.composition import ENDING, is_blend
from screwsim.fluid.description import describe
from screwsim.fluid.oils import OILS
from screwsim.fluid.transport import transport
from screwsim.inputs.faults import UsageError
from screwsim.machine.rotors.slide import fitting_slide
from screwsim.outputs.customary import RPM, ZERO_CELSIUS, in_celsius
from screwsim.scene import loads
from screwsim.template import economizer, sizes, texts
from screwsim.template.duty import (
    COPPER_CORROSIVES,
    EFFICIENCIES,
    Duty,
    conditions,
    duty_of,
    is_carbon_dioxide,
    motor_in_gas,
)
from screwsim.template.request import SceneRequest

OIL_COOLED_FROM = 350.0  # [K] after isentropic compression, from which the oil is cooled
LEAVES, ABOVE = 348.15, 35.0  # [K] outlet temperature of gas and oil then, and least margin above condensing
BEYOND_MIXTURE = 15.0  # [K] by which gas that left chambers may at least be hotter than the mixture: assumed
WITHIN = 5.0  # [K] by which gas and oil then stay at least below the end of the oil's data
OIL_WARMING = 25.0  # [K] by which the oil is then warmed
MOST_WARMING_SHARE = 0.75  # of the way from the dew point to the outlet temperature: by how much oil may be warmed
OVER_DEW = 4.0  # [K] margin of oil above condensing where a machine leaks more than those behind EFFICIENCIES
TIGHT, LEAKED = 0.8, 1.3  # eta_s without leaks, and what these take, rather too large: five gases from 40 m³/h ...
CAUTION = 0.82  # of that estimate over the work beyond the built-in ratio: enough in tests/tools/fuzz_new.py --freezers
MOTOR_EFFICIENCY = 0.92  # of a semi-hermetic motor, assumed by the source of validation/bitzer
RISING, THIN, DENSER = 0.9, 3.6, 0.35  # ... by powers of pressure ratio and of density, at least the second [kg/m³]
LEAKY = 0.6  # eta_s below which leaks bring a machine so much oil that its room counts, if the gas is dense
LEAST, TOO_HOT = 0.2, 400.0  # least value of the estimate; [K] leaving a leaky machine, from which its oil is cooled
BORE_OIL_TEMPERATURE = 333.15  # [K] of the oil in its bores
FRICTION, OF_DISPLACED = 0.096, 1.08  # of the indicated power; ratio of that to the theoretical one at 0/40 °C
# ratio of the axial port beside a slide valve, or the machine's, beyond which bores have no port: assumed
LARGEST_BORE_PORT_RATIO = 5.0
STAND_IN, COLDEST_STAND_IN = "R134a", 200.0  # [K] from which its transport properties are taken
# refrigerants of which the curves behind EFFICIENCIES are means
CURVES = ("r134a", "propane", "r290", "n-propane", "r1234yf", "r1234ze(e)", "r1234zee", "r407c")
EQUILIBRIUM = (  # of a fluid that is replaced by its blend
    "# {0} as its blend in equilibrium: what the discharge end keeps condenses as it expands to suction pressure,\n"
    "# which the mixture described as if pure cannot follow. Its condensing temperature is that of the dew point.\n"
)
OILS_FOR = {
    **dict.fromkeys(COPPER_CORROSIVES, "mineral_68"),
    **dict.fromkeys(("propane", "r290", "isobutane", "r600a", "n-butane", "r600", "propylene", "r1270"), "PAG_68"),
}


class Plant(NamedTuple):
    """Defaults of a kind of plant."""

    what: str
    fluid: str
    condition: str
    gives: str


COOLING = Plant("Refrigeration screw", "R134a", "0/40 degC", "cooling")
HEATING = Plant("Heat-pump screw", "R1234ze(E)", "10/65 degC", "heating")


RATED_POWER_SOURCES = ("the next size of IEC 60072-1 above an estimate", "as stated")  # source of the rated power
ABOVE_LOAD = "the next size of IEC 60072-1 above the load found"
DEFAULT_DISPLACEMENT_FLOW = 600.0 / 3600.0  # [m³/s] default displacement


def first_flow(plant: Plant, asked: SceneRequest) -> float:
    """Return the displacement [m³/s] from which a size is sought, as output is nearly proportional to it.

    A stated motor must be able to drive the first size tried.
    """
    if asked.motor is None:
        return DEFAULT_DISPLACEMENT_FLOW
    condition, flow = asked.condition or plant.condition, DEFAULT_DISPLACEMENT_FLOW
    fluid = asked.fluid or plant.fluid
    return flow * asked.motor / _power(fluid, duty_of(fluid, flow, condition, plant.condition), asked)


def scene_of(plant: Plant, asked: SceneRequest, blend_of: str = "") -> str:
    """Return the scene of the compressor of a refrigeration machine or a heat pump.

    `blend_of` is the fluid that was asked for, where its blend takes its place.
    """
    fluid, flow = asked.fluid or plant.fluid, asked.flow or DEFAULT_DISPLACEMENT_FLOW
    duty = duty_of(fluid, flow, asked.condition or plant.condition, plant.condition)
    size = texts.sized(flow, asked.speed or 2950.0 * RPM)
    usual = _usual_ratio(duty)
    oil = asked.oil or OILS_FOR.get(fluid.lower(), "POE_68")
    leaky, in_gas = _leaky_efficiency(fluid, duty, size), motor_in_gas(fluid)
    ratio, separator = _oil_and_separator(fluid, duty, oil, asked.ratio or usual, leaky, in_gas)
    cooled, drop = "discharge_temperature:" in separator.partition("#")[0], duty.p_d - duty.p_s
    if cooled and (blend := _blend_of_wet(fluid, duty, oil)):
        return scene_of(plant, replace(asked, fluid=blend, oil=oil), fluid)
    bore = sizes.bore(ratio * duty.gas_flow, OILS[oil].density_at(BORE_OIL_TEMPERATURE), drop)
    substitute = substitute_properties(fluid, *_reference(duty))
    viscosity = "" if substitute is None else f",\n    gas_viscosity: {1e3 * substitute[1]:.3g} mPa s"
    values = {
        **conditions(duty, fluid),
        **_drive(fluid, asked.load or _power(fluid, duty, asked), asked.motor, asked.load is not None),
        **_supply(ratio, sizes.mm(bore, 2), cooled),
        "bore": sizes.mm(bore, 2),
        "jet": f"{1e-5 * drop:.2g} bar",
        "transport": _transport(fluid, duty, substitute),
        "room": texts.oil_room(duty.p_d) if is_carbon_dioxide(fluid) or leaky < LEAKY else "",
        **texts.machine(size, asked, usual, duty.p_d / duty.p_s),
        "ports": texts.ports(size, viscosity) + texts.shafts(size, viscosity),
        "rests": _evidence_comments(fluid),
        "made": _sizing_comment(asked, plant) + (EQUILIBRIUM.format(blend_of) if blend_of else ""),
        "what": plant.what if asked.stage is None else f"{plant.what}, {'high' if asked.stage.second else 'low'} stage",
        "fluid": fluid,
        # on cooled oil gas may condense
        "two_phase": texts.two_phase(fluid, cooled or (asked.stage is not None and asked.stage.condenses)),
        "oil": oil,
        "separator": separator,
        **_friction(asked.slide),
    }
    text = texts.filled("refrigeration", values)
    if asked.slide:
        ratio = asked.ratio or usual
        values |= texts.machine(size, asked, usual, duty.p_d / duty.p_s, _slide(text, ratio))
        text = texts.filled("refrigeration", values) + texts.filled("slot", {})
    return f"{text}{economizer.entry(text, fluid, duty)}" if asked.economizer else text


def _supply(ratio: float, bore: str, cooled: bool) -> dict[str, str]:
    """Return the entries of the oil's supply.

    Oil that cools must not become less where the gas becomes less, as a fixed ratio would have it.
    """
    if not cooled:
        return {"supply": f"kind: pump, ratio: {ratio:g}", "supplied": "Kilograms of oil per kilogram of gas."}
    told = (
        f"Discharge pressure pushes the oil through two bores, some {ratio:g} kg per kg of gas at this condition.\n"
        "# Where the gas is thinner there is hardly less oil; at a fixed ratio it would no longer cool the gas.\n#"
    )
    return {"supply": f"kind: displacement, orifice_diameter: {bore}, orifice_count: 2", "supplied": told}


def _friction(slide: bool) -> dict[str, str]:
    """Return the entries on friction of bearings, seals and films; with a slide their torque stays at part load."""
    if not slide:
        return {"stays": "", "friction": f"fraction: {FRICTION:g}"}
    fraction = f"{FRICTION * OF_DISPLACED:.3g}"
    of = f"at full load: {fraction} of the theoretical power of the full displacement"
    told = f"\n  # {of}, so that their torque stays constant (M460)"
    return {"stays": told, "friction": f"fraction: {fraction}, of: theoretical_power"}


def _slide(text: str, ratio: float) -> str:
    """Return the lines of a slide valve for the rotors of a machine with the given scene text."""
    profile = build_parts(loads(text)).geometry.profile
    assert profile is not None  # of a family
    axial = max(LARGEST_BORE_PORT_RATIO, ratio)
    angles = (profile.rotors.discharge_angle(each) for each in (min(ratio, 0.5 * axial), axial))
    slide = fitting_slide(profile.rotors, *angles)
    spans = {name: f"{math.degrees(getattr(slide, f'{name}_span')):.0f} deg" for name in ("male", "female")}
    return texts.filled("slide", {"axial": f"{axial:g}", "travel": f"{math.floor(1e3 * slide.travel)} mm", **spans})


def _evidence_comments(fluid: str) -> str:
    """Return the comment lines on the evidence for λ and η_s of the machine."""
    if fluid.lower().removesuffix(ENDING) in CURVES:
        return (
            "Those curves are a mean over five refrigerants including this one;\n"
            "# on R134a at 0/40 degC such machines of 100 to 3000 m^3/h lie within 4 points of their lambda and 6 of "
            "their eta_s.\n"
            "# Single machines of one maker on R134a (validation/hsk) have a lambda up to 10 points higher at 84 to "
            "192 m^3/h\n"
            "# and 50 Hz, 15 at lower speeds, and 2 to 6 lower at 535; their electrical efficiency is up to 9 lower at "
            "50 Hz,\n"
            "# 14 at 25. With `uncertainty: {model: screw_r134a}` added, a run on R134a states that beside both."
        )
    return (
        f"On {fluid} lambda and eta_s rest on the laws and on that fit\n"
        "# (R134a): no measured or rated machine with stated conditions was available for comparison."
    )


def _sizing_comment(asked: SceneRequest, plant: Plant) -> str:
    """Return the comment on the goal by which the size was sought; empty where the size was stated."""
    capacity, motor = (asked.capacity, f"of {plant.gives}"), (asked.motor, "at the shaft, the full load of its motor")
    power, what = {"--capacity": capacity, "--motor": motor}.get(asked.sought, (None, ""))
    by = f"{1e-3 * (power or 0.0):g} kW {what}"
    return f"# Made for {by}: its size was found with the cycle.\n" if what else ""


def _usual_ratio(duty: Duty) -> float:
    """Return the built-in volume ratio for the pressures of a duty, within the range on the market."""
    return sizes.matching(duty.p_d / duty.p_s, duty.k, 0.9)


def _power(fluid: str, duty: Duty, asked: SceneRequest) -> float:
    """Return the estimated shaft power [W], including the gas of an economizer."""
    worse = sizes.beyond_matching(duty.p_d / duty.p_s, duty.k, asked.ratio or _usual_ratio(duty))
    more = economizer.more_power(fluid, duty) if asked.economizer else 1.0
    return duty.gas_flow * more * worse * duty.work / EFFICIENCIES[1]


def _drive(fluid: str, power: float, stated: float | None, found: bool) -> dict[str, str]:
    """Return the motor with the stated rated power [W], or with one chosen for a power [W], estimated or found."""
    rated = sizes.motor_for(power) if stated is None else 1e-3 * stated
    told = "Semi-hermetic, in the suction gas, 92 % efficient as assumed by the source of validation/bitzer"
    motor = f"efficiency: {MOTOR_EFFICIENCY:g}, cooling: suction_gas"
    if not motor_in_gas(fluid):
        told = "Open drive, as ammonia attacks copper: IE3, four poles (IEC 60034-30-1)"
        motor = sizes.motor_efficiency(rated)
    motor = f"{{rated_power: {rated:g} kW, {motor}}}"
    source = ABOVE_LOAD if found else RATED_POWER_SOURCES[stated is not None]
    return {"drive": told, "motor": motor, "rated": source}


def _reference(duty: Duty) -> tuple[float, float]:
    """Return the pressure [Pa] and temperature [K] for the gas properties."""
    return math.sqrt(duty.p_s * duty.p_d), 0.5 * (duty.T_e + duty.more + duty.T_c + 20.0)


def substitute_properties(fluid: str, p: float, T: float) -> tuple[float, float, float] | None:
    """Return conductivity, viscosity and Prandtl number of a substitute gas; None where CoolProp has the fluid's."""
    try:
        transport(fluid, p, T)
        transport(fluid, 1e4, 400.0)
    except UsageError:
        T = max(T, COLDEST_STAND_IN)
        return transport(STAND_IN, min(p, 0.5 * constants.dew_pressure(STAND_IN, min(T, 370.0))), T)
    return None


def _transport(fluid: str, duty: Duty, substitute: tuple[float, float, float] | None) -> str:
    """Return the entries for gas properties around droplets: a state, or numbers of a substitute gas with a comment."""
    if substitute is None:
        p, T = _reference(duty)
        return f"    reference_pressure: {1e-5 * p:.2g} bar\n    reference_temperature: {T:.0f} K\n"
    conductivity, viscosity, prandtl = substitute
    whose = f"these values and the viscosity in the gaps are those of {STAND_IN}"
    lines = (
        f"# CoolProp has no transport properties of {fluid}: {whose}",
        f"gas_conductivity: {conductivity:.3g} W/(m K)",
        f"gas_viscosity: {1e3 * viscosity:.3g} mPa s",
        f"prandtl: {prandtl:.3g}",
    )
    return "".join(f"    {line}\n" for line in lines)


def _blend_of_wet(fluid: str, duty: Duty, oil: str) -> str:
    """Return the blend in equilibrium that takes the place of a mixture described as if pure; '' where none need.

    What is left at the discharge end expands with the chamber to suction pressure: gas from a cooled machine that
    leaves with less entropy than saturated vapour has there condenses, and such a mixture cannot.
    """
    blend = f"{fluid}{ENDING}"
    if is_blend(fluid) or not describe(fluid).glides or not is_blend(blend):
        return ""
    dew = constants.saturation_temperature(fluid, duty.p_d)
    driest = constants.compressed(fluid, duty.p_s, duty.T_e, duty.p_d, 1.0)
    leaving = constants.vapour_enthalpy(fluid, duty.p_d, _outlet(fluid, duty, oil))
    over_dew = leaving - constants.vapour_enthalpy(fluid, duty.p_d, dew)
    return blend if driest is not None and over_dew < driest.over_dew else ""


def _outlet(fluid: str, duty: Duty, oil: str) -> float:
    """Return the temperature [K] at which gas and oil leave a machine whose oil is cooled."""
    limits = constants.limits(fluid)
    assert limits is not None
    hottest = min(OILS[oil].high - WITHIN, limits.T_max - BEYOND_MIXTURE)
    return min(max(LEAVES, duty.T_c + ABOVE), hottest)


def _leaky_efficiency(fluid: str, duty: Duty, size: sizes.Size) -> float:
    """Return an estimate of eta_s of a small or slow machine, whose gaps pass much of its displacement."""
    R, T = constants.gas_constant(fluid), duty.T_e + duty.more
    passed = sizes.GAP * size.clearance * size.diameter * math.sqrt(duty.k * R * T) / size.flow
    passed *= (duty.p_d / duty.p_s) ** RISING
    return TIGHT * max(1.0 - LEAKED * max(duty.p_s / (R * T), THIN) ** DENSER * passed, LEAST)


def _oil_and_separator(
    fluid: str, duty: Duty, oil: str, built_in: float, leaky: float, motor_in_gas: bool
) -> tuple[float, str]:
    """Return oil over gas, and the separator, with a cooler where the gas would get hot without one.

    So much oil is cooled that no gas condenses on it, also where a machine takes more power than estimated. Raise
    UsageError where no oil temperature is both above condensing and within the oil's data.
    """
    T, dew = duty.T_e + duty.more, constants.saturation_temperature(fluid, duty.p_d)
    limits, begins = constants.limits(fluid), constants.vapour_enthalpy(fluid, duty.p_s, T)
    assert limits is not None
    hottest_oil = OILS[oil].high - WITHIN
    hottest = min(hottest_oil, limits.T_max - BEYOND_MIXTURE)
    leaves = _outlet(fluid, duty, oil)
    lossless = constants.compressed(fluid, duty.p_s, T, duty.p_d, 1.0)
    work = duty.work if lossless is None else lossless.work
    work *= sizes.beyond_matching(duty.p_d / duty.p_s, duty.k, built_in)
    usual, most = work / EFFICIENCIES[1], work / (CAUTION * leaky * (MOTOR_EFFICIENCY if motor_in_gas else 1.0))

    def left(work: float, leaving: float) -> float:
        """Return what the oil takes of a work [J/kg] where the gas leaves at a temperature [K]."""
        return work - constants.vapour_enthalpy(fluid, duty.p_d, leaving) + begins

    coldest = OILS[oil].low
    if dew < coldest and left(most, coldest) < 0.0:
        what = f"gas and oil would leave colder than {in_celsius(coldest)}, where the data of {oil} begin"
        raise UsageError(f"--condition: {what} (choose warmer ends, or ends farther apart)")
    if hottest_oil < dew + OVER_DEW and (hottest_oil <= dew or left(usual, hottest_oil) > 0.0):
        ends = f"{oil}, whose data end at {in_celsius(OILS[oil].high)}"
        what = f"condenses at {in_celsius(dew)}; oil so much warmer that nothing condenses on it is too hot for {ends}"
        further = next((f", or write --oil {name}" for name in OILS if OILS[name].high > OILS[oil].high), "")
        remedy = f"condense below {in_celsius(hottest_oil - OVER_DEW)}{further}"
        raise UsageError(f"--condition: {fluid} {what} ({remedy})")
    hot = duty.hottest >= OIL_COOLED_FROM and left(usual, leaves) > 0.0
    too_hot, power = (TOO_HOT, most) if leaves < TOO_HOT else (leaves, work / leaky)
    if not hot and left(power, min(too_hot, hottest)) <= 0.0:
        return 1.0, "separator: {}    # uncooled; cooler: {discharge_temperature: 75 degC} adds a thermostat"
    dry = max(leaves - dew - OVER_DEW, MOST_WARMING_SHARE * (leaves - dew))
    needed = max(left(usual, leaves) / min(OIL_WARMING, dry), left(most, leaves) / dry)
    ratio = max(1.0, math.ceil(2.0 * needed / OILS[oil].heat_capacity_at(leaves)) / 2.0)
    kept = f"cooler: {{discharge_temperature: {leaves - ZERO_CELSIUS:.0f} degC}}"
    return ratio, f"separator: {{{kept}}}    # a thermostat holds the discharge temperature"
