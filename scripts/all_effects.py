"""Solve the scene with all effects on, and print how it closes and what a point costs (docs/effects.md).

Run: .venv/bin/python scripts/all_effects.py [REPEATS]. The time is the processor's in a whole `simulate`, compiled and
warm, without traces, as in a sweep; `near` takes it along a course of near speeds, as cases of a sweep do.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path

from screwsim.effects import catalogue
from screwsim.scene import Scene, load, with_values
from screwsim.simulate import simulate, simulate_many

SCENE = Path(__file__).resolve().parent.parent / "configs" / "everything.yaml"
REPEATS = 40
SPEEDS = 0.002  # relative step between the points of a course


def repeated(scene: Scene, repeats: int) -> list[float]:
    """Return the time [ms] of each of so many solutions, every one from its own first guess."""
    simulate(scene, trace=False)
    found = []
    for _ in range(repeats):
        started = time.process_time()
        simulate(scene, trace=False)
        found.append(1e3 * (time.process_time() - started))
    return found


def along(scene: Scene, repeats: int) -> tuple[list[float], list[str]]:
    """Return the time [ms] of each solution along a course of near speeds, and their status."""
    speed = scene.operation.speed
    scenes = [with_values(scene, {"operation.speed": speed * (1.0 + SPEEDS * i)}) for i in range(repeats)]
    found, statuses = [], []
    started = time.process_time()
    for result in simulate_many(scenes, trace=False):
        found.append(1e3 * (time.process_time() - started))
        statuses.append(result.status)
        started = time.process_time()
    return found, statuses


def main() -> None:
    """Print both."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else REPEATS
    for accuracy in (None, 1e-3):
        scene = load(SCENE, [] if accuracy is None else [f"numerics.accuracy={accuracy}"])
        result = simulate(scene)
        balance, numerics = result.balance, result.numerics
        left_out = sorted(set(catalogue()) - set(scene.effects))
        print(f"accuracy {scene.numerics.accuracy:g}: {result.status}, {len(scene.effects)} effects on")
        print(f"  left out: {', '.join(left_out)}")
        residues = ", ".join(f"{name} {balance[name]:.1e}" for name in ("mass", "energy", "entropy", "oil_mass"))
        print(f"  residues: {residues} (bound {balance.bound:.1e})")
        print(f"  {numerics.rhs_evaluations} evaluations, {numerics.steps} steps, closing {numerics.closing}")
        alone, (near, statuses) = repeated(scene, repeats), along(scene, repeats)
        print(f"  alone {statistics.median(alone):.1f} ms (least {min(alone):.1f})", end=", ")
        print(f"near {statistics.median(near):.1f} ms (least {min(near):.1f}), {statuses.count('ok')}/{repeats} ok")


if __name__ == "__main__":
    main()
