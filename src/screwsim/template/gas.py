"""Screws on gases: what their texts have in common, and an air package."""

import math
import re
import textwrap
from typing import NamedTuple

from screwsim.effects.oil_drag import end_drag, tip_drag
from screwsim.fluid import constants
from screwsim.fluid.oils import OILS
from screwsim.inputs.faults import UsageError
from screwsim.machine.rotors.settings import FAMILIES
from screwsim.outputs.customary import RPM, ZERO_CELSIUS, in_bar
from screwsim.scene.units import NUMBER, is_gauge
from screwsim.template import sizes, texts
from screwsim.template.request import ATMOSPHERE, Condition, SceneRequest, condition_of, quantity_after_comma

LAMBDA, ETA = 0.90, 0.78  # for estimates of flow and power
THINNEST_AIR = 0.3e5  # [Pa] least inlet pressure of an air package: 0.34 bar on the highest mountain
DENSEST_AIR = 1.2e5  # [Pa] ambient pressure at the most, that of a mine of 1.5 km
AIR_OIL = 4.0  # least kg of oil per kg of air, warmed by some 30 K (validation/cagi)
LARGEST_OIL_WARMING = 40.0  # [K] most by which the oil of an air package is warmed: assumed
ROOM, ROOM_RESERVE = 303.15, 5.0  # [K] room in which its cooler keeps LEAVES, this far above the inlet at least ...
LARGEST_EFFECTIVENESS = 0.9  # ... as far as this suffices, for which 2.3 transfer units are needed: assumed
LEAVES, WARMED = 353.15, 30.0  # [K] temperature at a booster's outlet, and by how much its oil is warmed
VALVE_OPENING_PRESSURE = 4e5  # [Pa] above ambient, below which a package's minimum-pressure valve stays shut ...
SHUT_SHARE = 0.8  # ... of the rise at the most: a valve that opens above it holds the machine at its own pressure
LOST_BEFORE, LOST_BEHIND = 3.5e3, 36e3  # [Pa]: filter and valve; separator, valve and aftercooler of air.template
COOLED, BROUGHT = 0.97, 1.1  # efficiency without friction with oil cooling; friction over that of films: estimates
FAN_SHARE = 0.04  # of the motor
BELTED = 22.0  # [kW] largest motor with V-belts, assumed: makers' small packages have them (Kaeser, manual of ASK T)
GEARS = "0.01", "gears, typical"  # share of the indicated power, and comment
WARM_BELTS = ", friction_share: 0.34"  # of bearings' friction in that of bearings and belts, at 100 and 200 m³/h
BELTS = "0.044", "V-belts, 3.5 % of the shaft power (Gates: 2 to 5 %), which heats no oil"
INVERTER_LOSS_SHARE = 0.03  # of the motor, lost by an inverter at its class's point: 97 % as in configs/air, assumed
SPEEDS = 1.0, 0.86, 0.73, 0.59, 0.46, 0.32  # of full speed, on the sheet of a variable-speed package
COMMENT_WIDTH = 110  # columns of a comment
ABOVE_DEW = 10.0  # [K] margin of the separator, or of gas at the inlet, above the dew point
HUMID = "    # relative_humidity: 0.6 adds the water in the air (docs/how-to/moist-air.md)"
FILTER = "    inlet_filter: {pressure_loss: 20 mbar}\n"
BEHIND = (  # parts of a package behind its machine
    "    separator_element: {{pressure_loss: 172 mbar}}\n"
    "    minimum_pressure_valve: {{pressure_loss: 50 mbar, pressure: {least}}}\n"
    "    aftercooler: {{pressure_loss: 138 mbar, approach: 10 K{coolant}}}\n"
)
FAN = "    fan: {{power: {power}{control}}}    # 4 % of {of} (validation/cagi/sheet.csv)\n"
SOLIDITY = 0.63  # of end faces, as in the text of flooded machines


class Duty(NamedTuple):
    """The lines of a condition, and estimates of the gas between them, in SI units."""

    at: Condition
    temperature: str
    T: float
    k: float
    R: float

    @property
    def ratio(self) -> float:
        """The higher pressure over the lower."""
        return max(self.at.high, self.at.low) / min(self.at.high, self.at.low)

    @property
    def density(self) -> float:
        """Density of the incoming gas."""
        return self.at.low / (self.R * self.T)

    @property
    def work(self) -> float:
        """Lossless work of compression or expansion."""
        return abs(sizes.isentropic_work(self.k, self.R, self.T, self.at.high / self.at.low))


def gas_duty(
    asked: SceneRequest,
    fluid: str,
    example: str,
    temperature: str,
    expands: bool = False,
    ambient: float = ATMOSPHERE,
) -> Duty:
    """Return the lines of a condition; an unstated temperature is the default, or 10 K above the dew point.

    Gauge pressures are over the ambient one [Pa].
    """
    if told := _temperatures(asked.condition, fluid, example):
        raise UsageError(f"--condition {asked.condition}: {told}")
    at = condition_of(asked.condition or example, "pressure", example, ambient)
    low, high = (at.high, at.low) if expands else (at.low, at.high)
    if not low < high:
        order = "suction comes first, below discharge"
        order = "an expander's inlet comes first, above its outlet" if expands else order
        raise UsageError(f"--condition {asked.condition}: {order} (write e.g. --condition '{example}')")
    text, T = quantity_after_comma(at, "temperature", temperature)
    boils = constants.liquid_below(fluid, at.low, T)
    if boils is not None:
        dry = f"{5.0 * math.ceil((boils + ABOVE_DEW - ZERO_CELSIUS) / 5.0):g} degC"
        if at.beside:
            limits, below = constants.limits(fluid), f"{boils - ZERO_CELSIUS:.4g} degC"
            gas_only = limits is not None and limits.gas_only
            why = f"is known as a gas only above {below}" if gas_only else f"of {at.low_text} is liquid below {below}"
            what = f"{fluid} {why}"
            pair = (asked.condition or example).partition(",")[0].strip()
            raise UsageError(f"--condition {asked.condition}: {what} (write e.g. --condition '{pair}, {dry}')")
        text, T = quantity_after_comma(at, "temperature", dry)  # the default is too cold
    return Duty(at, text, T, constants.isentropic_exponent(fluid, T), constants.gas_constant(fluid))


def _temperatures(condition: str | None, fluid: str, example: str) -> str:
    """Return that a condition states saturation temperatures, with the pressures to write; empty for any other."""
    try:
        at = condition_of(condition or example, "temperature", example)
        pressures = [constants.dew_pressure(fluid, T) for T in (at.low, at.high)]
    except UsageError:
        return ""
    first, second = (f"{p / 1e5:.4g}" for p in pressures)
    warm = f"{at.low - ZERO_CELSIUS + ABOVE_DEW:.4g} degC"
    what = f"these are temperatures, where {fluid} has these saturation pressures"
    return f"{what} (write e.g. --condition '{first}/{second} bar, {warm}', with the temperature of the gas)"


def common_values(asked: SceneRequest, duty: Duty, size: sizes.Size, share: float) -> dict[str, str]:
    """Return the machine, with `share` of the built-in ratio of an ideal gas, and the lines of a condition."""
    return {
        **texts.machine(size, asked, sizes.matching(duty.ratio, duty.k, share), duty.ratio),
        "low": duty.at.low_text,
        "high": duty.at.high_text,
        "temperature": duty.temperature,
    }


def motor_values(rated: float) -> dict[str, str]:
    """Return what a scene states about a motor of the rated power [kW]."""
    return {"rated": f"{rated:.6g} kW", "efficiency": sizes.motor_efficiency(rated)}


def air_duty(asked: SceneRequest) -> Duty:
    """Return the lines of an air package; raise UsageError for a condition that is none of one."""
    if asked.molar is not None:
        what = "a package delivers free air, at the state of its inlet"
        raise UsageError(f"--flow {asked.flow_text}: {what} (write e.g. --flow '7.5 m^3/min')")
    duty = gas_duty(asked, "Air", "0 bar(g)/7.5 bar(g)", "20 degC")
    if duty.at.low < THINNEST_AIR:
        what = f"an air package draws in ambient air, not {1e-5 * duty.at.low:.3g} bar"
        raise UsageError(f"--condition {asked.condition}: {what} (write screwsim new booster --fluid Air)")
    ambient = ambient_of(duty.at) if asked.stage is None else asked.stage.ambient
    return gas_duty(asked, "Air", "0 bar(g)/7.5 bar(g)", "20 degC", ambient=ambient)


def ambient_of(at: Condition) -> float:
    """Return the ambient pressure [Pa] of a package: that of its inlet, where it is stated as an absolute one."""
    return ATMOSPHERE if is_gauge(at.low_text) or at.low > DENSEST_AIR else at.low


def first_flow(asked: SceneRequest) -> float:
    """Return the approximate displacement [m³/s] of an air package for the stated delivery, or for full motor load."""
    duty = air_duty(asked)
    if asked.free_air is None and asked.motor is not None:
        return asked.motor * ETA / (duty.work * LAMBDA * duty.density)
    return (asked.free_air or 0.0) / LAMBDA


def air(asked: SceneRequest) -> str:
    """Return the scene of an oil-flooded air package."""
    if (asked.fluid or "Air").lower() != "air":
        raise UsageError(f"--fluid {asked.fluid}: an air package compresses air (write screwsim new booster for a gas)")
    flow, speed, oil = asked.flow or 1200.0 / 3600.0, asked.speed or 2950.0 * RPM, asked.oil or "mineral_46"
    size, duty = texts.sized(flow, speed), air_duty(asked)
    gas_flow, drop = LAMBDA * flow * duty.density, duty.at.high - duty.at.low
    worse = sizes.beyond_matching(duty.ratio, duty.k, asked.ratio)
    friction = BROUGHT * film_friction(size, oil)
    taken = max(gas_flow * worse * duty.work / ETA, gas_flow * worse * _package_work(duty) + friction)
    carried = _oil_per_air(duty, taken / gas_flow, oil)
    oil_capacity = carried * gas_flow * _oil_heat_capacity(oil)
    room, ambient = _surroundings(asked, duty)
    gas_capacity = gas_flow * heat_capacity(duty)
    warm = gas_capacity * max(duty.T - room, 0.0) if asked.stage is not None else 0.0  # as if it entered from the room
    cooler = _oil_cooler(room, taken + warm, gas_capacity, oil_capacity)
    delivered = (asked.free_air or LAMBDA * flow) / (LAMBDA * flow)  # of the estimated flow, where it is stated
    rated = _rated_power(asked, min(delivered, 1.0) * taken)
    displaced = [] if asked.by_sheet else [f"{sizes.flow_text(flow)} at {sizes.rpm(speed)}"]
    outside = duty.at.low if asked.stage is None else ambient
    least = outside + min(VALVE_OPENING_PRESSURE, SHUT_SHARE * (duty.at.high - outside))
    values = {
        **common_values(asked, duty, size, 0.97),
        **_speeds(asked, rated, speed),
        **_place(asked, rated, f"{1e-5 * least:.3g} bar"),
        "flooded": texts.flooded(
            size, LEAVES, cooler, _coolant_of_second(asked), WARM_BELTS if _has_belts(asked, rated) else ""
        ),
        "ambient": in_bar(ambient),
        "oil": oil,
        "bore": sizes.mm(sizes.bore(carried * gas_flow, OILS[oil].density_at(LEAVES), drop, 1), 2),
        "carried": f"{carried:g}",
        "free_air": f"{60.0 * (asked.free_air or LAMBDA * flow):.3g} m^3/min",
        "sheet": _sheet_comment(asked),
        "named": ", ".join([*displaced, *filter(None, [_title_part(asked)])]),
    }
    return texts.filled("air", values)


def _surroundings(asked: SceneRequest, duty: Duty) -> tuple[float, float]:
    """Return the room [K] for which the oil's cooler is sized, and the ambient pressure [Pa]."""
    if asked.stage is None:
        return max(ROOM, duty.T + ROOM_RESERVE), ambient_of(duty.at)
    return max(ROOM, asked.stage.T_coolant + ROOM_RESERVE), asked.stage.ambient


def _coolant_of_second(asked: SceneRequest) -> str:
    """Return the temperature of what cools a second stage, as stated in a scene; '' for other machines."""
    return asked.stage.coolant if asked.stage is not None and asked.stage.second else ""


def _place(asked: SceneRequest, rated: float, least: str) -> dict[str, str]:
    """Return what the machine is, and the parts around it: of two stages the first has those before it, and the fan.

    `rated` [kW] is the power of its motor, `least` the pressure of the minimum-pressure valve.
    """
    stage, valve = asked.stage, "" if asked.variable else "    inlet_valve: {pressure_loss: 15 mbar}\n"
    before, behind = f"{FILTER}{valve}", BEHIND.format(least=least, coolant="")
    control = ", control: flow" if asked.variable else ""
    if stage is None:
        fan = FAN.format(power=f"{FAN_SHARE * rated:.2g} kW", control=control, of="the motor")
        return {
            "what": "An oil-flooded air package",
            "kind": "Air package",
            "rated_by": "this machine",
            "humid": HUMID,
            "around": before + behind + fan,
        }
    if stage.second:
        around, place = BEHIND.format(least=least, coolant=f", coolant_temperature: {stage.coolant}"), "high"
    else:
        both = 2.0 * rated if stage.motors is None else 1e-3 * stage.motors
        fan = FAN.format(power=f"{FAN_SHARE * both:.2g} kW", control=control, of="both motors")
        around, place = before + fan, "low"
    what, kind = f"The {place} stage of an oil-flooded air package", f"Air package, {place} stage"
    return {"what": what, "kind": kind, "rated_by": "both stages", "humid": "", "around": around}


def _rated_power(asked: SceneRequest, taken: float) -> float:
    """Return the rated power [kW] of a package's motor: stated, or by the load found, or by an estimated one [W]."""
    if asked.motor is not None:
        return 1e-3 * asked.motor
    return sizes.motor_for(taken) if asked.load is None else sizes.motor_for(asked.load, reserve=1.0)


def _oil_per_air(duty: Duty, taken: float, oil: str) -> float:
    """Return the kg of oil per kg of air that remove a work [J/kg], warmed by at most `LARGEST_OIL_WARMING`."""
    heat = taken - heat_capacity(duty) * (LEAVES - duty.T)  # [J/kg] of the work, which the oil carries
    per_air = heat / (_oil_heat_capacity(oil) * LARGEST_OIL_WARMING)
    return max(AIR_OIL, math.ceil(2.0 * per_air) / 2.0)


def heat_capacity(duty: Duty) -> float:
    """Return the gas's heat capacity at constant pressure [J/(kg K)]."""
    return duty.R * duty.k / (duty.k - 1.0)


def _oil_heat_capacity(oil: str) -> float:
    return OILS[oil].heat_capacity_at(LEAVES - 0.5 * LARGEST_OIL_WARMING)


def _oil_cooler(room: float, taken: float, gas: float, oil: float) -> texts.OilCooler | None:
    """Return the cooler that keeps LEAVES in a room [K], or as far as the largest effectiveness allows (M288).

    The air enters as warm as the room: taken = (gas + effectiveness oil) (LEAVES - room), of the power taken [W] and
    heat capacity rates [W/K]. None where the gas carries all heat.
    """
    warmest = LEAVES - taken / (gas + LARGEST_EFFECTIVENESS * oil)
    kept = min(room, warmest)
    effectiveness = (taken / (LEAVES - kept) - gas) / oil
    if effectiveness <= 0.0:
        return None
    return texts.OilCooler(kept, -oil * math.log1p(-effectiveness), effectiveness if warmest < room else None)


def _package_work(duty: Duty) -> float:
    """Return the work [J/kg] without friction, with the package's pressure losses, which matter for small rises."""
    ratio = (duty.at.high + LOST_BEHIND) / max(duty.at.low - LOST_BEFORE, 0.5 * duty.at.low)
    return sizes.isentropic_work(duty.k, duty.R, duty.T, ratio) / COOLED


def _has_belts(asked: SceneRequest, rated: float) -> bool:
    """Tell whether belts drive a package with a motor of rated power [kW]."""
    return not asked.variable and rated <= BELTED


def _speeds(asked: SceneRequest, rated: float, speed: float) -> dict[str, str]:
    """Return the parts that differ between packages of fixed and variable speed, with a motor of rated power [kW]."""
    motor, alone = motor_values(rated), asked.stage is None
    if not asked.variable:
        fraction, transmission = BELTS if _has_belts(asked, rated) else GEARS
        return {
            "driven": texts.filled("fixed_speed", {**motor, "fraction": fraction, "transmission": transmission}),
            "sweep": "    unloaded: {intake_pressure: 0.12 bar, separator_pressure: 2.5 bar}\n" if alone else "",
        }
    inverter = {
        "share": f"{100.0 * INVERTER_LOSS_SHARE:g}",
        "loss": f"{INVERTER_LOSS_SHARE * rated:.3g} kW",
        "speed": sizes.rpm(speed),
    }
    told = "# The points of its data sheet, from full speed to a third of it."
    return {
        "driven": texts.filled("variable_speed", {**motor, **inverter}),
        "sweep": f"\n{told}\nsweep:\n  operation.speed: [{swept_speeds(speed)}]\n" if alone else "",
    }


def swept_speeds(speed: float) -> str:
    """Return the speeds of the sheet of a variable-speed package, whose full speed [rad/s] is given."""
    return ", ".join(f"{share * speed / RPM:.0f} rpm" for share in SPEEDS)


def _title_part(asked: SceneRequest) -> str:
    """Return the part of the title on a machine made for a sheet; empty without one."""
    flow = [] if asked.free_air is None else [f"{_spaced(asked.flow_text)} of free air"]
    return ", ".join(flow + ([] if asked.motor is None else [f"motor of {_spaced(asked.motor_text)}"]))


def _spaced(text: str) -> str:
    """Return a quantity as it was stated, with a space before its unit."""
    match = re.fullmatch(rf"\s*({NUMBER})\s*(\S.*?)\s*", text)
    return text.strip() if match is None else f"{match[1]} {match[2]}"


def _sheet_comment(asked: SceneRequest) -> str:
    """Return the comment on the maker's data that the machine was made for; empty without any."""
    stated = _title_part(asked)
    if not stated:
        return ""
    by = {"": "", "--flow": "the flow", "--motor": "the motor's full load"}[asked.sought]
    sought = f"; its size was found with the cycle, from {by}" if by else ""
    told = f"Made for a data sheet: {stated}{sought}. All else is typical, as the comments say."
    return textwrap.indent(textwrap.fill(told, COMMENT_WIDTH), "# ") + "\n"


def film_friction(size: sizes.Size, oil: str, leaves: float = LEAVES) -> float:
    """Return the friction [W] of oil films in tip and end gaps (M141, M142); `leaves` is the outlet temperature [K]."""
    rotors, big, gap = FAMILIES["b"], size.diameter / 0.240, sizes.GAP * size.clearance
    total = 0.0
    for ratio, lobes in ((1.0, rotors.male_lobes), (rotors.male_lobes / rotors.female_lobes, rotors.female_lobes)):
        total += tip_drag(ratio * size.speed, size.diameter, lobes, size.length, 0.003 * big, gap)
        total += end_drag(ratio * size.speed, size.diameter, SOLIDITY, gap)
    return OILS[oil].viscosity_at(leaves - 0.5 * WARMED) * total
