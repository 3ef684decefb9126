"""Measured chamber pressures among the data of a fit: a file of an indicator for each operating point."""

import os

from screwsim.figures.indicated import IndicatedVolumes, pressure_at, read_indicated
from screwsim.inputs.faults import UsageError
from screwsim.scene.units import Refused
from screwsim.scene.values import shown
from screwsim.study.calibration.fit import Measurement, odd_uncertainty

INDICATOR = "indicator"  # column with the file of a point; its uncertainty has the usual suffix
ANY_PRESSURE = pressure_at(0.0)  # a figure with the units that pressures at angles have
MOST_PRESSURES = 2000  # of a point


def pressures_of(file: str, folder: str, uncertainty: float) -> dict[str, Measurement]:
    """Return the pressures [Pa] of a file, by their figures, with the standard uncertainty [Pa] of each.

    A relative name is one in `folder`. Raise `Refused` where there is no such file, or it does not suit a fit.
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
        name = pressure_at(angle)
        if name in found:
            raise Refused(f"{shown(file)} has {angle:g} deg twice (give the mean of the recorded cycles)")
        if angle < 0.0:
            raise Refused(f"{shown(file)} has {angle:g} deg (angles count from where the chamber begins to grow)")
        if why := odd_uncertainty(pressure, uncertainty):
            raise Refused(why)
        found[name] = Measurement(pressure, uncertainty)
    return found
