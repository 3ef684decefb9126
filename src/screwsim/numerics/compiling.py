"""Messages on stderr about compilation, which takes a while the first time.

They are printed when something turns out to be missing, and so not when everything is cached.
"""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from screwsim.numerics.folder import tell
from screwsim.numerics.store import keep, read

TIMES = "compile-times.json"  # [s] by kind: duration of the last compilation on this machine


class announced:
    """Print on stderr that `what` is compiled, if something within has to be, and how long its kind takes.

    `usual` is that duration in words, where none has been compiled here before.
    """

    def __init__(self, kind: str, what: str, usual: str) -> None:
        self._kind, self._what, self._usual = kind, what, usual
        self._began: float | None = None

    def __enter__(self) -> None:
        self._before = _now.set(self)

    def __exit__(self, kind: type[BaseException] | None, *_: Any) -> None:
        _now.reset(self._before)
        if kind is None:
            self.end()

    def begin(self) -> None:
        """Print once that something is being compiled."""
        if self._began is None:
            last = _times().get(self._kind)
            expected = (
                self._usual if last is None else f"the last one took {max(last, 0.1):.{1 if last < 10 else 0}f} s here"
            )
            tell(f"compiling {self._what}{_whole.get()}, once ({expected}) ...")
            self._began = time.perf_counter()

    def end(self) -> None:
        """Print how long it took."""
        if self._began is not None:
            seconds = time.perf_counter() - self._began
            tell(f"compiled in {seconds:.1f} s")
            keep(TIMES, json.dumps(_times() | {self._kind: seconds}).encode())


_whole: ContextVar[str] = ContextVar("whole", default="")  # the larger task that the wait is part of
_now: ContextVar[announced | None] = ContextVar("now", default=None)


def _times() -> dict[str, float]:
    return json.loads(read(TIMES) or b"{}")


@contextmanager
def one_of(kind: str, number: int, count: int, what: str) -> Iterator[None]:
    """Add to each message within that it belongs to one of several parts: '(fluid 2 of 4: R513A)'."""
    before = _whole.set(f" ({kind} {number} of {count}: {what})" if count > 1 else "")
    try:
        yield
    finally:
        _whole.reset(before)


def begins() -> None:
    """Note that something is missing and about to be compiled."""
    wait = _now.get()
    if wait is not None:
        wait.begin()


_own = threading.local()


@contextmanager
def again() -> Iterator[None]:
    """Mark a recompilation of running code for speed: silent, and not counted in the time of a solution."""
    before, started, waits = seconds_again(), time.perf_counter(), _now.set(None)
    try:
        yield
    finally:
        _now.reset(waits)
        _own.seconds = before + time.perf_counter() - started


def seconds_again() -> float:
    """Return the time [s] that this thread has spent on recompiling for speed."""
    return getattr(_own, "seconds", 0.0)


def clock() -> float:
    """Return the time [s] of a clock that stands still while this thread recompiles for speed."""
    return time.perf_counter() - seconds_again()
