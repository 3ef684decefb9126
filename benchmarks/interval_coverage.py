"""Do 90 % intervals of a posterior hold what is measured? Points of a known machine with a known discrepancy.

    python benchmarks/interval_coverage.py [--fits 10] [--fitted 12] [--held-out 20]
        [--discrepancy even|speed|none] [-o FILE]

The machine is that of configs/calibration/leakage.fit.yaml with its three parameters drawn anew for each fit; each
point has a speed and a discharge pressure of its own. Measured is what that machine gives, plus a discrepancy, plus
noise (0.5 % of flow and power, 0.5 K). The discrepancy has a standard deviation of 1 % of a figure's median, 1 K of
temperatures: `even` is normal at every point, as the posterior assumes; `speed` is a straight line over the speed,
which it does not assume. The posterior of the fitted points then predicts the others. `-o` adds the outcome to a file
of such; `--table` prints the table of the docs from one.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from screwsim.scene import with_values
from screwsim.simulate import simulate
from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.calibration.answers import LEVEL
from screwsim.study.calibration.fit import Fit, Measurement, Point
from screwsim.study.calibration.predict import posterior_with_predictions

ROOT = Path(__file__).resolve().parent.parent
FIT = ROOT / "configs" / "calibration" / "leakage.fit.yaml"
FIGURES = ("gas_mass_flow", "shaft_power", "discharge_temperature")
SPEEDS, PRESSURES = (1000.0, 4000.0), (8e5, 11.5e5)  # [rpm], [Pa]
RPM, RATIO = np.pi / 30.0, 1.5
NOISE, DISCREPANCY = (0.005, 0.5), (0.01, 1.0)  # of the value, of temperatures [K]
KINDS = ("even", "speed", "none")


def measured(fit: Fit, seed: int, count: int, kind: str) -> list[Point]:
    """Return `count` measured points of a machine whose parameters are drawn by the seed."""
    random = np.random.default_rng(seed)
    truth = {each.path: each.value(float(random.uniform(0.25, 0.75))) for each in fit.parameters}
    speeds, pressures = random.uniform(*SPEEDS, count) * RPM, random.uniform(*PRESSURES, count)
    conditions = [
        {"operation.speed": float(n), "operation.discharge.pressure": float(p), "oil_supply.ratio": RATIO}
        for n, p in zip(speeds, pressures, strict=True)
    ]
    machine = fit.machine(truth)
    results = [simulate(with_values(machine, each), trace=False) for each in conditions]
    ours = np.array([[result.performance[name] for name in FIGURES] for result in results])
    share = np.array([name != "discharge_temperature" for name in FIGURES])
    noise = np.where(share, NOISE[0] * ours, NOISE[1])
    width = np.where(share, DISCREPANCY[0] * np.median(ours, axis=0), DISCREPANCY[1])
    line = (speeds - speeds.mean()) / speeds.std()
    by_kind = {
        "even": random.standard_normal(ours.shape),
        "speed": line[:, None] * random.choice([-1.0, 1.0], len(FIGURES)),
        "none": np.zeros(ours.shape),
    }
    values = ours + width * by_kind[kind] + noise * random.standard_normal(ours.shape)
    return [
        Point(f"{i}", each, {name: Measurement(*pair) for name, *pair in zip(FIGURES, *rows, strict=True)})
        for i, (each, *rows) in enumerate(zip(conditions, values.tolist(), noise.tolist(), strict=True))
    ]


def covered(seed: int, fitted: int, held_out: int, kind: str, jobs: int | None) -> dict:
    """Return how many held-out measurements lie in the intervals of one fit, by figure."""
    fit = read_fit(FIT)
    points = measured(fit, seed, fitted + held_out, kind)
    found = calibrate(replace(fit, points=tuple(points[:fitted]), starts=1, seed=seed), jobs=jobs)
    wide = posterior_with_predictions(found, points[fitted:], jobs=jobs)
    told = wide.predictions
    assert told is not None
    inside = {name: sum(bool(each.inside) for each in told.figures if each.figure == name) for name in FIGURES}
    return {
        "seed": seed,
        "status": [found.status, wide.status, told.status],
        "inside": inside,
        "of": held_out if told.figures else 0,
        "solutions": found.solutions + wide.solutions + told.solutions,
    }


def summary(run: dict) -> dict:
    """Return the shares inside, by figure and in all, and the latter's standard error between fits."""
    fits = [each for each in run["fits"] if each["of"]]
    of = sum(each["of"] for each in fits)
    shares = {name: sum(each["inside"][name] for each in fits) / of for name in FIGURES}
    by_fit = [sum(each["inside"].values()) / (each["of"] * len(FIGURES)) for each in fits]
    error = float(np.std(by_fit, ddof=1) / np.sqrt(len(by_fit))) if len(by_fit) > 1 else float("nan")
    return {**shares, "all": float(np.mean(by_fit)), "error": error, "measurements": of * len(FIGURES)}


def table(runs: dict) -> str:
    """Return the outcomes as a table for the docs."""
    lines = [
        "| discrepancy | fits | fitted points | held-out measurements | flow | power | temperature | all |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for kind, run in runs.items():
        s = summary(run)
        shares = " | ".join(f"{100.0 * s[name]:.1f} %" for name in FIGURES)
        all_ = f"{100.0 * s['all']:.1f} ± {100.0 * s['error']:.1f} %"
        lines.append(f"| {kind} | {len(run['fits'])} | {run['fitted']} | {s['measurements']} | {shares} | {all_} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fits", type=int, default=10)
    parser.add_argument("--fitted", type=int, default=12)
    parser.add_argument("--held-out", type=int, default=20)
    parser.add_argument("--discrepancy", choices=KINDS, default="even")
    parser.add_argument("--jobs", type=int)
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--table", type=Path, metavar="FILE.json")
    asked = parser.parse_args()
    if asked.table is not None:
        print(table(json.loads(asked.table.read_text(encoding="utf-8"))))
        return
    if min(asked.fits, asked.fitted, asked.held_out) < 1:
        parser.error("--fits, --fitted and --held-out are 1 or more")
    fits = []
    for seed in range(1, asked.fits + 1):
        fits.append(covered(seed, asked.fitted, asked.held_out, asked.discrepancy, asked.jobs))
        print(fits[-1], flush=True)
    run = {"level": LEVEL, "fitted": asked.fitted, "fits": fits}
    print(table({asked.discrepancy: run}))
    if asked.output is not None:
        runs = json.loads(asked.output.read_text(encoding="utf-8")) if asked.output.exists() else {}
        asked.output.write_text(json.dumps({**runs, asked.discrepancy: run}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
