"""Print the cost of derivatives of all figures by 20 numbers, relative to a point: CPU time of one thread, medians.

Exact ones come first, then quick ones (`derivatives.collocation.QUICK`). Then follow the parts, in points: the
collocated cycle, scenes composed with shifted numbers, the response of the cycle to that, reading figures. Last are the
numbers of evaluations for one chamber: by the point, then by the derivatives.

Run: python benchmarks/sensitivities.py [RUNS]. Points and derivatives alternate, compiled for speed and warm, so that
no compilation is included. A point is `simulate` with its error estimate, as in `run`.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from screwsim.codegen.modules import for_speed
from screwsim.derivatives import lane_rates, solving
from screwsim.derivatives.collocation import FINE, QUICK, Fineness
from screwsim.derivatives.directions import Directions
from screwsim.derivatives.node_rates import NodeRates
from screwsim.derivatives.solving import scene_derivatives
from screwsim.scene import Scene, load
from screwsim.simulate import simulate
from screwsim.study.uncertainty.slopes import numeric_paths

ROOT = Path(__file__).resolve().parent.parent
SCENES = (
    "configs/paper/point.yaml",
    "configs/r134a/point.yaml",
    "configs/slider_crank/air.yaml",
    "configs/everything.yaml",
)
NUMBERS = 20
KINDS = {"exact": FINE, "quick": QUICK}
SHOWN = ("cycle", "composed", "moved", "read")


def cpu(work: Callable[[], object]) -> float:
    """Return the CPU time [ms] of a call."""
    started = time.process_time()
    work()
    return 1e3 * (time.process_time() - started)


class Counted:
    """CPU time [ms] of parts of the derivatives, and numbers of evaluations, since the last `clear`."""

    def __init__(self) -> None:
        self.times, self.rates, self.jacobians, self.slices = dict.fromkeys(PARTS, 0.0), 0, 0, 0
        for part, (owner, work) in PARTS.items():
            setattr(owner, work.__name__, self._timed(part, work))
        rates, lanes, slopes = NodeRates.at, lane_rates._in_lanes, NodeRates._slopes

        def counted(of: NodeRates, Y: Any, edges: Any = None) -> Any:
            self.rates += Y.size // of.n
            return rates(of, Y, edges)

        def counted_lanes(of: NodeRates, nodes: Any, numbers: Any, *asked: Any) -> Any:
            self.rates += len(numbers) * math.prod(nodes.y.shape) // of.n
            return lanes(of, nodes, numbers, *asked)

        def counted_slopes(of: NodeRates, angles: Any, *asked: Any, **how: Any) -> Any:
            self.jacobians += len(angles) * of.N // of.n
            return slopes(of, angles, *asked, **how)

        for owner, name, by in (
            (NodeRates, "at", counted),
            (lane_rates, "_in_lanes", counted_lanes),
            (NodeRates, "_slopes", counted_slopes),
        ):
            setattr(owner, name, by)

    def clear(self) -> None:
        """Reset all counts."""
        self.times, self.rates, self.jacobians = dict.fromkeys(PARTS, 0.0), 0, 0

    def _timed(self, part: str, work: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*arguments: Any) -> Any:
            started = time.process_time()
            found = work(*arguments)
            self.times[part] += 1e3 * (time.process_time() - started)
            if part in ("cycle", "again"):
                self.slices = found.pitch.count
            return found

        return timed


PARTS = {  # by their names here: whose they are, and which function
    "cycle": (solving, solving.collocated),
    "again": (solving, solving.collocated_nearby),
    "composed": (Directions, Directions.of),
    "moved": (solving, solving.closed_with_drive),
    "shifted": (solving, solving.shifted_evaluation),
    "read": (solving, solving._readings_of),
}


def told(scene: Scene, runs: int, counted: Counted, fineness: Fineness) -> str:
    """Return point, derivatives [ms] and the median of their ratios for a scene."""
    values, _ = numeric_paths(scene)
    asked = {path: value for path, value in values.items() if value}
    asked = dict(list(asked.items())[:NUMBERS])

    def derived() -> None:
        answer = scene_derivatives(scene, asked, fineness)
        assert not answer.why and not answer.refused, (answer.why, answer.refused)

    simulate(scene, trace=False)
    derived()
    counted.clear()
    pairs = [(cpu(lambda: simulate(scene, trace=False)), cpu(derived)) for _ in range(runs)]
    points, derivatives = zip(*pairs, strict=True)
    # `scene_derivatives` also closes the cycle of the point itself, which the ratio includes
    ratio = statistics.median(after / before for before, after in pairs)
    point, told = statistics.median(points), simulate(scene, trace=False).numerics
    times = counted.times
    parts = times | {"cycle": times["cycle"] + times["again"], "read": times["shifted"] + times["read"]}
    parts = "".join(f" {parts[name] / runs / point:9.1f}" for name in SHOWN)
    of_point = f"{told['rhs_evaluations']} rates, {told['jacobians']} Jacobians"
    of_all = f"{counted.rates // runs} rates, {counted.jacobians // runs} Jacobians, {counted.slices} slices"
    return f"{point:8.1f} {statistics.median(derivatives):12.1f} {ratio:8.1f}{parts}  {of_point}; {of_all}"


def main(runs: int = 9) -> None:
    """Print a line for each scene and kind."""
    counted = Counted()
    head = f"{'scene':28} {'':5} {'point ms':>8} {f'{NUMBERS} numbers':>12} {'ratio':>8}"
    print(head + "".join(f" {name:>9}" for name in SHOWN))
    with for_speed():
        for name in SCENES:
            for kind, fineness in KINDS.items():
                print(f"{name:28} {kind} {told(load(ROOT / name), runs, counted, fineness)}", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
