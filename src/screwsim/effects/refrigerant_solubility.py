"""Refrigerant solubility: gas that the injected oil brings dissolved flashes where it enters the chamber.

What: oil leaves the separator saturated with gas at discharge pressure and the separator's temperature and is cooled.
What it holds is known of R134a in polyol esters (M195), and of a pure refrigerant in any oil by measured points,
`points_file`, to which a law of Flory and Huggins is fitted (M198). Without `flash_time` it flashes adiabatically to
equilibrium at the chamber's pressure as it enters (M196): a further stream of gas, whose heat of evaporation the oil
supplies. With `flash_time` the dissolved gas is a state of the chamber that travels with the oil through leaks and
ports (M230); oil that holds more than in equilibrium releases it with that time constant (M231), and oil that holds
less absorbs gas with `absorption_time`, if that is stated. In the separator the oil absorbs that gas again, so that
delivery equals suction; the machine compresses the flashed gas for nothing. With `films_at` it makes the oil thinner in
films (bearings, oil drag, the viscous term of hydromechanical losses) and in the pump's line (M199).
Source: model: J. F. Heil, J. M. Prausnitz, AIChE J. 12 (1966) 678; constants: J. J. Grebner, 1992; by measured points:
P. J. Flory, J. Chem. Phys. 10 (1942) 51, M. L. Huggins, Ann. N. Y. Acad. Sci. 43 (1942) 1; flash, rate and balances
ours. No source gives the time constants of oil in a screw compressor's chamber: they are assumptions.
Assumptions: the oil's density and heat capacity are those of pure oil, its viscosity, too, except where `films_at`
changes it, and always in bores, drops and gaps; films hold what is supplied, or what they have in equilibrium with gas
of the line that `films_at` names where that is less; no gas is taken up between separator and port. Flash in the port:
it is complete there; gas that stays dissolved goes with the oil to discharge, it does not flash again in leaks to lower
pressure, and no gas is taken up during compression; heat of solution is that of evaporation, excess enthalpy neglected.
Over time: all oil of a chamber holds the same; dissolved gas has one enthalpy, that which M195 gives between separator
and supply, and with it the equilibrium at other temperatures (M232). Needs effects.oil_injection.
Parameters: separator_temperature, points_file, flash_time, absorption_time, films_at, oil_molar_mass.
"""

import math
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

import numpy as np

from screwsim.effects.base import (
    Drawn,
    Effect,
    InSeparator,
    OilContent,
    OilGas,
    OilSolution,
    OilThinning,
    Plenum,
    Site,
)
from screwsim.effects.oil_injection import discharge_pressure
from screwsim.effects.parts.thinned_oil import (
    SUPPLIED_OIL_VISCOSITY,
    declared_films,
    declared_molar_mass,
    thinning,
    thinning_faults,
)
from screwsim.fluid import constants
from screwsim.fluid.oils import is_ester
from screwsim.fluid.reservoir import Reservoir
from screwsim.fluid.solubility_laws import COLUMNS, ESTER, Measured, SolubilityLaw, law_of_points, read_points
from screwsim.inputs.declare import file, optional
from screwsim.inputs.faults import Fault, UsageError
from screwsim.machine.protocol import OIL
from screwsim.numerics import cubic
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
    Figure(
        "solubility_misfit",
        "1",
        "root mean square by which the law of M198 misses the pressures of points_file",
        needs=(".points_file",),
    ),
    SUPPLIED_OIL_VISCOSITY,
)
POINTS = 81  # rows of the table over pressure
LOWEST = 0.02  # share of the separator's pressure below which the flashed amount is held constant
RISE = 1e-6  # least relative rise of pressure from row to row: oil as warm as the separator flashes from p_d on
LEAST = 1e-6  # [kg/kg] least content of a solution's tables; below, the equilibrium is held constant
ROWS = 401  # rows of those tables
OTHERWISE = "state another one, or remove flash_time"
TO_MOST = 0.05  # of the most that a law knows: least content that is looked at for the end of the tables
FLAT = 1e-4  # distance from saturation, over its pressure, from which on a solution's tables end
BEYOND = 0.1  # [K] tolerated beyond the law's temperatures: a search passes a thermostat's by less
APART = 5.0  # [K] least distance of the two temperatures that the heat of solution is derived from


@dataclass(frozen=True)
class Parameters(InSeparator):
    """Where the oil was in equilibrium with gas, and how fast it comes to equilibrium in the chamber."""

    points_file: str | None = file(
        f"CSV with columns {', '.join(COLUMNS)} (of the solution's mass; absolute pressures), and refrigerant (its "
        "name) if wanted: what the oil dissolves"
    )
    flash_time: float | None = optional(
        "time", "time in which oil in a chamber gives off gas beyond equilibrium (absent: at once, in the port)"
    )
    absorption_time: float | None = optional(
        "time", "time in which it absorbs gas (absent: it does not; needs flash_time)"
    )
    films_at: str | None = declared_films()
    oil_molar_mass: float | None = declared_molar_mass()


def law_of(parameters: Parameters, fluid: str) -> SolubilityLaw:
    """Return the law of what the oil dissolves of a fluid; raise UsageError where the points give none."""
    return ESTER if parameters.points_file is None else law_of_points(fluid, read_points(parameters.points_file, fluid))


def flashed(law: SolubilityLaw, p: float, T: float, supply: float, latent: float, c_oil: float) -> float:
    """Return the gas that flashes adiabatically [kg per kg of oil] when oil at T [K] comes to p [Pa] (M196).

    `supply` is its content before [kg/kg], `latent` [J/kg] the heat of evaporation, `c_oil` [J/(kg K)] its heat
    capacity.
    """

    def excess(flash: float) -> float:
        return supply - flash - law.content(p, max(T - flash * latent / c_oil, law.low))

    if supply <= 0.0 or excess(0.0) <= 0.0:
        return 0.0
    return brentq(excess, 0.0, supply, xtol=1e-12)


@lru_cache(maxsize=64)
def _content(law: SolubilityLaw, gas: Any, T_separator: float, T: float, p_d: float, c_oil: float) -> OilContent:
    supply, latent = law.content(p_d, T_separator), heat_of_flash(law, gas, T_separator, T, p_d)
    return OilContent(*_flashes(law, T, p_d, supply, latent, c_oil), latent)


def heat_of_flash(law: SolubilityLaw, gas: Any, T_separator: float, T: float, p_d: float) -> float:
    """Return the heat [J/kg] that flashing gas takes from oil at T [K] (M196).

    That of evaporation, or by van 't Hoff's law (M232) where the law reaches beyond the saturation of the refrigerant.
    """
    if law.beyond:
        return _vapour(law, gas, T_separator, T, p_d).h - heat_enthalpy(law, gas, T_separator, T, p_d)
    p_sat = constants.dew_pressure(law.fluid, T)
    return constants.wet_enthalpy(law.fluid, p_sat, 1.0) - constants.wet_enthalpy(law.fluid, p_sat, 0.0)


def _flashes(
    law: SolubilityLaw, T: float, p_d: float, supply: float, latent: float, c_oil: float
) -> tuple[Array, Array]:
    """Return pressures [Pa] up to p_d and the gas that flashes at each [kg/kg] (M196), in `POINTS` rows.

    Rows are dense in the flashed amount where it begins and where it ends; their pressures follow from it without a
    search. One row lies where the oil reaches the law's coldest temperature. As many rows, whether it
    begins to flash below p_d or only there, let the table change smoothly as the supply passes the separator's
    temperature.
    """
    least, most = (flashed(law, p, T, supply, latent, c_oil) for p in (p_d, LOWEST * p_d))
    if most <= 0.0:
        return p_d * np.linspace(LOWEST, 1.0, POINTS), np.zeros(POINTS)
    flash = most + (least - most) * np.sin(np.linspace(0.0, np.pi / 2.0, POINTS - 1)) ** 2
    coldest = (T - law.low) * c_oil / latent
    if flash[-2] < coldest < flash[1]:
        flash[1 + np.argmin(np.abs(flash[1:-1] - coldest))] = coldest
    at = [LOWEST * p_d]
    for each in flash[1:]:
        pressure = law.equilibrium_pressure(supply - each, max(T - each * latent / c_oil, law.low))
        at.append(max(pressure, at[-1] * (1.0 + RISE)))
    return np.array([*at, max(p_d, at[-1] * (1.0 + RISE))]), np.append(flash, flash[-1])


@lru_cache(maxsize=8)
def _vapour(law: SolubilityLaw, gas: Any, T_separator: float, T: float, p_d: float) -> Reservoir:
    """Return the vapour in equilibrium with oil that is supplied at T [K] (M197)."""
    return gas.vapour(law.equilibrium_pressure(law.content(p_d, T_separator), T), T)


def heat_enthalpy(law: SolubilityLaw, gas: Any, T_separator: float, T: float, p_d: float) -> float:
    """Return the enthalpy [J/kg] of dissolved gas by van 't Hoff's law between separator and oil supply at T (M232).

    Where the two temperatures are closer than `APART`, one at that distance from the supply takes the separator's
    place.
    """
    supply, other = law.content(p_d, T_separator), T_separator
    if abs(other - T) < APART:
        other = T + APART if T + APART <= law.high else T - APART
    potentials = []
    for at in (T, other):
        vapour = gas.vapour(law.equilibrium_pressure(supply, at), at)
        potentials.append(vapour.h / at - vapour.s)
    return (potentials[1] - potentials[0]) / (1.0 / other - 1.0 / T)


@lru_cache(maxsize=256)
def most_held(law: SolubilityLaw, T: float) -> float:
    """Return the content [kg/kg] up to which the pressure over oil at T [K] grows, below saturation; the law's at most.

    Below 290 K the fit of M195 is flat within 0.3 % beyond 3.9 kg/kg, and would have one pressure at two contents.
    """
    contents = np.geomspace(TO_MOST * law.most, law.most, ROWS)
    pressures = np.array([law.equilibrium_pressure(float(each), T) for each in contents])
    ends = np.flatnonzero((np.diff(pressures) <= 0.0) | (pressures[1:] > (1.0 - FLAT) * law.p_sat(T)))
    return float(contents[ends[0]]) if len(ends) else law.most


@lru_cache(maxsize=32)
def solution(
    law: SolubilityLaw, gas: Any, T_separator: float, T: float, p_d: float, release: float, uptake: float
) -> OilSolution:
    """Return content and entropy of oil supplied at T [K] as it releases gas (M231–M233); rates in 1/s."""
    enthalpy = heat_enthalpy(law, gas, T_separator, T, p_d)
    z = np.linspace(math.log(LEAST), math.log(most_held(law, T)), ROWS)
    vapours = [gas.vapour(law.equilibrium_pressure(math.exp(each), T), T) for each in z]
    entropies = cubic.coefficients(z, np.array([each.s - (each.h - enthalpy) / T for each in vapours]))
    entropy, slope, held = cubic.at_points(z, entropies), cubic.slopes_at_points(z, entropies), np.exp(z)
    falls = cubic.coefficients(z, -held * slope)
    rest = cubic.at_points(z, cubic.integral(z, falls)) + falls[-1, 0]
    below = rest / held  # below the tables, in proportion to what is held
    return OilSolution(z, entropy, slope, below, enthalpy, law.content(p_d, T_separator), release, uptake)


def build(parameters: Parameters, machine) -> list[OilGas | Plenum | OilThinning]:
    T_separator = parameters.separator_temperature or 0.0  # stated, or the current value of the search
    flash_time, absorption_time = parameters.flash_time, parameters.absorption_time

    @cache
    def law_for(fluid: str) -> SolubilityLaw:
        return law_of(parameters, fluid)

    def content_of(site: Site) -> OilContent | OilSolution:
        assert site.T_oil is not None and site.oil is not None  # needs_oil
        law = law_for(site.fluid)
        if flash_time is not None:
            uptake = 0.0 if absorption_time is None else 1.0 / absorption_time
            return solution(law, site.gas, T_separator, site.T_oil, site.p_d, 1.0 / flash_time, uptake)
        return _content(law, site.gas, T_separator, site.T_oil, site.p_d, site.oil.heat_capacity)

    def state(site: Site) -> Reservoir:
        assert site.T_oil is not None
        return _vapour(law_for(site.fluid), site.gas, T_separator, site.T_oil, site.p_d)

    thinner = thinning(parameters, law_for, T_separator)

    def figures(drawn: Drawn) -> dict[str, float | None]:
        law, site = law_for(drawn.site.fluid), drawn.site
        fitted: dict[str, float | None] = {"solubility_misfit": law.misfit} if isinstance(law, Measured) else {}
        if thinner is not None:
            assert site.T_oil is not None and site.oil is not None and site.oil.viscosity is not None  # `check`
            fitted[SUPPLIED_OIL_VISCOSITY.name] = thinner.supply(site, site.T_oil, site.oil.viscosity)
        return {
            "dissolved_gas_ratio": law.content(site.p_d, T_separator),
            "flash_mass_flow": drawn.flow,
            "flash_flow_ratio": drawn.ratio,
            **fitted,
        }

    thinned = [] if thinner is None else [thinner]
    return [OilGas(PLENUM, content_of), Plenum(PLENUM, state, figures, product=False), *thinned]


def _law(parameters: Parameters, facts, faults: list[Fault]) -> SolubilityLaw | None:
    """Return the law of a scene's pair, None without one; add to its faults."""
    path, gas = f"effects.{NAME}", facts.gas.name
    if parameters.points_file is None:
        if facts.oil is not None and facts.oil.name is not None and not is_ester(facts.oil.name):
            what = f"is {facts.oil.name}, and effects.{NAME} knows what polyol esters dissolve"
            faults.append(Fault("oil.name", f"{what} (choose a POE, state {path}.points_file, or remove the effect)"))
        if gas == ESTER.fluid:
            return ESTER
        what = f"covers {ESTER.fluid} in POE oil only, not {gas}"
        faults.append(Fault(path, f"{what} (state points_file, with measured points of {gas}, or remove the effect)"))
        return None
    if constants.parts_on_boiling(gas):
        what = f"is for a pure refrigerant; of {gas} an oil dissolves another composition"
        faults.append(Fault(f"{path}.points_file", f"{what} (remove the effect)"))
        return None
    try:
        return law_of(parameters, gas)
    except UsageError as error:
        faults.append(Fault(f"{path}.points_file", str(error)))
        return None


def check(parameters: Parameters, facts) -> list[Fault]:
    path, faults = f"effects.{NAME}", []
    law = _law(parameters, facts, faults)
    if law is None:
        return faults
    if parameters.absorption_time is not None and parameters.flash_time is None:
        what = "has no meaning where the oil flashes at once in the port"
        faults.append(Fault(f"{path}.absorption_time", f"{what} (state flash_time, or remove it)"))
    faults += thinning_faults(path, parameters, facts, law)
    if "oil_injection" not in facts.effects:
        faults.append(Fault(path, "needs effects.oil_injection, at whose port the oil flashes (add it)"))
    stated = {f"{path}.separator_temperature": parameters.separator_temperature}
    stated["oil_supply.temperature"] = facts.oil_supply.temperature
    if parameters.separator_temperature is None and SEPARATOR not in facts.effects:
        remedy = f"write e.g. separator_temperature: 60 degC, or name effects.{SEPARATOR}, which finds it"
        faults.append(Fault(f"{path}.separator_temperature", f"is missing ({remedy})"))
    for where, T in stated.items():
        if T is not None and not law.known_from - BEYOND <= T <= law.high + BEYOND:
            reach = f"{in_celsius(law.known_from)} to {in_celsius(law.high)}, where the solubility is known"
            others = "" if parameters.points_file is None else " add points there,"
            remedy = f"choose one inside,{others} or remove effects.{NAME}"
            faults.append(Fault(where, f"{in_celsius(T)} lies outside {reach} ({remedy})"))
    p_d, T = discharge_pressure(facts), parameters.separator_temperature
    return faults if faults or p_d is None or T is None else _faults_of_separator(parameters, facts, law, p_d, T)


def _faults_of_separator(parameters: Parameters, facts, law: SolubilityLaw, p_d: float, T: float) -> list[Fault]:
    """Return the fault of a separator at p_d [Pa] and T [K] in which the law does not hold, if any."""
    where, held = f"effects.{NAME}.separator_temperature", law.content(p_d, T)
    if p_d >= law.p_sat(T) and T <= law.last_liquid:
        what = f"at {in_celsius(T)} the gas condenses in the separator, at {in_bar(p_d)}"
        return [Fault(where, f"{what} (state a warmer separator)")]
    if isinstance(law, Measured) and held >= law.most:
        percent = 100.0 * law.most / (1.0 + law.most)
        known = f"the {percent:.3g} % up to which points_file tells"
        what = f"at {in_celsius(T)} and {in_bar(p_d)} the oil holds more than {known}"
        return [Fault(where, f"{what} (state a warmer separator, or points of more refrigerant)")]
    if parameters.flash_time is None:
        return []
    T_oil = facts.oil_supply.temperature
    most = law.most if T_oil is None else most_held(law, T_oil)
    if LEAST < held < most:
        return []
    what = f"oil from there holds {held:.3g} kg of gas per kg, and the rate is known from {LEAST:g} to {most:.3g}"
    remedy = "state another one, or warmer oil_supply, or remove flash_time" if most < law.most else OTHERWISE
    return [Fault(where, f"{what} ({remedy})")]


EFFECT = Effect(
    name=NAME,
    title="refrigerant dissolved in the injected oil flashes in the chamber",
    equations=("M195", "M196", "M197", "M198", "M199", "M230", "M231", "M232", "M233", "M234"),
    source="Grebner 1992 (Heil's model), or Flory and Huggins by measured points; flash and rate: ours",
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
