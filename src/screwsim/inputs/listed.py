"""Texts that a program passes: several, or one alone."""

from collections.abc import Iterable
from typing import TypeVar

T = TypeVar("T")


def listed(given: str | Iterable[T] | None) -> list[str] | list[T]:
    """Return what is given as a list; of one text, which is an iterable of its letters, that text alone."""
    return [] if given is None else [given] if isinstance(given, str) else list(given)
