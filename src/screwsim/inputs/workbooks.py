"""Reads the first visible worksheet of a workbook (.xlsx) as rows of texts, such as a CSV file has them.

Numbers are read as they are stored, with all their digits. A cell that is shown in percent has its number in percent,
with the sign behind it unless the head of its column states that unit. A sign that a format only writes behind the
stored number, in quotes or behind a backslash, is no part of it.
"""

import io
import os
import re
import warnings
from collections.abc import Iterator
from typing import Any

from screwsim.inputs.textfiles import MOST_TABLE, Unreadable, read_bytes

WORKBOOK = ".xlsx"
TABLES = (".csv", WORKBOOK)  # endings of tables
OTHER_WORKBOOKS = (".xls", ".xlsm", ".xlsb", ".ods", ".numbers")  # of spreadsheet programs, and not read
NEEDS = "a workbook needs openpyxl: pip install 'screwsim[excel]', or save the table as CSV"
NOT_ONE = "it is not a workbook ({})"
MOST_UNPACKED = 250_000_000  # [byte] of a workbook, which is a compressed file
MOST_EMPTY = 10_000  # empty rows in succession, after which no more is read
PERCENT = "%"
WORKSHEETS, FORMULA = "xl/worksheets/", re.compile(rb"<(\w+:)?f[\s/>]")  # where formulas are in the file, and how
LITERAL = re.compile(r'"[^"]*"|\\.|_.')  # of a format: what it writes as it is, or leaves room for


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
    with warnings.catch_warnings(action="ignore"):  # of styles and other parts that are not read
        if _has_formulas(content):
            _check_formulas(content)
        return list(_texts(content, remark))


Cells = tuple[Any, ...]  # openpyxl's


def _texts(content: bytes, remark: str) -> Iterator[tuple[int, list[str]]]:
    wanted = 0
    units: list[bool] = []
    for number, row in _rows(content, values=True):
        last = _last_filled(row)
        if not last:
            continue
        if not wanted and not str(row[0].value).startswith(remark):
            wanted, units = last, [_states_percent(cell.value) for cell in row[:last]]
        cells = [_text(cell, number, i < wanted and units[i]) for i, cell in enumerate(row[: max(wanted, last)])]
        yield number, cells + [""] * (wanted - len(cells))


def _rows(content: bytes, values: bool) -> Iterator[tuple[int, Cells]]:
    """Yield (number, cells) of each row of the worksheet, up to the first of many that are empty.

    With `values` cells have those of their formulas, else the formulas.
    """
    try:
        import openpyxl
    except ImportError:
        raise Unreadable(NEEDS) from None
    empty = 0
    try:
        book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=values)
        for sheet in [sheet for sheet in book.worksheets if sheet.sheet_state == "visible"][:1]:
            sheet.reset_dimensions()  # as a file states them: some programs write A1 for any table
            for number, row in enumerate(sheet.iter_rows(), 1):
                empty = 0 if _last_filled(row) else empty + 1
                if empty > MOST_EMPTY:
                    return
                yield number, row
    except Exception as error:  # noqa: BLE001 - openpyxl raises errors of many kinds at files that are none of its own
        raise Unreadable(NOT_ONE.format(type(error).__name__)) from None


def _has_formulas(content: bytes) -> bool:
    """Tell whether any worksheet has a formula; raise Unreadable where a file is none, or too large."""
    import zipfile  # commands import this module for its endings of names

    try:
        with zipfile.ZipFile(io.BytesIO(content)) as packed:
            parts = packed.infolist()
            if sum(part.file_size for part in parts) > MOST_UNPACKED:
                raise Unreadable(f"it holds more than {MOST_UNPACKED // 1_000_000} MB when unpacked")
            sheets = [part for part in parts if part.filename.startswith(WORKSHEETS)]
            return any(FORMULA.search(packed.read(part)) for part in sheets)
    except Unreadable:
        raise
    except Exception as error:  # noqa: BLE001 - zipfile raises errors of many kinds, too
        raise Unreadable(NOT_ONE.format(type(error).__name__)) from None


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
        if PERCENT in LITERAL.sub("", cell.number_format or ""):
            return f"{100.0 * value:.15g}" + ("" if in_percent else f" {PERCENT}")
        return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(float(value))
    return " ".join(str(value).split())


def _check_formulas(content: bytes) -> None:
    """Raise BadCell where a formula has no value, as it was never computed; one of a blank text has."""
    for (number, values), (_, formulas) in zip(_rows(content, values=True), _rows(content, values=False), strict=False):
        for value, formula in zip(values, formulas, strict=False):
            if formula.data_type == "f" and value.value is None and value.data_type != "str":
                what = f"has a formula without a value in {formula.column_letter}{number}"
                raise BadCell(f"{what} (open the workbook in a spreadsheet program, and save it)", number)
