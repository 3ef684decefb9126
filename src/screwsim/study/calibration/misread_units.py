"""Columns of measured figures that look like those of another unit: all values off by one usual factor, or one offset.

A fit that ends far beyond its uncertainties may have such a column; its residuals alone do not say so. Measured values
are compared with those computed before the fit, which a wrong column has not bent.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from screwsim.figures import declared
from screwsim.figures.engineering import shown_name
from screwsim.outputs.customary import ZERO_CELSIUS
from screwsim.outputs.us_units import BTU, CFM, HORSEPOWER, PSI, TON
from screwsim.study.asked.figure_units import UNITS
from screwsim.study.calibration.fit import Fit, Measurement, Point

Array = np.ndarray
HOPELESS = 100.0  # chi squared per degree of freedom from which on columns are looked at
FAR = 10.0  # standard uncertainties by which each number of such a column is off, at least
NEAR = 0.12  # of a number's distance from the computed one that another unit may leave: hp for kW within 3 %
CLOSE, UNUSUAL = 0.1, 10.0  # relative distance that is allowed of factors up to `UNUSUAL`, which other machines have
FEWEST = 2  # numbers of a column
ALIKE = 1e-3  # relative distance of factors that are named together
MORE = {  # units of measured columns beside those of `UNITS`
    "W": {"hp": HORSEPOWER, "Btu/h": BTU / 3600.0, "refrigeration_ton": TON},
    "Pa": {"psi": PSI},
    "m3 s-1": {"ft^3/min": CFM, "L/s": 1e-3},
}
MISTAKEN = {  # SI unit of a figure -> pairs of units that are taken for each other
    "1": "%|1",
    "W": "W|kW kW|MW hp|kW Btu/h|W Btu/h|kW refrigeration_ton|kW",
    "J": "J|kJ",
    "kg": "g|kg",
    "kg s-1": "kg/h|kg/s g/s|kg/s kg/h|g/s kg/h|t/h lb/h|kg/h lb/min|kg/s lb/min|kg/h",
    "Pa": "Pa|bar kPa|bar MPa|bar Pa|kPa kPa|MPa psi|bar psi|kPa",
    "m3 s-1": "m^3/h|m^3/s m^3/h|m^3/min ft^3/min|m^3/h ft^3/min|m^3/min L/s|m^3/h L/s|m^3/min L/min|m^3/min",
    "W s m-3": "hp/(100_cfm)|kW/(m^3/min)",
    "J m-3": "J/m^3|kJ/m^3",
    "N": "N|kN",
    "rad": "deg|rad",
    "rad s-1": "rpm|rad/s",
}
DEGREE_F, ZERO_F = 5.0 / 9.0, 459.67  # [K], and the temperature 0 K below 0 °F


class Reading(NamedTuple):
    """What a true value x [SI] is read as, factor · x + offset, where values of one unit stand under another."""

    values: str
    head: str
    factor: float
    offset: float = 0.0

    def misses(self, measured: float, ours: float) -> float:
        """Return how far a number is from what this reading makes of the computed one, over what is allowed."""
        read = self.factor * ours + self.offset
        if self.offset:
            return abs(measured - read) / (NEAR * abs(measured - ours))
        if not measured * ours > 0.0:
            return math.inf
        away = abs(math.log(measured / ours))
        return abs(math.log(measured / read)) / (NEAR * away if away > math.log(UNUSUAL) else min(NEAR * away, CLOSE))


def misread_units(numbers: Iterable[tuple[str, Measurement, float]], ambient: float) -> tuple[str, ...]:
    """Return a line for each figure whose measured numbers are all those of another unit.

    `numbers` are (figure, measured, computed [SI]); `ambient` [Pa] is what gauge pressures are relative to.
    """
    columns: dict[str, list[tuple[Measurement, float]]] = {}
    for figure, measured, ours in numbers:
        columns.setdefault(figure, []).append((measured, ours))
    return tuple(filter(None, (_told(figure, pairs, ambient) for figure, pairs in columns.items())))


def misread_by_residuals(fit: Fit, points: Sequence[Point], residuals: Sequence[Array]) -> tuple[str, ...]:
    """Return the same from the residuals of points: computed less measured figures, over their uncertainties."""
    numbers = (
        (name, measured, measured.value + off * measured.uncertainty)
        for point, each in zip(points, residuals, strict=True)
        for (name, measured), off in zip(point.measured.items(), each.tolist(), strict=True)
    )
    return misread_units(numbers, fit.scene.operation.ambient_pressure)


def _told(figure: str, pairs: list[tuple[Measurement, float]], ambient: float) -> str:
    """Return in a line which unit a column of (measured, computed) may have; '' where none is clear."""
    if len(pairs) < FEWEST or any(abs(each.value - ours) < FAR * each.uncertainty for each, ours in pairs):
        return ""
    readings = list(_readings(figure, ambient))
    worst = [max(one.misses(each.value, ours) for each, ours in pairs) for one in readings]
    if not worst or min(worst) > 1.0:
        return ""
    best = readings[worst.index(min(worst))]
    alike = [one for one in readings if abs(one.factor / best.factor - 1.0) < ALIKE and one.offset == best.offset]
    if best.offset:
        mean = sum(each.value - ours for each, ours in pairs) / len(pairs)
        off = (
            f"off by {mean / 1e5:+.3g} bar on average"
            if declared(figure).units == "Pa"
            else f"off by {mean:+.3g} K on average"
        )
    else:
        mean = math.exp(sum(math.log(each.value / ours) for each, ours in pairs) / len(pairs))
        off = f"{mean:.3g} times what the scene has before the fit"
    columns = ", or ".join(f"values in {one.values} under [{one.head}]" for one in alike[:2])
    return f"measured {shown_name(figure)} is {off} at all {len(pairs)} points, as of {columns}: check its unit"


def _readings(figure: str, ambient: float) -> Iterator[Reading]:
    """Yield what a column of a figure may be misread as."""
    si = declared(figure).units
    units = UNITS.get(si, {}) | MORE.get(si, {})
    for pair in MISTAKEN.get(si, "").split():
        one, other = pair.replace("_cfm", " cfm").split("|")
        yield Reading(one, other, units[other] / units[one])
        yield Reading(other, one, units[one] / units[other])
    if si == "K":
        yield Reading("K", "degC", 1.0, ZERO_CELSIUS)
        yield Reading("degC", "K", 1.0, -ZERO_CELSIUS)
        yield Reading("degF", "degC", 1.0 / DEGREE_F, ZERO_CELSIUS - ZERO_F)
        yield Reading("degC", "degF", DEGREE_F, DEGREE_F * (ZERO_F - ZERO_CELSIUS))
    if si == "Pa":
        yield Reading("bar(g)", "bar", 1.0, -ambient)
        yield Reading("bar", "bar(g)", 1.0, ambient)
