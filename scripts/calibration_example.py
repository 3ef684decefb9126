"""Make the data of the worked examples in configs/calibration from machines whose parameters are known.

    python scripts/calibration_example.py          -> configs/calibration/points.csv, later.csv
    screwsim calibrate configs/calibration/leakage.fit.yaml
    screwsim diagnose configs/calibration/fault.fit.yaml

The points of later.csv are those of the machine of configs/paper after its tip gap has grown by 10 um. Noise is normal,
of the standard deviation that the files state as uncertainty (0.5 % of flow and power, 0.5 K), seed 1.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from screwsim.scene import load, with_values
from screwsim.simulate import simulate

ROOT = Path(__file__).resolve().parent.parent
SCENE, POINTS = ROOT / "configs" / "paper" / "point.yaml", ROOT / "configs" / "calibration" / "points.csv"
LATER = POINTS.with_name("later.csv")
RPM = 2.0 * np.pi / 60.0
TRUTH = {
    "effects.tip_leakage.gap": 19e-6,
    "effects.hydromechanical.acceleration_factor": 0.4,
    "effects.mechanical.fraction": 0.06,
}
SPEEDS, PRESSURES = (1000.0, 2000.0, 4000.0), (8e5, 11.5e5)  # [rpm], [Pa]
GROWN = {"effects.tip_leakage.gap": 37.5e-6}  # of 27.5 um
RATIO = 1.5  # oil to gas
SHARE, KELVIN = 0.005, 0.5
COMMENT = (
    "# Made by scripts/calibration_example.py from a known machine, with noise of the stated uncertainties (seed 1)."
)


def rows(truth: Mapping[str, float], ratio: float | None) -> list[dict[str, str]]:
    """Return one row an operating point of a machine, with the oil ratio as a condition where it is stated."""
    random = np.random.default_rng(1)
    oil = {} if ratio is None else {"oil_supply.ratio": ratio}
    machine = with_values(load(SCENE, ["numerics.accuracy=1e-5"]), {**truth, **oil})
    found = []
    for speed in SPEEDS:
        for p_d in PRESSURES:
            scene = with_values(machine, {"operation.speed": speed * RPM, "operation.discharge.pressure": p_d})
            figures = simulate(scene, trace=False).performance
            row = {
                "name": f"{speed:.0f} rpm, {p_d / 1e5:g} bar",
                "operation.speed [rpm]": f"{speed:g}",
                "operation.discharge.pressure [bar]": f"{p_d / 1e5:g}",
                **{path: f"{value:g}" for path, value in oil.items()},
            }
            for name, unit, factor in (("gas_mass_flow", "kg/s", 1.0), ("shaft_power", "kW", 1e-3)):
                true = factor * figures[name]
                row[f"{name} [{unit}]"] = f"{true * (1.0 + SHARE * random.standard_normal()):.5g}"
                row[f"{name}_uncertainty [{unit}]"] = f"{SHARE * true:.2g}"
            noisy = figures["discharge_temperature"] - 273.15 + KELVIN * random.standard_normal()
            row["discharge_temperature [degC]"] = f"{noisy:.2f}"
            row["discharge_temperature_uncertainty [K]"] = f"{KELVIN:g}"
            found.append(row)
    return found


def text(truth: Mapping[str, float] = TRUTH, ratio: float | None = RATIO) -> str:
    """Return the file of a machine."""
    found = rows(truth, ratio)
    stream = io.StringIO()
    writer = csv.DictWriter(stream, list(found[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(found)
    return f"{COMMENT}\n{stream.getvalue()}"


if __name__ == "__main__":
    for file, made in ((POINTS, text()), (LATER, text(GROWN, None))):
        file.write_text(made, encoding="utf-8")
        print(file)
