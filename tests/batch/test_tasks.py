"""Points side by side: what each comes to is what it comes to alone, and does not depend on the others."""

import sys
import threading
import time
from contextvars import ContextVar
from functools import partial

import numpy as np
import pytest
from folders import CONFIGS, ROOT
from greenlet import GreenletExit, getcurrent

from screwsim.batch import simulate_courses, tasks, together
from screwsim.model import leases
from screwsim.model.run import FIRST_STEP, Machinery
from screwsim.model.turn_scheduler import reach_station, scheduler
from screwsim.numerics.compiling import again, clock
from screwsim.scene import case, load
from screwsim.simulate import simulate, simulate_many
from screwsim.study.pool import limit

POINTS = 16
SAMPLE = [
    "sweep.sample={kind: sobol, count: 16, seed: 3, over: {operation.speed: {from: 300 rpm, to: 6000 rpm}, "
    "operation.condensing_temperature: {from: 20 degC, to: 75 degC}, "
    "oil_supply.ratio: {from: 0.05, to: 5, spacing: log}, oil_supply.temperature: {from: 265 K, to: 350 K}}}"
]
ROUNDING = 1e-8  # differences in the last bits of exponentials, through some turns: far below the accuracy


def told(result):
    """Return all that a result says but times."""
    numerics = {name: value for name, value in result.numerics.items() if "time" not in name}
    figures = (result.performance, result.error, result.balance)
    return result.status, result.message, result.warnings, numerics, *map(dict, figures)


@pytest.fixture(scope="module")
def sample():
    """Points of a real gas, of which some condense, and are failed."""
    scene = load(str(ROOT / "tests" / "plain" / "r134a.yaml"), SAMPLE)
    return [case(scene, k) for k in range(POINTS)]


@pytest.fixture(scope="module")
def many(sample):
    return [result for (result,) in simulate_courses([[scene] for scene in sample])]


@pytest.fixture(scope="module")
def alone(sample):
    return [simulate(scene, trace=False) for scene in sample]


def test_status_message_and_warnings_are_those_of_single_points(alone, many):
    assert {result.status for result in alone} == {"ok", "failed"}
    for one, other in zip(alone, many, strict=True):
        assert (one.status, one.message, one.warnings) == (other.status, other.message, other.warnings)


def test_figures_and_their_errors_are_those_of_single_points(alone, many):
    for one, other in zip(alone, many, strict=True):
        assert one.performance.keys() == other.performance.keys()
        for name, value in one.performance.items():
            assert other.performance[name] == (None if value is None else pytest.approx(value, rel=ROUNDING))
        for name, value in one.error.items():
            near = None if value is None else pytest.approx(value, rel=1e-3, abs=ROUNDING)
            assert other.error[name] == near


@pytest.mark.parametrize("size", [1, 7])
def test_no_bit_depends_on_the_grouping(size, sample, many):
    some = sample[:3] if size == 1 else sample
    groups = [some[first : first + size] for first in range(0, len(some), size)]
    found = [result for group in groups for (result,) in simulate_courses([[scene] for scene in group])]
    assert list(map(told, found)) == list(map(told, many[: len(some)]))


def test_more_courses_than_run_at_a_time_are_taken_in_turn(sample, many):
    found = together([partial(simulate, scene, False) for scene in sample], in_flight=3)
    assert list(map(told, found)) == list(map(told, many))


def test_as_many_run_at_a_time_as_one_likes_however_deep_calls_may_be():
    def work(k):
        reach_station()
        return k

    count = 2 * sys.getrecursionlimit()
    assert together([partial(work, k) for k in range(count)], in_flight=count) == list(range(count))


def test_a_course_begins_each_point_from_those_before_it():
    speeds = "sweep.operation.speed={from: 2500 rpm, to: 3000 rpm, count: 12}"
    scene = load(str(CONFIGS / "paper" / "point.yaml"), [speeds])
    courses = [[case(scene, k) for k in range(first, first + 4)] for first in (0, 4, 8)]
    found = simulate_courses(courses)
    for course, results in zip(courses, found, strict=True):
        for one, other in zip(simulate_many(course, trace=False), results, strict=True):
            assert one.numerics.rhs_evaluations == other.numerics.rhs_evaluations
            assert one.performance.shaft_power == pytest.approx(other.performance.shaft_power, rel=ROUNDING)
    assert found[1][1].numerics.turns < found[1][0].numerics.turns


def test_times_of_points_side_by_side_add_up_to_no_more_than_what_they_took(sample):
    began = time.perf_counter()
    found = simulate_courses([[scene] for scene in sample[:8]])
    elapsed = time.perf_counter() - began
    spent = sum(result.numerics.wall_time + result.numerics.estimating_time for results in found for result in results)
    assert 0.0 < spent <= elapsed


def test_a_task_that_waits_is_not_charged_twice_for_what_another_compiles_again():
    """What is compiled again stands on no clock: as time of others it would be taken off once more."""

    def work(seconds):
        began = clock() - scheduler.elsewhere
        reach_station()
        with again():
            time.sleep(seconds)
        reach_station()
        return clock() - scheduler.elsewhere - began

    assert min(together([partial(work, 0.05)] * 3)) > 0.0


def test_turns_are_integrated_side_by_side_as_alone_and_leave_every_array_so(sample, monkeypatch):
    """What a turn leaves behind (the ends of its steps, run-time cells, counts) is what a single one leaves."""
    kept = {}

    def noted(machinery, y, rtol, h, turn):
        answer = turn(machinery, y, rtol, h)
        steps = int(machinery.lives.kept[0])
        kept.setdefault(turn, []).append((
            *(answer[0], answer[1], answer[2].copy(), y.copy(), steps, machinery.counts.copy(), machinery.R.copy()),
            *(machinery.lives.histories[1][0][: steps + 1].copy(), machinery.lives.histories[1][1][:steps, :2].copy()),
        ))  # fmt: skip
        return answer

    def beside(machinery, y, rtol, h):
        return tasks._turns([tasks.side_by_side.TurnRequest(machinery, y, rtol, h)])[0]

    for turn in (Machinery.own_turn, beside):
        monkeypatch.setattr(
            Machinery, "turn", lambda self, y, rtol, h=FIRST_STEP, turn=turn: noted(self, y, rtol, h, turn)
        )
        simulate(sample[0], trace=False)
    for one, other in zip(*kept.values(), strict=True):
        for a, b in zip(one, other, strict=True):
            # steps end where their error says, which is a small difference: rounding is seen in it
            np.testing.assert_allclose(a, b, rtol=1e-5, atol=1e-10)


def paper_point():
    return load(str(CONFIGS / "paper" / "point.yaml"))


@pytest.mark.parametrize("error", [ZeroDivisionError, KeyboardInterrupt])
def test_what_a_task_raises_is_raised_and_those_that_wait_end(error):
    ended, scene = [], paper_point()

    def waits():
        try:
            simulate(scene, trace=False)
        finally:
            ended.append(1)

    def fails():
        raise error("of one task")

    with pytest.raises(error, match="of one task"):
        together([waits, waits, fails, waits])
    assert len(ended) == 2  # the last had not begun
    assert scheduler.turn is None


def test_a_task_that_will_not_end_gets_no_turn_more():
    asked, scene = [], paper_point()

    def stubborn():
        for _ in range(3):
            try:
                simulate(scene, trace=False)
            except BaseException as error:  # noqa: BLE001 - that is what is tried
                asked.append(type(error))

    def fails():
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        together([stubborn, fails])
    assert asked == [GreenletExit] * 3


def test_what_a_call_raises_is_raised_where_its_turns_were_asked_for(monkeypatch):
    def breaks(_asked):
        raise MemoryError("of a call")

    monkeypatch.setattr(tasks, "_turns", breaks)
    told, scene = [], paper_point()

    def hears():
        try:
            simulate(scene, trace=False)
        except MemoryError as error:
            told.append(str(error))

    together([hears, hears])
    assert told == ["of a call"] * 2


def test_two_threads_solve_points_side_by_side_at_once(sample, many):
    found = {}

    def run(which):
        found[which] = [result for (result,) in simulate_courses([[scene] for scene in sample[which::2]])]

    threads = [threading.Thread(target=run, args=(which,)) for which in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for which in (0, 1):
        assert list(map(told, found[which])) == list(map(told, many[which::2]))


def test_points_side_by_side_within_a_task_of_others_are_what_they_are(sample, many):
    def inner():
        return [result for (result,) in simulate_courses([[scene] for scene in sample[:2]])]

    found = together([inner, partial(simulate, sample[2], False)])
    assert list(map(told, found[0])) == list(map(told, many[:2]))
    assert told(found[1]) == told(many[2])


def test_a_task_sees_what_is_set_around_it_and_sets_it_for_itself_alone():
    seen, scene = {}, paper_point()
    around = ContextVar("around", default=0)
    around.set(1)

    def sets(number):
        seen[number] = [around.get()]
        around.set(number)
        simulate(scene, trace=False)  # others run
        seen[number].append(around.get())

    together([partial(sets, 2), partial(sets, 3)])
    assert seen == {2: [1, 2], 3: [1, 3]}
    assert around.get() == 1


def test_so_many_points_at_a_time_share_their_working_arrays():
    assert leases.MOST_FREE >= tasks.IN_FLIGHT


def test_points_in_step_without_lanes_have_the_bits_of_single_points(alone, sample):
    found = together([partial(simulate, scene, False) for scene in sample], lanes=False)
    assert list(map(told, found)) == list(map(told, alone))


def test_courses_in_step_without_lanes_have_the_bits_of_courses_alone():
    scene = load(
        str(ROOT / "tests" / "plain" / "r134a.yaml"), ["sweep.operation.speed={from: 2000 rpm, to: 3000 rpm, count: 9}"]
    )
    courses = [[case(scene, k) for k in range(first, first + 3)] for first in (0, 3, 6)]
    works = [lambda course=course: list(simulate_many(course, trace=False)) for course in courses]
    for one, other in zip(together(works, lanes=False), (work() for work in works), strict=True):
        assert list(map(told, one)) == list(map(told, other))


def test_all_come_to_a_station_before_one_goes_on_to_the_next():
    came = []

    def goes(number):
        for stop in range(3):
            came.append((stop, number))
            reach_station()

    together([partial(goes, number) for number in range(4)])
    assert came == [(stop, number) for stop in range(3) for number in range(4)]


def test_time_at_a_station_is_that_of_others_and_told_so():
    spent = {}

    def waits():
        before = scheduler.elsewhere
        reach_station()
        spent["waiting"] = scheduler.elsewhere - before

    def works():
        before = scheduler.elsewhere
        time.sleep(0.05)
        spent["working"] = scheduler.elsewhere - before

    together([waits, works])
    assert spent["waiting"] >= 0.05
    assert spent["working"] == 0.0


def test_what_is_raised_behind_a_station_is_raised_and_those_that_wait_there_end():
    ended = []

    def waits():
        try:
            for _ in range(5):
                reach_station()
        finally:
            ended.append(1)

    def fails():
        reach_station()
        raise ZeroDivisionError("of one task")

    with pytest.raises(ZeroDivisionError, match="of one task"):
        together([waits, fails, waits])
    assert len(ended) == 2
    assert scheduler.station is None


def test_the_time_of_one_that_waits_at_a_station_does_not_run():
    left = {}

    def waits():
        with limit.TimeLimit(100.0):
            reach_station()
            left["deadline"] = limit._deadlines[getcurrent()] - time.monotonic()

    def works():
        with limit.TimeLimit(100.0):
            time.sleep(0.3)
            reach_station()

    together([waits, works], during=limit.clocks_running, handed_on=limit.clock_handed_on)
    assert left["deadline"] > 100.0 - 0.2
    assert not limit._deadlines
