"""A value of an object that is found when it is first asked for.

`functools.cached_property` of Python 3.11 takes a lock for each, which costs more than most of these values; from 3.12
on there is none. Two threads that ask at once may both find it, and find the same.
"""

from collections.abc import Callable
from functools import cached_property
from sys import version_info
from typing import TYPE_CHECKING, Any

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
            """Return the value, which then stands in the object itself."""
            if of is None:
                return self
            value = of.__dict__[self._name] = self._found(of)
            return value
