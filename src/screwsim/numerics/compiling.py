"""What a compilation means for people: said on stderr the first time, because it takes a while.

It is said when something is found to be missing, and so not when all is there.
"""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from typing import Any

from screwsim.numerics.folder import tell
from screwsim.numerics.store import keep, read

TIMES = "compile-times.json"  # [s] by kind, that the last one took on this machine


class _Wait:
    """A stretch of work within which something may have to be compiled first."""

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
        """Say that something is compiled, once."""
        if self._began is None:
            last = _times().get(self._kind)
            expected = (
                self._usual if last is None else f"the last one took {max(last, 0.1):.{1 if last < 10 else 0}f} s here"
            )
            tell(f"compiling {self._what}{_whole.get()}, once ({expected}) ...")
            self._began = time.perf_counter()

    def end(self) -> None:
        """Say how long it took."""
        if self._began is not None:
            seconds = time.perf_counter() - self._began
            tell(f"compiled in {seconds:.1f} s")
            keep(TIMES, json.dumps(_times() | {self._kind: seconds}).encode())


_whole: ContextVar[str] = ContextVar("whole", default="")  # what the wait is one part of
_now: ContextVar[_Wait | None] = ContextVar("now", default=None)


def _times() -> dict[str, float]:
    return json.loads(read(TIMES) or b"{}")


def announced(kind: str, what: str, usual: str) -> AbstractContextManager[None]:
    """Say on stderr that `what` is compiled, where something within must be, and how long one of its kind takes.

    `usual` says that in words where none was compiled here before.
    """
    return _Wait(kind, what, usual)


@contextmanager
def one_of(kind: str, number: int, count: int, what: str) -> Iterator[None]:
    """Say of each wait within that it belongs to one of some parts: '(fluid 2 of 4: R513A)'."""
    before = _whole.set(f" ({kind} {number} of {count}: {what})" if count > 1 else "")
    try:
        yield
    finally:
        _whole.reset(before)


def begins() -> None:
    """Take note that something is missing and compiled now."""
    wait = _now.get()
    if wait is not None:
        wait.begin()


_own = threading.local()


@contextmanager
def again() -> Iterator[None]:
    """Take note that what runs is compiled once more, for speed: in silence, and none of a solution's time."""
    before, started, waits = seconds_again(), time.perf_counter(), _now.set(None)
    try:
        yield
    finally:
        _now.reset(waits)
        _own.seconds = before + time.perf_counter() - started


def seconds_again() -> float:
    """Return how long [s] this thread has compiled for speed what it had compiled before."""
    return getattr(_own, "seconds", 0.0)


def clock() -> float:
    """Return the seconds [s] of a clock that stands still while this thread compiles again what it had compiled."""
    return time.perf_counter() - seconds_again()
