"""Ratings of HSK screws as volumetric and electrical isentropic efficiencies; fit.csv has those at 50 Hz as points.

    python validation/hsk/ratings.py
    screwsim calibrate validation/hsk/machine.fit.yaml -o validation/hsk/fitted

Fitted are 5/35, 0/45 and -10/50 degC at 50 Hz, which span the pressure ratios from 2.5 to 6.6; the other conditions and
all other speeds are predicted. The source gives no uncertainty: half of what the comparison asks for is written.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi
from pathlib import Path

from CoolProp.CoolProp import PropsSI

from screwsim.study.validation import read_table

HERE = Path(__file__).parent
FLUID, ZERO = "R134a", 273.15
FITTED_MODEL, FITTED = "HSK7451-50", ("5/35", "0/45", "-10/50")
NOMINAL, RATED = 2950.0, 2900.0  # [rpm] at 50 Hz: taken here, and at which the displacement is given; two poles ...
SYNCHRONOUS = 3000.0  # [rpm] ... without slip
LAMBDA, ETA = 0.017, 0.03  # asked for: half of 2900 to 3000 rpm; as in validation/bitzer
COMMENT = "# Made by validation/hsk/ratings.py from points.csv; uncertainty: half of what is asked.\n"
HEAD = (
    "name,use,operation.evaporating_temperature [degC],operation.condensing_temperature [degC],"
    "volumetric_efficiency [%],volumetric_efficiency_uncertainty [%],"
    "electrical_isentropic_efficiency [%],electrical_isentropic_efficiency_uncertainty [%]"
)


@dataclass(frozen=True)
class Rating:
    """One rating: conditions, and what follows from capacity and power."""

    model: str
    displacement: str
    name: str
    frequency: float  # [Hz]
    values: Mapping[str, float]  # paths of a scene [SI]
    ratio: float
    volumetric_efficiency: float
    electrical_isentropic_efficiency: float


def rating(row: Mapping[str, str], poles: int = 2) -> Rating:
    """Return a row of points.csv: the mass flow is the capacity over the rise of enthalpy from saturated liquid."""
    T_e, T_c = (float(row[f"{name}_degC"]) + ZERO for name in ("evaporating", "condensing"))
    superheat, frequency = float(row["superheat_K"]), float(row["frequency_Hz"])
    low, high = (PropsSI("P", "T", T, "Q", 1, FLUID) for T in (T_e, T_c))
    h, s, rho = (PropsSI(name, "P", low, "T", T_e + superheat, FLUID) for name in "HSD")
    mdot = float(row["capacity_W"]) / (h - PropsSI("H", "T", T_c, "Q", 0, FLUID))
    swept = float(row["displacement_m3h"]) / 3600.0 * NOMINAL / RATED * frequency / 50.0
    return Rating(
        row["model"],
        row["displacement_m3h"],
        f"{row['evaporating_degC']}/{row['condensing_degC']}",
        frequency,
        {
            "operation.evaporating_temperature": T_e,
            "operation.condensing_temperature": T_c,
            "operation.superheat": superheat,
            "operation.subcooling": 0.0,
            "operation.speed": NOMINAL * 2 / poles * frequency / 50.0 * pi / 30.0,
        },
        high / low,
        mdot / (rho * swept),
        mdot * (PropsSI("H", "P", high, "S", s, FLUID) - h) / float(row["power_W"]),
    )


def ratings(here: Path, poles: int = 2, file: str = "points.csv") -> list[Rating]:
    """Return all ratings of a folder's file."""
    return [rating(row, poles) for row in read_table(here / file)]


def write_fit(here: Path, own: Sequence[Rating], fitted: Sequence[str], comment: str) -> None:
    """Write the ratings at 50 Hz as points for `screwsim calibrate`: the fitted ones, and others to check."""
    target = here / "fit.csv"
    with target.open("w", encoding="utf-8", newline="") as stream:
        stream.write(comment + HEAD + "\n")
        writer = csv.writer(stream, lineterminator="\n")
        for one in own:
            if one.frequency != 50.0:
                continue
            shown = (
                (100.0 * one.volumetric_efficiency, 50.0 * LAMBDA),
                (100.0 * one.electrical_isentropic_efficiency, 50.0 * ETA),
            )
            cells = [text for value, half in shown for text in (f"{value:.2f}", f"{half:g}")]
            writer.writerow([one.name, "fit" if one.name in fitted else "check", *one.name.split("/"), *cells])
    print(target)


if __name__ == "__main__":
    write_fit(HERE, [one for one in ratings(HERE) if one.model == FITTED_MODEL], FITTED, COMMENT)
