"""A data sheet in a file: a self-contained HTML page, without scripts and external resources; or a PDF, or a table."""

import math
from collections.abc import Iterator, Sequence
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.inputs.workbooks import TABLES
from screwsim.report.datasheet_csv import check_table, write_table
from screwsim.results.atomic import check_writable, make_folder, write_text
from screwsim.results.protection import PAGE, PDF, protect_unmarked
from screwsim.results.tables import check_workbook
from screwsim.version import version

WIDE, HIGH = 640.0, 300.0  # size of a drawing
LEFT, RIGHT, TOP, BOTTOM = 58.0, 14.0, 26.0, 44.0  # margins of a drawing
TICK_COUNT = 6
AXIS_MARGIN = 0.08  # of the range, left free on each side of the curves
COLOURS, DASHES = 6, ("", "7 3", "2 3", "9 3 2 3")  # of several curves: colours of the page, then dashes
VERDICT_CLASSES = {True: "holds", False: "fails", None: ""}
VERDICT_WORDS = {True: "met", False: "not met", None: "no verdict"}
SIDE_BY_SIDE_FROM = 2  # number of tables, or of drawings, from which they are side by side
LONG_HEADS = 42  # characters of a table's heads from which units move below, so that two tables fit side by side


def check_sheet(output: Path) -> None:
    """Raise UsageError where a sheet's file name is none of a page, PDF or table, another's, or cannot be written."""
    if output.suffix.lower() in TABLES:
        check_workbook(output)
        check_table(output)
        check_writable(output)
        return
    mark = {".pdf": PDF, ".html": PAGE, ".htm": PAGE}.get(output.suffix.lower())
    if mark is None:
        good = ", ".join(str(output.with_suffix(ending)) for ending in (".html", ".pdf"))
        good += f" or {output.with_suffix(TABLES[0])}"
        raise UsageError(f"-o {output}: a data sheet is an HTML page, a PDF or a table (write -o {good})")
    protect_unmarked(output, mark)
    check_writable(output)


def write_sheet(sheet: Any, output: Path) -> str:
    """Write a data sheet as PDF, HTML or table, by its ending; raise UsageError when the system refuses."""
    make_folder(output.parent)
    if output.suffix.lower() in TABLES:
        return write_table(sheet.document, output)
    if output.suffix.lower() == ".pdf":
        from screwsim.report.datasheet_pdf import write_pdf

        return write_pdf(sheet, output)
    return write_text(output, page(sheet))


def page(sheet: Any) -> str:
    """Return the HTML text of a data sheet (`study.datasheet.Sheet`)."""
    source = resources.files("screwsim.report")
    lines = (f'<tr><th scope="row">{escape(name)}</th><td>{escape(text)}</td></tr>' for name, text in sheet.lines)
    parts = {
        "VERSION": escape(version()),
        "TITLE": escape(sheet.title or sheet.heading),
        "HEADING": escape(sheet.heading),
        "STYLE": "".join(source.joinpath("page", f"{name}.css").read_text("utf-8") for name in ("theme", "page")),
        "LINES": "".join(lines),
        "TABLES": _side_by_side("tables", [_table(table) for table in sheet.tables]),
        "DRAWINGS": _side_by_side("drawings", [_figure(each) for each in sheet.drawings]),
        "VERDICT": _verdict(sheet.verdict),
        "NOTES": "".join(f"<li>{escape(note)}</li>" for note in sheet.notes),
    }
    pieces = source.joinpath("datasheet.html").read_text(encoding="utf-8").split("@")
    return "".join(parts.get(piece, piece) if i % 2 else piece for i, piece in enumerate(pieces))


def _side_by_side(name: str, parts: Sequence[str]) -> str:
    many = " many" if len(parts) >= SIDE_BY_SIDE_FROM else ""
    return f'<div class="{name}{many}">{"".join(parts)}</div>' if parts else ""


def _table(table: Any) -> str:
    kinds = ["" if i < table.left else ' class="n"' for i in range(len(table.heads))]
    short = sum(map(len, table.heads)) < LONG_HEADS
    named = table.heads if short else [head.replace("\xa0", " ") for head in table.heads]
    heads = "".join(
        f'<th scope="col"{kind}>{escape(head.replace("/ (", "/("))}</th>'
        for kind, head in zip(kinds, named, strict=True)
    )
    rows = (
        "".join(f"<td{kind}>{escape(cell)}</td>" for kind, cell in zip(kinds, row, strict=True)) for row in table.rows
    )
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    wide = ' class="wide"' if table.wide else ""
    note = f'<p class="hint">{escape(table.note)}</p>' if table.note else ""
    return (
        f"<section{wide}><h2>{escape(table.title)}</h2>"
        f'<div class="scroll" role="region" aria-label="{escape(table.title)}" tabindex="0">'
        f'<table class="points"><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table></div>{note}</section>'
    )


def _verdict(verdict: tuple[str, str, bool | None] | None) -> str:
    if verdict is None:
        return ""
    what, text, good = verdict
    mark = f'<span class="verdict {VERDICT_CLASSES[good]}">{VERDICT_WORDS[good]}</span>'
    return f"<h2>{escape(what)}</h2><p>{mark} {escape(text)}</p>"


def ticks(low: float, high: float) -> list[float]:
    """Return round numbers between two values, in steps of 1, 2 or 5 times a power of ten."""
    rough = (high - low) / TICK_COUNT
    scale = 10.0 ** math.floor(math.log10(rough))
    step = next(scale * each for each in (1.0, 2.0, 5.0, 10.0) if scale * each >= rough)
    first = math.ceil(low / step - 1e-9)
    return [step * i for i in range(first, math.floor(high / step + 1e-9) + 1)]


def _figure(one: Any) -> str:
    named = [(curve.name, *_curve_style(i)) for i, curve in enumerate(one.curves) if curve.name]
    keys = "".join(
        f'<li><i style="border-top-style: {"dashed" if dashes else "solid"}; border-color: {colour}"></i>'
        f"{escape(name)}</li>"
        for name, colour, dashes in named
    )
    legend = f'<ul class="legend">{keys}</ul>' if keys else ""
    return f"<section><h2>{escape(one.title)}</h2>{legend}{drawing(one)}</section>"


def _curve_style(number: int) -> tuple[str, str]:
    """Return colour and dashes of one of several curves; the first has the page's accent colour."""
    colour = "var(--accent)" if number == 0 else f"var(--c{number % COLOURS})"
    return colour, DASHES[number % len(DASHES)]


def drawing(one: Any) -> str:
    """Return curves with their points as an SVG whose text takes the colours of the page."""
    x, y = ([value for curve in one.curves for value in getattr(curve, name)] for name in ("x", "y"))
    (x_0, x_1), (y_0, y_1) = (0.0, max(x) * (1.0 + AXIS_MARGIN)) if one.from_zero else _range(x), _range(y)

    def across(value: float) -> float:
        return LEFT + (WIDE - LEFT - RIGHT) * (value - x_0) / (x_1 - x_0)

    def up(value: float) -> float:
        return HIGH - BOTTOM - (HIGH - TOP - BOTTOM) * (value - y_0) / (y_1 - y_0)

    floor, label = HIGH - BOTTOM, f"{one.y_label} over {one.x_label}"
    drawn = [
        f'<svg viewBox="0 0 {WIDE:g} {HIGH:g}" role="img" aria-label="{escape(label)}">',
        f'<path d="M{LEFT:g},{TOP:g}V{floor:g}H{WIDE - RIGHT:g}" fill="none" stroke="var(--soft)"/>',
    ]
    for at in ticks(x_0, x_1):
        drawn.append(f'<path d="M{across(at):.1f},{floor:g}v5" stroke="var(--soft)"/>')
        drawn.append(f'<text x="{across(at):.1f}" y="{floor + 18:g}" text-anchor="middle">{_digits(at)}</text>')
    for at in ticks(y_0, y_1):
        drawn.append(f'<path d="M{LEFT:g},{up(at):.1f}H{WIDE - RIGHT:g}" stroke="var(--line)"/>')
        drawn.append(f'<text x="{LEFT - 6:g}" y="{up(at) + 4:.1f}" text-anchor="end">{_digits(at)}</text>')
    for number, curve in enumerate(one.curves):
        drawn += _svg_curve([(across(a), up(b)) for a, b in zip(curve.x, curve.y, strict=True)], *_curve_style(number))
    middle = 0.5 * (LEFT + WIDE - RIGHT)
    drawn.append(f'<text x="{middle:g}" y="{HIGH - 6:g}" text-anchor="middle">{escape(one.x_label)}</text>')
    above = "" if one.y_label == one.title else escape(one.y_label)  # left out where the heading says the same
    drawn.append(f'<text x="4" y="14">{above}</text></svg>')
    return "".join(drawn)


def _svg_curve(points: Sequence[tuple[float, float]], colour: str, dashes: str) -> Iterator[str]:
    joined, dashed = " ".join(f"{x:.1f},{y:.1f}" for x, y in points), f' stroke-dasharray="{dashes}"' if dashes else ""
    yield f'<polyline points="{joined}" fill="none" stroke="{colour}" stroke-width="1.8"{dashed}/>'
    yield from (f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in points)


def _digits(value: float) -> str:
    return f"{float(f'{value:.6g}') + 0.0:g}"


def _range(values: Sequence[float]) -> tuple[float, float]:
    low, high = min(values), max(values)
    room = AXIS_MARGIN * (high - low) or 0.05 * abs(high) or 1.0
    return low - room, high + room
