"""Refrigerant solubility: R134a that the injected POE oil brings dissolved flashes where it enters the chamber.

What: oil leaves the separator saturated with gas at discharge pressure and the separator's temperature (M195) and is
cooled. Without `flash_time` it flashes adiabatically to equilibrium at the chamber's pressure as it enters (M196): a
further stream of gas, whose heat of evaporation the oil supplies. With `flash_time` the dissolved gas is a state of the
chamber that travels with the oil through leaks and ports (M230); oil that holds more than in equilibrium releases it
with that time constant (M231), and oil that holds less absorbs gas with `absorption_time`, if that is stated. In the
separator the oil absorbs that gas again, so that delivery equals suction; the machine compresses the flashed gas for
nothing.
Source: Heil's model with the constants of J. J. Grebner, 1992; flash, rate and balances ours. No source gives the time
constants of oil in a screw compressor's chamber: they are assumptions.
Assumptions: the oil's viscosity, density and heat capacity are those of pure oil; no gas is taken up between separator
and port. Flash in the port: it is complete there; gas that stays dissolved goes with the oil to discharge, it does not
flash again in leaks to lower pressure, and no gas is taken up during compression; heat of solution is that of
evaporation, excess enthalpy neglected. Over time: all oil of a chamber holds the same; dissolved gas has one enthalpy,
that which M195 gives between separator and supply, and with it the equilibrium at other temperatures (M232). Needs
effects.oil_injection.
Parameters: separator_temperature, flash_time, absorption_time.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.effects.base import Drawn, Effect, InSeparator, OilContent, OilGas, OilSolution, Plenum, Site
from screwsim.effects.oil_injection import discharge_pressure
from screwsim.fluid import constants, solubility
from screwsim.fluid.oils import is_ester
from screwsim.fluid.reservoir import Reservoir
from screwsim.fluid.vapour_fugacity import Fugacity, fugacity_table
from screwsim.inputs.declare import optional
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import OIL
from screwsim.numerics import cubic
from screwsim.numerics.pchip import Pchip
from screwsim.numerics.roots import brentq
from screwsim.outputs import HELD, Figure, Scale
from screwsim.outputs.customary import in_bar, in_celsius

Array = np.ndarray

NAME = "refrigerant_solubility"
PLENUM, SEPARATOR = "oil_gas", "separator"
BROUGHT = 0.1  # share of the dissolved gas to which errors of the flash over time are relative, at least
OVER_TIME = "discharge_dissolved_gas_ratio"  # with it the net flash may pass through zero: oil absorbs gas, too
FIGURES = (
    Figure("dissolved_gas_ratio", "1", "refrigerant dissolved in the injected oil, per oil"),
    Figure(
        "flash_mass_flow",
        "kg s-1",
        "refrigerant that flashes out of the injected oil, less what the oil absorbs",
        Scale(BROUGHT, ("dissolved_gas_ratio", "oil_mass_flow"), where=OVER_TIME),
        by_held=True,
    ),
    Figure(
        "flash_flow_ratio",
        "1",
        "refrigerant that flashes out of the oil, over net suction flow",
        Scale(BROUGHT, ("dissolved_gas_ratio", "oil_flow_ratio"), where=OVER_TIME),
        by_flow=True,
        by_held=True,
    ),
)
POINTS = 81  # rows of the table over pressure
LOWEST = 0.02  # share of the separator's pressure below which the flashed amount is held constant
RISE = 1e-6  # least relative rise of pressure from row to row: oil as warm as the separator flashes from p_d on
HIGHEST = 370.0  # [K] highest temperature, below the critical one
STEP = 1.0  # [K] between the temperatures at which CoolProp is evaluated
LEAST, MOST = 1e-6, 20.0  # [kg/kg] range of a solution's tables; beyond them the equilibrium is held constant
ROWS = 401  # rows of those tables
OTHERWISE = "state another one, or remove flash_time"
FLAT = 1e-4  # distance from saturation, over its pressure, from which on a solution's tables end
APART = 5.0  # [K] least distance of the two temperatures that the heat of solution is derived from


@dataclass(frozen=True)
class Parameters(InSeparator):
    """Where the oil was in equilibrium with gas, and how fast it comes to equilibrium in the chamber."""

    flash_time: float | None = optional(
        "time", "time in which oil in a chamber gives off gas beyond equilibrium (absent: at once, in the port)"
    )
    absorption_time: float | None = optional(
        "time", "time in which it absorbs gas (absent: it does not; needs flash_time)"
    )


@lru_cache(maxsize=1)
def _saturation() -> tuple[Pchip, Pchip]:
    """Return ln p_sat [Pa] over 1/T and the density of saturated liquid [kg/m³] over T [K]."""
    T = np.arange(solubility.LOW, HIGHEST + STEP / 2, STEP)
    p = [constants.dew_pressure(solubility.FLUID, float(each)) for each in T]
    rho = [constants.saturated_liquid_density(solubility.FLUID, float(each)) for each in T]
    return Pchip(1.0 / T[::-1], np.log(p[::-1])), Pchip(T, np.array(rho))


@lru_cache(maxsize=256)
def pair(T: float) -> solubility.RefrigerantOilPair:
    """Return the constants of the pair R134a and oil at T [K]."""
    log_pressure, density = _saturation()
    return solubility.pair(T, math.exp(log_pressure(1.0 / T)), density(T))


@lru_cache(maxsize=256)
def vapour(T: float) -> Fugacity:
    """Return the fugacity of R134a vapour at T [K]."""
    return fugacity_table(solubility.FLUID, solubility.LOW, HIGHEST).at(T)


def content(p: float, T: float) -> float:
    """Return the R134a dissolved in equilibrium [kg per kg of oil] at p [Pa] and T [K] (M195)."""
    found = pair(T)
    return solubility.dissolved(found.p_sat * vapour(T).ratio(p / found.p_sat), *found)


def flashed(p: float, T: float, supply: float, latent: float, c_oil: float) -> float:
    """Return the gas that flashes adiabatically [kg per kg of oil] when oil at T [K] comes to p [Pa] (M196).

    `supply` is its content before [kg/kg], `latent` [J/kg] the heat of evaporation, `c_oil` [J/(kg K)] its heat
    capacity.
    """

    def excess(flash: float) -> float:
        return supply - flash - content(p, max(T - flash * latent / c_oil, solubility.LOW))

    if supply <= 0.0 or excess(0.0) <= 0.0:
        return 0.0
    return brentq(excess, 0.0, supply, xtol=1e-12)


@lru_cache(maxsize=64)
def _content(T_separator: float, T: float, p_d: float, c_oil: float) -> OilContent:
    supply = content(p_d, T_separator)
    p_sat = constants.dew_pressure(solubility.FLUID, T)
    latent = constants.wet_enthalpy(solubility.FLUID, p_sat, 1.0) - constants.wet_enthalpy(solubility.FLUID, p_sat, 0.0)
    return OilContent(*_flashes(T, p_d, supply, latent, c_oil), latent)


def _flashes(T: float, p_d: float, supply: float, latent: float, c_oil: float) -> tuple[Array, Array]:
    """Return pressures [Pa] up to p_d and the gas that flashes at each [kg/kg] (M196), in `POINTS` rows.

    Rows are dense in the flashed amount where it begins and where it ends; their pressures follow from it without a
    search. One row lies where the oil reaches the coldest temperature of the solubility data.
    """
    least, most = (flashed(p, T, supply, latent, c_oil) for p in (p_d, LOWEST * p_d))
    if most <= 0.0:
        return p_d * np.linspace(LOWEST, 1.0, POINTS), np.zeros(POINTS)
    begins = least == 0.0  # below p_d
    flash = most + (least - most) * np.sin(np.linspace(0.0, np.pi / 2.0, POINTS - begins)) ** 2
    coldest = (T - solubility.LOW) * c_oil / latent
    if flash[-2] < coldest < flash[1]:
        flash[1 + np.argmin(np.abs(flash[1:-1] - coldest))] = coldest
    at = [LOWEST * p_d]
    for each in flash[1:]:
        pressure = equilibrium_pressure(supply - each, max(T - each * latent / c_oil, solubility.LOW))
        at.append(max(pressure, at[-1] * (1.0 + RISE)))
    if begins:
        at, flash = [*at, max(p_d, at[-1] * (1.0 + RISE))], np.append(flash, 0.0)
    return np.array(at), flash


def equilibrium_pressure(ratio: float, T: float) -> float:
    """Return the pressure [Pa] of the gas over oil at T [K] that holds `ratio` [kg/kg] (M195), `content`'s inverse."""
    found = pair(T)
    x = ratio / (ratio + found.mass_ratio)
    return found.p_sat * vapour(T).share(solubility.log_activity(x, *found[1:5]))


@lru_cache(maxsize=8)
def _vapour(gas: Any, T_separator: float, T: float, p_d: float) -> Reservoir:
    """Return the vapour in equilibrium with oil that is supplied at T [K] (M197)."""
    return gas.vapour(equilibrium_pressure(content(p_d, T_separator), T), T)


def heat_enthalpy(gas: Any, T_separator: float, T: float, p_d: float) -> float:
    """Return the enthalpy [J/kg] of dissolved gas by van 't Hoff's law between separator and oil supply at T (M232).

    Where the two temperatures are closer than `APART`, one at that distance from the supply takes the separator's
    place.
    """
    supply, other = content(p_d, T_separator), T_separator
    if abs(other - T) < APART:
        other = T + APART if T + APART <= HIGHEST else T - APART
    potentials = []
    for at in (T, other):
        vapour = gas.vapour(equilibrium_pressure(supply, at), at)
        potentials.append(vapour.h / at - vapour.s)
    return (potentials[1] - potentials[0]) / (1.0 / other - 1.0 / T)


@lru_cache(maxsize=256)
def most_held(T: float) -> float:
    """Return the content [kg/kg] up to which the pressure over oil at T [K] grows, below saturation; `MOST` at most.

    Below 290 K the fit is flat within 0.3 % beyond 3.9 kg/kg, and would have one pressure at two contents.
    """
    contents = np.geomspace(1.0, MOST, ROWS)
    pressures = np.array([equilibrium_pressure(float(each), T) for each in contents])
    ends = np.flatnonzero((np.diff(pressures) <= 0.0) | (pressures[1:] > (1.0 - FLAT) * pair(T).p_sat))
    return float(contents[ends[0]]) if len(ends) else MOST


@lru_cache(maxsize=32)
def solution(gas: Any, T_separator: float, T: float, p_d: float, release: float, uptake: float) -> OilSolution:
    """Return content and entropy of oil supplied at T [K] as it releases gas (M231–M233); rates in 1/s."""
    enthalpy = heat_enthalpy(gas, T_separator, T, p_d)
    z = np.linspace(math.log(LEAST), math.log(most_held(T)), ROWS)
    vapours = [gas.vapour(equilibrium_pressure(math.exp(each), T), T) for each in z]
    entropies = cubic.coefficients(z, np.array([each.s - (each.h - enthalpy) / T for each in vapours]))
    entropy, slope, held = cubic.at_points(z, entropies), cubic.slopes_at_points(z, entropies), np.exp(z)
    falls = cubic.coefficients(z, -held * slope)
    rest = cubic.at_points(z, cubic.integral(z, falls)) + falls[-1, 0]
    below = rest / held  # below the tables, in proportion to what is held
    return OilSolution(z, entropy, slope, below, enthalpy, content(p_d, T_separator), release, uptake)


def build(parameters: Parameters, machine) -> list[OilGas | Plenum]:
    T_separator = parameters.separator_temperature or 0.0  # stated, or the current value of the search
    flash_time, absorption_time = parameters.flash_time, parameters.absorption_time

    def content_of(site: Site) -> OilContent | OilSolution:
        assert site.T_oil is not None and site.oil is not None  # needs_oil
        if flash_time is not None:
            uptake = 0.0 if absorption_time is None else 1.0 / absorption_time
            return solution(site.gas, T_separator, site.T_oil, site.p_d, 1.0 / flash_time, uptake)
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
    if facts.oil is not None and facts.oil.name is not None and not is_ester(facts.oil.name):
        what = f"is {facts.oil.name}, and effects.{NAME} knows what polyol esters dissolve"
        faults.append(Fault("oil.name", f"{what} (choose a POE, or remove the effect)"))
    if facts.gas.name != solubility.FLUID:
        faults.append(
            Fault(path, f"covers {solubility.FLUID} in POE oil only, not {facts.gas.name} (remove the effect)")
        )
        return faults
    if parameters.absorption_time is not None and parameters.flash_time is None:
        what = "has no meaning where the oil flashes at once in the port"
        faults.append(Fault(f"{path}.absorption_time", f"{what} (state flash_time, or remove it)"))
    if "oil_injection" not in facts.effects:
        faults.append(Fault(path, "needs effects.oil_injection, at whose port the oil flashes (add it)"))
    stated = {f"{path}.separator_temperature": parameters.separator_temperature}
    stated["oil_supply.temperature"] = facts.oil_supply.temperature
    if parameters.separator_temperature is None and SEPARATOR not in facts.effects:
        remedy = f"write e.g. separator_temperature: 60 degC, or name effects.{SEPARATOR}, which finds it"
        faults.append(Fault(f"{path}.separator_temperature", f"is missing ({remedy})"))
    for where, T in stated.items():
        if T is not None and not solubility.LOW <= T <= HIGHEST:
            reach = f"{in_celsius(solubility.LOW)} to {in_celsius(HIGHEST)}, where the solubility is known"
            what = f"{in_celsius(T)} lies outside {reach} (choose one inside, or remove effects.{NAME})"
            faults.append(Fault(where, what))
    p_d, T = discharge_pressure(facts), parameters.separator_temperature
    if T is None:
        return faults
    if not faults and p_d is not None and p_d >= pair(T).p_sat:
        what = f"at {in_celsius(T)} the gas condenses in the separator, at {in_bar(p_d)}"
        faults.append(Fault(f"{path}.separator_temperature", f"{what} (state a warmer separator)"))
    elif not faults and p_d is not None and parameters.flash_time is not None:
        held = content(p_d, T)
        most = MOST if facts.oil_supply.temperature is None else most_held(facts.oil_supply.temperature)
        if not LEAST < held < most:
            what = (
                f"oil from there holds {held:.3g} kg of gas per kg, and the rate is known from {LEAST:g} to {most:.3g}"
            )
            remedy = "state another one, or warmer oil_supply, or remove flash_time" if most < MOST else OTHERWISE
            faults.append(Fault(f"{path}.separator_temperature", f"{what} ({remedy})"))
    return faults


EFFECT = Effect(
    name=NAME,
    title="refrigerant dissolved in the injected oil flashes in the chamber",
    equations=("M195", "M196", "M197", "M230", "M231", "M232", "M233", "M234"),
    source="Grebner 1992 (Heil's model); flash and rate: ours",
    parameters=Parameters,
    build=build,
    needs_oil=True,
    states=("T_oil", "x_oil"),
    check=check,
    needs=frozenset({OIL}),
    figures=FIGURES,
    roles={HELD[0]: ".flash_time"},
    in_expander="never",
)
