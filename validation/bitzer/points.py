"""Write fit.csv: the published curves as measured points, three of them for the fit, the others to be predicted.

    python validation/bitzer/points.py

Fitted are 5/35, 2/45 and -10/40 °C, which span the pressure ratios of the five conditions; predicted are 5/45 and
0/40 °C and a sweep of the pressure ratio 2 to 10 at 45 °C condensing, all at 50 Hz (2950 rpm) and 10 K superheat. The
source gives no scatter: half of what points outside the fit should be met to (2 points of volumetric, 3 points of
isentropic efficiency) counts as the uncertainty.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from screwsim.study.validation import read_table, sibling

HERE = Path(__file__).parent
FITTED = ("5/35", "2/45", "-10/40")
SWEEP = np.geomspace(2.0, 10.0, 9)
KELVIN = 273.15
COMMENT = (
    "# Made by validation/bitzer/points.py from the regressions of compare.py; uncertainty: half of what is asked.\n"
)
HEAD = (
    "name,use,operation.evaporating_temperature [degC],operation.condensing_temperature [degC],"
    "volumetric_efficiency [%],volumetric_efficiency_uncertainty [%],"
    "isentropic_efficiency [%],isentropic_efficiency_uncertainty [%]"
)


def rows() -> list[list[str]]:
    """Return the rows of the file."""
    compare = sibling(HERE / "compare.py")
    scene_file = HERE.parents[1] / "configs" / "r134a" / "point.yaml"
    found = []
    for row in read_table(HERE / "conditions.csv"):
        name = f"{row['evaporating_degC']}/{row['condensing_degC']}"
        use = "fit" if name in FITTED else "check"
        ratio = np.array(float(row["pressure_ratio"]))
        found.append([name, use, row["evaporating_degC"], row["condensing_degC"], *_cells(compare, ratio)])
    for ratio in SWEEP:
        T_e = compare.evaporating(scene_file, float(ratio)) - KELVIN
        found.append([f"pi = {ratio:.2f}", "check", f"{T_e:.4f}", "45", *_cells(compare, np.array(ratio))])
    return found


def _cells(compare, ratio: np.ndarray) -> list[str]:
    limits = (compare.LAMBDA_POINTS, compare.ETA_POINTS)
    values = zip(compare.published(ratio), limits, strict=True)
    return [text for value, limit in values for text in (f"{100.0 * float(value):.2f}", f"{0.5 * limit:g}")]


def main() -> None:
    """Write the file."""
    target = HERE / "fit.csv"
    with target.open("w", encoding="utf-8", newline="") as stream:
        stream.write(COMMENT + HEAD + "\n")
        csv.writer(stream, lineterminator="\n").writerows(rows())
    print(target)


if __name__ == "__main__":
    main()
