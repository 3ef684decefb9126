"""What follows from objects that many cases share: found once for the same objects, without a look at what they hold.

`functools.lru_cache` asks for the hash of its arguments, which for a section of a scene costs more than most of what is
remembered of it. Objects are held as long as they are remembered, so that where they stand tells them. They must be
such that nobody changes.
"""

from collections.abc import Callable
from typing import Any, Generic, TypeVar

Value = TypeVar("Value")
MOST = 64


class Remembered(Generic[Value]):
    """A function of objects that is asked but once for the same ones; what it raises is raised every time."""

    def __init__(self, function: Callable[..., Value], most: int = MOST) -> None:
        self._function, self._most = function, most
        self._known: dict[tuple[int, ...], tuple[tuple[Any, ...], Value]] = {}

    def __call__(self, *objects: Any) -> Value:
        """Return what the function returns."""
        key = tuple(map(id, objects))
        known = self._known.get(key)
        if known is not None:
            return known[1]
        found = self._function(*objects)
        if len(self._known) >= self._most:
            self._known.clear()
        self._known[key] = objects, found
        return found
