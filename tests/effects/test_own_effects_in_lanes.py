"""A user's own effect gives the same figures in lanes as alone."""

import json
from functools import partial

import pytest
from scenes import scene_dict

from screwsim.batch import tasks, together
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import problem_of
from screwsim.scene import Scene, loads
from screwsim.simulate import simulate

SPEEDS = range(1500, 3500, 250)  # one point for each lane
FIGURES = ("gas_mass_flow", "shaft_power", "discharge_temperature")


def scenes(name: str) -> list[Scene]:
    base = scene_dict({})
    changed = {**base, "effects": {**base["effects"], f"own_effects.{name}": {}}}
    speeds = ({**base["operation"], "speed": f"{speed} rpm"} for speed in SPEEDS)
    return [loads(json.dumps({**changed, "operation": operation})) for operation in speeds]


def in_lanes(scene: Scene) -> bool:
    return tasks._lanes[lease_for(problem_of(scene)).module.__name__] is not None


def test_a_loop_that_lanes_leave_at_different_turns_gives_each_its_own_number():
    points = scenes("stepped")
    alone = [simulate(each, trace=False) for each in points]
    many = together([partial(simulate, each, False) for each in points])
    assert in_lanes(points[0])
    for one, other in zip(alone, many, strict=True):
        assert one.status == other.status == "ok"
        for name in FIGURES:
            assert other.performance[name] == pytest.approx(one.performance[name], rel=1e-9)  # rounding


def test_points_whose_kernels_lanes_refuse_are_those_of_points_alone():
    points = scenes("picked")
    alone = [simulate(each, trace=False) for each in points]
    many = together([partial(simulate, each, False) for each in points])
    assert not in_lanes(points[0])
    for one, other in zip(alone, many, strict=True):
        assert one.status == other.status == "ok"
        assert [one.performance[name] for name in FIGURES] == [other.performance[name] for name in FIGURES]
