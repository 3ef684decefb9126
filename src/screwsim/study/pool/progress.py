"""Progress of a study: a bar for terminals and notebooks, lines for other outputs."""

import sys
import time
import uuid
from collections.abc import Callable, Sequence
from contextlib import suppress
from html import escape
from typing import Any

from screwsim.numerics.folder import tell

Publisher = Callable[..., Any]  # of data, metadata, transient, update, as IPython's publish_display_data
BAR_HTML = (
    '<div style="display: flex; gap: 0.8em; align-items: center"><span>{title}</span>'
    '<progress max="{cases}" value="{done}" style="width: 14em"></progress><span>{told}</span></div>'
)


class Progress:
    """Reports of a running study, here none; every call comes from the process and thread that started the study."""

    def start(self, cases: int, reused: int) -> None:
        """Begin: `reused` of the `cases` were computed by an earlier run."""

    def advance(self, cases: int, failed: int) -> None:
        """Count finished cases, `failed` of them without a closed cycle."""

    def solving(self, cases: int) -> None:
        """Show cases that are solved, and that `advance` will count when their chunk is finished."""

    def more(self, cases: int) -> None:
        """Expect more cases than announced at the beginning."""

    def tick(self) -> None:
        """Refresh the report, several times a second."""

    def stop(self) -> None:
        """End, also after an error."""


class CountingProgress(Progress):
    """Base of progresses that count points, those of chunks that are not finished among them, and time their work [s].

    Each finished point refreshes the report. Nothing is shown once its output has failed: a terminal that is gone is no
    fault of a study.
    """

    def __init__(self, title: str = "", clock: Callable[[], float] = time.monotonic) -> None:
        self._title = title
        self._clock = clock
        self._cases = self._reused = self._done = self._failed = self._ahead = self._most = 0
        self._began = 0.0
        self._gone = False

    @property
    def counts(self) -> tuple[int, int]:
        """Return how many points were solved, also in chunks that were never finished, and how many there are."""
        return self._most, self._cases

    def start(self, cases: int, reused: int) -> None:
        self._cases, self._reused, self._done, self._most = cases, reused, reused, reused
        self._began = self._clock()
        self._show(self._begin)

    def advance(self, cases: int, failed: int) -> None:
        shown = min(self._ahead, cases)
        self._ahead -= shown
        self._done += cases - shown
        self._failed += failed
        self._most = max(self._most, self._done)
        self.tick()

    def solving(self, cases: int) -> None:
        self._done += cases - self._ahead
        self._ahead = cases
        self._most = max(self._most, self._done)

    def more(self, cases: int) -> None:
        self._cases += cases

    def tick(self) -> None:
        self._show(self._refresh)

    def stop(self) -> None:
        self._show(self._end)

    def _show(self, show: Callable[[], None]) -> None:
        if self._gone:
            return
        try:
            show()
        except (OSError, ValueError):  # ValueError: the file is closed
            self._gone = True
            with suppress(OSError, ValueError):
                self._end()  # restores stdout and stderr

    def _begin(self) -> None: ...

    def _refresh(self) -> None: ...

    def _end(self) -> None: ...

    def _failures(self, before: str = ", ") -> str:
        return f"{before}{self._failed} not ok" if self._failed else ""


class TerminalBar(CountingProgress):
    """A bar on stderr with rate, time left and failures.

    It has no thread of its own: workers are forked from this process, and a fork copies the locks that threads hold,
    but not the threads.
    """

    def __init__(self, title: str = "sweep") -> None:
        super().__init__(title)
        self._bar: Any = None

    def _begin(self) -> None:
        from rich.console import Console

        class Told(Console):
            def on_broken_pipe(self) -> None:
                raise

        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (
            TextColumn(self._title),
            BarColumn(bar_width=None),  # takes up the rest of the line
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeRemainingColumn(),
            TextColumn("{task.fields[failures]}"),
        )
        self._bar = Progress(*columns, console=Told(stderr=True), auto_refresh=False, expand=True)
        self._bar.add_task(self._title, total=self._cases, completed=self._reused, rate="", failures="")
        self._bar.start()
        self._bar.refresh()

    def _refresh(self) -> None:
        elapsed, new = self._clock() - self._began, self._done - self._reused
        rate = f"{digits(new / elapsed)} points/s" if elapsed and new > 0 else ""
        task = self._bar.task_ids[0]
        self._bar.update(task, completed=self._done, total=self._cases, rate=rate, failures=self._failures(""))
        self._bar.refresh()

    def _end(self) -> None:
        if self._bar is not None:
            self._bar.stop()


class OccasionalLine(CountingProgress):
    """A line on stderr after `first` [s], and then each time the elapsed time has doubled: for logs of long studies."""

    def __init__(self, title: str, first: float = 10.0, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__(title, clock)
        self._next = first

    def _begin(self) -> None:
        if 0 < self._reused < self._cases:
            tell(f"{self._title}: continues with {self._reused} of {self._cases} that were there")

    def _refresh(self) -> None:
        passed = self._clock() - self._began
        if passed < self._next or self._done >= self._cases:
            return
        while self._next <= passed:
            self._next *= 2.0
        new = self._done - self._reused
        left = f", about {passed * (self._cases - self._done) / new:.0f} s left" if new else ""
        tell(f"{self._title}: {self._done} of {self._cases} in {passed:.0f} s{self._failures()}{left}")


class StepLines(Progress):
    """A line on stderr before each of a few named steps: for outputs that are not terminals."""

    def __init__(self, title: str, names: Sequence[str]) -> None:
        self._title = title
        self._names = names
        self._done = 0

    def start(self, cases: int, reused: int) -> None:
        self._done = reused
        self._tell()

    def advance(self, cases: int, failed: int) -> None:
        self._done += cases
        self._tell()

    def _tell(self) -> None:
        if self._done < len(self._names):
            tell(f"{self._title} {self._done + 1} of {len(self._names)}: {self._names[self._done]}")


class OverwrittenLine(CountingProgress):
    """One line on stderr that overwrites itself, at most twice a second: for programs, and a start-up on a terminal."""

    def __init__(self, title: str, every: float = 0.5) -> None:
        super().__init__(title)
        self._every = every
        self._told = 0.0
        self._shown = ""

    def _begin(self) -> None:
        self._shown = self._text()  # nothing is written before a point is solved

    def _refresh(self) -> None:
        now = self._clock()
        if self._text() != self._shown and now - self._told >= self._every:
            self._told = now
            self._write("")

    def _end(self) -> None:
        self._write("\n")

    def _write(self, end: str) -> None:
        self._shown = self._text()
        print(f"\r{self._shown}", end=end, file=sys.stderr, flush=True)

    def _text(self) -> str:
        return f"{self._title}: {self._done} of {self._cases}{self._failures()}"


class NotebookBar(CountingProgress):
    """A bar in a notebook, of plain HTML without widgets: rate, time left and failures, redrawn five times a second.

    Jupyter, VS Code and Colab replace an output by its name (`display_id`); programs that store or convert a notebook
    keep the last one, which has counts only and so is the same from run to run. Its metadata mark it by `screwsim:
    progress`.
    """

    def __init__(
        self,
        title: str,
        publish: Publisher | None = None,
        every: float = 0.2,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(title, clock)
        self._publish = publish
        self._every = every
        self._name = uuid.uuid4().hex
        self._drawn = 0.0
        self._there = False

    def _begin(self) -> None:
        self._draw([])

    def _refresh(self) -> None:
        now = self._clock()
        if not self._there or now - self._drawn < self._every:
            return
        seconds, new = now - self._began, self._done - self._reused
        if new and seconds > 0.0:
            left = (self._cases - self._done) * seconds / new
            self._draw([f"{digits(new / seconds)} points/s", f"{_duration(left)} left"])
        else:
            self._draw([])

    def _end(self) -> None:
        if self._there:
            self._draw([])

    def _draw(self, pace: list[str]) -> None:
        told = ", ".join([f"{self._done} of {self._cases}{self._failures()}", *pace])
        html = BAR_HTML.format(title=escape(self._title), cases=max(self._cases, 1), done=self._done, told=told)
        if self._publish is None:
            from IPython.display import publish_display_data

            self._publish = publish_display_data
        self._publish(
            data={"text/html": html, "text/plain": f"{self._title}: {told}"},
            metadata={"screwsim": "progress"},
            transient={"display_id": self._name},
            update=self._there,
        )
        self._there, self._drawn = True, self._clock()


def _duration(seconds: float) -> str:
    if seconds < 100.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.1f} h"


def in_notebook() -> bool:
    """Return whether output is shown in a notebook; a plain IPython shell is none."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and getattr(shell, "kernel", None) is not None


def for_program(title: str, wanted: bool | None = None) -> Progress:
    """Return the progress of a program's call: by default a bar in notebooks only; on request also a bar or a line."""
    if wanted is not False and in_notebook():
        return NotebookBar(title)
    if not wanted:
        return Progress()
    found = for_terminal(title)
    return found if isinstance(found, TerminalBar) else OverwrittenLine(title)


def progress_of(title: str, asked: Progress | bool | None) -> Progress:
    """Return the progress as given, or that of `for_program` for True, False or None."""
    return for_program(title, asked) if asked is None or isinstance(asked, bool) else asked


def digits(rate: float) -> str:
    """Return a rate with a useful number of digits."""
    return f"{rate:.0f}" if rate >= 10.0 else f"{rate:.2g}"


def for_terminal(title: str = "sweep", names: Sequence[str] = ()) -> Progress:
    """Return a bar when stderr is a terminal; else a line for each of the named steps, or occasional lines."""
    if sys.stderr is None:
        return Progress()
    try:
        if sys.stderr.isatty():
            return TerminalBar(title)
    except ValueError:  # stderr is closed
        return Progress()
    return StepLines(title, names) if names else OccasionalLine(title)
