"""Numerical errors of performance figures, each relative to what makes sense for it (contract: error)."""

from __future__ import annotations

from screwsim.outputs import PERFORMANCE, Figures

NET = ("gas_mass_flow", "oil_flow_ratio")  # of the net gas flow, which passes through zero where leakage takes all


OIL = ("oil_ratio", "oil_flow_ratio", "oil_mass_flow")
LEAST_OIL = 1e-4  # oil per gas below which its error is that of nothing


def relative_errors(found: Figures, better: Figures, least_power: float = 0.0, least_work: float = 0.0) -> Figures:
    """Return |found − better| of every figure, over what makes sense for it; None where either is None.

    Powers are over the larger of shaft and ideal power, efficiencies over max(|η|, 0.1), oil over at least LEAST_OIL of
    the gas, the net gas flow and what is divided by it over as much as the volumetric efficiency allows, the others
    over themselves. Powers [W] and work [J] below the least ones are rounding.
    """
    ideal = (better.ideal_isothermal_efficiency or 0.0) * (better.shaft_power or 0.0)
    power_scale = max(abs(better.shaft_power or 0.0), abs(ideal), least_power, 1e-300)
    filling = abs(better.get("volumetric_efficiency") or 0.0)
    errors: dict[str, float | None] = {}
    for name, value in found.items():
        reference = better.get(name)
        if value is None or reference is None:
            errors[name] = None
            continue
        if name.endswith("_power") and PERFORMANCE[name].units == "W":
            scale = power_scale
        elif name.endswith("_efficiency"):
            scale = max(abs(reference), 0.1)
        elif name in NET and filling:
            scale = max(abs(reference) * max(filling, 0.1) / filling, 1e-300)
        else:
            scale = max(abs(reference), 1e-300)
        if name == "work_per_cycle":
            scale = max(scale, least_work)
        elif name in OIL:
            gas = abs(better.get("gas_mass_flow") or 0.0) if name == "oil_mass_flow" else 1.0
            scale = max(scale, LEAST_OIL * gas)
        errors[name] = abs(value - reference) / scale
    return Figures(errors)
