"""The duty of a refrigeration machine: its states, a superheat from which the gas stays dry, flow and power.

Above its critical point carbon dioxide has a gas cooler in place of a condenser, with a pressure of its own.
"""

import math
from typing import NamedTuple

from screwsim.fluid import constants
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import ZERO_CELSIUS, in_celsius
from screwsim.scene.conventions import glide_to_tell
from screwsim.template import sizes
from screwsim.template.request import Condition, condition_of, quantity_after_comma

EFFICIENCIES = 0.91, 0.74  # lambda and eta_s of mean curves (validation/bitzer), for estimates of flow and power
CONDITION_SHARES = 0.5, 0.8  # of the way from triple to critical point: a condition possible for any fluid
SUPERHEATS = 10.0, 15.0, 20.0, 25.0, 30.0, 40.0  # [K] of which the first that keeps the gas dry is the default
UNUSUAL_SUPERHEATS = 50.0, 60.0, 80.0, 100.0  # [K] proposed where none of those suffices
DRY = 5e3  # [J/kg] least enthalpy above the dew point that the compressed gas has by default: some 5 K

COPPER_CORROSIVES = ("ammonia", "r717", "nh3")  # their motors stand outside the gas
CARBON_DIOXIDE = ("carbondioxide", "co2", "r744")
WARMEST_OUTLET = 333.15  # [K] at the outlet of the gas cooler, to which the correlation was fitted
FITTED_EVAPORATION = 263.15, 293.15  # [K] evaporation, likewise
PRESSURE_SOURCE = "Liao, Zhao, Jakobsen 2000 (Appl. Therm. Eng. 20, 831)"


class Duty(NamedTuple):
    """The states of a condition, and estimates of flow and power, in SI units."""

    T_e: float
    T_c: float
    liquid: float  # [K] saturated, behind the condenser: colder than T_c where a blend glides
    superheat: str
    more: float  # [K] of it
    p_s: float
    p_d: float
    gas_flow: float
    work: float  # lossless work of an ideal gas
    hottest: float  # [K] after isentropic compression of an ideal gas
    k: float

    @property
    def subcooling(self) -> float:
        """By how much [K] the condenser subcools the liquid, which stays warmer than the evaporator."""
        return min(5.0, 0.5 * (self.liquid - self.T_e))


def duty_of(
    fluid: str, flow: float, condition: str, example: str, p_cooler: float | None = None, lossless: bool = False
) -> Duty:
    """Return the states of a condition with estimates of flow and power; raise UsageError for an impossible one.

    The gas stays dry, also in `lossless` compression, which is nearly that of a cylinder until its valve opens.
    `p_cooler` [Pa] is the pressure of a gas cooler, which the condition's upper temperature leaves; without it, the gas
    condenses.
    """
    found = condition_of(condition, "temperature", example)
    limits = constants.limits(fluid)
    assert limits is not None
    if limits.gas_only:
        what = f"has no known saturation: it is known as a gas only, from {in_celsius(limits.T_triple)} on"
        remedy = "write screwsim new booster, whose --condition are pressures and a temperature"
        raise UsageError(f"--fluid {fluid}: {what} ({remedy})")
    for T in (found.low, found.high) if p_cooler is None else (found.low,):
        if not limits.T_triple < T < limits.T_critical:
            least, most = (end - ZERO_CELSIUS for end in (limits.T_triple, limits.T_critical))
            usual = ", which is the default" if condition == example else ""
            what = f"{fluid} saturates between {least:.1f} and {most:.1f} degC"
            what += f" (write e.g. --condition '{_possible_condition(limits)}')"
            cooler = refused_screw(fluid, condition, example) if T is found.high else ""
            raise UsageError(f"--condition {condition}{usual}: {cooler or what}")
    if not found.low < found.high:
        what = "evaporates above the condensing temperature"
        raise UsageError(f"--condition {condition}: {what} (write LOW/HIGH, e.g. '{example}')")
    p_s, p_d = constants.dew_pressure(fluid, found.low), p_cooler or constants.condensing_pressure(fluid, found.high)
    liquid = constants.condensed(fluid, found.high) if p_cooler is None else found.high
    if liquid <= found.low:
        what = f"{fluid} glides: its liquid leaves the condenser at {in_celsius(liquid)}, colder than the evaporator"
        raise UsageError(f"--condition {condition}: {what} (choose ends farther apart)")
    superheat, more = _superheat(fluid, found, p_s, p_d, condition, 1.0 if lossless else EFFICIENCIES[1])
    T, R = found.low + more, constants.gas_constant(fluid)
    k = constants.isentropic_exponent(fluid, T)
    hottest = T * (p_d / p_s) ** ((k - 1.0) / k)
    gas_flow = EFFICIENCIES[0] * flow * p_s / (R * T)
    work = sizes.isentropic_work(k, R, T, p_d / p_s)
    return Duty(found.low, found.high, liquid, superheat, more, p_s, p_d, gas_flow, work, hottest, k)


def _superheat(
    fluid: str, at: Condition, p_s: float, p_d: float, condition: str, efficiency: float
) -> tuple[str, float]:
    """Return the superheat of the suction gas, its text and value [K]: as stated, or so much that the gas stays dry.

    The vapour line of heavy molecules leans over, so that compression from little superheat ends in the wet region.
    Raise UsageError for a stated superheat from which it does.
    """

    def over_dew(more: float) -> float:
        end = constants.compressed(fluid, p_s, at.low + more, p_d, efficiency)
        return math.inf if end is None else end.over_dew

    enough = next((more for more in SUPERHEATS if over_dew(more) >= DRY), None)
    usual = f"{enough or SUPERHEATS[0]:g} K"
    superheat, more = quantity_after_comma(at, "temperature_difference", usual)
    if over_dew(more) >= 0.0:
        told = f"    # so that {fluid}, whose vapour line leans over, leaves dry"
        return superheat + (told if more > SUPERHEATS[0] and not at.beside else ""), more
    what = f"compressed from {superheat} of superheat, {fluid} ends wet, as its vapour line leans over"
    suffices = enough or next((more for more in UNUSUAL_SUPERHEATS if over_dew(more) >= DRY), None)
    pair = condition.partition(",")[0].strip()
    remedy = "choose ends closer together, or another --fluid"
    remedy = f"write e.g. --condition '{pair}, {suffices:g} K'" if suffices else remedy
    raise UsageError(f"--condition {condition}: {what} ({remedy})")


def _possible_condition(limits: constants.Limits) -> str:
    """Return a condition that is possible for a fluid."""
    span, zero = limits.T_critical - limits.T_triple, ZERO_CELSIUS
    low, high = (limits.T_triple + share * span - zero for share in CONDITION_SHARES)
    return f"{low:.1f}/{high:.1f} degC"


def conditions(duty: Duty, fluid: str) -> dict[str, str]:
    """Return the temperatures of a duty as stated in a scene; the liquid stays warmer than the evaporator."""
    e, c = (f"{T - ZERO_CELSIUS:.6g}" for T in (duty.T_e, duty.T_c))
    return {
        "condition": f"{e}/{c} degC",
        "evaporating": f"{e} degC",
        "condensing": f"{c} degC",
        "point": point_of_condensing(fluid, duty.T_c),
        "superheat": duty.superheat,
        "subcooling": f"{duty.subcooling:.4g} K",
    }


def point_of_condensing(fluid: str, T_c: float) -> str:
    """Return a comment where the condensing temperature [K] of a fluid with glide is its bubble point; else nothing."""
    if not glide_to_tell(fluid, T_c):
        return ""
    return f"    # bubble point; of fluid: {fluid}.mix it is the dew point, as on makers' sheets"


def motor_in_gas(fluid: str) -> bool:
    """Return whether a machine on a fluid is semi-hermetic, so that its suction gas cools the motor."""
    return fluid.lower() not in COPPER_CORROSIVES


def is_carbon_dioxide(fluid: str) -> bool:
    """Return whether a fluid is carbon dioxide, by any of its names."""
    return fluid.lower() in CARBON_DIOXIDE


def needs_gas_cooler(fluid: str, condition: Condition) -> bool:
    """Return whether the warm side of a condition lies at or above the critical temperature of carbon dioxide."""
    limits = constants.limits(fluid)
    return limits is not None and is_carbon_dioxide(fluid) and condition.high >= limits.T_critical


def best_pressure(T_e: float, T_out: float) -> float:
    """Return the pressure [Pa] of a gas cooler at which the COP is highest; evaporation and outlet in K.

    Source: Liao, Zhao, Jakobsen, Applied Thermal Engineering 20 (2000) 831-841, for evaporation from -10 to 20 °C and
    30 to 60 °C at the outlet.
    """
    e, c = T_e - ZERO_CELSIUS, T_out - ZERO_CELSIUS
    return 1e5 * ((2.778 - 0.0157 * e) * c + 0.381 * e - 9.34)


def range_note(T_e: float) -> str:
    """Return that the best pressure is extrapolated, where evaporation [K] is beyond what it was fitted to; else ''."""
    low, high = FITTED_EVAPORATION
    if low <= T_e <= high:
        return ""
    return f" (extrapolated: fitted to {low - ZERO_CELSIUS:.0f} to {high - ZERO_CELSIUS:.0f} degC of evaporation)"


def refuse_too_warm(text: str, condition: Condition) -> None:
    """Raise UsageError where the outlet of the gas cooler is warmer than where its pressure is known."""
    if condition.high > WARMEST_OUTLET:
        warmest = f"{WARMEST_OUTLET - ZERO_CELSIUS:.0f} degC"
        what = f"the outlet of the gas cooler is above {warmest}, to which its best pressure is known"
        remedy = "write a colder one, and change operation.gas_cooler in the file"
        raise UsageError(f"--condition {text}: {what} ({remedy})")


def refused_screw(fluid: str, text: str, example: str) -> str:
    """Return why a screw is not written for a condition that needs a gas cooler, with what is; '' for any other."""
    condition = condition_of(text, "temperature", example)
    if not needs_gas_cooler(fluid, condition):
        return ""
    limits = constants.limits(fluid)
    assert limits is not None
    critical = f"{limits.T_critical - ZERO_CELSIUS:.1f} degC"
    what = "needs a gas cooler above, for whose pressures hardly a screw is built"
    remedy = f"screwsim new reciprocating --fluid {fluid} --condition '{text}' writes a cylinder with one"
    return f"{fluid} condenses up to {critical}, and {what} ({remedy}; or choose a colder condition)"
