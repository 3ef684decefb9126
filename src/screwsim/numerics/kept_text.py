"""Texts of generated modules, cached in the cache folder under a digest of everything that they are made from."""

import hashlib
import sys
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from screwsim.numerics import sources, store
from screwsim.numerics.garbage import no_search
from screwsim.numerics.kernel import HEADER, Kernel, flatten, kernels_digest

FASTEST = 1  # zlib's level: a sixth of the size, in a millisecond
NO_SLOTS: Mapping[str, str] = MappingProxyType({})


def kept_text(by: Sequence[str], kernels: Iterable[Kernel], of: Sequence[Any], write: Callable[[], str]) -> str:
    """Return the text that `write` returns, from the cache if it is there, else written and cached now.

    It depends on the code in the folders `by` of this package, on kernels and everything that they use, on the `repr`
    of the objects `of`, and on Python's version, which determines how trees are unparsed: a change of any of these
    gives another text. Where the code was edited after this process began, the digest of the folders is not that of the
    running code, and nothing is cached.
    """
    code = sources.folders_digest(*by)
    if code is None:
        return write()
    parts = (code, kernels_digest(kernels), sys.version, *map(repr, of))
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
    """Return the text of a module of kernels and of `calling`, kernels whose slots are filled by `slots`."""

    def text() -> str:
        found = flatten(kernels)
        found |= flatten(calling, slots)
        return "\n\n".join([HEADER, *found.values()]) + "\n"

    return kept_text(("numerics",), (*kernels, *calling), [len(kernels), sorted(slots.items())], text)
