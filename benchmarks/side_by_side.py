"""Print the gain of points side by side in the lanes of a core over one by one, in processor time of paired runs.

Run: python benchmarks/side_by_side.py [PAIRS | SCENE.yaml …]. Courses of R134a over the condensing temperature, with or
without error estimates, also in step without lanes, and the share of the turns in such a point; points of a sample,
each from its own first guess; only the turns of these. For scenes: by how much figures differ from those of the point
alone, and the numbers of evaluations.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from screwsim.batch import simulate_courses, tasks, together, warm_up
from screwsim.batch.tasks import IN_STEP
from screwsim.codegen.modules import for_speed
from screwsim.model.run import Machinery
from screwsim.model.side_by_side import TurnRequest
from screwsim.model.turn_scheduler import scheduler
from screwsim.scene import Scene, case, load
from screwsim.simulate import simulate, simulate_many
from screwsim.simulate import warm_up as alone
from screwsim.study.sweep.cases import LONG_BLOCK_CASES

PLAIN = Path(__file__).resolve().parent.parent / "tests" / "plain" / "r134a.yaml"
POINTS = 8 * LONG_BLOCK_CASES
TURNS = 64
COURSE = f"sweep.operation.condensing_temperature={{from: 30 degC, to: 60 degC, count: {POINTS}}}"
SAMPLE = (
    f"sweep.sample={{kind: sobol, count: {TURNS}, seed: 1, over: {{operation.speed: {{from: 1500 rpm, to: 4500 rpm}}, "
    "operation.condensing_temperature: {from: 35 degC, to: 60 degC}, oil_supply.ratio: {from: 0.5, to: 3}}}"
)


def seconds(work: Callable[[], object]) -> float:
    """Return the processor time of a call [s]."""
    began = time.process_time()
    work()
    return time.process_time() - began


def pairs(name: str, scene: Scene, count: int, block: int, repeats: int) -> None:
    """Measure the cases of a scene's sweep in courses of length `block`, one by one and side by side in turn."""
    scenes = [case(scene, k) for k in range(count)]
    courses = [scenes[first : first + block] for first in range(0, count, block)]
    alone(scenes[0])
    warm_up(scenes[0])
    found = []
    for _ in range(repeats):
        one = seconds(lambda: [list(simulate_many(course, trace=False)) for course in courses])
        step = seconds(lambda: in_step(courses))
        found.append((one / count, seconds(lambda: simulate_courses(courses)) / count, step / count))
    _print(name, [pair[:2] for pair in found])
    step, gain = (
        statistics.median(each) for each in zip(*((pair[2], pair[0] / pair[2]) for pair in found), strict=True)
    )
    print(f"  in step without lanes: {1e3 * step:.3f} ms; {gain:.2f} times as fast as one by one")


def in_step(courses: Sequence[Sequence[Scene]]) -> None:
    """Solve courses in step, each turn alone, as a sweep does without lanes."""
    together([partial(list, simulate_many(course, trace=False)) for course in courses], IN_STEP, lanes=False)


def _print(name: str, found: Sequence[tuple[float, float]]) -> None:
    one, many = (statistics.median(column) for column in zip(*found, strict=True))
    gain = statistics.median(a / b for a, b in found)
    print(f"{name}: {1e3 * one:.3f} ms one by one, {1e3 * many:.3f} ms side by side; {gain:.2f} times as fast")


@contextmanager
def clocked(spent: list[float]) -> Iterator[None]:
    """Sum the time of this process's turns [s], alone and side by side, their number, and the number of calls."""

    def timed(machinery: Machinery, y: Any, rtol: float, h: float) -> object:
        began = time.thread_time()
        found = machinery.own_turn(y, rtol, h)
        spent[:] = spent[0] + time.thread_time() - began, spent[1] + 1, spent[2] + 1
        return found

    def called(asked: Sequence[TurnRequest]) -> list[object]:
        began = time.thread_time()
        answers = kept(asked)
        spent[:] = spent[0] + time.thread_time() - began, spent[1] + len(asked), spent[2] + 1
        return answers

    kept = tasks._turns
    tasks._turns, scheduler.turn = called, timed
    try:
        yield
    finally:
        tasks._turns, scheduler.turn = kept, None


def parts(scene: Scene, repeats: int) -> None:
    """Print the share of the turns in a point of a course, one by one and side by side [us]."""
    scenes = [case(scene, k) for k in range(POINTS)]
    courses = [scenes[first : first + LONG_BLOCK_CASES] for first in range(0, POINTS, LONG_BLOCK_CASES)]
    ways: tuple[Callable[[], object], ...] = (
        lambda: [list(simulate_many(course, trace=False)) for course in courses],
        lambda: simulate_courses(courses),
    )
    found: list[list[tuple[float, ...]]] = [[], []]
    for _ in range(repeats):
        for rows, way in zip(found, ways, strict=True):
            spent = [0.0, 0.0, 0.0]
            with clocked(spent):
                whole = seconds(way)
            rows.append((1e6 * whole / POINTS, 1e6 * spent[0] / POINTS, spent[1] / POINTS, spent[1] / spent[2]))
    for rows, how in zip(found, ("one by one", "side by side"), strict=True):
        whole, within, count, filled = (statistics.median(column) for column in zip(*rows, strict=True))
        beside = f"{whole - within:.0f} us between them, {filled:.1f} turns a call"
        print(f"  {how}: {whole:.0f} us a point, {within:.0f} us in its {count:.2f} turns, {beside}")


def turns(scene: Scene, repeats: int) -> None:
    """Measure only the turns of cases: the part of a point inside the call."""
    scenes = [case(scene, k) for k in range(TURNS)]
    found = []
    for _ in range(repeats):
        one, many = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        with clocked(one):
            for each in scenes:
                list(simulate_many([each], trace=False))
        with clocked(many):
            simulate_courses([[each] for each in scenes])
        found.append((one[0] / one[1], many[0] / many[1]))
    _print("a turn", found)


def compare(file: str) -> None:
    """Print by how much figures of a scene side by side differ from those alone."""
    scene = load(file)
    scene = case(scene, 0) if scene.sweep else scene
    one, many = simulate(scene, trace=False), simulate_courses([[scene]])[0][0]
    figures = [(value, many.performance[name]) for name, value in one.performance.items() if value]
    largest = max((abs(other / value - 1.0) for value, other in figures if other is not None), default=0.0)
    counts = [result.numerics.rhs_evaluations for result in (one, many)]
    print(f"{file}: {one.status} and {many.status}, {largest:.1e} apart, {counts[0]} and {counts[1]} evaluations")


@for_speed()
def main() -> None:
    """Measure all, or compare scenes."""
    if len(sys.argv) > 1 and not sys.argv[1].isdigit():
        for file in sys.argv[1:]:
            compare(file)
        return
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    for errors in ("estimate", "none"):
        scene = load(str(PLAIN), [COURSE, f"numerics.error={errors}"])
        pairs(f"a point of a course, numerics.error: {errors}", scene, POINTS, LONG_BLOCK_CASES, repeats)
        parts(scene, repeats)
    sample = load(str(PLAIN), [SAMPLE])
    pairs("a point of a sample", sample, TURNS, 1, repeats)
    turns(sample, repeats)


if __name__ == "__main__":
    main()
