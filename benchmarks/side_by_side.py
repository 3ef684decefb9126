"""Print what points side by side in the lanes of a core gain over one by one, in processor time of interleaved pairs.

Run: python benchmarks/side_by_side.py [PAIRS | SCENE.yaml …]. Courses of R134a over the condensing temperature, with
errors estimated or not; points of a sample, each from its own first guess; the turns of these alone. Of scenes: by how
much their figures differ from those of the point alone, and their evaluations.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from screwsim.batch import simulate_courses, warm_up
from screwsim.codegen.modules import for_speed
from screwsim.model.exchange import here
from screwsim.model.run import Machinery
from screwsim.scene import Scene, case, load
from screwsim.simulate import simulate, simulate_many
from screwsim.simulate import warm_up as alone
from screwsim.study.blocks import LONG_BLOCK

PLAIN = Path(__file__).resolve().parent.parent / "tests" / "plain" / "r134a.yaml"
POINTS = 8 * LONG_BLOCK
TURNS = 64
COURSE = f"sweep.operation.condensing_temperature={{from: 30 degC, to: 60 degC, count: {POINTS}}}"
SAMPLE = (
    f"sweep.sample={{kind: sobol, count: {TURNS}, seed: 1, over: {{operation.speed: {{from: 1500 rpm, to: 4500 rpm}}, "
    "operation.condensing_temperature: {from: 35 degC, to: 60 degC}, oil_supply.ratio: {from: 0.5, to: 3}}}"
)


def seconds(work: Callable[[], object]) -> float:
    """Return the processor time of something [s]."""
    began = time.process_time()
    work()
    return time.process_time() - began


def pairs(name: str, scene: Scene, count: int, block: int, repeats: int) -> None:
    """Measure the cases of a scene's sweep in courses of so many, one by one and side by side in turn."""
    scenes = [case(scene, k) for k in range(count)]
    courses = [scenes[first : first + block] for first in range(0, count, block)]
    alone(scenes[0])
    warm_up(scenes[0])
    found = []
    for _ in range(repeats):
        one = seconds(lambda: [list(simulate_many(course, trace=False)) for course in courses])
        found.append((one / count, seconds(lambda: simulate_courses(courses)) / count))
    _print(name, found)


def _print(name: str, found: Sequence[tuple[float, float]]) -> None:
    one, many = (statistics.median(column) for column in zip(*found, strict=True))
    gain = statistics.median(a / b for a, b in found)
    print(f"{name}: {1e3 * one:.3f} ms one by one, {1e3 * many:.3f} ms side by side; {gain:.2f} times as fast")


def turns(scene: Scene, repeats: int) -> None:
    """Measure the turns of cases alone: what of a point is in the call."""
    scenes = [case(scene, k) for k in range(TURNS)]
    spent = [0.0, 0]

    def timed(machinery: Machinery, y: object, rtol: float, h: float) -> object:
        began = time.thread_time()
        found = machinery.own_turn(y, rtol, h)  # type: ignore[arg-type]
        spent[0], spent[1] = spent[0] + time.thread_time() - began, spent[1] + 1
        return found

    from screwsim.batch import tasks

    found, kept = [], tasks._turns
    for _ in range(repeats):
        spent[:], here.turn = [0.0, 0], timed
        for one in scenes:
            list(simulate_many([one], trace=False))
        here.turn, single = None, spent[0] / spent[1]
        spent[:] = [0.0, 0]

        def called(asked: Sequence[object]) -> list[object]:
            began = time.thread_time()
            answers = kept(asked)  # type: ignore[arg-type]
            spent[0], spent[1] = spent[0] + time.thread_time() - began, spent[1] + len(asked)
            return answers

        tasks._turns = called  # type: ignore[assignment]
        simulate_courses([[one] for one in scenes])
        tasks._turns = kept
        found.append((single, spent[0] / spent[1]))
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
    """Measure them all, or compare scenes."""
    if len(sys.argv) > 1 and not sys.argv[1].isdigit():
        for file in sys.argv[1:]:
            compare(file)
        return
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    for errors in ("estimate", "none"):
        scene = load(str(PLAIN), [COURSE, f"numerics.error={errors}"])
        pairs(f"a point of a course, numerics.error: {errors}", scene, POINTS, LONG_BLOCK, repeats)
    sample = load(str(PLAIN), [SAMPLE])
    pairs("a point of a sample", sample, TURNS, 1, repeats)
    turns(sample, repeats)


if __name__ == "__main__":
    main()
