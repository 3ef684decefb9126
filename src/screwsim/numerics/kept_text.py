"""Texts of kernels that were written before: read from the cache folder, found by all that they are made of."""

import hashlib
import sys
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from screwsim.numerics import sources, store
from screwsim.numerics.garbage import no_search
from screwsim.numerics.kernel import HEADER, Kernel, flatten, spelled

FASTEST = 1  # level of zlib: a sixth of the size, in a millisecond
NO_SLOTS: Mapping[str, str] = MappingProxyType({})


def kept_text(by: Sequence[str], kernels: Iterable[Kernel], of: Sequence[Any], write: Callable[[], str]) -> str:
    """Return the text that `write` returns, as it was kept, or written now and kept.

    It is made by code in the folders `by` of this package, of kernels and all that they use, and of what has one
    `repr`: an edit of any of these makes another text. How a tree is spelled is Python's matter, so its version counts.
    Where the code was edited after this process began, it is not what the folders hold, and nothing is kept.
    """
    code = sources.of_folders(*by)
    if code is None:
        return write()
    parts = (code, spelled(kernels), sys.version, *map(repr, of))
    name = f"screwsim_{by[0]}_{hashlib.sha256(chr(0).join(parts).encode()).hexdigest()[:24]}.text"
    text = _read(name)
    if text is None:
        with no_search():
            text = write()
        store.keep(name, zlib.compress(text.encode(), FASTEST))
    return text


def _read(name: str) -> str | None:
    content = store.read(name)
    if content is None:
        return None
    try:
        return zlib.decompress(content).decode()
    except (zlib.error, UnicodeDecodeError):
        return None


def flat_module(kernels: Sequence[Kernel], calling: Sequence[Kernel] = (), slots: Mapping[str, str] = NO_SLOTS) -> str:
    """Return the text of a module of kernels, and of more of them, `calling` what fills their slots."""

    def text() -> str:
        found = flatten(kernels)
        found |= flatten(calling, slots)
        return "\n\n".join([HEADER, *found.values()]) + "\n"

    return kept_text(("numerics",), (*kernels, *calling), [len(kernels), sorted(slots.items())], text)
