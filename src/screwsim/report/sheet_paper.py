"""A4 pages filled from top to bottom: positions are computed first, and matplotlib draws when all are known."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import accumulate
from typing import Any, NamedTuple

from screwsim.report.style import DPI, GREY, MM, new_figure
from screwsim.version import version

WIDE, HIGH = 210.0, 297.0  # [mm] size of a page
MARGIN = 12.0  # [mm] margin
POINT_SIZE = 1.0 / (72.0 * MM)  # [mm]
LEAST_PT = 6.5  # [pt] smallest type
LINE, FALL = 1.28, 0.25  # of the font size: line spacing, and depth of letters below the baseline
_UNIT = re.compile(r"(?<=\d) (?=[^\s\d])")
_FIXED = "\u00a0"  # no-break space
TEXT, PAGE = WIDE - 2.0 * MARGIN, HIGH - 2.0 * MARGIN  # [mm] width and height of the text area of a page
TABLE_GAP = 8.0  # [mm] between tables
COLUMN_GAP = 1.1  # of the font size: between columns
ABOVE, RULE = 1.35, 0.55  # of a line: space above a title, and around the rule below the heads


@lru_cache(maxsize=8192)
def width_of(words: str, size: float, bold: bool = False) -> float:
    """Return the width [mm] of words in a font size [pt]."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal", size=size)
    return text_to_path.get_text_width_height_descent(words, font, False)[0] * POINT_SIZE


def wrapped(words: str, width: float, size: float, bold: bool = False) -> list[str]:
    """Return words broken into lines of a width [mm]; numbers stay with their units, too long words are broken."""
    rows: list[str] = []
    for word in _UNIT.sub(_FIXED, words).split(" "):
        longer = f"{rows[-1]} {word}" if rows else word
        if rows and width_of(longer, size, bold) <= width:
            rows[-1] = longer
        else:
            rows += _pieces(word, width, size, bold)
    return rows or [""]


def _pieces(word: str, width: float, size: float, bold: bool) -> Iterator[str]:
    """Yield a word, in pieces if it is wider than the line."""
    while len(word) > 1 and width_of(word, size, bold) > width:
        fits = next((n for n in range(len(word) - 1, 1, -1) if width_of(word[:n], size, bold) <= width), 1)
        yield word[:fits]
        word = word[fits:]
    yield word


@dataclass
class Paper:
    """Pages so far, each a list of calls that draw it; `at` is the filled height [mm] of the last; `size` in [pt]."""

    title: str
    size: float
    pages: list[list[Callable[[Any], None]]] = field(default_factory=list)
    at: float = HIGH

    @property
    def line(self) -> float:
        """Height [mm] of a line of text."""
        return self.size * LINE * POINT_SIZE

    @property
    def left(self) -> float:
        """Remaining height [mm] of the last page."""
        return HIGH - MARGIN - self.at

    def room(self, height: float) -> None:
        """Begin a new page if this one has less than that height left."""
        if height > self.left or not self.pages:
            self.pages.append([])
            self.at = MARGIN

    def down(self, height: float) -> None:
        """Leave a height free."""
        self.at += height

    def draw(self, call: Callable[[Any], None]) -> None:
        """Add a call that draws on the figure of the last page."""
        self.pages[-1].append(call)

    def text(self, x: float, words: str, size: float = 0.0, bold: bool = False, **look: Any) -> None:
        """Write words at x [mm] from the left edge, at the filled height of the page."""
        if words:
            where = x / WIDE, 1.0 - self.at / HIGH
            look = {"fontsize": size or self.size, "va": "baseline", **look} | ({"weight": "bold"} if bold else {})
            self.draw(lambda figure: figure.text(*where, words, parse_math=False, **look))

    def rule(self, x: float, y: float, width: float, **look: Any) -> None:
        """Draw a horizontal line from x, y [mm], counted from the left and upper edges."""
        ends = [x / WIDE, (x + width) / WIDE], [1.0 - y / HIGH] * 2
        look = {"color": GREY, "linewidth": 0.4, **look}

        def call(figure: Any) -> None:
            from matplotlib.lines import Line2D

            figure.add_artist(Line2D(*ends, **look))

        self.draw(call)

    def paragraph(self, words: str, **look: Any) -> None:
        """Write words in lines as wide as the text, on the next page when this one is full."""
        size = look.get("size") or self.size
        for row in wrapped(words, TEXT, size, look.get("bold", False)):
            high = size * LINE * POINT_SIZE
            self.room(high)
            self.down(high)
            self.text(MARGIN, row, **look)

    def figures(self) -> list[Any]:
        """Return the pages as figures, with their footers."""
        return [self._figure(number) for number in range(len(self.pages))]

    def _figure(self, number: int) -> Any:
        figure = new_figure(WIDE, HIGH, "none")
        figure.set_dpi(DPI)  # drawings are fitted by the widths of their letters, in whole pixels
        for call in self.pages[number]:
            call(figure)
        tail = f"  ·  screwsim {version()}"
        tail += f"  ·  page {number + 1} of {len(self.pages)}" if len(self.pages) > 1 else ""
        title, *more = wrapped(self.title, WIDE - 2.0 * MARGIN - width_of(tail + " …", LEAST_PT), LEAST_PT)
        foot = f"{title}{' …' if more else ''}{tail}"
        figure.text(MARGIN / WIDE, 0.5 * MARGIN / HIGH, foot, fontsize=LEAST_PT, color=GREY, parse_math=False)
        return figure


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
        words = (width_of(word, size) for word in _UNIT.sub(_FIXED, head).split(" "))
        least.append(max(cells, *words) + (gap if i else 0.0))
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
