"""Figures of an expander: power out, its isentropic efficiency, filling (docs/model.md M151, M152)."""

from collections.abc import Mapping
from typing import Any

NO_MEANING = {
    "isothermal_efficiency": "it is a figure of compression",
    "ideal_isothermal_efficiency": "it is a figure of compression",
    "volumetric_efficiency": "an expander is filled at the pressure of its inlet: see filling_factor",
    "specific_power": "an expander takes no power",
    "peak_pressure": "an expander's pressure is highest at its inlet",
}


def figures(
    found: Mapping[str, Any], isentropic_work: float, filled: float | None
) -> tuple[dict[str, float | None], dict[str, str]]:
    """Return the figures of an expander in place of a compressor's, and why some are None.

    `isentropic_work` h_2s − h_1 [J/kg], negative; `filled` [kg/s]: flow that fills the chambers where the inlet closes,
    None without an inlet port.
    """
    flow, shaft = float(found["gas_mass_flow"]), float(found["shaft_power"])
    changed: dict[str, float | None] = dict.fromkeys(NO_MEANING)
    reasons = dict(NO_MEANING)
    changed |= {"output_power": -shaft, "isentropic_efficiency": None, "filling_factor": None}
    if flow <= 0.0:
        reasons |= dict.fromkeys(("isentropic_efficiency", "filling_factor"), "no net gas flows through the expander")
        return changed, reasons
    if filled is None:
        reasons["filling_factor"] = "the machine has no port whose closing ends the filling (machine.discharge_port)"
    else:
        changed["filling_factor"] = flow / filled
    if shaft < 0.0:
        changed["isentropic_efficiency"] = shaft / (flow * isentropic_work)
    else:
        reasons["isentropic_efficiency"] = "the shaft gives no power: losses take more than the gas gives"
    return changed, reasons
