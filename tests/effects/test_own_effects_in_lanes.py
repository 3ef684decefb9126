"""A user's own effect gives the same figures in lanes as alone."""

import json
from functools import partial

import pytest
from scenes import scene_dict

from screwsim.batch import tasks, together
from screwsim.scene import Scene, loads
from screwsim.simulate import simulate

NAME = "own_effects.stepped"
SPEEDS = range(1500, 3500, 250)  # one point for each lane


def scene(speed: int) -> Scene:
    base = scene_dict({})
    return loads(
        json.dumps(
            {
                **base,
                "operation": {**base["operation"], "speed": f"{speed} rpm"},
                "effects": {**base["effects"], NAME: {}},
            }
        )
    )


def test_a_loop_that_lanes_leave_at_different_turns_gives_each_its_own_number():
    scenes = [scene(speed) for speed in SPEEDS]
    alone = [simulate(each, trace=False) for each in scenes]
    many = together([partial(simulate, each, False) for each in scenes])
    assert tasks._lanes[next(reversed(tasks._lanes))] is not None  # they ran in lanes
    for one, other in zip(alone, many, strict=True):
        assert one.status == other.status == "ok"
        for name in ("gas_mass_flow", "shaft_power", "discharge_temperature"):
            assert other.performance[name] == pytest.approx(one.performance[name], rel=1e-9)  # rounding
