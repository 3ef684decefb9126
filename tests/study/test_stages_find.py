"""Goal seek of two stages: values of both that meet goals of the whole, and the files of what was found."""

import json
import math

import pytest
from scenes import scene_dict

import screwsim
from screwsim.cli import exit_code
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.study.asked.goals import read_goals
from screwsim.study.asked.spans import read_spans
from screwsim.study.seek import find_each, question
from screwsim.study.stages import StageChain, read_stages
from screwsim.study.stages.result import figures_of_both
from screwsim.study.uncertainty.measured import read_measured

RPM = math.pi / 30.0
FIRST, SECOND = "first.operation.speed", "second.operation.speed"
RANGES = [f"{FIRST}=1000 rpm..5000 rpm", f"{SECOND}=500 rpm..3000 rpm"]


def matching(chain):
    """Return a flow in proportion to the first speed, and a pressure between both in proportion to that of speeds."""
    first, second = chain.first.operation.speed / RPM, chain.second.operation.speed / RPM
    values = {"gas_mass_flow": first / 3000.0, "intermediate_pressure": 2e5 * first / second, "shaft_power": 1e4}
    error = Figures(dict.fromkeys(values, 1e-6))
    return Result("ok", performance=figures_of_both(values), error=error)


def test_speeds_of_both_stages_meet_a_flow_and_the_pressure_between(plant):
    goals = ["gas_mass_flow=0.8 kg/s", "intermediate_pressure=4 bar"]
    found = screwsim.find(plant(), RANGES, goals, simulate=matching)
    assert (found.status, found.failed) == ("ok", 0)
    # 0.8 · 3000 rpm, and half of it for 4 bar
    assert found.values == pytest.approx({FIRST: 2400.0 * RPM, SECOND: 1200.0 * RPM}, rel=2e-6)
    assert isinstance(found.scene, StageChain)
    assert found.scene.second.operation.speed == pytest.approx(found.values[SECOND], rel=1e-12)


def test_a_gauge_pressure_of_both_is_read_over_the_ambient_one_that_they_share(plant):
    shared = [f"{stage}.operation.ambient_pressure=0.9 bar" for stage in ("first", "second")]
    (goal,) = read_goals(read_stages(plant(), shared), ["intermediate_pressure=3 barg"])
    assert goal.value == pytest.approx(3.9e5, rel=1e-12)
    for read in (read_goals, read_measured):
        with pytest.raises(UsageError, match=r"'barg' is a gauge pressure \(write the absolute pressure"):
            read(read_stages(plant(), shared[:1]), ["intermediate_pressure=3 barg"])


def test_a_range_in_gauge_pressures_is_read_over_the_shared_ambient_pressure_alone(plant):
    """As their sweep reads it: options took each stage's own."""
    path, apart = "second.operation.discharge.pressure", ["first.operation.ambient_pressure=0.9 bar"]
    (span,) = read_spans(read_stages(plant()), [f"{path}=7 barg..9 barg"], ranged=True)
    assert (span.low, span.high) == pytest.approx((8.01325e5, 10.01325e5), rel=1e-12)
    with pytest.raises(UsageError, match=f"{path}: '7 barg' is a gauge pressure .write the absolute pressure"):
        read_spans(read_stages(plant(), apart), [f"{path}=7 barg..9 barg"], ranged=True)


def test_each_row_of_the_sweep_has_its_answer(plant):
    chain = read_stages(plant(sweep={FIRST: ["2000 rpm", "4000 rpm"]}))
    asked = question(chain, RANGES[1:], ["intermediate_pressure=4 bar"])
    rows = find_each(chain, asked, jobs=1, simulate=matching)
    assert [row.at[FIRST] / RPM for row in rows] == pytest.approx([2000.0, 4000.0])
    assert [row.values[SECOND] / RPM for row in rows] == pytest.approx([1000.0, 2000.0], rel=2e-6)


def test_a_size_of_a_stage_is_the_next_of_the_catalogue(plant, tmp_path, capsys):
    """The larger first stage delivers more; the title of its scene tells the size."""
    out = tmp_path / "found.stages.yaml"
    flow = read_stages(plant()).with_values({"first.machine.volume.max": 500e-6}).solved().performance.gas_mass_flow
    words = ["find", str(plant()), "--vary", "first.machine.volume.max", "--for", f"gas_mass_flow={flow} kg/s"]
    words += ["--catalogue", "400, 800 cm^3", "--jobs", "1", "-o", str(out), "--json"]
    assert exit_code(words) == 0
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    assert row["values"]["first.machine.volume.max"] == pytest.approx(500e-6, rel=1e-3)
    assert row["size"]["value"] == pytest.approx(800e-6) and row["size"]["figure"] > 1.2 * flow
    again = read_stages(out)
    assert again.first.machine.volume.max == pytest.approx(800e-6) and "resized" in again.first.title
    assert not again.second.title


@pytest.mark.around
def test_what_is_found_is_a_run_of_the_files_written(plant, tmp_path, capsys):
    path, out = plant(intercooler={"kind": "cooler", "outlet_temperature": "310 K"}), tmp_path / "found.stages.yaml"
    vary = f"{SECOND}=900 rpm..1800 rpm"
    words = ["find", str(path), "--vary", vary, "--for", "intermediate_pressure=4.2 bar", "--jobs", "1", "-o", str(out)]
    assert exit_code([*words, "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    again = read_stages(out)
    assert again.intercooler.outlet_temperature == 310.0
    result = again.solved()
    # each within the estimated error of the pressure
    assert result.performance.intermediate_pressure == pytest.approx(4.2e5, abs=row["errors"]["intermediate_pressure"])
    assert sorted(each.name for each in tmp_path.glob("found*")) == [
        "found.stages.yaml",
        "found_first.yaml",
        "found_second.yaml",
    ]
    assert exit_code(words) == 0  # what a search has written it may replace
    (tmp_path / "found_first.yaml").write_text("title: mine\n")
    assert exit_code(words) == 2
    assert "found_first.yaml" in capsys.readouterr().err


def test_scenes_that_another_two_stage_file_names_are_not_replaced(plant, tmp_path, monkeypatch, capsys):
    """plant.yaml and plant.stages.yaml would both name their scenes plant_first.yaml and plant_second.yaml."""
    monkeypatch.setattr(StageChain, "solved", matching)
    words = ["find", str(plant()), "--vary", RANGES[1], "--for", "intermediate_pressure=3 bar", "--jobs", "1", "-o"]
    assert exit_code([*words, str(tmp_path / "found.yaml")]) == 0
    before = (tmp_path / "found_second.yaml").read_text()
    capsys.readouterr()
    assert exit_code([*words, str(tmp_path / "found.stages.yaml")]) == 2
    error = capsys.readouterr().err
    assert f"would replace {tmp_path / 'found_first.yaml'}, which {tmp_path / 'found.yaml'} names" in error
    assert (tmp_path / "found_second.yaml").read_text() == before and not (tmp_path / "found.stages.yaml").exists()
    assert exit_code([*words, str(tmp_path / "found.yaml")]) == 0
    assert exit_code([*words, str(tmp_path / ".stages.yaml")]) == 0
    assert (tmp_path / ".stages_first.yaml").exists() and read_stages(tmp_path / ".stages.yaml")


def test_the_best_stages_are_written_as_those_found(plant, tmp_path, monkeypatch):
    monkeypatch.setattr(StageChain, "solved", matching)
    out = tmp_path / "best.stages.yaml"
    words = ["optimize", str(plant()), "--vary", RANGES[1], "--minimize", "intermediate_pressure", "--jobs", "1"]
    assert exit_code([*words, "--evaluations", "30", "--best", str(out)]) == 0
    assert read_stages(out).second.operation.speed == pytest.approx(3000.0 * RPM, rel=1e-3)


def test_a_goal_beyond_the_ranges_says_how_near_the_search_came(plant):
    found = screwsim.find(plant(), RANGES[1:], ["intermediate_pressure=1 bar"], simulate=matching)
    assert (found.status, found.borders) == ("none", {SECOND: "upper border"})
    assert (
        "the nearest is 2 bar, at second.operation.speed 3000 rpm, its upper border (widen the range)" in found.message
    )


@pytest.mark.parametrize(
    ("vary", "goal", "told"),
    [
        (FIRST, "gas_mass_flow=1 kg/s", f"--vary {FIRST}: has no range (write {FIRST}=LOW..HIGH"),
        ("operation.speed=1 rpm..2 rpm", "gas_mass_flow=1 kg/s", "starts with none of first., second., intercooler."),
        (
            "intermediate_pressure=1 bar..2 bar",
            "gas_mass_flow=1 kg/s",
            "is a figure, which follows from the inputs (vary",
        ),
        (
            "low.speed=1 rpm..2 rpm",
            "gas_mass_flow=1 kg/s",
            "(write e.g. first.operation.speed or second.operation.speed)",
        ),
        (
            RANGES[0],
            "volumetric_efficiency=0.9",
            "is a figure of one stage, not of these two together (use one of inter",
        ),
        (
            RANGES[0],
            "first.peak_pressure=9 bar",
            "is a figure of one stage, not of these two together (use one of inter",
        ),
        (
            RANGES[0],
            "second.shaft_power=9 kW",
            "--for second.shaft_power: is not known; did you mean 'second_shaft_power'?",
        ),
    ],
)
def test_a_question_that_makes_no_sense_is_one_line(plant, vary, goal, told):
    with pytest.raises(UsageError) as refused:
        question(read_stages(plant()), [vary], [goal])
    assert told in str(refused.value) and "\n" not in str(refused.value)


MOTOR = {"effects": {"motor": {"rated_power": "30 kW", "efficiency": 0.9}}}


@pytest.mark.parametrize(
    ("low", "figure", "needs"),
    [
        (MOTOR, "electrical_power", "a motor in the second scene (use one of intermediate_pressure"),
        ({}, "electrical_power", "a motor in both scenes (use"),
        ({}, "cooling_capacity", "operation.condensing_temperature or gas_cooler in the second scene (use"),
    ],
)
def test_a_figure_that_both_scenes_do_not_give_says_what_it_needs(plant, tmp_path, low, figure, needs):
    path = plant()
    (tmp_path / "low.yaml").write_text(json.dumps(scene_dict(low)))
    with pytest.raises(UsageError) as refused:
        question(read_stages(path), [RANGES[0]], [f"{figure}=10 kW"])
    assert f"--for {figure}: is not a figure of these two stages: it needs {needs}" in str(refused.value)


@pytest.mark.parametrize("form", [dict, str])
def test_two_stages_in_a_program_are_given_by_their_file(form):
    content = {"title": "plant", "stages": ["low.yaml", "high.yaml"]}
    given = content if form is dict else "title: plant\nstages: [low.yaml, high.yaml]\n"
    for ask in (lambda: screwsim.find(given, RANGES[0], "gas_mass_flow=1 kg/s"), lambda: screwsim.tabulate(given)):
        with pytest.raises(UsageError, match="two stages are given by the path of their file"):
            ask()
