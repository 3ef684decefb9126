"""Warnings reach people: in the first line of `run`, the last of `sweep`, in Python and in stored results."""

import json
from pathlib import Path

import pytest

import screwsim
from screwsim.cli import exit_code

PLAIN = str(Path(__file__).parents[1] / "plain" / "r134a.yaml")
PAPER = str(Path(__file__).parents[2] / "configs" / "paper" / "point.yaml")
ODD = "effects.tip_leakage.gap=1.2 mm"
TOLD = "effects.tip_leakage.gap: 1.2 mm is unusual"
SPEEDS = "sweep={effects.tip_leakage.gap: [40 um, 1.2 mm], operation.speed: [2950 rpm, 2500 rpm]}"


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    path = tmp_path_factory.mktemp("warned") / "swept.h5"
    assert exit_code(["sweep", PLAIN, "--set", SPEEDS, "-o", str(path)]) == 0
    return path


def words(text):
    return " ".join(text.split())


def test_run_says_of_a_machine_that_sucks_nothing_so_in_its_first_line(capsys):
    exit_code(["run", PLAIN, "--set", "operation.speed=60 rpm"])
    title, _, status = capsys.readouterr().out.splitlines()[:3]
    assert title.startswith("R134a") and status.startswith("status: ")
    assert "the volumetric efficiency is -" in status


def test_the_first_line_of_run_tells_a_figure_that_no_machine_has(capsys):
    exit_code(["run", PLAIN, "--set", "operation.speed=60 rpm"])
    assert capsys.readouterr().out.splitlines()[0] == (
        "R134a, 2/45 °C, plain, changed: physically impossible: volumetric efficiency -168.56 %"
    )
    exit_code(["run", PLAIN])
    assert capsys.readouterr().out.splitlines()[0] == "R134a, 2/45 °C, plain"


def test_the_first_line_of_run_tells_gas_hotter_than_a_machine_stands(capsys):
    hot = ["oil_supply.ratio=0", "operation.discharge.pressure=60 bar"]
    result = screwsim.simulate(screwsim.load(PAPER, hot))
    assert result.status == "ok" and result.impossible == ("discharge_temperature",)
    exit_code(["run", PAPER, *(part for each in hot for part in ("--set", each))])
    title, _, status = capsys.readouterr().out.splitlines()[:3]
    assert "oil from an independent pump, changed: physically impossible: discharge temperature " in title
    assert status.startswith("status: ok, with ")


def test_the_essentials_tell_a_figure_that_no_machine_has_below_any_title(capsys):
    hot = ["oil_supply.ratio=0", "operation.discharge.pressure=60 bar"]
    exit_code(["run", PAPER, "--short", *(part for each in hot for part in ("--set", each))])
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= 24 and max(map(len, lines)) <= 80
    assert "status: ok; physically impossible: discharge temperature " in words("\n".join(lines))


def test_run_and_python_tell_the_same_warning(capsys):
    assert exit_code(["run", PLAIN, "--set", ODD]) == 0
    told = words(capsys.readouterr().out)
    result = screwsim.simulate(screwsim.load(PLAIN, [ODD]))
    assert "status: ok, with 2 warnings" in told and f"warning: {TOLD}" in told
    assert len(result.warnings) == 2 and sum(each.startswith(TOLD) for each in result.warnings) == 1
    assert all(words(each) in told for each in result.warnings)


def test_a_sweep_counts_cases_with_warnings_and_says_where_each_is_first(tmp_path, capsys):
    assert exit_code(["sweep", PLAIN, "--set", SPEEDS, "-o", str(tmp_path / "again.h5")]) == 0
    out = capsys.readouterr().out
    told = words(out)
    assert out.splitlines()[-1].startswith("4 cases: 4 ok (2 of them with warnings), ")
    assert "4 cases: 4 ok (2 of them with warnings)" in told
    assert f"warning in 2 cases, first at effects.tip_leakage.gap = 1.2 mm, operation.speed = 2950 rpm: {TOLD}" in told


def test_results_read_again_have_the_warnings_of_each_case(stored):
    warned = screwsim.open_results(stored).warnings
    assert warned.shape == (2, 2)
    assert list(warned[0]) == ["", ""] and all(each.startswith(TOLD) for each in warned[1])


# ---- studies: what their answer warns of ----

NO_WAY = ["--without", "discharge_port", "--set", "numerics.accuracy=1e-3", "--set", "numerics.error=none"]
NO_WAY_TOLD = "no port or valve leads to the discharge line out of the chambers"
STUDIES = {
    "optimum": [  # that does not ask for more and more
        *("--path", "oil_supply.ratio", "--from", "1", "--to", "3", "--jobs", "1", "--set", "numerics.rtol=1e-3"),
    ],
    "sensitivity": ["--path", "oil_supply.ratio=1..3", "--samples", "2", "--jobs", "1"],
    "sensitivity --local": ["oil_supply.ratio"],
    "find": ["--vary", "oil_supply.ratio=1..3", "--for", "shaft_power=150 kW", "--jobs", "1"],
    "optimize": [
        "--vary",
        "oil_supply.ratio=1..3",
        "--maximize",
        "gas_mass_flow",
        "--evaluations",
        "14",
        "--jobs",
        "1",
    ],
    "optimize, two aims": [
        *("--vary", "oil_supply.ratio=1..3", "--maximize", "gas_mass_flow", "--minimize", "shaft_power"),
        *("--evaluations", "8", "--jobs", "1"),
    ],
}


def _texts(found):
    """Return all texts of a JSON document."""
    if isinstance(found, dict | list):
        return [text for each in (found.values() if isinstance(found, dict) else found) for text in _texts(each)]
    return [found] if isinstance(found, str) else []


@pytest.mark.parametrize("study", STUDIES)
def test_a_study_tells_what_its_answer_warns_of(study, capsys):
    command = [*study.partition(",")[0].split(), PAPER, *STUDIES[study], *NO_WAY]
    assert exit_code(command) == 0
    assert f"{NO_WAY_TOLD}" in words(capsys.readouterr().out)
    assert exit_code([*command, "--json"]) == 0
    assert any(text.startswith(NO_WAY_TOLD) for text in _texts(json.loads(capsys.readouterr().out)))


def test_a_fit_tells_what_its_points_warn_of(tmp_path, capsys):
    no_way = {"base": PAPER, "effects": {"discharge_port": False}, "numerics": {"accuracy": 1e-3, "error": "none"}}
    (tmp_path / "no_way.yaml").write_text(json.dumps(no_way))
    (tmp_path / "points.csv").write_text(
        "name,use,operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]\n"
        "a,fit,1000,130,1\nb,fit,1200,160,1\nc,check,1100,140,1\n"
    )
    fit = {"scene": "no_way.yaml", "data": "points.csv", "starts": 1}
    fit |= {"parameters": {"effects.mechanical.fraction": {"from": 0, "to": 0.12}}}
    (tmp_path / "x.fit.yaml").write_text(json.dumps(fit))
    command = ["calibrate", str(tmp_path / "x.fit.yaml"), "--jobs", "1"]
    exit_code(command)
    assert f"warning at a and 2 other points: {NO_WAY_TOLD}" in words(capsys.readouterr().out)
    exit_code([*command, "--json"])
    assert {"a", "b", "c"} == json.loads(capsys.readouterr().out)["warnings"].keys()


def test_a_map_tells_what_the_points_of_its_sweep_warn_of(tmp_path, capsys):
    axes = "sweep={operation.evaporating_temperature: {from: -10 degC, to: 10 degC, count: 4}, "
    axes += "operation.condensing_temperature: {from: 35 degC, to: 50 degC, count: 4}}"
    rough = ["--set", "numerics.accuracy=1e-2", "--set", "numerics.error=none"]
    assert exit_code(["sweep", PLAIN, "--set", axes, "--set", ODD, *rough, "-o", str(tmp_path / "map.h5")]) == 0
    capsys.readouterr()
    exit_code(["map", str(tmp_path / "map.h5")])
    assert f"warning in 16 points of the sweep: {TOLD}" in words(capsys.readouterr().out)


def test_new_warns_of_a_pressure_ratio_that_no_machine_has_when_it_writes_the_scene(tmp_path, capsys):
    told = "warning: operation.condensing_temperature: the pressure ratio of a single machine is 57.11"
    asked = ["new", "refrigeration", "--condition", "-50/60 degC"]
    assert exit_code([*asked, "-o", str(tmp_path / "x.yaml")]) == 0
    assert told in words(capsys.readouterr().out)
    assert exit_code(asked) == 0
    shown = capsys.readouterr()
    assert told in words(shown.err) and told not in words(shown.out)
    assert exit_code(["new", "refrigeration", "-o", str(tmp_path / "usual.yaml")]) == 0
    assert "warning" not in capsys.readouterr().out
