"""Sweep a million points of a cheap scene, and print time, rate, memory and size.

Run: python benchmarks/big_sweep.py [--points 1000000] [--jobs N] [--real] [--batch] [--engine-alone] [-o OUT.h5
[--restart]]. The scene is the paper's point with its ports alone and no error estimate, over speeds and pressures;
with `--real` one on R134a with all its effects and its errors estimated, over speeds and condensing temperatures.
`--batch` solves points side by side; `--engine-alone` simulates one point and gives its result to all, which leaves
what the sweep itself costs. One with -o that was interrupted goes on where it stood when it is run again.
"""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path

from screwsim.codegen.modules import for_speed
from screwsim.outputs import Result
from screwsim.scene import Scene, case, load
from screwsim.simulate import simulate
from screwsim.study.pool.progress import Progress
from screwsim.study.sweep import run_sweep

ROOT = Path(__file__).resolve().parent.parent
POINT = ROOT / "configs" / "paper" / "point.yaml"
REAL = ROOT / "tests" / "plain" / "r134a.yaml"
PORTS = ("suction_port", "discharge_port")
MEBI = 1 << 20


class Tenths(Progress):
    """Progress that records when each tenth was done, and the largest number of part files on disk."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.total = self.done = self.most = self.reused = 0
        self.began = time.perf_counter()
        self.times: list[float] = []
        self.failed = 0  # failed or not closed

    def start(self, cases: int, reused: int) -> None:
        self.total, self.reused = cases - reused, reused

    def advance(self, cases: int, failed: int) -> None:
        self.done += cases
        self.failed += failed
        if 10 * self.done >= (len(self.times) + 1) * self.total:
            self.times.append(time.perf_counter() - self.began)
            self.most = max(self.most, sum(1 for _ in self.folder.iterdir()))
            what = f"{self.reused + self.done} points in {self.times[-1]:.0f} s, {self.failed} of them not ok"
            print(what, file=sys.stderr, flush=True)

    def rates(self) -> list[str]:
        """Return the points per second of each tenth."""
        spans = [after - before for before, after in zip([0.0, *self.times], self.times, strict=False)]
        return [f"{self.total / 10 / span:.0f}" for span in spans]


def scene_of(points: int) -> Scene:
    """Return the machine with its ports only, over speeds and discharge pressures, about `points` in all."""
    rows = max(1, round(points**0.5))
    axes = [
        f"sweep.operation.speed={{from: 1000 rpm, to: 5000 rpm, count: {rows}}}",
        f"sweep.operation.discharge.pressure={{from: 6 bar, to: 10 bar, count: {max(1, points // rows)}}}",
    ]
    whole = load(str(POINT), ["numerics.error=none", *axes])
    return load(str(POINT), ["numerics.error=none", *axes], [name for name in whole.effects if name not in PORTS])


def real_scene_of(points: int) -> Scene:
    """Return a machine on R134a over speeds and condensing temperatures, about `points` in all."""
    rows = max(1, round(points**0.5))
    axes = [
        f"sweep.operation.speed={{from: 2000 rpm, to: 5000 rpm, count: {rows}}}",
        f"sweep.operation.condensing_temperature={{from: 35 degC, to: 60 degC, count: {max(1, points // rows)}}}",
    ]
    return load(str(REAL), axes)


def repeat(result: Result, scenes: Iterable[Scene]) -> Iterator[Result]:
    """Return one result for each scene."""
    return (result for _ in scenes)


@for_speed()
def main() -> None:
    """Run the sweep, and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--real", action="store_true")
    parser.add_argument("--batch", action="store_true")
    parser.add_argument("--engine-alone", action="store_true")
    parser.add_argument("-o", type=Path)
    parser.add_argument("--restart", action="store_true")
    given = parser.parse_args()
    scene = (real_scene_of if given.real else scene_of)(given.points)
    many = partial(repeat, simulate(case(scene, 0), trace=False)) if given.engine_alone else None
    with tempfile.TemporaryDirectory() as folder:
        output = given.o or Path(folder) / "big.h5"
        progress = Tenths(output.with_name(output.name + ".parts"))
        how = {"jobs": given.jobs, "batch": given.batch, "simulate_many": many, "restart": given.restart}
        summary = run_sweep(scene, output, progress=progress, **how)
        size = output.stat().st_size
    peaks = [resource.getrusage(who).ru_maxrss / 1024 for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    statuses = f"{summary.ok} ok, {summary.not_closed} not closed, {summary.failed} failed"
    reused = f", {summary.reused} of them before" if summary.reused else ""
    print(f"{summary.cases} points ({statuses}{reused}) in {summary.seconds:.0f} s", end=", ")
    of_file = summary.seconds - max(progress.times, default=0.0)
    print(f"the file of {size / MEBI:.0f} MiB in the last {of_file:.0f} s of them")
    print(f"points/s by tenths: {' '.join(progress.rates())}")
    print(f"at most {progress.most} files of parts; peak memory {peaks[0]:.0f} MiB, of a worker {peaks[1]:.0f} MiB")


if __name__ == "__main__":
    main()
