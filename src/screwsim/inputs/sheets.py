"""Reads tables, all in the same way: a line of names, then rows with one cell for each name.

A table is a CSV file in UTF-8, or the first worksheet of a workbook (.xlsx, `inputs.workbooks`). In a CSV file cells
are separated by commas and may stand in double quotes; a number has a decimal point. Where the line of names has
semicolons and no commas, these separate cells, and the decimal sign is the one that the numbers of the table show.
Empty lines and lines that begin with # are skipped; but where the first column holds names, a line that begins with #
and a number and has the cells of a row is refused, for `#3` may be a name. A row with more or fewer cells than there
are names is refused: most often its decimal commas have split numbers.
"""

import csv
import io
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import counted
from screwsim.inputs.textfiles import MOST_TABLE, Unreadable, read_text
from screwsim.inputs.workbooks import OTHER_WORKBOOKS, WORKBOOK, BadCell, is_workbook, rows_of_workbook

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
    """One row: its line number in the file, the line itself, its cells without surrounding blanks, their separator.

    Cells of a worksheet have no separator, '', and its lines are those of a CSV file with the same cells.
    """

    line: int
    text: str
    cells: tuple[str, ...]
    mark: str = COMMA

    @property
    def places(self) -> tuple[int, ...]:
        """The place of each cell in the line, by which faults name it; in a worksheet the number of its column."""
        if not self.mark:
            return tuple(range(1, len(self.cells) + 1))
        starts, quoted = [1], False
        for place, letter in enumerate(self.text):  # marks inside quotes do not separate cells
            quoted ^= letter == '"'
            if letter == self.mark and not quoted:
                starts.append(place + 2)
        return tuple(starts)


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
        """Return the numbers in the named columns of each row; raise BadSheet, with `words` where one is no number."""
        rows = self.columns(*names)
        try:
            return [tuple(map(float, cells)) for _, cells in rows]
        except ValueError:
            for line, cells in rows:
                if shown := [cell for cell in cells if cell.endswith("%")]:
                    what = f"has {shown[0]!r}, and a plain number is needed"
                    raise BadSheet(
                        f"{what} (write it, or in a workbook have its cell shown as a number)", line
                    ) from None
            raise BadSheet(words) from None

    def records(self) -> list[dict[str, str]]:
        """Return each row as {name: cell}."""
        return [dict(zip(self.names, row.cells, strict=True)) for row in self.rows]


def read_sheet(path: str | os.PathLike[str]) -> Sheet:
    """Return the table in a CSV file or a workbook; raise Unreadable, or BadSheet with the line at fault."""
    if is_workbook(path):
        return _sheet_of_workbook(path)
    try:
        return sheet_of(read_text(path, MOST_TABLE))
    except Unreadable:
        ending = os.path.splitext(os.fspath(path))[1].lower()
        if ending in OTHER_WORKBOOKS and os.path.exists(path):
            raise Unreadable(f"a workbook is read as {WORKBOOK}, not as {ending} (save it so, or as CSV)") from None
        raise


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


def _sheet_of_workbook(path: str | os.PathLike[str]) -> Sheet:
    try:
        found = rows_of_workbook(path, REMARK)
    except BadCell as fault:
        raise BadSheet(str(fault), fault.row) from None
    every = [Row(number, _as_line(cells), tuple(cells), "") for number, cells in found]
    rows = [row for row in every if not row.cells[0].startswith(REMARK)]
    if not rows:
        return Sheet(Row(1, "", ()), ())
    _check_remarks([(row.line, row.text) for row in every], rows[0])
    return _sheet(rows[0], rows[1:], "leave the rest out")


def _as_line(cells: list[str]) -> str:
    """Return the line of a CSV file with these cells."""
    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow(cells)
    return line.getvalue()


def sheet_of(text: str) -> Sheet:
    """Return the table in a text; without any row its head has no names. Raise BadSheet."""
    numbered = [(number, line) for number, line in enumerate(text.split("\n"), 1) if line.strip()]
    lines = [each for each in numbered if not each[1].lstrip().startswith(REMARK)]
    if not lines:
        return Sheet(Row(1, "", ()), ())
    between = QUOTED.sub("", lines[0][1])
    head = _row(*lines[0], SEMICOLON if SEMICOLON in between and COMMA not in between else COMMA)
    if len(head.cells) == 1 and "\t" in head.text:
        raise BadSheet("is separated by tabs (save it with commas between cells and decimal points)", head.line)
    _check_count(len(lines) - 1)
    more = "write decimal points, not decimal commas" if head.mark == COMMA else "leave the rest out"
    found = _sheet(head, [_row(number, line, head.mark) for number, line in lines[1:]], more)
    _check_remarks(numbered, head)
    return found if head.mark == COMMA else replace(found, rows=tuple(_with_points(head, found.rows)))


def _check_count(rows: int) -> None:
    if rows > MOST_ROWS:
        raise BadSheet(f"has {rows} rows (at most {MOST_ROWS} are read; leave some out)")


def _sheet(head: Row, body: Sequence[Row], more: str) -> Sheet:
    """Return the table of a row of names and the rows below it; raise BadSheet where they do not fit together.

    `more` is the remedy where a row has more cells than there are names.
    """
    _check_count(len(body))
    for name in head.cells:
        if name and head.cells.count(name) > 1:
            raise BadSheet(f"has the column {_short(name)} twice (remove one)", head.line)
    wanted = len(head.cells)
    for row in body:
        count = len(row.cells)
        if count != wanted:
            remedy = more if count > wanted else "fill the row"
            what = f"has {counted(count, 'cell')}, but the first line has {wanted}"
            raise BadSheet(f"{what} ({remedy}: one cell per column)", row.line)
    return Sheet(head, tuple(body))


def name_and_unit(cell: str) -> tuple[str, str]:
    """Return the name and the unit, empty where none stands, of a cell that reads `NAME [UNIT]`."""
    match = HEAD.fullmatch(cell)
    assert match is not None
    return match[1], (match[2] or "").strip()


def _with_points(head: Row, body: Sequence[Row]) -> Iterator[Row]:
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


def _check_remarks(numbered: Iterable[tuple[int, str]], head: Row) -> None:
    """Raise BadSheet where the first column holds names, and a remark may be a row with a name as #3."""
    if head.cells[0] == NAMES and len(head.cells) > 1:
        for number, line in numbered:
            _check_remark(number, line, head)


def _check_remark(number: int, line: str, head: Row) -> None:
    """Raise BadSheet of a remark below the line of names that may be a row with a name as #3."""
    text = line.strip()
    if number < head.line or not NUMBERED.match(text):
        return
    try:
        count = len(_row(number, text, head.mark or COMMA).cells)
    except BadSheet:
        return
    if count == len(head.cells):
        what = f"begins with {REMARK}, but has as many cells as a row"
        remedy = f"put its name in double quotes, or a space after {REMARK} if the row is to be left out"
        raise BadSheet(f"{what} ({remedy})", number)


def _short(name: str) -> str:
    return repr(name if len(name) <= 40 else name[:39] + "…")
