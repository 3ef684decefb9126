"""A data sheet as PDF: pages of A4, from top to bottom, drawn by matplotlib."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from screwsim.report.datasheet import WORDS
from screwsim.report.style import COLOURS, DASHES, GREY, journal, new_figure, plain_ticks
from screwsim.results.atomic import replacing
from screwsim.version import version

WIDE, HIGH = 210.0, 297.0  # [mm] of a page
EDGE, GUTTER = 16.0, 10.0
LINE = 4.2  # of a line of text, of SIZE points
SIZE, TITLE, HEAD = 8.0, 13.0, 9.5  # [pt]
EM = 0.53 * SIZE * 25.4 / 72.0  # [mm] mean width of a letter
DRAWN = 54.0  # height of a drawing, its legend with it
ABREAST, DRAWINGS = 2, 3  # narrow tables, and drawings where there are so many
MOST_ROWS = 30  # that a table keeps together
BOLD, FOOT = 0.21, 80  # [mm] mean width of a bold letter a point; letters of the title at the foot of a page
NAMES = 26.0  # [mm] of the names of the lines
LETTERS = int((WIDE - 2.0 * EDGE) / EM)


@dataclass
class Paper:
    """The pages so far, and how far down [mm] the last one is filled."""

    title: str
    pages: list[Any] = field(default_factory=list)
    at: float = HIGH

    def room(self, height: float) -> None:
        """Begin a new page where that height is not left on this one."""
        if self.at + height > HIGH - EDGE:
            figure = new_figure(WIDE, HIGH)
            figure.set_layout_engine("none")
            self.pages.append(figure)
            self.at = EDGE
            title = textwrap.shorten(self.title, FOOT, placeholder=" …")
            foot = f"{title}  ·  screwsim {version()}  ·  page {len(self.pages)}"
            self.text(EDGE, HIGH - 0.5 * EDGE, foot, size=6.5, color=GREY)

    def text(self, x: float, y: float, words: str, size: float = SIZE, **look: Any) -> None:
        """Write words at x, y [mm] from the left and upper edges of the last page."""
        self.pages[-1].text(x / WIDE, 1.0 - y / HIGH, words, fontsize=size, va="baseline", **look)

    def rule(self, x: float, y: float, width: float) -> None:
        """Draw a thin line across."""
        from matplotlib.lines import Line2D

        ends = [x / WIDE, (x + width) / WIDE], [1.0 - y / HIGH] * 2
        self.pages[-1].add_artist(Line2D(*ends, color=GREY, linewidth=0.4))

    def down(self, height: float) -> None:
        """Leave a height free."""
        self.at += height


def write_pdf(sheet: Any, output: Path) -> str:
    """Write a data sheet as PDF and return its path; raise UsageError in one line when the system refuses."""
    from matplotlib.backends.backend_pdf import PdfPages

    nameless: dict[str, Any] = {"Creator": "screwsim", "Producer": None, "CreationDate": None}
    with journal(), replacing(output) as temporary:
        pages = pages_of(sheet)
        with PdfPages(temporary, metadata={**nameless, "Title": sheet.title or sheet.heading}) as book:
            for page in pages:
                book.savefig(page)
    return str(output)


def pages_of(sheet: Any) -> list[Any]:
    """Return the pages of a data sheet, as figures."""
    paper = Paper(sheet.title or sheet.heading)
    paper.room(HIGH)
    paper.down(6.0)
    _paragraph(paper, sheet.title or sheet.heading, TITLE, 6.5, weight="bold")
    _paragraph(paper, sheet.heading, SIZE, LINE, color=GREY)
    paper.down(2.0)
    for name, words in sheet.lines:
        _line(paper, name, words)
    for tables in _beside(sheet.tables):
        _tables(paper, tables)
    abreast = DRAWINGS if len(sheet.drawings) == DRAWINGS else ABREAST
    for i in range(0, len(sheet.drawings), abreast):
        _drawings(paper, sheet.drawings[i : i + abreast], abreast)
    if sheet.verdict is not None:
        what, words, good = sheet.verdict
        _heading(paper, what, 2.0 * LINE)
        _paragraph(paper, f"{WORDS[good]}: {words}", SIZE, LINE)
    _heading(paper, "Notes", LINE)
    for note in sheet.notes:
        _paragraph(paper, f"– {note}", SIZE, LINE, indent="  ")
    return paper.pages


def _heading(paper: Paper, words: str, with_it: float) -> None:
    paper.room(9.0 + with_it)
    paper.down(7.0)
    paper.text(EDGE, paper.at, words, HEAD, weight="bold")
    paper.down(2.0)


def _paragraph(paper: Paper, words: str, size: float, line: float, indent: str = "", **look: Any) -> None:
    for row in textwrap.wrap(words, int(LETTERS * SIZE / size), subsequent_indent=indent):
        paper.room(line)
        paper.down(line)
        paper.text(EDGE, paper.at, row, size, **look)


def _line(paper: Paper, name: str, words: str) -> None:
    rows = textwrap.wrap(words, int((WIDE - 2.0 * EDGE - NAMES) / EM)) or [""]
    paper.room(LINE * len(rows))
    for number, row in enumerate(rows):
        paper.down(LINE)
        if number == 0:
            paper.text(EDGE, paper.at, name, color=GREY)
        paper.text(EDGE + NAMES, paper.at, row)


# ---- tables ------------------------------------------------------------------------------------------------------


def _beside(tables: Sequence[Any]) -> Iterator[list[Any]]:
    """Yield tables in twos where they are narrow, alone where they are wide."""
    waiting: list[Any] = []
    for table in tables:
        if waiting and (table.wide or len(waiting) == ABREAST):
            yield waiting
            waiting = []
        waiting.append(table)
        if table.wide:
            yield waiting
            waiting = []
    if waiting:
        yield waiting


def _tables(paper: Paper, tables: Sequence[Any]) -> None:
    width = WIDE - 2.0 * EDGE if tables[0].wide else 0.5 * (WIDE - 2.0 * EDGE - GUTTER)
    paper.room(12.0 + LINE * max(min(len(table.rows), MOST_ROWS) + 3 for table in tables))
    top, lowest = paper.at, paper.at
    for number, table in enumerate(tables):
        paper.at = top
        _table(paper, table, EDGE + number * (width + GUTTER), width)
        lowest = max(lowest, paper.at)
    paper.at = lowest


def _table(paper: Paper, table: Any, x: float, width: float) -> None:
    paper.down(7.0)
    paper.text(x, paper.at, table.title, HEAD, weight="bold")
    rights = _rights(table, x, width)
    heads = [textwrap.wrap(head, 11, break_long_words=False) or [""] for head in table.heads]
    deep = max(map(len, heads))
    for k in range(deep):
        paper.down(LINE)
        _cells(paper, table, [([""] * (deep - len(head)) + head)[k] for head in heads], x, rights, color=GREY)
    paper.rule(x, paper.at + 1.2, width)
    paper.down(0.8)
    for row in table.rows:
        paper.room(LINE)
        paper.down(LINE)
        _cells(paper, table, row, x, rights)
    if table.note:
        for words in textwrap.wrap(table.note, int(width / EM)):
            paper.down(LINE)
            paper.text(x, paper.at, words, 7.0, color=GREY)


def _rights(table: Any, x: float, width: float) -> list[float]:
    """Return the right edge [mm] of each column, in proportion to the letters that it holds."""
    letters = []
    for i, head in enumerate(table.heads):
        longest = max(map(len, textwrap.wrap(head, 11, break_long_words=False)), default=1)
        letters.append(2 + max([longest, *(len(row[i]) for row in table.rows)]))
    share, rights = width / sum(letters), []
    for count in letters:
        rights.append((rights[-1] if rights else x) + share * count)
    return rights


def _cells(paper: Paper, table: Any, cells: Sequence[str], x: float, rights: Sequence[float], **look: Any) -> None:
    for i, cell in enumerate(cells):
        if i < table.left:
            paper.text(x if i == 0 else rights[i - 1] + 2.0, paper.at, cell, **look)
        else:
            paper.text(rights[i], paper.at, cell, ha="right", **look)


# ---- drawings ----------------------------------------------------------------------------------------------------


def _drawings(paper: Paper, drawings: Sequence[Any], abreast: int) -> None:
    paper.room(DRAWN + 12.0)
    paper.down(7.0)
    width = (WIDE - 2.0 * EDGE - (abreast - 1) * GUTTER) / abreast
    for number, one in enumerate(drawings):
        x = EDGE + number * (width + GUTTER)
        paper.text(x, paper.at, one.title, min(HEAD, width / (BOLD * len(one.title))), weight="bold")
        legend = 6.0 if any(curve.name for curve in one.curves) else 0.0
        left, low = x + 11.0, paper.at + 3.0 + DRAWN - 11.0
        box = left / WIDE, 1.0 - low / HIGH, (width - 11.0) / WIDE, (DRAWN - 13.0 - legend) / HIGH
        _draw(paper.pages[-1].add_axes(box), one)
    paper.down(DRAWN + 3.0)


def _draw(axes: Any, one: Any) -> None:
    for i, curve in enumerate(one.curves):
        look = {"color": COLOURS[i % len(COLOURS)], "linestyle": DASHES[i % len(DASHES)]}
        axes.plot(curve.x, curve.y, marker="o", markersize=2.2, linewidth=0.9, label=curve.name or None, **look)
    axes.set_xlabel(one.x_label)
    if one.y_label != one.title:
        axes.set_ylabel(one.y_label)
    if one.from_zero:
        axes.set_xlim(left=0.0)
    plain_ticks(axes.xaxis, axes.yaxis)
    if any(curve.name for curve in one.curves):
        above = {"loc": "lower left", "bbox_to_anchor": (-0.02, 1.01), "ncols": 6}
        axes.legend(fontsize=6.0, handlelength=1.3, columnspacing=0.7, handletextpad=0.3, **above)
