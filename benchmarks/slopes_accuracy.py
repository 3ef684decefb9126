"""Print the cost of exact derivatives: errors of stored pairs of figure and number, over processor time.

Run: python benchmarks/slopes_accuracy.py [RUNS]. Scenes and references are those of tests/tools/derivatives_pairs.csv;
pairs whose reference is less accurate than 1e-5 are left out. Quick, exact and intermediate derivatives of each scene
are computed in turn from the same solved cycle; times are medians of one thread, summed over all scenes, with code as
in a first run (not compiled for speed, which would take minutes for all models), compiled beforehand.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "tools"))
import derivatives as tool  # noqa: E402
from screwsim.derivatives.collocation import FINE, QUICK, Fineness, collocated  # noqa: E402
from screwsim.derivatives.solving import derivatives, with_settled_surroundings  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402

PAIRS = ROOT / "tests" / "tools" / "derivatives_pairs.csv"
SEED = 1  # seed of the scenes of that file
KINDS = {"quick": QUICK, "between": Fineness(), "exact": FINE}
LIMITS = (1e-5, 1e-4, 1e-3, 1e-2)


class Measured:
    """Results of one kind of derivatives: errors of pairs, seconds and slices by scene."""

    def __init__(self) -> None:
        self.errors: list[float] = []
        self.cycles: list[float] = []
        self.rest: list[float] = []
        self.slices = 0

    def line(self, points: float) -> str:
        """Return a row: slices, times in points, and the shares of pairs below the limits."""
        errors = np.array(self.errors)
        shares = " ".join(f"{np.mean(errors < limit):>8.2%}" for limit in LIMITS)
        cycle, rest = sum(self.cycles) / points, sum(self.rest) / points
        return f"{self.slices:7d} {cycle:9.1f} {rest:9.1f}  {shares}  {np.median(errors):8.1e}"


def of_scene(rows: list[tool.Row], exact: tool.Exact, fineness: Fineness) -> tuple[float, float, Any, dict[str, Any]]:
    """Return the seconds of the collocated cycle and of the rest, that cycle, and the derivatives by path."""
    paths = list(dict.fromkeys(row["path"] for row in rows))
    began = time.process_time()
    cycle = collocated(exact.problem, exact.machinery, exact.life, fineness)
    cycle = with_settled_surroundings(cycle, exact.life, None, fineness)
    closed = time.process_time()
    slopes, _ = derivatives(cycle, {path: exact.values[path] for path in paths})
    return closed - began, time.process_time() - closed, cycle, slopes


def main(runs: int = 3) -> None:
    """Print a line for each kind."""
    measured, points = {name: Measured() for name in KINDS}, 0.0
    for number, rows in sorted(tool.read([str(PAIRS)]).items()):
        scene = tool.scene_of(number, SEED)[2]
        exact, times = tool.Exact(scene), []
        simulate(scene, trace=False)
        seconds: dict[str, list[tuple[float, float]]] = {name: [] for name in KINDS}
        for run in range(runs + 1):  # the first one compiles
            began = time.process_time()
            simulate(scene, trace=False)
            times += [time.process_time() - began]
            for name, fineness in KINDS.items():
                closing, rest, cycle, slopes = of_scene(rows, exact, fineness)
                seconds[name].append((closing, rest))
                if not run:
                    measured[name].slices += cycle.pitch.count
                    for row in rows:
                        if row["own"] <= tool.GOOD:
                            slope = slopes[row["path"]][row["figure"]] * exact.values[row["path"]] / row["value"]
                            measured[name].errors.append(tool._error(row, slope))
        points += statistics.median(times[1:])
        for name, each in seconds.items():
            measured[name].cycles.append(statistics.median(closing for closing, _ in each[1:]))
            measured[name].rest.append(statistics.median(rest for _, rest in each[1:]))
    heads = " ".join(f"{f'< {limit:g}':>8}" for limit in LIMITS)
    print(f"{'':6} {'slices':>7} {'cycle':>9} {'rest':>9}  {heads}  {'median':>8}   (times in points)")
    for name, each in measured.items():
        print(f"{name:6} {each.line(points)}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
