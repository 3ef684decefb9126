"""Who integrates the turns that are asked for in this thread: each machinery its own, or somebody for many."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any


class _Here(threading.local):
    turn: Callable[..., Any] | None = None  # (machinery, y, rtol, h), does what `Machinery.turn` does


here = _Here()
