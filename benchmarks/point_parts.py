"""Print where the time of a point goes, alone and in a row, with and without error estimates, by parts and calls.

Run: python benchmarks/point_parts.py [ROUNDS]. Parts are sampled by the process's own processor clock, each including
all that it calls, so that some rows are contained in others. Compiled functions are timed call by call, in a separate
round. All values are in µs of processor time per point, of the paper's machine and of R134a at 3000 rpm, from some
hundred samples.
"""

from __future__ import annotations

import signal
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import numpy as np

from screwsim.codegen.calls import Variant
from screwsim.codegen.modules import Function, for_speed
from screwsim.scene import Scene, load, with_values
from screwsim.simulate import simulate, simulate_many

ROOT = Path(__file__).resolve().parent.parent
POINTS = 60
TICK = 1e-3  # [s] of processor time between samples, as far as the system resolves it
SERIES = {
    "paper": (ROOT / "configs" / "paper" / "point.yaml", "oil_supply.ratio", np.linspace(0.5, 8.0, POINTS)),
    "R134a": (
        ROOT / "tests" / "plain" / "r134a.yaml",
        "operation.condensing_temperature",
        273.15 + np.linspace(30.0, 60.0, POINTS),
    ),
}
PARTS = {  # functions, by file, and their part in a point
    "problem.py:problem_of": "scene to problem",
    "guess.py:continued": "guess from the cycles before",
    "guess.py:begin": "first guess",
    "run.py:own_turn": "turns: compiled, and the call",
    "relaxation.py:integrate": "turns that close, what they changed",
    "relaxation.py:go_on": "mixing for the next turn",
    "relaxation.py:ended": "copy of the closed cycle",
    "accurately.py:_close_somehow": "closing, with its guess",
    "estimate.py:estimated_errors": "estimate, figures of both lives",
    "evaluation.py:read": "figures",
    "total.py:ledger": "ledger, for the entropy balance",
    "cautions.py:doubts": "doubts",
    "cautions.py:warnings": "warnings",
    "accurately.py:note": "note for the next point",
    "modules.py:__call__": "calls of compiled functions",
}


def scenes(name: str, errors: str) -> list[Scene]:
    """Return the points of a series."""
    path, axis, values = SERIES[name]
    base = load(str(path), ["operation.speed=3000 rpm", f"numerics.error={errors}"])
    return [with_values(base, {axis: float(value)}) for value in values]


@contextmanager
def sampled(found: Counter[str]) -> Iterator[None]:
    """Count in which functions the process is, with their callers, at ticks of its processor time."""

    def look(_signal: int, frame: FrameType | None) -> None:
        seen = {""}
        while frame is not None:
            seen.add(f"{Path(frame.f_code.co_filename).name}:{frame.f_code.co_name}")
            frame = frame.f_back
        found.update(seen)

    before = signal.signal(signal.SIGPROF, look)
    signal.setitimer(signal.ITIMER_PROF, TICK, TICK)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@contextmanager
def timed(spent: Counter[str], calls: Counter[str]) -> Iterator[None]:
    """Time the calls of compiled functions [s], by name."""
    by_name, by_words = Function.__call__, Variant.__call__
    now = [""]

    def named(self: Function, *arguments: object) -> object:
        now[0] = self._name
        return by_name(self, *arguments)

    def clocked(self: Variant, words: object) -> object:
        name, began = now[0], time.thread_time()
        answer = by_words(self, words)  # type: ignore[arg-type]
        spent[name] += time.thread_time() - began  # type: ignore[assignment]
        calls[name] += 1
        return answer

    Function.__call__, Variant.__call__ = named, clocked  # type: ignore[method-assign]
    try:
        yield
    finally:
        Function.__call__, Variant.__call__ = by_name, by_words  # type: ignore[method-assign]


def tell(name: str, work: Callable[[], object], rounds: int) -> None:
    """Print the parts of work on all points."""
    work()
    parts: Counter[str] = Counter()
    began = time.process_time()
    with sampled(parts):
        for _ in range(rounds):
            work()
    point = 1e6 * (time.process_time() - began) / (rounds * POINTS)
    print(f"\n{name}: {point:.0f} µs a point")
    for part, what in PARTS.items():
        if parts[part]:
            print(f"{point * parts[part] / parts['']:>8.0f}  {what}")
    spent: Counter[str] = Counter()
    calls: Counter[str] = Counter()
    with timed(spent, calls):
        work()
    print(f"compiled: {1e6 * sum(spent.values()) / POINTS:.0f} µs in {sum(calls.values()) / POINTS:.1f} calls a point")
    for each, seconds in spent.most_common(8):
        print(f"{1e6 * seconds / POINTS:>8.1f}  {each} ({calls[each] / POINTS:.2f} calls)")


@for_speed()
def main() -> None:
    """Print all parts."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    for name in SERIES:
        for errors in ("estimate", "none"):
            points = scenes(name, errors)
            tell(f"{name} in a row, {errors}", lambda: list(simulate_many(points, trace=False)), rounds)  # noqa: B023
            tell(f"{name} alone, {errors}", lambda: [simulate(each, trace=False) for each in points], rounds)  # noqa: B023


if __name__ == "__main__":
    main()
