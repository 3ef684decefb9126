"""Numerical errors of performance figures, each relative to what makes sense for it (contract: error)."""

from __future__ import annotations

from screwsim.outputs import Figures

NET = ("gas_mass_flow", "oil_flow_ratio")  # of the net gas flow, which passes through zero where leakage takes all


def relative_errors(found: Figures, better: Figures) -> Figures:
    """Return |found − better| of every figure: powers over the larger of shaft and ideal power, efficiencies over
    max(|η|, 0.1), the net gas flow and what is divided by it over as much as the volumetric efficiency allows, the
    others over themselves; None where either is None.
    """
    ideal = (better.ideal_isothermal_efficiency or 0.0) * (better.shaft_power or 0.0)
    power_scale = max(abs(better.shaft_power or 0.0), abs(ideal), 1e-300)
    filling = abs(better.get("volumetric_efficiency") or 0.0)
    errors: dict[str, float | None] = {}
    for name, value in found.items():
        reference = better.get(name)
        if value is None or reference is None:
            errors[name] = None
            continue
        if name.endswith("_power"):
            scale = power_scale
        elif name.endswith("_efficiency"):
            scale = max(abs(reference), 0.1)
        elif name in NET and filling:
            scale = abs(reference) * max(filling, 0.1) / filling
        else:
            scale = max(abs(reference), 1e-300)
        errors[name] = abs(value - reference) / scale
    return Figures(errors)
