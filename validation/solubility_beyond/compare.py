"""M198 beyond the critical temperature: measured solubilities of carbon dioxide in an ester, up to 1.13 of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from screwsim.fluid.constants import limits
from screwsim.fluid.solubility_laws import Measured, Point, read_points
from screwsim.study.validation import Comparison, Panel, Row, Series, equal

TITLE = "CO₂ dissolved in an ester beyond its critical temperature"
CITATION = (
    "points of CO₂ in pentaerythritol tetraoctanoate as in ExpData/PEC8_CO2 of github.com/Runnizone/OilMixProp; form: "
    "Flory 1942, Huggins 1942, Prausnitz & Shair 1961"
)
ABOUT = """\
CO₂ is above its critical temperature in every warm separator, where there is no saturation to refer to: M198 goes on
with a straight line of ln p over 1/T. Three constants are fitted to the points of all temperatures but one, and the
pressures at the one that is left out are predicted. They hold where their mean is within what the fit misses its own
points by (root mean square). The first row has all points.

No row is a prediction: that the density in the law stays from 0.85 of the critical temperature on was chosen in view of
these points, of R125 and R143a in an alkylbenzene and of these and R32 in an ester (SorpPropLib)."""
FLUID = "CO2"
Array = np.ndarray


def off(law: Measured, points: Sequence[Point]) -> Array:
    """Return by what a law's pressures are off the points [%]."""
    found = [law.equilibrium_pressure(each.ratio, each.T) / each.p - 1.0 for each in points]
    return 100.0 * np.array(found)


def rows(points: Sequence[Point], T_critical: float) -> list[Row]:
    """Return the misfit of all points, and the mean deviations at temperatures that are left out, but the ends."""
    law = Measured(FLUID, points)
    note = f"{len(points)} points at {celsius(min(each.T for each in points))} to {celsius(law.high)} °C"
    quantity = "M198 fitted to all points: root mean square of its pressures"
    found = [Row(quantity, 100.0 * law.misfit, None, "calibrated", "no verdict", "%", note=note)]
    for T in sorted({each.T for each in points})[1:-1]:
        rest, left = [each for each in points if each.T != T], [each for each in points if each.T == T]
        fitted = Measured(FLUID, rest)
        misses = off(fitted, left)
        at = f"{celsius(T)} °C, {T / T_critical:.2f} T_c"
        quantity = f"pressure at {at}, from other temperatures: mean of {len(left)} points"
        basis = "misfit of the other points"
        note = f"{misses.min():+.0f} to {misses.max():+.0f} % at single points"
        spread = 100.0 * fitted.misfit
        found.append(equal(quantity, float(misses.mean()), 0.0, spread, "calibrated", unit="%", basis=basis, note=note))
    return found


def celsius(T: float) -> str:
    """Return a temperature [K] in °C."""
    return f"{T - 273.15:.0f}"


def picture(points: Sequence[Point]) -> Panel:
    """Return pressures over the content at the temperatures beyond the critical one."""
    law, series = Measured(FLUID, points), []
    for T in sorted({each.T for each in points})[-2:]:
        at = [each for each in points if each.T == T]
        percent = [100.0 * each.ratio / (1.0 + each.ratio) for each in at]
        pressures = [1e-5 * law.equilibrium_pressure(each.ratio, T) for each in at]
        series.append(Series(f"M198, {celsius(T)} °C", percent, pressures))
        series.append(Series(f"measured, {celsius(T)} °C", percent, [1e-5 * each.p for each in at], theirs=True))
    return Panel("CO₂ in the solution / % of the mass", "pressure / bar", series)


def compare(here: Path) -> Comparison:
    """Return the comparison."""
    points, known = read_points(str(here / "carbon_dioxide.csv"), FLUID), limits(FLUID)
    assert known is not None
    return Comparison(TITLE, CITATION, ABOUT, rows(points, known.T_critical), [picture(points)])
