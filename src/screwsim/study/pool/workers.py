"""Run chunks of blocks on worker processes, through the interface of concurrent.futures.

The default is a pool of local processes; `screwsim.study.sweep.cluster` provides dask's workers.
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
from screwsim.numerics.folder import adopt_worker_state, worker_state

CHUNK_SECONDS = 1.0  # [s] of work that a crash may cost per worker; writing a part costs some ms
SCHEDULER_LOST = "the scheduler, or its connection, was lost (start it again; the sweep resumes)"
WORKER_DIED = "worker died (run this case alone, with `screwsim run --set …`)"
POLL_INTERVAL = 0.25  # [s] between two looks at the workers
GARBAGE_THRESHOLDS = 20_000, 20, 20  # thresholds of a worker's garbage collector: a case leaves a few hundred objects
DEATH_GRACE = 1.0  # [s] that a pool has to notice the death of a worker


class Pool(Protocol):
    """Source of workers."""

    def executor(self, jobs: int) -> Executor:
        """Return an executor of at most so many workers."""
        ...

    def workers(self) -> int:
        """Return how many cases can run at the same time, at the moment."""
        ...


@dataclass(frozen=True)
class LocalPool:
    """Worker processes of this machine."""

    jobs: int

    def executor(self, jobs: int) -> Executor:
        """Return a pool of processes."""
        context = multiprocessing.get_context(start_method())
        return ProcessPoolExecutor(min(jobs, self.jobs), context, _start_worker, (worker_state(),))

    def workers(self) -> int:
        """Return the number of processes."""
        return self.jobs


def cores() -> int:
    """Return the number of cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


class Chunks:
    """Cut the remaining work into chunks of consecutive blocks that take about CHUNK_SECONDS each.

    Where blocks are simulated side by side, a chunk has at least `beside` of them, as long as there are enough for all.
    """

    def __init__(self, todo: Iterable[range], longest: int, jobs: Callable[[], int], beside: int = 1) -> None:
        self._gaps = deque(blocks for blocks in todo if len(blocks))
        self._left = sum(map(len, self._gaps))
        self._jobs = jobs
        self._longest = longest
        self._beside = beside
        self._least = 0  # blocks per chunk; not known yet
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
        """Put a chunk back, to be run next."""
        self._gaps.appendleft(blocks)
        self._left += len(blocks)

    def _size(self) -> int:
        if not self._least:
            self._least = min(self._beside, max(1, -(-self._left // self._jobs())))
        least = self._least
        if not self._blocks:
            return least  # until the time per case is known
        wanted = int(CHUNK_SECONDS * self._blocks / max(self._seconds, 1e-9))
        fair = -(-self._left // (4 * self._jobs()))  # the last chunks end together
        size = max(1, min(wanted, fair, self._longest))
        return max(least, size // self._beside * self._beside or size)

    def learn(self, blocks: int, seconds: float) -> None:
        """Record how long blocks took."""
        self._blocks += blocks
        self._seconds += seconds


def start_method() -> str:
    """Return the start method of workers.

    A fork takes milliseconds and inherits the compiled module; it is safe while this process has one thread, and does
    not run the caller's main module again. With several threads, whose locks a fork would copy, and on systems without
    a reliable fork (macOS, Windows), workers start afresh: about a second each, with compiled code read from disk.
    """
    if sys.platform != "linux":
        return "spawn"
    return "fork" if threading.active_count() == 1 else "forkserver"


def _start_worker(known: tuple[str, set[str]]) -> None:
    """Leave Ctrl-C to the parent and end with it: a worker of a pool waits for ever when its parent is killed.

    Objects inherited from the parent are exempt from garbage collection. The worker shares its parent's cache.
    """
    adopt_worker_state(known)
    gc.freeze()
    gc.set_threshold(*GARBAGE_THRESHOLDS)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if hasattr(signal, "SIGALRM"):
        signal.signal(signal.SIGALRM, signal.SIG_DFL)  # it ends a case that hangs
    threading.Thread(target=end_with_parent, daemon=True).start()


def end_with_parent() -> None:
    """Wait for the parent process to end, and end this one then."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def stop_executor(executor: Executor) -> None:
    """Stop an executor at once: its unfinished work is no longer wanted.

    The thread that manages its processes ends with it. If it were still ending at the end of this process, Python would
    wake it through a pipe that it has closed, and print a traceback. New workers would not be forked beside it
    (`start_method`).
    """
    processes, results = dict(getattr(executor, "_processes", None) or {}), getattr(executor, "_result_queue", None)
    thread = getattr(executor, "_executor_manager_thread", None)
    if processes:
        executor.shutdown(wait=False, cancel_futures=True)
        _kill(processes.values(), results)  # they hold nothing: only this process writes files
        if thread is not None:
            thread.join(DEATH_GRACE)
        return
    try:  # dask's executor has no `cancel_futures`: it cancels them in any case
        executor.shutdown(wait=False)
    except Exception as error:  # known by its name, as below: with a lost scheduler there is nothing to cancel
        if type(error).__name__ != "ClosedClientError":
            raise


def _kill(processes: Iterable[Any], results: Any) -> None:
    """Kill the processes of a pool and close the writing end of its result queue: a truncated message stays so.

    Otherwise the pool would wait for its rest for ever, and this process at its end for the pool.
    """
    for process in processes:
        process.kill()
    results._writer.close()


class DeathGuard:
    """Breaks a pool of processes that does not notice the death of a worker.

    A worker killed while it sends a result leaves half a message, and the pool would wait for the rest for ever.
    """

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._died: float | None = None

    def look(self) -> None:
        """Check the pool, to be called several times a second."""
        processes = list((getattr(self._executor, "_processes", None) or {}).values())
        if not processes or not connection.wait([process.sentinel for process in processes], 0.0):
            self._died = None
        elif self._died is None:
            self._died = time.monotonic()
        elif time.monotonic() - self._died >= DEATH_GRACE:
            _kill(processes, self._executor._result_queue)  # type: ignore[attr-defined]


@dataclass(frozen=True)
class ChunkWork:
    """Processing of chunks: `task(payload(blocks))` runs in a worker, the other functions in this process."""

    pool: Pool
    task: Callable[[Any], Any]
    payload: Callable[[range], Any]
    finish: Callable[[range, Any], None]  # with the task's result
    tick: Callable[[], None]


@dataclass(frozen=True)
class LostChunk:
    """A chunk that was running, for so many seconds, when a worker died."""

    blocks: range
    seconds: float


def drain(chunks: Chunks, work: ChunkWork, lent: Executor | None = None) -> list[LostChunk]:
    """Run chunks, two per worker, until none is left or a worker dies; return those running at its death.

    The workers are started and stopped here, unless an executor is lent.
    """
    executor = work.pool.executor(work.pool.workers()) if lent is None else lent
    guard = DeathGuard(executor)
    running: dict[Future[Any], tuple[range, float]] = {}
    lost: list[LostChunk] = []
    try:
        while True:
            flying = 2 * work.pool.workers()
            while not lost and len(running) < flying and (blocks := chunks.take()) is not None:
                future = submit(executor, work.task, work.payload(blocks))
                running[future] = blocks, time.monotonic()
            if not running:
                break
            done, _ = wait(running, POLL_INTERVAL, FIRST_COMPLETED)
            for future in done:
                blocks, began = running.pop(future)
                if worker_died(future):
                    lost.append(LostChunk(blocks, time.monotonic() - began))
                else:
                    work.finish(blocks, future.result())
            guard.look()
            work.tick()
    finally:  # after Ctrl-C or on a full disk workers must not go on; when all is done they hold nothing
        if lent is None:
            stop_executor(executor)
    return lost


def submit(executor: Executor, task: Callable[[Any], Any], payload: Any) -> Future[Any]:
    """Return the future of a task; where the executor is already broken, one that holds the error."""
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
    """Return whether a worker died over a task; raise UsageError when the whole cluster is gone."""
    if future.cancelled():
        raise UsageError(SCHEDULER_LOST)
    error = future.exception()
    # dask's own error is known by its name: dask need not be installed
    return isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker"


def pickled_work(work: Any) -> bytes:
    """Return work pickled for workers; raise UsageError where a function in it belongs to no module."""
    try:
        return pickle.dumps(work)
    except (AttributeError, TypeError, pickle.PicklingError) as reason:
        what = f"it cannot be sent to workers: {reason}"
        raise UsageError(f"simulate: {what} (define it at module level, or pass jobs=1)") from None
