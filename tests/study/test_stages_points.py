"""Points of two stages over a sweep: each is a run's, failures keep their reason, what is finished is kept."""

import csv
import json
import re
from dataclasses import replace
from functools import partial

import pytest
from scenes import scene_dict, two_stages

from screwsim.cli import exit_code
from screwsim.figures.errors import relative_errors, worst
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import Figures, Result
from screwsim.scene.fields import leaves_of
from screwsim.scene.model_errors import stored_model_errors
from screwsim.study.datasheet.stages_points import points_sheet
from screwsim.study.stages import read_stages, run_stages, solve
from screwsim.study.stages.result import ChainResult, figures_of_both
from screwsim.study.sweep import stages as points
from screwsim.study.sweep.stages import KeptPoints, sweep_stages

SPEEDS = {"first.operation.speed": ["2500 rpm", "3000 rpm"], "second.operation.speed": ["1300 rpm", "10000 rpm"]}


@pytest.fixture
def plant(tmp_path):
    return partial(two_stages, tmp_path, sweep=SPEEDS)


@pytest.fixture
def solved(monkeypatch):
    """Replace the solution of a point by one that is immediate; return the values asked for."""
    asked = []

    def answer(chain, values, warm):
        asked.append(dict(values))
        power, stage = sum(values.values()), Result("ok", performance=Figures(shaft_power=1.0))
        whole = figures_of_both({"shaft_power": power})
        return ChainResult("ok", stages=(stage, stage), scenes=(chain.first, chain.second), performance=whole)

    monkeypatch.setattr(points, "solved_with", answer)
    return asked


def test_points_are_those_of_runs_and_one_without_a_pressure_keeps_its_reason(plant):
    path = plant()
    found = sweep_stages(read_stages(path), jobs=1)
    assert [each.result.status for each in found] == ["ok", "failed", "ok", "failed"]
    alone = run_stages(read_stages(path, ["first.operation.speed=2500 rpm"]))
    assert found[0].result.performance.shaft_power == pytest.approx(alone.performance.shaft_power, rel=1e-12)
    assert found[0].result.error.shaft_power == pytest.approx(alone.error.shaft_power, rel=1e-6)
    assert "no intermediate pressure" in found[1].result.message


def test_cycles_that_start_from_one_another_spare_work_and_stay_within_the_accuracy(plant, monkeypatch):
    spent = {"cold": 0, "warm": 0}
    asked = solve.simulate_next

    def counted(series, *given):
        result = asked(series, *given)
        spent["cold" if series is None else "warm"] += result.numerics.rhs_evaluations
        return result

    monkeypatch.setattr(solve, "simulate_next", counted)
    chain = replace(read_stages(plant()), sweep={})
    alone, found = run_stages(chain), run_stages(chain, warm=True)
    assert worst(relative_errors(found.performance, alone.performance))[1] < chain.accuracy
    assert 0 < spent["warm"] < 0.7 * spent["cold"]


def test_paths_of_both_stages_vary_together_and_so_does_what_lies_between(plant, solved):
    between = {"kind": "cooler", "outlet_temperature": "300 K"}
    sweep = {
        "intercooler.outlet_temperature": ["290 K", "300 K"],
        "zip": [{name: values[:2] for name, values in SPEEDS.items()}],
    }
    found = sweep_stages(read_stages(plant(intercooler=between, sweep=sweep)), jobs=1)
    rpm = 3.141592653589793 / 30
    assert [[*each.values.values()] for each in found] == [
        [pytest.approx(T), pytest.approx(n * rpm), pytest.approx(m * rpm)]
        for T in (290.0, 300.0)
        for n, m in ((2500, 1300), (3000, 10000))
    ]


def test_values_reach_their_stage_and_the_line_between(plant):
    between = {"kind": "cooler", "outlet_temperature": "300 K"}
    chain = read_stages(plant(intercooler=between))
    changed = chain.with_values({"second.operation.speed": 5.0, "intercooler.outlet_temperature": 290.0})
    assert (changed.second.operation.speed, changed.intercooler.outlet_temperature) == (5.0, 290.0)
    assert changed.first.operation.speed == chain.first.operation.speed
    assert not changed.sweep


def test_an_interrupted_sweep_goes_on_where_it_was(plant, solved, tmp_path):
    chain = read_stages(plant())
    kept = KeptPoints(chain, tmp_path / "out.csv")
    whole = sweep_stages(chain, kept, jobs=1)
    lines = kept.path.read_text().splitlines()
    kept.path.write_text("\n".join(lines[:3]) + "\n" + lines[3][:20])  # two points, and one cut off
    solved.clear()
    resumed = KeptPoints(chain, tmp_path / "out.csv")
    again = sweep_stages(chain, resumed, jobs=1)
    assert resumed.reused == 2
    assert points_sheet(chain, again, resumed.reused).lines[0][1].endswith("(2 from an earlier run)")
    assert solved == [dict(each.values) for each in whole[2:]]
    assert [each.result.performance for each in again] == [each.result.performance for each in whole]
    assert len(kept.path.read_text().splitlines()) == 1 + len(whole)
    solved.clear()
    sweep_stages(chain, kept, jobs=1, restart=True)
    assert len(solved) == len(whole)


def test_a_point_whose_worker_died_is_tried_again(plant, solved, monkeypatch, tmp_path):
    """The worker of the second point dies once: its message is kept in the table, not for the next run."""
    chain, in_order = read_stages(plant()), points.parallel_map

    def dying(work, count, *, died, kept, **more):
        answers = [died(1) if number == 1 else work(number) for number in range(count)]
        kept(dict(enumerate(answers)))

    monkeypatch.setattr(points, "parallel_map", dying)
    first = sweep_stages(chain, KeptPoints(chain, tmp_path / "out.csv"))
    assert [each.result.status for each in first] == ["ok", "failed", "ok", "ok"]
    monkeypatch.setattr(points, "parallel_map", in_order)
    solved.clear()
    again = sweep_stages(chain, KeptPoints(chain, tmp_path / "out.csv"), jobs=1)
    assert solved == [dict(first[1].values)]
    assert all(each.result.status == "ok" for each in again)


@pytest.mark.parametrize("count", [8, 11])
def test_curves_that_are_not_drawn_are_told_of(plant, solved, count):
    speeds = [f"{1000 + 10 * number} rpm" for number in range(count)]
    along = [f"{1300 + 10 * number} rpm" for number in range(count + 1)]
    chain = read_stages(plant(sweep={"first.operation.speed": speeds, "second.operation.speed": along}))
    sheet = points_sheet(chain, sweep_stages(chain, jobs=1))
    assert {len(drawing.curves) for drawing in sheet.drawings} == {8}
    told = [note for note in sheet.notes if " draw " in note]
    assert told == ["pages and PDFs draw 8 of 11 curves (the table has all points)"] * (count > 8)


@pytest.mark.parametrize(
    ("sweep", "words"),
    [
        ({"sample": {"kind": "sobol", "count": 4}}, "over: {first.operation.speed: {from: 1000 rpm, to: 3000 rpm}}"),
        ({"zip": {}}, "write [{first.operation.speed: […], first.oil_supply.ratio: […]}]"),
    ],
)
def test_examples_of_axes_name_their_stage(plant, sweep, words):
    with pytest.raises(SceneError) as caught:
        read_stages(plant(sweep=sweep))
    assert words in str(caught.value)


def test_points_of_another_sweep_are_not_mixed_in(plant, solved, tmp_path):
    chain = read_stages(plant())
    sweep_stages(chain, KeptPoints(chain, tmp_path / "out.csv"), jobs=1)
    for other in (
        read_stages(plant(sweep={"first.operation.speed": ["1000 rpm"]})),
        read_stages(plant(), ["second.oil_supply.ratio=2"]),
        read_stages(plant(intercooler={"pressure_drop": "0.1 bar"})),
    ):
        with pytest.raises(UsageError, match=r"out\.csv\.part: holds points of other scenes, .* \(start over with"):
            KeptPoints(other, tmp_path / "out.csv").read()
    (tmp_path / "out.csv.part").write_text("not JSON\n")
    with pytest.raises(UsageError, match="holds points of other scenes"):
        KeptPoints(chain, tmp_path / "out.csv").read()


def test_the_command_writes_all_figures_with_their_errors(plant, tmp_path, capsys):
    out = tmp_path / "out.csv"
    assert exit_code(["sweep", str(plant()), "-o", str(out), "--jobs", "1"]) == 4
    told = " ".join(capsys.readouterr().out.split())
    assert "points 4: 2 ok, 2 without a result" in told and "no intermediate pressure" in told
    with out.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["second.operation.speed [rpm]"] for row in rows] == ["1300", "10000"] * 2
    assert float(rows[0]["intermediate_pressure [bar]"]) > 1.5
    assert 0.0 < float(rows[0]["shaft_power_error"]) < 1e-3
    assert rows[1]["status"].startswith("failed: no intermediate pressure") and not rows[1]["shaft_power [kW]"]
    assert not (tmp_path / "out.csv.part").exists()


def test_the_command_draws_the_points_on_a_page(plant, solved, tmp_path, capsys):
    out = tmp_path / "out.html"
    assert exit_code(["sweep", str(plant()), "-o", str(out), "--jobs", "1"]) == 0
    assert "Two stages, 4 points over" in out.read_text(encoding="utf-8")
    assert exit_code(["sweep", str(plant()), "-o", str(tmp_path / "all.csv"), "--jobs", "1", "--json"]) == 0
    out = capsys.readouterr().out
    document = json.loads(out[out.index("{") :])
    assert (document["cases"], document["ok"], len(document["points"])) == (4, 4, 4)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-o", "a.txt"], "-o a.txt: points of two stages are results, a table, a page or a PDF (write one of a.h5, "),
        (["--batch"], "stages have no --batch (sweep one of the two scenes instead)"),
        (["--without", "oil_heat"], "stages have no --without"),
        (["--set", "sweep.first.operation.speed=[1 rpm]"], "belongs to the two-stage file (write it there)"),
    ],
)
def test_what_two_stages_have_not_is_one_line(plant, capsys, arguments, words):
    assert exit_code(["sweep", str(plant()), *arguments]) == 2
    told = capsys.readouterr().err
    assert words in told and told.count("\n") == 1


def test_two_stages_without_a_sweep_are_told_how_to_write_one(plant, capsys):
    assert exit_code(["sweep", str(plant(sweep=None))]) == 2
    assert "has no sweep (add sweep: {first.operation.speed: " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("axis", "words"),
    [
        ("first.operation.sped", "is not known; did you mean 'first.operation.speed'?"),
        ("first.zzz.a", "is not known (use a dotted path of that scene after first.)"),
        ("second.gap", "is not known; there are second.effects.tip_leakage.gap, second.effects.interlobe"),
        ("second.operation.xx", "is not known; known there: speed, tip_speed, ambient_temperature, condensing_temp"),
        (
            "operation.speed",
            "starts with none of first., second., intercooler. (write e.g. first.operation.speed or sec",
        ),
        ("speed", "starts with none of first., second., intercooler. (write e.g. first.operation.speed or sec"),
        ("discharge.pressure", "starts with none of first., second., intercooler. (write e.g. second.operation.disch"),
        ("pressure_drop", "starts with none of first., second., intercooler. (write e.g. intercooler.pressure_drop)"),
        ("first.operation.discharge.pressure", "belongs to the discharge line, which follows from the other stage"),
        ("second.operation.suction.temperature", "belongs to the suction line, which follows from the other stage"),
        ("second.gas.fluid", "is the same in both stages"),
        ("gas.fluid", "is the same in both stages (vary it by two files, or with --set in both)"),
        ("first", "names a stage, not an input of it (write e.g. first.operation.speed)"),
        ("second.effects.oil_heat", "is a section, not a value (write e.g. second.effects.oil_heat."),
        ("intercooler.outlet_temperature", "is not stated (it belongs to kind: cooler; write it first)"),
        ("intercooler.kind", "is not known"),
    ],
)
def test_an_axis_that_cannot_vary_is_located(plant, axis, words):
    with pytest.raises(SceneError) as caught:
        read_stages(plant(sweep={axis: [1, 2]}))
    (line,) = caught.value.lines
    assert f"sweep.{axis}: {words}" in line and "plant.stages.yaml:1:" in line


def test_a_path_offered_for_one_without_a_stage_may_vary(plant):
    chain = read_stages(plant())
    names = {name.rpartition(".")[2] for scene in chain.by_stage.values() for name in leaves_of(scene)}
    offered = set()
    for name in names | {"operation.discharge.pressure", "x", "first speed"}:
        with pytest.raises(UsageError) as refused:
            chain.leaf_of(name)
        offered |= {*re.search(r"\(write e\.g\. (.*)\)$", str(refused.value))[1].split(" or ")}
    assert {"first.operation.speed", "second.operation.discharge.pressure"} < offered
    for path in offered:
        chain.leaf_of(path)


def test_a_run_tells_that_it_leaves_the_sweep_aside(plant, capsys):
    path = str(plant())
    assert exit_code(["run", path]) == 0
    assert capsys.readouterr().err.startswith(f"{path}: its sweep of 4 cases is ignored, and the scene's own point")


def test_a_sweep_tells_that_it_leaves_model_errors_aside(plant, solved, tmp_path, capsys):
    path = plant()
    name = next(iter(stored_model_errors()))
    (tmp_path / "low.yaml").write_text(json.dumps(scene_dict({}) | {"uncertainty": {"model": name}}))
    assert exit_code(["sweep", str(path), "-o", str(tmp_path / "out.csv"), "--jobs", "1"]) == 0
    assert "the first scene's model error is ignored" in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    ("asked", "told"), [({"keep": "cycle"}, ["keep: cycle"]), ({"derivatives": "all"}, ["derivatives: all"]), ({}, [])]
)
def test_a_sweep_tells_that_its_points_keep_figures_alone(plant, solved, tmp_path, capsys, asked, told):
    path = plant()
    (tmp_path / "high.yaml").write_text(
        json.dumps(json.loads((tmp_path / "high.yaml").read_text()) | {"output": asked})
    )
    for ending, lines in ((".h5", told), (".csv", [])):  # a table has no place for them
        assert exit_code(["sweep", str(path), "-o", str(tmp_path / f"out{ending}"), "--jobs", "1"]) == 0
        said = [line for line in capsys.readouterr().err.splitlines() if "output." in line]
        start = f"{path}: the second scene's output."
        assert [line.removeprefix(start).partition(" is ignored (points of two")[0] for line in said] == lines


@pytest.mark.parametrize(
    ("axis", "remedy"),
    [
        ("second.operation.discharge.pressure", "vary second.operation.condensing_temperature"),
        ("first.operation.suction.temperature", "vary first.operation.superheat"),
    ],
)
def test_an_axis_of_the_other_way_to_state_the_lines_is_refused(plant, tmp_path, capsys, axis, remedy):
    lines = {"evaporating_temperature": "-10 degC", "condensing_temperature": "40 degC", "superheat": "5 K"}
    for name in ("low.yaml", "high.yaml"):
        path = plant(sweep={axis: ["8 bar", "9 bar"] if "pressure" in axis else ["280 K", "290 K"]})
        scene = scene_dict({"operation.speed": "1300 rpm"})
        operation = {key: value for key, value in scene["operation"].items() if key not in ("suction", "discharge")}
        operation |= lines | {"subcooling": "2 K"}
        (tmp_path / name).write_text(json.dumps({**scene, "operation": operation}))
    for name in ("low.yaml", "high.yaml"):
        (tmp_path / name).write_text(json.dumps({**scene, "operation": operation}))
    assert exit_code(["sweep", str(path)]) == 3
    told = " ".join(capsys.readouterr().err.split())
    assert "has no meaning where the scene states saturation temperatures" in told and remedy in told


def test_a_sweep_over_two_ambient_pressures_takes_no_gauge_pressures_and_all_else(plant, capsys):
    high = "second.operation.ambient_pressure=0.8 bar"
    assert read_stages(plant(), [high]).sweep
    path = plant(sweep={"second.operation.discharge.pressure": ["7 bar(g)", "8 bar"]})
    assert exit_code(["sweep", str(path), "--set", high]) == 3
    told = capsys.readouterr().err.split(":", 3)[3]
    assert told.startswith(" sweep.second.operation.discharge.pressure: '7 bar(g)' is a gauge pressure (write the abs")
