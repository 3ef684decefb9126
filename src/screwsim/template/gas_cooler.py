"""Carbon dioxide above its critical point: the gas cooler that takes the place of a condenser, and its pressure."""

from screwsim.fluid import constants
from screwsim.inputs.faults import UsageError
from screwsim.scene.units import ZERO_CELSIUS
from screwsim.template.request import Condition, condition_of

CARBON_DIOXIDE = ("carbondioxide", "co2", "r744")
WARMEST = 333.15  # [K] at the outlet of the gas cooler, to which the correlation was fitted
FITTED = 263.15, 293.15  # [K] evaporation, likewise
BY = "Liao, Zhao, Jakobsen 2000 (Appl. Therm. Eng. 20, 831)"


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
    low, high = FITTED
    if low <= T_e <= high:
        return ""
    return f" (extrapolated: fitted to {low - ZERO_CELSIUS:.0f} to {high - ZERO_CELSIUS:.0f} degC of evaporation)"


def refuse_too_warm(text: str, condition: Condition) -> None:
    """Raise UsageError where the outlet of the gas cooler is warmer than where its pressure is known."""
    if condition.high > WARMEST:
        warmest = f"{WARMEST - ZERO_CELSIUS:.0f} degC"
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
    what = (
        f"{fluid} condenses up to {critical}, and needs a gas cooler above, for whose pressures hardly a screw is built"
    )
    remedy = f"screwsim new reciprocating --fluid {fluid} --condition '{text}' writes a cylinder with one"
    return f"{what} ({remedy}; or choose a colder condition)"
