"""How far M195 and the source's own equation lie from the measured points of an oil."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from screwsim.fluid.solubility import M_REFRIGERANT, dissolved, log_activity
from screwsim.fluid.solubility_laws import ESTER

MOST = 0.8  # share of the saturation pressure up to which contents are compared
SLIP = 1.0  # relative deviation of a pressure from its source's own equation from which on the point is a slip
FRACTIONS = np.linspace(0.01, 0.97, 97)
Array = np.ndarray


class Deviations(NamedTuple):
    """Relative deviations at the points of an oil that are no slips.

    `content` of M195, `ideal` of M195 with pressures in place of fugacities, and `scatter` of the source's own
    equation, from the contents measured below `MOST` at the temperatures `T` [K]; `pressure` of M195, and
    `ideal_pressure` with pressures, from the pressures measured over all contents. `mole` and `mass` are the mean
    deviations of the own equation's pressures with the stored loadings as mole fractions, and as the likeliest of
    masses; `slips` a number of points.
    """

    T: Array
    content: Array
    ideal: Array
    scatter: Array
    pressure: Array
    ideal_pressure: Array
    mole: float
    mass: float
    slips: int


def ratio(x: float, molar_mass: float) -> float:
    """Return kilograms of R134a per kilogram of an oil [kg/mol] at its mole fraction."""
    return M_REFRIGERANT * x / (molar_mass * (1.0 - x))


def mole_fraction(content: float, molar_mass: float) -> float:
    """Return the mole fraction of R134a in a solution that holds so many kilograms per kilogram of an oil [kg/mol]."""
    return content / (content + M_REFRIGERANT / molar_mass)


def by_pressures(p: float, T: float) -> float:
    """Return the content [kg/kg] by M195 as it is often handed on: with p/p_sat, as if the vapour were an ideal gas."""
    return dissolved(p, *ESTER.pair(T))


def pressure_by_pressures(ratio: float, T: float) -> float:
    """Return the pressure [Pa] over oil that holds `ratio` [kg/kg], the inverse of `by_pressures`."""
    known = ESTER.pair(T)
    x = ratio / (ratio + known.mass_ratio)
    return known.p_sat * math.exp(log_activity(x, *known[1:5]))


def own_fraction(pressure: Any, T: float, p: float) -> float:
    """Return the least mole fraction that a source's own equation has at p [Pa]: beyond, an oil may part in two."""
    below = (0.0, 0.0)
    for x in FRACTIONS:
        here = (pressure(T, float(x)), float(x))
        if here[0] >= p:
            return float(np.interp(p, *zip(below, here, strict=True)))
        below = here
    return float("nan")


def misses(pressure: Any, measured: Sequence[Any], kind: str, molar_mass: float) -> Array:
    """Return how far the own equation's pressures lie from the measured ones, with loadings of a kind.

    Kinds: "mole", "solution" and "oil", kilograms per kilogram of these.
    """

    def fraction(loading: float) -> float:
        if kind == "mole":
            return loading
        return mole_fraction(loading if kind == "oil" else loading / (1.0 - loading), molar_mass)

    return np.array([pressure(each.T, fraction(each.loading)) / each.p - 1.0 for each in measured])


def deviations(pressure: Any, stored: Sequence[Any], molar_mass: float) -> Deviations | None:
    """Return those of M195 and of the source's own equation, `pressure`, at the points of an oil.

    None where no point that is no slip lies below `MOST`.
    """
    mole = misses(pressure, stored, "mole", molar_mass)
    kept = [each for each, far in zip(stored, mole, strict=True) if abs(far) < SLIP]
    held = [each for each in kept if each.p < MOST * ESTER.p_sat(each.T)]
    if not held:
        return None
    masses = [np.mean(np.abs(misses(pressure, kept, kind, molar_mass))) for kind in ("oil", "solution")]
    measured = np.array([ratio(each.loading, molar_mass) for each in held])
    by_own = np.array([ratio(own_fraction(pressure, each.T, each.p), molar_mass) for each in held])

    def over(law: Callable[[float, float], float]) -> Array:
        return np.array([law(ratio(each.loading, molar_mass), each.T) / each.p - 1.0 for each in kept])

    return Deviations(
        np.array([each.T for each in held]),
        np.array([ESTER.content(each.p, each.T) for each in held]) / measured - 1.0,
        np.array([by_pressures(each.p, each.T) for each in held]) / measured - 1.0,
        by_own / measured - 1.0,
        over(ESTER.equilibrium_pressure),
        over(pressure_by_pressures),
        float(np.mean(np.abs(mole[np.abs(mole) < SLIP]))),
        float(min(masses)),
        len(stored) - len(kept),
    )
