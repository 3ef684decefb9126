"""The commands of studies: pure JSON, tables that fit a terminal, exit codes, files."""

import csv
import json
import math
import shutil
import sys
from pathlib import Path

import h5py
import pytest

from screwsim.outputs import Figures, Result
from screwsim.scene import load
from screwsim.study.sweep import run_sweep

MAP = """\
base: oiled.yaml
gas: {model: real, isentropic_exponent: null}
operation:
  suction: null
  discharge: null
  evaporating_temperature: 0 degC
  condensing_temperature: 40 degC
  superheat: 10 K
sweep:
  operation.evaporating_temperature: [-15 degC, -5 degC, 0 degC, 10 degC]
  operation.condensing_temperature: [30 degC, 38 degC, 45 degC, 50 degC]
"""
RANGES = ("--path", "oil_supply.ratio=1..3", "--path", "effects.tip_leakage.gap=40 um..60 um")


def fake(scene, trace=True):
    """Return a parabola in ln d about 1, powers that follow pressures; fail above d = 9."""
    ratio = scene.oil_supply.ratio if scene.oil_supply else 1.0
    if ratio > 9.0:
        return Result("failed", message="pressure left the range")
    power = 1e4 + 10.0 * (scene.operation.condensing_temperature or 300.0) + scene.operation.speed
    efficiency = 0.7 - 0.02 * math.log(ratio) ** 2
    figures = Figures(isothermal_efficiency=efficiency, shaft_power=power, gas_mass_flow=0.3, cooling_capacity=2e4)
    return Result("ok", performance=figures, error=Figures(dict.fromkeys(figures, 1e-7)))


@pytest.fixture(scope="module")
def swept(tmp_path_factory, furnished):
    """Return a folder with results of a simulator that takes no time: a map, and two sweeps."""
    place = furnished(tmp_path_factory.mktemp("swept"))
    (place / "map.yaml").write_text(MAP)
    (place / "both.yaml").write_text(
        "base: oiled.yaml\nsweep:\n  operation.speed: [2000 rpm, 3000 rpm]\n  oil_supply.ratio: [0.5, 2]\n"
    )
    for name in ("map", "both"):
        run_sweep(load(place / f"{name}.yaml"), place / f"{name}.h5", jobs=1, simulate=fake)
    other = load(place / "both.yaml", ["operation.discharge.pressure=13 bar"])
    run_sweep(other, place / "other.h5", jobs=1, simulate=fake)
    return place


@pytest.fixture
def studied(folder, swept, monkeypatch):
    """Have that simulator, and a copy of its results to work in."""
    from screwsim.simulate import warm_up

    module = sys.modules[warm_up.__module__]
    monkeypatch.setattr(module, "simulate", fake)
    monkeypatch.setattr(module, "warm_up", lambda scene: None)
    shutil.copytree(swept, folder, dirs_exist_ok=True)
    return folder


COMMANDS = {
    "optimum": ("optimum", "both.yaml", "--jobs", "1"),
    "map": ("map", "map.h5"),
    "sensitivity": ("sensitivity", "oiled.yaml", "--jobs", "1", "--samples", "16", *RANGES),
    "compare": ("compare", "both.h5", "other.h5"),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_the_table_fits_the_terminal(name, studied, command):
    answer = command(*COMMANDS[name])
    assert (answer.code, answer.err) == (0, "")
    assert len(answer.out.splitlines()) > 5
    assert max(map(len, answer.out.splitlines())) <= 80


@pytest.mark.parametrize("name", COMMANDS)
def test_json_is_one_document(name, studied, command):
    answer = command(*COMMANDS[name], "--json")
    assert (answer.code, answer.err) == (0, "")
    assert json.loads(answer.out)


@pytest.mark.parametrize("as_json", [False, True])
@pytest.mark.parametrize(("name", "file"), [("optimum", "new.csv"), ("map", "new.json"), ("sensitivity", "new.h5")])
def test_the_file_that_was_written_is_named_last_and_on_stderr_beside_json(name, file, as_json, studied, command):
    answer = command(*COMMANDS[name], "-o", file, *(["--json"] if as_json else []))
    assert answer.code == 0 and (studied / file).is_file()
    assert (answer.err if as_json else answer.out).splitlines()[-1] == file
    assert (answer.err == "") != as_json


def test_the_optimum_is_told_and_written(studied, command):
    answer = command(*COMMANDS["optimum"], "--from", "0.2", "--to", "5", "-o", "out.h5", "--json")
    found = json.loads(answer.out)
    assert [row["value"] for row in found["rows"]] == pytest.approx([1.0, 1.0], rel=1e-3)
    with h5py.File("out.h5") as file:
        assert list(file["oil_supply_ratio"]) == [row["value"] for row in found["rows"]]
        assert list(file["operation_speed"]) == pytest.approx([2000 * math.pi / 30, 100 * math.pi])
    assert command(*COMMANDS["optimum"], "-o", "out.csv").code == 0
    with open("out.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["place"] for row in rows] == ["inside", "inside"]
    assert "operation.speed [rad/s]" in rows[0]


@pytest.mark.parametrize(("name", "rest"), [("optimum", ("--jobs", "1")), ("sensitivity", COMMANDS["sensitivity"][2:])])
def test_the_efficiency_of_a_real_gas_is_the_isentropic_one_and_stderr_says_so(name, rest, studied, command):
    real = command(name, "oiled.yaml", *rest, "--set", "gas={model: real, isentropic_exponent: null}")
    assert real.err.startswith(f"{name}: isentropic_efficiency is used, because a real gas may have no isothermal one")
    assert len(real.err.splitlines()) == 1
    assert command(name, "oiled.yaml", *rest).err == ""
    asked = ("--set", "gas={model: real, isentropic_exponent: null}", "--figure", "shaft_power")
    assert command(name, "oiled.yaml", *rest, *asked).err == ""


@pytest.mark.around
def test_a_comparison_writes_all_points_and_a_figure_and_tells_places_as_people_do(studied, command):
    shutil.copy("other.h5", "faster.h5")
    with h5py.File("faster.h5", "r+") as file:
        file["performance/shaft_power"][1, 0] *= 1.5
    answer = command("compare", "both.h5", "faster.h5", "-o", "both")
    assert (answer.code, answer.err) == (0, "")
    assert "largest change at operation.speed = 3000 rpm, oil_supply.ratio = 0.5 kg/kg: shaft power" in " ".join(
        answer.out.split()
    )
    assert {path.name for path in Path("both").iterdir()} == {"comparison.csv", "comparison.png", "comparison.pdf"}
    with open("both/comparison.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    ratios = [float(row["shaft_power_b [W]"]) / float(row["shaft_power_a [W]"]) for row in rows]
    assert ratios == pytest.approx([1.0, 1.0, 1.5, 1.0])
    Path("both/comparison.csv").write_text("mine\n1\n")
    assert command("compare", "both.h5", "faster.h5", "-o", "both").code == 2
    assert Path("both/comparison.csv").read_text() == "mine\n1\n"


def test_a_trial_that_fails_is_told_and_an_answer_that_is_missing_ends_with_its_code(studied, command):
    answer = command(*COMMANDS["optimum"], "--to", "12", "--json")
    found = json.loads(answer.out)
    assert (answer.code, found["rows"][0]["status"]) == (0, "ok")
    assert found["failed_solutions"] > 0
    answer = command(*COMMANDS["optimum"], "--from", "9", "--to", "12", "--json")
    assert (answer.code, json.loads(answer.out)["rows"][0]["status"]) == (4, "failed")
    answer = command("sensitivity", "oiled.yaml", "--jobs", "1", "--samples", "16", "--path", "oil_supply.ratio=1..12")
    assert answer.code == 4 and "narrow the ranges" in answer.out


@pytest.mark.parametrize(
    ("name", "rest"),
    [
        ("optimum", ("--from", "3 bar")),
        ("sensitivity", ("--path", "oil_supply.ratio=1")),
        ("sensitivity", ("--path", "oil_supply.ratio=1..2", "--samples", "3")),
    ],
)
def test_a_refusal_is_one_line_also_where_a_real_gas_would_be_told_its_efficiency(name, rest, studied, command):
    real = ("--set", "gas={model: real, isentropic_exponent: null}")
    answer = command(name, "oiled.yaml", *real, *rest)
    assert (answer.code, answer.out, len(answer.err.splitlines())) == (2, "", 1), answer.err


def test_a_range_may_follow_the_path_and_the_search_go_down(studied, command):
    followed = command(*COMMANDS["optimum"], "--path", "oil_supply.ratio=0.5..4", "--minimize", "--json")
    apart = command(*COMMANDS["optimum"], "--from", "0.5", "--to", "4", "--minimum", "--json")
    assert followed.code == 0
    assert followed.out == apart.out
    assert command(*COMMANDS["optimum"], "--from", "0.5", "--to", "4", "--json").out != apart.out


def test_a_border_is_said_with_its_remedy(studied, command):
    answer = command(*COMMANDS["optimum"], "--from", "2", "--to", "5")
    assert answer.code == 0
    told = "2000 rpm: at the lower border of the range; a better value may lie beyond, so widen it (--from)"
    least = "down to the oil that the maker requires: lubrication is not modelled"
    assert f"{told}, {least}" in " ".join(answer.out.split())
    along = command(*COMMANDS["optimum"], "--path", "oil_supply.ratio=2..5")
    assert "so widen it (LOW of --path)" in " ".join(along.out.split()) and "--from" not in along.out


def test_maps_are_written_as_csv_and_json(studied, command):
    printed = json.loads(command("map", "map.h5", "-o", "map.json", "--json").out)
    assert json.loads((studied / "map.json").read_text()) == printed
    assert command("map", "map.h5", "-o", "map.csv", "--figure", "shaft_power").code == 0
    with open("map.csv", encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    fitted = printed["maps"][0]["fits"]["shaft_power"]["coefficients"]
    assert [float(row[f"C{i}"]) for i in range(1, 11)] == fitted
    # 1e4 + 10 (273.15 + D) + the speed
    assert fitted[2] == pytest.approx(10.0, rel=1e-6)


def test_indices_are_written(studied, command):
    assert command(*COMMANDS["sensitivity"], "-o", "indices.csv").code == 0
    with open("indices.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["path"] for row in rows] == ["oil_supply.ratio", "effects.tip_leakage.gap"]
    assert float(rows[1]["total"]) == 0.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("optimum", "small.yaml"),
            "oil_supply.ratio: the scene has no oil supply (vary another path, e.g. --path 'operation.speed=1000 rpm.."
            "3000 rpm')",
        ),
        (
            ("optimum", "oiled.yaml", "--path", "oil_supply.ratio=1..2", "--to", "3"),
            "oil_supply.ratio=1..2: states its range (remove --from and --to)",
        ),
        (
            ("optimum", "oiled.yaml", "--path", "oil_supply.ratio=2"),
            "oil_supply.ratio=2: is not PATH=LOW..HIGH (write e.g. 'oil_supply.ratio=0.5..4')",
        ),
        (("optimum", "oiled.yaml", "-o", "out.txt"), "-o out.txt: needs an ending that states its format"),
        (("map", "both.h5"), "both.h5: has no axis operation.evaporating_temperature and operation.condensing"),
        (("map", "nowhere.h5"), "nowhere.h5: there is no such file"),
        (("sensitivity", "oiled.yaml"), "nothing varies (write one or more --path PATH=LOW..HIGH)"),
        (("compare", "both.h5", "map.h5"), "both.h5: has no operation.evaporating_temperature, over which"),
    ],
)
def test_wrong_input_is_one_line(arguments, message, studied, command):
    answer = command(*arguments)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith(message) and answer.err.count("\n") == 1


def test_a_missing_extra_is_named(studied, command, monkeypatch):
    monkeypatch.setitem(sys.modules, "SALib.sample", None)
    answer = command(*COMMANDS["sensitivity"])
    assert answer.code == 2
    assert answer.err == "SALib is not installed (install it with: pip install 'screwsim[sensitivity]')\n"
