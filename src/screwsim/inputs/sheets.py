"""Reads CSV tables, all in the same way: a line of names, then rows with one cell for each name.

Cells are separated by commas and may stand in double quotes; a number has a decimal point. Where the line of names has
semicolons and no commas, these separate cells, and the decimal sign is the one that the numbers of the table show.
Empty lines and lines that begin with # are skipped; but where the first column holds names, a line that begins with #
and a number and has the cells of a row is refused, for `#3` may be a name. A row with more or fewer cells than there
are names is refused: most often its decimal commas have split numbers.
"""

import csv
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import counted
from screwsim.inputs.textfiles import MOST_TABLE, Unreadable, read_text

MOST_CELLS, MOST_ROWS = 4096, 200_000
NAMES, REMARK = "name", "#"  # the column of names; what a line that is no row begins with
NUMBERED = re.compile(rf"{REMARK}\d+\s*[,;]")  # a row whose name may be #3, or one named 3 that is left out
COMMA, SEMICOLON = ",", ";"  # what separates cells
HEAD = re.compile(r"(.*?)\s*(?:\[([^\]]*)\])?")  # a name, and its unit in brackets
QUOTED = re.compile(r'"[^"]*"')
DECIMAL = re.compile(r"([+-]?\d*)([.,])(\d+)((?:[eE][+-]?\d+)?)((?:\s*[^\d.,\s][^.,]*)?)")  # one mark, unit behind it
LIKE_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}")


class BadSheet(Exception):
    """Say in one line, without the file's name, why a table cannot be read, and the remedy; `line` is where."""

    def __init__(self, what: str, line: int | None = None) -> None:
        super().__init__(what if line is None else f"line {line}: {what}")
        self.what = what
        self.line = line


@dataclass(frozen=True)
class Row:
    """One row: its line number in the file, the line itself, its cells without surrounding blanks, their separator."""

    line: int
    text: str
    cells: tuple[str, ...]
    mark: str = COMMA


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
    between = QUOTED.sub("", lines[0][1])
    head = _row(*lines[0], SEMICOLON if SEMICOLON in between and COMMA not in between else COMMA)
    if len(head.cells) == 1 and "\t" in head.text:
        raise BadSheet("is separated by tabs (save it with commas between cells and decimal points)", head.line)
    body = [_row(number, line, head.mark) for number, line in lines[1:]]
    for name in head.cells:
        if name and head.cells.count(name) > 1:
            raise BadSheet(f"has the column {_short(name)} twice (remove one)", head.line)
    wanted = len(head.cells)
    for row in body:
        count = len(row.cells)
        if count != wanted:
            more = "write decimal points, not decimal commas" if head.mark == COMMA else "leave the rest out"
            remedy = more if count > wanted else "fill the row"
            what = f"has {counted(count, 'cell')}, but the first line has {wanted}"
            raise BadSheet(f"{what} ({remedy}: one cell per column)", row.line)
    if head.cells[0] == NAMES and len(head.cells) > 1:
        for number, line in numbered:
            _check_remark(number, line, head)
    return Sheet(head, tuple(body if head.mark == COMMA else _with_points(head, body)))


def name_and_unit(cell: str) -> tuple[str, str]:
    """Return the name and the unit, empty where none stands, of a cell that reads `NAME [UNIT]`."""
    match = HEAD.fullmatch(cell)
    assert match is not None
    return match[1], (match[2] or "").strip()


def _with_points(head: Row, body: list[Row]) -> Iterator[Row]:
    """Yield the rows of a table separated by semicolons, with a point in numbers that have a decimal comma.

    Raise BadSheet where points and commas are in use, or where each of them may separate thousands.
    """
    cells = ((row, cell) for row in body for name, cell in zip(head.cells, row.cells, strict=True) if name != NAMES)
    decimals = [(row, found) for row, cell in cells if (found := DECIMAL.fullmatch(cell)) is not None]
    signs = {found[2] for _, found in decimals}
    if len(signs) > 1:
        row, found = next((row, found) for row, found in decimals if found[2] != decimals[0][1][2])
        what = f"{_short(found[0])} and {_short(decimals[0][1][0])} have different decimal signs"
        raise BadSheet(f"{what} (write all with commas, or all with points)", row.line)
    if decimals and all(LIKE_THOUSANDS.fullmatch("".join(found.group(1, 2, 3, 4))) for _, found in decimals):
        row, found = decimals[0]
        number = f"{found[1]}{found[3]}", "".join(found.group(1, 2, 3)) + "0"
        what = f"{_short(found[0])} may have {'a comma' if signs == {COMMA} else 'a point'} for thousands or decimals"
        raise BadSheet(f"{what} (write {number[0]}, or {number[1]})", row.line)
    for row in body:
        numbers = (
            cell if name == NAMES else _with_point(cell) for name, cell in zip(head.cells, row.cells, strict=True)
        )
        yield replace(row, cells=tuple(numbers))


def _with_point(cell: str) -> str:
    """Return a cell with a point in place of the decimal comma of its number."""
    found = DECIMAL.fullmatch(cell)
    return cell if found is None else f"{found[1]}.{''.join(found.group(3, 4, 5))}"


def _row(number: int, line: str, mark: str) -> Row:
    try:
        (cells,) = csv.reader([line], strict=True, delimiter=mark)
    except csv.Error as error:
        why = "holds a cell that is too long" if "field limit" in str(error) else f"is not CSV: {error}"
        named = "commas" if mark == COMMA else "semicolons"
        raise BadSheet(f"{why} (separate cells by {named}; close each quote that opens a cell)", number) from None
    if len(cells) > MOST_CELLS:
        raise BadSheet(f"has {len(cells)} cells (at most {MOST_CELLS} are allowed)", number)
    return Row(number, line, tuple(cell.strip() for cell in cells), mark)


def _check_remark(number: int, line: str, head: Row) -> None:
    """Raise BadSheet of a remark below the line of names that may be a row with a name as #3."""
    text = line.strip()
    if number < head.line or not NUMBERED.match(text):
        return
    try:
        count = len(_row(number, text, head.mark).cells)
    except BadSheet:
        return
    if count == len(head.cells):
        what = f"begins with {REMARK}, but has as many cells as a row"
        remedy = f"put its name in double quotes, or a space after {REMARK} if the row is to be left out"
        raise BadSheet(f"{what} ({remedy})", number)


def _short(name: str) -> str:
    return repr(name if len(name) <= 40 else name[:39] + "…")
