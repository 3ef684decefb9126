"""The data sheet of an air package: points, regulation, zero flow, what it prints and draws, what it refuses."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from folders import CONFIGS, ROOT

import screwsim
from screwsim.cli import exit_code
from screwsim.effects.parts.rating import STANDARDS, isentropic_power
from screwsim.outputs.us_units import CFM
from screwsim.report.datasheet import page, ticks
from screwsim.study.datasheet import Sheet
from screwsim.study.datasheet.air_rating import rating
from screwsim.study.datasheet.air_sheet import air_sheet
from screwsim.study.datasheet.sheet import Table
from screwsim.study.pool.progress import Progress

pytestmark = pytest.mark.around
AIR = CONFIGS / "air"
FIXED, VARIABLE = ("fixed_speed_7", "fixed_speed_10"), ("variable_speed_7", "variable_speed_10")
IDLE = 0.2, 0.45  # of the power at full flow, that unloaded packages take: 25 to 35 % typical, no source


def rated(name, *changes):
    scene = screwsim.load(AIR / f"{name}.yaml", changes)
    return scene, rating(scene)


@pytest.fixture(scope="module")
def sheets():
    found = {name: rated(name) for name in (*FIXED, *VARIABLE)}
    return {name: (of, air_sheet(scene, of)) for name, (scene, of) in found.items()}


def efficiency_of_the_public_sheet():
    """Return the package isentropic efficiency of a package of that size that is sold, at full flow and 125 psi."""
    text = (ROOT / "validation" / "cagi" / "sheet.csv").read_text(encoding="utf-8")
    row = next(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    return isentropic_power(float(row["flow_acfm"]) * CFM, 1e5, 9.62e5) / (1e3 * float(row["power_kW"]))


def public_curve():
    """Return specific power over that at full flow, by the share of full flow, of that package."""
    text = (ROOT / "validation" / "cagi" / "sheet.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    full = float(rows[0]["power_kW"]) / float(rows[0]["flow_acfm"])
    flows = [float(row["flow_acfm"]) for row in rows]
    return {flow / flows[0]: float(row["power_kW"]) / flow / full for flow, row in zip(flows, rows, strict=True)}


@pytest.mark.parametrize("name", (*FIXED, *VARIABLE))
def test_shipped_packages_lie_between_what_may_be_sold_and_a_good_one(sheets, name):
    of, sheet = sheets[name]
    assert sheet.ok
    assert of.regulation.met is True
    found = of.full.result.performance
    assert of.regulation.least < found.package_isentropic_efficiency < efficiency_of_the_public_sheet()
    assert 0.95 < found.shaft_power / 110e3 < 1.05  # the class that its title says
    assert not of.full.result.warnings


@pytest.mark.parametrize("name", VARIABLE)
def test_the_curve_of_a_variable_speed_package_is_that_of_public_ones(sheets, name):
    """Specific power over its value at full flow: within 2.5 % of the one public sheet, at its points."""
    of, _ = sheets[name]
    public = public_curve()
    assert max(public) == 1.0 and len(public) == 5
    good = sorted((point.flow / of.full.flow, point.result.performance.package_specific_power) for point in of.points)
    shares, specific = zip(*good, strict=True)
    for share, theirs in public.items():
        if share >= shares[0]:
            ours = np.interp(share, shares, specific) / specific[-1]
            assert ours == pytest.approx(theirs, rel=0.025), share


@pytest.mark.parametrize("name", FIXED)
def test_fixed_speed_is_judged_at_full_load_and_idles(sheets, name):
    of, sheet = sheets[name]
    assert len(sheet.tables[0].rows) == 1
    assert of.regulation.efficiency == of.full.result.performance.package_isentropic_efficiency
    assert of.regulation.least == STANDARDS["fixed", "air"].least(of.full.flow)
    share = of.unloaded.result.performance.package_input_power / of.full.result.performance.package_input_power
    assert IDLE[0] < share < IDLE[1]


@pytest.mark.parametrize("name", VARIABLE)
def test_variable_speed_is_judged_at_three_loads_of_its_own(sheets, name):
    of, sheet = sheets[name]
    flows = [point.flow for point in of.points]
    assert flows == sorted(flows, reverse=True)
    assert len(sheet.tables[0].rows) == len(flows) == 6
    loads = dict(of.regulation.loads)
    assert of.regulation.efficiency == pytest.approx(0.25 * loads[0.4] + 0.5 * loads[0.7] + 0.25 * loads[1.0])
    assert loads[1.0] == of.full.result.performance.package_isentropic_efficiency
    near = {load: min(of.points, key=lambda point: abs(point.flow - load * flows[0])) for load in (0.4, 0.7)}
    for load, point in near.items():  # next to the point of the sheet beside it
        assert loads[load] == pytest.approx(point.result.performance.package_isentropic_efficiency, abs=0.02)
    assert of.regulation.least == STANDARDS["variable", "air"].least(of.full.flow)


def test_figures_of_a_row_are_those_of_its_point_in_the_trades_units(sheets):
    of, sheet = sheets["variable_speed_7"]
    (table,) = sheet.tables
    found, cells = of.points[2].result.performance, dict(zip(table.heads, table.rows[2], strict=True))
    assert float(cells["m³/min"]) == pytest.approx(60.0 * found.free_air_delivered, abs=0.005)
    assert float(cells["acfm"]) == pytest.approx(found.free_air_delivered / CFM, abs=0.05)
    assert float(cells["kW"]) == pytest.approx(1e-3 * found.package_input_power, abs=0.05)
    specific = 1e-3 * found.package_input_power / (60.0 * found.free_air_delivered)
    assert float(cells["kW/ (m³/min)"]) == pytest.approx(specific, abs=0.005)
    hundred = 1e-3 * found.package_input_power / (found.free_air_delivered / CFM) * 100.0
    assert float(cells["kW/ 100 acfm"]) == pytest.approx(hundred, abs=0.05)
    assert float(cells["% of full"]) == pytest.approx(100.0 * of.points[2].flow / of.full.flow, abs=0.5)


def test_a_sheet_whose_lowest_flow_is_too_high_has_no_verdict():
    _, of = rated("variable_speed_7", "sweep.operation.speed=[2950 rpm, 2000 rpm]")
    assert of.regulation.met is None
    assert "40 %" in of.regulation.why


def test_a_package_without_a_fan_is_liquid_cooled_and_small_ones_are_not_covered():
    scene, of = rated("fixed_speed_7", "effects.air_package.fan=null")
    assert (of.coolant, of.regulation.least) == ("liquid", STANDARDS["fixed", "liquid"].least(of.full.flow))
    assert "liquid-cooled" in dict(air_sheet(scene, of).lines)["package"]
    _, of = rated("fixed_speed_7", "operation.discharge.pressure=5.5 bar")
    assert (of.regulation.covered, of.regulation.met) == (False, None)
    assert "75 to 200 psi" in of.regulation.why


def test_loads_between_coarse_speeds_are_met():
    """Two speeds alone bend the interpolation most; flow is all but proportional to speed."""
    _, of = rated("variable_speed_10", "sweep.operation.speed=[2650 rpm, 800 rpm]")
    assert of.regulation.why == ""
    assert [load for load, _ in of.regulation.loads] == [1.0, 0.7, 0.4]


def test_it_prints_a_sheet_for_a_terminal_and_a_page_without_scripts(tmp_path, capsys):
    file = tmp_path / "sheet.html"
    assert exit_code(["datasheet", str(AIR / "variable_speed_7.yaml"), "-o", str(file)]) == 0
    out = capsys.readouterr().out
    assert "10 CFR 431.345, air-cooled, variable speed: part load" in out
    assert "7.5 bar (109 psi) over the inlet" in out
    assert max(len(line) for line in out.splitlines() if str(tmp_path) not in line) <= 80
    text = file.read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")
    for foreign in ("<script", "http://", "https://", "@STYLE@"):
        assert foreign not in text
    assert text.count("<circle") == 6


def test_its_json_is_pure_and_in_si(capsys):
    assert exit_code(["datasheet", str(AIR / "fixed_speed_7.yaml"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["kind"], found["speed"], found["coolant"]) == ("air_package", "fixed", "air")
    assert found["discharge_pressure"] == pytest.approx(8.5e5)
    point = found["points"][0]
    assert point["status"] == "ok"
    assert point["package_specific_power"] == pytest.approx(point["package_input_power"] / point["free_air_delivered"])
    assert found["unloaded"]["free_air_delivered"] == 0.0
    assert found["regulation"]["met"] is True


def test_another_inlet_than_the_usual_is_noted():
    scene, of = rated("fixed_speed_7", "operation.suction.pressure=0.9 bar")
    assert any("an inlet other than" in note for note in air_sheet(scene, of).notes)
    assert not any("an inlet other than" in note for note in air_sheet(*rated("fixed_speed_7")).notes)


@pytest.mark.parametrize(
    ("inlet", "motors", "thin"),
    [
        ("operation.suction.pressure=0.9 bar", False, False),
        ("operation.suction.temperature=40 degC", False, False),
        ("operation.suction.temperature=45 degC", True, False),
        ("operation.suction.pressure=0.795 bar", True, True),
    ],
)
def test_what_thin_and_hot_air_change_beside_the_machine_is_noted(inlet, motors, thin):
    notes = air_sheet(*rated("fixed_speed_7", inlet)).notes
    assert any("IEC 60034-1" in note for note in notes) == motors
    assert any("thin air cools less" in note for note in notes) == thin


@pytest.mark.parametrize("inlet", ["operation.suction.pressure=0.795 bar", "operation.suction.temperature=45 degC"])
@pytest.mark.parametrize("name", ["fixed_speed_7", "variable_speed_7"])
def test_a_package_at_another_inlet_is_not_judged(name, inlet):
    """Thin or hot air raises the efficiency: a package is judged as data sheets are compared, or not at all."""
    scene, of = rated(name, inlet)
    assert (of.regulation.met, of.regulation.covered, of.regulation.loads) == (None, True, ())
    _, told, met = air_sheet(scene, of).verdict
    assert met is None and told.startswith("required: ") and "; no verdict: rated at an inlet other than" in told


class Counted(Progress):
    """What a progress is told: how many points were announced, and how many were finished."""

    cases = done = 0
    ended = False

    def start(self, cases, reused):
        self.cases = cases

    def more(self, cases):
        self.cases += cases

    def advance(self, cases, failed):
        self.done += cases

    def stop(self):
        self.ended = True


def test_the_points_of_a_package_are_counted_for_a_progress():
    scene = screwsim.load(AIR / "variable_speed_7.yaml", ["sweep.operation.speed=[3000 rpm, 2000 rpm, 1000 rpm]"])
    shown = Counted()
    points = len(rating(scene, shown).points)
    assert points == 3 and shown.done == shown.cases >= points + 2 and shown.ended  # and the loads of its rating


def test_points_that_fail_are_told_and_counted(capsys):
    arguments = ["datasheet", str(AIR / "fixed_speed_7.yaml"), "--set", "effects.motor.rated_power=11 kW"]
    assert exit_code(arguments) == 4
    told = " ".join(capsys.readouterr().out.split())
    assert "2950 failed" in told
    assert "no motor carries more than" in told


HOT, COLD = "mixture_discharge_temperature<95 degC", "discharge_temperature<60 degC"


def of_a_size(name, *limits, **more):
    scene = screwsim.load(AIR / f"{name}.yaml").with_({"effects.separator.cooler.conductance": "4 kW/K", **more})
    return scene, screwsim.datasheet(scene, limits=limits)


def test_in_the_hottest_room_the_limit_is_reached_and_one_that_is_broken_has_none():
    scene, sheet = of_a_size("fixed_speed_7", HOT, COLD)
    hot, cold = sheet.document["hottest_room"]
    found = screwsim.simulate(scene.with_(operation__suction__temperature=f"{hot['temperature']} K"), trace=False)
    assert found.performance.mixture_discharge_temperature == pytest.approx(95.0 + 273.15, abs=1e-3)
    assert found.performance.oil_cooler_load > 1.0
    assert (hot["limit"], hot["path"]) == (95.0 + 273.15, "operation.suction.temperature")
    assert cold["temperature"] is None
    lines = dict(sheet.lines)
    shown = f"{hot['temperature'] - 273.15:.1f} °C for mixture discharge temperature < 95 °C"
    assert lines["hottest room"].startswith(f"{shown}; none, since it is ")
    (point,) = sheet.document["points"]
    assert f"loaded to {100.0 * point['oil_cooler_load']:.0f} %" in lines["heat"]


def test_a_variable_speed_package_is_hottest_at_full_flow_and_water_has_a_warmest_temperature():
    stated = {"effects.separator.cooler.coolant_temperature": "25 degC"}
    _, sheet = of_a_size("variable_speed_7", HOT, **stated)
    (hot,) = sheet.document["hottest_room"]
    assert hot["path"] == "effects.separator.cooler.coolant_temperature"
    assert "coolant up to" in dict(sheet.lines)
    cooler = {"conductance": "4 kW/K", "coolant_temperature": f"{hot['temperature']} K"}
    stated = {f"effects.separator.cooler.{name}": value for name, value in cooler.items()}
    scene = replace(screwsim.load(AIR / "variable_speed_7.yaml").with_(stated), sweep={})
    at = (screwsim.simulate(scene.with_(operation__speed=speed), trace=False) for speed in ("2950 rpm", "950 rpm"))
    reached = [each.performance.mixture_discharge_temperature for each in at]
    assert reached[0] == pytest.approx(95.0 + 273.15, abs=1e-3)
    assert reached == sorted(reached, reverse=True)


def test_a_limit_that_nothing_reaches_holds_up_to_the_end_of_the_search():
    """The aftercooler's air is that of the inlet, 20 °C, whatever water the oil cooler has."""
    stated = {"effects.separator.cooler.coolant_temperature": "40 degC"}
    _, sheet = of_a_size("fixed_speed_7", "package_discharge_temperature<35 degC", **stated)
    (room,) = sheet.document["hottest_room"]
    assert (room["temperature"], room["message"]) == (None, "80.0 °C at least")
    assert dict(sheet.lines)["coolant up to"].startswith("80.0 °C at least for package discharge temperature < 35 °C")


@pytest.mark.parametrize(
    ("scene", "more", "code", "words"),
    [
        (
            "configs/air/fixed_speed_7.yaml",
            ["--limit", "shaft_power<1 kW"],
            2,
            "--limit shaft_power: is no upper limit of a temperature, as the hottest room",
        ),
        (
            "configs/air/fixed_speed_7.yaml",
            ["--limit", "discharge_temperature>60 degC"],
            2,
            "--limit discharge_temperature: is no upper limit",
        ),
        (
            "configs/air/fixed_speed_7.yaml",
            ["--limit", "mixture_discharge_temperature<110 degC"],
            2,
            "needs an oil cooler of a size",
        ),
        ("configs/air/fixed_speed_7.yaml", ["--evaporating", "0 degC..5 degC"], 2, "--evaporating: belongs to a"),
        (
            "configs/air/fixed_speed_7.yaml",
            ["--set", "sweep.oil_supply.orifice_diameter=[8 mm, 9 mm]"],
            2,
            "varies oil",
        ),
        (
            "configs/air/fixed_speed_7.yaml",
            ["--set", "effects.air_package.state=unloaded"],
            2,
            "delivers nothing (write loaded)",
        ),
        ("configs/air/fixed_speed_7.yaml", ["-o", "sheet.txt"], 2, "-o sheet.html, sheet.pdf or sheet.csv"),
        ("configs/air/fixed_speed_7.yaml", ["--without", "motor"], 3, "needs effects.motor"),
    ],
)
def test_what_it_cannot_rate_is_told_in_one_line(scene, more, code, words, capsys):
    assert exit_code(["datasheet", str(ROOT / scene), *more]) == code
    out, err = capsys.readouterr()
    assert out == ""
    assert words in err
    assert "Traceback" not in err


TABLE = Table("<u>", ["x<"], [["<b>"]], note="<s>")


def test_a_page_shows_any_sheet_and_escapes_what_it_says():
    sheet = Sheet("heading", "a < b & @STYLE@", [("<i>", "1 & 2")], [TABLE], ("c", "d", False), ["<note>"])
    text = page(sheet)
    for raw in ("<i>", "<b>", "<note>", "<u>", "<s>", "a < b"):
        assert raw not in text
    assert "not met" in text
    assert text.count("@STYLE@") == 2  # in the title and its heading, as it was written
    assert "<h2>c</h2>" not in page(replace(sheet, verdict=None))


@pytest.mark.parametrize(("low", "high"), [(0.0, 20.0), (7.46, 8.31), (0.0, 0.013)])
def test_ticks_are_round_and_within(low, high):
    found = ticks(low, high)
    assert 3 <= len(found) <= 7
    assert low - 1e-9 <= found[0] < found[-1] <= high + 1e-9


def test_the_how_to_shows_what_the_command_prints(sheets):
    """To one in the last digit, which another machine may round otherwise."""
    text = (ROOT / "docs" / "how-to" / "air-package.md").read_text(encoding="utf-8")
    _, sheet = sheets["variable_speed_7"]
    (table,) = sheet.tables
    shown = {line.split()[0]: line.split() for line in text.splitlines() if len(line.split()) == len(table.heads)}
    for row in table.rows:
        for cell, theirs in zip(row, shown[row[0]], strict=True):
            digit = 10.0 ** -len(cell.partition(".")[2])
            assert float(theirs) == pytest.approx(float(cell), abs=1.01 * digit)
    for name, value in sheet.lines:
        assert value.split(",")[0] in " ".join(text.split()), name
