"""Tables on disk: a line of heads and rows below it, as CSV or as a workbook (.xlsx), by the ending of the name."""

import contextlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.inputs.workbooks import NEEDS, TABLES, is_workbook
from screwsim.results.atomic import replacing, write_csv
from screwsim.version import version

NARROWEST, WIDEST = 8, 28  # characters, of the columns of a workbook
LINE_HEIGHT = 15.0  # points
MOST_LINES = 1_048_576  # of a worksheet


def check_workbook(path: Path) -> None:
    """Raise UsageError where a workbook is to be written and openpyxl is not installed."""
    if is_workbook(path):
        try:
            import openpyxl  # noqa: F401
        except ImportError:
            raise UsageError(f"{path}: {NEEDS}") from None


def write_table(path: Path, heads: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """Write a table atomically, and return its path; raise UsageError as `replacing` does, or without openpyxl.

    In a workbook a cell that reads as a number is one if all of its column are, or are empty; else all are texts.
    """
    if not is_workbook(path):
        return write_csv(path, heads, rows)
    check_workbook(path)
    cells = [list(row) for row in rows]
    if len(cells) >= MOST_LINES:
        raise UsageError(f"{path}: a workbook holds fewer rows than {len(cells)} (write {path.with_suffix(TABLES[0])})")
    with replacing(path) as temporary:
        _write_workbook(temporary, list(heads), cells)
    return str(path)


def _write_workbook(path: Path, heads: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    from openpyxl import Workbook
    from openpyxl.styles import Alignment, Font
    from openpyxl.utils import get_column_letter

    book = Workbook()
    book.properties.creator = f"screwsim {version()}"
    sheet = book.active
    assert sheet is not None  # of a new workbook
    for i, (head, cells) in enumerate(zip(heads, _columns(rows, len(heads)), strict=True), 1):
        numbers = _as_numbers(cells)
        for row, value in enumerate((head, *(_as_texts(cells) if numbers is None else numbers)), 1):
            cell = sheet.cell(row, i, value)
            if isinstance(value, str):
                cell.data_type = "s"  # never a formula
        top = sheet.cell(1, i)
        top.font, top.alignment = Font(bold=True), Alignment(wrap_text=True, vertical="bottom")
        words = max((len(word) for word in head.split()), default=0)
        longest = max((len(str(cell)) for cell in cells), default=0)
        sheet.column_dimensions[get_column_letter(i)].width = min(max(words, longest, NARROWEST), WIDEST) + 2
    lines = max((1 + len(head) // NARROWEST for head in heads), default=1)
    sheet.row_dimensions[1].height = LINE_HEIGHT * min(lines, 4)
    sheet.freeze_panes = "A2"
    sheet.auto_filter.ref = sheet.dimensions
    book.save(path)


def _columns(rows: Sequence[Sequence[Any]], count: int) -> list[list[Any]]:
    return [[row[i] for row in rows] for i in range(count)]


def _as_numbers(cells: Sequence[Any]) -> list[float | None] | None:
    """Return the numbers of a column, None for an empty cell; None where one is neither."""
    found: list[float | None] = []
    for cell in cells:
        number = None
        if cell not in ("", None):
            text = str(cell)
            if "_" not in text:  # Python reads 1_0 as 10
                with contextlib.suppress(ValueError):
                    number = float(text)
            if number is None or number - number != 0.0:  # no number, or none that a workbook can hold
                return None
        found.append(number)
    return found


def _as_texts(cells: Sequence[Any]) -> list[str | None]:
    """Return the texts of a column as a CSV file has them, None for an empty cell."""
    return [None if cell in ("", None) else str(cell) for cell in cells]
