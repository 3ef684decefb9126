"""Where the gas of both lines would condense, and how far above that it is (docs/model.md M411)."""

from functools import lru_cache
from typing import Any

from screwsim.cycle.problem import Problem
from screwsim.fluid import constants
from screwsim.inputs.faults import UsageError

WET = "what is sucked in is wet"


def figures(problem: Problem, found: dict[str, Any]) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the saturation temperatures of both lines and the superheats [K] that the scene calls for, or why not.

    `found` has the temperature of the gas at discharge.
    """
    if "suction_superheat" not in problem.called:
        return {}, {}
    lines, fluid = problem.lines, problem.scene.gas.name
    dew_s, bubble_s, why_s = _saturated(fluid, lines.p_s)
    dew_d, bubble_d, why_d = _saturated(fluid, lines.p_d)
    T_d, blend = found["discharge_temperature"], "condensing_bubble_temperature" in problem.called
    values: dict[str, float | None] = {
        "evaporating_temperature": dew_s,
        "condensing_temperature": dew_d if blend else bubble_d,
        "suction_superheat": None if dew_s is None or lines.quality is not None else lines.T_s - dew_s,
        "discharge_superheat": None if dew_d is None or T_d is None else T_d - dew_d,
    }
    if blend:
        values |= {"evaporating_bubble_temperature": bubble_s, "condensing_bubble_temperature": bubble_d}
    at_suction = ("evaporating_temperature", "suction_superheat", "evaporating_bubble_temperature")
    reasons = {name: why_s if name in at_suction else why_d for name in values}
    if lines.quality is not None:
        reasons["suction_superheat"] = WET
    if dew_d is not None:  # what has no temperature there
        reasons["discharge_superheat"] = "nothing flows out to the discharge line"
    return values, {name: why for name, why in reasons.items() if values[name] is None}


@lru_cache(maxsize=64)
def _saturated(fluid: str, p: float) -> tuple[float | None, float | None, str]:
    """Return dew and bubble point [K] at a pressure [Pa], apart where the fluid glides, or why there are none."""
    try:
        known = constants.limits(fluid)
        if known is not None and p < known.p_critical:
            return constants.saturation_temperature(fluid, p), constants.boiling_temperature(fluid, p), ""
    except UsageError as error:
        return None, None, str(error)
    return None, None, f"{fluid} at {p / 1e5:.4g} bar is above its critical pressure"
