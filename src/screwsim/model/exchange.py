"""Who integrates the turns that a thread asks for: each machinery its own, or one caller for many.

Points that are solved side by side also wait for each other at stations on their way. Each part of the way is then done
for all points before the next one begins, while the code and tables that it needs are in the processor's cache.
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
