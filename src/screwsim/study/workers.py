"""Run chunks of blocks on worker processes, over the interface of concurrent.futures.

A pool of processes is the default; `screwsim.study.cluster` makes one of dask's workers.
"""

import gc
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from multiprocessing import connection
from typing import Any, Protocol

from screwsim.inputs.faults import UsageError
from screwsim.numerics.folder import handed_on, take_over

CHUNK_SECONDS = 1.0  # [s] what a crash may lose per worker; a part costs some ms
_FIRST = 1  # [blocks] of the chunks that tell how long cases take
LOST = "the scheduler, or its connection, was lost (start it again; the sweep resumes)"
DIED = "worker died (run this case alone, with `screwsim run --set …`)"
TICK = 0.25  # [s]
RARELY = 20_000, 20, 20  # objects, and rounds, after which a worker looks for garbage: a case leaves few hundred
GRACE = 1.0  # [s] in which a pool has to notice the death of a worker


class Pool(Protocol):
    """Where workers come from."""

    def executor(self, jobs: int) -> Executor:
        """Return an executor of so many workers at most."""
        ...

    def workers(self) -> int:
        """Return how many cases run at a time, at the moment."""
        ...


@dataclass(frozen=True)
class LocalPool:
    """Worker processes of this machine."""

    jobs: int

    def executor(self, jobs: int) -> Executor:
        """Return a pool of processes."""
        context = multiprocessing.get_context(start_method())
        return ProcessPoolExecutor(min(jobs, self.jobs), context, _start_worker, (handed_on(),))

    def workers(self) -> int:
        """Return the number of processes."""
        return self.jobs


def cores() -> int:
    """Return the number of cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


class Chunks:
    """Cut what is left to do into chunks of consecutive blocks that take about CHUNK_SECONDS.

    Of `beside` blocks at least, where they are simulated side by side, as long as all workers have some.
    """

    def __init__(self, todo: Iterable[range], longest: int, jobs: Callable[[], int], beside: int = 1) -> None:
        self._gaps = deque(blocks for blocks in todo if len(blocks))
        self._left = sum(map(len, self._gaps))
        self._jobs = jobs
        self._longest = longest
        self._beside = beside
        self._least = 0  # of a chunk: not known yet
        self._blocks = 0
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

    def give_back(self, blocks: range) -> None:
        """Put a chunk back, to be done next."""
        self._gaps.appendleft(blocks)
        self._left += len(blocks)

    def _size(self) -> int:
        if not self._least:
            self._least = min(self._beside, max(1, -(-self._left // self._jobs())))
        least = self._least
        if not self._blocks:
            return max(_FIRST, least)
        wanted = int(CHUNK_SECONDS * self._blocks / max(self._seconds, 1e-9))
        fair = -(-self._left // (4 * self._jobs()))  # the last chunks end together
        size = max(1, min(wanted, fair, self._longest))
        return max(least, size // self._beside * self._beside or size)

    def learn(self, blocks: int, seconds: float) -> None:
        """Take note of how long blocks took."""
        self._blocks += blocks
        self._seconds += seconds


def start_method() -> str:
    """Return how workers start.

    A fork takes milliseconds and inherits the compiled module; it is safe while this process has one thread, and
    it does not run the caller's main module again. With threads about, whose locks a fork would copy, and where
    there is no reliable fork (macOS, Windows), workers start afresh: a second or so each, compiled code from disk.
    """
    if sys.platform != "linux":
        return "spawn"
    return "fork" if threading.active_count() == 1 else "forkserver"


def _start_worker(known: tuple[str, set[str]]) -> None:
    """Leave Ctrl-C to the parent, and end with it: a pool's worker waits for ever when its parent is killed.

    What it inherits is no garbage, and is not looked through for it again and again. It shares its parent's cache.
    """
    take_over(known)
    gc.freeze()
    gc.set_threshold(*RARELY)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "SIGALRM"):
        signal.signal(signal.SIGALRM, signal.SIG_DFL)  # it ends a case that hangs
    threading.Thread(target=end_with_parent, daemon=True).start()


def end_with_parent() -> None:
    """Wait for the end of the process that started this one, and end this one then."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def stop(executor: Executor) -> None:
    """Give up an executor at once: what it still does is not wanted any more."""
    processes, results = dict(getattr(executor, "_processes", None) or {}), getattr(executor, "_result_queue", None)
    if processes:
        executor.shutdown(wait=False, cancel_futures=True)
        _kill(processes.values(), results)  # they hold nothing: only this process writes files
        return
    try:  # dask's knows no `cancel_futures`: it cancels them in any case
        executor.shutdown(wait=False)
    except Exception as error:  # by its name, as below: of a lost scheduler there is nothing to cancel
        if type(error).__name__ != "ClosedClientError":
            raise


def _kill(processes: Iterable[Any], results: Any) -> None:
    """Kill the processes of a pool, and close the last end of what they send: the rest of half a message never comes.

    The pool would wait for it for ever, and this process at its end for the pool.
    """
    for process in processes:
        process.kill()
    results._writer.close()


class Guard:
    """Breaks a pool of processes that does not notice the death of a worker.

    One that is killed while it sends a result leaves half a message, for whose rest the pool waits for ever.
    """

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._died: float | None = None

    def look(self) -> None:
        """Look after the pool, some times a second."""
        processes = list((getattr(self._executor, "_processes", None) or {}).values())
        if not processes or not connection.wait([process.sentinel for process in processes], 0.0):
            self._died = None
        elif self._died is None:
            self._died = time.monotonic()
        elif time.monotonic() - self._died >= GRACE:
            _kill(processes, self._executor._result_queue)  # type: ignore[attr-defined]


@dataclass(frozen=True)
class Work:
    """What to do with chunks: `task(payload(blocks))` runs in a worker, the others are called in this process."""

    pool: Pool
    task: Callable[[Any], Any]
    payload: Callable[[range], Any]
    finish: Callable[[range, Any], None]  # with the task's result
    tick: Callable[[], None]


@dataclass(frozen=True)
class Lost:
    """A chunk that was in flight, for so many seconds, when a worker died."""

    blocks: range
    seconds: float


def drain(chunks: Chunks, work: Work) -> list[Lost]:
    """Run chunks, two a worker, until none is left or a worker dies; return those in flight at its death."""
    executor = work.pool.executor(work.pool.workers())
    guard = Guard(executor)
    running: dict[Future[Any], tuple[range, float]] = {}
    lost: list[Lost] = []
    try:
        while True:
            flying = 2 * work.pool.workers()
            while not lost and len(running) < flying and (blocks := chunks.take()) is not None:
                future = submit(executor, work.task, work.payload(blocks))
                running[future] = blocks, time.monotonic()
            if not running:
                break
            done, _ = wait(running, TICK, FIRST_COMPLETED)
            for future in done:
                blocks, began = running.pop(future)
                if worker_died(future):
                    lost.append(Lost(blocks, time.monotonic() - began))
                else:
                    work.finish(blocks, future.result())
            guard.look()
            work.tick()
    finally:  # after Ctrl-C or on a full disk workers must not go on; when all is done they hold nothing
        stop(executor)
    return lost


def submit(executor: Executor, task: Callable[[Any], Any], payload: Any) -> Future[Any]:
    """Return the future of a task; where the executor is broken already, one that tells it."""
    try:
        with warnings.catch_warnings():
            # Python 3.12 warns when it forks beside any thread; numerical libraries keep idle ones that survive it
            warnings.filterwarnings("ignore", ".*fork", DeprecationWarning)
            return executor.submit(task, payload)
    except BrokenExecutor as error:
        broken: Future[Any] = Future()
        broken.set_exception(error)
        return broken


def worker_died(future: Future[Any]) -> bool:
    """Tell whether a worker died over a task; raise UsageError when the whole cluster is gone."""
    if future.cancelled():
        raise UsageError(LOST)
    error = future.exception()
    # dask's own error is known by its name: dask need not be installed
    return isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker"


def sent(work: Any) -> bytes:
    """Return work as workers receive it; raise UsageError where a function in it belongs to no module."""
    try:
        return pickle.dumps(work)
    except (AttributeError, TypeError, pickle.PicklingError) as reason:
        raise UsageError(
            f"simulate: it cannot be sent to workers: {reason} (define it at the top of a module, or pass jobs=1)"
        ) from None
