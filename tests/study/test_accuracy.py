"""The study of what accuracy costs: what it tries, what it finds on a small scene, what it says and stores."""

import csv
import math
import re
from dataclasses import replace
from pathlib import Path

import h5py
import pytest
from small_scene import SCENE as SMALL

from screwsim.cli import exit_code
from screwsim.figures.errors import relative_errors, worst
from screwsim.outputs import Figures, Result
from screwsim.report.evidence import accuracy_figure
from screwsim.report.style import write_all
from screwsim.scene import Scene, load, loads
from screwsim.simulate import simulate
from screwsim.study import accuracy
from screwsim.study.accuracy import QUICK_SCOPE, NoReference, Study, effect_costs, files, reference_of, study, words
from screwsim.study.accuracy.solving import CHECKS, WorkLimit, all_cases, method_of, solve

SCENE = SMALL + "numerics: {accuracy: 0.01}\n"
EXTENT = replace(QUICK_SCOPE, asked=(1e-2, 1e-4), points=(1, 3), limit=1.0, pairs=0, seconds=1e-3, runs=1)


CO2 = Path(__file__).parents[2] / "configs" / "co2" / "transcritical.yaml"


@pytest.fixture(scope="module")
def scene() -> Scene:
    return loads(SCENE)


@pytest.fixture(scope="module")
def found(scene: Scene) -> Study:
    return study.__wrapped__(scene, EXTENT)  # its times are none: code need not be written for speed


def of_part(found: Study, part: str, **others):
    return [m for m in found.measured if m.part == part and all(getattr(m, k) == v for k, v in others.items())]


def test_the_reference_is_checked_by_a_second_method(found):
    assert "radau" in found.reference.second
    assert found.reference.difference < 1e-3 * min(EXTENT.asked) * 10.0


def test_nothing_is_measured_by_a_reference_less_than_a_thousand_times_tighter(found):
    assert all(found.reference.accuracy <= 1e-3 * each.asked for each in found.asked)
    coarse = replace(found.reference, accuracy=1e-9)
    assert not coarse.why_not(1e-6)
    assert "only at 1e-09" in coarse.why_not(1e-7)


def test_every_integrator_is_measured_or_left_out_with_a_reason(found):
    for name in CHECKS:
        cases = of_part(found, "integrators", label=name)
        assert cases
        assert all(m.status == "ok" or m.reason for m in cases)
        for m in cases:
            assert m.status == "ok" or any(name in what for what, _ in found.left_out)


def test_errors_are_within_what_was_asked_and_work_rises(found):
    for label in ("rodas4 histories", "rodas4 coupled"):
        cases = of_part(found, "integrators", label=label)
        assert [m.asked for m in cases] == list(EXTENT.asked)
        assert all(m.error < 3.0 * m.asked for m in cases)
        counts = [m.evaluations for m in cases]
        assert counts == sorted(counts)
    assert all(each.error < each.asked for each in found.asked)


def test_the_lower_order_keeps_what_was_asked_too_and_costs_more_for_more_digits(found):
    lower, own = (of_part(found, "integrators", label=f"{name} histories") for name in ("rodas3", "rodas4"))
    assert [m.asked for m in lower] == list(EXTENT.asked)
    assert all(m.error < 3.0 * m.asked for m in lower)
    assert lower[-1].evaluations > own[-1].evaluations


def test_the_regularisation_alone_biases_as_its_width(found):
    none, own, wide = of_part(found, "regularisation alone")
    assert (none.factor, own.factor, wide.factor) == EXTENT.widths
    assert none.error < 1e-6 < own.error < wide.error


def test_what_changes_the_model_is_told_from_numerical_error(found):
    (dead,) = of_part(found, "dead volume")
    assert dead.error < found.accuracy < dead.change


def test_effects_are_priced(found):
    costs = {each.effect: each for each in found.effects}
    assert set(costs) == {"suction_port", "discharge_port", "tip_leakage"}
    assert costs["tip_leakage"].efficiency < 0.0
    assert costs["tip_leakage"].evaluations != 0.0


def test_start_and_end_angle_are_said_not_to_be_there(found):
    assert "start and end angle" in dict(found.left_out)


def test_the_front_is_beaten_by_no_case(found):
    cases = [m for m in found.comparable if m.status == "ok"]
    best = found.front()
    assert best
    for one in best:
        assert not any(m.time < one.time and m.error < one.error for m in cases)


def test_the_sentence_is_made_from_the_results(found):
    text = words.sentence(found)
    told = next(each for each in found.asked if each.asked == 1e-4)
    assert f"1e-4 costs {words.milliseconds(told.time + told.estimating_time)}" in text
    limit = found.limit_of_regularisation
    assert limit is not None
    assert f"limits you to {words.plain_power(limit)}." in text


def test_the_report_fits_a_terminal(found):
    text = words.report(found)
    assert max(len(line) for line in text.splitlines()) <= 100
    assert "nan" not in text
    assert re.search(r"^What failed or was left out$", text, flags=re.MULTILINE)
    assert " ".join(text.split()).endswith(words.sentence(found))


def test_files_hold_every_case(found, tmp_path):
    table, data = files.write(found, tmp_path)
    with open(table, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["label"] for row in rows] == [m.label for m in found.measured]
    assert float(rows[0]["error_shaft_power"]) <= float(rows[0]["error"]) == found.measured[0].error
    with h5py.File(data) as file:
        assert file.attrs["sentence"] == words.sentence(found)
        assert len(file["cases/time"]) == len(found.measured) == len(file["cases/pressure"])
        assert file["cases/time"].attrs["units"] == "s"
        assert file["reference/performance/shaft_power"].attrs["units"] == "W"
        assert file["reference"].attrs["difference"] == found.reference.difference
        assert len(file["effects/effect"]) == 3
        assert len(file["left_out/reason"]) == len(found.left_out)


def test_the_figure_is_drawn(sketched, found, tmp_path):
    paths = write_all({"accuracy": lambda: accuracy_figure(found)}, tmp_path)
    assert [path.rsplit("/")[-1] for path in paths] == ["accuracy.png", "accuracy.pdf"]


def test_the_command_prints_the_study_and_writes_its_files(sketched, found, tmp_path, monkeypatch, capsys):
    asked = []
    monkeypatch.setattr(accuracy, "study", lambda *arguments: asked.append(arguments) or found)
    (tmp_path / "small.yaml").write_text(SCENE, encoding="utf-8")
    code = exit_code(["accuracy", str(tmp_path / "small.yaml"), "--quick", "-o", str(tmp_path / "out" / "study")])
    out = capsys.readouterr().out
    assert code == 0 and (asked[0][0].title, asked[0][1]) == ("small", QUICK_SCOPE)
    names = {path.name for path in (tmp_path / "out" / "study").iterdir()}
    assert names == {"accuracy.csv", "accuracy.h5", "accuracy.png", "accuracy.pdf"}
    assert "rodas4 histories" in out
    assert "What failed or was left out" in out
    assert "1e-4 costs" in out
    assert out.rstrip().endswith("accuracy.pdf")


def test_what_is_hopeless_is_given_up_within_its_limit(scene):
    with pytest.raises(WorkLimit, match=r"limit of 0\.01 s"):
        solve(scene, method_of(1e-6, "scipy-radau"), limit=0.01)
    # the machinery serves the next scene
    assert solve(scene, method_of(1e-3)).cycle.status == "ok"


def test_explicit_methods_count_their_evaluations(scene):
    rodas = solve(scene, method_of(1e-2))
    radau = solve(scene, method_of(1e-2, "scipy-radau"))
    assert radau.evaluations > rodas.evaluations > 0
    assert math.isclose(radau.evaluation.figures.shaft_power, rodas.evaluation.figures.shaft_power, rel_tol=2e-2)


def test_a_real_gas_is_also_asked_of_coolprop(scene):
    real = replace(scene, gas=replace(scene.gas, model="real", isentropic_exponent=None))
    assert {case.back_end for case in all_cases(real, EXTENT)} == {"compiled", "ideal", "coolprop"}


def test_nothing_is_measured_of_a_cycle_that_closes_where_its_gas_condenses():
    wet = ["operation.superheat=0 K", "operation.speed=4000 rpm", "operation.gas_cooler.pressure=200 bar"]
    scene = load(CO2, [*wet, "effects.suction_line=off"])  # whose leak would warm the gas
    assert simulate(scene, trace=False).status == "failed"
    with pytest.raises(NoReference, match=r"the scene itself has no result: at .* deg CarbonDioxide condenses at"):
        reference_of(scene, QUICK_SCOPE, checked=False)


def test_a_scene_that_fails_says_why_no_reference_is_found():
    drowned = load(CO2.parents[1] / "r134a" / "point.yaml", ["oil_supply.ratio=1000"])
    with pytest.raises(NoReference, match=r"the scene itself has no result: .* highest temperature, 181.85 degC"):
        reference_of(drowned, QUICK_SCOPE, checked=False)


def test_what_is_next_to_nothing_without_an_effect_is_not_divided_by(scene, monkeypatch):
    def fake(asked, trace):
        flow = 0.1 if "suction_port" in asked.effects else 1e-17
        figures = {"gas_mass_flow": flow, "shaft_power": 100.0 * (1.0 + flow), "discharge_temperature": 300.0 + flow}
        figures |= dict.fromkeys(("cooling_capacity", "cop", "electrical_cop"))
        numerics = {"wall_time": 1.0, "estimating_time": 0.0, "rhs_evaluations": 10}
        return Result("ok", performance=Figures(figures), numerics=Figures(numerics))

    monkeypatch.setattr("screwsim.study.accuracy.simulate", fake)
    monkeypatch.setattr("screwsim.study.accuracy.cross_check", lambda scene: [])
    monkeypatch.setattr("screwsim.study.accuracy._points", lambda full, less: 0.0)
    found = effect_costs(scene, "suction_port", QUICK_SCOPE)
    assert math.isnan(found.gas_mass_flow)
    assert found.shaft_power == pytest.approx(0.1)
    assert found.discharge_temperature == pytest.approx(0.1)
    assert math.isnan(found.cop) and math.isnan(found.cooling_capacity)


@pytest.mark.slow
def test_a_driven_scene_is_solved_at_the_speed_at_which_it_runs():
    driven = load(str(Path(__file__).parents[2] / "configs" / "drive" / "induction.yaml"))
    wanted = driven.numerics.accuracy
    finer = solve(driven, method_of(0.1 * wanted))
    assert finer.cycle.status == "ok"
    assert worst(relative_errors(simulate(driven, trace=False).performance, finer.evaluation.figures))[1] <= wanted
