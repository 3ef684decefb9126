"""Viscosity of oil that holds dissolved refrigerant: M199 and other rules beside measured solutions of isobutane."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import CoolProp.CoolProp as coolprop
import numpy as np

from screwsim.fluid.solution_viscosity import solution_viscosity
from screwsim.study.validation import Comparison, Panel, Row, Series, equal, read_table

TITLE = "Viscosity of oil that holds refrigerant"
CITATION = (
    "M. A. Marcelino Neto, J. R. Barbosa, Fluid Phase Equilib. 292 (2010) 7 (isobutane, alkylbenzene ISO 5), as in "
    "ExpData/LAB_ISO5 of github.com/Runnizone/OilMixProp; rules: Yokozeki 1994, Conde 1996"
)
ABOUT = """\
Nothing here is fitted: M199 has the viscosities of pure oil and of liquid isobutane, and an exponent that its source
found with other pairs. An oil of ISO 5 is thinner than that of screws, and isobutane no refrigerant of theirs: of R134a
in an ester no measured viscosities could be had. How to read the rows:

- The points are all of the source's that hold up to 35 % of isobutane, at 23 to 80 °C.
- The oil's viscosity is a curve through the source's nine values of pure oil; its molar mass, 240 g/mol, is that of the
  collection.
- ± is how far the points themselves lie from a smooth surface over content and temperature (root mean square)."""
M_ISOBUTANE, M_OIL = 58.1222, 240.0  # [g/mol]
WARM = 333.15  # [K] of the picture
ENDS = (0.0, 10.0, 20.0, 35.0)  # [%] of the ranges that are judged
COLUMNS = ("temperature_K", "refrigerant_percent", "viscosity_mPa_s")
OIL_COLUMNS = ("temperature_K", "viscosity_mPa_s", "density_kg_m3")
Array = np.ndarray


class Measured(NamedTuple):
    """Solutions: temperature [K], isobutane's share of the mass, viscosity [Pa s]; and those of oil and isobutane."""

    T: Array
    w: Array
    mu: Array
    oil: Array
    oil_density: Array
    isobutane: Array
    isobutane_density: Array


def measured(here: Path) -> Measured:
    """Return the source's points, with pure oil by a quadratic of the logarithm over 1/T."""
    rows, pure = read_table(here / "isobutane.csv"), read_table(here / "oil.csv")
    T, w, mu = (np.array([float(row[name]) for row in rows]) for name in COLUMNS)
    T_oil, mu_oil, rho_oil = (np.array([float(row[name]) for row in pure]) for name in OIL_COLUMNS)
    oil = 1e-3 * np.exp(np.polyval(np.polyfit(1.0 / T_oil, np.log(mu_oil), 2), 1.0 / T))
    rho = np.polyval(np.polyfit(T_oil, rho_oil, 1), T)
    liquid, liquid_rho = (np.array([coolprop.PropsSI(of, "T", each, "Q", 0, "IsoButane") for each in T]) for of in "VD")
    return Measured(T, 1e-2 * w, 1e-3 * mu, oil, rho, liquid, liquid_rho)


def by_m199(of: Measured) -> Array:
    """Return the viscosities [Pa s] of M199."""
    rows = zip(of.w / (1.0 - of.w), of.isobutane, of.oil, strict=True)
    return np.array([solution_viscosity(*map(float, row), M_ISOBUTANE, M_OIL) for row in rows])


def by_masses(of: Measured) -> Array:
    """Return those of kinematic viscosities with shares of the mass (Schroeder, by Conde)."""
    density = 1.0 / (of.w / of.isobutane_density + (1.0 - of.w) / of.oil_density)
    logarithm = of.w * np.log(of.isobutane / of.isobutane_density) + (1.0 - of.w) * np.log(of.oil / of.oil_density)
    return density * np.exp(logarithm)


def by_moles(of: Measured) -> Array:
    """Return those of Grunberg and Nissan's rule with G = 0, by shares of the molecules."""
    x = of.w / M_ISOBUTANE / (of.w / M_ISOBUTANE + (1.0 - of.w) / M_OIL)
    return np.exp(x * np.log(of.isobutane) + (1.0 - x) * np.log(of.oil))


OTHERS: dict[str, Callable[[Measured], Array]] = {
    "that of pure oil": lambda of: of.oil,
    "the rule of masses and kinematic viscosities (Conde)": by_masses,
    "the rule of molecules (Grunberg and Nissan, G = 0)": by_moles,
}


def scatter(of: Measured) -> float:
    """Return how far the points lie from a smooth surface of the logarithm (root mean square) [%]."""
    a, b = of.w, 300.0 / of.T - 1.0
    rows = np.stack([np.ones_like(a), a, b, a * a, a * b, b * b], axis=1)
    off = rows @ np.linalg.lstsq(rows, np.log(of.mu), rcond=None)[0] - np.log(of.mu)
    return 100.0 * float(np.sqrt(np.sum(off**2) / (len(a) - rows.shape[1])))


def told(off: Array) -> str:
    """Return the ends and the root mean square of deviations [%]."""
    return f"{off.min():+.0f} to {off.max():+.0f} % at single points, root mean square {np.sqrt(np.mean(off**2)):.0f} %"


def rows(of: Measured) -> list[Row]:
    """Return the mean deviations of M199 in each range of contents, and of other rules over all."""
    off, spread = 100.0 * (by_m199(of) / of.mu - 1.0), scatter(of)
    found = []
    for low, high in pairwise(ENDS):
        inside = (low < 100.0 * of.w) & (100.0 * of.w <= high)
        quantity = f"viscosity by M199, {low:g} to {high:g} % of isobutane: mean of {inside.sum()} points"
        basis = "scatter of the points"
        mean = float(off[inside].mean())
        found.append(equal(quantity, mean, 0.0, spread, "published", unit="%", basis=basis, note=told(off[inside])))
    for name, rule in OTHERS.items():
        other = 100.0 * (rule(of) / of.mu - 1.0)
        quantity = f"{name}: mean of {len(other)} points"
        found.append(Row(quantity, float(other.mean()), None, "estimate", "no verdict", "%", note=told(other)))
    return found


def picture(of: Measured) -> Panel:
    """Return viscosities over the content at 60 °C: measured, by M199 and of pure oil."""
    at = np.abs(of.T - WARM) < 1.0
    percent = (100.0 * of.w[at]).tolist()
    series = [
        Series("M199", percent, (1e3 * by_m199(of)[at]).tolist()),
        Series("pure oil", percent, (1e3 * of.oil[at]).tolist()),
        Series("measured, 60 °C", percent, (1e3 * of.mu[at]).tolist(), theirs=True),
    ]
    return Panel("isobutane in the solution / % of the mass", "viscosity / mPa s", series, log_y=True)


def compare(here: Path) -> Comparison:
    """Return the comparison."""
    of = measured(here)
    return Comparison(TITLE, CITATION, ABOUT, rows(of), [picture(of)])
