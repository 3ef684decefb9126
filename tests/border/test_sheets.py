"""Tables in CSV: a cell a column, or one line with its number; the same rule wherever a table is read."""

import numpy as np
import pytest
from small_scene import SCENE

from screwsim.effects.motor import read_table as read_motor
from screwsim.effects.parts import inverter
from screwsim.fluid import solubility_laws
from screwsim.inputs import sheets
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.inputs.sheets import MOST_ROWS, BadSheet, read_sheet, sheet_of
from screwsim.machine.rotors.imported import read_profile
from screwsim.numerics.spline import read_curve
from screwsim.scene import load
from screwsim.study.validation import NotRun, read_table

DECIMAL_COMMAS = "has 3 cells, but the first line has 2 (write decimal points, not decimal commas: one cell per column)"
SWEPT = SCENE + "sweep:\n  operation.speed: {file: speeds.csv, column: speed, unit: rpm}\n"


def test_comments_and_empty_lines_say_nothing_and_lines_keep_their_numbers():
    sheet = sheet_of('# source\n\na, b\n  # more\n"1,5", 2\n')
    assert sheet.names == ("a", "b")
    assert sheet.records() == [{"a": "1,5", "b": "2"}]
    assert sheet.columns("b") == [(5, ("2",))]


def test_a_row_whose_name_begins_with_a_hash_is_not_left_out_without_a_word():
    with pytest.raises(BadSheet, match="line 3: begins with #, but has as many cells as a row"):
        sheet_of("name,a\nx,1\n#3,2\n")
    kept = sheet_of('# source, of two parts\nname,a\nx,1\n"#3",2\n# 4,3\n#remark\n#1,2,3\n')
    assert kept.records() == [{"name": "x", "a": "1"}, {"name": "#3", "a": "2"}]
    assert sheet_of("name,a\nx,1\n#y,2\n").records() == [{"name": "x", "a": "1"}]  # no number: left out
    assert sheet_of("a,b\n1,2\n#3,4\n").records() == [{"a": "1", "b": "2"}]  # numbers have no hash: left out


@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
def test_all_ends_of_lines_are_read_alike(ends, tmp_path):
    (tmp_path / "x.csv").write_bytes(f"\ufeffa,b{ends}1,2{ends}".encode())
    assert read_sheet(tmp_path / "x.csv").records() == [{"a": "1", "b": "2"}]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a,b\n1,2\n650,0,004\n", "line 3: " + DECIMAL_COMMAS),
        ("a,b\n1\n", "line 2: has 1 cell, but the first line has 2 (fill the row: one cell per column)"),
        ("a,b\n1,2,\n", "line 2: has 3 cells"),
        ("a,a\n1,2\n", "line 1: has the column 'a' twice (remove one)"),
        ('a,b\n"1,2\n', "line 2: is not CSV: unexpected end of data"),
        ("a,b\n" + "1" * 200_000 + ",2\n", "line 2: holds a cell that is too long"),
        ("a,b\n" + "," * 5000 + "\n", "line 2: has 5001 cells (at most 4096 are allowed)"),
        ("a,b\n" + "1,2\n" * (MOST_ROWS + 1), "has 200001 rows (at most 200000 are read; leave some out)"),
    ],
    ids=["decimal commas", "too few", "a comma at the end", "twice", "quote", "long", "wide", "many"],
)
def test_what_is_no_table_is_told_with_its_line(text, said):
    with pytest.raises(BadSheet) as caught:
        sheet_of(text)
    assert str(caught.value).startswith(said)


def test_a_missing_column_is_told_with_those_that_are_there():
    with pytest.raises(BadSheet, match=r"needs the columns a and c \(found: a, b\)"):
        sheet_of("a,b\n1,2\n").columns("a", "c")


def split(tmp_path, names: str) -> str:
    """Return the path of a table of two columns whose third line has a decimal comma."""
    path = tmp_path / "x.csv"
    path.write_text(f"{names}\n1,0.5\n2,0,6\n3,0.7\n", encoding="utf-8")
    return str(path)


@pytest.mark.parametrize(
    ("read", "names", "kind"),
    [
        (lambda path: read_curve(path, "area_m2"), "angle_deg,area_m2", UsageError),
        (read_motor, "load,efficiency", UsageError),
        (read_profile, "x_mm,y_mm", UsageError),
        (read_table, "a,b", NotRun),
    ],
    ids=["curve", "motor", "profile", "validation"],
)
def test_a_decimal_comma_is_a_fault_in_every_kind_of_table(read, names, kind, tmp_path):
    with pytest.raises(kind) as caught:
        read(split(tmp_path, names))
    assert f"line 3: {DECIMAL_COMMAS}" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_decimal_comma_in_a_swept_column_is_a_fault_at_the_axis(tmp_path):
    (tmp_path / "x.yaml").write_text(SWEPT, encoding="utf-8")
    (tmp_path / "speeds.csv").write_text("speed,note\n1000,a\n2000,5,b\n", encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        load(tmp_path / "x.yaml")
    (line,) = caught.value.lines
    assert line.endswith(f"x.yaml:18:20: sweep.operation.speed: speeds.csv line 3: {DECIMAL_COMMAS}")


def test_tabs_between_cells_are_told():
    """Not as decimal commas, which such files have as well."""
    told = r"^line 1: is separated by tabs \(save it with commas between cells and decimal points\)$"
    with pytest.raises(BadSheet, match=told):
        sheet_of("angle\tvolume\n0,5\t1,25\n")


# ---- semicolons between cells, as Excel writes where the decimal sign is a comma ----


def test_semicolons_and_decimal_commas_are_the_table_of_commas_and_points():
    points = sheet_of('name,T [degC],p,n\n2.4.1,-.5,1.25e-3 bar,1000\n"1,5",+3.000,7,2\n')
    commas = sheet_of("name;T [degC];p;n\n2.4.1;-,5;1,25e-3 bar;1000\n1,5;+3,000;7;2\n")
    assert commas.names == points.names and commas.records() == points.records()
    assert commas.records()[1] == {"name": "1,5", "T [degC]": "+3.000", "p": "7", "n": "2"}


def test_semicolons_between_names_in_quotes_are_read():
    assert sheet_of('"a";"b, c"\n1,5;2\n').records() == [{"a": "1.5", "b, c": "2"}]


def test_semicolons_with_decimal_points_or_whole_numbers_are_read_as_they_stand():
    assert sheet_of("a;b\n1.5;2.250\n").records() == [{"a": "1.5", "b": "2.250"}]
    assert sheet_of("a;b\n1;2000\n").records() == [{"a": "1", "b": "2000"}]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "a;b\n1,5;2\n3;1.5\n",
            "line 3: '1.5' and '1,5' have different decimal signs (write all with commas, or all with points)",
        ),
        (
            "a;b\n1;2\n3;-3,000\n",
            "line 3: '-3,000' may have a comma for thousands or decimals (write -3000, or -3,0000)",
        ),
        ("a;b\n1.234;2 rpm\n", "line 2: '1.234' may have a point for thousands or decimals (write 1234, or 1.2340)"),
        ("a;b\n1,5;2;\n", "line 2: has 3 cells, but the first line has 2 (leave the rest out: one cell per column)"),
        ("name;b\nx;1,5\n#3;2\n", "line 3: begins with #, but has as many cells as a row"),
    ],
)
def test_a_table_with_semicolons_of_which_a_number_may_be_another_is_refused(text, said):
    with pytest.raises(BadSheet) as caught:
        sheet_of(text)
    assert str(caught.value).startswith(said)


def test_thousands_with_decimals_are_left_for_the_reader_of_numbers_to_refuse():
    assert sheet_of("a;b\n1.234,5;0,5\n").records() == [{"a": "1.234,5", "b": "0.5"}]


def test_a_curve_with_semicolons_is_that_with_commas(tmp_path):
    for name, text in (("points", "angle_deg,area_m2\n0,0\n90,.004\n180,0.0025\n"), ("commas", None)):
        text = text or "angle_deg;area_m2\n0;0\n90;,004\n180;0,0025\n"
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8-sig")
    one, other = (read_curve(str(tmp_path / f"{name}.csv"), "area_m2") for name in ("points", "commas"))
    assert all(np.array_equal(mine, its) for mine, its in zip(one, other, strict=True))


@pytest.mark.parametrize(
    ("read", "head", "row"),
    [
        (lambda path: read_curve(path, "area_m2"), "angle_deg,area_m2", "{0}0,0.00{1}"),
        (read_motor, "load,efficiency", "0.{0},0.9{1}"),
        (inverter.read_points, "speed,current,loss", "0.{0},1,{1}00"),
        (lambda path: solubility_laws.read_points(path, "R134a"), ",".join(solubility_laws.COLUMNS), "{0}0,1.{1},9"),
    ],
    ids=["curve", "motor", "inverter", "solubility"],
)
def test_a_file_that_a_scene_names_is_read_once_until_it_changes(read, head, row, tmp_path, monkeypatch):
    reads, path = [], tmp_path / "x.csv"
    monkeypatch.setattr(sheets, "read_text", lambda *a, text=sheets.read_text: reads.append(a) or text(*a))

    def write(last):
        text = "\n".join([head, *(row.format(i, i) for i in (1, 2, 3)), row.format(4, last)]) + "\n"
        (tmp_path / "new.csv").write_text(text)
        (tmp_path / "new.csv").replace(path)

    write(4)
    first = read(str(path))
    assert read(str(path)) is first and len(reads) == 1
    write(5)
    assert str(read(str(path))) != str(first) and len(reads) == 2
