"""Texts of kernels that were written before: read from the cache folder, found by all that they are made of."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from screwsim.numerics import sources, store
from screwsim.numerics.kernel import HEADER, Kernel, flatten, spelled

NO_SLOTS: Mapping[str, str] = MappingProxyType({})


def kept_text(by: Sequence[str], kernels: Iterable[Kernel], of: Sequence[Any], write: Callable[[], str]) -> str:
    """Return the text that `write` returns, as it was kept, or written now and kept.

    It is made by code in the folders `by` of this package, of kernels and all that they use, and of what has one
    `repr`: an edit of any of these makes another text. How a tree is spelled is Python's matter, so its version counts.
    """
    parts = (sources.of_folders(*by), spelled(kernels), sys.version, *map(repr, of))
    name = f"screwsim_text_{hashlib.sha256(chr(0).join(parts).encode()).hexdigest()[:24]}"
    kept = store.read(name)
    if kept is not None:
        return kept.decode()
    text = write()
    store.keep(name, text.encode())
    return text


def flat_module(
    kernels: Sequence[Kernel], calling: Sequence[Kernel] = (), slots: Mapping[str, str] = NO_SLOTS
) -> str:
    """Return the text of a module of kernels, and of more of them, `calling` what fills their slots."""

    def text() -> str:
        found = flatten(kernels)
        found |= flatten(calling, slots)
        return "\n\n".join([HEADER, *found.values()]) + "\n"

    return kept_text(("numerics",), (*kernels, *calling), [len(kernels), sorted(slots.items())], text)
