"""Scenes solved in a row, each begun from the cycles before: cheaper, and within the tolerances the same."""

import gc
import math

import numpy as np
import pytest
from folders import CONFIGS, POINT
from scenes import closed, make

from screwsim.cycle import newton
from screwsim.cycle.continuation import Course
from screwsim.cycle.surroundings import NOTHING_LEARNT, KnownSurroundings
from screwsim.cycle.tangents import linearised
from screwsim.cycle.trend import extrapolation_weights
from screwsim.figures.errors import relative_errors, worst
from screwsim.scene import case, load, with_values
from screwsim.simulate import simulate, simulate_many

ENVELOPE = CONFIGS / "r134a" / "envelope.yaml"
ALONG = {
    "oil_supply.ratio": [float(d) for d in np.linspace(1.0, 4.0, 9)],
    "operation.discharge.pressure": [f"{p} bar" for p in np.linspace(8.0, 12.0, 9)],
    "operation.speed": [f"{n} rpm" for n in np.geomspace(1000.0, 4000.0, 9)],
}
MOST = {"oil_supply.ratio": 0.75, "operation.discharge.pressure": 0.75, "operation.speed": 1.0}  # wide steps of speed
ACCURACY = 3e-4
RPM = math.pi / 30.0
CONDENSING = "operation.condensing_temperature"


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
    drawn = load(str(ENVELOPE), ["numerics.error=none"])
    far = [case(drawn, number) for number in range(0, 64, 3)]
    # a guess begins a case with a discharge line below saturation: it is no state of the line
    for one, other in zip((simulate(scene, trace=False) for scene in far), simulate_many(far, False), strict=True):
        assert (one.status, other.status) == ("ok", "ok")
        assert worst(relative_errors(one.performance, other.performance))[1] <= 2 * drawn.numerics.accuracy


def test_what_is_left_by_tangents_of_another_cycle_is_told_by_turns_and_not_by_these():
    # tangents of a cycle that is full of oil tell little of how one with less warms its line
    paper, points = load(str(POINT)), ((200, 1.0), (3000, 30.0), (3000, 1.0))
    course = [with_values(paper, {"operation.speed": n * RPM, "oil_supply.ratio": d}) for n, d in points]
    last = list(simulate_many(course, trace=False))[-1]
    alone = simulate(with_values(course[-1], {"numerics.accuracy": 3e-5}), trace=False)
    assert last.status == alone.status == "ok"
    error = relative_errors(last.performance, alone.performance)["discharge_temperature"]
    assert error <= 0.5 * ACCURACY  # where the tangents were believed 2.6e-4, told to be 3e-5
    assert error <= last.error["discharge_temperature"] + 1e-5


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
    weights = extrapolation_weights(points[:3], points[3])[0]
    assert len(weights) == 3
    for power in range(3):  # exact for every polynomial of degree 2
        assert weights @ np.array([0.0, 0.1, 0.3]) ** power == pytest.approx(0.4**power, abs=1e-12)


def test_parameters_off_the_line_take_the_last_cycle_alone():
    points = [np.array([1.0, 1.0]), np.array([1.1, 1.0]), np.array([1.1, 1.2])]
    assert [list(weights) for weights in extrapolation_weights(points[:2], points[2])] == [[1.0]]


@pytest.mark.parametrize(("far", "followed"), [(7.9, True), (8.1, False)])
def test_a_trend_is_not_followed_to_a_scene_far_along_its_line(far, followed):
    """Through two cycles a step apart a line weighs that of the last by how many steps it goes on."""
    ways = extrapolation_weights([np.array([1.0, 10.0]), np.array([1.0, 11.0])], np.array([1.0, 10.0 + far]))
    assert [list(weights) for weights in ways[:-1]] == ([pytest.approx([1.0 - far, far])] if followed else [])
    assert list(ways[-1]) == [1.0]


def speeds(machine, steps):
    """Return a machine's scenes at speeds that differ by steps relative to its own."""
    scene = load(str(CONFIGS / machine))
    return [with_values(scene, {"operation.speed": scene.operation.speed * (1.0 + step)}) for step in steps]


def evaluations(course):
    results = list(simulate_many(course, trace=False))
    assert [result.status for result in results] == ["ok"] * len(course)
    return results, [result.numerics.rhs_evaluations for result in results]


@pytest.mark.parametrize("machine", ["air/fixed_speed_7.yaml", "r134a/te5_tc35.yaml"])
def test_oil_temperatures_and_pressure_losses_are_extrapolated_like_the_cycle(machine, monkeypatch):
    course = speeds(machine, [-0.02 * i for i in range(8)])
    results, counts = evaluations(course)
    with monkeypatch.context() as without:
        without.setattr(KnownSurroundings, "expected", lambda self, parameters: None)
        others, from_the_last = evaluations(course)
    assert sum(counts[2:]) <= 0.7 * sum(from_the_last[2:])
    for one, other, scene in zip(results, others, course, strict=True):
        assert worst(relative_errors(one.performance, other.performance))[1] <= scene.numerics.accuracy


def test_errors_along_a_course_are_estimated_by_one_linearisation_and_cover_what_figures_are_off(monkeypatch):
    made = []

    def counted(*arguments):
        made.append(arguments)
        return linearised(*arguments)

    monkeypatch.setattr(newton, "linearised", counted)
    chiller = load(str(CONFIGS / "r134a" / "point.yaml"))
    points = [with_values(chiller, {CONDENSING: 273.15 + float(each)}) for each in np.linspace(40.0, 45.0, 6)]
    course = list(simulate_many(points, trace=False))
    assert {result.status for result in course} == {"ok"} and len(made) == 1
    for scene, result in zip(points[1::2], course[1::2], strict=True):
        true = simulate(with_values(scene, {"numerics.accuracy": 1e-6}), trace=False)
        off = relative_errors(result.performance, true.performance)
        for name, told in result.error.items():
            assert told is None or off[name] <= max(1.5 * told, 0.05 * ACCURACY), name


def test_surroundings_follow_an_input_that_enters_the_circuit_alone():
    path, thermostat = str(CONFIGS / "r134a" / "separator.yaml"), "effects.separator.cooler.discharge_temperature"
    _, counts = evaluations([load(path, [f"{thermostat}={T} degC"]) for T in (62, 63, 64, 65, 66)])
    assert sum(counts[3:]) <= 0.4 * sum(counts[:2])  # as many as these without the trend


def test_points_closer_than_the_surroundings_are_found_take_no_finer_steps():
    """Losses of 0.02 kPa too much are a step of the search; as an error they asked for steps ever finer."""
    _, counts = evaluations(speeds("everything.yaml", [0.002 * i for i in range(7)]))
    assert max(counts[1:]) < 0.5 * counts[0]


def test_losses_that_a_trend_leads_below_zero_are_not_followed():
    """They go with the square of the flow: at a third of the speed a line through two points leads to -0.9 kPa."""
    results, _ = evaluations(speeds("everything.yaml", [0.0, -1.0 / 3.0, -2.0 / 3.0]))
    assert results[-1].performance.package_pressure_loss > 0.0


def test_discharge_pressures_are_followed_although_the_loss_behind_adds_to_them(monkeypatch):
    scene, told = load(str(CONFIGS / "air" / "fixed_speed_7.yaml")), []
    expected = KnownSurroundings.expected
    monkeypatch.setattr(KnownSurroundings, "expected", lambda *given: told.append(expected(*given)) or told[-1])
    evaluations([with_values(scene, {"operation.discharge.pressure": p}) for p in (8.0e5, 8.1e5, 8.2e5)])
    assert told[0] is None and told[1] is None and told[2] is not None


def test_a_series_that_loses_an_unknown_forgets_what_it_learnt_with_it(monkeypatch):
    package = load(str(CONFIGS / "air" / "fixed_speed_7.yaml"))
    without = load(str(CONFIGS / "air" / "fixed_speed_7.yaml"), without=["air_package"])
    begun, begin = [], KnownSurroundings.begin

    def noted(self, unknowns):
        begin(self, unknowns)
        begun.append((unknowns, self.around is NOTHING_LEARNT))

    monkeypatch.setattr(KnownSurroundings, "begin", noted)
    evaluations([package, package, without, package])
    counts, forgotten = zip(*begun, strict=True)
    assert counts[0] == counts[1] == counts[3] > counts[2]
    assert forgotten == (True, False, True, True)


def test_surroundings_are_expected_where_what_is_stated_leads():
    known = KnownSurroundings()
    for speed in (1.0, 1.1, 1.3):  # the second parameter follows from the surroundings
        kelvin = 300.0 + 10.0 * speed**2
        known.add(np.array([speed, 0.0]), np.array([speed, kelvin]), np.array([kelvin, 2.0 * speed]))
    assert known.expected(np.array([1.4, 0.0])) == pytest.approx([319.6, 2.8])
    assert known.expected(np.array([1.4, 0.0, 1.0])) is None  # another machine


@pytest.fixture(scope="module")
def one_closed():
    return closed(make({"numerics.accuracy": ACCURACY, "numerics.error": "none"}))


@pytest.mark.parametrize("where", ["the state at 0 deg", "the history"])
@pytest.mark.parametrize(("share", "followed"), [(0.9, True), (0.6, False)])
def test_a_trend_that_leads_to_no_state_of_a_gas_is_not_followed(one_closed, where, share, followed):
    """Four steps on, a density that falls by a tenth a step is one yet; one that falls by four tenths is none."""
    _, machinery, cycle = one_closed
    course = Course()
    for parameter in (1.0, 2.0):
        course.add(cycle, np.array([parameter]), np.zeros(0), 1.0, 1.0)
    before, last = course._cycles
    times, dense, steps = last.history
    if where == "the history":
        thinner = last._replace(history=(times, share * dense, steps))
    else:
        values = last.values.copy()
        values[1] *= share  # density
        thinner = last._replace(values=values)
    course._cycles = [before, thinner]
    guess = course.guess(machinery, np.array([6.0]))
    assert guess is not None
    y = guess[0].y
    alone = thinner.values[: len(y)]
    trend = 5.0 * alone - 4.0 * before.values[: len(y)]
    assert y == pytest.approx(trend if followed else alone, rel=1e-12)
    ends = machinery.lives.last()[1][: machinery.lives.last()[3], 1]
    grows = 5.0 * thinner.history[1] - 4.0 * before.history[1] if followed else thinner.history[1]
    assert ends == pytest.approx(grows[:, 1], rel=1e-9)


def left_for_the_search(points):
    """Return how many objects simulating points leaves that only a search for cycles of references frees."""
    gc.collect()
    gc.disable()
    try:
        list(simulate_many(points, trace=False))
        return gc.collect()
    finally:
        gc.enable()


def test_what_was_read_of_a_point_is_freed_with_it():
    points = scenes("oil_supply.ratio")[:3]
    list(simulate_many(points, trace=False))  # what is kept for good
    # a cycle would hold the histories of every round; what else the process drops, of other tests too, falls into one
    assert any(left_for_the_search(points) == 0 for _ in range(3))
