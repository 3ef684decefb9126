"""Immutable mapping of a scene, so that a scene always agrees with its text."""

from typing import Any, Generic, NoReturn, TypeVar

K = TypeVar("K")
V = TypeVar("V")


class FixedDict(dict[K, V], Generic[K, V]):
    """A dict that cannot be changed; any attempt raises TypeError with the remedy."""

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError("a scene cannot be changed: with_ and without return a new one")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = _refuse
    setdefault = update = _refuse  # pyright: ignore[reportAssignmentType] - of more forms than one

    def __reduce__(self) -> tuple[Any, ...]:
        return FixedDict, (dict(self),)
