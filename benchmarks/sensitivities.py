"""Print what the derivatives of all figures by 20 numbers cost, over a point: CPU time of one thread, medians.

Run: python benchmarks/sensitivities.py [RUNS]. Points and derivatives take turns, compiled for speed and warm; what
compiling takes is not in it. A point is `simulate` with its error estimate, as `run` does it.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

from screwsim.codegen.modules import for_speed
from screwsim.derivatives.solving import found
from screwsim.scene import Scene, load
from screwsim.simulate import simulate
from screwsim.study.local import numeric_paths

ROOT = Path(__file__).resolve().parent.parent
SCENES = ("configs/paper/point.yaml", "configs/r134a/point.yaml")
NUMBERS = 20


def cpu(work: Callable[[], object]) -> float:
    """Return the CPU time [ms] of some work."""
    started = time.process_time()
    work()
    return 1e3 * (time.process_time() - started)


def told(scene: Scene, runs: int) -> str:
    """Return point, derivatives [ms] and the median of their ratios for a scene."""
    values, _ = numeric_paths(scene)
    asked = {path: value for path, value in values.items() if value}
    asked = dict(list(asked.items())[:NUMBERS])

    def derived() -> None:
        answer = found(scene, asked)
        assert not answer.why and not answer.refused, (answer.why, answer.refused)

    simulate(scene, trace=False)
    derived()
    pairs = [(cpu(lambda: simulate(scene, trace=False)), cpu(derived)) for _ in range(runs)]
    points, derivatives = zip(*pairs, strict=True)
    # `found` closes the cycle of the point itself: the ratio counts that, too
    ratio = statistics.median(after / before for before, after in pairs)
    return f"{statistics.median(points):8.1f} {statistics.median(derivatives):12.1f} {ratio:8.1f}"


def main(runs: int = 9) -> None:
    """Print a line for each scene."""
    print(f"{'scene':28} {'point ms':>8} {f'{NUMBERS} numbers':>12} {'ratio':>8}")
    with for_speed():
        for name in SCENES:
            print(f"{name:28} {told(load(ROOT / name), runs)}", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
