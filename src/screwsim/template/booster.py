"""A booster: a flooded screw that takes in any gas, such as natural gas under pressure."""

import math

from screwsim.fluid import constants
from screwsim.fluid.description import describe
from screwsim.fluid.oils import OILS
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import RPM, ZERO_CELSIUS
from screwsim.template import sizes, texts
from screwsim.template.gas import (
    ABOVE_DEW,
    ETA,
    LAMBDA,
    LEAVES,
    WARMED,
    Duty,
    common_values,
    film_friction,
    gas_duty,
    heat_capacity,
    motor_values,
)
from screwsim.template.refrigeration import OILS_FOR
from screwsim.template.request import R, SceneRequest

FRICTION_COOLING = 0.5  # share of WARMED by which oil is warmed less where all power is friction: cold films take more
LEAST_OIL, LEAST_SHARE = 2.0, 0.004  # least kg of oil per kg of gas; and of the displaced volume (air packages: 0.5 %)
LARGEST_KEPT_RISE = 0.75  # of the temperature rise without cooling: most that gas and oil keep
COMPRESSION_EFFICIENCY = 0.88  # efficiency without friction, for an estimate; friction depends on size, not gas
FRICTION_FACTOR = 1.5  # over that of the films alone, for bearings and for accelerating the oil
LARGEST_FRICTION_RATIO = 4.0  # times the lossless work, beyond which friction rules out a booster
BOOSTED = "5/20 bar"  # the default condition of a booster
NEARLY = 0.999  # fraction of the critical temperature up to which gas has a dew point
OIL_OVER_DEW = 4.0  # [K] margin of cooled oil above the dew point
# of gases that hardly dissolve in it, as in air packages; others thin mineral oil
BOOSTER_OILS = {**OILS_FOR, **dict.fromkeys(("air", "nitrogen", "n2", "argon", "ar", "oxygen", "o2"), "mineral_46")}


def _rated_power(asked: SceneRequest, taken: float) -> float:
    """Return the rated power [kW] of a booster's motor: stated, or with a reserve over the load found, or estimated."""
    return sizes.motor_for(asked.load or taken) if asked.motor is None else 1e-3 * asked.motor


def _size_comment(asked: SceneRequest) -> str:
    """Return the comment on what a booster's size was sought for; empty where it was stated."""
    sought = {"--flow": asked.flow_text, "--motor": "the full load of its motor"}.get(asked.sought)
    return "" if sought is None else f"# Made for {sought}: its size was found with the cycle.\n"


def _condenses(fluid: str, duty: Duty) -> bool:
    """Tell whether the gas at its inlet temperature, or on cooled oil, would be liquid at the outlet pressure."""
    limits, T = constants.limits(fluid), min(duty.T, LEAVES)
    return limits is not None and T < limits.T_critical and constants.dew_pressure(fluid, T) < duty.at.high


def _dew_temperature(fluid: str, duty: Duty) -> float | None:
    """Return the condensing temperature [K] of a gas at the outlet pressure; None where it does not condense."""
    limits = constants.limits(fluid)
    if limits is None or not _condenses(fluid, duty):
        return None
    highest = constants.dew_pressure(fluid, NEARLY * limits.T_critical)
    return constants.saturation_temperature(fluid, min(duty.at.high, 0.999 * highest))


def _outlet_temperature(fluid: str, duty: Duty, warmed: float, dew: float | None) -> float:
    """Return a booster's outlet temperature [K]: above the dew point, below what a rise of `warmed` [K] uncooled gives.

    Raise UsageError where there is none.
    """
    leaves = min(LEAVES, ZERO_CELSIUS + 5.0 * math.floor((duty.T + LARGEST_KEPT_RISE * warmed - ZERO_CELSIUS) / 5.0))
    if dew is None:
        return leaves
    dry = ZERO_CELSIUS + 5.0 * math.ceil((dew + ABOVE_DEW - ZERO_CELSIUS) / 5.0)
    if dry > duty.T + warmed:
        what = f"condenses below {dew - ZERO_CELSIUS:.0f} °C, close to its outlet temperature"
        remedy = "choose warmer gas, or a lower pressure"
        raise UsageError(f"--condition: {fluid} of {duty.at.high_text} {what} ({remedy})")
    return max(leaves, dry)


def _refuse_liquid_at_outlet(fluid: str) -> None:
    """Raise UsageError for a blend that is known as a gas only above a booster's outlet temperature."""
    limits = constants.limits(fluid)
    if limits is None or not limits.gas_only or limits.T_triple <= LEAVES:
        return
    warmest = max(describe(fluid).components, key=lambda name: describe(name).T_c)
    above = f"{limits.T_triple - ZERO_CELSIUS:.4g} degC"
    what = f"is known as a gas only above {above}, but leaves a booster at {LEAVES - ZERO_CELSIUS:g} degC"
    raise UsageError(f"--fluid {fluid}: {what} (leave out {warmest})")


def first_flow(asked: SceneRequest) -> float:
    """Return the approximate displacement [m³/s] of a booster for the stated delivery, or for full motor load."""
    duty = gas_duty(asked, asked.fluid or "Methane", BOOSTED, "20 degC")
    if asked.molar is not None:
        return asked.molar * R / duty.R / (LAMBDA * duty.density)
    if asked.free_air is not None:
        return asked.free_air / LAMBDA
    return (asked.motor or 0.0) * ETA / (duty.work * LAMBDA * duty.density)


def booster(asked: SceneRequest) -> str:
    """Return the scene of a screw that takes in gas under pressure: a fuel-gas booster, or a second stage."""
    fluid = asked.fluid or "Methane"
    oil = asked.oil or BOOSTER_OILS.get(fluid.lower(), "PAG_100")
    flow, speed = asked.flow or 600.0 / 3600.0, asked.speed or 2950.0 * RPM
    example = BOOSTED
    _refuse_liquid_at_outlet(fluid)
    size, duty = texts.sized(flow, speed), gas_duty(asked, fluid, example, "20 degC")
    c_p = heat_capacity(duty)
    gas_flow = LAMBDA * flow * duty.density

    def taken_at(leaving: float) -> float:
        """Return the work [J/kg] at an outlet temperature [K]: cold films take more."""
        friction = FRICTION_FACTOR * film_friction(size, oil, leaving) / gas_flow
        return max(duty.work / ETA, duty.work / COMPRESSION_EFFICIENCY + friction)

    dew = _dew_temperature(fluid, duty)
    leaves = _outlet_temperature(fluid, duty, taken_at(LEAVES) / c_p, dew)
    if leaves > OILS[oil].high:
        what = f"gas and oil have to leave at {leaves - ZERO_CELSIUS:.0f} degC"
        what += f", beyond the data of {oil}, which end at {OILS[oil].high - ZERO_CELSIUS:.0f} degC"
        raise UsageError(f"--condition {asked.condition or example}: {what} (choose a lower discharge pressure)")
    taken = taken_at(leaves)
    if taken > LARGEST_FRICTION_RATIO * duty.work:
        what = f"with oil films it takes {taken / duty.work:.0f} times the work that the gas needs"
        thinner = min(OILS, key=lambda name: OILS[name].viscosity_at(LEAVES))
        oils = "" if thinner == oil else f"a thinner oil, e.g. --oil {thinner}, "
        remedy = f"choose a lower speed, {oils}or pressures farther apart"
        raise UsageError(f"--speed {sizes.rpm(speed)}: {what} ({remedy})")
    friction = 1.0 - duty.work / COMPRESSION_EFFICIENCY / taken
    warmed = WARMED * (1.0 - FRICTION_COOLING * max(friction, 0.0))
    warmed = warmed if dew is None else min(warmed, leaves - dew - OIL_OVER_DEW)
    left = taken - c_p * (leaves - duty.T)
    least = max(LEAST_OIL, LEAST_SHARE * flow * OILS[oil].density_at(LEAVES) / gas_flow)
    ratio = math.ceil(2.0 * left / (OILS[oil].heat_capacity_at(leaves - 0.5 * WARMED) * warmed)) / 2.0
    values = {
        **common_values(asked, duty, size, 0.97),
        **motor_values(_rated_power(asked, gas_flow * taken)),
        "sheet": _size_comment(asked),
        "flooded": texts.flooded(size, leaves),
        "room": texts.oil_room(duty.at.high),
        "fluid": fluid,
        "two_phase": texts.two_phase(fluid, _condenses(fluid, duty)),
        "oil": oil,
        "oil_ratio": f"{max(math.ceil(2.0 * least) / 2.0, ratio):g}",
    }
    return texts.filled("booster", values)
