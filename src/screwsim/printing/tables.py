"""Plain tables and wrapped lines for a terminal of 80 columns."""

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from screwsim.figures.engineering import shown_name
from screwsim.outputs.customary import with_printed_units
from screwsim.outputs.display import distinct_words, grouped
from screwsim.screen import printable, say

WIDTH = 80
NARROWEST = 12  # least width of a first column that has others beside it
LEAST_SHOWN_CHANCE = 1e-6  # of a misfit


def plain_table(heads: Sequence[str], rows: Iterable[Sequence[str]], left: int) -> list[str]:
    """Return the lines of a table: the first `left` columns aligned to the left, the others to the right.

    Columns are two spaces apart, or one if the table would be wider than the terminal; heads break between words. A
    name in the first column that leaves too little space for its row gets a line of its own above it.
    """
    body = [[with_printed_units(cell) for cell in row] for row in rows]
    widths = [max((len(row[i]) for row in body), default=0) for i in range(len(heads))]
    words = [_broken_head(head, width) for head, width in zip(heads, widths, strict=True)]
    deep = max(map(len, words))
    top = [[""] * (deep - len(lines)) + lines for lines in words]
    head = [[column[i] for column in top] for i in range(deep)]
    widths = [max(len(row[i]) for row in head + body) for i in range(len(heads))]
    gap = "  " if sum(widths) + 2 * len(widths) <= WIDTH + 1 else " "
    rest = sum(widths[1:]) + len(gap) * (len(widths) - 1)
    if left and widths[0] + rest > WIDTH and rest + NARROWEST <= WIDTH:
        widths[0] = max(len(row[0]) for row in head + body if len(row[0]) + rest <= WIDTH or not row[0])
    lines = []
    for row in head + body:
        if left and len(row[0]) > widths[0]:
            lines.append(row[0])
            row = ["", *row[1:]]
        cells = enumerate(zip(row, widths, strict=True))
        padded = (cell.ljust(width) if i < left else cell.rjust(width) for i, (cell, width) in cells)
        lines.append(gap.join(padded).rstrip())
    return lines


def print_table(heads: Sequence[str], rows: Iterable[Sequence[str]], left: int = 0) -> None:
    """Print a table (`plain_table`)."""
    say("\n".join(plain_table(heads, rows, left)))


def _broken_head(head: str, width: int) -> list[str]:
    """Return a head broken into lines about as wide as its column."""
    longest = max(map(len, head.split()), default=1)
    return textwrap.wrap(head, max(width, longest), break_long_words=False) or [""]


def wrapped(text: str) -> str:
    """Return a text in lines that fit, all but the first indented."""
    return textwrap.fill(text, WIDTH - 1, subsequent_indent="  ", break_on_hyphens=False)


def print_scene_title(title: str, changed: Sequence[str] = ()) -> None:
    """Print a title, if any, in lines that fit, and what the command line changes."""
    print_wrapped(filter(None, [heading(title, changed), ", ".join(changed)]))


def heading(title: str, changed: Sequence[str] = ()) -> str:
    """Return a title with its units as printed, which says so where what it tells may be changed by the next line."""
    return f"{with_printed_units(title)}{', changed' if title and changed else ''}"


def column_heads(paths: Sequence[str]) -> list[str]:
    """Return what columns of paths are called: the words that tell them apart."""
    return [" ".join(words).replace("_", " ") for words in distinct_words(paths)]


def print_text(text: str, *, err: bool = False) -> None:
    """Print a text on stdout, or on stderr, in lines that fit, with nothing in it that steers a terminal."""
    say(wrapped(printable(text)), err=err)


def print_wrapped(texts: Iterable[str]) -> None:
    """Print texts in lines that fit, each starting on a new line."""
    for text in texts:
        print_text(text)


def absent_figures(figures: Mapping[str, Any], notes: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the names that people read of figures without a value, by the reason that the notes give."""
    absent = (name for name, value in figures.items() if value is None and name in notes)
    return grouped((notes[name], shown_name(name)) for name in absent)


def print_left_out(reasons: Mapping[str, str]) -> None:
    """Print the points without a solution, and the reasons."""
    print_wrapped(f"left out: {name} has no solution: {reason}" for name, reason in reasons.items())


def shown_chance(chance: float) -> str:
    """Return a probability of a misfit in words; of a tiny one its digits say nothing."""
    return f"{chance:.1g}" if chance >= LEAST_SHOWN_CHANCE else f"fewer than {LEAST_SHOWN_CHANCE:g}"
