"""Results that follow from objects shared by many cases: found once for each object, without looking into it.

`functools.lru_cache` hashes its arguments, which for a section of a scene costs more than most of the results that are
remembered. Here objects are known by their address, and are held for as long as their results are remembered. They must
never change.
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
