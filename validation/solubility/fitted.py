"""How well M198 follows the measured points of an oil: fitted to all of them, and to every other one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.fluid.solubility import FLUID
from screwsim.fluid.solubility_laws import Measured, Point
from screwsim.inputs.faults import UsageError
from screwsim.study.validation import Row, sibling

measured = sibling(Path(__file__).with_name("deviations.py"))
DENSITIES = 850.0, 1050.0  # [kg/m³] in place of that of M198
AT = 330.0, 0.3  # temperature [K] and share of the saturation pressure at which their contents are compared
HOTTEST = measured.ESTER.high  # [K] of points that are compared


def of_points(oil: Any, stored: Sequence[Any]) -> list[Point]:
    """Return the points of an oil below saturation that are no slips, by the larger of its molar masses."""
    mass = oil.molar_mass[-1]
    off = np.abs(measured.misses(oil.pressure, stored, "mole", mass))
    kept = [each for each, far in zip(stored, off, strict=True) if far < measured.SLIP]
    kept = [each for each in kept if each.T < HOTTEST and each.p < measured.ESTER.p_sat(each.T)]
    return [Point(i, each.T, each.p, measured.ratio(each.loading, mass)) for i, each in enumerate(kept, 1)]


def held_out(points: Sequence[Point]) -> str:
    """Return in words by how much laws fitted to every other point miss the rest's pressures (root mean square)."""
    off = []
    for part in (0, 1):
        try:
            law = Measured(FLUID, points[part::2])
        except UsageError:
            return "too few to leave every other one out"
        rest = [each for each in points[1 - part :: 2] if law.low <= each.T <= law.high and each.ratio <= law.most]
        off += [law.equilibrium_pressure(each.ratio, each.T) / each.p - 1.0 for each in rest]
    return f"fitted to every other one, {100.0 * float(np.sqrt(np.mean(np.square(off)))):.1f} % at the rest"


def content_at(law: Measured) -> float:
    """Return the content [kg/kg] of a law at `AT`."""
    T, share = AT
    return law.content(share * law.p_sat(T), T)


def fitted_row(oil: Any, stored: Sequence[Any]) -> Row:
    """Return by how much M198 misses the pressures of the points that it is fitted to."""
    quantity, points = f"M198 fitted to {oil.words}: root mean square of its pressures", of_points(oil, stored)
    try:
        law = Measured(FLUID, points)
    except UsageError as error:
        return Row(quantity, None, None, "calibrated", "no verdict", note=f"not fitted: {error}")
    others = (type("Other", (Measured,), {"oil_density": density})(FLUID, points) for density in DENSITIES)
    moved = max(abs(content_at(other) / content_at(law) - 1.0) for other in others)
    note = (
        f"{len(points)} points; {held_out(points)}; with "
        f"{DENSITIES[0]:g} or {DENSITIES[1]:g} kg/m³ for {law.oil_density:g} the content at {AT[0] - 273.15:.0f} °C, "
        f"{AT[1]:g} of saturation, changes by {100.0 * moved:.2f} %"
    )
    return Row(quantity, 100.0 * law.misfit, None, "calibrated", "no verdict", "%", note=note)
