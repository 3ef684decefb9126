"""Optimisation: the known best of one aim, fronts of several, bounds, operating points, interruptions, failures."""

import gc
import math
import threading
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from each_row import each_row
from seek_fakes import RPM, chiller, choosing, deadly, hollow, idle
from study_fakes import gappy, parabola, scene, two_tops

import screwsim
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.printing.optimize import optimize_document, print_optimize
from screwsim.results.table import table_of
from screwsim.scene import with_values
from screwsim.simulate import simulate as simulated
from screwsim.study.best.optimum import optimum
from screwsim.study.best.optimum import question as of_optimum
from screwsim.study.optimize import Aim, optimize, question, run_question
from screwsim.study.optimize.evaluate import weighted_mean
from screwsim.study.optimize.points import as_csv, read_points
from screwsim.study.optimize.record import Record, nearest_neighbour_order
from screwsim.study.optimize.seasons import BIN_HOURS, HEATING_WEATHER, energy_shares, load_at, standards
from screwsim.study.optimize.solve import front_of
from screwsim.study.optimize.store import held_parts
from screwsim.study.pool.parallel import BatchWorkers

RATIO, SPEED = "oil_supply.ratio=1..3", "operation.speed=1000 rpm..5000 rpm"
FIG1 = Path(__file__).parents[2] / "configs" / "paper" / "fig1.yaml"


EVALUATIONS, SMALL_PARTS = 3_000, 16  # of a long run, in 30 batches: parts are joined


@pytest.fixture(scope="module")
def chilled():
    """Return a scene that states evaporation at 2 °C and condensation at 45 °C."""
    return screwsim.load(FIG1.parents[1] / "r134a" / "point.yaml")


def test_one_path_has_the_best_that_optimum_finds():
    one = scene()
    found = optimize(one, ["oil_supply.ratio=0.1..10"], ["isothermal_efficiency"], simulate=parabola, jobs=1)
    (row,) = optimum(one, of_optimum(one), simulate=parabola)
    assert found.values["oil_supply.ratio"] == pytest.approx(row.value, rel=1e-3)
    assert found.aims[found.front[0], 0] == pytest.approx(row.figure, abs=1e-6)


def test_a_function_of_no_module_simulates_here_and_workers_say_that_they_cannot_have_it(tmp_path):
    def own(scene):
        return parabola(scene)

    asked = {"vary": ["oil_supply.ratio=0.1..10"], "maximize": ["isothermal_efficiency"], "evaluations": 5}
    assert optimize(scene(), **asked, simulate=own, jobs=1).status == "ok"
    for call in (
        lambda: optimize(scene(), **asked, simulate=own, jobs=2),
        lambda: screwsim.run_sweep(FIG1, tmp_path / "x.h5", simulate=own, jobs=2),
    ):
        with pytest.raises(UsageError, match=r"cannot be sent to workers: .*own.* \(define it .*, or pass jobs=1\)"):
            call()


def test_every_local_optimum_of_one_path_is_told():
    found = optimize(scene(), ["oil_supply.ratio=0.1..10"], ["eta_iso"], simulate=two_tops, jobs=1)
    ((other, height),) = found.others
    assert (other, height) == (pytest.approx(4.0, rel=1e-2), pytest.approx(0.6, abs=1e-2))


def test_the_known_best_of_the_papers_machine_is_found():
    one = screwsim.load(FIG1, ["operation.speed=3000 rpm", "sweep.operation.speed=[3000 rpm]"])
    (row,) = optimum(one, of_optimum(one), jobs=1)
    found = optimize(one, ["oil_supply.ratio"], ["isothermal_efficiency"], jobs=1)
    assert found.reach["oil_supply.ratio"].low <= row.value <= found.reach["oil_supply.ratio"].high
    # optimum asks for a tenth of the accuracy in the end: both errors
    off = found.errors[found.front[0], 0] + row.error
    assert found.aims[found.front[0], 0] == pytest.approx(row.figure, abs=2.0 * off)


def test_the_best_says_how_far_the_inputs_tolerances_move_its_aim_and_what_is_bounded(capsys):
    """As `uncertainty` of the best scene does, but for the tolerance of what varies."""
    ratio, bounded = "oil_supply.ratio", ["discharge_temperature<15 degC"]
    tolerant = screwsim.load("configs/paper/uncertain.yaml", ["sweep=null"])
    more = {"subject_to": bounded, "evaluations": 12, "jobs": 1, "progress": False}
    found = optimize(tolerant, [f"{ratio}=2.5..5"], minimize=["shaft_power"], **more)
    whole = screwsim.uncertainty(found.scene).spreads
    assert list(found.by_inputs) == ["shaft_power", "discharge_temperature"]
    for name, spread in found.by_inputs.items():
        changes = [one.change for one in whole[name].contributors if one.paths != (ratio,)]
        assert len(changes) == len(whole[name].contributors) - 1
        # the result is that of the value before it is written with seven digits
        assert spread.expanded == pytest.approx(math.hypot(*changes), rel=1e-4), name
    print_optimize(found)
    out = " ".join(capsys.readouterr().out.split())
    half = found.by_inputs["discharge_temperature"].expanded
    assert f" °C by the inputs' tolerances ± {half:.2g} K (95 %): oil_heat.drop" in out
    assert optimize_document(found)["uncertainties_by_inputs"].keys() == found.by_inputs.keys()
    assert not optimize(tolerant, [f"{ratio}=2.5..5"], ["eta_iso", "shaft_power"], **more).by_inputs


def test_a_path_that_is_best_at_both_ends_matters():
    """Values as good lie at both ends of the range, and none between."""
    found = optimize(scene(), ["oil_supply.ratio=1..3"], ["isothermal_efficiency"], simulate=hollow, jobs=1)
    reach = found.reach["oil_supply.ratio"]
    assert reach.border and not reach.idle


@pytest.mark.parametrize(("high", "told"), [("2", ""), ("4.9", "failed: pressure left the range")])
def test_at_a_border_it_is_said_whether_there_is_anything_beyond(high, told):
    """`gappy` has no solution from a ratio of 5 on; the best at 6000 rpm is 6.28."""
    fast = with_values(scene(), {"operation.speed": 6.0 * RPM * 1000.0})
    found = optimize(fast, [f"oil_supply.ratio=0.5..{high}"], ["isothermal_efficiency"], simulate=gappy, jobs=1)
    reach = found.reach["oil_supply.ratio"]
    assert reach.border == "upper border" and reach.beyond.startswith(told) and bool(reach.beyond) == bool(told)


def test_a_best_beside_values_that_fail_says_why(capsys):
    """`gappy` has no solution from a ratio of 5 on, and its best at 6000 rpm is at 6.28."""
    fast = with_values(scene(), {"operation.speed": 6.0 * RPM * 1000.0})
    found = optimize(fast, ["oil_supply.ratio=0.5..8"], ["isothermal_efficiency"], simulate=gappy, jobs=1)
    reach = found.reach["oil_supply.ratio"]
    assert found.values["oil_supply.ratio"] == pytest.approx(5.0, rel=1e-2) and not reach.border
    print_optimize(found)
    told = "oil_supply.ratio: at the edge of the values that have a solution: failed: pressure left the range"
    assert told in " ".join(capsys.readouterr().out.split())


def test_the_operating_point_that_fails_is_told(tmp_path):
    """`gappy` fails at 2000 rpm."""
    file = tmp_path / "points.csv"
    file.write_text("name,operation.speed [rpm]\nslow,1500\nmiddle,2000\nfast,3000\n")
    asked = {"maximize": ["isothermal_efficiency"], "over": str(file), "evaluations": 5}
    found = optimize(scene(), ["oil_supply.ratio=1..3"], **asked, simulate=gappy, jobs=1)
    (reason,) = found.reasons
    assert reason == "failed at middle: pressure left the range (choose a smaller gap)"


def test_a_path_that_does_nothing_lies_at_no_border():
    """The best of figures that differ by their errors alone is anywhere: here at the lower end."""
    found = optimize(scene(), ["oil_supply.ratio=1..3"], ["isothermal_efficiency"], simulate=idle, jobs=1)
    reach = found.reach["oil_supply.ratio"]
    assert found.values["oil_supply.ratio"] == 1.0
    assert (reach.low, reach.high, reach.border, reach.idle) == (1.0, 3.0, "", True)


@pytest.mark.parametrize("jobs", [1, 2])
def test_one_aim_over_two_paths_is_found_beside_what_fails(jobs):
    found = optimize(scene(), [RATIO, SPEED], minimize=["shaft_power"], simulate=choosing, jobs=jobs, evaluations=200)
    # at x = y = 0; the polish ends within a thousandth of the ranges
    assert found.aims[found.front[0], 0] == pytest.approx(1.0, abs=1e-4)
    assert found.failed > 0 and sum(found.reasons.values()) == found.failed
    assert next(iter(found.reasons)).startswith("failed: speed of 0.") and len(found.reasons) == 1
    assert {reach.border for reach in found.reach.values()} == {"lower border"}


def test_the_answer_is_the_same_for_any_number_of_workers():
    asked = question(scene(), [RATIO, SPEED], ["gas_mass_flow"], ["shaft_power"], evaluations=60)
    one, two = (run_question(asked, simulate=choosing, jobs=jobs) for jobs in (1, 2))
    assert np.array_equal(one.places, two.places) and np.array_equal(one.aims, two.aims, equal_nan=True)


def test_a_search_that_ran_out_of_evaluations_says_so(capsys):
    for allowed, cut in ((30, True), (2000, False)):
        found = optimize(
            scene(), [RATIO, SPEED], minimize=["shaft_power"], simulate=choosing, jobs=1, evaluations=allowed
        )
        assert found.cut_short is cut and (len(found.places) == allowed) is cut
        print_optimize(found)
        assert ("more of them may find better (--evaluations)" in " ".join(capsys.readouterr().out.split())) is cut


def test_a_bound_moves_the_best_to_it():
    # x ≥ sqrt(0.25) by the power less y²: at y = 0 the flow is best where the power is at its bound
    found = optimize(
        scene(), [RATIO, SPEED], ["gas_mass_flow"], subject_to=["shaft_power<1.25 W"], simulate=choosing, jobs=1
    )
    row = found.front[0]
    assert found.excess[row, 0] <= 0.0 and found.outside > 0
    assert found.aims[row, 0] == pytest.approx(1.75, abs=5e-3)


def test_bounds_that_nothing_meets_are_said_with_the_nearest():
    bound = ["shaft_power<0.5 W"]
    found = optimize(scene(), [RATIO, SPEED], ["gas_mass_flow"], subject_to=bound, simulate=choosing, jobs=1)
    assert (found.status, len(found.front)) == ("none", 0)
    assert "shaft_power<0.5 W was required, and the nearest is 1" in found.message


def test_where_all_fails_the_reason_is_told():
    one = with_values(scene(), {"operation.speed": 2000.0 * RPM})
    found = optimize(one, ["oil_supply.ratio=0.1..10"], ["eta_iso"], simulate=gappy, jobs=1)
    assert found.status == "none" and found.failed == len(found.places)
    assert found.message.startswith("all 13 evaluations failed, 13 of them with: failed: pressure left the range")


def test_a_front_of_two_aims_lies_on_the_true_one_and_beats_random_samples():
    found = optimize(
        scene(), [RATIO, SPEED], ["gas_mass_flow"], ["shaft_power"], simulate=choosing, jobs=1, evaluations=300
    )
    flow, power = found.aims[found.front].T
    assert len(found.front) > 20
    # the true front: sqrt(power - 1) + sqrt(2 - flow) = 1
    assert np.median(np.sqrt(power - 1.0) + np.sqrt(2.0 - flow)) == pytest.approx(1.0, abs=0.02)
    samples = np.random.default_rng(7).random((3000, 2))  # ten times as many
    worse = np.column_stack([-2.0 + (1.0 - samples[:, 0]) ** 2 + samples[:, 1] ** 2, 1.0 + np.sum(samples**2, axis=1)])
    ours = np.column_stack([-flow, power])
    beaten = np.any(np.all(ours[None] <= worse[:, None] + 0.02, axis=2), axis=1)
    assert beaten.all()


@pytest.mark.parametrize("columns", [1, 2, 3])
def test_a_front_is_what_no_other_dominates(columns):
    values = np.random.default_rng(columns).random((200, columns))
    values[3] = np.nan
    front = set(front_of(values))
    for row in range(200):
        better = np.all(values <= values[row], axis=1) & np.any(values < values[row], axis=1)
        assert (row in front) == (not better.any() and row != 3)


def test_an_interrupted_run_goes_on_and_gives_the_same(tmp_path):
    asked = question(scene(), [RATIO, SPEED], ["gas_mass_flow"], ["shaft_power"], evaluations=80)
    whole = run_question(asked, tmp_path / "whole.h5", simulate=choosing, jobs=1)
    with pytest.raises(KeyboardInterrupt):
        run_question(asked, tmp_path / "part.h5", simulate=Interrupted(), jobs=1)
    again = run_question(asked, tmp_path / "part.h5", simulate=choosing, jobs=1)
    assert again.reused == 48  # three populations of 16
    assert np.array_equal(again.places, whole.places)
    a, b = (screwsim.open_results(tmp_path / name) for name in ("whole.h5", "part.h5"))
    for name in a.optimum:
        assert np.array_equal(a.optimum[name], b.optimum[name], equal_nan=True)
    assert not (tmp_path / "part.h5.parts").exists()


class Interrupted:
    """Stop the 51st solution."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, one):
        self.calls += 1
        if self.calls > 50:
            raise KeyboardInterrupt
        return choosing(one)


@pytest.mark.around
def test_a_worker_that_dies_costs_its_evaluations_only():
    asked = question(scene(), [RATIO], minimize=["shaft_power"])
    found = run_question(asked, simulate=deadly, jobs=2)
    assert found.status == "ok" and found.aims[found.front[0], 0] == pytest.approx(1.25, abs=1e-3)  # at y = 0.5
    dead = int(np.sum(found.asked.spans[0].low + 2.0 * found.places[:, 0] > 2.8))
    assert found.failed == dead and next(iter(found.reasons)).startswith("failed: worker died")


def test_workers_start_afresh_after_a_while(monkeypatch):
    monkeypatch.setattr("screwsim.study.optimize.record.EVALUATIONS_PER_WORKER", 20)
    asked = question(scene(), [RATIO, SPEED], ["gas_mass_flow"], ["shaft_power"], evaluations=80)
    left = []
    monkeypatch.setattr(BatchWorkers, "leave", lambda crew: left.append(crew))
    found = run_question(asked, simulate=choosing, jobs=1)
    assert len(found.places) == 80 and len(left) == 4  # after 20, 40, 60, and in the end


def test_workers_that_have_left_leave_no_thread_beside_which_none_is_forked():
    before = threading.active_count()
    with BatchWorkers(2, lambda: None) as crew:
        for _ in range(5):
            assert crew.answers(abs, [-1, 2, -3]) == [1, 2, 3]
            crew.leave()
            assert threading.active_count() == before


@pytest.mark.around
def test_a_long_run_keeps_few_bytes_of_an_evaluation_in_memory(monkeypatch, tmp_path):
    monkeypatch.setattr("screwsim.study.sweep.shards.BYTES_IN_MEMORY", 100_000)
    monkeypatch.setattr("screwsim.study.sweep.shards.MOST_SMALL_PARTS", SMALL_PARTS)
    asked = question(scene(), [RATIO, SPEED], ["gas_mass_flow"], ["shaft_power"], evaluations=EVALUATIONS)
    batch, generator, sizes = 100, np.random.default_rng(1), []
    tracemalloc.start()
    try:
        with held_parts(tmp_path / "long.h5", asked, restart=False) as parts:
            record = Record(asked, Canned(), parts)
            while len(record) < EVALUATIONS:
                record.evaluate(generator.random((batch, 2)))
                if len(record) in (EVALUATIONS // 2, EVALUATIONS):
                    gc.collect()
                    sizes.append(tracemalloc.get_traced_memory()[0])
    finally:
        tracemalloc.stop()
    numbers = 8 * (len(asked.spans) + 2 * len(asked.aims))
    assert numbers <= (sizes[1] - sizes[0]) / (EVALUATIONS // 2) < 2 * numbers
    assert len(list((tmp_path / "long.h5.parts").glob("*.npz"))) <= SMALL_PARTS


class Canned(BatchWorkers):
    """Answer every evaluation with one result, at once."""

    def __init__(self) -> None:
        super().__init__(1, lambda: None)
        self._table = table_of([choosing(with_values(scene(), {"oil_supply.ratio": 1.5}))], keep_cycle=False)

    def answers(self, task, payloads):
        return [self._table.rows(np.zeros(len(work), int)) for work in payloads]


def test_the_file_holds_all_cases_and_what_was_aimed_at(tmp_path):
    file = tmp_path / "out.h5"
    how = {"subject_to": ["shaft_power<1.5 W"], "simulate": choosing, "jobs": 1, "output": file}
    found = optimize(scene(), [RATIO, SPEED], ["gas_mass_flow"], **how)
    results = screwsim.open_results(file)
    assert results.shape == (len(found.places),)
    assert np.array_equal(results.optimum["aim_gas_mass_flow"], found.aims[:, 0], equal_nan=True)
    assert np.array_equal(results.optimum["excess_shaft_power_most"], found.excess[:, 0], equal_nan=True)
    assert np.flatnonzero(results.optimum["front"]).tolist() == found.front.tolist()
    assert results.along("oil_supply.ratio") == pytest.approx(1.0 + 2.0 * found.places[:, 0])
    ok = results.status == "ok"
    assert results.performance["gas_mass_flow"][ok] == pytest.approx(found.aims[ok, 0])
    data = results.to_xarray(None)
    assert data.optimum_front.sum() == 1 and data.optimum_aim_gas_mass_flow.dims == ("evaluation",)
    with pytest.raises(UsageError, match="already exists"):
        optimize(scene(), [RATIO], ["gas_mass_flow"], simulate=choosing, jobs=1, output=file)


def test_parts_of_another_question_are_refused(tmp_path):
    asked = question(scene(), [RATIO, SPEED], ["gas_mass_flow"], evaluations=60)
    with pytest.raises(KeyboardInterrupt):
        run_question(asked, tmp_path / "out.h5", simulate=Interrupted(), jobs=1)
    with pytest.raises(UsageError, match="holds evaluations of another optimisation"):
        run_question(replace(asked, seed=2), tmp_path / "out.h5", simulate=choosing, jobs=1)
    assert (
        run_question(replace(asked, seed=2), tmp_path / "out.h5", simulate=choosing, jobs=1, restart=True).reused == 0
    )


def test_seasonal_points_have_the_weights_of_their_standards():
    known = standards()
    assert [point.weight for point in known["IPLV"].ratings] == [0.01, 0.42, 0.45, 0.12]
    assert sum(point.weight for point in known["ESEER-water"].ratings) == pytest.approx(1.0)
    assert sum(BIN_HOURS["SEPR"].values()) == pytest.approx(8760.0)  # a year
    assert sum(BIN_HOURS["SEER"].values()) == 2602.0  # hours above 16 °C
    assert sum(BIN_HOURS["SCOP"].values()) == 4910.0  # hours below 16 °C
    for name in ("SEER", "SEPR", "SCOP"):
        assert sum(energy_shares(name)) == pytest.approx(1.0)


def test_the_heat_of_a_year_is_that_of_2066_hours_at_full_load():
    """Regulation (EU) 811/2013, annex VII 4(c): the equivalent hours of the average climate, in whole hours."""
    assert round(sum(hours * load_at("SCOP", T) for T, hours in BIN_HOURS["SCOP"].items())) == 2066


def test_the_law_of_the_cooling_load_gives_the_rating_points_in_whole_percents():
    """And goes on: space cooling vanishes at 16 °C and exceeds the design load on hotter days than 35 °C."""
    for name in ("SEER", "SEPR"):
        ratings = standards()[name].ratings
        assert [round(load_at(name, each.warm), 2) for each in ratings] == [each.load for each in ratings]
    assert load_at("SEER", 16.0) == 0.0
    assert load_at("SEER", 39.0) == pytest.approx(23.0 / 19.0)
    assert load_at("SEPR", -10.0) == load_at("SEPR", 5.0) == 0.8
    ratings = standards()["SCOP-35"].ratings
    assert [round(load_at("SCOP", each.cold), 2) for each in ratings] == [each.load for each in ratings]
    assert load_at("SCOP", 16.0) == 0.0


def test_shares_of_the_cooling_energy_meet_its_mean_temperature():
    """Dividing each hour linearly between two points keeps its first moment, inside the outer points."""
    points = {"SEER": (35.0, 30.0, 25.0, 20.0), "SEPR": (35.0, 25.0, 15.0, 5.0), "SCOP": HEATING_WEATHER}
    for name, at in points.items():
        cooling = {T: hours * load_at(name, T) for T, hours in BIN_HOURS[name].items()}
        mean = sum(min(max(T, min(at)), max(at)) * each for T, each in cooling.items()) / sum(cooling.values())
        found = sum(T * share for T, share in zip(at, energy_shares(name), strict=True))
        assert found == pytest.approx(mean, abs=1e-9)


def test_a_seasonal_figure_of_one_cop_is_that_cop(chilled):
    points = read_points(chilled, "SEPR")
    four = np.full(4, 5.0)
    assert weighted_mean(points, "cop", four, 0.01 * four) == (pytest.approx(5.0), pytest.approx(0.05))
    # cooling over work: half the cooling at twice the COP takes a third of the work
    halves = _first_two_halved(points)
    for cop in ("cop", "electrical_cop"):
        assert weighted_mean(halves, cop, np.array([2.0, 4.0, 9.0, 9.0]), np.zeros(4))[0] == pytest.approx(8.0 / 3.0)
    assert weighted_mean(halves, "shaft_power", np.array([2.0, 4.0, 9.0, 9.0]), np.zeros(4))[0] == pytest.approx(3.0)


def _first_two_halved(points):
    """Return points of a file, of which the first two have half of the energy each."""
    return replace(
        points, bins=(), points=tuple(replace(each, weight=0.5 * (i < 2)) for i, each in enumerate(points.points))
    )


@pytest.mark.parametrize(("season", "name"), [("SEER", "SEER"), ("SEPR", "SEPR-water"), ("SCOP", "SCOP-55")])
def test_a_standard_interpolates_the_cop_at_each_outdoor_temperature(season, name, chilled):
    """EN 14825: the year's heat over its work, at COPs linear between the rating points, constant beyond them."""
    weather = {"SEER": (20.0, 25.0, 30.0, 35.0), "SEPR": (5.0, 15.0, 25.0, 35.0), "SCOP": HEATING_WEATHER}[season]
    rising = np.linspace(2.0, 9.0, len(weather))
    heat = {T: hours * load_at(season, T) for T, hours in BIN_HOURS[season].items()}
    work = sum(each / np.interp(T, weather, rising) for T, each in heat.items())
    kelvin = {"operation.evaporating_temperature": 258.15, "operation.condensing_temperature": 331.15}
    points = read_points(with_values(chilled, kelvin), name)
    cops = rising if season == "SCOP" else rising[::-1]  # points of cooling begin with the hottest day
    found, error = weighted_mean(points, points.cops[0], cops, 0.01 * cops)
    assert found == pytest.approx(sum(heat.values()) / work)
    assert error == pytest.approx(0.01 * found)
    of_file, _ = weighted_mean(replace(points, bins=()), points.cops[0], cops, 0.01 * cops)
    assert found > 1.005 * of_file


def test_standards_become_a_compressors_temperatures_by_the_scenes_own(chilled):
    points = read_points(chilled, "IPLV")
    T_e, T_c = (
        [point.values[f"operation.{name}_temperature"] - 273.15 for point in points.points]
        for name in ("evaporating", "condensing")
    )
    # 5 K below 7 °C and 10 K above 35 °C at full load, in proportion to the load; 20 °C at least
    assert T_e == pytest.approx([2.0, 3.25, 4.5, 5.75])
    assert T_c == pytest.approx([45.0, 34.5, 24.0, 20.0])


def test_a_heat_pump_meets_the_temperatures_of_scop_by_its_own(chilled):
    kelvin = {"operation.evaporating_temperature": 258.15, "operation.condensing_temperature": 331.15}
    pump = with_values(chilled, kelvin)
    entering = {"": (-10.0, -7.0, 2.0, 7.0, 12.0), "-brine": (0.0,) * 5, "-water": (10.0,) * 5}
    load = np.array([1.0, 0.88, 0.54, 0.35, 0.15])
    for medium, outside in entering.items():
        points = read_points(pump, f"scop-55{medium}")
        T_e, T_c = np.array([list(point.values.values()) for point in points.points]).T - 273.15
        assert [point.load for point in points.points] == load.tolist()
        assert T_e == pytest.approx(np.array(outside) - (outside[0] + 15.0) * load)
        assert T_c == pytest.approx(np.array([55.0, 52.0, 42.0, 36.0, 30.0]) + 3.0 * load)
        assert points.aim.load == "heating_capacity"


def test_over_shares_of_the_heat_a_heating_cop_is_heat_over_work(chilled):
    points = read_points(with_values(chilled, {"operation.evaporating_temperature": 258.15}), "SCOP-35")
    halves = _first_two_halved(points)
    values, none = np.array([2.0, 4.0, 9.0, 9.0, 9.0]), np.zeros(5)
    for cop, mean in (("heating_cop", 8.0 / 3.0), ("electrical_heating_cop", 8.0 / 3.0), ("cop", 3.0)):
        assert weighted_mean(halves, cop, values, none)[0] == pytest.approx(mean)


def test_without_paths_the_scene_itself_is_rated_over_the_points(chilled):
    assert question(chilled, [], over="IPLV").aims == (Aim("electrical_cop"),)
    found = optimize(chilled, maximize="cop", over="IPLV", simulate=chiller, jobs=1)
    assert (found.status, len(found.places), len(found.points)) == ("ok", 1, 4)
    T = np.array([list(point.values.values())[:2] for point in read_points(chilled, "IPLV").points])
    weights = [0.01, 0.42, 0.45, 0.12]
    assert found.aims[0, 0] == pytest.approx(np.dot(weights, 0.6 * T[:, 0] / (T[:, 1] - T[:, 0])))
    none = optimize(chilled, maximize="cop", subject_to=["cop>100"], over="IPLV", simulate=chiller, jobs=1)
    assert none.status == "none" and none.message.endswith("(widen the bound, or vary a path)")
    with pytest.raises(UsageError, match=r"nothing varies \(give one path or more with its range, or points to rate"):
        optimize(chilled, simulate=chiller, jobs=1)


@pytest.mark.parametrize("name", ["SEER-water", "SCOP-35"])
def test_printed_points_read_back(name, chilled, tmp_path):
    if name == "SCOP-35":
        chilled = with_values(chilled, {"operation.evaporating_temperature": 258.15})
    points = read_points(chilled, name)
    file = tmp_path / "points.csv"
    file.write_text(as_csv(points))
    again = read_points(chilled, str(file))
    assert (again.energy, again.by, again.heating) == (True, "operation.speed", name == "SCOP-35")
    for a, b in zip(again.points, points.points, strict=True):
        assert (a.name, a.load) == (b.name, b.load)
        assert a.weight == pytest.approx(b.weight, rel=1e-5)
        assert a.values == pytest.approx(b.values, abs=1e-5)


def test_part_loads_are_reached_by_the_speed(chilled):
    how = {"over": "IPLV", "simulate": chiller, "jobs": 1, "evaluations": 13}
    found = optimize(chilled, ["oil_supply.ratio=0.5..2"], ["cop"], **how)
    capacity = [each.result.performance.cooling_capacity for each in found.points]
    assert np.array(capacity) / capacity[0] == pytest.approx([1.0, 0.75, 0.5, 0.25], rel=5e-3)
    both = ([each.values[name] for name in each.point.values] for each in found.points)
    cop = [0.6 * T_e / (T_c - T_e) for T_e, T_c in both]
    assert found.aims[found.front[0], 0] == pytest.approx(np.dot([0.01, 0.42, 0.45, 0.12], cop))


@pytest.mark.parametrize("own", [0.0, 0.1])
def test_part_loads_are_reached_by_a_slide_that_is_at_full_load_first(own, tmp_path):
    """It had no range from zero, and none beyond 1.3 times its own position."""

    def slid(scene):
        found = chiller(scene).performance
        share = 1.0 - 0.9 * scene.effects["slide_valve"].parameters.position
        return Result("ok", performance=Figures({**found, "cooling_capacity": share * found.cooling_capacity}))

    file = tmp_path / "points.csv"
    file.write_text("weight, load by effects.slide_valve.position\n1, 1\n1, 0.5\n1, 0.25\n")
    control = screwsim.load(FIG1.parents[1] / "control" / "point.yaml", [f"effects.slide_valve.position={own}"])
    found = optimize(control, maximize="cop", over=str(file), simulate=slid, jobs=1)
    capacity = [each.result.performance.cooling_capacity for each in found.points]
    assert np.array(capacity) / capacity[0] == pytest.approx([1.0, 0.5, 0.25], rel=5e-3)


def test_bounds_hold_at_every_operating_point(chilled):
    found = optimize(
        chilled,
        ["operation.speed=1000 rpm..5000 rpm"],
        ["cooling_capacity"],
        over="IPLV",
        subject_to=["shaft_power<20 kW"],
        simulate=chiller,
        jobs=1,
    )
    assert max(each.result.performance.shaft_power for each in found.points) == pytest.approx(20e3, rel=1e-2)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("weight, operation.condensing_temperature [bar]\n1, 20", "line 2: operation.condensing_temperature: '20 bar'"),
        ("weight, operation.condensing_temprature [degC]\n1, 20", "line 1: operation.condensing_temprature: is not"),
        ("weight, load\n1, 0.5", "its first point does not have load 1 (write full load first)"),
        ("weight, energy\n1, 1", "has both weight and energy (keep one: each weights the points)"),
        (
            "energy, heating_load\n1, 1",
            "its load and its energy are not both of cooling or of heating (write heating_l",
        ),
        ("weight\n-1", "line 2: weight '-1' is not a number of at least 0"),
        ("weight\n0", "all weights are zero"),
        ("weight", "has 0 points"),
    ],
)
def test_bad_points_are_refused_at_their_line(chilled, tmp_path, rows, message):
    file = tmp_path / "points.csv"
    file.write_text(rows)
    with pytest.raises(UsageError) as refusal:
        read_points(chilled, str(file))
    assert message in str(refusal.value) and "\n" not in str(refusal.value)


@each_row(
    ("asked", "message"),
    [
        ({"maximize": ["effciency"]}, "--maximize effciency: is not known"),
        (
            {"maximize": ["cop", "shaft_power"], "minimize": ["shaft_power"]},
            "--maximize cop: is not a figure of this",
        ),
        (
            {"maximize": ["shaft_power"], "minimize": ["shaft_power"]},
            "--maximize, --minimize: shaft_power is given twice as an aim",
        ),
        ({"subject_to": ["shaft_power=9 kW"]}, "--subject-to shaft_power=9 kW: is not FIGURE<VALUE or FIGURE>VALUE"),
        ({"evaluations": 0}, "--evaluations 0: is not a number of evaluations"),
        ({"over": "IPVL"}, "--over IPVL: is neither a CSV file nor a seasonal figure (known: IPLV, IPLV-water"),
        ({"over": "SEPR"}, "--over SEPR: needs operation.evaporating_temperature and"),
        ({"vary": ["operation.speed"]}, "--vary operation.speed: has no range (write operation.speed=LOW..HIGH"),
    ],
)
def test_a_wrong_question_is_refused_in_one_line(asked, message):
    with pytest.raises(UsageError) as refusal:
        question(scene(), **({"vary": [RATIO]} | asked))
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)


def test_points_take_gauge_pressures_over_the_scenes_ambient_one(tmp_path):
    file, p_d = tmp_path / "points.csv", "operation.discharge.pressure"
    file.write_text(f"{p_d} [bar(g)], operation.suction.temperature [degF]\n7, 68\n8, 50\n")
    points = read_points(scene().with_({"operation.ambient_pressure": "0.9 bar"}), str(file)).points
    assert [point.values[p_d] for point in points] == pytest.approx([7.9e5, 8.9e5])
    assert [point.values["operation.suction.temperature"] for point in points] == pytest.approx([293.15, 283.15])


def test_an_approach_of_nothing_is_refused(chilled):
    cold = with_values(chilled, {"operation.condensing_temperature": 308.15})
    with pytest.raises(
        UsageError, match=r"leaves 0 K for the condenser above air of 35 °C at full load \(raise operation"
    ):
        read_points(cold, "ESEER")


def test_a_gas_cooler_has_no_condensing_temperature_and_so_no_seasonal_figure():
    cooled = screwsim.load(FIG1.parents[1] / "co2" / "transcritical.yaml")
    with pytest.raises(UsageError, match=r"^--over SEPR: needs operation.evaporating_temperature and operation.cond"):
        read_points(cooled, "SEPR")


def test_a_path_of_the_points_is_not_varied(chilled):
    with pytest.raises(UsageError, match="is also set by the operating points of --over"):
        question(chilled, ["operation.condensing_temperature=30 degC..50 degC"], ["cop"], over="SEPR")


def test_neighbours_follow_each_other():
    order = nearest_neighbour_order(np.array([[0.0], [0.9], [0.2], [1.0], [0.1]]))
    assert order.tolist() == [0, 4, 2, 1, 3]


@pytest.mark.around
def test_the_machine_itself_is_optimised_over_a_season(chilled):
    # three evaluations, to see that simulation, loads and weights go together
    found = optimize(chilled, ["oil_supply.ratio=0.8..1.2"], ["cop"], over="ESEER", evaluations=3, jobs=1)
    assert found.status == "ok" and found.failed == 0
    best = found.points
    load = [each.result.performance.cooling_capacity / best[0].result.performance.cooling_capacity for each in best]
    assert load == pytest.approx([1.0, 0.75, 0.5, 0.25], rel=5e-3)
    weighted = sum(each.point.weight * each.result.performance.cop for each in best)
    assert found.aims[found.front[0], 0] == pytest.approx(weighted, rel=1e-3)
    full = simulated(with_values(found.scene, best[0].values), trace=False)
    assert best[0].result.performance.cop == pytest.approx(full.performance.cop, rel=3e-4)
