"""Scenes solved in a row, each begun from the cycles before: cheaper, and within the tolerances the same."""

from pathlib import Path

import numpy as np
import pytest
from scenes import make

from screwsim.cycle.continuation import _weights
from screwsim.figures.errors import relative_errors, worst
from screwsim.scene import case, load
from screwsim.simulate import simulate, simulate_many

ENVELOPE = Path(__file__).parents[2] / "configs" / "r134a" / "envelope.yaml"
ALONG = {
    "oil_supply.ratio": [float(d) for d in np.linspace(1.0, 4.0, 9)],
    "operation.discharge.pressure": [f"{p} bar" for p in np.linspace(8.0, 12.0, 9)],
    "operation.speed": [f"{n} rpm" for n in np.geomspace(1000.0, 4000.0, 9)],
}
MOST = {"oil_supply.ratio": 0.75, "operation.discharge.pressure": 0.75, "operation.speed": 1.0}  # wide steps of speed
ACCURACY = 3e-4


def scenes(path):
    return [make({path: value, "numerics.accuracy": ACCURACY, "numerics.error": "none"}) for value in ALONG[path]]


def figures(results):
    return [dict(result.performance) for result in results]


@pytest.mark.parametrize("path", ALONG)
def test_a_course_gives_the_figures_of_single_scenes_for_fewer_evaluations(path):
    alone = [simulate(scene, trace=False) for scene in scenes(path)]
    course = list(simulate_many(scenes(path), trace=False))
    assert {result.status for result in course} == {"ok"}
    for one, other in zip(alone, course, strict=True):
        # each is within the accuracy of the truth
        assert worst(relative_errors(one.performance, other.performance))[1] <= 2 * ACCURACY
    spent = [sum(result.numerics.rhs_evaluations for result in results) for results in (course, alone)]
    assert spent[0] < MOST[path] * spent[1]


def test_a_course_through_scenes_far_apart_gives_what_single_scenes_give():
    drawn = load(str(ENVELOPE))
    far = [case(drawn, number) for number in range(64)]
    # a guess begins a case with a discharge line below saturation: it is no state of the line
    for one, other in zip((simulate(scene, trace=False) for scene in far), simulate_many(far, False), strict=True):
        assert (one.status, other.status) == ("ok", "ok")
        assert worst(relative_errors(one.performance, other.performance))[1] <= 2 * drawn.numerics.accuracy


def test_a_course_depends_on_nothing_but_its_scenes():
    first = figures(simulate_many(scenes("oil_supply.ratio"), trace=False))
    simulate(make({"operation.speed": "500 rpm"}), trace=False)
    assert figures(simulate_many(scenes("oil_supply.ratio"), trace=False)) == first


@pytest.mark.parametrize(
    "between",
    [
        {"numerics.rtol": 0.05, "numerics.accuracy": 1e-9, "numerics.closing": "histories"},  # does not close
        {"oil.transport": "carried"},  # another composition
        {"machine.male_lobes": 5},  # other angles
    ],
)
def test_a_scene_begins_afresh_after_one_that_is_no_neighbour(between):
    last = scenes("oil_supply.ratio")[0]
    results = list(simulate_many([*scenes("oil_supply.ratio")[1:3], make(between), last], trace=False))
    assert figures(results[-1:]) == figures([simulate(last, trace=False)])


def test_parameters_on_a_line_are_extrapolated_by_their_polynomial():
    line = np.array([2.0, 30.0, -1.0])
    points = [np.array([1.0, 400.0, 5.0]) + s * line for s in (0.0, 0.1, 0.3, 0.4)]
    weights = _weights(points[:3], points[3])[0]
    assert len(weights) == 3
    for power in range(3):  # exact for every polynomial of degree 2
        assert weights @ np.array([0.0, 0.1, 0.3]) ** power == pytest.approx(0.4**power, abs=1e-12)


def test_parameters_off_the_line_take_the_last_cycle_alone():
    points = [np.array([1.0, 1.0]), np.array([1.1, 1.0]), np.array([1.1, 1.2])]
    assert [list(weights) for weights in _weights(points[:2], points[2])] == [[1.0]]
