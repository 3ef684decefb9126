"""Draw the drives of configs/drive over the speed, and print what their ripple changes (docs/reference/drive.md).

scripts/drive.py [-o FOLDER]      writes drive_campbell.png and .pdf, drive.csv (default: results/drive)
"""

import argparse
import math
import sys
from functools import partial
from pathlib import Path

import numpy as np

from screwsim import load
from screwsim.report.drive import DrivePoint, campbell_figure
from screwsim.report.style import write_all
from screwsim.results.atomic import make_folder, write_csv
from screwsim.simulate import simulate, simulate_many

CONFIGS = Path(__file__).parents[1] / "configs" / "drive"
PAPER = "effects.drive.coupling={linear: null, rubber_cord: {discs: 1}, damping: 6 N m s/rad}"
CASES = {
    "linear, 5 kN m/rad": ("point", ()),
    "rubber cords, 60 mm": ("rubber_cord", ()),
    "rubber cords of the source": ("point", (PAPER,)),
}
RPM = math.pi / 30.0
SPEEDS = np.unique(np.concatenate([np.arange(250.0, 900.0, 25.0), np.arange(900.0, 5001.0, 100.0)]))  # rpm
SHOWN = (250, 500, 1000, 3000, 5000)  # rpm
FINE = "numerics.accuracy=1e-6"
FIGURES = ("shaft_power", "volumetric_efficiency", "isothermal_efficiency")


def points(name: str, overrides: tuple[str, ...]) -> list[DrivePoint]:
    """Return the points of a drive over the speeds."""
    path = CONFIGS / f"{name}.yaml"
    quick = ("numerics.error=none", "numerics.accuracy=1e-3")
    scenes = (load(path, overrides=[*overrides, *quick, f"operation.speed={n} rpm"]) for n in SPEEDS)
    found = []
    for n, result in zip(SPEEDS, simulate_many(scenes, trace=False), strict=True):
        p = result.performance
        if result.status != "ok":
            print(f"{name}, {n:g} rpm: {result.status}, {result.message}", file=sys.stderr)
            found.append(DrivePoint(n * RPM, None, None, None, None))
            continue
        numbers = p.torsional_frequency, p.coupling_torque_mean, p.coupling_torque_amplitude, p.speed_ripple
        found.append(DrivePoint(n * RPM, *numbers))
    return found


def ripple() -> None:
    """Print the changes by ripple of power, volumetric and isothermal efficiency, by speed."""
    print("| drive | speed | ripple | coupling torque | ΔP_shaft | Δλ | Δη_iso |")
    print("|---|---|---|---|---|---|---|")
    for name in ("point", "rubber_cord"):
        for n in SHOWN:
            sets = [FINE, f"operation.speed={n} rpm", "effects.gas_torque=off"]
            path = CONFIGS / f"{name}.yaml"
            with_it, without = simulate(load(path, sets)), simulate(load(path, sets, without=["drive"]))
            a, b = with_it.performance, without.performance
            if with_it.status != "ok":
                print(f"| {name} | {n} rpm | {with_it.message} |")
                continue
            changes = [a[figure] / b[figure] - 1.0 for figure in FIGURES]
            torque = f"{a.coupling_torque_mean:.1f} ± {a.coupling_torque_amplitude:.3g} N m"
            cells = " | ".join(f"{100.0 * change:+.4f} %" for change in changes)
            print(f"| {name} | {n} rpm | {100.0 * a.speed_ripple:.3g} % | {torque} | {cells} |", flush=True)


def main() -> None:
    """Draw the figure and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", dest="folder", default="results/drive", metavar="FOLDER")
    folder = Path(parser.parse_args().folder)
    make_folder(folder)
    found = {label: points(name, overrides) for label, (name, overrides) in CASES.items()}
    table = ([name, *point] for name, rows in found.items() for point in rows)
    write_csv(folder / "drive.csv", ["drive", *DrivePoint._fields], table)
    for path in write_all({"drive_campbell": partial(campbell_figure, found, 4)}, folder):
        print(path, file=sys.stderr)
    for label, rows in found.items():
        known = [row for row in rows if row.frequency is not None]
        worst = max(known, key=lambda row: row.amplitude or 0.0)
        ends = f"{known[0].frequency:.4g} to {known[-1].frequency:.4g} Hz from {known[0].speed / RPM:g} rpm on"
        print(f"{label}: {ends}; amplitude {worst.amplitude:.4g} N m at {worst.speed / RPM:.5g} rpm")
    ripple()


if __name__ == "__main__":
    main()
