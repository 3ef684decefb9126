"""Print the evaluations of a point over speed: for closing alone, and for closing with the error estimate.

Run: python benchmarks/by_speed.py [SPEEDS | circuits]. Three machines (the paper's, it with carried oil, one on R134a)
are run at 25 speeds (or SPEEDS) from 250 to 10 000 rpm in equal ratios, each from its own first guess.
`numerics.rhs_evaluations` of a result counts closing alone. The counts hardly depend on the computer.

With `circuits`: closing of shipped scenes with an oil circuit or a package, each at shares of its own speed.
"""

from __future__ import annotations

import statistics
import sys
from pathlib import Path

import numpy as np

from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import problem_of
from screwsim.scene import Scene, load, with_values
from screwsim.simulate import simulate
from screwsim.solve.accurately import solve

ROOT = Path(__file__).resolve().parent.parent
PAPER, REAL = ROOT / "configs" / "paper" / "point.yaml", ROOT / "tests" / "plain" / "r134a.yaml"
MACHINES = {"paper": (PAPER, ()), "carried oil": (PAPER, ("oil.transport=carried",)), "R134a": (REAL, ())}
SLOWEST, FASTEST, COUNT = 250.0, 10_000.0, 25
WANTED = 10_000  # evaluations per point that should suffice
CIRCUITS = (
    *(f"air/{name}" for name in ("fixed_speed_7", "fixed_speed_10", "variable_speed_7", "variable_speed_10")),
    *("air/humid_package", "air/moist", "r134a/separator", "r134a/compact", "two_stage/air_low", "two_stage/air_high"),
    "everything",
)
SHARES = (0.4, 0.6, 0.8, 1.0, 1.15, 1.3)  # of the scene's own speed


def evaluations(scene: Scene) -> tuple[str, int, int]:
    """Return the status of a scene's cycle and the evaluations of closing it, and of closing and estimating."""
    problem = problem_of(scene)
    machinery = lease_for(problem)
    before = machinery.counts.copy()
    found = solve(problem, machinery)
    both = machinery.evaluations_of(machinery.counts - before)
    return found.cycle.status, machinery.evaluations_of(found.cost.counts), both


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


def with_circuits() -> None:
    """Print a row of evaluations for each scene with an oil circuit or a package, and their mean."""
    print(f"{'of its speed':24}" + "".join(f"{share:>9g}" for share in SHARES) + f"{'mean':>9}")
    counts = []
    for name in CIRCUITS:
        scene = load(ROOT / "configs" / f"{name}.yaml")
        results = [
            simulate(with_values(scene, {"operation.speed": share * scene.operation.speed}), trace=False)
            for share in SHARES
        ]
        row = [int(result.numerics.rhs_evaluations) for result in results]
        counts += row
        marks = "".join(f" ({result.status})" for result in results if result.status != "ok")
        print(f"{name:24}" + "".join(f"{count:>9}" for count in row) + f"{statistics.mean(row):>9.0f}" + marks)
    print(f"{'mean':24}{statistics.mean(counts):>{9 * (len(SHARES) + 1)}.0f}")


def _line(first: str, counts: list[int]) -> str:
    return f"{first:>8}" + "".join(f"{count:>{11 if i % 2 else 16}}" for i, count in enumerate(counts))


if __name__ == "__main__":
    if sys.argv[1:] == ["circuits"]:
        with_circuits()
    else:
        main(*map(int, sys.argv[1:]))
