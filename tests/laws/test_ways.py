"""Another way of closing is one record and one entry: all that is asked of a closed cycle is asked of its way."""

from dataclasses import fields, replace

import pytest
from scenes import make

from screwsim.cycle.ways import WAYS
from screwsim.explain import explain
from screwsim.inputs.declare import LEAF
from screwsim.numerics.settings import CLOSINGS, TOGETHER, Closing, NumericsSettings
from screwsim.simulate import simulate

NAME = "half together"


def close(task, start, last):
    """Close coarsely, then as is wanted."""
    coarse = WAYS[TOGETHER].close(task._replace(criteria=task.criteria.tighter(10.0)), start, last)
    return replace(coarse, how=NAME) if coarse.status != "ok" else again(task, coarse, None)


def again(task, cycle, led):
    """Close as all chambers together do; the cycle stays one of this way."""
    return replace(WAYS[TOGETHER].again(task, cycle, led), how=NAME)


# all chambers together, from a cycle that was closed so with ten times the tolerances
HALF_TOGETHER = WAYS[TOGETHER]._replace(close=close, again=again, instead="numerics.closing: auto")


@pytest.fixture
def registered(monkeypatch):
    monkeypatch.setitem(WAYS, NAME, HALF_TOGETHER)
    monkeypatch.setitem(CLOSINGS, NAME, Closing((NAME,), "all chambers alive at once, coarsely first"))


def asking(closing, **changes):
    scene = make({"operation.speed": "1500 rpm"})
    return replace(scene, numerics=replace(scene.numerics, closing=closing, **changes))


def test_a_scene_may_name_every_closing_and_each_names_ways_that_are_there():
    offered = next(each for each in fields(NumericsSettings) if each.name == "closing").metadata[LEAF].limits["options"]
    assert tuple(CLOSINGS) == offered
    assert {way for closing in CLOSINGS.values() for way in closing.ways} == set(WAYS)


def test_another_way_closes_and_estimates_as_the_others_do(registered):
    one, other = simulate(asking(NAME)), simulate(asking("coupled"))
    assert one.status == "ok" and one.numerics.closing == NAME
    assert one.error and max(each for each in one.error.values() if each is not None) <= 3e-4
    assert one.performance.gas_mass_flow == pytest.approx(other.performance.gas_mass_flow, rel=3e-4)
    assert f"{NAME}: all chambers alive at once, coarsely first" in str(explain(asking(NAME)))


def test_what_to_try_in_its_place_is_told_by_the_way(registered, monkeypatch):
    monkeypatch.setitem(CLOSINGS, NAME, CLOSINGS[NAME]._replace(fallbacks=False))
    result = simulate(asking(NAME, accuracy=1e-9, rtol=0.05))
    assert result.status == "not_closed"
    assert "try numerics.closing: auto, or a tighter numerics.accuracy" in result.message
