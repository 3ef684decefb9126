"""Tables in workbooks are read and written as those in CSV files are."""

import csv
import datetime
import re
import zipfile

import openpyxl
import pytest

from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import BadSheet, read_sheet, sheet_of
from screwsim.inputs.textfiles import Unreadable
from screwsim.results.protection import protect_other_heads
from screwsim.results.tables import write_table


def book_of(path, *rows, percent=()):
    """Write rows as a workbook; return its path. Cells at the places `percent` are shown in percent."""
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    for place in percent:
        book.active[place].number_format = "0.0%"
    book.save(path)
    return path


def test_a_workbook_is_the_table_that_its_csv_file_is(tmp_path):
    text = '# bench, 2024\n\nname,speed [rpm],power [kW],note\n"a, b",3000,12.5,\nc,1500,0.1,warm\n'
    rows = [["# bench, 2024"], [], ["name", "speed [rpm]", "power [kW]", "note"], ["a, b", 3000, 12.5], []]
    found, same = read_sheet(book_of(tmp_path / "x.xlsx", *rows, ["c", 1500.0, 0.1, "warm"])), sheet_of(text)
    assert found.records() == same.records()
    assert [row.line for row in found.rows] == [4, 6]


def test_numbers_keep_all_their_digits(tmp_path):
    numbers = [0.1, 1e-12, 123456789.125, -7.0, 1e300]
    found = read_sheet(book_of(tmp_path / "x.xlsx", ["x"], *([number] for number in numbers)))
    assert [value for (value,) in found.numbers("x", words="")] == numbers


def test_a_cell_shown_in_percent_has_its_number_in_percent(tmp_path):
    path = book_of(tmp_path / "x.xlsx", ["eta [%]", "ratio", "plain [%]"], [0.815, 0.05, 81.5], percent=("A2", "B2"))
    assert read_sheet(path).rows[0].cells == ("81.5", "5 %", "81.5")


def test_a_sign_behind_a_number_that_a_format_only_writes_is_no_part_of_it(tmp_path):
    book = openpyxl.Workbook()
    book.active.append(["eta [%]", "load"])
    book.active.append([81.5, 90])
    book.active["A2"].number_format, book.active["B2"].number_format = '0.0" %"', r"0\%"
    book.save(tmp_path / "x.xlsx")
    assert read_sheet(tmp_path / "x.xlsx").rows[0].cells == ("81.5", "90")


def test_a_plain_number_that_is_shown_in_percent_is_told_with_its_line(tmp_path):
    path = book_of(tmp_path / "x.xlsx", ["load", "efficiency"], [0.5, 0.9], percent=("B2",))
    with pytest.raises(BadSheet, match=r"line 2: has '90 %', and a plain number is needed"):
        read_sheet(path).numbers("load", "efficiency", words="")


def changed(path, part, pattern, by):
    """Replace what matches a pattern in a part of a workbook; return its path."""
    with zipfile.ZipFile(path) as book:
        parts = {name: book.read(name).decode() for name in book.namelist()}
    parts[part], count = re.subn(pattern, by, parts[part], flags=re.DOTALL)
    assert count
    with zipfile.ZipFile(path, "w") as book:
        for name, text in parts.items():
            book.writestr(name, text)
    return path


SHEET = "xl/worksheets/sheet1.xml"


def test_all_cells_are_read_whatever_size_a_program_states(tmp_path):
    path = book_of(tmp_path / "x.xlsx", ["x", "y"], [1, 2], [3, 4])
    changed(path, SHEET, r'<dimension ref="[^"]*"', '<dimension ref="A1"')
    assert [row.cells for row in read_sheet(path).rows] == [("1", "2"), ("3", "4")]


def test_styles_that_a_program_leaves_out_are_nothing_to_warn_of(tmp_path, recwarn):
    path = changed(book_of(tmp_path / "x.xlsx", ["x"], [1]), "xl/styles.xml", "<cellStyles.*</cellStyles>", "")
    assert read_sheet(path).rows[0].cells == ("1",)
    assert not recwarn.list


def test_a_formula_that_gave_a_blank_text_is_an_empty_cell(tmp_path):
    path = book_of(tmp_path / "x.xlsx", ["x", "y"], [1, '=IF(A2=2,A2,"")'], ["=A5", "=A5"])
    changed(path, SHEET, r'<c r="(A3|B2|B3)"[^>]*>', r'<c r="\1" t="str">')
    assert [row.cells for row in read_sheet(path).rows] == [("1", "")]


def test_only_the_first_visible_worksheet_is_read(tmp_path):
    book = openpyxl.Workbook()
    book.active.append(["hidden"])
    book.active.sheet_state = "hidden"
    book.create_sheet("shown").append(["x"])
    book.create_sheet("other").append(["y"])
    book.save(tmp_path / "x.xlsx")
    assert read_sheet(tmp_path / "x.xlsx").names == ("x",)


def test_other_cells_are_texts(tmp_path):
    row = [True, datetime.datetime(2024, 5, 1), "  two\nlines "]
    cells = read_sheet(book_of(tmp_path / "x.xlsx", ["a", "b", "c"], row)).rows[0].cells
    assert cells == ("true", "2024-05-01 00:00:00", "two lines")


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ([["x", "y"], [1, "=A2*2"]], "line 2: has a formula without a value in B2"),
        ([["x", "y"], [1, 2], ["=A2", "=B2"]], "line 3: has a formula without a value in A3"),
        ([["x", "y"], [1, "#DIV/0!"]], "line 2: has the error #DIV/0! in B2"),
        ([["x"], [1, 2]], "line 2: has 2 cells, but the first line has 1 (leave the rest out"),
        ([["x", "x"], [1, 2]], "line 1: has the column 'x' twice"),
        ([["name", "x"], ["#3", 2]], "line 2: begins with #, but has as many cells as a row"),
    ],
)
def test_a_bad_cell_is_told_with_its_place(tmp_path, rows, told):
    with pytest.raises(BadSheet) as fault:
        read_sheet(book_of(tmp_path / "x.xlsx", *rows))
    assert str(fault.value).startswith(told)


def test_a_file_that_is_no_workbook_says_so(tmp_path):
    (tmp_path / "x.xlsx").write_text("x,y\n1,2\n")
    with pytest.raises(Unreadable, match="it is not a workbook"):
        read_sheet(tmp_path / "x.xlsx")
    (tmp_path / "x.xls").write_bytes(b"\xd0\xcf\x11\xe0")
    with pytest.raises(Unreadable, match=r"read as \.xlsx, not as \.xls"):
        read_sheet(tmp_path / "x.xls")
    with pytest.raises(Unreadable, match="No such file"):
        read_sheet(tmp_path / "none.xlsx")


def test_a_file_that_grows_when_it_is_unpacked_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("screwsim.inputs.workbooks.MOST_UNPACKED", 1000)
    with pytest.raises(Unreadable, match="when unpacked"):
        read_sheet(book_of(tmp_path / "x.xlsx", ["x"], [1]))


def test_without_openpyxl_the_remedy_is_told(tmp_path, monkeypatch):
    path = book_of(tmp_path / "x.xlsx", ["x"], [1])
    monkeypatch.setitem(__import__("sys").modules, "openpyxl", None)
    with pytest.raises(Unreadable, match=r"pip install 'screwsim\[excel\]'"):
        read_sheet(path)
    with pytest.raises(UsageError, match=r"pip install 'screwsim\[excel\]'"):
        write_table(tmp_path / "y.xlsx", ["x"], [[1]])
    assert not (tmp_path / "y.xlsx").exists()


def test_a_written_workbook_holds_the_numbers_of_the_csv_file(tmp_path):
    heads = ["speed [rpm]", "status", "power [kW]", "run"]
    rows = [["3000", "ok", "12.3456789", "7"], ["1500", "=1+1", "", "seven"]]
    write_table(tmp_path / "x.csv", heads, rows)
    write_table(tmp_path / "x.xlsx", heads, rows)
    with (tmp_path / "x.csv").open(newline="") as stream:
        assert [list(row.cells) for row in read_sheet(tmp_path / "x.xlsx").rows] == list(csv.reader(stream))[1:]
    sheet = openpyxl.load_workbook(tmp_path / "x.xlsx").active
    kinds = [[cell.data_type for cell in row] for row in sheet.iter_rows(min_row=2)]
    assert kinds == [["n", "s", "n", "s"], ["n", "s", "n", "s"]]  # =1+1 is no formula, the empty cell no text
    assert sheet["C2"].value == 12.3456789
    assert sheet.freeze_panes == "A2"


def test_a_column_of_words_holds_texts_alone(tmp_path):
    rows = [[1_0, "1_0", True, ("a", 1)], [2.5, "2", False, None]]
    write_table(tmp_path / "x.xlsx", ["number", "name", "good", "pair"], rows)
    assert [row.cells for row in read_sheet(tmp_path / "x.xlsx").rows] == [
        ("10", "1_0", "True", "('a', 1)"),
        ("2.5", "2", "False", ""),
    ]


def test_more_rows_than_a_workbook_holds_are_a_table_of_csv(tmp_path, monkeypatch):
    monkeypatch.setattr("screwsim.results.tables.MOST_LINES", 2)
    write_table(tmp_path / "x.xlsx", ["x"], [[1]])
    with pytest.raises(UsageError, match=r"a workbook holds fewer rows than 2 \(write .*y\.csv"):
        write_table(tmp_path / "y.xlsx", ["x"], [[1], [2]])


def test_a_workbook_of_something_else_is_not_replaced(tmp_path):
    path = book_of(tmp_path / "x.xlsx", ["mine"], [1])
    for content in (path.read_bytes(), b"no workbook"):
        path.write_bytes(content)
        with pytest.raises(UsageError, match="is not a file of this kind"):
            protect_other_heads(path, lambda heads: "status" in heads)
    write_table(path, ["status"], [["ok"]])
    protect_other_heads(path, lambda heads: "status" in heads)
    path.write_bytes(b"")  # such as programs create in advance
    protect_other_heads(path, lambda heads: "status" in heads)


def test_faults_name_a_cell_of_a_worksheet_by_its_column(tmp_path):
    (row,) = read_sheet(book_of(tmp_path / "x.xlsx", ["a", "b", "c"], ["one, two", None, 3])).rows
    assert row.places == (1, 2, 3)
    assert sheet_of('a,b,c\n"one, two",,3\n').rows[0].places == (1, 12, 13)
