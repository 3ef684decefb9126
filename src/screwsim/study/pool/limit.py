"""Time limit of a case: the worker process that runs a hanging case is killed by the system's own timer.

While compiled code runs, neither signal handlers nor other threads of Python do, so only the signal's default action
helps.
"""

import signal
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from greenlet import getcurrent, greenlet

from screwsim.inputs.faults import UsageError

CASE_LIMIT = 300.0  # [s] of one case; the hardest known ones take some seconds
LEAST, MOST = 0.001, 1e8  # [s] that a case may be given: beyond MOST the system's timer overflows
# by running task: a worker may have several threads, each with several greenlets, but a process has one timer
_deadlines: dict[greenlet, float] = {}  # [s]
_seconds_left: dict[greenlet, float] = {}  # [s] left to tasks that wait for others
_lock = threading.Lock()


def checked_limit(seconds: float | None) -> float | None:
    """Return a limit [s] as the system's timer takes it; raise UsageError where it is not valid, as NaN."""
    if seconds is not None and not LEAST <= seconds <= MOST:
        what = f"is not a time from {LEAST:g} to {MOST:g} seconds (leave it out for {CASE_LIMIT:g} s)"
        raise UsageError(f"--case-limit {seconds:g}: {what}")
    return None if seconds is None else float(seconds)


class TimeLimit:
    """Context in which this process is killed after `seconds`; never for None, or on a system without such timers."""

    def __init__(self, seconds: float | None) -> None:
        self._seconds = seconds if hasattr(signal, "setitimer") else None

    def __enter__(self) -> None:
        if self._seconds is not None:
            with _lock:
                _deadlines[getcurrent()] = time.monotonic() + self._seconds
                _arm_timer()

    def __exit__(self, *error: object) -> None:
        if self._seconds is not None:
            with _lock:
                _deadlines.pop(getcurrent(), None)
                _seconds_left.pop(getcurrent(), None)  # the task ended while it waited for others
                _arm_timer()


@contextmanager
def clocks_running(tasks: Sequence[greenlet]) -> Iterator[None]:
    """Run the clocks of `tasks` within, which wait for what this one does; without any, stop the clock of this one."""
    going, waiting = (tasks, ()) if tasks else ((), (getcurrent(),))
    _switch_clocks(waiting, going)
    try:
        yield
    finally:
        _switch_clocks(going, waiting)


def clock_handed_on(one: greenlet, other: greenlet) -> None:
    """Stop the clock of one task and start that of the other, which continues in its place."""
    _switch_clocks((one,), (other,))


def _switch_clocks(stopping: Sequence[greenlet], going: Sequence[greenlet]) -> None:
    """Stop the clocks of some tasks and start those of others, as far as they have a limit."""
    with _lock:
        now = time.monotonic()
        stopped = {one: _deadlines.pop(one) - now for one in stopping if one in _deadlines}
        started = {one: now + _seconds_left.pop(one) for one in going if one in _seconds_left}
        _seconds_left.update(stopped)
        _deadlines.update(started)
        if stopped or started:
            _arm_timer()


def _arm_timer() -> None:
    left = max(1e-3, min(_deadlines.values()) - time.monotonic()) if _deadlines else 0.0
    signal.setitimer(signal.ITIMER_REAL, left)
