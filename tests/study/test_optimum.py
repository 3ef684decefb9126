"""The optimum of one path: found between grid points, with its uncertainty, its border and its failures."""

import math
from dataclasses import replace

import numpy as np
import pytest
from each_row import each_row
from folders import POINT
from result_fakes import SCENE
from study_fakes import deadly, flat, gappy, parabola, raising, result_of, rough, scene, steady, two_tops

from screwsim.build import build_parts
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import case, load, loads, with_values
from screwsim.simulate import simulate
from screwsim.study.best.optimum import optimum, question
from screwsim.study.best.search import SearchPoint, find_maximum
from screwsim.template import new_scene, request_of

SPEEDS = "sweep:\n  operation.speed: [1000 rpm, 2000 rpm, 3000 rpm]\n"


def best_of(simulate, extra: str = "", jobs: int = 1, **asked):
    one = scene(extra)
    return optimum(one, question(one, **asked), jobs=jobs, simulate=simulate)


@pytest.mark.parametrize("jobs", [1, 2])
def test_the_top_of_a_parabola_is_found_for_each_speed(jobs):
    rows = best_of(parabola, SPEEDS, jobs)
    assert [row.place for row in rows] == ["inside"] * 3
    for row, rpm in zip(rows, (1000, 2000, 3000), strict=True):
        speed = rpm * math.pi / 30.0
        assert row.values == {"operation.speed": pytest.approx(speed)}
        # scipy's search stops within 1e-4 of the range, ln 100
        assert row.value == pytest.approx(speed / 100.0, rel=1e-3)
        assert row.figure == pytest.approx(0.8, abs=1e-6)
        assert row.low <= row.value <= row.high
        assert row.failed == 0 and 13 < row.solutions < 40


def test_the_interval_is_where_the_figure_is_within_its_error():
    (row,) = best_of(rough)
    # 0.05 ln²(d/d*) = 0.8 · accuracy, from a point of the parabola that scipy's search came by
    half = math.sqrt(row.error / 0.05)
    assert row.error == pytest.approx(0.8 * row.accuracy, rel=1e-2)
    assert math.log(row.high / row.value) == pytest.approx(half, rel=0.3)
    assert math.log(row.value / row.low) == pytest.approx(half, rel=0.3)
    assert row.low <= math.pi <= row.high


def test_the_accuracy_is_tightened_until_the_place_is_known():
    (row,) = best_of(rough)
    # 1 % of the range ln 100 needs 0.05 · 0.046² > 0.8 · accuracy
    assert row.accuracy == pytest.approx(3e-5)
    assert row.value == pytest.approx(math.pi, rel=0.05)


def test_a_best_value_keeps_its_warnings_where_a_more_accurate_solution_of_it_fails():
    wanted = scene().numerics.accuracy

    def solved(one):
        if one.numerics.accuracy < wanted:
            return Result("failed", message="too hard")
        rising = 0.5 + wanted * math.log(one.oil_supply.ratio)  # highest at the border, which each search tries
        return replace(result_of(rising, wanted), warnings=("a warning",))

    (row,) = best_of(solved)
    assert (row.status, row.warnings) == ("ok", ("a warning",)) and row.failed and "too hard" in row.message


def test_a_value_that_closes_only_more_accurately_has_not_failed():
    wanted = scene().numerics.accuracy

    def solved(one):
        if one.numerics.accuracy == wanted and one.oil_supply.ratio == pytest.approx(2.0):
            return Result("failed", message="too loose")
        return result_of(0.5 - wanted * math.log(one.oil_supply.ratio), wanted)  # highest at that border

    (row,) = best_of(solved, first="2", last="20")
    assert row.accuracy < wanted and row.value == pytest.approx(2.0)
    assert (row.failed, row.message, row.beyond) == (0, "", "")


def test_a_minimum_is_found():
    (row,) = best_of(parabola, minimum=True, first="2", last="20")
    assert (row.place, row.value) == ("upper border", pytest.approx(20.0, rel=1e-3))


@pytest.mark.parametrize(
    ("first", "last", "place", "d"), [("0.1", "2", "upper border", 2), ("5", "50", "lower border", 5)]
)
def test_an_optimum_at_the_border_is_said(first, last, place, d):
    (row,) = best_of(parabola, first=first, last=last)
    assert (row.place, row.value) == (place, pytest.approx(d, rel=1e-3))


@each_row(
    ("last", "told"),
    [
        ("2", ""),
        ("4.9", "failed: pressure left the range (choose a smaller gap)"),  # `gappy` has no solution from 5 on
    ],
)
def test_at_a_border_it_is_said_whether_there_is_anything_beyond(last, told):
    (row,) = best_of(gappy, "sweep:\n  operation.speed: [6000 rpm]\n", first="0.5", last=last)
    assert (row.place, row.beyond, row.failed) == ("upper border", told, 0)


def test_a_border_that_is_one_of_the_key_itself_is_said_with_its_limit():
    (row,) = best_of(steady, path="gas.isentropic_exponent", first="1.001", last="1.5")
    assert row.place == "lower border"
    assert row.beyond.startswith("gas.isentropic_exponent: ") and "at least 1.001" in row.beyond


def test_a_best_at_the_edge_of_what_has_solutions_is_told_as_such():
    (row,) = best_of(gappy, "sweep:\n  operation.speed: [6000 rpm]\n", first="0.5", last="10")
    assert row.place == "inside" and row.value == pytest.approx(5.0, rel=1e-3)
    assert row.beyond == "failed: pressure left the range (choose a smaller gap)"


def test_every_local_optimum_is_told_the_highest_first():
    (row,) = best_of(two_tops)
    assert row.value == pytest.approx(0.5, rel=1e-2)
    ((other, height),) = row.others
    assert other == pytest.approx(4.0, rel=1e-2)
    assert height == pytest.approx(0.6, abs=1e-2)


def test_noise_within_the_errors_is_no_local_optimum():
    tops = find_maximum(lambda x: SearchPoint(x, -x * x + 1e-3 * math.cos(40.0 * x), 1e-3), -1.0, 1.0)
    assert tops is not None and tops.others == ()


def test_the_range_is_that_of_the_axis():
    one = scene("sweep:\n  oil_supply.ratio: [0.5, 1, 2]\n")
    asked = question(one)
    assert (asked.low, asked.high) == (0.5, 2.0)
    assert len(optimum(one, asked, simulate=parabola)) == 1


@pytest.mark.parametrize(("model", "figure"), [("ideal", "isothermal_efficiency"), ("real", "isentropic_efficiency")])
def test_the_efficiency_that_is_asked_for_by_itself_is_one_that_the_gas_has(model, figure):
    one = scene()
    real = with_values(one, {"gas.model": model, "gas.isentropic_exponent": None})
    assert question(real).figure == figure
    assert question(real, figure="shaft_power").figure == "shaft_power"
    assert question(scene("sweep:\n  gas.model: [ideal, real]\n")).figure == "isentropic_efficiency"


def test_a_border_of_the_range_that_is_no_machine_is_no_end_of_the_question():
    """Which figures there are is asked of the scene itself, where a slide is too narrow for the first of its axis."""
    slide = new_scene("refrigeration", request_of(fluid="R134a", slide=True))
    whole = loads(slide + "\nsweep:\n  machine.built_in_volume_ratio: [2.2, 3.5]\n")
    with pytest.raises(UsageError, match="male_span"):
        build_parts(case(whole, 0))
    assert question(whole, "machine.built_in_volume_ratio", "shaft_power").low == 2.2


def test_a_figure_that_the_path_does_not_change_has_its_best_anywhere():
    (row,) = best_of(flat)
    assert row.place == "anywhere"
    assert row.low == pytest.approx(0.1) and row.high == pytest.approx(10.0)


@pytest.mark.parametrize(("first", "last"), [(0.31, 0.69), (0.46, 0.48)])
def test_the_best_may_lie_where_values_begin_to_fail(first, last):
    """A hole over a third of the range, whose edge is the best that is left, and one between two points."""

    def hill(x: float) -> SearchPoint:
        return SearchPoint(x, math.nan if first < x < last else 1.0 - abs(x - 0.4), 1e-9)

    top = find_maximum(hill, 0.0, 1.1, count=12 if last > 0.5 else 15)
    expected = first if first < 0.4 else 0.4
    assert top is not None and top.point.x == pytest.approx(expected, abs=2e-4)


def test_failed_solutions_leave_a_partial_result():
    first, second, third = best_of(gappy, SPEEDS)
    assert (second.status, second.value, second.failed) == ("failed", None, second.solutions)
    assert second.message == "13 of 13 solutions: failed: pressure left the range (choose a smaller gap)"
    for row, d in ((first, math.pi / 3.0), (third, math.pi)):
        assert (row.status, row.value) == ("ok", pytest.approx(d, rel=1e-3))
        assert row.failed == 2  # of 13 points from 0.1 to 10 two lie above d = 5
        assert "pressure left the range" in row.message


def test_an_error_of_one_solution_is_its_own():
    (row,) = best_of(raising)
    assert (row.status, row.value) == ("ok", pytest.approx(math.pi, rel=1e-3))
    assert "ZeroDivisionError: float division by zero" in row.message


def test_a_worker_that_dies_costs_its_row_only():
    rows = best_of(deadly, SPEEDS, jobs=2)
    assert [row.status for row in rows] == ["ok", "failed", "ok"]
    assert rows[1].message.startswith("worker died")


@each_row(
    ("asked", "message"),
    [
        ({"figure": "isothermal_eficiency"}, "--figure isothermal_eficiency: is not known; did you mean"),
        ({"path": "oil_supply.ratoi"}, "oil_supply.ratoi: is not known; did you mean 'oil_supply.ratio'?"),
        ({"path": "operation.speed"}, "operation.speed: has no range (write operation.speed=LOW..HIGH, or an axis"),
        ({"path": "machine.male_lobes"}, "machine.male_lobes: is a whole number, not a continuous quantity"),
        ({"path": "operation.speed", "first": "10", "last": "20 rpm"}, "operation.speed: '10' has no unit"),
        ({"first": "3", "last": "2"}, "oil_supply.ratio: the range 3 … 2 is empty (--from must be below --to)"),
        ({"path": "oil_supply.ratio=4..0.5"}, "oil_supply.ratio: the range 4 … 0.5 is empty (LOW must be below HIGH)"),
        ({"path": "oil_supply.ratio=1..2..4"}, "oil_supply.ratio=1..2..4: is not PATH=LOW..HIGH (write e.g. "),
        ({"first": "many"}, "oil_supply.ratio: 'many' is not a plain number"),
    ],
)
def test_a_wrong_question_is_refused_in_one_line(asked, message):
    with pytest.raises(UsageError) as refusal:
        question(scene(), **asked)
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)


def test_a_path_that_the_scene_cannot_have_is_refused():
    text = SCENE.replace("{kind: pump, ratio: 3,", "{kind: displacement, orifice_diameter: 2 mm,")
    one = loads(text)
    with pytest.raises(UsageError, match=r"oil_supply\.ratio: follows from the orifice of displaced oil"):
        optimum(one, question(one), simulate=parabola)
    dry = load(POINT.parents[1] / "slider_crank" / "air.yaml")
    with pytest.raises(UsageError, match=r"oil_supply\.ratio: the scene has no oil supply \(vary another path"):
        question(dry)


def test_the_optimum_of_the_paper_is_that_of_a_fine_grid():
    one = loads(POINT.read_text(), folder=str(POINT.parent), overrides=["operation.speed=3000 rpm"])
    (row,) = optimum(one, question(one))
    fine = with_values(one, {"numerics.accuracy": 1e-6})
    ratio = np.geomspace(0.8, 1.1, 33)  # 1 % apart
    curve = [
        simulate(with_values(fine, {"oil_supply.ratio": float(d)}), trace=False).performance.isothermal_efficiency
        for d in ratio
    ]
    step = ratio[1] / ratio[0]
    assert row.low / step <= ratio[np.argmax(curve)] <= row.high * step
    # two errors: the optimum's own, and that its accuracy of the figure is another than the grid's
    assert row.figure == pytest.approx(max(curve), abs=2.0 * row.error + 1e-6)


def test_a_figure_that_the_scene_has_not_is_said_with_the_remedy():
    (row,) = best_of(gappy, first="0.1", last="0.25")
    message = "no isothermal_efficiency: no gas is delivered (choose another --figure)"
    assert (row.status, row.failed, row.message) == ("failed", 0, message)
