"""The search over scenes of all effects: it draws every effect, and what it stored keeps its bounds."""

import json
from types import SimpleNamespace

import fuzz_effects
import pytest
from effects_space import STRUCTURES, drawn, effects_drawn, ranges, scene_of
from hard_page import OF_EFFECTS
from known_figures import known_reference
from scenes import closed, make
from true_error import true_error

from screwsim.effects import catalogue
from screwsim.simulate import simulate
from screwsim.solve import second_cycle

MADE = json.loads(OF_EFFECTS.read_text(encoding="utf-8"))
TRUE = MADE["true"]
AGAIN = {  # scenes in which estimates did not hold
    "plenums, valves": 39,  # discharge temperature 5.0e-4 off where 1.2e-4 was estimated, coupled
    "displaced": 36,  # oil ratio 3.8e-4 where 3.0e-4 was, histories
    "plenums": 25,  # least flow in the line 4.4e-4 where 5.8e-5 was, histories
}


def test_every_effect_is_drawn():
    assert set(catalogue()) <= effects_drawn()
    assert set(catalogue()) <= set(MADE["effects"])


def test_effects_with_numbers_have_some_of_them_drawn():
    """But ports, whose areas are the machine's, and what is simply there."""
    without = {"suction_port", "discharge_port", "oil_volume", "suction_line"}
    paths = {path for structure in STRUCTURES for path in ranges(structure)}
    assert set(catalogue()) - without <= {path.split(".")[1] for path in paths if path.startswith("effects.")}


def test_a_scene_is_drawn_by_its_number_alone():
    assert drawn("plenums", 1, 3) == drawn("plenums", 1, 3)
    assert drawn("plenums", 1, 3) != drawn("plenums", 1, 4)
    assert scene_of("plenums", 1, 3) == scene_of("plenums", 1, 3)


def test_the_stored_outcome_is_of_this_space_and_nothing_crashed_or_hung():
    assert MADE["space"] == fuzz_effects.space()
    assert set(MADE["structure"]) == set(STRUCTURES)
    assert set(MADE["status"]) <= {"ok", "not_closed", "failed", "refused"}
    assert MADE["status"]["ok"] >= 0.8 * MADE["scenes"]
    assert MADE["worst_balance_over_accuracy"]["value"] <= 1.0


def test_the_stored_estimates_hold():
    """Within the wanted accuracy or warned in 98 %, within three times it or warned in all."""
    assert TRUE["compared"] >= 50
    assert TRUE["within_or_warned"] >= 0.98 * TRUE["compared"]
    assert TRUE["beyond_three_times_unwarned"] == []


TWO_CYCLES, ONE = (4, 9), (3, 12)  # of "gaps full of oil", all of which close slowly


@pytest.mark.parametrize("number", [*TWO_CYCLES, *ONE])
def test_a_machine_with_another_cycle_says_so(number):
    """Gaps that pass oil where there is enough and gas where not: begun with little oil some stay elsewhere."""
    result = simulate(scene_of("gaps full of oil", 1, number), trace=False)
    assert result.status == "ok"
    assert result.numerics.rhs_evaluations > second_cycle.SLOW_CLOSING  # it was asked
    assert any("another cycle" in words for words in result.warnings) == (number in TWO_CYCLES)


def test_a_cycle_beside_which_turns_stood_is_told(monkeypatch):
    """What turns close from there may be any other cycle: here that of a machine whose gaps are wider."""
    _, _, beside = closed(make({"effects.tip_leakage.gap": "40 um"}))
    monkeypatch.setattr(second_cycle, "nearly_closed_apart", lambda problem, cycle: beside)
    monkeypatch.setattr(second_cycle, "relax", lambda task, start, last: beside)
    result = simulate(make({}))
    (warning,) = [words for words in result.warnings if "another cycle" in words]
    assert "from the state that the turns of single chambers had reached" in warning
    assert f"{result.performance.volumetric_efficiency:.4g}" in warning


@pytest.mark.parametrize(
    ("mass", "change", "asked"),
    [(1.01, 1e-4, True), (1.001, 1e-4, False), (1.01, 2e-3, False), (1.0, 1e-4, False)],
    ids=["stood beside it", "near", "far from closed", "the same"],
)
def test_turns_stood_beside_a_cycle_that_is_farther_away_than_they_would_have_gone(mass, change, asked):
    """Only those are gone on with: a scene whose turns led to its cycle, or nowhere, pays nothing."""
    problem = SimpleNamespace(
        scene=SimpleNamespace(numerics=SimpleNamespace(accuracy=3e-4)), parts=SimpleNamespace(shaft=None), pv=1.0
    )
    left = SimpleNamespace(change=change, seen=(mass, 2.0))
    cycle = SimpleNamespace(abandoned_cycle=left, seen=(1.0, 2.0))
    assert second_cycle.nearly_closed_apart(problem, cycle) is (left if asked else None)
    assert second_cycle.nearly_closed_apart(problem, SimpleNamespace(abandoned_cycle=None)) is None


LEAKS_ALONE = {  # structure, seed, number: machines that deliver nothing, and what they were off by
    ("part load", 7711, 0): "gas of 2475 K goes round; corrected turns led to and fro; flow 4.5e-4, estimated 5e-5",
    ("part load", 237, 0): "trapped mass 9.4e-4, estimated 1.3e-4",
    ("part load", 232, 5): "discharge temperature 4.8e-4, estimated 1.1e-4",
    ("part load", 220, 15): "discharge temperature 3.8e-4, estimated 1.4e-4",
    ("solubility over time", 200, 35): "flash flow 6.1e-4, estimated 2.4e-4",
}


@pytest.mark.parametrize("drawn_as", LEAKS_ALONE)
def test_what_leaks_hide_of_an_error_is_told_where_nothing_is_delivered(drawn_as):
    scene = scene_of(*drawn_as)
    result = simulate(scene, trace=False)
    assert result.status == "ok", result.message
    assert result.performance.volumetric_efficiency < 0.0
    _, _, true = true_error(scene, result, asked=known_reference)
    assert true <= scene.numerics.accuracy


@pytest.mark.slow
@pytest.mark.parametrize("structure", AGAIN)
def test_an_estimate_holds_when_solved_again(structure):
    index = list(STRUCTURES).index(structure) * fuzz_effects.effects_space.EACH + AGAIN[structure]
    row, scene, result = fuzz_effects.one(index, 1)
    assert row["status"] == "ok", row["message"]
    _, _, true = true_error(scene, result, asked=known_reference)
    assert true <= scene.numerics.accuracy
