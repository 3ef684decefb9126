"""Profiles, curves and coefficients as text: CSV for `law: table` and `kind: points`, and DXF for drawing."""

import math

import numpy as np

from screwsim.machine.rotors.curves import Curve, Curves
from screwsim.machine.rotors.pair import Array
from screwsim.machine.rotors.rotors import Rotors

VOLUME_RATIOS = 2.2, 2.6, 3.2, 4.0  # usual built-in ones
_COLUMN = {"m^3": "volume_m3", "m^2": "area_m2", "m": "length_m"}


def curve_csv(curve: Curve) -> str:
    """Return a curve as CSV: its angle_deg, and volume_m3, area_m2 or the like by its unit."""
    # readers refuse the −0 of rounding
    value = np.maximum(curve.value, 0.0) if curve.unit in ("m^2", "m^3") else curve.value
    rows = (f"{math.degrees(a):.10g},{v:.10g}" for a, v in zip(curve.angle, value, strict=True))
    return f"angle_deg,{_COLUMN[curve.unit]}\n" + "\n".join(rows) + "\n"


def curves_csv(curves: Curves) -> dict[str, str]:
    """Return {file name: CSV text} of the volume, the ports (axial and radial together) and every leakage path.

    Leakage paths are over the trailing chamber's angle, as the `area_file` of an effect requires.
    """
    files = {"volume.csv": curve_csv(curves.volume)}
    for name, parts in (("suction", curves.suction), ("discharge", curves.discharge)):
        one, two = parts["axial"], parts["radial"]
        both = Curve(one.angle, one.value + two.value, one.unit, one.breakpoints)
        files[f"{name}_port.csv"] = curve_csv(both)
    if curves.slot is not None:
        files["slide_valve.csv"] = curve_csv(curves.slot)
    for path in curves.paths:
        files[f"{path.name}.csv"] = curve_csv(path.behind)
    return files


def profile_csv(x: Array, y: Array) -> str:
    """Return points [m] as CSV with the columns x_mm, y_mm."""
    rows = (f"{a * 1e3:.9f},{b * 1e3:.9f}" for a, b in zip(x, y, strict=True))
    return "x_mm,y_mm\n" + "\n".join(rows) + "\n"


def lobe_csv(rotors: Rotors) -> str:
    """Return the male lobe from root to root as CSV for `kind: points`."""
    first, last = rotors.chain.edges
    x, y = rotors.chain.male
    return profile_csv(x[first : last + 1], y[first : last + 1])


def outline_dxf(x: Array, y: Array) -> str:
    """Return a closed polygon [m] as DXF R12: one POLYLINE in mm, as a comment says, since R12 has no units."""
    head = ["999", "lengths in mm", "0", "SECTION", "2", "ENTITIES", "0", "POLYLINE", "8", "0", "66", "1", "70", "1"]
    for a, b in zip(x, y, strict=True):
        head += ["0", "VERTEX", "8", "0", "10", f"{a * 1e3:.6f}", "20", f"{b * 1e3:.6f}"]
    return "\n".join([*head, "0", "SEQEND", "0", "ENDSEC", "0", "EOF", ""])


def coefficients_csv(rotors: Rotors) -> str:
    """Return the coefficients, and φ_dis (own angle) for usual built-in volume ratios, as CSV."""
    rows = [f"{name},{value:.8g},{unit},{about}" for name, (value, unit, about) in rotors.coefficients().items()]
    for ratio in VOLUME_RATIOS:
        angle = rotors.discharge_angle(ratio) - rotors.start
        rows.append(f"discharge_angle_{ratio:g},{angle:.8g},rad,own angle at which the port opens for Vi = {ratio:g}")
    return "name,value,unit,meaning\n" + "\n".join(rows) + "\n"
