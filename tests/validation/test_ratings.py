"""Ratings of validation/hsk, varispeed and co2: what follows from them, their fits, and their verdicts."""

import json
from pathlib import Path

import pytest
from each_row import each_row

import screwsim
from screwsim.outputs import Figures, Result
from screwsim.scene import value_at
from screwsim.simulate import simulate
from screwsim.study.calibration import read_fit
from screwsim.study.validation import NotRun, read_table, sibling
from screwsim.template import reciprocating

ROOT = Path(__file__).parents[2]
HSK, VARISPEED, CO2 = (ROOT / "validation" / name for name in ("hsk", "varispeed", "co2"))
FIGURES = ("volumetric_efficiency", "electrical_isentropic_efficiency")


@pytest.fixture(scope="module")
def rated():
    return sibling(HSK / "ratings.py")


@pytest.fixture(scope="module")
def row():
    return next(row for row in read_table(HSK / "points.csv") if row["frequency_Hz"] == "50")


def test_capacity_is_mass_flow_and_power_is_work(rated, row):
    one = rated.rating(row)
    twice = rated.rating({**row, "capacity_W": str(2.0 * float(row["capacity_W"]))})
    strong = rated.rating({**row, "power_W": str(2.0 * float(row["power_W"]))})
    for figure in FIGURES:
        assert getattr(twice, figure) == pytest.approx(2.0 * getattr(one, figure), rel=1e-12)
    assert strong.volumetric_efficiency == one.volumetric_efficiency
    assert strong.electrical_isentropic_efficiency == pytest.approx(0.5 * one.electrical_isentropic_efficiency)


def test_speed_and_swept_flow_follow_the_frequency_and_four_poles_halve_the_speed_alone(rated, row):
    one, slow, four = rated.rating(row), rated.rating({**row, "frequency_Hz": "25"}), rated.rating(row, poles=4)
    speed = "operation.speed"
    assert slow.values[speed] == pytest.approx(0.5 * one.values[speed]) == four.values[speed]
    assert slow.volumetric_efficiency == pytest.approx(2.0 * one.volumetric_efficiency)
    assert four.volumetric_efficiency == one.volumetric_efficiency


@each_row("folder", [HSK, VARISPEED], ids=lambda folder: folder.name)
def test_a_fit_is_of_three_ratings_at_one_speed_and_within_its_bounds(folder):
    fit, stored = read_fit(folder / "machine.fit.yaml"), json.loads((folder / "fitted" / "fit.json").read_text())
    script = sibling(folder / ("ratings.py" if folder == HSK else "points.py"))
    assert {point.name for point in fit.points if point.fitted} == set(script.FITTED)
    assert len(fit.points) > len(script.FITTED)
    for parameter in fit.parameters:
        assert parameter.low < stored["parameters"][parameter.path]["value"] < parameter.high


@each_row("folder", [HSK, VARISPEED], ids=lambda folder: folder.name)
def test_the_points_of_a_fit_are_those_of_the_ratings(rated, folder):
    poles, model = (2, rated.FITTED_MODEL) if folder == HSK else (4, "4CE-6.F1")
    own = {one.name: one for one in rated.ratings(folder, poles) if (one.model, one.frequency) == (model, 50.0)}
    points = read_fit(folder / "machine.fit.yaml").points
    assert {point.name for point in points} == set(own)
    for point in points:
        for figure in FIGURES:
            # two digits of a percentage
            assert point.measured[figure].value == pytest.approx(getattr(own[point.name], figure), abs=6e-5)


def test_the_clearance_of_new_cylinders_is_the_one_that_the_other_machines_call_for():
    """λ is too high with half a percent of the swept volume less, too low with as much more; 4CE-6.F1 has no part."""
    new = sibling(VARISPEED / "new.py")
    assert "4CE-6.F1" not in new.others()
    less, written, more = (new.mean_difference(share) for share in (3.5, new.SHARE, 4.5))
    assert less > 1.0 > abs(written) and more < -1.0


def test_lambda_of_new_cylinders_differs_by_as_much_at_all_speeds():
    """Reeds of 6.5 times the shaft's frequency shut late at single speeds; 4CE-6.F1 has no part in what is written."""
    new = sibling(VARISPEED / "new.py")
    written = new.spreads(new.every())
    with new.reeds(6.5, 0.1):
        before = new.spreads(new.every())
    for model, spread in written.items():
        assert spread < (1.0 if model in new.others() else 2.0)
        assert before[model] > 3.0 > spread


def test_friction_of_new_cylinders_is_the_one_that_one_series_calls_for_on_two_fluids():
    """Whose fluids tell share and pressure apart, so that it has no part in a verdict."""
    fit, template = sibling(ROOT / "validation" / "energyplus" / "friction.py"), reciprocating
    share, pressure, left = fit.fitted()
    assert share == pytest.approx(template.FRICTION, abs=0.005)
    assert pressure == pytest.approx(template.FRICTION_PRESSURE, abs=0.005)
    assert left < 3.0


def test_one_point_outside_fails_whatever_the_mean(rated, row, compare_of):
    compare = compare_of("hsk")
    one = rated.rating(row)
    ours = ({figure: getattr(one, figure) + off for figure in FIGURES} for off in (0.01, -0.09))
    scene = screwsim.load(ROOT / "configs" / "paper" / "point.yaml")
    near, far = (compare.Found(one, scene, Result("ok", performance=Figures(each))) for each in ours)
    within = dict.fromkeys(FIGURES, 0.05)
    basis = dict.fromkeys(FIGURES, "")
    assert {row.verdict for row in compare.farthest("", [near] * 9, within, basis)} == {"holds"}
    failed = list(compare.farthest("", [near] * 8 + [far], within, basis))
    assert {row.verdict for row in failed} == {"fails"}
    assert [row.ours for row in failed] == pytest.approx([-9.0, -9.0])


def test_a_rating_that_has_no_solution_is_told_and_not_left_out(rated, row, compare_of, monkeypatch):
    compare, scene = compare_of("hsk"), screwsim.load(ROOT / "configs" / "paper" / "point.yaml")
    monkeypatch.setattr(compare, "with_values", lambda scene, values: scene)
    monkeypatch.setattr(compare, "simulate", lambda scene, trace: Result("failed", "too hot"))
    with pytest.raises(NotRun, match=r"°C, 50 Hz: failed.*too hot"):
        compare.found(scene, [rated.rating(row)])


def test_losses_of_lambda_at_any_speed_and_by_the_time_of_a_turn_are_told_apart(compare_of):
    slow, full = (1.0 - 0.02 - 0.05 * 50.0 / frequency for frequency in (25.0, 50.0))
    assert compare_of("hsk").split(slow, full) == "2.0 + 5.0 points"


def test_slip_that_grows_with_the_square_of_the_frequency_raises_lambda_of_the_source(rated, compare_of):
    """50 rpm of 3000 at 50 Hz are 112.5 of 4500 at 75, where 75 had been taken."""
    compare, scene = compare_of("hsk"), screwsim.load(ROOT / "configs" / "paper" / "point.yaml")
    filled = Result("ok", performance=Figures(dict.fromkeys(FIGURES, 0.9)))
    ratings = [one for one in rated.ratings(HSK) if one.model == "HSK7451-50" and one.name == compare.AT]
    points = [compare.Found(one, scene, filled) for one in ratings]
    at = {one.frequency: one.volumetric_efficiency for one in ratings}
    row = compare.weakened("", points)
    assert row.ours == 0.0
    assert row.theirs == pytest.approx(100.0 * (at[75.0] * (4500.0 - 75.0) / (4500.0 - 112.5) - at[50.0]), rel=1e-12)


def test_friction_by_films_has_the_clearances_of_the_machine_and_of_a_maker(compare_of):
    compare = compare_of("hsk")
    for as_tips in (False, True):
        scene = compare.choices.by_films(compare.new, "192", as_tips)
        tip, gap = (value_at(scene, path) for path in ("effects.oil_drag.tip_gap", "effects.tip_leakage.gap"))
        end, leak = (value_at(scene, path) for path in ("effects.oil_drag.end_gap", "effects.end_face_leakage.gap"))
        assert (tip, end) == pytest.approx((gap, leak), rel=1e-5)
        assert end / tip == pytest.approx(1.0 if as_tips else 50.0 / 26.0, rel=1e-5)  # 129 mm: in proportion to 160
        assert "mechanical" not in scene.effects


def test_films_of_oil_that_holds_gas_rub_less_and_what_it_holds_flashes(compare_of):
    compare = compare_of("hsk")
    pure, laden = (compare.choices.by_films(compare.new, "192", films_at=line) for line in ("", "suction"))
    parameters = laden.effects["refrigerant_solubility"].parameters
    assert (parameters.films_at, "oil_injection" in laden.effects) == ("suction", True)
    dry, wet = (simulate(scene, trace=False).performance for scene in (pure, laden))
    assert wet.oil_drag_power < 0.9 * dry.oil_drag_power and wet.flash_mass_flow > 0.0


def test_the_machine_that_was_fitted_again_is_of_the_stored_fit_and_as_large_as_the_new_one(compare_of):
    compare = compare_of("hsk")
    again = compare.choices.fitted_again(compare.new, "192")
    stored = json.loads((HSK.parent / "bitzer" / "ends_fitted" / "fit.json").read_text())["parameters"]
    tip, flank, end = (value_at(again, path) for path in compare.choices.GAPS)
    written = value_at(compare.new("192"), "effects.tip_leakage.gap")
    assert tip == flank == pytest.approx(written / 26e-6 * stored["effects.tip_leakage.gap"]["value"], rel=1e-9)
    assert end / written == pytest.approx(50.0 / 26.0, rel=1e-9)
    assert again.effects["blow_hole"].parameters.model == "homogeneous"


def test_a_leak_of_one_flow_costs_each_size_the_same_flow_of_suction_gas(compare_of):
    """7 m³/h less of 84 and of 192 m³/h at 2900 rpm, which turn 2950 at 50 Hz."""
    lost_flow = compare_of("hsk").lost_flow
    for displacement in (84.0, 192.0):
        slow, full = (1.0 - 7.0 / (displacement * 2950.0 / 2900.0 * f / 50.0) for f in (25.0, 50.0))
        assert lost_flow(slow, full, str(displacement)) == pytest.approx(7.0)


def test_a_tried_machine_without_solution_is_told_and_counted_only_where_its_oil_may_be_too_hot(
    compare_of, monkeypatch
):
    choices = compare_of("hsk").choices
    dry, oily = (screwsim.load(ROOT / "configs" / "r134a" / f"{name}.yaml") for name in ("compact", "separator"))
    good = Result("ok", performance=Figures(dict.fromkeys(FIGURES, 0.9)))
    results = iter([Result("failed", "too hot"), good, good, Result("failed", "too hot")])
    monkeypatch.setattr(choices, "simulate", lambda scene, trace: next(results))
    assert choices.told(oily, [({}, 88.0, 87.0)] * 3) == "2.0/3.0, 1 of 3 too hot"
    with pytest.raises(NotRun, match="too hot"):
        choices.told(dry, [({}, 88.0, 87.0)])


def test_curves_have_the_nominal_values_printed_beside_them(compare_of):
    compare = compare_of("co2")
    every = compare.compressors(CO2)
    for row in read_table(CO2 / "curves.csv"):
        y = 15.0 if row["range"] == "subcritical" else compare.NOMINAL[1]
        value = every[row["model"]].at(row["figure"], row["range"], -5.0, y)
        assert value == pytest.approx(1e3 * float(row["nominal_kW"]), rel=0.01)  # the cubics are fits


def test_nominal_powers_of_both_files_are_the_same():
    curves = {
        row["model"]: row["nominal_kW"] for row in read_table(CO2 / "curves.csv") if row["range"] == "transcritical"
    }
    assert {row["model"]: row["power_kW"] for row in read_table(CO2 / "nominal.csv")} == curves


def test_sources_that_were_not_run_stay_as_they_are_kept(page_script):
    def source(*verdicts):
        return {"rows": [{"verdict": verdict} for verdict in verdicts]}

    kept = {"version": "1", "sources": {"a": source("holds"), "b": source("fails", "holds")}}
    new = {"version": "2", "sources": {"b": source("fails"), "c": source("no verdict")}}
    found = page_script.merged(kept, new)
    assert found["sources"] == {"a": source("holds"), "b": source("fails"), "c": source("no verdict")}
    assert found["verdicts"] == {"holds": 1, "fails": 1, "no verdict": 1}
