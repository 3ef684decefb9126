"""Refrigerant solubility: R134a that the injected POE oil brings dissolved flashes where it enters the chamber.

What: oil leaves the separator with what it holds in equilibrium at discharge pressure and the separator's temperature
(M195), is cooled, and flashes adiabatically to equilibrium at the chamber's pressure while it enters (M196): a further
stream of gas, whose heat of evaporation the oil pays. In the separator the oil takes that gas up again, so that what is
delivered is what is sucked in; the machine compresses it for nothing.
Source: Heil's model with the constants of B. Grebner, 1992; flash and balances ours.
Assumptions: the flash is complete in the port; what stays dissolved goes with the oil to discharge and neither flashes
again in leaks to lower pressure nor is gas taken up during compression (slow); heat of solution is that of evaporation,
excess enthalpy neglected; the oil's viscosity, density and heat capacity are those of pure oil. No gas is taken up
between separator and port. Needs effects.oil_injection.
Parameters: separator_temperature.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.declare import quantity
from screwsim.effects.base import Drawn, Effect, OilContent, OilGas, Plenum, Site
from screwsim.faults import Fault
from screwsim.fluid import constants, solubility
from screwsim.fluid.reservoir import Reservoir
from screwsim.machine.kinds import TWIN_SCREW

NAME = "refrigerant_solubility"
PLENUM = "oil_gas"
POINTS = 25  # of the table over pressure
LOWEST = 0.02  # of the separator's pressure: below it, what flashes is held
HIGHEST = 370.0  # [K], below the critical temperature
STEP = 5.0  # [K] between the temperatures at which CoolProp is asked


@dataclass(frozen=True)
class Parameters:
    """Where the oil was in equilibrium with gas."""

    separator_temperature: float = quantity("temperature", "of oil and gas in the separator", gt=0.0)


@lru_cache(maxsize=1)
def _saturation() -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return ln p_sat [Pa] over 1/T and the density of saturated liquid [kg/m³] over T [K]."""
    from scipy.interpolate import PchipInterpolator

    T = np.arange(solubility.LOW, HIGHEST + STEP / 2, STEP)
    p = [constants.dew_pressure(solubility.FLUID, float(each)) for each in T]
    rho = [constants.saturated_liquid_density(solubility.FLUID, float(each)) for each in T]
    return PchipInterpolator(1.0 / T[::-1], np.log(p[::-1])), PchipInterpolator(T, rho)


@lru_cache(maxsize=256)
def pair(T: float) -> solubility.Pair:
    """Return R134a and oil at T [K]."""
    log_pressure, density = _saturation()
    return solubility.pair(T, math.exp(float(log_pressure(1.0 / T))), float(density(T)))


def content(p: float, T: float) -> float:
    """Return R134a dissolved in equilibrium [kg per kg of oil] at p [Pa] and T [K] (M195)."""
    return solubility.dissolved(p, *pair(T))


def flashed(p: float, T: float, supply: float, latent: float, c_oil: float) -> float:
    """Return what flashes of oil at T [K] that holds `supply` [kg/kg] when it comes to p [Pa], adiabatically (M196)."""

    def excess(flash: float) -> float:
        return supply - flash - content(p, max(T - flash * latent / c_oil, solubility.LOW))

    if supply <= 0.0 or excess(0.0) <= 0.0:
        return 0.0
    from scipy.optimize import brentq

    return float(brentq(excess, 0.0, supply, xtol=1e-12))  # type: ignore[arg-type]


@lru_cache(maxsize=64)
def _content(T_separator: float, T: float, p_d: float, c_oil: float) -> OilContent:
    supply = content(p_d, T_separator)
    p_sat = constants.dew_pressure(solubility.FLUID, T)
    latent = constants.wet_enthalpy(solubility.FLUID, p_sat, 1.0) - constants.wet_enthalpy(solubility.FLUID, p_sat, 0.0)
    pressure = p_d * np.linspace(LOWEST, 1.0, POINTS)
    return OilContent(pressure, np.array([flashed(p, T, supply, latent, c_oil) for p in pressure]), latent)


def equilibrium_pressure(ratio: float, T: float) -> float:
    """Return the pressure [Pa] of the gas over oil at T [K] that holds `ratio` [kg/kg] (M195)."""
    found = pair(T)
    x = ratio / (ratio + found.mass_ratio)
    return found.p_sat * math.exp(solubility.log_activity(x, *found[1:5]))


@lru_cache(maxsize=8)
def _vapour(gas: Any, T_separator: float, T: float, p_d: float) -> Reservoir:
    """Return the vapour in equilibrium with the oil that is supplied at T [K] (M197)."""
    return gas.vapour(equilibrium_pressure(content(p_d, T_separator), T), T)


def build(parameters: Parameters, machine) -> list[OilGas | Plenum]:
    T_separator = parameters.separator_temperature

    def content_of(site: Site) -> OilContent:
        assert site.T_oil is not None and site.oil is not None  # needs_oil
        return _content(T_separator, site.T_oil, site.p_d, site.oil.heat_capacity)

    def state(site: Site) -> Reservoir:
        assert site.T_oil is not None
        return _vapour(site.gas, T_separator, site.T_oil, site.p_d)

    def figures(drawn: Drawn) -> dict[str, float | None]:
        return {
            "dissolved_gas_ratio": content(drawn.site.p_d, T_separator),
            "flash_mass_flow": drawn.flow,
            "flash_flow_ratio": drawn.ratio,
        }

    return [OilGas(PLENUM, content_of), Plenum(PLENUM, state, figures, product=False)]


def check(parameters: Parameters, facts) -> list[Fault]:
    path, faults = f"effects.{NAME}", []
    if facts.gas.fluid != solubility.FLUID:
        return [Fault(path, f"knows {solubility.FLUID} in POE oil only, not {facts.gas.fluid} (remove the effect)")]
    if "oil_injection" not in facts.effects:
        faults.append(Fault(path, "needs effects.oil_injection, at whose port the oil flashes (add it)"))
    stated = {f"{path}.separator_temperature": parameters.separator_temperature}
    stated["oil_supply.temperature"] = facts.oil_supply.temperature
    for where, T in stated.items():
        if not solubility.LOW <= T <= HIGHEST:
            what = f"{T:.6g} K lies outside {solubility.LOW:g} K to {HIGHEST:g} K, where solubility is known"
            faults.append(Fault(where, f"{what} (choose one inside, or remove effects.{NAME})"))
    operation, T = facts.operation, parameters.separator_temperature
    p_d, T_c = operation.discharge.pressure, operation.condensing_temperature
    if p_d is None and T_c is not None:
        p_d = constants.bubble_pressure(solubility.FLUID, T_c)
    if not faults and p_d is not None and p_d >= pair(T).p_sat:
        what = f"at {T:.6g} K the gas condenses in the separator, at {p_d / 1e5:.4g} bar"
        faults.append(Fault(f"{path}.separator_temperature", f"{what} (state a warmer separator)"))
    return faults


EFFECT = Effect(
    name=NAME,
    title="refrigerant dissolved in the injected oil flashes in the chamber",
    equations=("M195", "M196", "M197"),
    source="Grebner 1992 (Heil's model); flash: ours",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    states=("T_oil", "x_oil"),
    check=check,
    machines=(TWIN_SCREW,),
)
