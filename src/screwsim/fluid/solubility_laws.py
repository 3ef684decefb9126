"""What an oil dissolves of a refrigerant: R134a in a polyol ester (M195), any pure one by measured points (M198).

A law relates the content [kg per kg of oil] to ln(f/f_sat), the vapour's fugacity over that at saturation; pressures
follow from the equation of the vapour.
"""

import math
from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from screwsim.fluid import constants, names, solubility
from screwsim.fluid.description import describe
from screwsim.fluid.reference_state import NEAR_CRITICAL, last_saturation, reference_pressure
from screwsim.fluid.transport import saturated_liquid_viscosity
from screwsim.fluid.vapour_fugacity import Fugacity, fugacity_table
from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import BadSheet, Sheet, read_sheet, sheet_or_usage_error
from screwsim.inputs.textfiles import once_per_file
from screwsim.numerics.pchip import Pchip
from screwsim.numerics.roots import brentq
from screwsim.outputs.customary import ZERO_CELSIUS, in_bar, in_celsius

Array = np.ndarray

STEP = 1.0  # [K] between the temperatures at which CoolProp is evaluated
MOST = 20.0  # [kg/kg] largest content of the ester's law
HIGHEST = 370.0  # [K] the same law's highest temperature, below the critical one
LEAST = 1e-9  # [kg/kg] content below which Henry's law holds
EXPANDS = 0.85  # of the critical temperature: from there on dissolved molecules take no more room, unlike the liquid's
REACH = 1.2  # of the critical temperature: highest temperature of points
T_0 = 300.0  # [K] reference temperature of M198
COLUMNS = "temperature_degC", "pressure_bar", "refrigerant_percent"
REFRIGERANT = "refrigerant"  # the column that names each row's refrigerant, where a file has it
# highest refrigerant_percent of a file up to which shares may stand there, and how many times as much Raoult's law has
# then in the mean: of ammonia mineral oils hold less than 1 %, a few times less than by that law
SHARES, TOO_LITTLE = 1.0, 10.0
FEWEST, SPREAD = 6, 20.0  # points, and [K] between the coldest and the warmest
COOLED = 30.0  # [K] below the coldest point, to which the law is extrapolated
POOR = 0.3  # relative distance of a point's pressure from the fitted law from which on it is refused
CHECKED = 7, 400  # temperatures and contents at which pressures are looked at


class SolubilityLaw:
    """What one oil dissolves of one refrigerant, from `low` to `high` [K] and up to `most` [kg/kg].

    Below `known_from` [K] it is an extrapolation, for oil that flashing cools. Beyond `expands_to` [K] the density of
    the refrigerant's liquid keeps its value.
    """

    def __init__(self, fluid: str, low: float, high: float, most: float) -> None:
        self.fluid, self.low, self.high, self.most = fluid, low, high, most
        self.known_from = low
        self.expands_to = self.last_liquid

    @cached_property
    def _saturation(self) -> tuple[Pchip, Pchip]:
        """ln p_sat [Pa] over 1/T and the density [kg/m³] over T [K], of the reference state."""
        T = np.linspace(self.low, self.high, 1 + math.ceil((self.high - self.low) / STEP))
        p = [reference_pressure(self.fluid, float(each)) for each in T]
        rho = [constants.saturated_liquid_density(self.fluid, min(float(each), self.expands_to)) for each in T]
        return Pchip(1.0 / T[::-1], np.log(p[::-1])), Pchip(T, np.array(rho))

    def p_sat(self, T: float) -> float:
        """Return the refrigerant's saturation pressure [Pa] at T [K], or its continuation."""
        return math.exp(self._saturation[0](1.0 / T))

    def liquid_density(self, T: float) -> float:
        """Return the density [kg/m³] of the refrigerant's saturated liquid at T [K], or its continuation."""
        return self._saturation[1](T)

    @cached_property
    def _viscosity(self) -> Pchip:
        """ln μ [Pa s] of saturated liquid over T [K]."""
        high = self.last_liquid
        low = min(self.known_from, high - COOLED)
        T = np.linspace(low, high, 1 + math.ceil((high - low) / STEP))
        return Pchip(T, np.log([saturated_liquid_viscosity(self.fluid, float(each)) for each in T]))

    @cached_property
    def last_liquid(self) -> float:
        """Highest of its temperatures [K] at which the refrigerant has a saturated liquid."""
        return min(self.high, last_saturation(self.fluid))

    @cached_property
    def beyond(self) -> bool:
        """Whether it reaches beyond the saturation of the refrigerant."""
        return self.high > self.last_liquid

    def liquid_viscosity(self, T: float) -> float:
        """Return the viscosity [Pa s] of the refrigerant's saturated liquid at T [K], the last one beyond its end.

        Raises UsageError where there is none.
        """
        return math.exp(self._viscosity(min(T, self.last_liquid)))

    def within(self, T: float) -> float:
        """Return T [K], or the end of the law's temperatures beyond which it lies."""
        return min(max(T, self.known_from), self.high)

    def vapour(self, T: float) -> Fugacity:
        """Return the fugacity of the refrigerant's vapour at T [K]."""
        return _vapour(self, T)

    def log_activity(self, ratio: float, T: float) -> float:
        """Return ln(f/f_sat) of vapour over oil at T [K] that holds `ratio` [kg/kg]."""
        raise NotImplementedError

    def content(self, p: float, T: float) -> float:
        """Return the refrigerant dissolved in equilibrium [kg per kg of oil] at p [Pa] and T [K]; `most` at most."""
        raise NotImplementedError

    def equilibrium_pressure(self, ratio: float, T: float) -> float:
        """Return the pressure [Pa] of vapour over oil at T [K] that holds `ratio` [kg/kg], `content`'s inverse."""
        return self.p_sat(T) * self.vapour(T).share(self.log_activity(ratio, T))


class Ester(SolubilityLaw):
    """R134a in a polyol ester by Heil's model (M195)."""

    def pair(self, T: float) -> solubility.RefrigerantOilPair:
        """Return the model's constants at T [K]."""
        return _pair(self, T)

    def log_activity(self, ratio: float, T: float) -> float:
        """Return ln(f/f_sat) of vapour over oil at T [K] that holds `ratio` [kg/kg]."""
        found = self.pair(T)
        return solubility.log_activity(ratio / (ratio + found.mass_ratio), *found[1:5])

    def content(self, p: float, T: float) -> float:
        """Return the R134a dissolved in equilibrium [kg per kg of oil] at p [Pa] and T [K]."""
        found = self.pair(T)
        return solubility.dissolved(found.p_sat * self.vapour(T).ratio(p / found.p_sat), *found)


class Point(NamedTuple):
    """A measured point: its line in the file, temperature [K], pressure [Pa], content [kg per kg of oil]."""

    line: int
    T: float
    p: float
    ratio: float


class Measured(SolubilityLaw):
    """A pure refrigerant in an oil by Flory and Huggins' law, fitted to measured points (M198).

    It holds up to the largest content, or to where the fitted pressure no longer rises with it (near saturation).
    `misfit` is the root mean square of the relative distances of the points' pressures from the fitted law. Raises
    UsageError, in one line, for points that give no law.
    """

    oil_density = 950.0  # [kg/m³] of the volume fractions; the constants absorb what it is off by

    def __init__(self, fluid: str, points: Sequence[Point]) -> None:
        _check_points(fluid, points)
        T = [each.T for each in points]
        low = max(min(T) - COOLED, _ends(fluid)[0])
        super().__init__(fluid, low, max(T), max(each.ratio for each in points))
        self.known_from, self.expands_to = min(T), EXPANDS * last_saturation(fluid) / NEAR_CRITICAL
        rows, logarithms = [], []
        for each in points:
            ideal, oil = self._ideal(each.ratio, each.T)
            rows.append([oil * oil, oil * oil * T_0 / each.T, oil**3])
            logarithms.append(math.log(self.vapour(each.T).ratio(each.p / self.p_sat(each.T))) - ideal)
        self._constants: tuple[float, float, float] = tuple(np.linalg.lstsq(rows, logarithms, rcond=None)[0].tolist())
        off = np.array([self.equilibrium_pressure(each.ratio, each.T) / each.p - 1.0 for each in points])
        self.misfit = float(np.sqrt(np.mean(off**2)))
        worst = int(np.argmax(np.abs(off)))
        if abs(off[worst]) > POOR:
            what = f"has a pressure that the law fitted to all points misses by {100.0 * off[worst]:+.0f} %"
            raise UsageError(f"line {points[worst].line}: {what} (check it, or leave it out)")
        self.most = self._rising()
        if sum(each.ratio <= self.most for each in points) < FEWEST:
            percent = 100.0 * self.most / (1.0 + self.most)
            what = f"imply two contents of one pressure from {percent:.3g} % on, as of two liquids"
            raise UsageError(f"{what} (leave out the points of most refrigerant)")

    def _rising(self) -> float:
        """Return the content [kg/kg], `most` at most, up to which pressures rise with it at all temperatures."""
        contents = np.geomspace(self.most / CHECKED[1], self.most, CHECKED[1])
        for T in np.linspace(self.known_from, self.high, CHECKED[0]):
            falls = np.diff([self.log_activity(float(each), float(T)) for each in contents]) <= 0.0
            contents = contents[: 1 + int(np.argmax(falls))] if falls.any() else contents
        return float(contents[-1])

    def _ideal(self, ratio: float, T: float) -> tuple[float, float]:
        """Return ln(f/f_sat) without interaction, and the oil's share of the volume."""
        refrigerant, oil = ratio / self.liquid_density(T), 1.0 / self.oil_density
        share = oil / (refrigerant + oil)
        return math.log(refrigerant / (refrigerant + oil)) + share, share

    def log_activity(self, ratio: float, T: float) -> float:
        """Return ln(f/f_sat) of vapour over oil at T [K] that holds `ratio` [kg/kg] (M198)."""
        (ideal, oil), (a, b, c) = self._ideal(ratio, T), self._constants
        return ideal + (a + b * T_0 / T + c * oil) * oil * oil

    def content(self, p: float, T: float) -> float:
        """Return the refrigerant dissolved in equilibrium [kg per kg of oil] at p [Pa] and T [K]; `most` at most."""
        if p <= 0.0:
            return 0.0
        ratio = self.vapour(T).ratio(p / self.p_sat(T))
        wanted, least = math.log(ratio), self.log_activity(LEAST, T)
        if wanted <= least:
            return LEAST * math.exp(wanted - least)
        if wanted >= self.log_activity(self.most, T):
            return self.most
        ends = math.log(LEAST), math.log(self.most)
        return math.exp(brentq(lambda z: self.log_activity(math.exp(z), T) - wanted, *ends, xtol=1e-13))


@lru_cache(maxsize=256)
def _pair(law: Ester, T: float) -> solubility.RefrigerantOilPair:
    return solubility.pair(T, law.p_sat(T), law.liquid_density(T))


@lru_cache(maxsize=256)
def _vapour(law: SolubilityLaw, T: float) -> Fugacity:
    return fugacity_table(law.fluid, law.low, law.high).at(T)


ESTER = Ester(solubility.FLUID, solubility.LOW, HIGHEST, MOST)


@once_per_file
def read_points(path: str, fluid: str) -> tuple[Point, ...]:
    """Return the measured points of a fluid in a CSV file; raise UsageError in one line where it has none.

    Rows of other refrigerants are left out, where the file names them.
    """
    columns = f"the columns {', '.join(COLUMNS)}"
    found = []
    with sheet_or_usage_error(f"name a CSV file with {columns}"):
        sheet = read_sheet(path)
        others = _lines_of_others(sheet, fluid)
        for line, cells in sheet.columns(*COLUMNS):
            if line in others:
                continue
            try:
                celsius, bar, percent = map(float, cells)
            except ValueError:
                raise BadSheet(f"has a cell that is not a number in {columns} (write one)", line) from None
            if not (math.isfinite(celsius) and 0.0 < bar < math.inf and 0.0 < percent < 100.0):
                what = "has a pressure not above 0, or refrigerant not between 0 and 100 % of the solution's mass"
                raise BadSheet(f"{what} (leave the row out)", line)
            found.append(Point(line, ZERO_CELSIUS + celsius, 1e5 * bar, percent / (100.0 - percent)))
    return tuple(found)


def _lines_of_others(sheet: Sheet, fluid: str) -> set[int]:
    """Return the lines that name another refrigerant; raise BadSheet where all do, or for an unknown one."""
    if REFRIGERANT not in sheet.names:
        return set()
    named = {line: name for line, (name,) in sheet.columns(REFRIGERANT)}
    for line, name in named.items():
        if constants.limits(name) is None:
            same = names.same_fluid(name)
            remedy = f"; did you mean {same}?" if same else " (write e.g. R134a)"
            raise BadSheet(f"{name!r} is no refrigerant that CoolProp has{remedy}", line)
    others = {line for line, name in named.items() if describe(name).name != describe(fluid).name}
    if others and len(others) == len(named):
        has = ", ".join(dict.fromkeys(named.values()))
        raise BadSheet(f"has points of {has}, none of {fluid} (name a file that has, or remove the effect)")
    return others


@lru_cache(maxsize=8)
def law_of_points(fluid: str, points: tuple[Point, ...]) -> Measured:
    """Return the law of a pure refrigerant that is fitted to measured points; raise UsageError where they give none."""
    return Measured(fluid, points)


def _ends(fluid: str) -> tuple[float, float]:
    """Return the temperatures [K] between which points give a law."""
    known = constants.limits(fluid)
    assert known is not None  # a fluid of a scene
    return known.T_triple, REACH * known.T_critical


def _check_points(fluid: str, points: Sequence[Point]) -> None:
    """Raise UsageError for a point beside the vapour's saturation, and for too few or too similar ones."""
    lowest, highest = _ends(fluid)
    for each in points:
        if not lowest < each.T <= highest:
            ends = f"{in_celsius(lowest)} to {in_celsius(highest)}, where the law of M198 holds for {fluid}"
            what = f"{in_celsius(each.T)} is outside {ends}"
            raise UsageError(f"line {each.line}: {what} (write it in degC, or leave the row out)")
        p_sat = reference_pressure(fluid, each.T)
        if each.p >= p_sat and each.T > last_saturation(fluid):
            what = f"at {in_celsius(each.T)} the law of M198 holds below {in_bar(p_sat)}, not at {in_bar(each.p)}"
            raise UsageError(f"line {each.line}: {what} (write absolute pressures in bar, or leave the row out)")
        if each.p >= p_sat:
            what = f"{in_bar(each.p)} is not below {in_bar(p_sat)}, at which {fluid} condenses at {in_celsius(each.T)}"
            raise UsageError(f"line {each.line}: {what} (write absolute pressures in bar; leave out rows of liquid)")
    T, contents = [each.T for each in points], {each.ratio for each in points}
    if len(points) < FEWEST or max(T) - min(T) < SPREAD or len(contents) < FEWEST // 2:
        what = f"needs at least {FEWEST} points, with {FEWEST // 2} contents and {SPREAD:g} K from coldest to warmest"
        raise UsageError(f"{what} (write more of them)")
    _refuse_shares(fluid, points)


def _refuse_shares(fluid: str, points: Sequence[Point]) -> None:
    """Raise UsageError where all contents are so small that shares must stand in place of percent."""
    most = 100.0 * max(each.ratio / (1.0 + each.ratio) for each in points)
    less = [math.log(_raoult(fluid, each.p, each.T) / each.ratio) for each in points]
    if most <= SHARES and sum(less) > len(less) * math.log(TOO_LITTLE):
        what = f"has no {COLUMNS[-1]} above {most:.3g}, as if they were shares"
        raise UsageError(f"{what} (write percent of the solution's mass: {100.0 * most:.3g} for {most:.3g})")


def _raoult(fluid: str, p: float, T: float) -> float:
    """Return the content [kg/kg] by Raoult's law of an oil as heavy as M195's, at p [Pa] below saturation and T [K]."""
    x = p / reference_pressure(fluid, T)
    return x / (1.0 - x) * describe(fluid).molar_mass / solubility.M_OIL
