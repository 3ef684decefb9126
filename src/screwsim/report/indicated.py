"""Measured pressures of a chamber over the angle, to be drawn beside those of a computed cycle."""

import os
import re
from typing import Any, NamedTuple

import numpy as np

from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import read_sheet, sheet_or_usage_error
from screwsim.report.quantities import PRESSURE, VOLUME
from screwsim.report.style import COLOURS
from screwsim.report.trace import Trace
from screwsim.scene.units import Refused, parse_quantity

PRESSURE_COLUMN = re.compile(r"pressure_(bar|mbar|kPa|MPa|Pa)")
_EXAMPLE = "write angle_deg,pressure_bar; absolute pressures, also _kPa, _MPa or _Pa"
ANGLE_SLACK = 5.0  # [degree] by which a point may exceed the ends of the cycle


class Indicated(NamedTuple):
    """Measured points: angles [degree] in the cycle's convention, absolute pressures [Pa]."""

    angle: np.ndarray
    pressure: np.ndarray


def read_indicated(path: str | os.PathLike[str]) -> Indicated:
    """Return the measured points of a CSV file with columns angle_deg and pressure_UNIT; raise UsageError."""
    where = os.fspath(path)
    with sheet_or_usage_error("name a CSV file of measured pressures", where):
        sheet = read_sheet(path)
    named = [name for name in sheet.names if PRESSURE_COLUMN.fullmatch(name)]
    if "angle_deg" not in sheet.names or len(named) != 1:
        found = ", ".join(name for name in sheet.names if name) or "none"
        raise UsageError(f"{where}: needs the columns angle_deg and one pressure (found: {found}; {_EXAMPLE})")
    unit = named[0].removeprefix("pressure_")
    rows = sheet.columns("angle_deg", named[0])
    if not rows:
        raise UsageError(f"{where}: has no points below its header (one row per point)")
    return Indicated(*map(np.array, zip(*(_point(where, line, cells, unit) for line, cells in rows), strict=True)))


def _point(where: str, line: int, cells: tuple[str, ...], unit: str) -> tuple[float, float]:
    try:
        angle, pressure = float(cells[0]), parse_quantity(KINDS["pressure"], f"{cells[1]} {unit}")
    except (Refused, ValueError):
        raise UsageError(f"{where}: line {line}: {', '.join(cells)} are not an angle and a pressure") from None
    if not (np.isfinite(angle) and pressure > 0.0):
        raise UsageError(
            f"{where}: line {line}: {cells[1]} {unit} is not an absolute pressure (add the ambient pressure)"
        )
    return angle, pressure


def check_angles(points: Indicated, trace: Trace) -> None:
    """Raise UsageError for points outside the life of the chamber."""
    first, last = float(trace.angle[0]), float(trace.angle[-1])
    out = points.angle[(points.angle < first - ANGLE_SLACK) | (points.angle > last + ANGLE_SLACK)]
    if len(out):
        what = (
            f"{len(out)} of the measured angles, as {out[0]:g} deg, lie outside the cycle's {first:g} to {last:g} deg"
        )
        raise UsageError(f"{what} (count angles from where the chamber starts to grow; docs/how-to/indicator.md)")


def deviation_in_words(points: Indicated, trace: Trace) -> str:
    """Return in words the deviation of computed from measured pressures: mean, root mean square, largest [bar]."""
    off = (np.interp(points.angle, trace.angle, trace.values["pressure"]) - points.pressure) * PRESSURE.factor
    worst = int(np.argmax(np.abs(off)))
    return (
        f"computed minus measured at {len(off)} points: mean {off.mean():+.3g} bar, root mean square "
        f"{np.sqrt(np.mean(off**2)):.3g} bar, largest {off[worst]:+.3g} bar at {points.angle[worst]:g} deg"
    )


def draw_over_angle(axes: Any, points: Indicated) -> None:
    """Draw measured points over the angle."""
    _draw(axes, points.angle, points.pressure, "upper left")


def draw_over_volume(axes: Any, points: Indicated, trace: Trace) -> None:
    """Draw measured points over the chamber's volume at their angles."""
    volume = np.interp(points.angle, trace.angle, trace.values["volume"])
    _draw(axes, volume * VOLUME.factor, points.pressure, "upper right")


def _draw(axes: Any, x: np.ndarray, pressure: np.ndarray, corner: str) -> None:
    y = pressure * PRESSURE.factor
    axes.plot(x, y, "x", color=COLOURS[3], markersize=3.5, markeredgewidth=0.8, label="measured", zorder=4)
    axes.set_ylim(top=max(axes.get_ylim()[1], 1.06 * float(y.max())))
    axes.legend(loc=corner)
