"""The process of a command: no work for memory that lives as long as it does.

What the compiler and CoolProp bring are a million objects that stay. Python would look through them for garbage while
it imports them, and take them apart one by one at the end, which takes longer than many a solution.
"""

from __future__ import annotations

import atexit
import gc
import os
import sys
import threading
from typing import NoReturn

YOUNG = 200_000  # objects made between two searches for garbage; Python's own number is 700


def begin() -> None:
    """Search for cyclic garbage seldom, from now on."""
    gc.set_threshold(YOUNG, *gc.get_threshold()[1:])


def end(code: int) -> NoReturn:
    """End the process with an exit code: what was registered for the end is done, what was written is flushed.

    With other threads about, output that cannot be written, or SCREWSIM_DEBUG=1 (a profiler waits for the end)
    Python ends it.
    """
    if threading.active_count() > 1 or os.environ.get("SCREWSIM_DEBUG") == "1":
        sys.exit(code)
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except (OSError, ValueError, AttributeError):
        sys.exit(code)
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
