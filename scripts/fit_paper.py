"""Fit the machine that the paper leaves open to its two numbers and its orderings, from several starts.

    python scripts/fit_paper.py 12      -> validation/paper/fits.csv, one row per start

Unknowns are the quantities of scripts/admissible.py within their bounds, and the speed at which displacement gives d =
3 (which determines the bore). Residuals: A5, 68 % within 0.5 points; A6, 44 % within 2 points; each ordering of A2, A3
and A4 between neighbouring speeds counts by its shortfall, or not at all where it holds. There are more unknowns than
conditions, so that many fits meet all: each start leads to one near it, and their scatter is the result.

Starts are the machines of validation/paper/admissible.csv with A1-A4, nearest to A5 first; least squares are as in
`screwsim calibrate` (bounded, central differences of 0.01 of the bounds). `screwsim validate paper` computes the
figures of each row again.
"""

import csv
import os
import sys
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise
from pathlib import Path
from typing import Any

import admissible
import numpy as np
from scipy.optimize import least_squares

from screwsim.scene import Scene, load, with_values
from screwsim.simulate import simulate
from screwsim.study.claims import curve_optimum, value_at
from screwsim.study.validation import read_table

ROOT = Path(__file__).resolve().parent.parent
PAPER = ROOT / "validation" / "paper"
TARGET = PAPER / "fits.csv"
RPM, D = 2.0 * np.pi / 60.0, 3.0
SPEEDS = (250.0, 5000.0)  # [rpm] of A6, range of Fig. 1
A5, A5_WIDTH, A6, A6_WIDTH = 0.68, 0.005, 0.44, 0.02
MARGINS = (0.004, 0.05, 0.05, 0.05)  # A2 (efficiency), A3 (curvature, drop), A4 (ratio); the last three in logarithms
WIDTHS = (0.004, 0.05, 0.05, 0.05)  # shortfalls that count as one
TOLD = "(least squares to A5, A6 and the orderings; row: of admissible.csv, where it began; cost: sum of squares)"
STEP, LOST, CHEAP = 0.01, 5.0, ("numerics.accuracy=1e-4", "numerics.error=none")


def displaced(scene: Scene, x: np.ndarray, rpm: float) -> tuple[float, float]:
    """Return η of displacement supply with the bore that gives d = 3 at a speed [rpm], and that bore [m]."""
    machine = with_values(admissible.machine(scene, x, pump=False), {"operation.speed": rpm * RPM})
    bore = 4e-3 * np.sqrt(rpm / 1000.0)
    for _ in range(4):
        found = simulate(with_values(machine, {"oil_supply.orifice_diameter": float(bore)}), trace=False).performance
        ratio = found.get("oil_ratio")
        if not ratio:
            return np.nan, float(bore)
        if abs(ratio / D - 1.0) < 2e-3:
            break
        bore *= np.sqrt(D / ratio)
    return float(found.isothermal_efficiency), float(bore)


def orderings(eta: np.ndarray) -> list[float]:
    """Return the shortfalls of A2, A3 and A4 between neighbouring speeds; LOST for each where an optimum is missing."""
    best = [curve_optimum(admissible.RATIOS, row) for row in eta]
    left = []
    for fast, slow in pairwise(best):
        if fast is None or slow is None or not (fast.interior and slow.interior):
            left += [LOST] * len(MARGINS)
            continue
        gains = (
            fast.efficiency - slow.efficiency,
            np.log(max(slow.curvature, 1e-4) / max(fast.curvature, 1e-4)),
            np.log(max(slow.drop or 0.0, 1e-4) / max(fast.drop or 0.0, 1e-4)),
            np.log(slow.ratio / fast.ratio),
        )
        left += [max(0.0, m - gain) / w for gain, m, w in zip(gains, MARGINS, WIDTHS, strict=True)]
    return left


class Paper:
    """Residuals over the unit cube: the open quantities, then the speed of A6 in logarithms."""

    def __init__(self) -> None:
        self.pump = load(ROOT / "configs" / "paper" / "point.yaml", CHEAP)
        self.displacement = load(PAPER / "displacement.yaml", CHEAP)

    def speed(self, u: np.ndarray) -> float:
        """Return the speed of A6 [rpm]."""
        return float(SPEEDS[0] * (SPEEDS[1] / SPEEDS[0]) ** u[-1])

    def residuals(self, u: np.ndarray) -> np.ndarray:
        """Return the residuals of A5, A6, then of the orderings."""
        u = np.clip(u, 0.0, 1.0)
        x = admissible.from_unit(u[:-1])
        eta = admissible.curves(admissible.machine(self.pump, x), in_series=True)
        at_three = value_at(admissible.RATIOS, eta[admissible.SPEEDS.index(1000.0)], D)
        pushed, _ = displaced(self.displacement, x, self.speed(u))
        values = (((at_three or np.nan) - A5) / A5_WIDTH, (pushed - A6) / A6_WIDTH)
        return np.array([*(each if np.isfinite(each) else LOST for each in values), *orderings(eta)])

    def slopes(self, u: np.ndarray) -> np.ndarray:
        """Return central differences, one-sided at bounds."""
        columns = []
        for i in range(len(u)):
            low, high = np.array(u), np.array(u)
            low[i], high[i] = max(0.0, u[i] - STEP), min(1.0, u[i] + STEP)
            columns.append((self.residuals(high) - self.residuals(low)) / (high[i] - low[i]))
        return np.column_stack(columns)


def starts(count: int) -> list[tuple[int, np.ndarray]]:
    """Return (row of the sample, point of the unit cube with 500 rpm) of machines with A1-A4, nearest to A5 first."""
    rows = read_table(PAPER / "admissible.csv")
    good = [(n, row) for n, row in enumerate(rows, 1) if all(row[f"a{i}"] == "True" for i in (1, 2, 3, 4))]
    good.sort(key=lambda each: abs(float(each[1]["eta"]) - A5))
    middle = np.log(500.0 / SPEEDS[0]) / np.log(SPEEDS[1] / SPEEDS[0])
    places = [(n, admissible.to_unit(np.array([float(row[item.name]) for item in admissible.OPEN]))) for n, row in good]
    return [(n, np.append(np.clip(u, 0.02, 0.98), middle)) for n, u in places[:count]]


def fit(start: tuple[int, np.ndarray]) -> dict[str, Any]:
    """Return the table row of one start."""
    paper, (number, began) = Paper(), start
    found = least_squares(
        paper.residuals, began, jac=paper.slopes, bounds=(0.0, 1.0), xtol=1e-4, ftol=1e-3, gtol=1e-6, max_nfev=10
    )
    u = np.clip(found.x, 0.0, 1.0)
    x, left = admissible.from_unit(u[:-1]), paper.residuals(u)
    _, bore = displaced(paper.displacement, x, paper.speed(u))
    row: dict[str, Any] = {"row": number, "cost": f"{float(left @ left):.4g}"}
    row |= {item.name: f"{value:.6g}" for item, value in zip(admissible.OPEN, x, strict=True)}
    return row | {"speed_rpm": f"{paper.speed(u):.5g}", "bore_mm": f"{1e3 * bore:.5g}"}


def write(rows: list[Mapping[str, Any]]) -> None:
    """Write the rows so far, the best first."""
    with TARGET.open("w", newline="", encoding="utf-8") as stream:
        stream.write(f"# Made by: python scripts/fit_paper.py {sys.argv[1]} {TOLD}\n")
        writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(rows, key=lambda row: float(row["cost"])))


def main(count: int) -> None:
    """Fit from `count` starts."""
    rows: list[Mapping[str, Any]] = []
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for row in pool.map(fit, starts(count)):
            rows.append(row)
            print(", ".join(f"{name} {value}" for name, value in row.items()), file=sys.stderr, flush=True)
            write(rows)


if __name__ == "__main__":
    main(int(sys.argv[1]))
