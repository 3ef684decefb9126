"""Warnings in figures and on the page: which cases warn, and in which words that is told."""

from __future__ import annotations

import textwrap

import numpy as np

from screwsim.results import Results
from screwsim.results.warned import Kind, warned

NAME = "warnings"
LONGEST = 110  # letters of a warning in a caption


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
    (text,) = results.performance.texts_at(NAME, np.array([_number(results, index)]))
    return text.split("\n") if text else []


def _number(results: Results, index: tuple[int, ...]) -> int:
    return int(np.ravel_multi_index(index, results.shape)) if index else 0


def kinds(results: Results) -> tuple[Kind, ...]:
    """Return the kinds of warnings, the most frequent first."""
    return warned(results).kinds if NAME in results.performance else ()


def caption(warnings: list[str]) -> str:
    """Return what a figure of one case says of its warnings; empty without any."""
    if not warnings:
        return ""
    first = textwrap.shorten(warnings[0], LONGEST, placeholder=" …")  # between words: half a number is another one
    return f"{len(warnings)} warnings, the first: {first}" if len(warnings) > 1 else f"warning: {first}"
