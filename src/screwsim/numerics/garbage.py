"""Python's search for garbage, put off where many objects are made of which none is garbage: texts, scenes composed.

Trees of a text are some hundred thousand objects, made one after the other and none of them in a ring: each search on
the way goes through all of them and finds nothing. Reading a text without takes half the time.
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
    """Search for no garbage meanwhile, in any thread; where it was off before, it stays off."""
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
