"""Performance figures of a closed cycle: flows, powers, efficiencies (docs/model.md M25–M36)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from screwsim.effects.base import PowerLoss
from screwsim.model.close import Array, discharge_enthalpy
from screwsim.model.compose import Parts
from screwsim.outputs import PERFORMANCE, Figures


@dataclass(frozen=True)
class CycleFigures:
    """What a power loss can ask of a closed cycle (SI units)."""

    omega: float
    tip_speed: float
    indicated_power: float
    oil_mass_flow: float
    oil_volume_flow: float
    oil_viscosity: float | None
    injection_pressure: float
    oil_source_pressure: float


@dataclass(frozen=True)
class Lines:
    """The states of both lines: pressures [Pa], suction temperature [K]."""

    p_s: float
    T_s: float
    p_d: float


def _quotient(a: float, b: float) -> float | None:
    return a / b if b != 0.0 and np.isfinite(a / b) else None


def efficiencies(
    gas: Any, lines: Lines, flow: float, shaft_power: float
) -> tuple[dict[str, float | None], dict[str, str]]:
    """Return isothermal and isentropic efficiency (M35, M36), or None with the reason."""
    names = ("isothermal_efficiency", "ideal_isothermal_efficiency", "isentropic_efficiency")
    if flow <= 0.0:
        reason = "no net gas is delivered: the machine leaks more than it takes in"
        return dict.fromkeys(names), dict.fromkeys(names, reason)
    if shaft_power <= 0.0:
        reason = "the shaft power is not positive"
        return dict.fromkeys(names), dict.fromkeys(names, reason)
    ends = lines.p_s, lines.p_d, lines.T_s
    works = gas.isothermal_work(*ends), gas.ideal_isothermal_work(*ends), gas.isentropic_work(*ends)
    found = {name: None if work is None else flow * work / shaft_power for name, work in zip(names, works, strict=True)}
    obstacle = gas.isothermal_obstacle(*ends)
    return found, {} if obstacle is None else {"isothermal_efficiency": obstacle}


def cycle_figures(
    parts: Parts, work: float, injected: float, p_injection: float, oil_viscosity: float | None, source_pressure: float
) -> CycleFigures:
    """Return what a power loss can ask: `work` [J] and `injected` oil [kg] are those of one chamber's life."""
    rate = parts.omega / parts.geometry.pitch
    oil_flow = injected * rate if parts.oil is not None else 0.0
    return CycleFigures(
        omega=parts.omega,
        tip_speed=0.5 * parts.geometry.settings.rotor_diameter * parts.omega,
        indicated_power=work * rate,
        oil_mass_flow=oil_flow,
        oil_volume_flow=oil_flow / parts.oil.density if parts.oil is not None else 0.0,
        oil_viscosity=oil_viscosity,
        injection_pressure=p_injection,
        oil_source_pressure=source_pressure,
    )


def figures(
    parts: Parts,
    lines: Lines,
    streams: Array,
    known: CycleFigures,
    work: float,
    trapped: float,
    d: float,
    peak: float,
    oil_mean_temperature: float | None,
) -> tuple[Figures, dict[str, str]]:
    """Return the performance figures of one closed cycle and why some are None.

    `streams` are the sums over one chamber's life (model.close.Balances.streams), `work` [J] that of one life.
    """
    geometry, gas, oil = parts.geometry, parts.gas, parts.oil
    rate = parts.omega / geometry.pitch  # chamber lives per second
    flow = float(streams[0, 0] + streams[1, 0]) * rate
    losses = _losses(parts.effects, known)
    lift = known.oil_volume_flow * (lines.p_d - known.injection_pressure) if oil is not None else None
    shaft = known.indicated_power + (lift or 0.0) + sum(losses.values())
    found: dict[str, float | None] = dict.fromkeys(PERFORMANCE)
    etas, notes = efficiencies(gas, lines, flow, shaft)
    swept = gas.density(lines.p_s, lines.T_s) * geometry.swept_volume * rate
    mean = discharge_enthalpy(streams)
    found |= (
        etas
        | losses
        | {
            "volumetric_efficiency": flow / swept,
            "gas_mass_flow": flow,
            "indicated_power": known.indicated_power,
            "shaft_power": shaft,
            "discharge_temperature": None if mean is None else gas.temperature(lines.p_d, mean[0]),
            "peak_pressure": peak,
            "work_per_cycle": work,
            "trapped_mass": trapped,
            "injection_pressure": known.injection_pressure,
        }
    )
    if mean is None:
        notes["discharge_temperature"] = "nothing flows out to the discharge line"
    if oil is not None:
        found |= {
            "oil_mass_flow": known.oil_mass_flow,
            "oil_ratio": d,
            "oil_flow_ratio": _quotient(known.oil_mass_flow, flow) if flow > 0.0 else None,
            "oil_lift_power": lift,
            "oil_discharge_temperature": oil_mean_temperature,
        }
        if flow <= 0.0:
            notes["oil_flow_ratio"] = "no net gas is delivered"
    return Figures(found), notes


def _losses(effects: Mapping[str, Sequence[Any]], known: CycleFigures) -> dict[str, float]:
    return {
        part.figure: float(part.power(known))
        for parts in effects.values()
        for part in parts
        if isinstance(part, PowerLoss)
    }
