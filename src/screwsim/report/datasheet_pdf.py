"""A data sheet as PDF: one A4 page in the largest type that fits, or several if even the smallest does not fit."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from screwsim.report.datasheet import VERDICT_WORDS
from screwsim.report.sheet_paper import (
    HIGH,
    LEAST_PT,
    MARGIN,
    POINT_SIZE,
    TABLE_GAP,
    TEXT,
    WIDE,
    Paper,
    tables_on,
    width_of,
    wrapped,
)
from screwsim.report.style import GREY, journal, line_style, plain_ticks
from screwsim.results.atomic import replacing

TITLE_SCALE = 1.6  # size of the title over that of the text
PLOT, MOST = 33.0, 54.0  # [mm] least and greatest height of a drawing without its title and legend
LEGEND_LINE = 4.5  # [mm] length of a line in a legend
TICK_DISTANCE = 9.0, 5.5  # [mm] least distance between ticks: horizontal, vertical
FITTED, NEAR = 6, 2e-4  # most iterations and tolerance (of the page) for fitting axes to a box, as ticks move


class Typesetting(NamedTuple):
    """Typesetting of a sheet: font size [pt], and number of drawings side by side."""

    size: float
    abreast: int


TYPESETTINGS = (
    Typesetting(8.0, 2),
    Typesetting(7.5, 2),
    Typesetting(7.5, 4),
    Typesetting(7.0, 4),
    Typesetting(LEAST_PT, 4),
)


def write_pdf(sheet: Any, output: Path) -> str:
    """Write a data sheet as PDF and return its path, with the number of pages if there is more than one.

    Raise UsageError in one line when the system refuses.
    """
    from matplotlib.backends.backend_pdf import PdfPages

    nameless: dict[str, Any] = {"Creator": "screwsim", "Producer": None, "CreationDate": None}
    with journal(), replacing(output) as temporary:
        pages = pages_of(sheet)
        with PdfPages(temporary, metadata={**nameless, "Title": sheet.title or sheet.heading}) as book:
            for page in pages:
                book.savefig(page)
    if len(pages) == 1:
        return str(output)
    why = f"one page cannot hold that much in type of {LEAST_PT:g} pt; ask for fewer points"
    return f"{output} ({len(pages)} pages: {why})"


def pages_of(sheet: Any) -> list[Any]:
    """Return the pages of a data sheet as figures; drawings fill the remaining height."""
    papers: list[tuple[Paper, Typesetting]] = []
    for form in TYPESETTINGS:
        papers.append((_typeset(sheet, form, PLOT), form))
        if len(papers[-1][0].pages) == 1:
            break
    paper, form = min(papers, key=lambda each: len(each[0].pages))
    count = -(-len(sheet.drawings) // _side_by_side(sheet, form)) if sheet.drawings else 0
    if count:
        higher = _typeset(sheet, form, min(MOST, PLOT + (paper.left - 0.1) / count))
        paper = higher if len(higher.pages) == len(paper.pages) else paper
    return paper.figures()


def _typeset(sheet: Any, form: Typesetting, plot: float) -> Paper:
    """Return a sheet typeset in a form, with drawings of height `plot` [mm]."""
    paper = Paper(sheet.title or sheet.heading, form.size)
    paper.room(HIGH)
    paper.paragraph(sheet.title or sheet.heading, size=TITLE_SCALE * form.size, bold=True)
    paper.paragraph(sheet.heading, color=GREY)
    paper.down(0.5 * paper.line)
    names = max((width_of(name, form.size) for name, _ in sheet.lines), default=0.0) + 4.0
    for name, words in sheet.lines:
        _line(paper, name, words, names)
    tables_on(paper, sheet.tables)
    abreast = _side_by_side(sheet, form)
    for i in range(0, len(sheet.drawings), abreast):
        _drawings(paper, sheet.drawings[i : i + abreast], abreast, plot)
    if sheet.verdict is not None:
        what, words, good = sheet.verdict
        _heading(paper, what)
        paper.paragraph(words if VERDICT_WORDS[good] in words else f"{VERDICT_WORDS[good]}: {words}")
    if sheet.notes:
        _heading(paper, "Notes")
        for note in sheet.notes:
            paper.paragraph(f"– {note}")
    return paper


def _side_by_side(sheet: Any, form: Typesetting) -> int:
    count = len(sheet.drawings)
    return form.abreast if count > 3 else max(count, 2)


def _heading(paper: Paper, words: str) -> None:
    paper.room(3.4 * paper.line)
    paper.down(0.4 * paper.line)
    paper.paragraph(words, bold=True)


def _line(paper: Paper, name: str, words: str, names: float) -> None:
    for number, row in enumerate(wrapped(words, TEXT - names, paper.size)):
        paper.room(paper.line)
        paper.down(paper.line)
        if number == 0:
            paper.text(MARGIN, name, color=GREY)
        paper.text(MARGIN + names, row)


def _drawings(paper: Paper, drawings: Sequence[Any], abreast: int, plot: float) -> None:
    width = (TEXT - (abreast - 1) * TABLE_GAP) / abreast
    titles = [wrapped(drawing.title, width, paper.size, bold=True) for drawing in drawings]
    legends = [_legend(drawing, width, paper.size) for drawing in drawings]
    deep, rows = max(map(len, titles)), max(legend[-1][2] + 1 if legend else 0 for legend in legends)
    above = (deep + rows + 0.7) * paper.line + (1.5 if rows else 0.0)
    paper.room(above + plot)
    top = paper.at
    for number, (one, title, legend) in enumerate(zip(drawings, titles, legends, strict=True)):
        x = MARGIN + number * (width + TABLE_GAP)
        paper.at = top + 0.35 * paper.line
        for words in title:
            paper.down(paper.line)
            paper.text(x, words, bold=True)
        for k, at, row in legend:
            paper.at = top + (deep + 1.6 + row) * paper.line
            look = line_style(k, len(one.curves))
            paper.rule(x + at, paper.at - 0.35 * paper.size * POINT_SIZE, LEGEND_LINE, linewidth=0.9, **look)
            paper.text(x + at + LEGEND_LINE + 0.8, one.curves[k].name)
        paper.draw(_drawer(one, (x, top + above, width, plot), paper.size))
    paper.at = top + above + plot


def _legend(one: Any, width: float, size: float) -> list[tuple[int, float, int]]:
    """Return (number, horizontal position [mm], line) of each named curve in a drawing's legend."""
    found: list[tuple[int, float, int]] = []
    at, row = 0.0, 0
    for i, curve in enumerate(one.curves):
        if curve.name:
            long = LEGEND_LINE + 0.8 + width_of(curve.name, size)
            if found and at + long > width:
                at, row = 0.0, row + 1
            found.append((i, at, row))
            at += long + 2.5
    return found


def _drawer(one: Any, box: tuple[float, float, float, float], size: float) -> Any:
    """Return a function that draws curves into a box: x, y of its upper left corner, width and height [mm]."""
    x, y, width, high = box
    size = max(size - 0.5, LEAST_PT)
    below = "\n".join(wrapped(one.x_label, width, size))

    def call(figure: Any) -> None:
        axes = figure.add_axes((x / WIDE, 1.0 - (y + high) / HIGH, width / WIDE, high / HIGH))
        for i, curve in enumerate(one.curves):
            look = line_style(i, len(one.curves))
            axes.plot(curve.x, curve.y, marker="o", markersize=2.0, linewidth=0.9, **look)
        axes.set_xlabel(below, fontsize=size)
        if one.y_label != one.title:
            axes.set_ylabel(one.y_label, fontsize=size)
        if one.from_zero:
            axes.set_xlim(left=0.0)
        axes.tick_params(labelsize=size)
        plain_ticks(axes.xaxis, most=max(int(width / TICK_DISTANCE[0]), 2))
        plain_ticks(axes.yaxis, most=max(int(high / TICK_DISTANCE[1]), 2))
        _place_axes(figure, axes, box)

    return call


def _place_axes(figure: Any, axes: Any, box: tuple[float, float, float, float]) -> None:
    """Place axes so that they fill a box together with their labels."""
    x, y, width, high = box
    asked = x / WIDE, 1.0 - (y + high) / HIGH, (x + width) / WIDE, 1.0 - y / HIGH
    for _ in range(FITTED):
        found = axes.get_tightbbox(figure.canvas.get_renderer()).transformed(figure.transFigure.inverted())
        place = axes.get_position()
        low = place.x0 + asked[0] - found.x0, place.y0 + asked[1] - found.y0
        end = place.x1 + asked[2] - found.x1, place.y1 + asked[3] - found.y1
        axes.set_position((*low, end[0] - low[0], end[1] - low[1]))
        if max(map(abs, (*(found.min - asked[:2]), *(found.max - asked[2:])))) < NEAR:
            break
