"""Who integrates the turns that are asked for in this thread: each machinery its own, or somebody for many.

Points that are solved side by side also wait for each other at stations on their way, so that a part of it is done for
all of them before the next: what it asks for (code, tables) is in the processor's cache then, which after a turn it is
not.
"""

import threading
from collections.abc import Callable
from typing import Any


class _Here(threading.local):
    turn: Callable[..., Any] | None = None  # (machinery, y, rtol, h), does what `Machinery.turn` does
    station: Callable[[], None] | None = None  # lets others come as far as this
    elsewhere: float = 0.0  # [s] of others, while what runs now waited for them


here = _Here()


def station() -> None:
    """Let points that are solved beside this one come as far."""
    if here.station is not None:
        here.station()
