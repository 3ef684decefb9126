"""The long search over random scenes: what dies or hangs costs its own scene only, and a table is gone on with."""

import json
import os
import time

import fuzz
import pytest
import search
from hard_page import OUTCOME

DIES, HANGS = 1, 3


def fake(index, seed, drawn_from):
    """Return a row; one scene kills its process, one does not end."""
    if index == DIES:
        os._exit(3)
    if index == HANGS:
        time.sleep(3600.0)
    return dict.fromkeys(fuzz.COLUMNS) | {"index": index, "structure": "paper", "status": "failed"}, None, None


@pytest.mark.parametrize(("jobs", "scenes"), [(1, HANGS), (2, 6)])  # what hangs is waited for
def test_a_scene_that_dies_or_hangs_is_one_row(jobs, scenes, monkeypatch):
    monkeypatch.setattr(fuzz, "one", fake)
    rows = {row["index"]: row["status"] for row in fuzz.rows_of(list(range(scenes)), jobs, 1, 0, 1.5)}
    every = {0: "failed", DIES: "crashed", 2: "failed", HANGS: "hung", 4: "failed", 5: "failed"}
    assert rows == {index: every[index] for index in range(scenes)}


def test_rows_come_back_as_they_were(tmp_path):
    (tmp_path / "rows.csv").write_text("index,status,mass,message\n7,ok,1.5e-06,\n", encoding="utf-8")
    assert search.read(tmp_path / "rows.csv") == [{"index": 7, "status": "ok", "mass": 1.5e-6, "message": None}]
    assert search.read(tmp_path / "none.csv") == []


def test_a_crash_is_a_status(monkeypatch):
    def broken(scene):
        raise ZeroDivisionError("what is looked for")

    monkeypatch.setattr(search, "simulate", broken)
    row, _, _ = fuzz.one(0, 1)
    assert row["status"] == "crashed"
    assert "what is looked for" in row["message"]


def test_the_stored_outcome_is_of_this_space_and_none_of_it_is_bad():
    made = json.loads(OUTCOME.read_text(encoding="utf-8"))
    assert made["space"] == fuzz.space()
    assert made["scenes"] >= 20_000
    assert set(made["status"]) <= {"ok", "not_closed", "failed", "refused"}  # none crashed, hung or was not finite
    assert made["status"]["ok"] >= 0.6 * made["scenes"]
    assert made["radau"]["compared"] >= 0.005 * made["status"]["ok"]
    assert made["radau"]["beyond_three_times_unwarned"] == []
