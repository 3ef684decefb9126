"""Measured pressures over the angle among the data of a fit: a file of a transducer for each operating point."""

import os

from screwsim.figures.curves import Reading, declared_trace
from screwsim.figures.indicated import IndicatedVolumes, read_indicated
from screwsim.inputs.faults import UsageError
from screwsim.scene.units import Refused
from screwsim.scene.values import shown
from screwsim.study.calibration.fit import Measurement, odd_uncertainty

INDICATOR, OF = "indicator", "indicator_of_"  # columns of files of the chamber's pressure, and of another curve's
CHAMBER = "pressure"
MOST_PRESSURES = 2000  # of a point


def curve_of_files(column: str) -> str | None:
    """Return the curve that the files in a column measure: `indicator`, or `indicator_of_` and a pressure's name.

    None for a column that names no files.
    """
    if column == INDICATOR:
        return CHAMBER
    curve = column.removeprefix(OF)
    about = None if curve in (column, CHAMBER) else declared_trace(curve)
    return curve if about is not None and about.units == "Pa" else None


def pressures_of(curve: str, file: str, folder: str, uncertainty: float) -> dict[str, Measurement]:
    """Return the pressures [Pa] of a file, by their figures, with the standard uncertainty [Pa] of each.

    `curve` is what they measure. A relative name is one in `folder`. Raise `Refused` where there is no such file, or it
    does not suit a fit.
    """
    path = os.path.join(folder, file)
    if not os.path.isfile(path):
        raise Refused(f"{shown(file)} is not a file (name an existing one, relative to the data)")
    try:
        read = read_indicated(path)
    except UsageError as error:
        raise Refused(str(error)) from None
    if isinstance(read, IndicatedVolumes):
        raise Refused(f"{shown(file)} has volumes, and a fit compares pressures at angles (add a column angle_deg)")
    if len(read.angle) > MOST_PRESSURES:
        remedy = "keep those of the phases that the parameters change"
        raise Refused(f"{shown(file)} has {len(read.angle)} pressures (at most {MOST_PRESSURES} are fitted; {remedy})")
    found: dict[str, Measurement] = {}
    for angle, pressure in zip(read.angle.tolist(), read.pressure.tolist(), strict=True):
        name = Reading(curve, angle).figure
        if name in found:
            raise Refused(f"{shown(file)} has {angle:g} deg twice (give the mean of the recorded cycles)")
        if angle < 0.0:
            raise Refused(f"{shown(file)} has {angle:g} deg (angles count from where the chamber begins to grow)")
        if why := odd_uncertainty(pressure, uncertainty):
            raise Refused(why)
        found[name] = Measurement(pressure, uncertainty)
    return found
