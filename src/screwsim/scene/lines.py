"""The states of both lines of a scene, however it states them: the only source of p_s, T_s and p_d.

Pressures are given, or follow from saturation at given temperatures (docs/model.md M42). For a machine in a package the
discharge pressure is stated at the package's outlet, and is higher at the machine (M342).
"""

from dataclasses import dataclass, replace
from functools import lru_cache

from screwsim.fluid import constants
from screwsim.fluid.composition import is_blend
from screwsim.fluid.models import condenses
from screwsim.fluid.settings import GasSettings
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.scene.types import Operation, Scene

LEAST_SUPERHEAT = 1e-6  # [K] for saturated vapour: more than the round-off of saturation, which would make it liquid


@dataclass(frozen=True)
class Lines:
    """States of both lines: pressures [Pa], suction temperature [K], and the vapour's mass fraction for wet suction."""

    p_s: float
    T_s: float
    p_d: float
    quality: float | None = None


def lines(scene: Scene) -> Lines:
    """Return the states of both lines of a scene that passed `cross_check` (M42)."""
    stated = _lines(scene.operation, scene.gas)
    behind = 0.0 if scene.losses is None else scene.losses.behind
    return stated if behind == 0.0 else replace(stated, p_d=stated.p_d + behind)


@IdentityCache
@lru_cache(maxsize=64)
def _lines(operation: Operation, gas: GasSettings) -> Lines:
    suction, p_d, fluid = operation.suction, operation.discharge.pressure, gas.name
    T_e, T_c, cooler = operation.evaporating_temperature, operation.condensing_temperature, operation.gas_cooler
    if T_e is not None and (T_c is not None or cooler is not None):
        p_d = cooler.pressure if cooler is not None else constants.condensing_pressure(fluid, T_c or 0.0)
        p_s = constants.dew_pressure(fluid, T_e)
        T_s = _superheated(T_e, operation.superheat)
        return Lines(p_s, _wet(fluid, p_s, T_s, suction.quality), p_d, suction.quality)
    if suction.pressure is None or p_d is None:
        raise ValueError("the scene states no pressures; call cross_check first")
    T_s = suction.temperature
    if T_s is None:
        T_s = _superheated(constants.saturation_temperature(fluid, suction.pressure), suction.superheat)
    return Lines(suction.pressure, _wet(fluid, suction.pressure, T_s, suction.quality), p_d, suction.quality)


def discharge_path(operation: Operation) -> str:
    """Return the path by which a scene states the pressure of its discharge line."""
    if operation.gas_cooler is not None:
        return "operation.gas_cooler.pressure"
    stated = operation.condensing_temperature is not None
    return "operation.condensing_temperature" if stated else "operation.discharge.pressure"


def _wet(fluid: str, p_s: float, T_s: float, quality: float | None) -> float:
    """Return the temperature [K] of suction gas: T_s, or for a wet blend its temperature below the dew point (M353)."""
    return T_s if quality is None or not is_blend(fluid) else constants.wet_temperature(fluid, p_s, quality)


def _superheated(T: float, superheat: float | None) -> float:
    """Return the suction temperature [K] at a superheat over saturation at T [K]; without one (wet gas) T itself."""
    return T if superheat is None else T + max(superheat, LEAST_SUPERHEAT)


def saturates(scene: Scene) -> bool:
    """Tell whether the gas is a real one that can condense on compression: it enters below its critical temperature."""
    known = constants.limits(scene.gas.name) if condenses(scene.gas) else None
    return known is not None and lines(scene).T_s < known.T_critical


def suction_enthalpy(scene: Scene) -> float:
    """Return the real fluid's enthalpy [J/kg] in the suction line, on CoolProp's default reference."""
    return _suction_enthalpy(scene.operation, scene.gas)


@lru_cache(maxsize=64)
def _suction_enthalpy(operation: Operation, gas: GasSettings) -> float:
    found, fluid = _lines(operation, gas), gas.name
    if found.quality is not None:
        return constants.wet_enthalpy(fluid, found.p_s, found.quality)
    return constants.vapour_enthalpy(fluid, found.p_s, found.T_s)


def condensate_enthalpy(scene: Scene) -> float | None:
    """Return the real fluid's enthalpy [J/kg] behind the condenser (M43) or the gas cooler (M330).

    None where the scene states neither, and for an expander.
    """
    return None if scene.machine.expands else _condensate_enthalpy(scene.operation, scene.gas)


def _condensate_enthalpy(operation: Operation, gas: GasSettings) -> float | None:
    T_c, subcooling, cooler = operation.condensing_temperature, operation.subcooling, operation.gas_cooler
    fluid = gas.name
    if cooler is not None:
        return constants.enthalpy(fluid, cooler.pressure, cooler.outlet_temperature)
    if T_c is None:
        return None
    T = constants.condensed(fluid, T_c)
    if subcooling:
        return constants.liquid_enthalpy(fluid, _lines(operation, gas).p_d, T - subcooling)
    return constants.saturated_liquid_enthalpy(fluid, T)


def refrigerating_effect(scene: Scene) -> float | None:
    """Return the heat that the refrigerant takes up in the evaporator [J/kg] (M43, M330).

    None where the scene states neither condenser nor gas cooler, and for an expander.
    """
    return None if scene.machine.expands else _refrigerating_effect(scene.operation, scene.gas)


@IdentityCache
@lru_cache(maxsize=64)
def _refrigerating_effect(operation: Operation, gas: GasSettings) -> float | None:
    behind = _condensate_enthalpy(operation, gas)
    return None if behind is None else _suction_enthalpy(operation, gas) - behind
