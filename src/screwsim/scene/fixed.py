"""A mapping of a scene, which does not change: what was simulated is what its text says."""

from typing import Any, NoReturn, TypeVar

K = TypeVar("K")
V = TypeVar("V")


def _refuse(*_: Any, **__: Any) -> NoReturn:
    raise TypeError("a scene does not change: with_ and without make another one")


REFUSED: Any = _refuse


class Fixed(dict[K, V]):
    """A dict that is made once; what would change it raises TypeError with the remedy."""

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = REFUSED

    def __reduce__(self) -> tuple[type, tuple[dict[K, V]]]:
        return Fixed, (dict(self),)
