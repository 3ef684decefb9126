"""Cases counted while they are being solved, for a progress that would otherwise stand still until a chunk is finished.

Workers append a byte per case to a temporary file, whose size this process reads now and then; no message has to pass
between them, whatever way they were started. In this process alone, cases are counted in memory.
"""

import os
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum

from screwsim.study.pool.progress import Progress

SHOWN_EVERY = 0.2  # [s] between two redraws in a process that solves its cases itself


def no_mark() -> None:
    """Count nothing."""


@dataclass(frozen=True)
class FileMark:
    """Count a case in a file; one that is gone or full is no fault of the case."""

    path: str

    def __call__(self) -> None:
        """Append a byte."""
        with suppress(OSError), os.fdopen(os.open(self.path, os.O_WRONLY | os.O_APPEND), "wb", 0) as stream:
            stream.write(b".")


class Place(Enum):
    """Where cases are solved: in this process, in others on this machine, or on machines that cannot count here."""

    HERE = 0
    BESIDE = 1
    ELSEWHERE = 2


class Tally:
    """Count of solved cases, shown by a progress beyond those of finished chunks; `mark` counts one.

    Of cases solved `BESIDE`, `mark` can be sent to the processes that solve them. Nothing is counted where nobody
    looks, or for a progress of another program that has no `solving`.
    """

    def __init__(self, progress: Progress, place: Place) -> None:
        self._progress = progress
        self._solved = self._finished = 0
        self._most = sys.maxsize
        self._shown = 0.0
        counts = place is not Place.ELSEWHERE and type(progress) is not Progress and hasattr(progress, "solving")
        self._path = _empty_file() if counts and place is Place.BESIDE else ""
        in_memory = self._mark if counts and place is Place.HERE else no_mark
        self.mark: Callable[[], None] = FileMark(self._path) if self._path else in_memory

    def start(self, cases: int, reused: int) -> None:
        """Start the progress, of cases of which some are reused."""
        self._most = cases - reused
        self._progress.start(cases, reused)

    def advance(self, cases: int, failed: int) -> None:
        """Take cases as finished, which the progress counts from now on."""
        self._finished += cases
        self._progress.advance(cases, failed)

    def advance_all(self, cases: int, failed: int) -> None:
        """Take all solved cases as finished, and have the progress count so many."""
        self._finished = self.solved()
        self._progress.advance(cases, failed)

    def solved(self) -> int:
        """Return the number of solved cases."""
        if self._path:
            with suppress(OSError):
                self._solved = os.stat(self._path).st_size
        return self._solved

    def tick(self) -> None:
        """Show the solved cases; those of a worker that died are solved again, and are not more than there are."""
        if self.mark is not no_mark:
            self._progress.solving(max(0, min(self.solved(), self._most) - self._finished))
        self._progress.tick()

    def stop(self) -> None:
        """End the progress, which then shows finished cases alone, and remove the file."""
        if self.mark is not no_mark:
            self._progress.solving(0)
        self._progress.stop()
        if self._path:
            with suppress(OSError):
                os.unlink(self._path)

    def _mark(self) -> None:
        self._solved += 1
        now = time.monotonic()
        if now - self._shown >= SHOWN_EVERY:
            self._shown = now
            self.tick()


def _empty_file() -> str:
    """Return the path of a new empty file; '' where the system has no room for one."""
    try:
        stream, path = tempfile.mkstemp(prefix="screwsim-", suffix=".tally")
    except OSError:
        return ""
    os.close(stream)
    return path
