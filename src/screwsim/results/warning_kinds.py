"""Warnings of the cases of a results file: which cases warn, and the kinds of warnings with their numbers of cases."""

import math
import re
import textwrap
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from screwsim.results.read import Results

NAME = "warnings"
LONGEST = 110  # characters of a warning in a caption
_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


class WarningKind(NamedTuple):
    """Warnings that differ only in their numbers: how many cases have them, the first such case, and its text."""

    cases: int
    first: int
    text: str


def kind_of(warning: str) -> str:
    """Return a warning with its numbers masked, so that warnings that differ only in these are equal."""
    return _NUMBER.sub("#", warning)


def kinds_of(every: Iterable[Iterable[str]]) -> tuple[tuple[int, str], ...]:
    """Return the kinds of warnings of results, each with the number of results and the first text."""
    found: dict[str, tuple[int, str]] = {}
    for warnings in every:
        for kind, text in {kind_of(text): text for text in warnings}.items():
            count, first = found.get(kind, (0, text))
            found[kind] = count + 1, first
    return tuple(sorted(found.values(), key=lambda each: -each[0]))


def _texts(results: Results) -> tuple[list[str], np.ndarray]:
    """Return the distinct warnings of the cases of a file, and the index of each case's; older files have none."""
    none = [""], np.zeros(math.prod(results.shape), np.int32)
    return results.performance.texts(NAME) if NAME in results.performance else none


def warnings_of_cases(results: Results) -> list[list[str]]:
    """Return the warnings of each case of a file, in the order of the cases."""
    words, number = _texts(results)
    return [words[each].split("\n") if words[each] else [] for each in number.tolist()]


def warning_kinds(results: Results) -> tuple[WarningKind, ...]:
    """Return the kinds of warnings of the cases of a file, the most frequent first."""
    words, number = _texts(results)
    found: dict[str, WarningKind] = {}
    there = (column.tolist() for column in np.unique(number, return_index=True, return_counts=True))
    for place, first, count in zip(*there, strict=True):
        for mask, text in {kind_of(line): line for line in reversed(words[place].split("\n")) if line}.items():
            known = found.get(mask, WarningKind(0, first, text))
            earlier = known if known.first < first else WarningKind(0, first, text)
            found[mask] = WarningKind(known.cases + count, earlier.first, earlier.text)
    return tuple(sorted(found.values(), key=lambda kind: (-kind.cases, kind.first, kind.text)))


def cases_with_warnings(results: Results) -> np.ndarray:
    """Return which cases warn, on the axes of the results; none for a file without warnings."""
    words, numbers = _texts(results)
    return np.array([bool(word) for word in words])[numbers].reshape(results.shape)


def warnings_of(results: Results, index: tuple[int, ...]) -> list[str]:
    """Return the warnings of one case."""
    words, numbers = _texts(results)
    text = words[numbers[np.ravel_multi_index(index, results.shape) if index else 0]]
    return text.split("\n") if text else []


def warning_caption(warnings: list[str]) -> str:
    """Return the caption on warnings in a figure of one case; empty without any."""
    if not warnings:
        return ""
    first = textwrap.shorten(warnings[0], LONGEST, placeholder=" …")  # between words, as half a number misleads
    return f"{len(warnings)} warnings, the first: {first}" if len(warnings) > 1 else f"warning: {first}"
