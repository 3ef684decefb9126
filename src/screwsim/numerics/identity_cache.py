"""Caches keyed by the identity of objects: results that follow from shared objects, and values of one object.

`functools.lru_cache` hashes its arguments, which for a section of a scene costs more than most of the results that are
`IdentityCache`. Here objects are identified by their address, and are kept alive as long as their results. They must
never change. `keep` bounds a dict of results by other keys.

`once` computes a value of an object when it is first read. `functools.cached_property` of Python 3.11 takes a lock for
each, which costs more than most of these values; from 3.12 on it takes none. Two threads that read it at the same time
may both compute it, with the same result.
"""

from collections.abc import Callable
from functools import cached_property
from sys import version_info
from typing import TYPE_CHECKING, Any, Generic, TypeVar

Value = TypeVar("Value")
MOST = 64  # results that are kept, by default
SIDE_BY_SIDE = 16  # as many points of different machines may be solved side by side


def keep(known: dict[Any, Any], key: Any, value: Any, most: int = SIDE_BY_SIDE) -> Any:
    """Store a value in a dict and return it; the oldest entry is dropped where there are too many."""
    if len(known) >= most:
        known.pop(next(iter(known)), None)
    known[key] = value
    return value


class IdentityCache(Generic[Value]):
    """A function of objects that is evaluated once for the same ones; exceptions are not cached."""

    def __init__(self, function: Callable[..., Value], most: int = MOST) -> None:
        self._function, self._most = function, most
        self._known: dict[tuple[int, ...], tuple[tuple[Any, ...], Value]] = {}

    def __call__(self, *objects: Any) -> Value:
        """Return the function's result, from the cache if it is there."""
        key = tuple(map(id, objects))
        known = self._known.get(key)
        if known is not None:
            return known[1]
        found = self._function(*objects)
        if len(self._known) >= self._most:
            self._known.clear()
        self._known[key] = objects, found
        return found


if TYPE_CHECKING or version_info >= (3, 12):
    once = cached_property
else:

    class once:
        """Do what `functools.cached_property` does, without its lock."""

        def __init__(self, found: Callable[[Any], Any]) -> None:
            self._found, self.__doc__ = found, found.__doc__

        def __set_name__(self, owner: type, name: str) -> None:
            self._name = name

        def __get__(self, of: Any, owner: type | None = None) -> Any:
            """Return the value, which is then stored in the object itself."""
            if of is None:
                return self
            value = of.__dict__[self._name] = self._found(of)
            return value
