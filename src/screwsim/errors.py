"""Numerical errors of performance figures, each relative to what makes sense for it (contract: error)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

from screwsim.outputs import PERFORMANCE, Figures

NET = ("gas_mass_flow", "oil_flow_ratio")  # of the net gas flow, which passes through zero where leakage takes all
DELIVERED = ("isothermal", "ideal_isothermal", "isentropic", "volumetric")  # efficiencies of what is delivered
BY_FLOW = (*NET, *(f"{name}_efficiency" for name in DELIVERED))
BY_FLOW += ("specific_power", "cooling_capacity", "cop", "electrical_cop")
SCALES = ("shaft_power", "ideal_isothermal_efficiency", "volumetric_efficiency", "gas_mass_flow")  # of errors

TORQUE, FORCE = "gas_torque", "_gas_force"  # over what they swing by: their means pass through zero
PULSATION = "_pulsation_"  # over the pressure of the line
LEAST_FLOW = "discharge_line_least_flow"  # over the mean flow, as it passes through zero
OIL = ("oil_ratio", "oil_flow_ratio", "oil_mass_flow")
FLASH = ("flash_mass_flow", "flash_flow_ratio")  # where oil takes gas up, too, they pass through zero
OF_FLASH = ("oil_mass_flow", "oil_flow_ratio", "dissolved_gas_ratio", "discharge_dissolved_gas_ratio")
BROUGHT = 0.1  # of the gas that the oil brings dissolved, over which at the least they err
LEAST_OIL = 1e-4  # oil per gas below which its error is that of nothing


def relative_errors(found: Figures, better: Figures, least_power: float = 0.0, least_work: float = 0.0) -> Figures:
    """Return |found − better| of every figure over its `error_scale`; None where either is None.

    Powers [W] and work [J] below the least ones are rounding.
    """
    known = {name: 0.0 if value is None else value for name, value in better.items()}
    errors: dict[str, float | None] = dict.fromkeys(found)
    of_powers: float | None = None  # they share one scale
    for name, value in found.items():
        if value is None or (reference := better.get(name)) is None:
            continue
        if _is_power(name):
            if of_powers is None:
                of_powers = max(error_scale(name, known), 1e-300, least_power)
            scale = of_powers
        elif _over_itself(name):
            scale = max(abs(reference), 1e-300)
        else:
            scale = max(error_scale(name, known), least_work if name == "work_per_cycle" else 1e-300, 1e-300)
        errors[name] = abs(value - reference) / scale
    of_power = errors.get("shaft_power")
    if of_power is not None and errors.get("shaft_torque") is not None:
        errors["shaft_torque"] = of_power + (errors.get("mean_speed") or 0.0)
    return Figures(errors)


@cache
def _is_power(name: str) -> bool:
    """Tell whether a figure is a power, or the heat of walls, which may be next to nothing."""
    return name == "wall_heat" or (name.endswith("_power") and PERFORMANCE[name].units == "W")


def flow_errors(found: Figures, lost: float) -> Figures:
    """Return what a relative error of the net gas flow, `lost`, makes of the figures that go with it."""
    known = {name: value for name in (*BY_FLOW, *SCALES) if (value := found.get(name)) is not None}
    return Figures(
        {name: lost * abs(known[name]) / max(error_scale(name, known), 1e-300) for name in BY_FLOW if name in known}
    )


def error_scale(name: str, known: Mapping[str, Any], larger: Callable[[Any, Any], Any] = max) -> Any:
    """Return what the relative error of a figure is relative to; figures that are None count as zero in `known`.

    Powers and heat of walls are over the larger of shaft and ideal power, the torque likewise, efficiencies over
    max(|η|, 0.1), oil over at least LEAST_OIL of the gas, the net gas flow and what is divided by it over as much as
    the volumetric efficiency allows, gas that the chambers' oil gives off over at least BROUGHT of what it brings, the
    others over themselves.
    For arrays `larger` is numpy's maximum.
    """
    size = abs(known[name])
    if _is_power(name):
        shaft = known.get("shaft_power", 0.0)
        return larger(abs(shaft), abs(known.get("ideal_isothermal_efficiency", 0.0) * shaft))
    if name == "shaft_torque":
        shaft = abs(known.get("shaft_power", 0.0))
        return size * error_scale("shaft_power", known, larger) / (shaft + (shaft == 0.0))
    if name.endswith("_efficiency"):
        return larger(size, 0.1)
    swing = _swing(name)
    if swing is not None:
        over = abs(known.get(swing, 0.0))
        return over if PULSATION in name else larger(size, over)
    if name in NET:
        filling = abs(known.get("volumetric_efficiency", 0.0))
        size = size * larger(filling, 0.1) / (filling + 0.1 * (filling == 0.0))
    if name in FLASH:
        oil = abs(known.get("oil_mass_flow" if name == "flash_mass_flow" else "oil_flow_ratio", 0.0))
        over_time = known.get("discharge_dissolved_gas_ratio", 0.0) != 0.0
        size = larger(size, BROUGHT * known.get("dissolved_gas_ratio", 0.0) * oil * over_time)
    if name in OIL:
        size = larger(size, LEAST_OIL * (abs(known.get("gas_mass_flow", 0.0)) if name == "oil_mass_flow" else 1.0))
    return size


@cache
def _over_itself(name: str) -> bool:
    """Tell whether the error of a figure is relative to the figure itself, whatever the others are."""
    apart = (*NET, *OIL, *FLASH, "work_per_cycle", "shaft_torque")
    special = name.endswith("_efficiency") or name in apart or _is_power(name)
    return not special and _swing(name) is None


@cache
def _swing(name: str) -> str | None:
    """Return the figure by which one whose mean may vanish swings; None of the others."""
    if TORQUE in name:
        return "gas_torque_peak_to_peak"
    if name == LEAST_FLOW:
        return "gas_mass_flow"
    if PULSATION in name:
        return f"{name.partition('_')[0]}_pressure"
    return f"{name.removesuffix('_peak')}_peak" if FORCE in name else None
