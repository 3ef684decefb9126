"""`screwsim startup`: what it prints and writes, and its exit codes."""

import csv
import json

import numpy as np
import pytest
from folders import CONFIGS

import screwsim
from screwsim import cli
from screwsim.inputs.faults import Interrupted
from screwsim.machine.drive import run_up
from screwsim.outputs import Figures
from screwsim.solve import start_up

FIGURES = {
    "time": 1.5,
    "end_speed": 100.0 * np.pi,
    "coupling_torque_peak": 300.0,
    "coupling_torque_peak_time": 0.5,
    "peak_over_steady": 2.5,
    "residue": None,
}
TIME = np.linspace(0.0, 1.5, 40)
TRACES = {"time": TIME} | {
    name: 100.0 + TIME * i
    for i, name in enumerate(
        ("angle", "speed", "motor_speed", "twist", "coupling_torque", "motor_torque", "gas_torque", "loss_torque")
    )
}


@pytest.fixture
def started(monkeypatch):
    """Let a start give stated figures; return what it was asked."""
    asked = {}

    def fake(scene, creep, longest, told):
        told(0.5)
        asked.update(scene=scene, creep=creep, longest=longest)
        if "so far" in asked:
            raise Interrupted(asked["so far"])
        return asked.get("outcome") or start_up.StartUp("ok", "", ("it hammers",), Figures(FIGURES), dict(TRACES))

    monkeypatch.setattr(start_up, "start_up", fake)
    return asked


def test_an_interrupted_start_keeps_what_there_is(started, capsys, tmp_path):
    told = "0.5 s after the start, at 2000 rpm of the steady 3000 rpm"
    started["so far"] = start_up.StartUp("interrupted", told, (), Figures(FIGURES), dict(TRACES))
    assert cli.exit_code(["startup", str(CONFIGS / "drive/point.yaml"), "-o", str(tmp_path / "st")]) == 130
    out, err = capsys.readouterr()
    assert f"status: interrupted, {told}" in out and err.strip().endswith("interrupted")
    assert (tmp_path / "st" / "startup.csv").stat().st_size > 100


def test_ctrl_c_in_a_start_is_raised_as_elsewhere_and_has_the_pitches_so_far():
    def pressed(share):
        if share > 0.05:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as raised:
        start_up.start_up(screwsim.load(CONFIGS / "drive/point.yaml"), told=pressed)
    found = raised.value.found
    assert found.status == "interrupted" and "of the steady 3000 rpm" in found.message
    assert 0.0 < found.figures["end_speed"] < found.figures["steady_speed"] and len(found.traces["time"]) > 100


def test_ctrl_c_before_the_first_pitch_is_raised_as_it_came(monkeypatch):
    monkeypatch.setattr(start_up.StartUpRun, "advance", lambda self: (_ for _ in ()).throw(KeyboardInterrupt("now")))
    with pytest.raises(KeyboardInterrupt, match="now") as raised:
        start_up.start_up(screwsim.load(CONFIGS / "drive/point.yaml"))
    assert type(raised.value) is KeyboardInterrupt


def test_a_folder_that_another_command_removes_meanwhile_is_made_again(started, monkeypatch, tmp_path):
    place = tmp_path / "st"

    def slow(*arguments):
        place.rmdir()
        return start_up.StartUp("ok", "", (), Figures(FIGURES), dict(TRACES))

    monkeypatch.setattr(start_up, "start_up", slow)
    assert cli.exit_code(["startup", str(CONFIGS / "drive/point.yaml"), "-o", str(place)]) == 0
    assert (place / "startup.csv").exists()


def test_it_prints_figures_in_customary_units_and_warnings(started, capsys):
    assert cli.exit_code(["startup", str(CONFIGS / "drive/point.yaml"), "--creep", "60", "--longest", "3"]) == 0
    out = capsys.readouterr().out
    assert "status: ok" in out
    assert "3000  rpm" in out
    assert 0 < out.index("warning: it hammers") < out.index("3000  rpm")
    assert "residue" not in out
    assert started["creep"] == pytest.approx(2.0 * np.pi)
    assert started["longest"] == 3.0


@pytest.mark.parametrize(
    ("text", "rpm"), [("45", 45.0), ("45 rpm", 45.0), ("4.5 rad/s", 4.5 * 30.0 / np.pi), (None, 30.0)]
)
def test_the_creeping_speed_may_have_a_unit(started, text, rpm):
    creep = [] if text is None else ["--creep", text]
    assert cli.exit_code(["startup", str(CONFIGS / "drive/point.yaml"), *creep]) == 0
    assert started["creep"] == pytest.approx(rpm * np.pi / 30.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [("30 m/s", "'30 m/s' is not a"), ("fast", "'fast' is not a"), ("0", "--creep 0: is below 0.1 rpm (write e.g.")],
)
def test_a_creeping_speed_that_is_none_is_one_line(started, text, words, capsys):
    assert cli.exit_code(["startup", str(CONFIGS / "drive/point.yaml"), "--creep", text]) == 2
    told = capsys.readouterr().err
    assert words in told and told.count("\n") == 1
    assert not started


def test_what_the_command_line_changes_stands_below_the_title(started, capsys):
    assert cli.exit_code(["startup", str(CONFIGS / "drive/point.yaml"), "--set", "operation.speed=2900 rpm"]) == 0
    assert "with operation.speed=2900 rpm" in capsys.readouterr().out.splitlines()[:3]


def test_json_is_one_document_and_a_failed_start_has_exit_code_4(started, capsys):
    started["outcome"] = start_up.StartUp("failed", "the motor cannot start the machine")
    assert cli.exit_code(["startup", str(CONFIGS / "drive/point.yaml"), "--json"]) == 4
    assert json.loads(capsys.readouterr().out) == {
        "status": "failed",
        "message": "the motor cannot start the machine",
        "warnings": [],
        "figures": {},
    }


def test_traces_and_figure_are_written(started, tmp_path):
    assert cli.exit_code(["startup", str(CONFIGS / "drive/point.yaml"), "-o", str(tmp_path)]) == 0
    rows = list(csv.DictReader((tmp_path / "startup.csv").read_text(encoding="utf-8").splitlines()))
    assert len(rows) == 40
    assert {head.partition(" [")[0] for head in rows[0]} == set(TRACES)
    assert {"time [s]", "angle [rad]", "motor_speed [rad/s]", "twist [rad]", "gas_torque [N m]"} < set(rows[0])
    assert (tmp_path / "startup.png").stat().st_size > 10_000
    assert (tmp_path / "startup.pdf").exists()


def test_a_scene_without_a_drive_cannot_be_started(capsys):
    assert cli.exit_code(["startup", str(CONFIGS / "paper/point.yaml")]) == 2
    assert "the scene has no drive to start (name drive under effects; docs" in capsys.readouterr().err


@pytest.mark.parametrize("inertia", ["motor_inertia", "rotor_inertia"])
def test_a_drive_that_cannot_be_followed_ends_with_the_remedy(inertia, capsys, monkeypatch):
    """An inertia of 1e-9 kg m² on 6 N m s/rad moves within nanoseconds: a pitch would take hours."""
    monkeypatch.setattr(run_up, "MOST_RATES", run_up.MOST_RATES // 20)  # its own number takes 5 s to reach
    scene = str(CONFIGS / "drive/point.yaml")
    asked = ["startup", scene, "--set", f"effects.drive.{inertia}=1e-9 kg m^2", "--set", "numerics.error=none"]
    assert cli.exit_code(asked) == 4
    printed = " ".join(capsys.readouterr().out.split())
    assert "status: failed, the drive moves too fast for its coupling to be followed over a pitch" in printed
    assert "(choose a larger motor_inertia or rotor_inertia, or a softer, less damped coupling)" in printed
