"""Pages of A4 that are filled from top to bottom: what stands where is found first, drawn by matplotlib when all is."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from screwsim.report.style import DPI, GREY, MM, new_figure
from screwsim.version import version

WIDE, HIGH = 210.0, 297.0  # [mm] of a page
EDGE = 12.0  # [mm] left free around
POINT = 1.0 / (72.0 * MM)  # [mm]
LEAST = 6.5  # [pt] the smallest type
LINE, FALL = 1.28, 0.25  # of the size: from line to line, and what letters take below theirs
_UNIT = re.compile(r"(?<=\d) (?=[^\s\d])")
_FIXED = "\u00a0"  # a space at which no line ends


@lru_cache(maxsize=8192)
def width_of(words: str, size: float, bold: bool = False) -> float:
    """Return the width [mm] of words in type of a size [pt]."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal", size=size)
    return text_to_path.get_text_width_height_descent(words, font, False)[0] * POINT


def wrapped(words: str, width: float, size: float, bold: bool = False) -> list[str]:
    """Return the lines that words take in a width [mm]; a number stays with its unit, a word too long is broken."""
    rows: list[str] = []
    for word in _UNIT.sub(_FIXED, words).split(" "):
        longer = f"{rows[-1]} {word}" if rows else word
        if rows and width_of(longer, size, bold) <= width:
            rows[-1] = longer
        else:
            rows += _pieces(word, width, size, bold)
    return rows or [""]


def _pieces(word: str, width: float, size: float, bold: bool) -> Iterator[str]:
    """Yield a word, in pieces where it is wider than the line."""
    while len(word) > 1 and width_of(word, size, bold) > width:
        fits = next((n for n in range(len(word) - 1, 1, -1) if width_of(word[:n], size, bold) <= width), 1)
        yield word[:fits]
        word = word[fits:]
    yield word


@dataclass
class Paper:
    """The pages so far, each the calls that draw it, and how far down [mm] the last one is filled; `size` [pt]."""

    title: str
    size: float
    pages: list[list[Callable[[Any], None]]] = field(default_factory=list)
    at: float = HIGH

    @property
    def line(self) -> float:
        """Height [mm] of a line of text."""
        return self.size * LINE * POINT

    @property
    def left(self) -> float:
        """Height [mm] that is left on the last page."""
        return HIGH - EDGE - self.at

    def room(self, height: float) -> None:
        """Begin a new page where that height is not left on this one."""
        if height > self.left or not self.pages:
            self.pages.append([])
            self.at = EDGE

    def down(self, height: float) -> None:
        """Leave a height free."""
        self.at += height

    def draw(self, call: Callable[[Any], None]) -> None:
        """Have the figure of the last page drawn on by a call."""
        self.pages[-1].append(call)

    def text(self, x: float, words: str, size: float = 0.0, bold: bool = False, **look: Any) -> None:
        """Write words at x [mm] from the left edge, as far down as the page is filled."""
        if words:
            where = x / WIDE, 1.0 - self.at / HIGH
            look = {"fontsize": size or self.size, "va": "baseline", **look} | ({"weight": "bold"} if bold else {})
            self.draw(lambda figure: figure.text(*where, words, parse_math=False, **look))

    def rule(self, x: float, y: float, width: float, **look: Any) -> None:
        """Draw a line across from x, y [mm] from the left and upper edges."""
        ends = [x / WIDE, (x + width) / WIDE], [1.0 - y / HIGH] * 2

        def call(figure: Any) -> None:
            from matplotlib.lines import Line2D

            figure.add_artist(Line2D(*ends, **({"color": GREY, "linewidth": 0.4} | look)))

        self.draw(call)

    def paragraph(self, words: str, x: float = EDGE, width: float = WIDE - 2.0 * EDGE, **look: Any) -> None:
        """Write words in lines of a width [mm], on the next page where this one is full."""
        size = look.get("size") or self.size
        for row in wrapped(words, width, size, look.get("bold", False)):
            high = size * LINE * POINT
            self.room(high)
            self.down(high)
            self.text(x, row, **look)

    def figures(self) -> list[Any]:
        """Return the pages as figures, with their foot."""
        return [self._figure(number) for number in range(len(self.pages))]

    def _figure(self, number: int) -> Any:
        figure = new_figure(WIDE, HIGH)
        figure.set_layout_engine("none")
        figure.set_dpi(DPI)  # drawings are fitted by the widths of their letters, in whole pixels
        for call in self.pages[number]:
            call(figure)
        tail = f"  ·  screwsim {version()}"
        tail += f"  ·  page {number + 1} of {len(self.pages)}" if len(self.pages) > 1 else ""
        title, *more = wrapped(self.title, WIDE - 2.0 * EDGE - width_of(tail + " …", LEAST), LEAST)
        foot = f"{title}{' …' if more else ''}{tail}"
        figure.text(EDGE / WIDE, 0.5 * EDGE / HIGH, foot, fontsize=LEAST, color=GREY, parse_math=False)
        return figure
