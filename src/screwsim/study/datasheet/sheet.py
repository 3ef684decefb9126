"""A data sheet of any kind, in words: what is printed, and drawn on a page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Curve:
    """A curve to draw: the meaning of both axes with their units, and points."""

    x_label: str
    y_label: str
    x: Sequence[float]
    y: Sequence[float]


@dataclass(frozen=True)
class Sheet:
    """A data sheet: a heading, lines of (what, value), a table, what is judged, notes, curves.

    `document` is the same for programs, SI units; `ok` tells that all points closed. `verdict` holds (what, text,
    whether it is good or None).
    """

    heading: str
    title: str
    lines: Sequence[tuple[str, str]]
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    verdict: tuple[str, str, bool | None] | None
    notes: Sequence[str]
    curves: Sequence[Curve] = ()
    document: Mapping[str, Any] = field(default_factory=dict)
    ok: bool = True
