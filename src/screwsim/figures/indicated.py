"""Files of pressures that were measured over angle or volume."""

import os
import re
from typing import NamedTuple

import numpy as np

from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import read_sheet, sheet_or_usage_error
from screwsim.scene.units import Refused, parse_quantity

ANGLE_COLUMN = "angle_deg"
PRESSURE_COLUMN = re.compile(r"pressure_(bar|mbar|kPa|MPa|Pa)")
VOLUME_COLUMN = re.compile(r"volume_(cm3|mm3|l|m3)")
CUBIC_METRES = {"cm3": 1e-6, "mm3": 1e-9, "l": 1e-3, "m3": 1.0}
_EXAMPLE = "write angle_deg,pressure_bar or volume_cm3,pressure_bar; absolute pressures, also _kPa, _MPa or _Pa"
_BRACKETED = re.compile(r"(angle|pressure|volume)\s*\[([^\]]+)\]")  # the other way to write a head: angle [deg]
_PLAIN = str.maketrans({"^": "", "³": "3", "°": "deg", " ": ""})


class Indicated(NamedTuple):
    """Measured points: angles [degree] in the cycle's convention, absolute pressures [Pa]."""

    angle: np.ndarray
    pressure: np.ndarray


class IndicatedVolumes(NamedTuple):
    """Measured points of an indicator diagram in the order of the cycle: volumes [m³], absolute pressures [Pa]."""

    volume: np.ndarray
    pressure: np.ndarray


def read_indicated(path: str | os.PathLike[str]) -> Indicated | IndicatedVolumes:
    """Return the measured points of a CSV file with angle_deg or volume_UNIT, and pressure_UNIT; raise UsageError.

    Heads may also have their unit in brackets, `angle [deg]`. Where a file has angles and volumes, angles are taken.
    """
    where = os.fspath(path)
    with sheet_or_usage_error("name a CSV file of measured pressures", where):
        sheet = read_sheet(path)
    heads = [(_plain(name), name) for name in sheet.names]
    named = [name for name, _ in heads if PRESSURE_COLUMN.fullmatch(name)]
    angles = [name for name, _ in heads if name == ANGLE_COLUMN]
    places = angles or [name for name, _ in heads if VOLUME_COLUMN.fullmatch(name)]
    if len(places) != 1 or len(named) != 1:
        found = ", ".join(name for name in sheet.names if name) or "none"
        raise UsageError(f"{where}: needs angle_deg or one volume, and one pressure (found: {found}; {_EXAMPLE})")
    unit, head = named[0].removeprefix("pressure_"), dict(heads)
    rows = sheet.columns(head[places[0]], head[named[0]])
    if not rows:
        raise UsageError(f"{where}: has no points below its header (one row per point)")
    of, pressure = map(np.array, zip(*(_point(where, line, cells, unit) for line, cells in rows), strict=True))
    volume = VOLUME_COLUMN.fullmatch(places[0])
    return IndicatedVolumes(of * CUBIC_METRES[volume[1]], pressure) if volume else Indicated(of, pressure)


def _plain(head: str) -> str:
    """Return the head of a column with its unit behind its name: `angle_deg` of `angle [deg]`; others as they are."""
    found = _BRACKETED.fullmatch(head)
    return head if found is None else f"{found[1]}_{found[2].translate(_PLAIN)}"


def _point(where: str, line: int, cells: tuple[str, ...], unit: str) -> tuple[float, float]:
    try:
        angle, pressure = float(cells[0]), parse_quantity(KINDS["pressure"], f"{cells[1]} {unit}")
    except (Refused, ValueError):
        raise UsageError(f"{where}: line {line}: {', '.join(cells)} are not two numbers") from None
    if not (np.isfinite(angle) and pressure > 0.0):
        what = f"{cells[1]} {unit} is not an absolute pressure"
        raise UsageError(f"{where}: line {line}: {what} (add the ambient pressure)")
    return angle, pressure
