"""Mutated files: the stored outcome of the tool is of these mutants and none of it is wrong; a sample still holds."""

import json
import sys
from pathlib import Path

import mutate
import mutate_space as space
import pytest
from each_row import each_row

OUTCOME = Path(__file__).parent / "mutate_outcome.json"
STORED = json.loads(OUTCOME.read_text(encoding="utf-8"))
SAMPLE = range(7, 2000, 67)  # numbers of mutants, of every kind


@pytest.fixture(autouse=True, scope="module")
def put_back():
    """Leave pages and figures to the tests that follow as they were: the tool makes them light."""
    import plotly.offline

    from screwsim.report import style

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "_FORMATS", style._FORMATS)
        patch.setattr(plotly.offline, "get_plotlyjs", plotly.offline.get_plotlyjs)
        yield


def test_the_stored_outcome_is_of_these_mutants_and_none_is_wrong():
    assert STORED["space"] == mutate.digest()
    assert STORED["files"] >= 2000
    assert STORED["wrong"] == {}
    assert set(STORED["kinds"]) == set(space.KINDS)
    assert STORED["memory_limit_MB"] == mutate.MEMORY // 1_000_000


def test_the_mutants_are_read_to_the_end_often_enough_to_say_something():
    for way in ("results: report", "results: plot", "results: compare", "results: map", "results: xarray"):
        assert STORED["answers"][f"{way} 0"] >= 10
        assert STORED["answers"][f"{way} 2"] >= 10
    for way in ("scene: explain", "table: explain", "fit: fit"):
        assert STORED["answers"][f"{way} 0"] >= 30
        assert STORED["answers"][f"{way} 3"] >= 30


@pytest.mark.slow
def test_a_sample_of_the_mutants_is_answered_as_it_should_be():
    rows = list(mutate.rows_of(list(SAMPLE), 1, STORED["seed"], 300.0))
    assert len(rows) == len(SAMPLE)
    assert {row["number"]: row["wrong"] for row in rows if row["wrong"]} == {}


def test_the_files_that_are_mutated_are_read_as_they_are(tmp_path):
    space.furnish(tmp_path)
    for name in space.SCENES:
        assert space._asked(space._command("explain", tmp_path / name)) == ("0", [])
    assert space._asked(lambda: space._fit(tmp_path / "small.fit.yaml")) == ("0", [])
    assert space._asked(lambda: len(space.read_table(tmp_path / "droplets.csv")) and 0) == ("0", [])
    for name in space.RESULTS:
        assert space._asked(lambda name=name: space._all_of(tmp_path / name)) == ("0", [])
    assert not (tmp_path / "sprung").exists()


@each_row(
    ("way", "what"),
    [
        (lambda: 1 // 0, "internal error"),
        (lambda: print("\x1b[31m") or 0, "steers the terminal"),
        (lambda: print(space.mutate_hdf5.SECRET) or 0, "the secret was told"),
        (lambda: print("UserWarning: x", file=sys.stderr) or 0, "noise"),
        (lambda: 7, "exit code 7"),
    ],
)
def test_what_is_wrong_is_seen(way, what):
    _, found = space._asked(way)
    assert any(what in each for each in found)


def test_a_trap_that_is_sprung_is_seen(tmp_path, monkeypatch):
    space.furnish(tmp_path / "files")
    (tmp_path / "work").mkdir()
    monkeypatch.setitem(space._MAKERS, "scene", lambda *_: ("x y", [("trap", lambda: sprung(tmp_path / "files"))]))
    number = space.KINDS.index("scene")
    assert space.read(tmp_path / "files", tmp_path / "work", 1, number).wrong == ("a trap was sprung",)


def sprung(folder):
    exec((folder / "trap.py").read_text())
    return 0


HANGS, DIES, EATS = 2, 1, 3


def fake(folder, place, seed, number):
    """Answer in the place of `read`: one mutant ends its process, one does not end, one wants memory without bound."""
    if number == DIES:
        mutate.os._exit(3)
    if number == HANGS:
        mutate.time.sleep(3600.0)
    if number == EATS:
        with pytest.raises(MemoryError):
            bytearray(40_000_000_000)
    return space.Answer("scene", "x y", ("explain 0",), ())


def test_a_mutant_that_dies_or_hangs_is_one_row(monkeypatch):
    monkeypatch.setattr(space, "read", fake)
    monkeypatch.setattr(space, "furnish", lambda folder: folder.mkdir())
    rows = {row["number"]: row["wrong"] for row in mutate.rows_of(list(range(5)), 1, 1, 1.5)}
    assert rows == {0: [], DIES: ["the process ended with 3"], HANGS: ["no end within 1.5 s"], EATS: [], 4: []}
