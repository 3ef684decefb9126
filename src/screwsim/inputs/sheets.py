"""Reads CSV tables, all in the same way: a line of names, then rows with one cell for each name.

Cells are separated by commas and may stand in double quotes; a number has a decimal point. Empty lines and lines that
begin with # are skipped; but where the first column holds names, a line that begins with # and a number and has the
cells of a row is refused, for `#3` may be a name. A row with more or fewer cells than there are names is refused: most
often its decimal commas have split numbers.
"""

import csv
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from screwsim.inputs.faults import UsageError
from screwsim.inputs.textfiles import MOST_TABLE, Unreadable, read_text

MOST_CELLS, MOST_ROWS = 4096, 200_000
NAMES, REMARK = "name", "#"  # the column of names; what a line that is no row begins with
NUMBERED = re.compile(rf"{REMARK}\d+\s*,")  # a row whose name may be #3, or one named 3 that is left out
_OTHER = {";": "semicolons", "\t": "tabs"}  # other separators of cells, which are refused


class BadSheet(Exception):
    """Say in one line, without the file's name, why a table cannot be read, and the remedy; `line` is where."""

    def __init__(self, what: str, line: int | None = None) -> None:
        super().__init__(what if line is None else f"line {line}: {what}")
        self.what = what
        self.line = line


@dataclass(frozen=True)
class Row:
    """One row: its line number in the file, the line itself, and its cells without surrounding blanks."""

    line: int
    text: str
    cells: tuple[str, ...]


@dataclass(frozen=True)
class Sheet:
    """A table: the row of names, and the rows below it with as many cells each."""

    head: Row
    rows: tuple[Row, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return self.head.cells

    def columns(self, *names: str) -> list[tuple[int, tuple[str, ...]]]:
        """Return (line, cells of the named columns) for each row; raise BadSheet where a column is missing."""
        if not set(names) <= set(self.names):
            found = ", ".join(name for name in self.names if name) or "none"
            wanted = "columns" if len(names) > 1 else "column"
            raise BadSheet(f"needs the {wanted} {' and '.join(names)} (found: {found})")
        places = [self.names.index(name) for name in names]
        return [(row.line, tuple(row.cells[place] for place in places)) for row in self.rows]

    def numbers(self, *names: str, words: str) -> list[tuple[float, ...]]:
        """Return the numbers in the named columns of each row; raise BadSheet, with `words` where one is none."""
        try:
            return [tuple(map(float, cells)) for _, cells in self.columns(*names)]
        except ValueError:
            raise BadSheet(words) from None

    def records(self) -> list[dict[str, str]]:
        """Return each row as {name: cell}."""
        return [dict(zip(self.names, row.cells, strict=True)) for row in self.rows]


def read_sheet(path: str | os.PathLike[str]) -> Sheet:
    """Return the table in a CSV file in UTF-8; raise Unreadable, or BadSheet with the line at fault."""
    return sheet_of(read_text(path, MOST_TABLE))


@contextmanager
def sheet_or_usage_error(remedy: str, where: str = "") -> Iterator[None]:
    """Turn a failure to read a table into a one-line UsageError, which begins with `where`.

    `remedy` is given where the file cannot be read at all.
    """
    before = f"{where}: " if where else ""
    try:
        yield
    except Unreadable as reason:
        raise UsageError(f"{before}cannot be read: {reason} ({remedy})") from None
    except BadSheet as fault:
        raise UsageError(f"{before}{fault}") from None


def sheet_of(text: str) -> Sheet:
    """Return the table in a text; without any row its head has no names. Raise BadSheet."""
    numbered = [(number, line) for number, line in enumerate(text.split("\n"), 1) if line.strip()]
    lines = [each for each in numbered if not each[1].lstrip().startswith(REMARK)]
    if not lines:
        return Sheet(Row(1, "", ()), ())
    if len(lines) - 1 > MOST_ROWS:
        raise BadSheet(f"has {len(lines) - 1} rows (at most {MOST_ROWS} are read; leave some out)")
    head = _row(*lines[0])
    divided = next((name for mark, name in _OTHER.items() if len(head.cells) == 1 and mark in head.text), None)
    if divided is not None:
        raise BadSheet(f"is separated by {divided} (save it with commas between cells and decimal points)", head.line)
    body = [_row(number, line) for number, line in lines[1:]]
    for name in head.cells:
        if name and head.cells.count(name) > 1:
            raise BadSheet(f"has the column {_short(name)} twice (remove one)", head.line)
    wanted = len(head.cells)
    for row in body:
        count = len(row.cells)
        if count != wanted:
            remedy = "write decimal points, not decimal commas" if count > wanted else "fill the row"
            what = f"has {count} cell{'s' * (count != 1)}, but the first line has {wanted}"
            raise BadSheet(f"{what} ({remedy}: one cell per column)", row.line)
    if head.cells[0] == NAMES and len(head.cells) > 1:
        for number, line in numbered:
            _check_remark(number, line, head)
    return Sheet(head, tuple(body))


def _row(number: int, line: str) -> Row:
    try:
        (cells,) = csv.reader([line], strict=True)
    except csv.Error as error:
        why = "holds a cell that is too long" if "field limit" in str(error) else f"is not CSV: {error}"
        raise BadSheet(f"{why} (separate cells by commas; close each quote that opens a cell)", number) from None
    if len(cells) > MOST_CELLS:
        raise BadSheet(f"has {len(cells)} cells (at most {MOST_CELLS} are allowed)", number)
    return Row(number, line, tuple(cell.strip() for cell in cells))


def _check_remark(number: int, line: str, head: Row) -> None:
    """Raise BadSheet of a remark below the line of names that may be a row with a name as #3."""
    text = line.strip()
    if number < head.line or not NUMBERED.match(text):
        return
    try:
        count = len(_row(number, text).cells)
    except BadSheet:
        return
    if count == len(head.cells):
        what = f"begins with {REMARK}, but has as many cells as a row"
        remedy = f"put its name in double quotes, or a space after {REMARK} if the row is to be left out"
        raise BadSheet(f"{what} ({remedy})", number)


def _short(name: str) -> str:
    return repr(name if len(name) <= 40 else name[:39] + "…")
