"""Python's garbage collection, suspended while many objects are made that are not garbage: syntax trees, scenes.

The tree of a text has some hundred thousand objects, made one after the other, without any cycles: every collection
meanwhile visits all of them and finds nothing. Without it a text is parsed in half the time.
"""

import gc
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_alone = threading.Lock()
_inside = 0
_was_on = False


@contextmanager
def no_search() -> Iterator[None]:
    """Suspend garbage collection within, in all threads; where it was off before, it stays off."""
    global _inside, _was_on
    with _alone:
        if not _inside:
            _was_on = gc.isenabled()
            gc.disable()
        _inside += 1
    try:
        yield
    finally:
        with _alone:
            _inside -= 1
            if not _inside and _was_on:
                gc.enable()
