"""Best values of two stages: found by the searches of one machine, with the pressure between both."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from scenes import scene_dict

import screwsim
from screwsim.cli import exit_code
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.printing.optimum import optimum_document, print_optimum, write_optimum
from screwsim.scene import cross_check
from screwsim.study.best.optimum import optimum, question
from screwsim.study.optimize import question as several
from screwsim.study.optimize import run_question
from screwsim.study.stages import StageChain, read_stages
from screwsim.study.stages.result import figures_of_both

RPM = math.pi / 30.0
SPEED = "second.operation.speed"
CONFIGS = Path(__file__).parents[2] / "configs" / "two_stage"


@pytest.fixture
def plant(tmp_path):
    def write(scene=None, **content):
        (tmp_path / "low.yaml").write_text(json.dumps(scene_dict(scene or {})))
        (tmp_path / "high.yaml").write_text(json.dumps(scene_dict({"operation.speed": "1300 rpm", **(scene or {})})))
        path = tmp_path / "plant.stages.yaml"
        path.write_text(json.dumps({"title": "plant", "stages": ["low.yaml", "high.yaml"], **content}))
        return path

    return write


def hill(chain):
    """Return figures with the best efficiency where the second stage turns at 0.4 of the first stage's speed."""
    first, second = chain.first.operation.speed, chain.second.operation.speed
    values = {
        "isentropic_efficiency": 0.7 - math.log(second / (0.4 * first)) ** 2 - 1e-6 * (first / RPM - 3000.0) ** 2,
        "intermediate_pressure": 4e5 * first / second,
        "gas_mass_flow": 1e-4 * first,
        "shaft_power": 100.0 * first,
    }
    return Result("ok", performance=figures_of_both(values))


def test_the_best_speed_is_found_for_each_speed_of_the_other_stage_with_the_pressure_there(plant):
    chain = read_stages(plant(sweep={"first.operation.speed": ["2500 rpm", "3500 rpm"]}))
    asked = question(chain, f"{SPEED}=500 rpm..3000 rpm")
    rows = optimum(chain, asked, jobs=1, simulate=hill)
    for row, rpm in zip(rows, (2500.0, 3500.0), strict=True):
        assert row.values == {"first.operation.speed": pytest.approx(rpm * RPM)}
        assert (row.status, row.place) == ("ok", "inside")
        # the search stops within 1e-4 of its range, ln 6
        assert row.value == pytest.approx(0.4 * rpm * RPM, rel=1e-3)
        assert row.beside == {"intermediate_pressure": pytest.approx(1e6, rel=1e-3)}


@pytest.mark.around
def test_a_best_value_of_solutions_is_better_than_those_beside_it(plant, tmp_path, capsys):
    """R134a without motors: the efficiency is highest at a speed inside the range, and lower 3 % to either side."""
    path, out = plant(), tmp_path / "best.csv"
    words = ["optimum", str(path), "--path", f"{SPEED}=900 rpm..1500 rpm", "--jobs", "1", "-o", str(out), "--json"]
    assert exit_code(words) == 0
    told = capsys.readouterr()
    assert "isentropic_efficiency is used (choose another with --figure)" in told.err
    (row,) = json.loads(told.out)["rows"]
    assert (row["status"], row["place"]) == ("ok", "inside")
    with out.open(encoding="utf-8-sig", newline="") as stream:
        (stored,) = csv.DictReader(stream)
    assert float(stored["intermediate_pressure [Pa]"]) == pytest.approx(
        row["beside"]["intermediate_pressure"], rel=1e-6
    )
    chain = read_stages(path)
    for value in (1.03 * row["value"], row["value"] / 1.03):
        other = chain.with_values({SPEED: value}).solved()
        assert other.performance.isentropic_efficiency < row["figure"] - 2.0 * row["error"]


def test_columns_of_both_speeds_name_their_stage(plant, capsys):
    chain = read_stages(plant(sweep={"first.operation.speed": ["2500 rpm", "3500 rpm"]}))
    asked = question(chain, f"{SPEED}=500 rpm..3000 rpm")
    print_optimum(chain, asked, optimum(chain, asked, jobs=1, simulate=hill))
    lines = capsys.readouterr().out.splitlines()
    top = next(number for number, line in enumerate(lines) if line.split()[:2] == ["first", "second"])
    assert lines[top + 1].split()[:2] == ["speed", "speed"]


def test_a_figure_that_is_sought_has_one_column(plant, tmp_path, capsys):
    chain, out = read_stages(plant()), tmp_path / "best.csv"
    asked = question(chain, f"{SPEED}=500 rpm..3000 rpm", "intermediate_pressure")
    rows = optimum(chain, asked, jobs=1, simulate=hill)
    assert "beside" not in optimum_document(chain, asked, rows)["rows"][0]
    print_optimum(chain, asked, rows)
    assert capsys.readouterr().out.count("intermediate") == 2  # in the question, and over its column
    write_optimum(out, chain, asked, rows)
    with out.open(encoding="utf-8-sig", newline="") as stream:
        (stored,) = csv.DictReader(stream)
    assert float(stored["intermediate_pressure [Pa]"]) == pytest.approx(rows[0].figure)


@pytest.mark.parametrize(
    "words",
    [
        ("optimum", "--path", "second.operation.tip_speed=20 m/s..50 m/s", "--figure", "shaft_power"),
        ("optimize", "--vary", "second.operation.tip_speed=20 m/s..50 m/s", "--minimize", "shaft_power"),
    ],
)
def test_values_that_fit_into_no_stage_are_told_before_anything_is_solved(plant, capsys, monkeypatch, words):
    monkeypatch.setattr(StageChain, "solved", lambda chain: pytest.fail("solved"))
    command, *rest = words
    assert exit_code([command, str(plant()), *rest, "--jobs", "1"]) == 2
    error = capsys.readouterr().err
    assert error.startswith("second.operation.tip_speed: is given as well as operation.speed")
    assert error.count("\n") == 1


def test_what_the_line_between_both_settles_is_no_fault(plant, tmp_path):
    """The discharge pressure of the first scene and the suction pressure of the second are replaced."""
    path = plant()
    (tmp_path / "low.yaml").write_text(json.dumps(scene_dict({"operation.discharge.pressure": "3 bar"})))
    (tmp_path / "high.yaml").write_text(json.dumps(scene_dict({"operation.suction.pressure": "8 bar"})))
    chain = read_stages(path)
    for name, bar in (("first.operation.suction.pressure", 4.0), ("second.operation.discharge.pressure", 7.0)):
        changed = chain.with_values({name: 1e5 * bar})
        stage, _, _ = name.partition(".")
        assert cross_check(getattr(changed, stage))  # alone it does not fit
        assert changed.faults() == ()


def test_two_inputs_are_sought_together_within_a_bound(plant):
    chain = read_stages(plant())
    vary = ["first.operation.speed=2000 rpm..4000 rpm", f"{SPEED}=500 rpm..3000 rpm"]
    asked = several(chain, vary, subject_to=["gas_mass_flow<0.0283 kg/s"], evaluations=150)
    found = run_question(asked, jobs=1, simulate=hill)
    assert found.status == "ok"
    # the bound is 1e-4 · first speed, so 2702 rpm, below the best of 3000 rpm
    assert found.values["first.operation.speed"] == pytest.approx(283.0, rel=0.01)
    assert found.values[SPEED] == pytest.approx(0.4 * 283.0, rel=0.02)
    assert found.points[0].result.performance.gas_mass_flow <= 0.0283


BOTH = ["first.operation.speed=2000 rpm..4000 rpm", f"{SPEED}=500 rpm..3000 rpm"]


def stored_columns(path, *names):
    """Return columns of a table, CSV or HDF5."""
    if path.suffix == ".h5":
        with h5py.File(path) as file:
            return [file[name.replace(".", "_")][:] for name in names]
    with path.open(encoding="utf-8-sig", newline="") as stream:
        rows = [{head.partition(" [")[0]: cell for head, cell in row.items()} for row in csv.DictReader(stream)]
    return [np.array([row[name] for row in rows], float) for name in names]


@pytest.mark.parametrize("ending", [".csv", ".h5"])
def test_all_evaluations_of_two_stages_are_a_table(plant, tmp_path, ending):
    asked = several(read_stages(plant()), BOTH, subject_to=["gas_mass_flow<0.0283 kg/s"], evaluations=40)
    out = tmp_path / f"out{ending}"
    found = run_question(asked, out, jobs=1, simulate=hill)
    first, second, flow, power, eta, excess, feasible, front = stored_columns(
        out,
        *("first.operation.speed", SPEED, "gas_mass_flow", "shaft_power", "isentropic_efficiency"),
        *("gas_mass_flow_most_excess", "feasible", "front"),
    )
    assert len(first) == len(found.places) and second.max() <= 3000.0 * RPM * (1.0 + 1e-12)
    assert flow == pytest.approx(1e-4 * first, rel=1e-12) and power == pytest.approx(100.0 * first, rel=1e-12)
    assert excess == pytest.approx(flow - 0.0283, abs=1e-12)
    assert np.array_equal(feasible == 1.0, flow <= 0.0283)
    (best,) = np.flatnonzero(front)
    assert eta[best] == eta[feasible == 1.0].max() and first[best] == pytest.approx(
        found.values["first.operation.speed"]
    )


def test_an_interrupted_search_of_two_stages_goes_on_from_what_it_solved(plant, tmp_path):
    asked = several(read_stages(plant()), BOTH, evaluations=40)
    out, solved = tmp_path / "out.csv", []

    def ended(chain):
        if len(solved) == 20:
            raise KeyboardInterrupt
        solved.append(chain)
        return hill(chain)

    with pytest.raises(KeyboardInterrupt):
        run_question(asked, out, jobs=1, simulate=ended)
    assert not out.exists()
    again = run_question(asked, out, jobs=1, simulate=hill)
    assert 0 < again.reused <= 20
    whole = run_question(asked, tmp_path / "whole.csv", jobs=1, simulate=hill)
    assert np.array_equal(again.places, whole.places)
    assert out.read_bytes() == (tmp_path / "whole.csv").read_bytes()
    with pytest.raises(UsageError, match="already exists"):
        run_question(asked, out, jobs=1, simulate=hill)
    run_question(asked, out, jobs=1, restart=True, simulate=hill)


def test_a_search_of_two_stages_replaces_no_table_of_ones_own(plant, tmp_path, capsys):
    mine = tmp_path / "mine.csv"
    mine.write_text("name,shaft_power [kW]\na,3\n")
    words = ["optimize", str(plant()), "--vary", BOTH[1], "--minimize", "shaft_power", "--jobs", "1"]
    for place, told in ((mine, "already exists, and is not a file of this kind"), ("out.yaml", "needs an ending that")):
        assert exit_code([*words, "-o", str(place)]) == 2
        assert told in capsys.readouterr().err
    assert mine.read_text().startswith("name,")


@pytest.mark.around
def test_the_commands_search_two_stages(plant, capsys):
    ranges = ["--vary", "first.operation.speed=2900 rpm..3100 rpm", "--vary", f"{SPEED}=1250 rpm..1350 rpm"]
    words = ["optimize", str(plant()), *ranges, "--minimize", "shaft_power", "--evaluations", "6", "--jobs", "1"]
    assert exit_code(words) == 0
    told = capsys.readouterr().out
    assert "lowest shaft power, varying first.operation.speed 2900 rpm … 3100 rpm" in told
    assert "intermediate pressure" in told


def test_a_finer_accuracy_is_asked_of_both_stages_unless_one_states_its_steps(plant):
    chain = read_stages(plant())
    finer = chain.with_accuracy(1e-5)
    assert (finer.first.numerics.accuracy, finer.second.numerics.accuracy) == (1e-5, 1e-5)
    assert read_stages(plant({"numerics.rtol": 1e-6})).with_accuracy(1e-5) is None


def test_a_stage_that_is_more_accurate_already_stays_so(plant, tmp_path):
    path = plant()
    (tmp_path / "high.yaml").write_text(json.dumps(scene_dict({"numerics.accuracy": 2e-5})))
    changed = read_stages(path, ["first.numerics.accuracy=1e-3"]).with_accuracy(1e-4)
    assert (changed.first.numerics.accuracy, changed.second.numerics.accuracy) == (1e-4, 2e-5)


def test_the_usual_figure_is_that_of_what_the_stages_are_for(plant):
    cold, air = (read_stages(CONFIGS / f"{name}.stages.yaml") for name in ("plant", "air"))
    assert cold.usual_figure == "electrical_cop"
    assert replace(cold, first=replace(cold.first, effects={})).usual_figure == "cop"
    assert air.usual_figure == "package_isentropic_efficiency"
    assert read_stages(plant()).usual_figure == "isentropic_efficiency"


@pytest.mark.parametrize(
    ("path", "told"),
    [
        ("oil_supply.ratio", "--path oil_supply.ratio: is in both stages (write that of one, e.g. --path 'second."),
        (f"{SPEED}=2 rpm..1 rpm", "the range 2 rpm … 1 rpm is empty (LOW must be below HIGH)"),
        (SPEED, f"{SPEED}: has no range (write {SPEED}=LOW..HIGH, or an axis of it under sweep:)"),
        ("second.operation.sped=1 rpm..2 rpm", "did you mean 'second.operation.speed'?"),
        ("operation.speed=1 rpm..2 rpm", "starts with none of first., second., intercooler."),
        (
            "first.operation.discharge.pressure=1 bar..2 bar",
            "belongs to the discharge line, which follows from the other",
        ),
        ("second.machine.male_lobes=3..5", "is a whole number, not a continuous quantity"),
        (f"{SPEED}=1 bar..2 bar", f"{SPEED}: "),
    ],
)
def test_a_path_that_cannot_vary_is_one_line(plant, capsys, path, told):
    assert exit_code(["optimum", str(plant()), "--path", path]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1


@pytest.mark.parametrize("option", [["--over", "IPLV"], ["--without", "oil_heat"]])
def test_what_a_search_of_two_stages_has_not_is_one_line(plant, capsys, option):
    assert exit_code(["optimize", str(plant()), "--vary", f"{SPEED}=1 rpm..2 rpm", *option]) == 2
    error = capsys.readouterr().err
    assert f"stages have no {option[0]} (optimize one of the two scenes instead)" in error and error.count("\n") == 1


def test_a_figure_that_two_stages_have_not_is_one_line(plant):
    with pytest.raises(UsageError, match="--figure volumetric_efficiency: is a figure of one stage, not of these two"):
        question(read_stages(plant()), f"{SPEED}=1 rpm..2 rpm", "volumetric_efficiency")


def test_a_program_asks_by_the_name_of_the_file(plant):
    with pytest.raises(UsageError, match="has no range"):
        screwsim.optimum(str(plant()), SPEED)
