"""Print how many points a minute a GPU integrates, beside this machine's processor, and how far its figures are off.

Run: python benchmarks/gpu.py [--points N] [--workers N] [--course N]. Of the paper's machine and one with R134a: points
of a sample, errors estimated, in one call on the GPU, and an eighth as many one by one and in the lanes of one core.
Figures are held against those of the processor, in parts of their stated errors. Double precision throughout. Wall
times, since a processor that waits for a device spends none. What compiling takes is told apart.

With `--workers` so many processes share the device, each with a core and points of its own, and then the same without
it, each core in its lanes; with `--course` each point of the sample is a course of so many over the speed, of which
each begins from those before it.
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

from screwsim.batch import simulate_courses, tasks, together
from screwsim.batch.driver import THREADS, Driver
from screwsim.batch.on_device import DeviceTurns
from screwsim.codegen.modules import for_speed
from screwsim.cycle.problem import sharing
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
ACCURACY = 3e-4  # default of `numerics.accuracy`
NEXT = 0.01  # relative increase of the speed between the points of a course
CHECKED = 8  # one in so many points is compared with the processor's, which solves as few
Courses = list[list[Scene]]


def courses_of(name: str, count: int, length: int, seed: int = 1) -> Courses:
    """Return courses of a machine that begin at a sample over its speed and pressure or temperature."""
    path, over = MACHINES[name]
    scene = load(str(path), [f"sweep.sample={{kind: sobol, count: {count}, seed: {seed}, over: {{{SPEED}, {over}}}}}"])
    return [_course(case(scene, k), length) for k in range(count)]


def _course(first: Scene, length: int) -> list[Scene]:
    speeds = [f"{first.operation.speed * (1 + NEXT * k)} rad/s" for k in range(1, length)]
    return [first, *(first.with_({"operation.speed": speed}) for speed in speeds)]


def seconds(work: Callable[[], Any]) -> tuple[float, Any]:
    """Return the wall time of a call [s], and its result."""
    began = time.perf_counter()
    found = work()
    return time.perf_counter() - began, found


class Clocked:
    """Wall time [s] of the parts of GPU calls, the number of calls and that of their turns."""

    def __init__(self) -> None:
        self.spent: dict[str, float] = {}
        self.clear()
        parts = {"calls": (DeviceTurns, "turns"), "kernels": (Driver, "run")}
        parts |= {"up": (Driver, "up"), "down": (Driver, "down")}
        for part, (owner, name) in parts.items():
            setattr(owner, name, self._timed(part, getattr(owner, name)))

    def _timed(self, part: str, work: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*asked: Any) -> Any:
            took, found = seconds(partial(work, *asked))
            self.spent[part] += took
            if part == "calls":
                self.count, self.turns = self.count + 1, self.turns + len(asked[1])
            return found

        return timed

    def clear(self) -> None:
        """Reset all times and counts."""
        self.spent.update(calls=0.0, kernels=0.0, up=0.0, down=0.0)
        self.count = self.turns = 0

    def told(self, took: float) -> str:
        """Return in words where the time was spent."""
        calls, kernels, up, down = self.spent.values()
        parts = {"kernels": kernels, "copies": up + down, "rows": calls - kernels - up - down, "between": took - calls}
        shares = ", ".join(f"{part} {100 * share / took:.0f} %" for part, share in parts.items())
        each = f"{1e3 * kernels / max(1, self.count):.0f} ms a kernel"
        return f"{self.count} calls of {self.turns / max(1, self.count):.0f} turns, {each}: {shares}"


def apart(pairs: Sequence[tuple[Result, Result]]) -> str:
    """Return in words how results differ, relative to the larger of the stated errors and the requested accuracy."""
    shares, statuses, counts = [], 0, []
    for one, other in pairs:
        statuses += one.status != other.status
        counts.append(one.numerics.rhs_evaluations / other.numerics.rhs_evaluations)
        for name, value in other.performance.items():
            given = one.performance[name]
            if isinstance(value, float) and isinstance(given, float) and value:
                error = max(other.error.get(name) or 0.0, ACCURACY * abs(value))
                shares.append((abs(given - value) / error, name))
    most, name = max(shares)
    return (
        f"{len(pairs)} points held against the processor's: {statuses} of another status; figures differ by "
        f"{most:.1e} of the error stated for them at most ({name}), evaluations by {statistics.median(counts) - 1:+.1%}"
    )


def measure(name: str, points: int, length: int, clock: Clocked) -> None:
    """Measure one machine; each way has its own points, so that none reuses properties computed for another."""
    first, _ = seconds(lambda: simulate_courses(courses_of(name, THREADS, 1, 99), gpu=True))
    print(f"{name}: compiled for the device, and {THREADS} points: {first:.1f} s", flush=True)
    few = points // CHECKED
    courses = courses_of(name, 8, length, 98)  # for compiling for the processor
    one_by_one(courses[:1])
    simulate_courses(courses)
    slow, quick = courses_of(name, few, length, 1), courses_of(name, few, length, 2)
    alone, _ = seconds(lambda: one_by_one(slow))
    lanes, _ = seconds(lambda: simulate_courses(quick))
    count = few * length
    print(f"  one core: {_rate(count, alone)} one by one, {_rate(count, lanes)} in its lanes", flush=True)
    courses = courses_of(name, points, length, 3)
    clock.clear()
    took, found = seconds(lambda: on_the_gpu(courses))
    print(f"  the device and one core: {_rate(points * length, took)}; {clock.told(took)}", flush=True)
    both = zip(found[::CHECKED], one_by_one(courses[::CHECKED]), strict=True)
    pairs = [pair for ours, theirs in both for pair in zip(ours, theirs, strict=True)]
    print(f"  {apart(pairs)}", flush=True)


def one_by_one(courses: Courses) -> list[list[Result]]:
    """Solve courses as a sweep does."""
    with sharing():
        return [list(simulate_many(course, trace=False)) for course in courses]


def on_the_gpu(courses: Courses) -> list[list[Result]]:
    """Solve courses, all at once."""
    work = [partial(list, simulate_many(course, trace=False)) for course in courses]
    return together(work, len(courses), gpu=True)


def _rate(points: int, took: float) -> str:
    return f"{60 * points / took:.0f} points/min ({1e3 * took / points:.2f} ms)"


@for_speed()
def _worker(name: str, points: int, length: int, gpu: bool, seed: int, ready: Any, out: Any) -> None:
    simulate_courses(courses_of(name, THREADS, 1, 99), gpu=gpu)
    courses = courses_of(name, points, length, seed)
    ready.wait()
    found = on_the_gpu(courses) if gpu else simulate_courses(courses)
    out.put(sum(result.status == "ok" for results in found for result in results))


def shared(name: str, points: int, length: int, workers: int, gpu: bool) -> None:
    """Measure processes that share the device, or do without."""
    context = multiprocessing.get_context("spawn")
    ready, out = context.Barrier(workers + 1), context.Queue()
    asked = [(name, points, length, gpu, seed, ready, out) for seed in range(workers)]
    every = [context.Process(target=_worker, args=each) for each in asked]
    for each in every:
        each.start()
    ready.wait()
    took, fine = seconds(lambda: sum(out.get() for _ in every))
    for each in every:
        each.join()
    count = workers * points * length
    having = "the device and " if gpu else "no device, "
    print(f"  {having}{workers} processes: {_rate(count, took)}; {fine} of {count} points ok", flush=True)


@for_speed()
def main() -> None:
    """Measure both machines on the first device."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=tasks.ON_GPU)
    parser.add_argument("--course", type=int, default=1)
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("--machine", choices=MACHINES, action="append")
    given = parser.parse_args()
    clock = Clocked()
    print(f"{Driver().name}, {given.points} points at once")
    for machine in given.machine or MACHINES:
        measure(machine, given.points, given.course, clock)
        for gpu in (True, False) if given.workers else ():
            shared(machine, given.points, given.course, given.workers, gpu)


if __name__ == "__main__":
    main()
