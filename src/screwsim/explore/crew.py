"""The workers: processes that solve for pages, each killed and started anew when it hangs, dies or grows too large."""

import asyncio
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from screwsim.explore import answer
from screwsim.explore.changes import Base
from screwsim.explore.worker import DONE, NOTE, Job, serve
from screwsim.numerics.folder import handed_on

LOOK = 0.05  # [s] between two looks at a worker that solves
LARGEST = 1 << 30  # [byte] of a worker, above which it is started anew


@dataclass(frozen=True)
class Patience:
    """How long [s] a page waits: for an answer, for one that a newer request waits behind, for what is compiled."""

    alone: float = 60.0
    behind: float = 5.0
    compiling: float = 180.0


class Dead(Exception):
    """Say why a worker gave no answer."""


@dataclass
class Worker:
    """One process and its pipe; `compiling` tells that it said so, and has not said that it is done."""

    base: Base
    patience: Patience
    process: Any = None
    pipe: Connection | None = None
    starts: int = 0
    compiling: bool = False
    jobs: int = field(default=0)

    def start(self) -> None:
        """Start the process; it gets ready while nobody waits."""
        context = multiprocessing.get_context("forkserver" if sys.platform == "linux" else "spawn")
        if sys.platform == "linux":
            context.set_forkserver_preload(["screwsim.explore.worker"])  # type: ignore[attr-defined]
        mine, its = context.Pipe()
        base = self.base
        arguments = (its, base.file, base.overrides, handed_on())
        self.process = context.Process(target=serve, args=arguments, daemon=True)  # type: ignore[attr-defined]
        self.process.start()
        its.close()
        self.pipe, self.compiling = mine, False
        self.starts += 1

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
        """Return the answer to a job, from a thread of its own; a worker that gives none is stopped and told of."""
        try:
            return self._answer(job, newer, note)
        except Dead as error:
            self.stop()
            return answer.refused(str(error), job.tag)
        except (EOFError, OSError):
            how = _how_it_ended(self.process)
            self.stop()
            return answer.refused(f"the process that solved this died {how}; another takes its place", job.tag)

    def _answer(self, job: Job, newer: Callable[[], bool], note: Callable[[str], None]) -> bytes:
        if self.process is None:
            self.start()
        assert self.pipe is not None
        self.pipe.send(job)
        self.jobs += 1
        began, compiled = time.monotonic(), 0.0
        last = began
        while True:
            if self.pipe.poll(LOOK):
                kind, content = self.pipe.recv()
                if kind == DONE:
                    return content
                if kind == NOTE:
                    self.compiling = content.startswith("compiling")
                    note(content)
            now = time.monotonic()
            compiled += now - last if self.compiling else 0.0
            last = now
            self._mind(now - began - compiled, compiled, newer())

    def _mind(self, solving: float, compiling: float, newer: bool) -> None:
        """Raise Dead where an answer takes too long."""
        most = self.patience.behind if newer else self.patience.alone
        if solving > most or compiling > self.patience.compiling:
            seconds = max(solving, compiling)
            what = "compilation" if compiling > self.patience.compiling else "solution"
            raise Dead(f"the {what} was given up after {seconds:.0f} s (change the settings, or go back)")

    def too_large(self) -> bool:
        """Tell whether the process has grown beyond what a page should cost."""
        with suppress(OSError, ValueError, AttributeError):
            pages = Path(f"/proc/{self.process.pid}/statm").read_text(encoding="ascii").split()[1]
            return int(pages) * os.sysconf("SC_PAGE_SIZE") > LARGEST
        return False


def _how_it_ended(process: Any) -> str:
    if process is None:
        return "before it began"
    process.join(1.0)
    code = process.exitcode
    if code is None:
        return "without a word"
    return f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"


class Crew:
    """Some workers; a job gets the one that is free the longest."""

    def __init__(self, base: Base, count: int, patience: Patience) -> None:
        self.workers = [Worker(base, patience) for _ in range(count)]
        self.aside = asyncio.Semaphore(count - 1)  # of what takes long and may wait: a worker is left to all else
        self._threads = ThreadPoolExecutor(count, thread_name_prefix="explore")
        self._free: asyncio.Queue[Worker] = asyncio.Queue()
        self._tasks: set[asyncio.Task[bytes]] = set()

    async def start(self) -> None:
        """Start all, and let each solve the scene as it is, which loads what is compiled."""
        for worker in self.workers:
            await asyncio.to_thread(worker.start)
            self._hold(asyncio.create_task(self._solve(worker, Job("curve", {}, {}), lambda: False, lambda text: None)))

    async def stop(self) -> None:
        """Kill all."""
        for worker in self.workers:
            if worker.process is not None:
                worker.process.kill()  # ends what a thread waits for
        self._threads.shutdown(wait=True)
        for worker in self.workers:
            worker.stop()

    async def lend(self) -> Worker:
        """Return a worker, as soon as one is free; it is to be given back, or to `solve`."""
        return await self._free.get()

    def give_back(self, worker: Worker) -> None:
        """Take a worker back."""
        self._free.put_nowait(worker)

    async def solve(self, worker: Worker, job: Job, newer: Callable[[], bool], note: Callable[[str], None]) -> bytes:
        """Return the answer of a lent worker, and take it back; `note` is called in this loop.

        Where nobody waits for the answer any more the worker comes back later, when it has given it.
        """
        return await asyncio.shield(self._hold(asyncio.create_task(self._solve(worker, job, newer, note))))

    def _hold(self, task: asyncio.Task[bytes]) -> asyncio.Task[bytes]:
        """Keep a task until it ends: the loop does not."""
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
