"""A4 pages filled from top to bottom: positions are computed first, and matplotlib draws when all are known."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from screwsim.report.style import DPI, GREY, MM, new_figure
from screwsim.version import version

WIDE, HIGH = 210.0, 297.0  # [mm] size of a page
MARGIN = 12.0  # [mm] margin
POINT_SIZE = 1.0 / (72.0 * MM)  # [mm]
LEAST_PT = 6.5  # [pt] smallest type
LINE, FALL = 1.28, 0.25  # of the font size: line spacing, and depth of letters below the baseline
_UNIT = re.compile(r"(?<=\d) (?=[^\s\d])")
_FIXED = "\u00a0"  # no-break space


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

        def call(figure: Any) -> None:
            from matplotlib.lines import Line2D

            figure.add_artist(Line2D(*ends, **({"color": GREY, "linewidth": 0.4} | look)))

        self.draw(call)

    def paragraph(self, words: str, x: float = MARGIN, width: float = WIDE - 2.0 * MARGIN, **look: Any) -> None:
        """Write words in lines of a width [mm], on the next page when this one is full."""
        size = look.get("size") or self.size
        for row in wrapped(words, width, size, look.get("bold", False)):
            high = size * LINE * POINT_SIZE
            self.room(high)
            self.down(high)
            self.text(x, row, **look)

    def figures(self) -> list[Any]:
        """Return the pages as figures, with their footers."""
        return [self._figure(number) for number in range(len(self.pages))]

    def _figure(self, number: int) -> Any:
        figure = new_figure(WIDE, HIGH)
        figure.set_layout_engine("none")
        figure.set_dpi(DPI)  # drawings are fitted by the widths of their letters, in whole pixels
        for call in self.pages[number]:
            call(figure)
        tail = f"  ·  screwsim {version()}"
        tail += f"  ·  page {number + 1} of {len(self.pages)}" if len(self.pages) > 1 else ""
        title, *more = wrapped(self.title, WIDE - 2.0 * MARGIN - width_of(tail + " …", LEAST_PT), LEAST_PT)
        foot = f"{title}{' …' if more else ''}{tail}"
        figure.text(MARGIN / WIDE, 0.5 * MARGIN / HIGH, foot, fontsize=LEAST_PT, color=GREY, parse_math=False)
        return figure
