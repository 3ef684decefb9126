"""Does a front beat random samples?

    benchmarks/optimize_front.py [--evaluations 1000] [--samples 10000]     writes optimize_front.json beside this file

It sets `screwsim optimize` (two aims: highest isothermal efficiency, highest net gas flow, of the paper's
machine over oil ratio, speed, opening and area of the discharge port, oil temperature) against random samples from the
same ranges, ten times as many. A sample is beaten where a member of the front is at least as good in both aims, but for
the estimated numerical errors of both. `profile_optimize.py` is of many evaluations
of rotor profiles.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

import screwsim
from screwsim.study.optimize import question, run_question
from screwsim.study.optimize.question import Question
from screwsim.study.optimize.record import Record
from screwsim.study.pool.parallel import BatchWorkers
from screwsim.study.pool.workers import cores

HERE = Path(__file__).parent
CONFIGS = HERE.parent / "configs"
VARY = {
    "oil_supply.ratio": (0.1, 10.0),
    "operation.speed": (52.36, 628.3),  # 500 to 6000 rpm
    "machine.discharge_port.opens": (10.472, 11.432),  # 600 to 655 deg
    "machine.discharge_port.area": (20e-4, 110e-4),
    "oil_supply.temperature": (275.0, 330.0),
}
AIMS = ("isothermal_efficiency", "gas_mass_flow")
BATCH = 500  # random samples solved at once


def sampled(asked: Question, count: int, jobs: int) -> Record:
    """Return `count` random evaluations."""
    with BatchWorkers(jobs, lambda: None) as crew:
        record = Record(asked, crew)
        generator = np.random.default_rng(11)
        while len(record) < count:
            record.evaluate(generator.random((min(BATCH, count - len(record)), len(asked.spans))))
    return record


def front(evaluations: int, samples: int, jobs: int) -> dict:
    """Return the results of the front and of the samples."""
    scene = screwsim.load(CONFIGS / "paper" / "point.yaml")
    began = time.perf_counter()
    found = run_question(question(scene, VARY, AIMS, evaluations=evaluations), jobs=jobs)
    between = time.perf_counter()
    others = sampled(question(scene, VARY, AIMS, evaluations=samples), samples, jobs)
    seconds = between - began, time.perf_counter() - between
    aims, errors, _ = others.columns()
    good = np.isfinite(aims).all(axis=1)
    ours, own = found.aims[found.front], found.errors[found.front]
    beaten = np.array(
        [np.any(np.all(ours + own >= aims[row] - errors[row], axis=1)) for row in np.flatnonzero(good)], bool
    )
    strictly = np.array([np.any(np.all(ours >= aims[row], axis=1)) for row in np.flatnonzero(good)], bool)
    low = aims[good].min(axis=0)
    return {
        "machine": "configs/paper/point.yaml",
        "vary": {path: list(ends) for path, ends in VARY.items()},
        "maximize": list(AIMS),
        "evaluations": len(found.places),
        "failed_evaluations": found.failed,
        "front": len(found.front),
        "samples": len(aims),
        "failed_samples": int(np.count_nonzero(~good)),
        "samples_beaten": int(np.count_nonzero(beaten)),
        "samples_beaten_without_errors": int(np.count_nonzero(strictly)),
        "hypervolume_of_front": volume(ours, low),
        "hypervolume_of_samples": volume(aims[good], low),
        "best_isothermal_efficiency": [float(ours[:, 0].max()), float(aims[good, 0].max())],
        "best_gas_mass_flow": [float(ours[:, 1].max()), float(aims[good, 1].max())],
        "time_ratio": seconds[0] / seconds[1],
    }


def volume(points: np.ndarray, low: np.ndarray) -> float:
    """Return the area above a corner dominated by points of two objectives to be maximised."""
    total, height = 0.0, float(low[1])
    for x, y in sorted(points.tolist(), key=lambda point: (-point[0], -point[1])):
        if y > height:
            total += (x - float(low[0])) * (y - height)
            height = y
    return total


def main() -> None:
    """Measure, and print the results."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--evaluations", type=int, default=1000)
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--jobs", type=int, default=cores())
    asked = parser.parse_args()
    found = front(asked.evaluations, asked.samples, asked.jobs)
    text = json.dumps(found, indent=1)
    (HERE / "optimize_front.json").write_text(text + "\n")
    print(text)


if __name__ == "__main__":
    main()
