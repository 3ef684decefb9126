"""The command `screwsim tolerance`: tables for a terminal, pure JSON, its figure, exit codes."""

import importlib
import json

import pytest

from screwsim.outputs import Figures, Result

SCENE = """\
title: a cylinder
machine: {kind: slider_crank, bore: 50 mm, crank_radius: 20 mm, rod_length: 90 mm, clearance: 3 cm^3}
gas: {fluid: Air, isentropic_exponent: 1.4}
operation: {speed: 1500 rpm, suction: {pressure: 1 bar, temperature: 300 K}, discharge: {pressure: 4 bar}}
"""


def fake(scene, trace=True):
    """Return figures that follow from the lengths."""
    machine = scene.machine
    figures = Figures(gas_mass_flow=machine.swept_volume, shaft_power=1e4 * machine.rod_length)
    return Result("ok", performance=figures)


@pytest.fixture
def scene_file(tmp_path, monkeypatch):
    monkeypatch.setattr(importlib.import_module("screwsim.simulate"), "simulate", fake)
    path = tmp_path / "cylinder.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def command(*arguments) -> int:
    from screwsim import cli

    return cli.exit_code([str(each) for each in ("tolerance", *arguments)])


def test_an_interruption_says_how_many_machines_were_done(scene_file, monkeypatch, capsys):
    study = importlib.import_module("screwsim.study.tolerance")
    one = study._figures_of_machine

    def third(*arguments):
        if arguments[-1] == 2:
            raise KeyboardInterrupt
        return one(*arguments)

    monkeypatch.setattr(study, "_figures_of_machine", third)
    assert command(scene_file, "--count", "5", "--jobs", "1") == 130
    lines = capsys.readouterr().err.splitlines()
    kept = "none is kept, and the same command begins anew"
    assert lines == [f"interrupted; tolerance: 2 of 5 machines were done; {kept}"]


@pytest.mark.around
def test_it_prints_tables_that_fit_a_terminal_and_draws(scene_file, tmp_path, capsys):
    assert command(scene_file, "--count", 8, "--jobs", 1, "--bore-grade", 7, "-o", tmp_path / "out") == 0
    out = capsys.readouterr().out
    assert "IT10" in out
    assert "seed 1" in out
    assert max(len(line) for line in out.splitlines() if not line.startswith("/")) <= 92
    assert (tmp_path / "out" / "tolerance.png").stat().st_size > 10_000


def test_its_json_is_pure(scene_file, capsys):
    assert command(scene_file, "--count", 8, "--jobs", 1, "--seed", 3, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["seed"] == 3
    assert found["count"] == 8
    assert set(found["figures"]) == {"gas_mass_flow", "shaft_power"}
    assert len(found["law_of_motion"]) == 14
    assert found["grades"] == {"crank_radius": 10, "rod_length": 10, "offset": 10}


@pytest.mark.parametrize(
    ("arguments", "code"), [(("--grade", 3), 2), (("--count", 1), 2), (("--set", "machine.bore=-1 mm"), 3)]
)
def test_bad_input_has_its_exit_code(scene_file, capsys, arguments, code):
    assert command(scene_file, "--jobs", 1, *arguments) == code
    assert "Traceback" not in capsys.readouterr().err
