"""Solve the scene with all effects, and print how it closes and what a point costs (docs/reference/effects.md).

Run: python benchmarks/all_effects.py [REPEATS]. Times are processor times of a whole `simulate`, compiled and warm,
without traces, as in a sweep; `near` measures a course of neighbouring speeds, as the cases of a sweep are. The paper's
point is solved in turn with it, at the same accuracy, so that other load on the machine affects both. Medians are
given, with the minimum in brackets: a busy machine lengthens processor times too, and the minimum is closer to a quiet
one.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from screwsim.codegen.modules import for_speed
from screwsim.effects import catalogue
from screwsim.scene import Scene, load, with_values
from screwsim.simulate import simulate, simulate_many

CONFIGS = Path(__file__).resolve().parent.parent / "configs"
SCENES = {"all effects": "everything.yaml", "paper's point": "paper/point.yaml"}
REPEATS = 40
SPEEDS = 0.002  # relative step between the points of a course
WAYS = ("alone", "near")


def times(scenes: dict[str, Scene], repeats: int) -> tuple[dict[tuple[str, str], list[float]], list[str]]:
    """Return the times [ms] of each scene, alone and along a course of neighbouring speeds, and all statuses."""
    found: dict[tuple[str, str], list[float]] = {}
    courses = {name: simulate_many(near(scene, repeats + 1), trace=False) for name, scene in scenes.items()}
    statuses = []
    for _ in range(repeats + 1):  # the first is for warming up
        for name, scene in scenes.items():
            for way in WAYS:
                started = time.process_time()
                result = next(courses[name]) if way == "near" else simulate(scene, trace=False)
                found.setdefault((name, way), []).append(1e3 * (time.process_time() - started))
                statuses.append(result.status)
    return {key: each[1:] for key, each in found.items()}, statuses


def near(scene: Scene, count: int) -> Iterator[Scene]:
    """Yield the scene at `count` neighbouring speeds."""
    for i in range(count):
        yield with_values(scene, {"operation.speed": scene.operation.speed * (1.0 + SPEEDS * i)})


@for_speed()
def main() -> None:
    """Print the results at both accuracies."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else REPEATS
    for accuracy in (None, 1e-3):
        changes = [] if accuracy is None else [f"numerics.accuracy={accuracy}"]
        scenes = {name: load(CONFIGS / path, changes) for name, path in SCENES.items()}
        scene = scenes["all effects"]
        result = simulate(scene)
        balance, numerics = result.balance, result.numerics
        left_out = sorted(set(catalogue()) - set(scene.effects))
        print(f"accuracy {scene.numerics.accuracy:g}: {result.status}, {len(scene.effects)} effects on")
        print(f"  left out: {', '.join(left_out)}")
        residuals = ", ".join(f"{name} {balance[name]:.1e}" for name in ("mass", "energy", "entropy", "oil_mass"))
        print(f"  residuals: {residuals} (bound {balance.bound:.1e})")
        print(f"  {numerics.rhs_evaluations} evaluations, {numerics.steps} steps, closing {numerics.closing}")
        found, statuses = times(scenes, repeats)
        for way in WAYS:
            both = [found[name, way] for name in SCENES]
            shown = [f"{statistics.median(each):.1f} ms ({min(each):.1f})" for each in both]
            ratio, least = (of(both[0]) / of(both[1]) for of in (statistics.median, min))
            print(f"  {way}: {shown[0]}, paper's point {shown[1]}, {ratio:.1f} times ({least:.1f})")
        print(f"  {statuses.count('ok')}/{len(statuses)} ok")


if __name__ == "__main__":
    main()
