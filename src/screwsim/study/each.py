"""Call a function for every number of a range on all cores: for studies whose answers fit into memory."""

from __future__ import annotations

import pickle
import warnings
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from functools import lru_cache
from typing import Any, TypeVar

from screwsim.study.progress import Progress, Silent
from screwsim.study.workers import Guard, LocalPool, cores, stop

Answer = TypeVar("Answer")
DIED = "worker died (run this case alone, with `screwsim run --set …`)"
_TICK = 0.25  # [s]
_CHUNKS = 16  # a worker, so that they end together


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

    def finish(numbers: range, found: list[Answer]) -> None:
        answers.update(zip(numbers, found, strict=True))
        progress.advance(len(found), sum(map(failed, found)))

    progress.start(count, 0)
    try:
        if jobs <= 1:
            for number in range(count):
                finish(range(number, number + 1), [function(number)])
        else:
            _on_workers(pickle.dumps(function), _chunks(count, jobs), jobs, finish, died, progress)
    finally:
        progress.stop()
    return [answers[number] for number in range(count)]


def _chunks(count: int, jobs: int) -> list[range]:
    size = max(1, count // (_CHUNKS * jobs))
    return [range(start, min(start + size, count)) for start in range(0, count, size)]


def _on_workers(
    function: bytes,
    chunks: list[range],
    jobs: int,
    finish: Callable[[range, list[Any]], None],
    died: Callable[[int], Any],
    progress: Progress,
) -> None:
    """Run chunks on workers; what was lost when one died is run number by number, each on a worker of its own."""
    lost = _run(function, chunks, LocalPool(jobs).executor(jobs), finish, progress)
    for number in (number for chunk in lost for number in chunk):
        alone = range(number, number + 1)
        if _run(function, [alone], LocalPool(1).executor(1), finish, progress):
            finish(alone, [died(number)])


def _run(
    function: bytes,
    chunks: list[range],
    pool: Executor,
    finish: Callable[[range, list[Any]], None],
    progress: Progress,
) -> list[range]:
    """Run chunks on a pool; return those that were not done when a worker died, none when none did."""
    guard = Guard(pool)
    running: dict[Future[list[Any]], range] = {}
    lost: list[range] = []
    try:
        with warnings.catch_warnings():
            # Python 3.12 warns when it forks beside any thread; numerical libraries keep idle ones that survive it
            warnings.filterwarnings("ignore", ".*fork", DeprecationWarning)
            running = {pool.submit(_answers, function, chunk): chunk for chunk in chunks}
        while running:
            done, _ = wait(running, _TICK, FIRST_COMPLETED)
            for future in done:
                chunk = running.pop(future)
                if isinstance(future.exception(), BrokenExecutor):
                    lost.append(chunk)
                else:
                    finish(chunk, future.result())
            guard.look()
            progress.tick()
    except BaseException:  # Ctrl-C: workers must not go on
        stop(pool)
        raise
    pool.shutdown()
    return sorted(lost, key=lambda chunk: chunk.start)


def _answers(function: bytes, numbers: range) -> list[Any]:
    call = _unpacked(function)
    return [call(number) for number in numbers]


@lru_cache(maxsize=1)
def _unpacked(function: bytes) -> Callable[[int], Any]:
    return pickle.loads(function)
