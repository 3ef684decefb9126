"""A data sheet of any kind, in words: what is printed, and drawn on a page."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from screwsim.results.warned import kind_of

COLUMNS, LETTERS = 7, 11  # of a table beside which another has room


@dataclass(frozen=True)
class Table:
    """A table of a sheet: its title, a note below it, heads and rows; the first `left` columns are words."""

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""
    left: int = 0
    across: bool = False

    @property
    def wide(self) -> bool:
        """Tell whether it asks for the width of a page: by itself, by its columns, or by words in them."""
        return self.across or len(self.heads) > COLUMNS or any(len(cell) > LETTERS for row in self.rows for cell in row)


@dataclass(frozen=True)
class Curve:
    """A curve to draw: points, and its name where there are several."""

    x: Sequence[float]
    y: Sequence[float]
    name: str = ""


@dataclass(frozen=True)
class Drawing:
    """Curves over one another: a title, the meaning of both axes with their units; `from_zero` of the x axis."""

    title: str
    x_label: str
    y_label: str
    curves: Sequence[Curve]
    from_zero: bool = False


@dataclass(frozen=True)
class Sheet:
    """A data sheet: a heading, lines of (what, value), tables, what is judged, notes, drawings.

    `document` is the same for programs, SI units; `ok` tells that all points closed. `verdict` holds (what, text,
    whether it is good or None).
    """

    heading: str
    title: str
    lines: Sequence[tuple[str, str]]
    tables: Sequence[Table]
    verdict: tuple[str, str, bool | None] | None
    notes: Sequence[str]
    drawings: Sequence[Drawing] = ()
    document: Mapping[str, Any] = field(default_factory=dict)
    ok: bool = True


def told(points: Sequence[tuple[str, Sequence[str]]]) -> Iterator[str]:
    """Yield what points of a sheet warn of, (where, warnings) each: words that differ by their numbers alone once.

    Said is the first of them, with its place where it is not that of every point, and at how many others it is so.
    """
    found: dict[str, list[tuple[str, str]]] = {}
    for where, warnings in points:
        for text in warnings:
            found.setdefault(kind_of(text), []).append((where, text))
    for (where, text), *others in found.values():
        if not others:
            yield f"{where}: {text}" if len(points) > 1 else text
        elif all(other == text for _, other in others) and len(others) + 1 == len(points):
            yield text
        else:
            yield f"{where}: {text} (alike at {len(others)} more point{'s' if len(others) > 1 else ''})"
