"""Print how many points a minute a GPU integrates, beside this machine's processor, and how far its figures are off.

Run: python benchmarks/gpu.py [--points N] [--workers N] [--course N]. Of the paper's machine and one with R134a: points
of a sample, errors estimated, in one call on the GPU, and a quarter of them one by one and in the lanes of one core.
Figures are held against those of the processor, in parts of their stated errors. Double precision throughout. Wall
times, since a processor that waits for a device spends none. What compiling takes is told apart.

With `--workers` so many processes share the device, each with a core and points of its own; with `--course` each point
of the sample is a course of so many over the speed, of which each begins from those before it.
"""

from __future__ import annotations

import argparse
import multiprocessing
import statistics
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from screwsim.batch import cuda as on_gpu
from screwsim.batch import simulate_courses, tasks, together
from screwsim.outputs import Result
from screwsim.scene import Scene, case, load
from screwsim.simulate import simulate_many

ROOT = Path(__file__).resolve().parent.parent
SPEED = "operation.speed: {from: 1500 rpm, to: 4500 rpm}"
MACHINES = {
    "paper": (ROOT / "configs" / "paper" / "point.yaml", "operation.discharge.pressure: {from: 8 bar, to: 14 bar}"),
    "R134a": (
        ROOT / "tests" / "plain" / "r134a.yaml",
        "operation.condensing_temperature: {from: 35 degC, to: 60 degC}",
    ),
}
NEXT = 0.01  # by so much of itself the speed rises from a point of a course to the next
CHECKED = 4  # of so many points one is held against the processor's
Courses = list[list[Scene]]


def courses_of(name: str, count: int, length: int, seed: int = 1) -> Courses:
    """Return courses of a machine: of a sample over its speed and pressure or temperature."""
    path, over = MACHINES[name]
    scene = load(str(path), [f"sweep.sample={{kind: sobol, count: {count}, seed: {seed}, over: {{{SPEED}, {over}}}}}"])
    return [_course(case(scene, k), length) for k in range(count)]


def _course(first: Scene, length: int) -> list[Scene]:
    speed = first.operation.speed
    return [first, *(first.with_({"operation.speed": speed * (1 + NEXT * k)}) for k in range(1, length))]


def seconds(work: Callable[[], Any]) -> tuple[float, Any]:
    """Return the wall time of something [s], and what it returns."""
    began = time.perf_counter()
    found = work()
    return time.perf_counter() - began, found


class Clocked:
    """Wall time [s] of the parts of calls of the GPU, their number and that of their turns."""

    def __init__(self) -> None:
        self.spent, self.calls, self.turns = dict.fromkeys(("whole", "given", "kernel"), 0.0), 0, 0
        self._timed(on_gpu.Cuda, "turns", "whole")
        self._timed(on_gpu.Cuda, "_given", "given")
        self._timed(on_gpu.Cuda, "_integrate", "kernel")

    def _timed(self, owner: Any, name: str, part: str) -> None:
        work = getattr(owner, name)

        def timed(*asked: Any) -> Any:
            took, found = seconds(partial(work, *asked))
            self.spent[part] += took
            if part == "whole":
                self.calls, self.turns = self.calls + 1, self.turns + len(asked[1])
            return found

        setattr(owner, name, timed)

    def clear(self) -> None:
        """Begin anew."""
        self.spent, self.calls, self.turns = dict.fromkeys(self.spent, 0.0), 0, 0

    def told(self, took: float) -> str:
        """Return where the time of a call went."""
        whole, given, kernel = self.spent.values()
        parts = {
            "kernels": kernel,
            "gathering": given,
            "bringing back": whole - given - kernel,
            "between": took - whole,
        }
        shares = ", ".join(f"{part} {100 * share / took:.0f} %" for part, share in parts.items())
        return f"{self.calls} calls of {self.turns / max(1, self.calls):.0f} turns: {shares}"


def apart(found: Sequence[Result], wanted: Sequence[Result]) -> str:
    """Tell by how much results differ, in parts of the larger of the stated errors and the accuracy asked for."""
    shares, statuses, counts = [], 0, []
    for one, other in zip(found, wanted, strict=True):
        statuses += one.status != other.status
        counts.append(one.numerics.rhs_evaluations / other.numerics.rhs_evaluations)
        for name, value in other.performance.items():
            given = one.performance[name]
            if isinstance(value, float) and isinstance(given, float) and value:
                error = max(other.error.get(name) or 0.0, ACCURACY * abs(value))
                shares.append((abs(given - value) / error, name))
    most, name = max(shares)
    return (
        f"{len(found)} points held against the processor's: {statuses} of another status; figures differ by "
        f"{most:.1e} of the error stated for them at most ({name}), evaluations by {statistics.median(counts) - 1:+.1%}"
    )


ACCURACY = 3e-4  # `numerics.accuracy`, its default


def measure(name: str, points: int, length: int, clock: Clocked) -> None:
    """Measure one machine."""
    courses = courses_of(name, points, length)
    first, _ = seconds(lambda: simulate_courses(courses_of(name, on_gpu.THREADS, 1, 2), gpu=True))
    print(f"{name}: compiled for the device, and {on_gpu.THREADS} points: {first:.0f} s")
    few = courses[::CHECKED]
    count = sum(map(len, few))
    one_by_one = [list(simulate_many(few[0], trace=False))]  # and compiled here
    simulate_courses(few[:8])
    alone, one_by_one = seconds(lambda: [list(simulate_many(course, trace=False)) for course in few])
    lanes, _ = seconds(lambda: simulate_courses(few))
    clock.clear()
    took, found = seconds(lambda: on_the_gpu(courses))
    print(f"  one core: {_rate(count, alone)} one by one, {_rate(count, lanes)} in its lanes")
    print(f"  the device and one core: {_rate(points * length, took)}; {clock.told(took)}")
    both = zip(found[::CHECKED], one_by_one, strict=True)
    one, other = zip(*((a, b) for left, right in both for a, b in zip(left, right, strict=True)), strict=True)
    print(f"  {apart(one, other)}")


def on_the_gpu(courses: Courses) -> list[list[Result]]:
    """Solve courses, all at once."""
    work = [partial(list, simulate_many(course, trace=False)) for course in courses]
    return together(work, len(courses), gpu=True)


def _rate(points: int, took: float) -> str:
    return f"{60 * points / took:.0f} points/min ({1e3 * took / points:.2f} ms)"


def _worker(name: str, points: int, length: int, seed: int, ready: Any, out: Any) -> None:
    simulate_courses(courses_of(name, on_gpu.THREADS, 1, 99), gpu=True)
    courses = courses_of(name, points, length, seed)
    ready.wait()
    found = on_the_gpu(courses)
    out.put(sum(result.status == "ok" for results in found for result in results))


def shared(name: str, points: int, length: int, workers: int) -> None:
    """Measure processes that share the device."""
    context = multiprocessing.get_context("spawn")
    ready, out = context.Barrier(workers + 1), context.Queue()
    asked = [(name, points, length, seed, ready, out) for seed in range(workers)]
    every = [context.Process(target=_worker, args=each) for each in asked]
    for each in every:
        each.start()
    ready.wait()
    took, fine = seconds(lambda: sum(out.get() for _ in every))
    for each in every:
        each.join()
    count = workers * points * length
    print(f"  the device and {workers} processes: {_rate(count, took)}; {fine} of {count} points ok")


def main() -> None:
    """Measure both machines on the first device."""
    from numba import cuda  # pyright: ignore[reportMissingImports] - an extra

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=tasks.ON_GPU)
    parser.add_argument("--course", type=int, default=1)
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("--machine", choices=MACHINES, action="append")
    given = parser.parse_args()
    name = cuda.get_current_device().name
    print(f"{name.decode() if isinstance(name, bytes) else name}, {given.points} points at once")
    clock = Clocked()
    for machine in given.machine or MACHINES:
        measure(machine, given.points, given.course, clock)
        if given.workers:
            shared(machine, given.points, given.course, given.workers)


if __name__ == "__main__":
    main()
