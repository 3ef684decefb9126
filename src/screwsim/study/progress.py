"""Progress of a sweep: what is told, and a bar for terminals."""

from __future__ import annotations

import sys
from typing import Any, Protocol


class Progress(Protocol):
    """What a sweep tells while it runs; every call comes from the process and thread that called `run_sweep`."""

    def start(self, cases: int, reused: int) -> None:
        """Begin: `reused` of the `cases` were computed by an earlier run."""

    def advance(self, cases: int, failed: int) -> None:
        """Count cases that are done, `failed` of them without a closed cycle."""

    def tick(self) -> None:
        """Give a sign of life, some times a second."""

    def stop(self) -> None:
        """End, also after an error."""


class Silent:
    """Tell nothing."""

    def start(self, cases: int, reused: int) -> None: ...

    def advance(self, cases: int, failed: int) -> None: ...

    def tick(self) -> None: ...

    def stop(self) -> None: ...


class Bar:
    """A bar on stderr with rate, time left and failures.

    It has no thread of its own: the workers are forked from this process, and a fork copies no threads but the
    locks that they hold.
    """

    def __init__(self, title: str = "sweep") -> None:
        self._title = title
        self._bar: Any = None
        self._task: Any = None
        self._failed = 0
        self._new = 0

    def start(self, cases: int, reused: int) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (
            TextColumn(self._title),
            BarColumn(bar_width=None),  # what is left of the line
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeRemainingColumn(),
            TextColumn("{task.fields[failures]}"),
        )
        self._bar = Progress(*columns, console=Console(stderr=True), auto_refresh=False, expand=True)
        self._task = self._bar.add_task(self._title, total=cases, completed=reused, rate="", failures="")
        self._bar.start()
        self._bar.refresh()

    def advance(self, cases: int, failed: int) -> None:
        self._failed += failed
        self._new += cases
        elapsed = self._bar.tasks[0].elapsed or 0.0
        rate = f"{_digits(self._new / elapsed)} points/s" if elapsed else ""
        failures = f"{self._failed} not ok" if self._failed else ""
        self._bar.update(self._task, advance=cases, rate=rate, failures=failures, refresh=True)

    def tick(self) -> None:
        self._bar.refresh()

    def stop(self) -> None:
        if self._bar is not None:
            self._bar.stop()


def _digits(rate: float) -> str:
    return f"{rate:.0f}" if rate >= 10.0 else f"{rate:.2g}"


def for_terminal(title: str = "sweep") -> Progress:
    """Return a bar when stderr is a terminal, else silence."""
    return Bar(title) if sys.stderr.isatty() else Silent()
