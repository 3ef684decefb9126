"""Print the evaluations of a point over speed: for closing alone, and for closing with the error estimate.

Run: python benchmarks/by_speed.py [SPEEDS]. Three machines, the paper's, the same with carried oil, and one on R134a,
run at 25 speeds (or SPEEDS) from 250 to 10 000 rpm in equal ratios, each from its own first guess.
`numerics.rhs_evaluations` of a result counts closing alone. The counts hardly depend on the computer.
"""

from __future__ import annotations

import statistics
import sys
from pathlib import Path

import numpy as np

from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import problem_of
from screwsim.scene import Scene, load
from screwsim.solve.accurately import solve

ROOT = Path(__file__).resolve().parent.parent
PAPER, REAL = ROOT / "configs" / "paper" / "point.yaml", ROOT / "tests" / "plain" / "r134a.yaml"
MACHINES = {"paper": (PAPER, ()), "carried oil": (PAPER, ("oil.transport=carried",)), "R134a": (REAL, ())}
SLOWEST, FASTEST, COUNT = 250.0, 10_000.0, 25
WANTED = 10_000  # evaluations per point that should suffice


def evaluations(scene: Scene) -> tuple[str, int, int]:
    """Return the status of a scene's cycle and the evaluations of closing it, and of closing and estimating."""
    problem = problem_of(scene)
    machinery = lease_for(problem)
    before = machinery.counts.copy()
    found = solve(problem, machinery)
    both = machinery.evaluations_of(machinery.counts - before)
    return found.cycle.status, machinery.evaluations_of(found.counts), both


def main(speeds: int = COUNT) -> None:
    """Print a row for each speed, and summary rows."""
    print(f"{'rpm':>8}" + "".join(f"{name:>16}{'estimated':>11}" for name in MACHINES))
    counts = []
    for rpm in np.geomspace(SLOWEST, FASTEST, speeds):
        row = [evaluations(load(path, [*more, f"operation.speed={rpm} rpm"])) for path, more in MACHINES.values()]
        counts.append([count for _, *both in row for count in both])
        marks = "".join(f" ({status})" for status, *_ in row if status != "ok")
        print(_line(f"{rpm:.0f}", counts[-1]) + marks)
    columns = list(zip(*counts, strict=True))
    print(_line("most", [max(column) for column in columns]))
    print(_line("median", [int(statistics.median(column)) for column in columns]))
    print(_line(f"> {WANTED}", [sum(count > WANTED for count in column) for column in columns]))


def _line(first: str, counts: list[int]) -> str:
    return f"{first:>8}" + "".join(f"{count:>{11 if i % 2 else 16}}" for i, count in enumerate(counts))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
