"""A user's own effect that returns what cannot be makes the case failed, with effect, value and place."""

import json
import re
import sys
from dataclasses import replace
from functools import partial

import pytest
from scenes import make, scene_dict

from screwsim import simulate
from screwsim.batch import together
from screwsim.build.own_modules import checked_parts
from screwsim.effects.base import FlowPath
from screwsim.numerics.kernel import kernel
from screwsim.scene import loads
from screwsim.simulate import simulate_many

NAME = "own_effects.wrong"


def scene(**parameters):
    base = scene_dict({})
    return loads(json.dumps({**base, "effects": {**base["effects"], NAME: parameters}}))


def found(**parameters):
    return simulate(scene(**parameters))


def test_an_effect_that_returns_what_can_be_is_solved():
    result = found()
    assert result.status == "ok"
    assert result.warnings == ()


WRONG = {
    "a negative area": ({"area": -1}, "its area is -1e-07 m² at 40"),
    "an area that is no number": ({"level": -1}, "its area is nan m² at 40"),
    "an infinite area": ({"spread": 0}, "its area is inf m² at 40"),
    "a narrow window": ({"area": -1, "opens": "413.2 deg", "closes": "413.4 deg"}, "its area is -1e-07 m² at 413."),
    "a negative flow coefficient": ({"coefficient": -0.7}, "its flow_coefficient is -0.7"),
    "a negative conductance": ({"gain": -1}, "its conductance is -0.001 W/K at 4"),
    "heat that is no number": ({"hot": "320 K"}, "its heat rate is nan W at "),
    "a gain of power": ({"power": "gain"}, "its power bearing_power [W] is -1e+09"),
    "a power that is no number": ({"power": "nan"}, "its power bearing_power [W] is nan"),
    "an infinite power": ({"power": "inf"}, "its power bearing_power [W] is inf"),
    "no power": ({"power": "none"}, "its power bearing_power [W] is None"),
    "text for a power": ({"power": "text"}, "its power bearing_power [W] is 'ten'"),
    "power that the oil loses": ({"kept": -5}, "what the oil keeps of bearing_power [W] is -5"),
    "what the cycle makes of nothing": ({"made": "nan"}, "the cycle's value of wrong_temperature is nan"),
    "a figure that is none": ({"figure": "nan"}, "its figure economizer_mass_flow is nan"),
    "a plenum of no pressure": ({"pressure": "nan"}, "p of its plenum vessel is nan"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_fails_the_case_and_is_named(name):
    changes, words = WRONG[name]
    result = found(**changes)
    assert result.status == "failed"
    assert result.message.startswith(f"effects.{NAME}: {words}")
    assert result.message.endswith(", which is impossible; fix that module")
    assert "\n" not in result.message


def looked_up(first):
    base = scene_dict({})
    changed = {**base["effects"], "own_effects.looked_up": {"first": first}}
    return loads(json.dumps({**base, "effects": changed}))


def test_an_index_beyond_a_table_fails_the_case_alone_and_in_lanes():
    """Where the pressure reaches the table's end, though the number read there is only compared."""
    cases = [looked_up(first) for first in (0, 95)]
    many = together([partial(simulate, each, False) for each in cases])
    for found in ([simulate(each, trace=False) for each in cases], many):
        assert [result.status for result in found] == ["ok", "failed"]
        assert found[1].message.startswith("effects.own_effects.looked_up: its heat rate is nan W at ")


@kernel
def hole(phi, size):
    return size


HOLE = FlowPath("suction", area=hole, values={"size": 1e-6}, breakpoints=(1.0,))
NO_PARTS = {
    "nothing": (None, "build returned None, not a list of parts"),
    "one part": (HOLE, "build returned a FlowPath, not a list of parts"),
    "a word": ([HOLE, "leak"], "build returned 'leak' among its parts, not a FlowPath, PowerLoss or the like"),
    "a function": (
        [replace(HOLE, area=hole.function)],
        "area of its FlowPath is the function hole, no kernel: put @ker",
    ),
    "text for a number": ([replace(HOLE, values={"size": "big"})], "values of its FlowPath holds size = 'big', which"),
    "text for angles": ([replace(HOLE, breakpoints="4")], "breakpoints of its FlowPath holds '4', which is no number"),
}


@pytest.mark.parametrize("name", NO_PARTS)
def test_what_is_no_part_of_an_effect_is_refused(name):
    built, words = NO_PARTS[name]
    with pytest.raises(TypeError, match=re.escape(words)):
        checked_parts(built)


def test_parts_of_an_effect_are_taken_as_they_are():
    assert checked_parts((HOLE,)) == [HOLE]


def test_a_later_case_of_a_sweep_does_not_suffer_from_one_that_failed():
    scenes = [scene(area=sign) for sign in (1, -1, 1)]
    assert [result.status for result in simulate_many(scenes, trace=False)] == ["ok", "failed", "ok"]


def test_a_scene_without_own_effects_asks_nothing(monkeypatch):
    monkeypatch.setattr(sys.modules["screwsim.evaluate.own_effects"], "_points", None)
    assert simulate(make({})).status == "ok"


def test_a_gap_of_an_own_effect_stays_as_stated_where_the_shipped_ones_grow_warm():
    base = scene_dict({})["effects"]
    warm = {"rotor_temperature": "330 K", "housing_temperature": "330 K", "axis_distance": "125 mm"}
    with_own = base | {"thermal_clearances": warm, "own_effects.second_tip": {"gap": "20 um"}}
    one = simulate(loads(json.dumps({**scene_dict({}), "effects": with_own})))
    assert one.status == "ok"
    growth = 10.5e-6 * (330.0 - 293.15) - 11.5e-6 * (330.0 - 293.15)
    assert one.performance.tip_gap == pytest.approx(50e-6 + growth * 0.08, rel=1e-9)
