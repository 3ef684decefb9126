"""Leak share against speed, and the viscous loss, of a machine of the size of Giuffrida's."""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np

from screwsim.study.validation import Comparison, Panel, Row, Series, equal, read_table, solved, trend

TITLE = "Giuffrida 2016: leak share and viscous loss"
CITATION = "A. Giuffrida, Appl. Therm. Eng. 93 (2016) 813; shares computed from its leak area"
ABOUT = (
    "Its one leak was fitted to a machine on another gas; the shares are orders of size. Ours are the volumetric loss "
    "1 − λ with the gaps of the machine fitted to Bitzer's curves, scaled with the diameter and sealed by the same "
    "rule; nothing is fitted to this source. Dry gaps of 40 µm at 160 mm lose 2.3 to 2.7 times as much as it says."
)
RPM, FACTOR = 2.0 * pi / 60.0, 2.0
VISCOUS = 168.0  # W at 2900 rpm and 20 mPa s, of about 14.5 kW


def compare(here: Path) -> Comparison:
    """Return the shares, their fall with speed, and the viscous loss."""
    table = read_table(here / "references.csv")
    speeds, theirs = ([float(row[name]) for row in table] for name in ("speed_rpm", "leak_share"))
    found = [solved(here / "machine.yaml", values={"operation.speed": n * RPM}).performance for n in speeds]
    ours = [1.0 - each.volumetric_efficiency for each in found]
    rows: list[Row] = []
    for n, own, other in zip(speeds, ours, theirs, strict=True):
        near = 1.0 / FACTOR <= own / other <= FACTOR
        rows.append(
            Row(
                f"leak share of displacement at {n:.0f} rpm",
                own,
                other,
                "published",
                "holds" if near else "fails",
                basis=f"an order of size: holds within a factor of {FACTOR:g} either way",
            )
        )
    slope = float(np.polyfit(np.log(speeds), np.log(ours), 1)[0])
    rows.append(
        trend(
            "leak share over speed",
            f"falls with speed to the power {slope:.2f}",
            "falls, with power −1 by construction",
            bool(np.all(np.diff(ours) < 0.0)),
        )
    )
    viscous = solved(here / "machine.yaml", values={"operation.speed": 2900.0 * RPM}).performance
    rows.append(
        equal(
            "viscous loss at 2900 rpm and 20 mPa s",
            viscous.hydromechanical_power,
            VISCOUS,
            1.0,
            "published",
            unit="W",
            basis="three digits; it checks our effect, not the formula",
        )
    )
    panel = Panel(
        "speed / rpm",
        "leak share of displacement",
        (Series("ours, 1 − λ", speeds, ours), Series("from Giuffrida's leak area", speeds, theirs, theirs=True)),
        log_x=True,
        log_y=True,
    )
    return Comparison(TITLE, CITATION, ABOUT, rows, (panel,))
