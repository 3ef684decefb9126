"""Make the data of the worked examples in configs/calibration from machines whose parameters are known.

    python docs/tools/calibration_example.py -> points.csv, later.csv, less_oil.csv, both.csv, stuck.csv, sheet.csv,
        indicator.csv with its two files of pressures, of configs/calibration
    screwsim calibrate configs/calibration/leakage.fit.yaml
    screwsim diagnose configs/calibration/fault.fit.yaml

The points of later.csv are those of the machine of configs/paper after its tip gap has grown by 10 um, those of
less_oil.csv with two thirds of its oil, those of both.csv with both faults. Those of stuck.csv are of the machine of
configs/control whose slide, commanded to 0.3 of its travel (slide.yaml), has stuck at 0.15. sheet.csv is a table of
capacity and power, as makers state them, of a machine with wider gaps and more friction than sheet.yaml. indicator.csv
names pressures over the angle of a machine whose tip gap and discharge port differ from configs/paper. Noise is
normal, of the standard deviation that the files state as uncertainty (0.5 % of flow and power, 0.5 K; 1 % of the
table; 0.05 bar), seed 1.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from screwsim.scene import load, with_values
from screwsim.simulate import simulate

ROOT = Path(__file__).resolve().parents[2]
SCENE, POINTS = ROOT / "configs" / "paper" / "point.yaml", ROOT / "configs" / "calibration" / "points.csv"
LATER = POINTS.with_name("later.csv")
RPM = 2.0 * np.pi / 60.0
TRUTH = {
    "effects.tip_leakage.gap": 19e-6,
    "effects.hydromechanical.acceleration_factor": 0.4,
    "effects.mechanical.fraction": 0.06,
}
SPEEDS = (1000.0, 2000.0, 4000.0)  # [rpm]
LESS, STUCK = POINTS.with_name("less_oil.csv"), POINTS.with_name("stuck.csv")
BOTH = POINTS.with_name("both.csv")
SLIDE = POINTS.with_name("slide.yaml")
GROWN = {"effects.tip_leakage.gap": 37.5e-6}  # of 27.5 um
LITTLE_OIL = {"oil_supply.ratio": 2.0}  # of 3
STILL = {"effects.slide_valve.position": 0.15}  # of 0.3
RATIO = 1.5  # oil to gas
SHARE, KELVIN = 0.005, 0.5
SHEET = POINTS.with_name("sheet.yaml")
GAPS = ("tip_leakage", "interlobe_leakage", "end_face_leakage")
WIDER = {**{f"effects.{gap}.gap": 33e-6 for gap in GAPS}, "effects.mechanical.fraction": 0.12}  # of 26 um and 0.096
TABLE = tuple((evaporating, condensing) for evaporating in (-10.0, 0.0, 5.0) for condensing in (30.0, 40.0, 50.0))
CHECKED, TABLE_SHARE = (0.0, 40.0), 0.01
INDICATOR = POINTS.with_name("indicator.csv")
THROTTLED = {"effects.tip_leakage.gap": 40e-6, "effects.discharge_port.flow_coefficient": 0.6}
ANGLES = np.arange(450.0, 711.0, 10.0)  # [degree], from closed suction to the end of discharge
INDICATED_SPEEDS, BAR = (1000.0, 3000.0), 0.05
COMMENT = (
    "# Made by docs/tools/calibration_example.py from a known machine, with noise of the stated uncertainties (seed 1)."
)


class Grid(NamedTuple):
    """Where a machine is measured: its scene, speeds [rpm], and a second condition with the unit that it is written in.

    `zero` is that of the unit [SI], `per` its size [SI].
    """

    scene: Path
    speeds: Sequence[float]
    path: str
    unit: str
    per: float
    zero: float
    values: Sequence[float]


PAPER = Grid(SCENE, SPEEDS, "operation.discharge.pressure", "bar", 1e5, 0.0, (8.0, 11.5))
CONTROL = Grid(SLIDE, (1450.0, 2950.0), "operation.condensing_temperature", "degC", 1.0, 273.15, (35.0, 45.0, 55.0))


def rows(truth: Mapping[str, float], ratio: float | None, grid: Grid = PAPER) -> list[dict[str, str]]:
    """Return one row an operating point of a machine, with the oil ratio as a condition where it is stated."""
    random = np.random.default_rng(1)
    oil = {} if ratio is None else {"oil_supply.ratio": ratio}
    machine = with_values(load(grid.scene, ["numerics.accuracy=1e-5"]), {**truth, **oil})
    found = []
    for speed in grid.speeds:
        for value in grid.values:
            scene = with_values(machine, {"operation.speed": speed * RPM, grid.path: value * grid.per + grid.zero})
            figures = simulate(scene, trace=False).performance
            row = {
                "name": f"{speed:.0f} rpm, {value:g} {grid.unit}",
                "operation.speed [rpm]": f"{speed:g}",
                f"{grid.path} [{grid.unit}]": f"{value:g}",
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


def text(truth: Mapping[str, float] = TRUTH, ratio: float | None = RATIO, grid: Grid = PAPER) -> str:
    """Return the file of a machine."""
    return written(rows(truth, ratio, grid))


def sheet_text() -> str:
    """Return a maker's table: cooling capacity and electrical power over both saturation temperatures [degC]."""
    random, machine = np.random.default_rng(1), with_values(load(SHEET, ["numerics.accuracy=1e-5"]), WIDER)
    found = []
    for at in TABLE:
        paths = [f"operation.{name}_temperature" for name in ("evaporating", "condensing")]
        scene = with_values(machine, {path: value + 273.15 for path, value in zip(paths, at, strict=True)})
        row = {"name": " / ".join(f"{value:g}" for value in at), "use": "check" if at == CHECKED else "fit"}
        row |= {f"{path} [degC]": f"{value:g}" for path, value in zip(paths, at, strict=True)}
        for name in ("cooling_capacity", "electrical_power"):
            true = 1e-3 * simulate(scene, trace=False).performance[name]
            row[f"{name} [kW]"] = f"{true * (1.0 + TABLE_SHARE * random.standard_normal()):.1f}"
            row[f"{name}_uncertainty [kW]"] = f"{TABLE_SHARE * true:.2g}"
        found.append(row)
    return written(found)


def indicator_texts() -> dict[Path, str]:
    """Return the file of the indicated points, and those of their pressures over the angle."""
    random, machine = np.random.default_rng(1), with_values(load(SCENE, ["numerics.accuracy=1e-5"]), THROTTLED)
    found, files = [], {}
    for speed in INDICATED_SPEEDS:
        cycle = simulate(with_values(machine, {"operation.speed": speed * RPM})).cycle
        true = 1e-5 * np.interp(ANGLES, cycle["angle"], cycle["pressure"])
        noisy = true + BAR * random.standard_normal(len(true))
        pressures = [
            {"angle_deg": f"{angle:g}", "pressure_bar": f"{p:.3f}"} for angle, p in zip(ANGLES, noisy, strict=True)
        ]
        file = INDICATOR.with_name(f"indicator_{speed:.0f}.csv")
        files[file] = written(pressures)
        row = {"name": f"{speed:.0f} rpm", "operation.speed [rpm]": f"{speed:g}", "indicator": file.name}
        found.append({**row, "indicator_uncertainty [bar]": f"{BAR:g}"})
    return {INDICATOR: written(found), **files}


def written(found: Sequence[Mapping[str, str]]) -> str:
    """Return rows as a file."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, list(found[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(found)
    return f"{COMMENT}\n{stream.getvalue()}"


if __name__ == "__main__":
    faults = {LATER: text(GROWN, None), LESS: text(LITTLE_OIL, None), STUCK: text(STILL, None, CONTROL)}
    faults[BOTH] = text({**GROWN, **LITTLE_OIL}, None)
    faults[SHEET.with_suffix(".csv")] = sheet_text()
    for file, made in {POINTS: text(), **faults, **indicator_texts()}.items():
        file.write_text(made, encoding="utf-8")
        print(file)
