"""Courses of scenes that are drawn far apart: each scene is as accurate as it says, whatever ran before it."""

import json
from pathlib import Path

import pytest
from fuzz_courses import KINDS, course, made

STORED = json.loads((Path(__file__).parent / "fuzz_courses_outcome.json").read_text(encoding="utf-8"))


def test_what_is_stored_is_of_all_kinds_and_keeps_its_bounds():
    assert set(STORED["kinds"]) == set(KINDS)
    rows = [row for rows in STORED["kinds"].values() for row in rows]
    compared, beyond = sum(row["compared"] for row in rows), sum(len(row["beyond"]) for row in rows)
    assert compared >= 0.9 * len(rows) * 30
    assert beyond <= 0.002 * compared
    assert max(row["worst"] for row in rows) <= 3.0


def test_a_course_is_drawn_by_its_seed():
    paper = KINDS["paper"]
    assert course(paper, 1, 3) == course(paper, 1, 3) != course(paper, 2, 3)


@pytest.mark.parametrize(("kind", "seed"), [("paper", 2), ("carried", 1)])
def test_a_course_is_as_accurate_as_wanted(kind, seed):
    found = made(KINDS[kind], seed, 12)
    assert found["compared"] == 12
    assert found["beyond"] == []
