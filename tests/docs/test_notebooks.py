"""The notebooks of docs/notebooks show what their cells give."""

import nbformat
import pytest
from folders import ROOT

from screwsim.study.validation import sibling

pytestmark = pytest.mark.around
notebooks = sibling(ROOT / "docs" / "tools" / "notebooks.py")
PAGES = sorted(notebooks.FOLDER.glob("*.ipynb"))


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_every_cell_gives_what_is_stored(path):
    assert notebooks.check(path) == []


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_a_notebook_begins_with_its_heading_and_draws(path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert notebook.cells[0].source.startswith("# ")
    shown = [notebooks.shown(output) for cell in notebook.cells for output in cell.get("outputs", [])]
    assert shown.count(notebooks.PICTURE) >= 1 and len(shown) >= 5


def stored_as(path, count, *outputs):
    """Write a notebook of two cells, the first with its number of execution, the second with outputs."""
    first = nbformat.v4.new_code_cell("x = 2.0", execution_count=count)
    second = nbformat.v4.new_code_cell("print(f'{x:.3f} W')\nx", execution_count=2, outputs=list(outputs))
    nbformat.write(nbformat.v4.new_notebook(cells=[first, second]), path)


def test_what_is_not_as_stored_is_told(tmp_path):
    path = tmp_path / "x.ipynb"
    value = nbformat.v4.new_output("execute_result", {"text/plain": "2.0"})
    stored_as(path, 1, nbformat.v4.new_output("stream", text="2.000 W\n"), value)
    assert notebooks.check(path) == []
    stored_as(path, 3, nbformat.v4.new_output("stream", text="2.003 W\n"), value)
    assert notebooks.check(path) == ["cell 1 was not run in its turn", "cell 2: gives 2.000, stored is 2.003"]
    stored_as(path, 1, nbformat.v4.new_output("stream", text="2.000 W\n"))
    assert notebooks.check(path) == ["cell 2 shows 2 things, 1 are stored"]


@pytest.mark.parametrize(
    ("stored", "now", "told"),
    [
        ("cop 4.172", "cop  4.173", 0),  # a last digit, and spaces
        ("cop 4.172", "cop 4.175", 1),
        ("12713.141 W", "12714.0 W", 0),  # less than a part in two thousand
        ("12713.141 W", "12730.0 W", 1),
        ("49 points", "50 points", 1),  # a count is a count
        ("3e-05", "4e-05", 0),
        ("3e-05", "5e-05", 1),
        ("effects.gap2", "effects.gap3", 1),  # a name
        ("2.5 kW", "2.5 W", 1),
    ],
)
def test_numbers_may_differ_by_their_rounding_and_words_not_at_all(stored, now, told):
    assert len(notebooks.differences(stored, now)) == told
