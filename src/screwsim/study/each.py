"""Call a function for every number of a range on all cores: for studies whose answers fit into memory."""

import pickle
import time
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any, TypeVar

from screwsim.study.progress import Progress, Silent
from screwsim.study.workers import Chunks, LocalPool, Work, cores, drain

Answer = TypeVar("Answer")
Finish = Callable[[range, tuple[list[Any], float]], None]


def each(
    function: Callable[[int], Answer],
    count: int,
    *,
    died: Callable[[int], Answer],
    jobs: int | None = None,
    failed: Callable[[Answer], bool] = lambda answer: False,
    progress: Progress | None = None,
    answers: dict[int, Answer] | None = None,
) -> list[Answer]:
    """Return [function(0), …, function(count - 1)], computed by `jobs` workers (default: all cores; 1: here).

    The function is pickled once. `died` gives the answer for a number whose worker died; `failed` tells which answers
    the progress counts as such. What an interruption leaves is in `answers`.
    """
    progress, jobs = progress or Silent(), min(jobs or cores(), count)
    answers = {} if answers is None else answers

    chunks = Chunks([range(count)], count, lambda: jobs)

    def finish(numbers: range, outcome: tuple[list[Answer], float]) -> None:
        found, seconds = outcome
        chunks.learn(len(numbers), seconds)
        answers.update(zip(numbers, found, strict=True))
        progress.advance(len(found), sum(map(failed, found)))

    progress.start(count, 0)
    try:
        if jobs <= 1:
            for number in range(count):
                finish(range(number, number + 1), ([function(number)], 0.0))
        else:
            _on_workers(pickle.dumps(function), chunks, jobs, finish, died, progress.tick)
    finally:
        progress.stop()
    return [answers[number] for number in range(count)]


def _on_workers(
    function: bytes, chunks: Chunks, jobs: int, finish: Finish, died: Callable[[int], Any], tick: Callable[[], None]
) -> None:
    """Run chunks on workers; what was lost when one died is run number by number, each on a worker of its own."""
    work = Work(LocalPool(jobs), partial(_answers, function), lambda numbers: numbers, finish, tick)
    while lost := drain(chunks, work):
        for number in sorted(number for chunk in lost for number in chunk.blocks):
            alone = range(number, number + 1)
            if drain(Chunks([alone], 1, lambda: 1), replace(work, pool=LocalPool(1))):
                finish(alone, ([died(number)], 0.0))


def _answers(function: bytes, numbers: range) -> tuple[list[Any], float]:
    """Return the answers for numbers, and the time that they took [s]."""
    began, call = time.perf_counter(), _unpacked(function)
    return [call(number) for number in numbers], time.perf_counter() - began


_unpacked = lru_cache(maxsize=1)(pickle.loads)
