"""What a compilation means for people: said on stderr the first time, because it takes long, and ended by Ctrl-C.

It is said when something is found to be missing, and so not when all is there. The compiler calls Python back from
within and renames or swallows an interruption there; here it is one in any case.
"""

from __future__ import annotations

import gc
import json
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
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
        self._collecting = False
        self._handler: Any = None
        self._hook = sys.unraisablehook
        self.interrupted = False

    def begin(self) -> None:
        """Say that something is compiled, once; raise KeyboardInterrupt where one was swallowed."""
        if self.interrupted:
            raise KeyboardInterrupt
        if self._began is not None:
            return
        last = _times().get(self._kind)
        expected = self._usual if last is None else f"the last one took {last:.0f} s here"
        tell(f"compiling {self._what}, once ({expected}) ...")
        self._began = time.perf_counter()
        # the compiler's many objects live on, and would be searched for cyclic garbage over and over
        self._collecting = gc.isenabled()
        gc.disable()
        if threading.current_thread() is threading.main_thread() and callable(signal.getsignal(signal.SIGINT)):
            self._handler = signal.signal(signal.SIGINT, self._interrupt)
            self._hook, sys.unraisablehook = sys.unraisablehook, self._swallowed

    def _interrupt(self, number: int, frame: Any) -> None:
        self.interrupted = True
        self._handler(number, frame)

    def _swallowed(self, what: Any) -> None:
        """Show what cannot be raised; but not that of an interruption, which is raised later."""
        if not self.interrupted:
            self._hook(what)

    def end(self, done: bool) -> None:
        """Say how long it took; leave the process as it was."""
        if self._handler is not None:
            signal.signal(signal.SIGINT, self._handler)
            sys.unraisablehook = self._hook
        if self._began is None:
            return
        if self._collecting:
            gc.enable()
        if done:
            seconds = time.perf_counter() - self._began
            tell(f"compiled in {seconds:.1f} s")
            keep(TIMES, json.dumps(_times() | {self._kind: seconds}).encode())


_now: ContextVar[_Wait | None] = ContextVar("now", default=None)


def _times() -> dict[str, float]:
    return json.loads(read(TIMES) or b"{}")


@contextmanager
def announced(kind: str, what: str, usual: str) -> Iterator[None]:
    """Say on stderr that `what` is compiled, where something within must be, and how long one of its kind takes.

    `usual` says that in words where none was compiled here before. An interruption while it is compiled is a
    KeyboardInterrupt, whatever the compiler made of it.
    """
    wait = _Wait(kind, what, usual)
    before = _now.set(wait)
    done = False
    try:
        yield
        done = not wait.interrupted
    except BaseException:
        if wait.interrupted:
            raise KeyboardInterrupt from None
        raise
    finally:
        _now.reset(before)
        wait.end(done)
    if wait.interrupted:
        raise KeyboardInterrupt


def begins() -> None:
    """Take note that something is missing and compiled now."""
    wait = _now.get()
    if wait is not None:
        wait.begin()
