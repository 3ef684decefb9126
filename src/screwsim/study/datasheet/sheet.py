"""A data sheet of any kind, in words: what is printed, and drawn on a page."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from screwsim.inputs.suggestions import counted
from screwsim.outputs.display import grouped
from screwsim.results.warning_kinds import kind_of

MOST_PLACES = 36  # of a warning that are named; of more their number is given
COLUMNS, LETTERS = 7, 11  # limits of a table that leaves room for another one beside it


@dataclass(frozen=True)
class Table:
    """A table of a sheet: title, heads and rows, a note below it; the first `left` columns are words."""

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""
    left: int = 0
    across: bool = False

    @property
    def wide(self) -> bool:
        """Whether it needs the full width of a page: by request, by its columns, or by long cells."""
        return self.across or len(self.heads) > COLUMNS or any(len(cell) > LETTERS for row in self.rows for cell in row)


@dataclass(frozen=True)
class Curve:
    """A curve to draw: its points, and its name where there are several."""

    x: Sequence[float]
    y: Sequence[float]
    name: str = ""


@dataclass(frozen=True)
class Drawing:
    """Curves in one diagram: a title, the labels of both axes with units; `from_zero` applies to the x axis."""

    title: str
    x_label: str
    y_label: str
    curves: Sequence[Curve]
    from_zero: bool = False


@dataclass(frozen=True)
class Sheet:
    """A data sheet: a heading, lines of (what, value), tables, a verdict, notes, drawings.

    `document` is the same for programs, in SI units; `ok` means that all points closed. `verdict` holds (what, text,
    whether it is good or None).
    """

    heading: str
    title: str
    lines: Sequence[tuple[str, str]]
    tables: Sequence[Table]
    verdict: tuple[str, str, bool | None] | None = None
    notes: Sequence[str] = ()
    drawings: Sequence[Drawing] = ()
    document: Mapping[str, Any] = field(default_factory=dict)
    ok: bool = True


def disclaimer(standards: str) -> str:
    """Return the note that a sheet is not a measurement by standards."""
    return f"computed, not measured: no tolerance of {standards} applies, and no third party verified it"


def warning_lines(points: Sequence[tuple[str, Sequence[str]]], among: int = 0) -> Iterator[str]:
    """Yield the warnings of a sheet's points, (where, warnings) each; those that differ only by numbers once.

    The first of them is given, with its place unless it holds for every point, and the other points. There are `among`
    points in all, by default those given.
    """
    among = among or len(points)
    found = grouped((kind_of(text), (where, text)) for where, warnings in points for text in warnings)
    for (where, text), *others in found.values():
        if not others:
            yield f"{where}: {text}" if among > 1 else text
        elif all(other == text for _, other in others) and len(others) + 1 == among:
            yield text
        elif len(others) <= MOST_PLACES:
            yield f"{where}: {text} (the same at {', '.join(place for place, _ in others)})"
        else:
            yield f"{where}: {text} (the same at {counted(len(others), 'more point')})"
