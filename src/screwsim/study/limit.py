"""An end to a case that hangs: the worker process that runs it is killed by the system's own timer.

Compiled code lets no signal handler and no thread of Python run, so only the signal's default action helps.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from screwsim.inputs.faults import UsageError

CASE_LIMIT = 300.0  # [s] of one case; the hardest known ones take some seconds
LEAST, MOST = 0.001, 1e8  # [s] that a case may be given: beyond, the system's timer overflows
_deadlines: dict[int, float] = {}  # [s], by thread: a worker of a cluster may have several, a process has one timer
_left: dict[int, float] = {}  # [s], of threads that wait for others
_lock = threading.Lock()


def check_limit(seconds: float | None) -> None:
    """Raise UsageError unless a limit [s] is one; NaN is none."""
    if seconds is not None and not LEAST <= seconds <= MOST:
        what = f"is not a time from {LEAST:g} to {MOST:g} seconds (leave it out for {CASE_LIMIT:g} s)"
        raise UsageError(f"--case-limit {seconds:g}: {what}")


class Limit:
    """Within it this process is killed after `seconds`; None, or a system without such timers: never."""

    def __init__(self, seconds: float | None) -> None:
        self._seconds = seconds if hasattr(signal, "setitimer") else None

    def __enter__(self) -> None:
        if self._seconds is not None:
            with _lock:
                _deadlines[threading.get_ident()] = time.monotonic() + self._seconds
                _arm()

    def __exit__(self, *error: object) -> None:
        if self._seconds is not None:
            with _lock:
                _deadlines.pop(threading.get_ident(), None)
                _arm()


@contextmanager
def running(threads: Sequence[int]) -> Iterator[None]:
    """Let the time of these threads run within, which wait for what this one does; of none: stop that of this one."""
    if not threads:
        _stop([threading.get_ident()])
    else:
        _go_on(threads)
    try:
        yield
    finally:
        if not threads:
            _go_on([threading.get_ident()])
        else:
            _stop(threads)


def _stop(threads: Sequence[int]) -> None:
    with _lock:
        now = time.monotonic()
        _left.update({one: _deadlines.pop(one) - now for one in threads if one in _deadlines})
        _arm()


def _go_on(threads: Sequence[int]) -> None:
    with _lock:
        now = time.monotonic()
        _deadlines.update({one: now + _left.pop(one) for one in threads if one in _left})
        _arm()


def _arm() -> None:
    left = max(1e-3, min(_deadlines.values()) - time.monotonic()) if _deadlines else 0.0
    signal.setitimer(signal.ITIMER_REAL, left)
