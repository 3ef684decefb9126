"""Sensitivities of two stages: derivatives are those of whole solutions, indices those of the inputs of both."""

import csv
import json
import math
from dataclasses import replace

import pytest
from scenes import DROP, scene_dict, two_stages

import screwsim
from screwsim.cli import exit_code
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.scene import with_values
from screwsim.study.asked.spans import read_ranges
from screwsim.study.seek.by_inputs import uncertainties_by_inputs
from screwsim.study.stages import read_stages, run_stages, solve
from screwsim.study.stages.result import figures_of_both
from screwsim.study.uncertainty.measured import compare_measured, read_measured
from screwsim.study.uncertainty.sobol import sensitivity
from screwsim.study.uncertainty.stages import chain_sensitivities

RPM = math.pi / 30.0
FIRST, SECOND = "first.operation.speed", "second.operation.speed"
COOLED = {"kind": "cooler", "outlet_temperature": "288 K", "pressure_drop": "0.05 bar"}
STEPS = {  # [SI] half the distance of the solutions whose difference is the derivative
    "first.operation.suction.pressure": 500.0,
    "first.effects.tip_leakage.gap": 1e-6,
    SECOND: 0.5,
    "second.operation.discharge.pressure": 2000.0,
    "intercooler.outlet_temperature": 0.5,
    "intercooler.pressure_drop": 500.0,
}
COMPARED = ("intermediate_pressure", "shaft_power", "gas_mass_flow", "discharge_temperature", "isentropic_efficiency")


def test_derivatives_are_those_of_whole_solutions_beside_the_point(plant):
    """Tolerance: 0.3 % of the largest derivative of a figure, each per step: quick ones are good to 1e-3, the flows of
    both solutions match to 1e-7 of steps worth some 1e-3, and the curvature over a step is of its square."""
    chain, finer = read_stages(plant(intercooler=COOLED)), {"numerics.accuracy": 1e-6}
    chain = replace(chain, first=with_values(chain.first, finer), second=with_values(chain.second, finer))
    found = chain_sensitivities(chain, list(STEPS), fine=False)
    assert not found.left_out and list(found.values) == list(STEPS)
    changes = {name: {} for name in COMPARED}
    for name, step in STEPS.items():
        value = chain.value_at(name)
        ends = [run_stages(chain.with_values({name: value + way * step})).performance for way in (1.0, -1.0)]
        for figure in COMPARED:
            changes[figure][name] = ends[0][figure] - ends[1][figure]
    for figure, by in changes.items():
        largest = max(map(abs, by.values()))
        for name, change in by.items():
            told = 2.0 * STEPS[name] * found.derivatives[figure][name]
            assert told == pytest.approx(change, abs=0.003 * largest), (figure, name)


def test_a_pressure_drop_of_zero_is_raised_only_as_gas_from_a_flash_intercooler_has_no_superheat_to_lose(tmp_path):
    """Tolerance: 2 % for the curvature over 1 kPa; both solutions are closed to 1e-5 of some 4 kW, 40 W per kPa."""
    path, exact = two_stages(tmp_path, intercooler={"kind": "flash_intercooler"}), {"numerics.accuracy": 1e-5}
    low = {**exact, "gas.fluid": "R134a", "gas.model": "real", "gas.two_phase": "equilibrium"}
    low |= {"oil.transport": "carried", "oil_supply.temperature": DROP, "effects.separator": {}}
    ends = {"evaporating_temperature": "10 degC", "superheat": "5 K", "condensing_temperature": "45 degC"}
    high = {**low, "operation.speed": "1300 rpm", **{f"operation.{name}": value for name, value in ends.items()}}
    high |= {"operation.suction": DROP, "operation.discharge": DROP}
    (tmp_path / "low.yaml").write_text(json.dumps(scene_dict(low)))
    (tmp_path / "high.yaml").write_text(json.dumps(scene_dict(high)))
    chain, name, step = read_stages(path), "intercooler.pressure_drop", 1e3
    found = chain_sensitivities(chain, [name], fine=False)
    solved = [run_stages(chain.with_values({name: by})).performance for by in (0.0, step)]
    for figure in ("shaft_power", "intermediate_pressure"):
        change = solved[1][figure] - solved[0][figure]
        assert found.derivatives[figure][name] * step == pytest.approx(change, rel=0.02), figure


def test_all_numbers_of_both_scenes_are_taken_but_for_the_line_that_is_solved_for(plant):
    found = screwsim.sensitivities(plant(intercooler=COOLED), figures=["shaft_power"], fine=False)
    assert list(found.derivatives) == ["shaft_power"]
    assert {FIRST, SECOND, "intercooler.pressure_drop", "first.operation.suction.pressure"} <= set(found.values)
    assert not {"first.operation.discharge.pressure", "second.operation.suction.pressure"} & set(found.values)
    assert found.units[SECOND] == "rad/s" and found.method[SECOND] in ("exact", "quick")


def test_the_command_prints_them_and_writes_a_table(plant, tmp_path, capsys):
    path, out = plant(), tmp_path / "slopes.csv"
    assert exit_code(["sensitivity", str(path), "--local", FIRST, SECOND, "-o", str(out)]) == 0
    text = capsys.readouterr().out
    assert "change of a figure, in percent per percent of a number" in text and SECOND in text
    with out.open(encoding="utf-8-sig", newline="") as stream:
        rows = {(row["figure"], row["path"]): row["relative"] for row in csv.DictReader(stream)}
    # a faster second stage draws the pressure between both down
    assert float(rows["intermediate_pressure", SECOND]) < 0.0 < float(rows["intermediate_pressure", FIRST])


@pytest.mark.around
def test_indices_share_the_variance_between_inputs_of_both_stages(plant):
    """A flow that is 3 x + y over equal widths has the shares 0.9 and 0.1."""

    def flow(chain):
        values = {"gas_mass_flow": 3.0 * chain.first.operation.speed + chain.second.operation.speed}
        return Result("ok", performance=figures_of_both(values), error=Figures(gas_mass_flow=1e-9))

    chain = read_stages(plant())
    ranges = read_ranges(chain, [f"{FIRST}=2000 rpm..3000 rpm", f"{SECOND}=1000 rpm..2000 rpm"])
    found = sensitivity(chain, ranges, ["gas_mass_flow"], samples=256, jobs=1, simulate=flow)
    (shares,) = found.shares
    # of 256 samples of Sobol's sequence, whose indices of a sum are good to 1e-2
    assert {each.path: each.total for each in shares.indices} == pytest.approx({FIRST: 0.9, SECOND: 0.1}, abs=0.01)


def test_the_derivative_by_a_pressure_drop_of_zero_is_that_beside_it(plant):
    """Tolerance: the drop beside it is 3e-4 of the pressure between both."""
    drop, slopes = "intercooler.pressure_drop", []
    for stated in ("0 bar", "1 mbar"):
        chain = read_stages(plant(intercooler=COOLED | {"pressure_drop": stated}))
        slopes.append(chain_sensitivities(chain, [drop], COMPARED, fine=False).derivatives)
    for name in COMPARED:
        assert slopes[0][name][drop] == pytest.approx(slopes[1][name][drop], rel=3e-3), name


@pytest.mark.around
def test_a_solution_of_both_is_a_sample(plant, capsys):
    words = ["sensitivity", str(plant()), "--path", f"{SECOND}=1250 rpm..1350 rpm", "--samples", "2", "--jobs", "1"]
    assert exit_code([*words, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["solutions"] == 6
    ends = [read_stages(plant()).with_values({SECOND: n * RPM}).solved().performance for n in (1250.0, 1350.0)]
    low, high = sorted(each.gas_mass_flow for each in ends)
    assert low < document["figures"]["gas_mass_flow"]["mean"] < high


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--check-sobol", "8"], "no input has a tolerance"),
        (["--local", "-o", "a.h5"], "-o a.h5: derivatives of two stages are a table (write -o a.csv)"),
        (["--local", "-o", "a.txt"], "-o a.txt: derivatives of two stages are a table (write -o a.csv)"),
        (["--local", "operation.speed"], "operation.speed: starts with none of first., second., intercooler."),
        (
            ["--local", "first.oil_supply.orifice_diameter"],
            "is not stated in the first scene (state it, or leave it out)",
        ),
        (["--local", "first.operation.discharge.pressure"], "belongs to the discharge line, which follows from"),
    ],
)
def test_what_a_study_of_two_stages_has_not_is_one_line(plant, tmp_path, monkeypatch, capsys, words, told):
    monkeypatch.chdir(tmp_path)
    assert exit_code(["sensitivity", str(plant()), *words]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1


@pytest.mark.around
def test_a_known_solution_of_both_is_not_solved_again(plant, monkeypatch):
    """`find` and `run --measured` solved it twice."""
    path = plant(intercooler=COOLED | {"outlet_temperature": "288 K ± 3 K"})
    solution = run_stages(read_stages(path)).as_result()
    found = screwsim.sensitivities(path, [SECOND], ["shaft_power"], fine=False)
    monkeypatch.setattr(solve, "_run", lambda *asked: pytest.fail("solved again"))
    known = screwsim.sensitivities(path, [SECOND], ["shaft_power"], result=solution, fine=False)
    assert known.derivatives["shaft_power"] == pytest.approx(found.derivatives["shaft_power"], rel=1e-9)
    assert screwsim.uncertainty(path, result=solution).spreads["shaft_power"].standard > 0.0
    by_inputs, why = uncertainties_by_inputs(read_stages(path), solution, {SECOND: 1300.0 * RPM}, ["shaft_power"])
    assert by_inputs[SECOND].standard > 0.0 and why == ""
    measured = read_measured(read_stages(path), [f"shaft_power={0.9 * solution.performance.shaft_power} W ± 1 %"])
    monkeypatch.setattr("screwsim.study.uncertainty.measured._solved", lambda *asked: ([], {}))
    assert compare_measured(read_stages(path), solution, measured).why == ""


def test_a_result_of_two_other_stages_is_refused(plant):
    path = plant()
    other = run_stages(read_stages(path, ["second.operation.speed=1200 rpm"])).as_result()
    for asked in (lambda: screwsim.sensitivities(path, result=other), lambda: screwsim.uncertainty(path, result=other)):
        with pytest.raises(UsageError, match="belongs to two other stages: the second one has another machine, speed"):
            asked()


def test_a_result_of_one_machine_is_none_of_two(plant):
    with pytest.raises(UsageError, match="result: belongs to one machine, and here are two stages"):
        screwsim.sensitivities(plant(), result=Result("ok"))
