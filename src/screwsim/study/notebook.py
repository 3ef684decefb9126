"""Progress in a notebook: a bar of plain HTML that is redrawn in place, without widgets.

Jupyter, VS Code and Colab replace an output by its name (`display_id`); programs that store or convert a notebook keep
the last one, which has counts only and so is the same from run to run. Its metadata mark it by `screwsim: progress`.
"""

import time
import uuid
from collections.abc import Callable
from html import escape
from typing import Any

from screwsim.study.progress import CountingProgress, digits

Publisher = Callable[..., Any]  # of data, metadata, transient, update, as IPython's publish_display_data
BAR_HTML = (
    '<div style="display: flex; gap: 0.8em; align-items: center"><span>{title}</span>'
    '<progress max="{cases}" value="{done}" style="width: 14em"></progress><span>{told}</span></div>'
)


class NotebookBar(CountingProgress):
    """A bar with rate, time left and failures, redrawn at most five times a second."""

    def __init__(self, title: str, publish: Publisher | None = None, every: float = 0.2) -> None:
        super().__init__(title, time.monotonic)
        self._publish = publish
        self._every = every
        self._name = uuid.uuid4().hex
        self._drawn = 0.0
        self._there = False

    def start(self, cases: int, reused: int) -> None:
        super().start(cases, reused)
        self._draw([])

    def tick(self) -> None:
        if self._there and time.monotonic() - self._drawn >= self._every:
            self._draw(self._pace())

    def stop(self) -> None:
        if self._there:
            self._draw([])

    def _pace(self) -> list[str]:
        """Return the rate and the time left, once a case has been computed."""
        seconds, new = time.monotonic() - self._began, self._done - self._reused
        if not new or seconds <= 0.0:
            return []
        left = (self._cases - self._done) * seconds / new
        return [f"{digits(new / seconds)} points/s", f"{_duration(left)} left"]

    def _draw(self, pace: list[str]) -> None:
        failed = [f"{self._failed} not ok"] if self._failed else []
        told = ", ".join([f"{self._done} of {self._cases}", *failed, *pace])
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
        self._there, self._drawn = True, time.monotonic()


def _duration(seconds: float) -> str:
    if seconds < 100.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.1f} h"
