"""Reads the first visible worksheet of a workbook (.xlsx) as rows of texts, such as a CSV file has them.

Numbers are read as they are stored, with all their digits. A cell that is shown in percent has its number in percent,
with the sign behind it unless the head of its column states that unit.
"""

import io
import os
import zipfile
from collections.abc import Iterator
from typing import Any

from screwsim.inputs.textfiles import MOST_TABLE, Unreadable, read_bytes

WORKBOOK = ".xlsx"
OTHER_WORKBOOKS = (".xls", ".xlsm", ".xlsb", ".ods", ".numbers")  # of spreadsheet programs, and not read
NEEDS = "a workbook needs openpyxl: pip install 'screwsim[excel]', or save the table as CSV"
MOST_UNPACKED = 250_000_000  # [byte] of a workbook, which is a compressed file
MOST_EMPTY = 10_000  # empty rows in succession, after which no more is read
PERCENT = "%"


class BadCell(Exception):
    """Say in one line what is wrong with a cell; `row` is where."""

    def __init__(self, what: str, row: int) -> None:
        super().__init__(what)
        self.row = row


def is_workbook(path: str | os.PathLike[str]) -> bool:
    """Tell by the ending of a file's name whether it is a workbook."""
    return os.fspath(path).lower().endswith(WORKBOOK)


def rows_of_workbook(path: str | os.PathLike[str], remark: str) -> list[tuple[int, list[str]]]:
    """Return (number, cells) of each row that is not empty; raise Unreadable, or BadCell.

    All rows have as many cells as the first that does not begin with `remark`, and more only where a cell beyond
    these is filled.
    """
    content = read_bytes(path, MOST_TABLE)
    wanted = 0
    units: list[bool] = []
    found = []
    for number, row in _filled_rows(content, values=True):
        if not wanted and not str(row[0].value).startswith(remark):
            wanted = _last_filled(row)
            units = [_states_percent(cell.value) for cell in row[:wanted]]
        last = max(wanted, _last_filled(row))
        cells = [_text(cell, number, i < wanted and units[i]) for i, cell in enumerate(row[:last])]
        found.append((number, cells + [""] * (last - len(cells))))
    _check_formulas(content, found)
    return found


Cells = tuple[Any, ...]  # openpyxl's


def _filled_rows(content: bytes, values: bool) -> list[tuple[int, Cells]]:
    """Return (number, cells) of each row of the worksheet that is not empty.

    With `values` cells have those of their formulas, else the formulas.
    """
    try:
        import openpyxl
    except ImportError:
        raise Unreadable(NEEDS) from None
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as packed:
            unpacked = sum(part.file_size for part in packed.infolist())
        if unpacked > MOST_UNPACKED:
            raise Unreadable(f"it holds more than {MOST_UNPACKED // 1_000_000} MB when unpacked")
        book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=values)
        visible = [sheet for sheet in book.worksheets if sheet.sheet_state == "visible"]
        return list(_filled(visible[0])) if visible else []
    except Unreadable:
        raise
    except Exception as error:  # noqa: BLE001 - openpyxl raises errors of many kinds at files that are none of its own
        raise Unreadable(f"it is not a workbook ({type(error).__name__})") from None


def _filled(sheet: Any) -> Iterator[tuple[int, Cells]]:
    empty = 0
    for number, row in enumerate(sheet.iter_rows(), 1):
        empty = 0 if _last_filled(row) else empty + 1
        if empty > MOST_EMPTY:
            return
        if not empty:
            yield number, row


def _last_filled(row: Cells) -> int:
    """Return how many cells a row has up to the last that is not empty."""
    filled = (i for i, cell in enumerate(row, 1) if cell.value is not None and str(cell.value).strip())
    return max(filled, default=0)


def _states_percent(head: Any) -> bool:
    return f"[{PERCENT}]" in str(head)


def _text(cell: Any, number: int, in_percent: bool) -> str:
    """Return a cell as text; `in_percent`: the head of its column states that its numbers are in percent."""
    value = cell.value
    if value is None:
        return ""
    if cell.data_type == "e":
        raise BadCell(f"has the error {value} in {cell.column_letter}{number} (mend its formula)", number)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        if PERCENT in (cell.number_format or ""):
            return f"{100.0 * value:.15g}" + ("" if in_percent else f" {PERCENT}")
        return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(float(value))
    return " ".join(str(value).split())


def _check_formulas(content: bytes, rows: list[tuple[int, list[str]]]) -> None:
    """Raise BadCell where an empty cell has a formula, whose value was never computed."""
    empty = {(number, i) for number, cells in rows for i, cell in enumerate(cells) if not cell}
    if not empty:
        return
    for number, row in _filled_rows(content, values=False):
        for i, cell in enumerate(row):
            if cell.data_type == "f" and (number, i) in empty:
                what = f"has a formula without a value in {cell.column_letter}{number}"
                raise BadCell(f"{what} (open the workbook in a spreadsheet program, and save it)", number)
