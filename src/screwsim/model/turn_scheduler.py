"""Who integrates the turns that a thread asks for: each machinery its own, or one scheduler for many.

Points that are solved side by side also wait for each other at stations along the way. Each stretch is then done for
all points before the next begins, while the code and tables that it needs are in the processor's cache.
"""

import threading
from collections.abc import Callable
from typing import Any


class _ThreadScheduler(threading.local):
    """The current thread's scheduler, if any."""

    turn: Callable[..., Any] | None = None  # (machinery, y, rtol, h): replaces `Machinery.turn`
    station: Callable[[], None] | None = None  # lets others reach the same station
    elsewhere: float = 0.0  # [s] spent on others while the running task waited


scheduler = _ThreadScheduler()


def reach_station() -> None:
    """Let points that are solved beside this one reach the same station."""
    if scheduler.station is not None:
        scheduler.station()
