"""What the cases of a results file warn of: which do, in which words, and the kinds with their numbers of cases."""

import re
import textwrap
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from screwsim.results.read import Results

NAME = "warnings"
LONGEST = 110  # letters of a warning in a caption
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


def kind_of(warning: str) -> str:
    """Return what warnings have in common that differ by their numbers alone."""
    return _NUMBER.sub("#", warning)


def kinds_of(every: Iterable[Iterable[str]]) -> tuple[tuple[int, str], ...]:
    """Return the kinds that results warn of, each with the number of results and the words of the first one."""
    found: dict[str, tuple[int, str]] = {}
    for warnings in every:
        for kind, text in {kind_of(text): text for text in warnings}.items():
            count, first = found.get(kind, (0, text))
            found[kind] = count + 1, first
    return tuple(sorted(found.values(), key=lambda each: -each[0]))


def warned(results: Results) -> Warned:
    """Return what the cases of a file warn of."""
    words, number = results.performance.texts(NAME)
    counts, firsts = np.bincount(number, minlength=len(words)), _firsts(number, len(words))
    found: dict[str, Kind] = {}
    told = 0
    for word, count, first in zip(words, counts.tolist(), firsts, strict=True):
        if not word or not count:
            continue
        told += count
        for mask, text in {kind_of(line): line for line in reversed(word.split("\n"))}.items():
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


def warns(results: Results) -> np.ndarray:
    """Return which cases warn, on the axes of the results; none of a file that keeps no warnings."""
    if NAME not in results.performance:
        return np.zeros(results.shape, bool)
    words, numbers = results.performance.texts(NAME)
    return np.array([bool(word) for word in words])[numbers].reshape(results.shape)


def warnings_of(results: Results, index: tuple[int, ...]) -> list[str]:
    """Return what one case warns of."""
    if NAME not in results.performance:
        return []
    number = int(np.ravel_multi_index(index, results.shape)) if index else 0
    (text,) = results.performance.texts_at(NAME, np.array([number]))
    return text.split("\n") if text else []


def kinds(results: Results) -> tuple[Kind, ...]:
    """Return the kinds of warnings, the most frequent first."""
    return warned(results).kinds if NAME in results.performance else ()


def caption(warnings: list[str]) -> str:
    """Return what a figure of one case says of its warnings; empty without any."""
    if not warnings:
        return ""
    first = textwrap.shorten(warnings[0], LONGEST, placeholder=" …")  # between words: half a number is another one
    return f"{len(warnings)} warnings, the first: {first}" if len(warnings) > 1 else f"warning: {first}"
