"""What is stored of the hard cases with each effect added: no case is lost, and the page shows the table."""

import json
from pathlib import Path

import hard_with_effects
from each_row import each_row
from scenes import scene_dict

from screwsim.effects import catalogue
from screwsim.machine.kinds import MACHINES

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "effects.md"
STORED = hard_with_effects.stored()
CASES = {case.name: case for case in hard_with_effects.chosen()}


@each_row("name", STORED)
def test_every_case_is_ok_refused_with_a_remedy_or_at_a_limit(name):
    outcomes = STORED[name]
    assert set(outcomes) == {case.name for case in hard_with_effects.chosen(name)}
    for case, each in outcomes.items():
        fine = each["status"] in {"ok", "refused", "left out"} or hard_with_effects.at_a_limit(each)
        assert fine, (case, each)
        if each["status"] == "ok":
            assert each["balance"] <= 1.0, case
        if each["status"] == "refused":
            assert "(" in each["message"], case
    assert any(each["status"] == "ok" for each in outcomes.values())


def test_every_effect_of_a_screw_machine_has_a_row():
    named = " ".join(json.dumps([name, effect], default=str) for name, effect in hard_with_effects.EFFECTS.items())
    on_base = set(scene_dict({})["effects"])
    for name, effect in catalogue().items():
        if effect.fits(MACHINES["twin_screw"]) and name not in on_base:
            assert f"effects.{name}" in named, name


def test_the_page_shows_what_is_stored():
    assert len(STORED) > 5
    assert hard_with_effects.table() in PAGE.read_text(encoding="utf-8")


def test_a_case_is_solved_again_as_stored():
    name = "dead volume 0.1"
    assert hard_with_effects.solved(CASES[name], hard_with_effects.EFFECTS["none"])["status"] == "ok"
    assert STORED["none"][name]["status"] == "ok"
