"""A data sheet as a page: one file, drawn without scripts, nothing loaded from elsewhere."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

from screwsim import __version__
from screwsim.results.atomic import make_folder, write_text

WIDE, HIGH = 640.0, 300.0  # of a drawing
LEFT, RIGHT, TOP, BOTTOM = 52.0, 14.0, 26.0, 44.0  # its margins
TICKS = 6
ROOM = 0.08  # of the range, left free above and below a curve
CLASSES = {True: "holds", False: "fails", None: ""}
WORDS = {True: "met", False: "not met", None: "no verdict"}


def write_page(sheet: Any, output: Path) -> str:
    """Write the page of a data sheet and return its path; raise UsageError in one line when the system refuses."""
    make_folder(output.parent)
    return write_text(output, page(sheet))


def page(sheet: Any) -> str:
    """Return the HTML text of a data sheet (`study.datasheet.Sheet`)."""
    source = resources.files("screwsim.report")
    lines = (f'<tr><th scope="row">{escape(name)}</th><td>{escape(text)}</td></tr>' for name, text in sheet.lines)
    rows = ("".join(f'<td class="n">{escape(cell)}</td>' for cell in row) for row in sheet.rows)
    parts = {
        "VERSION": escape(__version__),
        "TITLE": escape(sheet.title or sheet.heading),
        "HEADING": escape(sheet.heading),
        "STYLE": "".join(source.joinpath("page", f"{name}.css").read_text("utf-8") for name in ("theme", "page")),
        "LINES": "".join(lines),
        "HEADS": "".join(f'<th scope="col" class="n">{escape(head)}</th>' for head in sheet.heads),
        "ROWS": "".join(f"<tr>{row}</tr>" for row in rows),
        "CURVES": "".join(f"<h2>{escape(each.y_label)}</h2>{drawing(each)}" for each in sheet.curves),
        "VERDICT": _verdict(sheet.verdict),
        "NOTES": "".join(f"<li>{escape(note)}</li>" for note in sheet.notes),
    }
    pieces = source.joinpath("datasheet.html").read_text(encoding="utf-8").split("@")
    return "".join(parts.get(piece, piece) if i % 2 else piece for i, piece in enumerate(pieces))


def _verdict(verdict: tuple[str, str, bool | None] | None) -> str:
    if verdict is None:
        return ""
    what, text, good = verdict
    mark = f'<span class="verdict {CLASSES[good]}">{WORDS[good]}</span>'
    return f"<h2>{escape(what)}</h2><p>{mark} {escape(text)}</p>"


def ticks(low: float, high: float) -> list[float]:
    """Return round numbers between two values, steps of 1, 2 or 5 times a power of ten."""
    rough = (high - low) / TICKS
    scale = 10.0 ** math.floor(math.log10(rough))
    step = next(scale * each for each in (1.0, 2.0, 5.0, 10.0) if scale * each >= rough)
    first = math.ceil(low / step - 1e-9)
    return [step * i for i in range(first, math.floor(high / step + 1e-9) + 1)]


def drawing(curve: Any) -> str:
    """Return a curve with its points as an SVG; its text follows the colours of the page."""
    (x_0, x_1), (y_0, y_1) = (0.0, max(curve.x) * (1.0 + ROOM)), _range(curve.y)

    def across(value: float) -> float:
        return LEFT + (WIDE - LEFT - RIGHT) * (value - x_0) / (x_1 - x_0)

    def up(value: float) -> float:
        return HIGH - BOTTOM - (HIGH - TOP - BOTTOM) * (value - y_0) / (y_1 - y_0)

    floor, label = HIGH - BOTTOM, f"{curve.y_label} over {curve.x_label}"
    drawn = [
        f'<svg viewBox="0 0 {WIDE:g} {HIGH:g}" role="img" aria-label="{escape(label)}">',
        f'<path d="M{LEFT:g},{TOP:g}V{floor:g}H{WIDE - RIGHT:g}" fill="none" stroke="var(--soft)"/>',
    ]
    for at in ticks(x_0, x_1):
        drawn.append(f'<path d="M{across(at):.1f},{floor:g}v5" stroke="var(--soft)"/>')
        drawn.append(f'<text x="{across(at):.1f}" y="{floor + 18:g}" text-anchor="middle">{at:g}</text>')
    for at in ticks(y_0, y_1):
        drawn.append(f'<path d="M{LEFT:g},{up(at):.1f}H{WIDE - RIGHT:g}" stroke="var(--line)"/>')
        drawn.append(f'<text x="{LEFT - 6:g}" y="{up(at) + 4:.1f}" text-anchor="end">{float(f"{at:.6g}"):g}</text>')
    points = [(across(x), up(y)) for x, y in zip(curve.x, curve.y, strict=True)]
    joined = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    drawn.append(f'<polyline points="{joined}" fill="none" stroke="var(--accent)" stroke-width="1.8"/>')
    drawn += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="var(--accent)"/>' for x, y in points]
    middle = 0.5 * (LEFT + WIDE - RIGHT)
    drawn.append(f'<text x="{middle:g}" y="{HIGH - 6:g}" text-anchor="middle">{escape(curve.x_label)}</text></svg>')
    return "".join(drawn)


def _range(values: Sequence[float]) -> tuple[float, float]:
    low, high = min(values), max(values)
    room = ROOM * (high - low) or 0.05 * abs(high) or 1.0
    return low - room, high + room
