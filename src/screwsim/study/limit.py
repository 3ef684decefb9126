"""An end to a case that hangs: the worker process that runs it is killed by the system's own timer.

Compiled code lets no signal handler and no thread of Python run, so only the signal's default action helps.
"""

import signal
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from greenlet import getcurrent, greenlet

from screwsim.inputs.faults import UsageError

CASE_LIMIT = 300.0  # [s] of one case; the hardest known ones take some seconds
LEAST, MOST = 0.001, 1e8  # [s] that a case may be given: beyond, the system's timer overflows
# by what runs: a worker may have several threads, each several tasks in greenlets, and a process has one timer
_deadlines: dict[greenlet, float] = {}  # [s]
_left: dict[greenlet, float] = {}  # [s], of those that wait for others
_lock = threading.Lock()


def checked_limit(seconds: float | None) -> float | None:
    """Return a limit [s] as the system's timer takes it; raise UsageError of one that is none, as NaN is."""
    if seconds is not None and not LEAST <= seconds <= MOST:
        what = f"is not a time from {LEAST:g} to {MOST:g} seconds (leave it out for {CASE_LIMIT:g} s)"
        raise UsageError(f"--case-limit {seconds:g}: {what}")
    return None if seconds is None else float(seconds)


class Limit:
    """Within it this process is killed after `seconds`; None, or a system without such timers: never."""

    def __init__(self, seconds: float | None) -> None:
        self._seconds = seconds if hasattr(signal, "setitimer") else None

    def __enter__(self) -> None:
        if self._seconds is not None:
            with _lock:
                _deadlines[getcurrent()] = time.monotonic() + self._seconds
                _arm()

    def __exit__(self, *error: object) -> None:
        if self._seconds is not None:
            with _lock:
                _deadlines.pop(getcurrent(), None)
                _left.pop(getcurrent(), None)  # it was ended while it waited for others
                _arm()


@contextmanager
def running(tasks: Sequence[greenlet]) -> Iterator[None]:
    """Let the time of these run within, which wait for what this one does; of none: stop that of this one."""
    going, waiting = (tasks, ()) if tasks else ((), (getcurrent(),))
    _switch(waiting, going)
    try:
        yield
    finally:
        _switch(going, waiting)


def handed_on(one: greenlet, other: greenlet) -> None:
    """Stop the time of one, and let that of another run, which goes on in its place."""
    _switch((one,), (other,))


def _switch(stopping: Sequence[greenlet], going: Sequence[greenlet]) -> None:
    """Stop the time of some tasks, and let that of others run, as far as they have a limit."""
    with _lock:
        now = time.monotonic()
        stopped = {one: _deadlines.pop(one) - now for one in stopping if one in _deadlines}
        started = {one: now + _left.pop(one) for one in going if one in _left}
        _left.update(stopped)
        _deadlines.update(started)
        if stopped or started:
            _arm()


def _arm() -> None:
    left = max(1e-3, min(_deadlines.values()) - time.monotonic()) if _deadlines else 0.0
    signal.setitimer(signal.ITIMER_REAL, left)
