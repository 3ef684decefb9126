"""Progress in a notebook: a bar that is drawn in one place, by itself, and says at its end what was done."""

import sys
from types import SimpleNamespace

import IPython.display
import nbformat
import pytest
from folders import ROOT

import screwsim
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import NotebookBar, Progress, for_program
from screwsim.study.seek.trials import ReportedSimulation
from screwsim.study.validation import sibling

pytestmark = pytest.mark.around
POINT = "configs/paper/point.yaml"


@pytest.fixture
def drawn(monkeypatch):
    """Let this be a notebook; return what is drawn in it."""
    found = []
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: SimpleNamespace(kernel=object())))
    monkeypatch.setattr(IPython.display, "publish_display_data", lambda **drawing: found.append(drawing))
    return found


def texts(drawn):
    return [drawing["data"]["text/plain"] for drawing in drawn]


def test_a_bar_is_drawn_in_one_place_and_ends_with_what_was_done():
    drawn = []
    bar = NotebookBar("a <sweep>", publish=lambda **drawing: drawn.append(drawing), every=0.0)
    bar.start(40, 10)
    bar.advance(10, 0)
    bar.advance(20, 1)
    bar.tick()
    bar.stop()
    assert [drawing["update"] for drawing in drawn] == [False, True, True, True, True]
    assert len({drawing["transient"]["display_id"] for drawing in drawn}) == 1
    assert all(drawing["metadata"] == {"screwsim": "progress"} for drawing in drawn)
    first, second, *_, last = texts(drawn)
    assert first == "a <sweep>: 10 of 40" and last == "a <sweep>: 40 of 40, 1 not ok"
    assert second.startswith("a <sweep>: 20 of 40, ") and "points/s, " in second and second.endswith(" left")
    html = drawn[-1]["data"]["text/html"]
    assert "a &lt;sweep&gt;" in html and '<progress max="40" value="40"' in html and "40 of 40, 1 not ok" in html


@pytest.mark.parametrize(
    ("seconds", "told"), [(99.4, "99 s"), (100.0, "2 min"), (5990.0, "100 min"), (6000.0, "1.7 h"), (9000.0, "2.5 h")]
)
def test_the_time_left_is_told_in_the_unit_of_its_size(seconds, told):
    drawn, now = [], [0.0]
    bar = NotebookBar("sweep", lambda **drawing: drawn.append(drawing), every=0.0, clock=lambda: now[0])
    bar.start(2, 0)
    now[0] = seconds
    bar.advance(1, 0)
    assert texts(drawn)[-1].endswith(f" points/s, {told} left")


def test_a_bar_is_not_drawn_for_every_case():
    drawn = []
    bar = NotebookBar("sweep", publish=lambda **drawing: drawn.append(drawing), every=1e9)
    bar.start(1000, 0)
    for _ in range(1000):
        bar.advance(1, 0)
    bar.stop()
    assert texts(drawn) == ["sweep: 0 of 1000", "sweep: 1000 of 1000"]


def test_a_bar_that_never_began_draws_nothing():
    drawn = []
    bar = NotebookBar("sweep", publish=lambda **drawing: drawn.append(drawing))
    bar.tick()
    bar.stop()
    assert drawn == []


def test_a_study_that_ends_early_says_how_far_it_came(drawn):
    def stops(number):
        if number == 2:
            raise KeyboardInterrupt
        return number

    with pytest.raises(KeyboardInterrupt):
        parallel_map(stops, 5, died=lambda number: number, jobs=1, progress=for_program("study"))
    assert texts(drawn)[-1] == "study: 2 of 5"


def test_a_bar_is_there_in_a_notebook_alone(drawn, monkeypatch):
    assert isinstance(for_program("x"), NotebookBar) and isinstance(for_program("x", True), NotebookBar)
    assert type(for_program("x", False)) is Progress
    for plain in (SimpleNamespace(kernel=None), None):  # a shell of IPython, a module that nobody runs
        monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda plain=plain: plain))
        assert type(for_program("x")) is Progress
    assert drawn == []


STUDIES = {
    "sweep": lambda scene, **how: screwsim.sweep(scene.with_({"sweep.oil_supply.ratio": [1, 2]}), jobs=1, **how),
    "optimum": lambda scene, **how: screwsim.optimum(scene, "oil_supply.ratio", low=0.5, high=2, jobs=1, **how),
    "optimize": lambda scene, **how: screwsim.optimize(
        scene, ["oil_supply.ratio=0.5..2"], ["isothermal_efficiency"], evaluations=20, jobs=1, **how
    ),
    "find": lambda scene, **how: screwsim.find(scene, ["operation.speed"], ["gas_mass_flow=0.3 kg/s"], **how),
    "calibrate": lambda _, **how: screwsim.calibrate("configs/calibration/leakage.fit.yaml", jobs=1, **how),
    "sensitivities": lambda _, **how: screwsim.sensitivities(
        "configs/slider_crank/air.yaml", ["operation.speed"], ["shaft_power"], **how
    ),
}


@pytest.mark.parametrize("name", STUDIES)
def test_studies_draw_a_bar_by_themselves(name, drawn, monkeypatch):
    # differences of cycles have steps, exact derivatives have none
    monkeypatch.setattr("screwsim.derivatives.collocation.MOST_EVENTS", 0)
    STUDIES[name](screwsim.load(POINT))
    assert texts(drawn), name
    done, _, count = texts(drawn)[-1].removeprefix(f"{name}: ").partition(" of ")
    assert int(done) <= int(count) and '<progress max="' in drawn[-1]["data"]["text/html"]


@pytest.mark.parametrize("name", ["sweep", "optimize", "find"])
def test_a_bar_that_is_not_wanted_is_not_drawn(name, drawn):
    STUDIES[name](screwsim.load(POINT), progress=False)
    assert drawn == []


def test_a_search_counts_its_solutions_and_ends_with_as_many_as_it_took(drawn):
    found = screwsim.find(POINT, ["operation.speed"], ["gas_mass_flow=0.3 kg/s"])
    assert texts(drawn)[0] == "find: 0 of 10"
    assert found.status == "ok" and texts(drawn)[-1] == f"find: {found.solutions} of {found.solutions}"


def test_a_search_that_takes_longer_than_expected_expects_more(drawn):
    told = []

    class Kept(Progress):
        def __getattribute__(self, name):
            return lambda *counts: told.append((name, *counts))

    with ReportedSimulation(lambda scene: scene, Kept(), 2) as _:
        pass
    assert told == [("start", 2, 0), ("more", -2), ("stop",)]
    told.clear()
    counted = ReportedSimulation(lambda scene: SimpleNamespace(status=scene), Kept(), 2)
    with counted:
        for status in ("ok", "failed", "ok"):
            counted(status)
    advanced = [("advance", 1, 0), ("advance", 1, 1), ("more", 2), ("advance", 1, 0)]
    assert told == [("start", 2, 0), *advanced, ("more", -1), ("stop",)]


def test_a_sweep_into_a_file_draws_one_too(drawn, tmp_path):
    scene = screwsim.load(POINT).with_({"sweep.oil_supply.ratio": [1, 2, 4]})
    screwsim.run_sweep(scene, tmp_path / "a.h5", jobs=1)
    assert texts(drawn)[0] == "sweep: 0 of 3" and texts(drawn)[-1] == "sweep: 3 of 3"
    drawn.clear()
    screwsim.run_sweep(scene, tmp_path / "b.h5", jobs=1, progress=False)
    assert drawn == []


def test_what_draws_no_more_is_left_alone(drawn, monkeypatch):
    def gone(**drawing):
        raise OSError("the notebook is gone")

    monkeypatch.setattr(IPython.display, "publish_display_data", gone)
    assert parallel_map(abs, 3, died=abs, jobs=1, progress=for_program("study")) == [0, 1, 2]


@pytest.fixture
def script(monkeypatch, tmp_path):
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(tmp_path / "runtime"))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    return sibling(ROOT / "docs" / "tools" / "notebooks.py")


@pytest.mark.slow
def test_a_kernel_stores_the_bar_as_it_ended(script):
    """In a kernel as Jupyter has it, with workers, the bar is one output, whose last state is kept."""
    scene = f"screwsim.load({POINT!r}).with_({{'sweep.operation.speed': ['1000 rpm', '2000 rpm', '3000 rpm']}})"
    sources = [f"import screwsim\nscene = {scene}", "data = screwsim.sweep(scene, jobs=2)\nprint(data.sizes)"]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in sources])
    script.run(notebook)
    assert notebook.cells[0].outputs == []
    bar, printed = notebook.cells[1].outputs
    assert bar.data["text/plain"] == "sweep: 3 of 3" and bar.metadata["screwsim"] == "progress"
    assert printed.text.startswith("Frozen({'operation_speed': 3")
    assert script.shown(bar) == "" and script.shown(printed) == printed.text
