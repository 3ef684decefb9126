"""Uncertainty of two stages: derivatives through both are those of whole solutions, and what is told of them."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from scenes import scene_dict

import screwsim
from screwsim.cli import exit_code
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.scene import scene_text, with_values
from screwsim.scene.types import COVERAGE
from screwsim.study.stages import read_stages, run_stages
from screwsim.study.stages.store import chain_text
from screwsim.study.sweep.stages import KeptPoints, sweep_stages
from screwsim.study.uncertainty import stages_linear
from screwsim.study.uncertainty.spreads import tolerances_of
from screwsim.study.uncertainty.stages import with_uncertainty

LOW = {
    "effects.tip_leakage.gap": "50 um ± 8 um",
    "operation.suction.pressure": "1.5 bar ± 20 mbar",
    "operation.suction.temperature": "283 K ± 1 K",
    "operation.discharge.pressure": "12 bar ± 1 bar",
}
HIGH = {
    "operation.speed": "1300 rpm ± 1 %",
    "operation.discharge.pressure": "12 bar ± 0.1 bar",
    "effects.interlobe_leakage.gap": "40 um ×/÷ 1.2",
}
COOLED = {"kind": "cooler", "outlet_temperature": "288 K", "pressure_drop": "0.05 bar"}
LOOSELY = COOLED | {"outlet_temperature": "288 K ± 3 K", "pressure_drop": "0.05 bar ± 20 mbar"}
COMPARED = ("intermediate_pressure", "shaft_power", "gas_mass_flow", "discharge_temperature", "isentropic_efficiency")


@pytest.fixture
def plant(tmp_path):
    def write(low=LOW, high=HIGH, intercooler=None, **content):
        (tmp_path / "low.yaml").write_text(json.dumps(scene_dict(low)))
        (tmp_path / "high.yaml").write_text(json.dumps(scene_dict({"operation.speed": "1300 rpm", **high})))
        path = tmp_path / "plant.stages.yaml"
        between = {} if intercooler is None else {"intercooler": intercooler}
        path.write_text(json.dumps({"title": "plant", "stages": ["low.yaml", "high.yaml"], **between, **content}))
        return path

    return write


@pytest.mark.around
@pytest.mark.parametrize("between", [None, COOLED, LOOSELY])
def test_standard_uncertainties_are_those_of_whole_solutions_at_other_inputs(plant, between):
    """The change of each figure by an input is that between two solutions one standard uncertainty to either side.

    Tolerance: 1 % of the figure's whole uncertainty. Quick derivatives are good to 1e-3, the curvature over the step
    is of its square, and both solutions match their flows to 1e-7.
    """
    chain = read_stages(plant(intercooler=between))
    finer = {"numerics.accuracy": 1e-6}
    chain = replace(chain, first=with_values(chain.first, finer), second=with_values(chain.second, finer))
    found = with_uncertainty(chain, run_stages(chain))
    assert not found.warnings
    told = found.uncertainty["figures"]
    tolerances = tolerances_of(chain)
    changes = {name: {} for name in COMPARED}
    for name, tolerance in tolerances.uncertain.items():
        value = float(chain.value_at(name))
        step = 0.5 * tolerance.standard_at(value)
        high, low = (run_stages(chain.with_values({name: value + way * step})).performance for way in (1.0, -1.0))
        for figure in COMPARED:
            changes[figure][name] = high[figure] - low[figure]
    for figure in COMPARED:
        whole = np.sqrt(sum(each**2 for each in changes[figure].values()))
        assert told[figure]["standard"] == pytest.approx(whole, rel=0.01)
        contributors = {one["paths"][0]: one["change"] / COVERAGE for one in told[figure]["contributors"]}
        for name, change in changes[figure].items():
            assert contributors.get(name, 0.0) == pytest.approx(change, abs=0.01 * whole), (figure, name)


def test_a_program_gets_the_uncertainties_of_both_by_the_path_of_their_file(plant):
    path = plant()
    told = with_uncertainty(chain := read_stages(path), run_stages(chain)).uncertainty["figures"]
    found = screwsim.uncertainty(path)
    assert {name: spread.standard for name, spread in found.spreads.items()} == pytest.approx(
        {name: each["standard"] for name, each in told.items()}, rel=1e-6
    )
    with pytest.raises(UsageError, match="no input has a tolerance"):
        screwsim.uncertainty(plant(low={}, high={}))


def test_the_line_between_both_has_no_tolerance_of_its_own(plant):
    chain = read_stages(plant())
    assert "operation.discharge.pressure" in chain.first.uncertain
    names = tolerances_of(chain).uncertain
    assert "first.operation.discharge.pressure" not in names
    assert "second.operation.discharge.pressure" in names


def test_inputs_that_err_together_in_one_scene_add_before_they_are_squared(plant, tmp_path):
    path = plant(
        low={"effects.tip_leakage.gap": "50 um ± 8 um", "effects.interlobe_leakage.gap": "40 um ± 8 um"}, high={}
    )
    apart = with_uncertainty(chain := read_stages(path), run_stages(chain)).uncertainty["figures"]["gas_mass_flow"]
    low = json.loads((tmp_path / "low.yaml").read_text())
    low["uncertainty"] = {"correlated": [["effects.tip_leakage.gap", "effects.interlobe_leakage.gap"]]}
    (tmp_path / "low.yaml").write_text(json.dumps(low))
    joined = with_uncertainty(chain := read_stages(path), run_stages(chain)).uncertainty
    own = joined["figures"]["gas_mass_flow"]
    assert joined["groups"] == [["first.effects.tip_leakage.gap", "first.effects.interlobe_leakage.gap"]]
    assert own["standard"] == pytest.approx(sum(abs(one["change"]) for one in apart["contributors"]) / COVERAGE)


def test_inputs_of_both_scenes_that_err_together_add_before_they_are_squared(plant, tmp_path):
    gaps = ("effects.tip_leakage.gap", "effects.interlobe_leakage.gap")
    rows = {gaps[0]: "50 um ± 8 um", gaps[1]: "40 um ± 8 um"}
    path = plant(low=rows, high=rows, intercooler=LOOSELY)
    apart = with_uncertainty(chain := read_stages(path), run_stages(chain)).uncertainty["figures"]
    low = json.loads((tmp_path / "low.yaml").read_text())
    low["uncertainty"] = {"correlated": [list(gaps)]}
    (tmp_path / "low.yaml").write_text(json.dumps(low))
    content = json.loads(path.read_text()) | {
        "uncertainty": {"correlated": [[f"first.{gaps[0]}", f"second.{gaps[0]}"]]}
    }
    path.write_text(json.dumps(content))
    chain = read_stages(path)
    found = with_uncertainty(chain, run_stages(chain)).uncertainty
    whole = (f"first.{gaps[0]}", f"first.{gaps[1]}", f"second.{gaps[0]}")
    assert list(whole) in found["groups"]  # one of the scene and one of both, which share an input
    for figure in COMPARED:
        changes = {each["paths"][0]: each["change"] for each in apart[figure]["contributors"]}
        (joined,) = (each for each in found["figures"][figure]["contributors"] if tuple(each["paths"]) == whole)
        assert joined["change"] == pytest.approx(sum(changes[name] for name in whole), rel=1e-6)
    text = chain_text(chain)
    for name, scene in chain.by_stage.items():
        (tmp_path / f"{name}.yaml").write_text(scene_text(scene))
    again = tmp_path / "again.stages.yaml"
    again.write_text(text)
    assert (read_stages(again).uncertain, read_stages(again).correlated) == (chain.uncertain, chain.correlated)


def test_a_value_that_replaces_one_with_a_tolerance_leaves_the_group_of_both(plant):
    group = ["first.effects.tip_leakage.gap", "first.operation.suction.pressure", "second.operation.speed"]
    path = plant(uncertainty={"correlated": [group]})
    assert read_stages(path).correlated == (tuple(group),)
    assert read_stages(path, ["second.operation.speed=1200 rpm"]).correlated == (tuple(group[:2]),)
    assert read_stages(path, [f"{group[0]}=50 um", f"{group[2]}=1200 rpm"]).correlated == ()


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ({"uncertainty": {"correlated": [["first.operation.speed", "second.operation.speed"]]}}, "has no tolerance"),
        ({"uncertainty": {"correlated": [["second.operation.speed"]]}}, "is not a list of groups of paths"),
        ({"uncertainty": {"correlated": [["second.operation.speed", 3]]}}, "3 has no tolerance"),
        ({"uncertainty": {"correlated": [["second.operation.speed", ["a"]]]}}, "has no tolerance"),
        ({"uncertainty": {"correlated": [["second.operation.sped", "first.effects.tip_leakage.gap"]]}}, "did you mean"),
        ({"uncertainty": {"correlated": 3}}, "is not a list of groups of paths"),
        ({"uncertainty": {"model": "bitzer"}}, "lists no correlated groups"),
        ({"uncertainty": []}, "lists no correlated groups"),
        ({"intercooler": COOLED | {"pressure_drop": "10 mbar ± 20 mbar"}}, "its 95 % interval reaches"),
        ({"intercooler": COOLED | {"outlet_temperature": "288 K ± 1 %"}}, "is a share of a temperature"),
        ({"intercooler": {"kind": "none ± 3"}}, "intercooler.kind"),
    ],
)
def test_tolerances_that_make_no_sense_are_told_at_their_line(plant, content, told):
    with pytest.raises(SceneError) as error:
        read_stages(plant(**content))
    (line,) = error.value.lines
    assert told in line and "plant.stages.yaml:1:" in line


@pytest.mark.around
def test_a_measured_point_of_both_is_held_against_them_and_explained(plant, capsys):
    path = plant()
    words = ["run", str(path), "--json", "--measured"]
    assert exit_code([*words, "gas_mass_flow=0.2 kg/s ± 1 %"]) == 0
    document = json.loads(capsys.readouterr().out)
    figure = document["measured"]["figures"]["gas_mass_flow"]
    parts = [each / COVERAGE for each in figure["expanded"].values()]
    assert figure["difference"] == pytest.approx(document["performance"]["gas_mass_flow"] - 0.2, rel=1e-9)
    assert figure["sigma"] == pytest.approx(figure["difference"] / np.hypot(np.hypot(*parts[:2]), parts[2]), rel=1e-9)
    assert figure["expanded"]["inputs"] == document["uncertainty"]["figures"]["gas_mass_flow"]["expanded"]
    near = 0.98 * document["performance"]["gas_mass_flow"]
    assert exit_code([*words, f"gas_mass_flow={near} kg/s ± 0.2 %"]) == 0
    explained = json.loads(capsys.readouterr().out)["measured"]["explanations"]
    best = next(each for each in explained if each["path"] == "first.operation.speed")
    chain = read_stages(path)
    assert run_stages(chain.with_values({best["path"]: best["wanted"]})).performance.gas_mass_flow == pytest.approx(
        near, rel=2e-3
    )
    assert exit_code(["run", str(path), "--measured", "gas_mass_flow=0.2 kg/s ± 1 %"]) == 0
    assert "uncertainty: {model" not in capsys.readouterr().out
    assert exit_code(["run", str(path), "--measured", "shaft_pwer=12 kW"]) == 2


@pytest.mark.around
def test_a_residual_as_a_goal_has_no_uncertainty_by_tolerances(plant):
    """The search ended with an internal error."""
    found = screwsim.find(plant(), ["second.operation.speed=1200 rpm..1400 rpm"], ["flow_mismatch=0"], progress=False)
    assert (found.status, found.by_inputs) == ("ok", {})
    assert found.message == "no uncertainty from the inputs: flow_mismatch has no derivative"


@pytest.mark.around
def test_a_sample_of_both_stages_spreads_as_far_as_the_linear_estimate(plant, capsys):
    words = ["sensitivity", str(plant()), "--check-sobol", "16", "--jobs", "1", "--figure", "gas_mass_flow", "--json"]
    assert exit_code(words) == 0
    document = json.loads(capsys.readouterr().out)
    linear = document["figures"]["gas_mass_flow"]["standard"]
    # by the standard error of a deviation of sixteen, 1/√(2 · 15)
    assert document["sampled"]["figures"]["gas_mass_flow"]["standard"] == pytest.approx(linear, rel=0.2)
    assert document["sampled"]["figures"]["gas_mass_flow"]["wrong"] == ""


@pytest.mark.around
def test_the_command_prints_it_and_the_file_has_it_for_both_and_for_each(plant, tmp_path, capsys):
    path, out = plant(), tmp_path / "out.h5"
    assert exit_code(["run", str(path), "-o", str(out)]) == 0
    text = capsys.readouterr().out
    assert "uncertain by" in text
    assert "first.tip_leakage.gap" in text
    assert exit_code(["run", str(path), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    results = screwsim.open_results(out)
    for own, told in ((results, document), *zip(results.stages.values(), document["stages"], strict=True)):
        figures = told["uncertainty"]["figures"]
        assert {"gas_mass_flow", "shaft_power"} <= figures.keys()
        for name, spread in figures.items():
            assert float(own.uncertainty[name]) == pytest.approx(spread["standard"], rel=1e-6), name
    # a gap of the first stage changes the second stage's power, too: the pressure between both moves
    assert results.stages["second"].contributions["shaft_power", "first.effects.tip_leakage.gap"] != 0.0
    assert screwsim.compare(out, out).figures[0].inputs == pytest.approx(0.0, abs=1e-9)


def test_points_of_a_sweep_have_it_and_keep_it_over_an_interruption(plant, tmp_path):
    chain = read_stages(plant(sweep={"second.operation.speed": ["1250 rpm", "1300 rpm"]}))
    kept = KeptPoints(chain, tmp_path / "out.csv")
    points = sweep_stages(chain, kept, jobs=1)
    again = KeptPoints(chain, tmp_path / "out.csv").read()
    for number, point in enumerate(points):
        assert "gas_mass_flow" in point.result.uncertainty["figures"]
        assert again[number].result.uncertainty == point.result.uncertainty
        assert again[number].stages[1].uncertainty == point.stages[1].uncertainty
    # 1 % of the speed that varies: the tolerance grows with it, so the mean slope is that between both points. One that
    # stayed that of the scene would be 2 % off; the curvature between both is worth 0.1 %
    changes = [
        next(one["change"] for one in each.result.uncertainty["figures"]["intermediate_pressure"]["contributors"]
             if one["paths"] == ["second.operation.speed"])
        for each in points
    ]  # fmt: skip
    speeds = chain.sweep["second.operation.speed"]
    low, high = (point.result.performance.intermediate_pressure for point in points)
    slopes = [change / (0.01 * speed) for change, speed in zip(changes, speeds, strict=True)]
    assert sum(slopes) / 2.0 == pytest.approx((high - low) / (speeds[1] - speeds[0]), rel=0.005)


def test_the_table_of_a_sweep_has_half_of_the_interval_in_the_unit_of_the_figure(plant, tmp_path):
    path, out = plant(sweep={"second.operation.speed": ["1300 rpm"]}), tmp_path / "out.csv"
    assert exit_code(["sweep", str(path), "-o", str(out), "--jobs", "1"]) == 0
    with out.open(encoding="utf-8-sig", newline="") as stream:
        row = next(csv.DictReader(stream))
    chain = read_stages(path)
    base = replace(chain, sweep={})
    figures = with_uncertainty(base, run_stages(base)).uncertainty["figures"]
    assert float(row["intermediate_pressure_uncertainty [bar]"]) == pytest.approx(
        1e-5 * figures["intermediate_pressure"]["expanded"], rel=1e-3
    )
    # the unit is that of the power, not one that suits the size of its uncertainty
    assert "shaft_power [kW]" in row
    assert float(row["shaft_power_uncertainty [kW]"]) == pytest.approx(
        1e-3 * figures["shaft_power"]["expanded"], rel=1e-3
    )
    assert float(row["discharge_temperature_uncertainty [K]"]) == pytest.approx(
        figures["discharge_temperature"]["expanded"], rel=1e-3
    )


@pytest.mark.around
def test_the_data_sheet_tells_it_at_its_own_point(plant, tmp_path, capsys):
    path = plant()
    sheet = ["datasheet", str(path), "--suction", "1.4 bar..1.5 bar", "--discharge", "11 bar..12 bar", "--jobs", "1"]
    assert exit_code([*sheet, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    chain = read_stages(path)
    figures = with_uncertainty(chain, run_stages(chain)).uncertainty["figures"]
    told = document["uncertainty"]["figures"]["shaft_power"]["standard"]
    assert told == pytest.approx(figures["shaft_power"]["standard"], rel=1e-6)


def test_an_input_without_a_derivative_is_told_of(plant, monkeypatch):
    original = stages_linear.scene_sensitivities

    def without_speed(scene, paths, **more):
        found = original(scene, [path for path in paths if path != "operation.speed"], **more)
        return replace(
            found, left_out={"operation.speed": "its cycle did not close"} if "operation.speed" in paths else {}
        )

    monkeypatch.setattr(stages_linear, "scene_sensitivities", without_speed)
    chain = read_stages(plant())
    found = with_uncertainty(chain, run_stages(chain))
    what = "the tolerance of second.operation.speed is not included in the uncertainties: its cycle did not close"
    assert found.warnings == (what,)
    assert found.uncertainty["left_out"] == {"second.operation.speed": "its cycle did not close"}


def test_stages_without_a_derivative_by_their_line_have_no_uncertainty_and_say_why(plant, monkeypatch):
    original = stages_linear.scene_sensitivities
    none = {"operation.suction.temperature": "its cycle did not close"}

    def without_line(scene, paths, **more):
        return replace(original(scene, [path for path in paths if path not in none], **more), left_out=none)

    monkeypatch.setattr(stages_linear, "scene_sensitivities", without_line)
    chain = read_stages(plant())
    found = with_uncertainty(chain, run_stages(chain))
    assert not found.uncertainty
    assert "no uncertainty from the inputs: the first stage by operation.suction.temperature: its" in found.warnings[0]


def test_without_tolerances_nothing_is_added(plant):
    chain = read_stages(plant(low={}, high={}))
    found = run_stages(chain)
    assert with_uncertainty(chain, found) is found
