"""Plain tables and wrapped lines for a terminal of 80 columns."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence

from screwsim.outputs.customary import raised

WIDTH = 80


def plain_table(heads: Sequence[str], rows: Iterable[Sequence[str]], left: int = 0) -> list[str]:
    """Return the lines of a table: the first `left` columns aligned to the left, the others to the right.

    Columns stand two spaces apart, one where they would be wider than the terminal; heads break between words.
    """
    body = [[raised(cell) for cell in row] for row in rows]
    widths = [max((len(row[i]) for row in body), default=0) for i in range(len(heads))]
    words = [_broken(head, width) for head, width in zip(heads, widths, strict=True)]
    deep = max(map(len, words))
    top = [[""] * (deep - len(lines)) + lines for lines in words]
    table = [[column[i] for column in top] for i in range(deep)] + body
    widths = [max(len(row[i]) for row in table) for i in range(len(heads))]
    gap = "  " if sum(widths) + 2 * len(widths) <= WIDTH + 1 else " "
    return [
        gap.join(
            cell.ljust(width) if i < left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in table
    ]


def _broken(head: str, width: int) -> list[str]:
    """Return a head in lines about as wide as its column."""
    longest = max(map(len, head.split()), default=1)
    return textwrap.wrap(head, max(width, longest), break_long_words=False) or [""]


def wrapped(text: str) -> str:
    """Return a text in lines that fit, all but the first indented."""
    return textwrap.fill(text, WIDTH - 1, subsequent_indent="  ", break_on_hyphens=False)
