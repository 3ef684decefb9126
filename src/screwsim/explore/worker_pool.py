"""Worker processes that solve for pages; one that hangs, dies or grows too large is killed and replaced."""

import asyncio
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import forkserver
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from screwsim.explore import answer
from screwsim.explore.changes import SceneArguments
from screwsim.explore.worker import DONE, NOTE, Job, serve_jobs
from screwsim.numerics.folder import worker_state

POLL_INTERVAL = 0.05  # [s] between two checks of a busy worker
LARGEST_WORKER = 1 << 30  # [byte] size above which a worker is restarted


@dataclass(frozen=True)
class Timeouts:
    """How long [s] a page waits: for an answer, for one with a newer request behind it, for compilation."""

    alone: float = 60.0
    behind: float = 5.0
    compiling: float = 180.0


class NoAnswer(Exception):
    """Reason why a worker gave no answer."""


def _context() -> Any:
    """Return the way in which workers are started: on Linux by a server that forks them, with all imported."""
    if sys.platform != "linux":
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["screwsim.explore.worker"])
    return context


def start_fork_server() -> None:
    """Start the process from which workers are forked, on Linux; called in the main thread.

    It ignores Ctrl-C from its first line on, also while it imports: a terminal sends that to all processes, and this
    one's answer to it ends them.
    """
    if sys.platform != "linux":
        return
    _context()
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        forkserver.ensure_running()
    finally:
        signal.signal(signal.SIGINT, before)


@dataclass
class Worker:
    """One process and its pipe; `compiling` is true while it reports a compilation."""

    base: SceneArguments
    patience: Timeouts
    process: Any = None
    pipe: Connection | None = None
    compiling: bool = False

    def start(self) -> None:
        """Start the process; it prepares itself in the meantime."""
        context = _context()
        mine, its = context.Pipe()
        base = self.base
        arguments = (its, base.file, base.overrides, worker_state())
        self.process = context.Process(target=serve_jobs, args=arguments, daemon=True)
        self.process.start()
        its.close()
        self.pipe, self.compiling = mine, False

    def stop(self) -> None:
        """Kill the process."""
        if self.process is not None:
            self.process.kill()
            self.process.join()
            self.process = None
        if self.pipe is not None:
            self.pipe.close()
            self.pipe = None

    def solve(self, job: Job, newer: Callable[[], bool], note: Callable[[str], None]) -> bytes:
        """Return the answer to a job, called in a separate thread; a worker that gives none is stopped and reported.

        A worker reads the scene's files with each job: where one has changed, its answer is no answer to the page.
        """
        try:
            found = self._answer(job, newer, note)
            changed = self.base.changed()
            return answer.refused_answer(changed, job.tag) if changed else found
        except NoAnswer as error:
            self.stop()
            return answer.refused_answer(str(error), job.tag)
        except (EOFError, OSError):
            how = _how_it_ended(self.process)
            self.stop()
            return answer.refused_answer(f"the process that solved this died {how}; another takes its place", job.tag)

    def _answer(self, job: Job, newer: Callable[[], bool], note: Callable[[str], None]) -> bytes:
        if self.process is None:
            self.start()
        assert self.pipe is not None
        self.pipe.send(job)
        began, compiled = time.monotonic(), 0.0
        last = began
        while True:
            if self.pipe.poll(POLL_INTERVAL):
                kind, content = self.pipe.recv()
                if kind == DONE:
                    return content
                if kind == NOTE:
                    self.compiling = content.startswith("compiling")
                    note(content)
            now = time.monotonic()
            compiled += now - last if self.compiling else 0.0
            last = now
            solving, most = now - began - compiled, self.patience.behind if newer() else self.patience.alone
            if solving > most or compiled > self.patience.compiling:
                what = "compilation" if compiled > self.patience.compiling else "solution"
                seconds = max(solving, compiled)
                raise NoAnswer(f"the {what} was stopped after {seconds:.0f} s (change the settings, or undo)")

    def too_large(self) -> bool:
        """Tell whether the process uses more memory than a page should."""
        with suppress(OSError, ValueError, AttributeError):
            pages = Path(f"/proc/{self.process.pid}/statm").read_text(encoding="ascii").split()[1]
            return int(pages) * os.sysconf("SC_PAGE_SIZE") > LARGEST_WORKER
        return False


def _how_it_ended(process: Any) -> str:
    if process is None:
        return "before it started"
    process.join(1.0)
    code = process.exitcode
    if code is None:
        return "for an unknown reason"
    return f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"


class WorkerPool:
    """Several workers; a job gets the one that has been free longest."""

    def __init__(self, base: SceneArguments, count: int, patience: Timeouts) -> None:
        self.workers = [Worker(base, patience) for _ in range(count)]
        self.aside = asyncio.Semaphore(count - 1)  # for long jobs that may wait: one worker is kept for all others
        self._threads = ThreadPoolExecutor(count, thread_name_prefix="explore")
        self._free: asyncio.Queue[Worker] = asyncio.Queue()
        self._tasks: set[asyncio.Task[bytes]] = set()

    async def start(self) -> None:
        """Start all workers; each solves the unchanged scene, to load compiled code."""
        for worker in self.workers:
            await asyncio.to_thread(worker.start)
            self._hold(asyncio.create_task(self._solve(worker, Job("curve", {}, {}), lambda: False, lambda text: None)))

    async def stop(self) -> None:
        """Kill all workers."""
        for worker in self.workers:
            if worker.process is not None:
                worker.process.kill()  # unblocks a waiting thread
        self._threads.shutdown(wait=True)
        for worker in self.workers:
            worker.stop()

    async def lend(self) -> Worker:
        """Return a worker as soon as one is free; it must be given back, or passed to `solve`."""
        return await self._free.get()

    def give_back(self, worker: Worker) -> None:
        """Take a worker back."""
        self._free.put_nowait(worker)

    async def solve(self, worker: Worker, job: Job, newer: Callable[[], bool], note: Callable[[str], None]) -> bytes:
        """Return the answer of a lent worker, and take the worker back; `note` is called in this event loop.

        If nobody waits for the answer any longer, the worker comes back later, once it has answered.
        """
        return await asyncio.shield(self._hold(asyncio.create_task(self._solve(worker, job, newer, note))))

    def _hold(self, task: asyncio.Task[bytes]) -> asyncio.Task[bytes]:
        """Keep a reference to a task until it ends, as the loop does not."""
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    async def _solve(self, worker: Worker, job: Job, newer: Callable[[], bool], note: Callable[[str], None]) -> bytes:
        loop = asyncio.get_running_loop()

        def told(text: str) -> None:
            loop.call_soon_threadsafe(note, text)

        try:
            found = await loop.run_in_executor(self._threads, worker.solve, job, newer, told)
            if worker.too_large():
                await loop.run_in_executor(self._threads, worker.stop)
            return found
        finally:
            self.give_back(worker)
