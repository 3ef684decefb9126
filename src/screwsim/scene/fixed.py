"""A mapping of a scene, which does not change: what was simulated is what its text says."""

from typing import Any, NoReturn, TypeVar

K, V = TypeVar("K"), TypeVar("V")


class Fixed(dict[K, V]):
    """A dict that is made once; what would change it raises TypeError with the remedy."""

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError("a scene does not change: with_ and without make another one")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[type, tuple[dict[K, V]]]:
        return Fixed, (dict(self),)
