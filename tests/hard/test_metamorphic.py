"""Laws that hold whatever solves the equations: scenes stated in two ways, machines of two sizes, wider gaps."""

import json
from pathlib import Path

import pytest
from metamorphic import LAWS, asked, same

STORED = json.loads((Path(__file__).parent / "metamorphic_outcome.json").read_text(encoding="utf-8"))


def test_what_is_stored_meets_every_law():
    assert set(STORED["laws"]) == set(LAWS)
    for row in STORED["laws"].values():
        assert row["asked"] > 0
        assert row["beyond"] == []


@pytest.mark.parametrize(("law", "kind"), [(law, "paper") for law in LAWS] + [("nothing_destroys_entropy", "real gas")])
def test_a_draw_meets_its_law(law, kind):
    found = asked(law, kind, 2)
    assert found["off"] <= 1.0, found


def test_a_figure_that_differs_by_one_bit_is_not_the_same():
    assert same({"p": 1.0, "q": None}, {"p": 1.0, "q": float("nan")}) == (0.0, "")
    assert same({"p": 1.0}, {"p": 1.0 + 2.3e-16}) == (float("inf"), "p")
    assert same({"p": 1.0}, {}) == (float("inf"), "p")
