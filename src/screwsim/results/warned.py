"""What the cases of a results file warn of: how many do, and the kinds of warning with their numbers of cases."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from screwsim.results.read import Results

_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


class Kind(NamedTuple):
    """Warnings that differ by their numbers alone: of how many cases, which is the first, and what that one says."""

    cases: int
    first: int
    text: str


class Warned(NamedTuple):
    """How many cases warn, and the kinds of their warnings, the most frequent first."""

    cases: int
    kinds: tuple[Kind, ...]


def warned(results: Results) -> Warned:
    """Return what the cases of a file warn of."""
    words, number = results.performance.texts("warnings")
    counts, firsts = np.bincount(number, minlength=len(words)), _firsts(number, len(words))
    found: dict[str, Kind] = {}
    told = 0
    for word, count, first in zip(words, counts.tolist(), firsts, strict=True):
        if not word or not count:
            continue
        told += count
        for mask, text in {_NUMBER.sub("#", line): line for line in reversed(word.split("\n"))}.items():
            known = found.get(mask, Kind(0, first, text))
            earlier = known if known.first < first else Kind(0, first, text)
            found[mask] = Kind(known.cases + count, earlier.first, earlier.text)
    return Warned(told, tuple(sorted(found.values(), key=lambda kind: (-kind.cases, kind.first, kind.text))))


def _firsts(number: np.ndarray, words: int) -> list[int]:
    """Return the first case of each word; the number of cases for a word without any."""
    firsts = np.full(words, number.size)
    found, places = np.unique(number, return_index=True)
    firsts[found] = places
    return firsts.tolist()
