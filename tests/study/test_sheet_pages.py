"""The PDF of a data sheet: one page of A4 for the usual one, on it no word over another, outside or too small."""

import re
from dataclasses import replace
from itertools import combinations, pairwise

import pytest
from folders import CONFIGS

import screwsim
from screwsim.cli import exit_code
from screwsim.report.datasheet import write_sheet
from screwsim.report.datasheet_pdf import TYPESETTINGS, pages_of
from screwsim.report.sheet_paper import HIGH, LEAST_PT, MARGIN, WIDE, columns_of, width_of, wrapped
from screwsim.report.style import journal, new_figure
from screwsim.study.datasheet.sheet import Curve, Drawing, Sheet, Table

pytestmark = pytest.mark.around

SLIDE = "machine.slide_valve={position: 0.1, travel: 90 mm, male_span: 70 deg, female_span: 60 deg}"
SHIPPED = {  # what is asked of each: the scene, changes, options
    "refrigeration": ("control/point", (), {"limits": ["discharge_temperature<110 degC"]}),
    "heat pump": ("control/point", (), {"heating": True, "condensing": "40 degC..55 degC"}),
    "map": ("r134a/map", (), {}),
    "slide valve": ("rotors/b", (SLIDE, "effects.slide_valve={}", "numerics.accuracy=1e-3"), {}),
    "air, variable speed": ("air/variable_speed_7", (), {}),
    "air, fixed speed": ("air/fixed_speed_10", (), {}),
    "air over pressures": ("air/variable_speed_7", (), {"discharge": "8, 8.5, 11, 14 bar"}),
    "humid air": ("air/humid_package", (), {}),
    "gas": ("paper/point", (), {}),
    "expander": ("expander/point", (), {}),
    "two stages of air": ("two_stage/air.stages", (), {}),
    "two stages": (
        "two_stage/plant.stages",
        (),
        {"evaporating": "-35 degC..-30 degC", "condensing": "35 degC..40 degC", "heating": True},
    ),
}
DPI = 300.0  # letters are set to whole pixels where their width is measured, not in the PDF
NEAR = 1.2  # [pixel], 0.1 mm: letters touch
FOOT = 5.0  # [mm] that no printer leaves out


@pytest.fixture(scope="module")
def shipped():
    sheets = {}

    def made(name):
        if name not in sheets:
            scene, changes, options = SHIPPED[name]
            file = CONFIGS / f"{scene}.yaml"
            given = file if scene.endswith(".stages") else screwsim.load(file, changes)
            sheets[name] = screwsim.datasheet(given, jobs=1, **options)
        return sheets[name]

    return made


def count_of(file):
    """Return the pages of a PDF, and the set of their sizes [mm]."""
    raw = file.read_bytes()
    boxes = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", raw)
    return len(re.findall(rb"/Type /Page\b", raw)), {
        tuple(round(float(side) * 25.4 / 72) for side in box) for box in boxes
    }


def words_of(figure):
    """Return (text, box [pixel], size [pt]) of everything that is written on a page, ticks that are drawn among it."""
    texts = list(figure.texts)
    for axes in figure.axes:
        texts += [axes.xaxis.label, axes.yaxis.label]
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            room = 1e-9 * (high - low)
            ticks = zip(axis.get_ticklocs(), axis.get_ticklabels(), strict=True)
            texts += [label for at, label in ticks if low - room <= at <= high + room]
    return [
        (text.get_text(), text.get_window_extent(), text.get_fontsize()) for text in texts if text.get_text().strip()
    ]


def over(one, other):
    """Tell whether two boxes lie over one another."""
    across = min(one.x1, other.x1) - max(one.x0, other.x0)
    return across > NEAR and min(one.y1, other.y1) - max(one.y0, other.y0) > NEAR


def faults_of(figure):
    """Return what is wrong on a page: words outside, over words, over a drawing, or too small."""
    figure.set_dpi(DPI)
    figure.draw_without_rendering()
    words, found, mm = words_of(figure), [], figure.bbox.x1 / WIDE
    for text, box, size in words:
        across, up = min(box.x0, figure.bbox.x1 - box.x1), min(box.y0, figure.bbox.y1 - box.y1)
        inside = min(across - (MARGIN - 0.5) * mm, up - FOOT * mm) >= 0.0
        found += [] if inside else [f"{text!r} runs off the page"]
        found += [] if size >= LEAST_PT else [f"{text!r} has {size} pt"]
        found += [f"{text!r} lies over a drawing" for axes in figure.axes if over(box, axes.bbox)]
    found += [f"{a[0]!r} lies over {b[0]!r}" for a, b in combinations(words, 2) if over(a[1], b[1])]
    return found


def faults(sheet):
    with journal():
        return [fault for page in pages_of(sheet) for fault in faults_of(page)]


@pytest.mark.parametrize("name", SHIPPED)
def test_the_sheet_of_a_shipped_scene_is_one_page_that_can_be_read(shipped, name, tmp_path):
    sheet, file = shipped(name), tmp_path / "sheet.pdf"
    assert write_sheet(sheet, file) == str(file)
    assert count_of(file) == (1, {(210, 297)})
    assert faults(sheet) == []


def test_all_that_the_sheet_says_is_on_its_page(shipped):
    sheet = shipped("refrigeration")
    with journal():
        (page,) = pages_of(sheet)
    shown = [text.get_text() for text in page.texts]
    for table in sheet.tables:
        assert table.title in shown
        assert not [cell for row in table.rows for cell in row if cell and shown.count(cell) == 0]
    said = " ".join(shown).replace("\u00a0", " ")
    assert all(note in said for note in sheet.notes) and all(words in said for _, words in sheet.lines)
    assert len(page.axes) == len(sheet.drawings) == 4


def test_faults_of_a_page_are_seen():
    with journal():
        page = new_figure(WIDE, HIGH)
        page.set_layout_engine("none")
        page.add_axes((0.1, 0.1, 0.3, 0.3), xticks=(), yticks=())
        for x, y, words, size in ((0.5, 0.5, "a", 8), (0.5, 0.5, "b", 8), (0.99, 0.9, "off", 8), (0.2, 0.2, "c", 6)):
            page.text(x, y, words, fontsize=size)
        found = faults_of(page)
    assert found == [
        "'off' runs off the page", "'c' has 6.0 pt", "'c' lies over a drawing", "'a' lies over 'b'",
    ]  # fmt: skip


def test_three_drawings_stand_in_a_row(shipped):
    sheet = shipped("refrigeration")
    with journal():
        (page,) = pages_of(replace(sheet, drawings=sheet.drawings[:3]))
        places = [axes.get_position() for axes in page.axes]
        assert faults_of(page) == []
    assert len(places) == 3
    assert all(a.x1 < b.x0 and a.y0 < b.y1 and b.y0 < a.y1 for a, b in pairwise(places))


# ---- more than a page holds --------------------------------------------------------------------------------------


def grid(rows, columns, title="Cooling capacity [kW]"):
    heads = ["condensing", *(f"{i - 40} °C" for i in range(columns))]
    cells = [[f"{j} °C", *(f"{100.0 + i * j:.1f}*" for i in range(columns))] for j in range(rows)]
    return Table(title, heads, cells, "* beyond a limit")


def sheet_with(*tables, curves=5, notes=("a note",)):
    drawn = [Curve(range(5), [i + j for j in range(5)], f"condensing {i} °C") for i in range(curves)]
    drawings = [Drawing("Cooling capacity [kW]", "evaporating [°C]", "Cooling capacity [kW]", drawn)] * 4
    return Sheet("heading", "title", [("point", "words " * 40)], list(tables), None, notes, drawings)


@pytest.mark.parametrize(
    ("rows", "columns", "tables", "pages"),
    [(3, 3, 6, 1), (8, 7, 6, 1), (15, 14, 6, 2), (300, 4, 2, 4), (120, 4, 2, 2), (4, 60, 2, 1)],
)
def test_tables_of_any_size_are_laid_without_faults_and_without_loss(rows, columns, tables, pages):
    sheet = sheet_with(*(grid(rows, columns) for _ in range(tables)))
    with journal():
        found = pages_of(sheet)
        assert [fault for page in found for fault in faults_of(page)] == []
    assert len(found) == pages
    shown = [text.get_text() for page in found for text in page.texts]
    for j in range(1, rows):
        assert shown.count(f"{100.0 + (columns - 1) * j:.1f}*") >= tables


def test_a_second_page_is_told_and_numbered(tmp_path, capsys):
    file = tmp_path / "sheet.pdf"
    wide = ["--evaporating", "-30 degC..10 degC", "--condensing", "20 degC..60 degC", "--jobs", "1"]
    exit_code(["datasheet", str(CONFIGS / "control" / "point.yaml"), *wide, "-o", str(file)])
    told = capsys.readouterr().out.splitlines()[-1]
    assert told == f"{file} (2 pages: one page cannot hold that much in type of 6.5 pt; ask for fewer points)"
    assert count_of(file) == (2, {(210, 297)})


def test_type_is_as_large_as_the_page_allows():
    sizes = []
    for rows in (3, 6, 8, 10):
        with journal():
            (page,) = pages_of(sheet_with(*(grid(rows, 6) for _ in range(6))))
        sizes.append(next(text.get_fontsize() for text in page.texts if text.get_text() == "condensing"))
    assert sizes == sorted(sizes, reverse=True) and sizes[0] == TYPESETTINGS[0].size > sizes[-1] >= LEAST_PT


def test_many_curves_have_their_own_names_and_looks():
    with journal():
        (page,) = pages_of(sheet_with(grid(3, 3), curves=12))
        assert faults_of(page) == []
    looks = [(line.get_color(), line.get_linestyle()) for line in page.axes[0].lines]
    assert len(set(map(str, (line.get_color() for line in page.axes[0].lines)))) == len(looks) == 12


# ---- words -------------------------------------------------------------------------------------------------------


def test_wrapped_words_fit_and_none_is_lost():
    words = "over the table: shaft power 63.01 kW at 10/55 °C, and effects.motor.rated_power_that_never_ends_at_all"
    for width in (20.0, 45.0, 200.0):
        rows = wrapped(words, width, 7.0)
        assert max(width_of(row, 7.0) for row in rows) <= width
        assert "".join(rows).replace("\u00a0", "").replace(" ", "") == words.replace(" ", "")
    assert any("63.01\u00a0kW" in row for row in wrapped(words, 45.0, 7.0))  # a number keeps its unit


def test_a_column_has_room_for_its_cells_and_the_words_of_its_head():
    columns = columns_of(Table("t", ["load %", "discharge °C"], [["100", "68.2"]]), 7.0)
    assert columns.heads == [["load", "%"], ["discharge", "°C"]]
    assert columns.widths[0] >= width_of("load", 7.0) and columns.widths[1] > width_of("discharge", 7.0)
    assert columns_of(Table("t", ["load %", "discharge °C"], [["100", "68.2"]]), 7.0, 100.0).deep == 1
