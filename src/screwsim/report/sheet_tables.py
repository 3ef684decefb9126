"""Tables of a data sheet on paper: side by side where their widths allow, split where too long."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import accumulate
from typing import Any, NamedTuple

from screwsim.report.sheet_paper import FALL, HIGH, MARGIN, POINT_SIZE, WIDE, Paper, width_of, wrapped
from screwsim.report.style import GREY

TEXT, PAGE = WIDE - 2.0 * MARGIN, HIGH - 2.0 * MARGIN  # [mm] width and height of the text area of a page
TABLE_GAP = 8.0  # [mm] between tables
COLUMN_GAP = 1.1  # of the font size: between columns
ABOVE, RULE = 1.35, 0.55  # of a line: space above a title, and around the rule below the heads


class Columns(NamedTuple):
    """The columns of a table in a font size: their heads in lines, and their widths [mm]."""

    heads: list[list[str]]
    widths: list[float]

    @property
    def deep(self) -> int:
        """Return the number of lines of the heads."""
        return max(map(len, self.heads))

    @property
    def width(self) -> float:
        """Return the total width [mm]."""
        return sum(self.widths)


def columns_of(table: Any, size: float, width: float = 0.0) -> Columns:
    """Return the columns of a table, spread over a width [mm] if that is more than they need.

    A column has room for its cells and for the longest word of its head, which is broken into lines.
    """
    gap, least = gap_of(size), []
    for i, head in enumerate(table.heads):
        cells = max((width_of(row[i], size) for row in table.rows), default=0.0)
        least.append(max(cells, *(width_of(word, size) for word in head.split(" "))) + (gap if i else 0.0))
    share = max(width / sum(least), 1.0)
    widths = [share * each for each in least]
    rooms = (each - (gap if i else 0.0) + 0.01 for i, each in enumerate(widths))
    return Columns([wrapped(head, room, size) for head, room in zip(table.heads, rooms, strict=True)], widths)


def gap_of(size: float) -> float:
    """Return the space [mm] between columns."""
    return COLUMN_GAP * size * POINT_SIZE


def tables_on(paper: Paper, tables: Sequence[Any]) -> None:
    """Write tables, as many side by side as their widths allow."""
    pieces = [piece for table in tables for piece in _narrowed(table, paper.size)]
    for shelf in _rows_of_tables(pieces, paper.size):
        _row_of_tables(paper, shelf)


def _narrowed(table: Any, size: float) -> Iterator[Any]:
    """Yield a table, split into ones of fewer columns if wider than the page; each repeats the first column."""
    widths = columns_of(table, size).widths
    kept, filled = [0], widths[0]
    for i in range(1, len(widths)):
        if len(kept) > 1 and filled + widths[i] > TEXT:
            yield _columns_of_table(table, kept)
            table, kept, filled = _continued(table), [0], widths[0]
        kept.append(i)
        filled += widths[i]
    yield _columns_of_table(table, kept)


def _columns_of_table(table: Any, kept: Sequence[int]) -> Any:
    if len(kept) == len(table.heads):
        return table
    rows = [[row[i] for i in kept] for row in table.rows]
    return replace(table, heads=[table.heads[i] for i in kept], rows=rows)


def _continued(table: Any) -> Any:
    return replace(table, title=f"{table.title.removesuffix(', continued')}, continued")


def _rows_of_tables(tables: Sequence[Any], size: float) -> Iterator[list[Any]]:
    shelf: list[Any] = []
    filled = 0.0
    for table in tables:
        width = columns_of(table, size).width
        if shelf and filled + TABLE_GAP + width > TEXT:
            yield shelf
            shelf, filled = [], 0.0
        filled += width + (TABLE_GAP if shelf else 0.0)
        shelf.append(table)
    if shelf:
        yield shelf


def _row_of_tables(paper: Paper, tables: Sequence[Any]) -> None:
    """Write tables side by side, splitting those that are longer than a page."""
    widths = _widths([columns_of(table, paper.size).width for table in tables])
    heights = [_height(paper, table, width) for table, width in zip(tables, widths, strict=True)]
    if max(heights) > PAGE:
        paper.room(0.5 * PAGE)
        over = int((max(heights) - paper.left) / paper.line) + 1
        rows = max(len(table.rows) for table in tables) - over
        _row_of_tables(paper, [replace(table, rows=table.rows[:rows]) for table in tables])
        longer = (table for table in tables if len(table.rows) > rows)
        _row_of_tables(paper, [_continued(replace(table, rows=table.rows[rows:])) for table in longer])
        return
    paper.room(max(heights))
    top, x = paper.at, MARGIN
    for table, width in zip(tables, widths, strict=True):
        paper.at = top
        _table(paper, table, x, width)
        x += width + TABLE_GAP
    paper.at = top + max(heights)


def _widths(least: Sequence[float]) -> list[float]:
    """Return the widths [mm] of tables in one row: equal if that suffices, else with the remaining space shared."""
    left = TEXT - TABLE_GAP * (len(least) - 1)
    equal = left / max(len(least), 2) - (0.5 * TABLE_GAP if len(least) == 1 else 0.0)
    if max(least) <= equal:
        return [equal] * len(least)
    return [width + (left - sum(least)) / len(least) for width in least]


def _note_fits_beside_title(table: Any, width: float, size: float) -> bool:
    """Tell whether a note fits on the line of the title."""
    return width_of(table.title, size, bold=True) + width_of(table.note, size) + 4.0 <= width


def _height(paper: Paper, table: Any, width: float) -> float:
    deep, size = columns_of(table, paper.size, width).deep, paper.size
    lines = len(wrapped(table.title, width, size, bold=True)) + deep + len(table.rows)
    if table.note and not _note_fits_beside_title(table, width, size):
        lines += len(wrapped(table.note, width, size))
    return paper.line * (lines + ABOVE - 1.0 + RULE + 0.35)


def _table(paper: Paper, table: Any, x: float, width: float) -> None:
    size = paper.size
    paper.down((ABOVE - 1.0) * paper.line)
    for words in wrapped(table.title, width, size, bold=True):
        paper.down(paper.line)
        paper.text(x, words, bold=True)
    above = table.note and _note_fits_beside_title(table, width, size)
    if above:
        paper.text(x + width, table.note, ha="right", color=GREY)
    columns = columns_of(table, size, width)
    rights = [x + edge for edge in accumulate(columns.widths)]
    paper.down(0.15 * paper.line)
    for k in range(columns.deep):
        paper.down(paper.line)
        _cells(paper, table, [([""] * (columns.deep - len(h)) + h)[k] for h in columns.heads], x, rights, color=GREY)
    paper.rule(x, paper.at + 1.2 * FALL * size * POINT_SIZE, width)
    paper.down(0.4 * paper.line)
    for row in table.rows:
        paper.down(paper.line)
        _cells(paper, table, row, x, rights)
    if table.note and not above:
        for words in wrapped(table.note, width, size):
            paper.down(paper.line)
            paper.text(x, words, color=GREY)


def _cells(paper: Paper, table: Any, cells: Sequence[str], x: float, rights: Sequence[float], **look: Any) -> None:
    for i, cell in enumerate(cells):
        if i < table.left:
            paper.text(x if i == 0 else rights[i - 1] + gap_of(paper.size), cell, **look)
        else:
            paper.text(rights[i], cell, ha="right", **look)
