"""Print the cost of a sweep beside its solutions, and the gain by a second worker.

Run: python benchmarks/sweep_speed.py [SCENE.yaml] [REPEATS]. Overhead: processor time of a sweep in this process,
including its parts, over that of the same blocks simulated alone; the file that joins the parts is given separately.
Workers: wall time of whole sweeps, best of the repeats, which needs idle cores. For comparison with the computer's own
limit, the same blocks run without a sweep in one process, and in two at once. For sweeps of a real gas, the processor
times of workers and of the process that writes the file are also given.
"""

from __future__ import annotations

import multiprocessing
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from screwsim.batch import warm_up as beside
from screwsim.codegen.modules import for_speed
from screwsim.scene import Scene, case, load
from screwsim.simulate import warm_up
from screwsim.study.pool.progress import Progress
from screwsim.study.sweep.cases import blocks_of
from screwsim.study.sweep.run import default_simulate_many, no_warm_up, run_sweep

ROOT = Path(__file__).resolve().parent.parent
FIG1 = ROOT / "configs" / "paper" / "fig1.yaml"
REAL = ROOT / "tests" / "plain" / "r134a.yaml"
PRESSURES = [
    "operation.speed=3000 rpm",
    "operation.condensing_temperature=45 degC",
    "sweep.operation.condensing_temperature={{from: 30 degC, to: 60 degC, count: {}}}",
]
REAL_SWEEPS = ((1000, "estimate"), (5000, "estimate"), (1000, "none"))  # points, and numerics.error


def seconds(work: Callable[[], object], clock: Callable[[], float]) -> float:
    """Return the duration of a call by a clock [s]."""
    began = clock()
    work()
    return clock() - began


def simulate_alone(scene: Scene) -> None:
    """Simulate the blocks of a sweep without a sweep."""
    blocks, many = blocks_of(scene), default_simulate_many(scene)
    for number in range(blocks.count):
        first = blocks.cases_of(range(number, number + 1)).start
        for _ in many(case(scene, first + place) for place in blocks.order(number)):
            pass


def side_by_side(scene: Scene, processes: int) -> float:
    """Return the time [s] of processes that each simulate all blocks simultaneously, from their common start."""
    fork = multiprocessing.get_context("fork")
    barrier = fork.Barrier(processes + 1)

    def work() -> None:
        barrier.wait()
        simulate_alone(scene)

    workers = [fork.Process(target=work) for _ in range(processes)]
    for worker in workers:
        worker.start()
    barrier.wait()
    began = time.perf_counter()
    for worker in workers:
        worker.join()
    return time.perf_counter() - began


class Stopwatch(Progress):
    """Progress that records processor times [s]: when all cases are computed, and how long laying out the file took.

    A sweep in this process lays out the file between its first chunk and its first tick.
    """

    computed = 0.0
    laid_out: float | None = None
    _first = 0.0

    def advance(self, cases: int, failed: int) -> None:
        self._first = self._first or time.process_time()

    def tick(self) -> None:
        if self.laid_out is None:
            self.laid_out = time.process_time() - self._first

    def stop(self) -> None:
        self.computed = time.process_time()


def swept(scene: Scene, jobs: int, batch: bool = False) -> tuple[float, float]:
    """Sweep a scene into a temporary file; return the processor time [s] of its cases and of its file."""
    watch, began = Stopwatch(), time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        run_sweep(scene, Path(folder) / "sweep.h5", jobs=jobs, progress=watch, warm_up=no_warm_up, batch=batch)
        ahead = watch.laid_out or 0.0
        return watch.computed - began - ahead, time.process_time() - watch.computed + ahead


def whole_sweep(scene: Scene, batch: bool) -> tuple[float, float, float]:
    """Sweep a scene with two workers; return wall time, and processor times of this process and of the workers [s]."""
    before, began = os.times(), time.perf_counter()
    swept(scene, 2, batch)
    wall, after = time.perf_counter() - began, os.times()
    own = after.user + after.system - before.user - before.system
    workers = after.children_user + after.children_system - before.children_user - before.children_system
    return wall, own, workers


@for_speed()
def main() -> None:
    """Measure one scene, and real-gas points over the condensing temperature."""
    scene = load(sys.argv[1] if len(sys.argv) > 1 else str(FIG1))
    repeats = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    warm_up(scene)
    swept(scene, 1)
    cases = blocks_of(scene).cases
    rounds = [(seconds(partial(simulate_alone, scene), time.process_time), *swept(scene, 1)) for _ in range(repeats)]
    alone, computed, file = (statistics.median(column) for column in zip(*rounds, strict=True))
    extra = statistics.median(each[1] / each[0] for each in rounds) - 1.0
    print(f"{cases} points: {1e3 * alone / cases:.3f} ms a point alone, {1e3 * computed / cases:.3f} ms in a sweep")
    print(f"overhead {extra:.1%} of the solution a point, and {1e3 * file:.0f} ms for the file (processor time)")
    walls = [
        (
            *(seconds(partial(swept, scene, jobs), time.perf_counter) for jobs in (1, 2)),
            *(side_by_side(scene, n) for n in (1, 2)),
        )
        for _ in range(repeats)
    ]
    one, two, alone, both = (min(column) for column in zip(*walls, strict=True))
    print(f"one worker {one:.2f} s, two workers {two:.2f} s: {one / two:.2f} times as fast")
    print(
        f"blocks alone: one process {alone:.2f} s, two at once {both:.2f} s: the machine gives {2 * alone / both:.2f}"
    )
    for points, errors in REAL_SWEEPS:
        asked = [text.format(points) if text.startswith("sweep.") else text for text in PRESSURES]
        real = load(str(REAL), [*asked, f"numerics.error={errors}"])
        warm_up(real)
        beside(real)
        for batch, how in ((False, ""), (True, ", --batch")):
            runs = [whole_sweep(real, batch) for _ in range(min(repeats, 3))]
            wall, own, workers = (min(column) for column in zip(*runs, strict=True))
            told = f"numerics.error: {errors}{how}: {points / wall:.0f} points/s"
            print(f"real gas at 3000 rpm over {points} condensing temperatures, two workers, {told}")
            of_workers, here = (f"{1e6 * each / points:.0f} us" for each in (workers, own))
            print(f"  processor time a point: {of_workers} of workers, {here} of the process that writes the file")


if __name__ == "__main__":
    main()
