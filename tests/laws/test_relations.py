"""Laws between results of random scenes (`tests/tools/relations.py`), of a few draws, and that a broken one is seen."""

import math
from dataclasses import replace

import numpy as np
import pytest
import relations
from effects_space import scene_of
from relating import LAWS, Case, Pair
from relation_figures import _bound as bound_of

from screwsim.figures import Performance

OF_ONE_RESULT = ("sums_and_quotients", "properties", "first_law", "packages", "second_law", "bounds")
DRAWN = {  # structure of effects_space.py, number of its scene: laws that tie it to another
    ("part load", 0): ("wider_leak", "losses_add", "similar"),
    ("bypass", 1): ("asked_otherwise", "hotter"),
    ("displaced", 0): ("found_values", "changed_intake"),
    ("oil circuit", 0): ("found_values",),
}
SEED = 51


def drawn(structure, index):
    """Return a case of a scene of the space."""
    return Case(scene_of(structure, SEED, index), np.random.default_rng(index))


@pytest.mark.parametrize("structure", ["part load", "air package", "economizer and liquid", "expander"])
def test_figures_of_a_result_are_sums_quotients_and_balances_of_each_other(structure):
    rows = relations.related(SEED, 2, list(OF_ONE_RESULT), structure)
    figures = [each for pairs in rows.values() for pair in pairs for each in pair]
    assert len(figures) > 20
    assert [each.what for each in figures if each.off > relations.FAR] == []


@pytest.mark.parametrize(("which", "law"), [(which, law) for which, laws in DRAWN.items() for law in laws])
def test_a_machine_and_one_that_a_law_ties_to_it_agree_within_what_both_tell(which, law):
    pairs, lost = relations.asked(LAWS[law], drawn(*which))
    assert pairs and all(pairs), lost
    assert lost == ""
    assert [each.what for pair in pairs for each in pair if each.off > relations.FAR] == []


def test_a_figure_that_is_off_by_more_than_it_tells_breaks_a_law():
    case = drawn("part load", 0)
    result = case.result
    figures = dict(result.performance)
    figures["shaft_power"] *= 1.01
    wrong = replace(result, performance=Performance(figures, result.performance.about))
    found = max(relations.off(Pair("again", result, wrong), case.scene.numerics.accuracy))
    assert found.figure in ("shaft_power", "shaft_torque")  # whose error is that of the power
    assert found.off > relations.FAR
    assert max(relations.off(Pair("again", result, result), case.scene.numerics.accuracy)).off == 0.0


def test_a_figure_that_is_no_number_breaks_a_law():
    case = drawn("part load", 0)
    result = case.result
    figures = {**result.performance, "shaft_power": math.nan}
    wrong = replace(result, performance=Performance(figures, result.performance.about))
    assert max(relations.off(Pair("again", result, wrong), case.scene.numerics.accuracy)).off == math.inf
    (bound,) = relations.off(bound_of(result, "shaft_power", math.nan, 1.0, 1e-3), case.scene.numerics.accuracy)
    assert bound.off == math.inf


def test_what_no_scene_may_cause_is_told_as_a_broken_law():
    def law(case):
        raise KeyError("second_tip")
        yield

    pairs, lost = relations.asked(law, drawn("part load", 0))
    assert [(each.off, each.figure) for pair in pairs for each in pair] == [(math.inf, "KeyError")]
    assert lost == ""
