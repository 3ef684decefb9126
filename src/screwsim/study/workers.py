"""Run chunks of cases in worker processes, and find the case that kills its worker.

Any executor with the interface of concurrent.futures serves; a pool of processes is the default.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import warnings
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from typing import Any

CHUNK_SECONDS = 1.0  # [s] what a crash may lose per worker; a part costs some ms
CHUNK_CASES = 256  # bounds the memory of a chunk with traces
_TICK = 0.25  # [s]

MakePool = Callable[[int], Executor]
Task = Callable[[int, int], Any]


class Chunks:
    """Cut what is left to do into chunks of consecutive cases that take about CHUNK_SECONDS."""

    def __init__(self, todo: Iterable[range], jobs: int, longest: int = CHUNK_CASES) -> None:
        self._gaps = deque(cases for cases in todo if len(cases))
        self._left = sum(map(len, self._gaps))
        self._jobs = jobs
        self._longest = longest
        self._cases = 0
        self._seconds = 0.0

    def take(self) -> range | None:
        """Return the next chunk; None when nothing is left."""
        if not self._gaps:
            return None
        first = self._gaps.popleft()
        size = min(self._size(), len(first))
        if size < len(first):
            self._gaps.appendleft(first[size:])
        self._left -= size
        return first[:size]

    def _size(self) -> int:
        if not self._seconds:
            return 1 if not self._cases else self._longest
        wanted = int(CHUNK_SECONDS * self._cases / self._seconds)
        fair = -(-self._left // (4 * self._jobs))  # the last chunks end together
        return max(1, min(wanted, fair, self._longest))

    def learn(self, cases: int, seconds: float) -> None:
        """Take note of how long cases took."""
        self._cases += cases
        self._seconds += seconds


def process_pool(jobs: int) -> Executor:
    """Return a pool of worker processes."""
    context = multiprocessing.get_context(start_method())
    return ProcessPoolExecutor(jobs, context, _start_worker)


def start_method() -> str:
    """Return how workers start.

    A fork takes milliseconds and inherits the compiled module; it is safe while this process has one thread, and
    it does not run the caller's main module again. With threads about, whose locks a fork would copy, and where
    there is no reliable fork (macOS, Windows), workers start afresh: a second or so each, compiled code from disk.
    """
    if sys.platform != "linux":
        return "spawn"
    return "fork" if threading.active_count() == 1 else "forkserver"


def _start_worker() -> None:
    """Leave Ctrl-C to the parent, and end with it: a pool's worker waits for ever when its parent is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def stop(pool: Executor) -> None:
    """Give up a pool at once: what it still does is not wanted any more."""
    processes = dict(getattr(pool, "_processes", None) or {})
    pool.shutdown(wait=False, cancel_futures=True)
    for process in processes.values():
        process.kill()  # it holds nothing: only this process writes files


@dataclass(frozen=True)
class Work:
    """What to do with chunks: `task(start, stop)` runs in a worker, the others are called in this process."""

    make_pool: MakePool
    task: Task
    finish: Callable[[range, Any], None]  # with the task's result
    dead: Callable[[int], None]  # for a case that kills its worker
    tick: Callable[[], None]


def settle(chunks: Chunks, jobs: int, work: Work, flying: int | None = None) -> None:
    """Run all chunks, at most `flying` in flight (default: two a worker).

    When a worker dies, nobody knows which of the chunks in flight was its. They are run again case by case on
    all workers, and those in flight at the next death one at a time: then the case is certain.
    """
    flying = flying or 2 * jobs
    if flying == 1:
        _probe(work.make_pool(1))
    while lost := _drain(chunks, flying, work, work.make_pool(jobs)):
        if flying == 1:
            work.dead(lost[0].start)
            continue
        again = 1 if all(len(cases) == 1 for cases in lost) else jobs
        single = [range(case, case + 1) for cases in sorted(lost, key=lambda cases: cases.start) for case in cases]
        settle(Chunks(single, again, 1), again, work, again)


def _probe(pool: Executor) -> None:
    """Raise RuntimeError when workers die without any case: no case is to blame then."""
    try:
        pool.submit(os.getpid).result()
    except BrokenExecutor as error:
        raise RuntimeError("worker processes cannot start (use one job: --jobs 1)") from error
    finally:
        pool.shutdown()


def _drain(chunks: Chunks, flying: int, work: Work, pool: Executor) -> list[range]:
    """Run chunks, `flying` at a time, until none is left or a worker dies; return those in flight at its death."""
    running: dict[Future[Any], range] = {}
    lost: list[range] = []
    try:
        while True:
            while not lost and len(running) < flying and (cases := chunks.take()) is not None:
                _submit(pool, work.task, cases, running, lost)
            if not running:
                break
            done, _ = wait(running, _TICK, FIRST_COMPLETED)
            for future in done:
                cases = running.pop(future)
                if _worker_died(future.exception()):
                    lost.append(cases)
                else:
                    work.finish(cases, future.result())
            work.tick()
    except BaseException:  # Ctrl-C or a full disk: workers must not go on
        stop(pool)
        raise
    pool.shutdown()
    return lost


def _submit(pool: Executor, task: Task, cases: range, running: dict[Future[Any], range], lost: list[range]) -> None:
    try:
        with warnings.catch_warnings():
            # Python 3.12 warns when it forks beside any thread; numerical libraries keep idle ones that survive it
            warnings.filterwarnings("ignore", ".*fork", DeprecationWarning)
            running[pool.submit(task, cases.start, cases.stop)] = cases
    except BrokenExecutor:
        lost.append(cases)


def _worker_died(error: BaseException | None) -> bool:
    # dask's own error is known by its name: dask need not be installed
    return isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker"
