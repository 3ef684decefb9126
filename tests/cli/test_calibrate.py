"""`screwsim calibrate`: table, JSON, files and exit codes, with a simulator that takes no time."""

import importlib
import json
import math
import re
import sys

import pytest

from screwsim.outputs import Figures, Result
from screwsim.scene import load

FIT = """\
title: one clearance
scene: small.yaml
data: points.csv
parameters:
  effects.tip_leakage.gap: {from: 20 um, to: 90 um, spacing: log}
  machine.discharge_port.area: {from: 5 cm^2, to: 20 cm^2}
starts: 2
"""
POINTS = """\
name,use,operation.speed [rpm],gas_mass_flow [kg/h],gas_mass_flow_uncertainty [kg/h],discharge_temperature [degC],\
discharge_temperature_uncertainty [K]
first,fit,1000,140,1,40,1
second,fit,2000,280,2,50,1
third,check,3000,430,2,63,1
"""


def fake(scene):
    """Return a flow that falls with the gap, and a temperature that falls with the port's area; fail above 5000 rpm."""
    gap, area = scene.effects["tip_leakage"].parameters.gap, scene.machine.discharge_port.area
    rpm = scene.operation.speed * 30.0 / math.pi
    if rpm > 5000.0:
        return Result("failed", message="pressure left the range")
    return Result(
        "ok",
        performance=Figures(
            gas_mass_flow=(rpm / 1000.0) * (0.04 - 20.0 * gap), discharge_temperature=313.0 + rpm / 100.0 - 1e4 * area
        ),
    )


@pytest.fixture
def fitted(folder, monkeypatch):
    """Work in a folder with a fit, and a simulator that takes no time."""
    module = importlib.import_module("screwsim.simulate")
    monkeypatch.setattr(module, "simulate_many", lambda scenes, trace=True: map(fake, scenes))
    monkeypatch.setattr(module, "warm_up", lambda scene: None)
    (folder / "small.fit.yaml").write_text(FIT, encoding="utf-8")
    (folder / "points.csv").write_text(POINTS, encoding="utf-8")
    return folder


def test_the_table_fits_the_terminal(fitted, command):
    answer = command("calibrate", "small.fit.yaml", "--jobs", "1")
    assert (answer.code, answer.err) == (0, "")
    assert max(map(len, answer.out.splitlines())) <= 80
    assert "third *" in answer.out
    assert "chi squared" in answer.out


def test_json_is_one_document(fitted, command):
    answer = command("calibrate", "small.fit.yaml", "--jobs", "1", "--json", "-o", "out")
    found = json.loads(answer.out)
    assert (answer.code, found["status"]) == (0, "ok")
    assert set(found["parameters"]) == {"effects.tip_leakage.gap", "machine.discharge_port.area"}
    assert len(found["starts"]) == 2
    assert [point["fitted"] for point in found["points"]] == [True, True, True, True, False, False]
    assert found["correlation"][0][0] == pytest.approx(1.0)
    assert "residuals.png" in answer.err


def test_a_terminal_is_told_beforehand_how_many_solutions_it_takes(fitted, command, monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    answer = command("calibrate", "small.fit.yaml", "--jobs", "1", "--json")
    least, most = map(int, re.findall(r"some (\d+) to (\d+) solutions", " ".join(answer.err.split()))[0])
    assert least <= json.loads(answer.out)["solutions"] <= most


def test_files_are_a_scene_a_document_and_a_figure(fitted, command):
    assert command("calibrate", "small.fit.yaml", "--jobs", "1", "-o", "out").code == 0
    assert {path.name for path in (fitted / "out").iterdir()} == {
        "scene.yaml",
        "fit.json",
        "residuals.png",
        "residuals.pdf",
    }
    document = json.loads((fitted / "out" / "fit.json").read_text(encoding="utf-8"))
    gap = load("out/scene.yaml").effects["tip_leakage"].parameters.gap
    assert gap == pytest.approx(document["parameters"]["effects.tip_leakage.gap"]["value"], rel=1e-6)


def test_a_point_without_a_solution_ends_with_4(fitted, command):
    (fitted / "points.csv").write_text(POINTS.replace("third,check,3000", "third,fit,6000"), encoding="utf-8")
    answer = command("calibrate", "small.fit.yaml", "--jobs", "1")
    assert answer.code == 4
    assert "third has no solution: failed: pressure left the range" in answer.out


def test_a_bad_fit_is_one_line_and_3(fitted, command):
    (fitted / "small.fit.yaml").write_text(FIT.replace("90 um", "90 xx"), encoding="utf-8")
    answer = command("calibrate", "small.fit.yaml")
    assert (answer.code, answer.out) == (3, "")
    assert answer.err.startswith("small.fit.yaml:5:")
    assert answer.err.count("\n") == 1


def test_an_interruption_shows_the_best_so_far_and_ends_with_130(fitted, command, monkeypatch):
    count = 0

    def stopping(scenes, trace=True):
        nonlocal count
        for scene in scenes:
            count += 1
            if count == 30:
                raise KeyboardInterrupt
            yield fake(scene)

    monkeypatch.setattr(sys.modules["screwsim.simulate"], "simulate_many", stopping)
    answer = command("calibrate", "small.fit.yaml", "--jobs", "1")
    assert answer.code == 130
    (line,) = answer.err.splitlines()
    assert line.startswith("interrupted; calibrate: the best so far of")
    assert "the best so far" in answer.out
    assert "gap" in answer.out


def test_a_scene_that_no_calibration_wrote_is_kept(fitted, command):
    (fitted / "scene.yaml").write_text("base: small.yaml\n")
    answer = command("calibrate", "small.fit.yaml", "-o", ".", "--jobs", "1")
    assert answer.code == 2
    assert "scene.yaml: already exists, and is not a file of this kind" in answer.err
    assert (fitted / "scene.yaml").read_text() == "base: small.yaml\n"
    assert command("calibrate", "small.fit.yaml", "-o", "out", "--jobs", "1").code == 0
    assert command("calibrate", "small.fit.yaml", "-o", "out", "--jobs", "1").code == 0  # over its own


def test_the_scene_of_the_fit_is_not_replaced_by_the_fitted_one(fitted, command):
    assert command("calibrate", "small.fit.yaml", "-o", "out", "--jobs", "1").code == 0
    (fitted / "again.fit.yaml").write_text(FIT.replace("small.yaml", "out/scene.yaml"), encoding="utf-8")
    answer = command("calibrate", "again.fit.yaml", "-o", "out", "--jobs", "1")
    assert answer.code == 2
    assert answer.err == "-o out: out/scene.yaml is the scene of the fit itself (name another folder)\n"
    (fitted / "later.yaml").write_text("base: out/scene.yaml\n", encoding="utf-8")
    (fitted / "again.fit.yaml").write_text(FIT.replace("small.yaml", "later.yaml"), encoding="utf-8")
    assert "later.yaml is based on this file" in command("calibrate", "again.fit.yaml", "-o", "out", "--jobs", "1").err
