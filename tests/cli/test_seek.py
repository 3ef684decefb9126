"""The commands that seek: pure JSON, what a person reads, exit codes, files."""

import json
import math
import sys
from dataclasses import replace

import pytest

from screwsim import load, open_results
from screwsim.figures.engineering import error_text
from screwsim.outputs import Figures, Result
from screwsim.simulate import warm_up

RPM = math.pi / 30.0


def fake(scene):
    """Return a flow of 1 kg/s at 3000 rpm, even with the speed, and an efficiency best at d = 2; fail above d = 5."""
    n, d = scene.operation.speed / RPM, scene.oil_supply.ratio
    if d > 5.0:
        return Result("failed", message="pressure left the range (choose a smaller gap)")
    efficiency = 0.8 - 0.05 * math.log(d / 2.0) ** 2 - 0.1 * (n / 3000.0 - 1.0) ** 2
    figures = Figures(gas_mass_flow=n / 3000.0, isothermal_efficiency=efficiency, shaft_power=1e4 * n / 3000.0)
    return Result("ok", performance=figures, error=Figures(dict.fromkeys(figures, 1e-6)))


@pytest.fixture
def sought(folder, monkeypatch):
    """Have a simulator that takes no time."""
    module = sys.modules[warm_up.__module__]
    monkeypatch.setattr(module, "simulate_many", lambda scenes, trace=True: map(fake, scenes))
    monkeypatch.setattr(module, "warm_up", lambda scene: None)
    return folder


SPEED = ("--vary", "operation.speed=1000 rpm..5000 rpm")
RATIO = ("--vary", "oil_supply.ratio=0.5..10")


def test_find_says_the_value_its_error_and_writes_the_scene(sought, command):
    found = command("find", "oiled.yaml", *SPEED, "--for", "gas_mass_flow=1.2 kg/s", "-o", "found.yaml")
    assert found.code == 0
    assert "operation.speed = 3600 rpm ± 0.004 rpm" in found.out
    assert "isothermal efficiency" not in found.out  # neither sought, nor one of those shown beside
    assert (found.out.splitlines()[-1], found.err) == ("found.yaml", "")
    assert load("found.yaml").operation.speed == pytest.approx(3600.0 * RPM)


@pytest.mark.parametrize(
    "words",
    [
        ("find", *SPEED, "--for", "gas_mass_flow=1.2 kg/s"),
        ("optimize", *RATIO, "--maximize", "isothermal_efficiency"),
        ("optimum", "--path", "oil_supply.ratio=0.5..4"),
    ],
)
def test_a_search_tells_under_the_title_what_the_command_line_changes(sought, command, words):
    """A title may name another gas than the one that is set."""
    name, *others = words
    told = command(name, "oiled.yaml", *others, "--set", "gas.fluid=R1234yf", "--without", "tip_leakage", "--jobs", "1")
    assert "with gas.fluid=R1234yf, without tip_leakage" in told.out.splitlines()[:2]


def test_find_shows_the_cop_of_heating_on_the_electrical_power(sought, monkeypatch, command):
    """That on the shaft power has the heat of a motor in the suction gas for nothing."""
    cops = Figures(cop=3.7, heating_cop=4.8, electrical_cop=3.4, electrical_heating_cop=4.4)

    def with_cops(scenes, trace=True):
        return (replace(found, performance=Figures(found.performance | cops)) for found in map(fake, scenes))

    monkeypatch.setattr(sys.modules[warm_up.__module__], "simulate_many", with_cops)
    told = command("find", "oiled.yaml", *SPEED, "--for", "gas_mass_flow=1.2 kg/s").out
    assert "\n  electrical heating COP  4.4\n" in told and "\n  heating COP" not in told


def test_find_says_how_far_tolerances_move_the_value(folder, command):
    tolerant = ("--set", "effects.tip_leakage.gap=27 um ± 5 um", "--set", "operation.speed=1000 rpm ± 1 %")
    words = ("find", "oiled.yaml", *tolerant, *SPEED, "--for", "gas_mass_flow=0.3 kg/s")
    found = command(*words)
    assert found.code == 0
    assert "(95 %): tip_leakage.gap 100%" in " ".join(found.out.split())
    row = json.loads(command(*words, "--json").out)["rows"][0]
    due = row["uncertainties_by_inputs"]["operation.speed"]["expanded"]
    assert due > 100.0 * row["uncertainties"]["operation.speed"]
    swept = ("--set", "sweep.operation.discharge.pressure=[7 bar, 8 bar]", "-o", "rows.csv")
    assert "± by" in command(*words, *swept).out
    head, *rows = (folder / "rows.csv").read_text(encoding="utf-8").splitlines()
    place = head.split(",").index("operation.speed_by_inputs [rad/s]")
    assert [float(row.split(",")[place]) for row in rows] == pytest.approx([due, due], rel=0.5)


def test_find_tells_a_value_and_its_width_in_one_unit(folder, monkeypatch, command):
    def sized(scene):
        figures = Figures(gas_mass_flow=1e3 * scene.machine.volume.max)
        return Result("ok", performance=figures, error=Figures(dict.fromkeys(figures, 1e-6)))

    module = sys.modules[warm_up.__module__]
    monkeypatch.setattr(module, "simulate_many", lambda scenes, trace=True: map(sized, scenes))
    monkeypatch.setattr(module, "warm_up", lambda scene: None)
    size = "machine.volume.max=400 cm^3..700 cm^3"
    found = command("find", "oiled.yaml", "--vary", size, "--for", "gas_mass_flow=0.5 kg/s")
    assert "machine.volume.max = 500 cm³ ± 0.0005 cm³" in found.out


@pytest.mark.parametrize(
    ("goal", "told"),
    [
        ("gas_mass_flow=0.3 kg/s", "= 1500 rpm (lower border: every size gives more than the goal)"),
        ("discharge_temperature=90 degC", "= 1500 rpm (lower border: every size gives less than the goal)"),
    ],
)
def test_find_says_on_which_side_of_a_goal_every_size_of_a_catalogue_is(folder, monkeypatch, command, goal, told):
    """The flow rises with the speed, 0.5 kg/s at 1500 rpm; the temperature falls with it, 85 °C there."""

    def sized(scene):
        n = scene.operation.speed / RPM
        figures = Figures(gas_mass_flow=n / 3000.0, discharge_temperature=373.15 - n / 100.0)
        return Result("ok", performance=figures, error=Figures(dict.fromkeys(figures, 1e-6)))

    module = sys.modules[warm_up.__module__]
    monkeypatch.setattr(module, "simulate_many", lambda scenes, trace=True: map(sized, scenes))
    monkeypatch.setattr(module, "warm_up", lambda scene: None)
    words = ("--vary", "operation.speed", "--catalogue", "1500, 3000 rpm", "--for", goal)
    found = command("find", "oiled.yaml", *words)
    assert found.code == 0 and told in found.out


def test_find_that_finds_nothing_ends_with_4_and_says_how_far_it_came(sought, command):
    found = command("find", "oiled.yaml", *SPEED, "--for", "gas_mass_flow=2 kg/s", "-o", "found.yaml")
    told = " ".join(found.out.split())
    assert found.code == 4 and not (sought / "found.yaml").exists()
    assert "the nearest is 1.6667 kg/s, at operation.speed 5000 rpm, its upper border (widen the range)" in told


def test_find_prints_one_document(sought, command):
    found = command("find", "oiled.yaml", *SPEED, "--for", "gas_mass_flow=1.2 kg/s", "--json")
    document = json.loads(found.out)
    (row,) = document["rows"]
    assert row["values"]["operation.speed"] == pytest.approx(3600.0 * RPM)
    assert (row["status"], document["failed_solutions"]) == ("ok", 0)


def test_an_error_beyond_its_figure_is_told_in_its_unit():
    assert error_text("isothermal_efficiency", 0.5, 1e-5) == "2e-05"
    assert error_text("isothermal_efficiency", 1e-10, 3e-5) == "0.003 %"  # 3e+05 of it says nothing
    assert error_text("condensate_flow", 0.0, 2.0 / 3600.0) == "2 kg/h"


def test_find_gives_a_sweep_a_row_a_point(sought, command):
    sweep = "sweep.oil_supply.ratio=[1, 2, 6]"
    arguments = ("find", "oiled.yaml", "--set", sweep, *SPEED, "--for", "gas_mass_flow=1.2 kg/s")
    found = command(*arguments, "-o", "rows.csv", "--jobs", "1")
    assert found.code == 4 and "3600 rpm" in found.out and "failed" in found.out
    assert "6: 8 of 8 solutions: failed: pressure left the range" in " ".join(found.out.split())
    assert len((sought / "rows.csv").read_text().splitlines()) == 4
    refused = command(*arguments, "-o", "found.yaml")
    assert refused.code == 2 and "the sweep gives one answer per row" in refused.err


def test_find_tells_an_axis_and_what_is_sought_apart(sought, command):
    low = "operation.suction.pressure=1 bar..2 bar"
    sweep = "sweep.operation.discharge.pressure=[10 bar, 12 bar]"
    found = command("find", "oiled.yaml", "--set", sweep, "--vary", low, "--for", "gas_mass_flow=1 kg/s", "--jobs", "1")
    lines = [line.split() for line in found.out.splitlines()]
    top = next(number for number, words in enumerate(lines) if words[:2] == ["discharge", "suction"])
    assert lines[top + 1][:2] == ["pressure", "pressure"]


def test_find_does_not_replace_a_scene_of_ones_own(sought, command):
    found = command("find", "oiled.yaml", *SPEED, "--for", "gas_mass_flow=1 kg/s", "-o", "oiled.yaml")
    assert found.code == 2 and "already exists, and is not a file of this kind" in found.err


def test_a_scene_found_may_replace_the_one_it_was_found_from(sought, command):
    """It stood there with itself as its base, and no command could read it."""
    goal = ("--for", "gas_mass_flow=1.2 kg/s", "-o", "found.yaml")
    assert command("find", "oiled.yaml", *RATIO, "--for", "isothermal_efficiency=0.78", "-o", "found.yaml").code == 0
    before = load("found.yaml")
    assert command("find", "found.yaml", *SPEED, *goal).code == 0
    again = load("found.yaml")
    assert again.operation.speed == pytest.approx(3600.0 * RPM)
    assert again.oil_supply.ratio == before.oil_supply.ratio
    assert command("optimize", "found.yaml", *RATIO, "--best", "found.yaml", "--jobs", "1").code == 0
    assert load("found.yaml").operation.speed == pytest.approx(3600.0 * RPM)


def test_a_base_of_the_scene_is_not_replaced(sought, command):
    goal = ("--for", "gas_mass_flow=1.2 kg/s", "-o")
    for of, file in (("oiled.yaml", "found.yaml"), ("found.yaml", "last.yaml")):
        assert command("find", of, *SPEED, *goal, file).code == 0
    found = command("find", "last.yaml", *SPEED, *goal, "found.yaml")
    assert (found.code, found.err) == (2, "-o found.yaml: last.yaml is based on this file (choose another name)\n")


def test_optimize_says_the_best_and_writes_it(sought, command):
    arguments = ("optimize", "oiled.yaml", *SPEED, *RATIO, "--maximize", "eta_iso", "--jobs", "1")
    found = command(*arguments, "--best", "best.yaml", "-o", "out.h5")
    assert found.code == 0
    assert "highest isothermal efficiency, varying operation.speed 1000 rpm … 5000 rpm" in found.out
    assert "isothermal efficiency 80 %, error" in found.out or "isothermal efficiency 79.99" in found.out
    assert "failed: pressure left the range (choose a smaller gap)" in found.out
    assert load("best.yaml").oil_supply.ratio == pytest.approx(2.0, rel=0.05)
    assert open_results("out.h5").optimum["front"].sum() == 1


def test_optimize_prints_a_front_and_one_document(sought, command):
    arguments = ("optimize", "oiled.yaml", *SPEED, *RATIO, "--maximize", "eta_iso", "--maximize", "gas_mass_flow")
    found = command(*arguments, "--evaluations", "120", "--jobs", "1")
    assert found.code == 0 and "evaluations that no other beats in all aims" in found.out
    document = json.loads(command(*arguments, "--evaluations", "120", "--jobs", "1", "--json").out)
    first = document["front"][0]["aims"]
    assert f"{100.0 * first['isothermal_efficiency']:.5g} %" in found.out
    assert document["evaluations"] == 120


def test_optimize_without_a_result_within_the_bounds_ends_with_4(sought, command):
    found = command("optimize", "oiled.yaml", *SPEED, "--subject-to", "shaft_power<1 kW", "--jobs", "1")
    assert found.code == 4
    told = " ".join(found.out.split())
    assert "no evaluation is within the bounds: shaft_power<1 kW was required, and the nearest is 3.3333 kW" in told


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--over", "SEPR"), "--over SEPR: needs operation.evaporating_temperature and operation.condensing_temp"),
        (("--print-points",), "--print-points: needs --over NAME, e.g. --over SEPR"),
        (
            ("--maximize", "eta_iso", "--maximize", "gas_mass_flow", "--best", "b.yaml"),
            "--best b.yaml: several aims",
        ),
        (("--best", "b.h5"), "--best b.h5: a scene file must end in .yaml (write --best b.yaml)"),
        (("-o", "out.csv"), "-o out.csv: results are HDF5"),
    ],
)
def test_optimize_refuses_what_makes_no_sense(sought, command, arguments, message):
    found = command("optimize", "oiled.yaml", *SPEED, *arguments)
    assert found.code == 2 and found.err.startswith(message) and not found.out
