"""The data sheets of two stages: each cell is a run's, the figures of a package are those of ISO 1217."""

import csv
import json
import re
from dataclasses import replace
from math import exp, log
from pathlib import Path

import pytest
from CoolProp.CoolProp import PropsSI
from scenes import DROP, scene_dict

import screwsim
from screwsim.cli import exit_code
from screwsim.effects.parts.rating import isentropic_power
from screwsim.fluid import constants
from screwsim.outputs import Figures, Result
from screwsim.outputs.customary import RPM
from screwsim.scene import with_values
from screwsim.study.datasheet import SheetOptions, sheet_of, stages_air
from screwsim.study.datasheet.air_sheet import FAN_CONTROL
from screwsim.study.datasheet.stages_sheet import best_intermediate
from screwsim.study.datasheet.units import METRIC
from screwsim.study.stages import ChainResult, read_stages, run_stages

PACKAGE = Path(__file__).parents[2] / "configs" / "two_stage" / "air.stages.yaml"

pytestmark = pytest.mark.around
LOW = {
    "operation": {"speed": "3000 rpm", "evaporating_temperature": "-20 degC", "superheat": "5 K",
                  "condensing_temperature": "10 degC"},
    "effects.motor": {"rated_power": "40 kW", "efficiency": 0.9},
}  # fmt: skip
HIGH = {
    "operation": {"speed": "1500 rpm", "evaporating_temperature": "0 degC", "superheat": "5 K",
                  "condensing_temperature": "40 degC"},
    "effects.motor": {"rated_power": "24 kW", "efficiency": 0.9},
}  # fmt: skip
AIR = {"gas": {"fluid": "Air", "model": "ideal"}}
AIR_LOW = {
    **AIR,
    "operation": {"speed": "3000 rpm", "suction": {"pressure": "1 bar", "temperature": "20 degC"},
                  "discharge": {"pressure": "3 bar"}},
    "effects.motor": {"rated_power": "55 kW", "efficiency": 0.9},
    "effects.air_package": {"rated_flow": "20 m^3/min", "fan": {"power": "1 kW", "control": "flow"}},
}  # fmt: skip
AIR_HIGH = {
    **AIR,
    "operation": {"speed": "1200 rpm", "suction": {"pressure": "3 bar", "temperature": "20 degC"},
                  "discharge": {"pressure": "8 bar"}},
    "effects.motor": {"rated_power": "45 kW", "efficiency": 0.9},
}  # fmt: skip
TEMPERATURES = {
    "first.operation.evaporating_temperature": ["-25 degC", "-20 degC"],
    "second.operation.condensing_temperature": ["35 degC", "40 degC"],
}


def operated(changes):
    """Return a scene whose operation is replaced as a whole."""
    scene = scene_dict({name: value for name, value in changes.items() if name != "operation"})
    return scene | {"operation": changes["operation"]}


def written(folder, low, high, **more):
    for name, changes in (("low", low), ("high", high)):
        (folder / f"{name}.yaml").write_text(json.dumps(operated(changes)), encoding="utf-8")
    path = folder / "plant.stages.yaml"
    path.write_text(json.dumps({"title": "a plant", "stages": ["low.yaml", "high.yaml"], **more}), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    return written(tmp_path_factory.mktemp("plant"), LOW, HIGH, intercooler={"kind": "economizer"}, sweep=TEMPERATURES)


@pytest.fixture(scope="module")
def rated(plant):
    return sheet_of(read_stages(plant), SheetOptions(limits=["discharge_temperature<20 degC"], jobs=1))


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    speeds = {"first.operation.speed": ["1500 rpm", "3000 rpm"], "second.operation.speed": ["600 rpm", "1200 rpm"]}
    return written(tmp_path_factory.mktemp("package"), AIR_LOW, AIR_HIGH, sweep={"zip": [speeds]})


@pytest.fixture(scope="module")
def aired(package, tmp_path_factory):
    loads = tmp_path_factory.mktemp("loads") / "loads.csv"
    loads.write_text("flow [m^3/min], hours\n10, 1000\n", encoding="utf-8")
    return sheet_of(read_stages(package), SheetOptions(profile=str(loads), jobs=1))


def table(sheet, title):
    return next(each for each in sheet.tables if each.title.startswith(title))


def number(cell):
    return float(cell.strip("*†‡\u00a0 %"))


def test_a_cell_is_that_of_a_run_with_these_temperatures(plant, rated):
    at = ["first.operation.evaporating_temperature=-25 degC", "second.operation.condensing_temperature=35 degC"]
    found = run_stages(read_stages(plant, at)).performance
    cells = {
        "Cooling capacity": 1e-3 * found.cooling_capacity,
        "Electrical power": 1e-3 * found.electrical_power,
        "COP of the electrical power": found.electrical_cop,
        "Intermediate pressure [bar]": 1e-5 * found.intermediate_pressure,
        "Shaft power of the second stage": 1e-3 * found.second_shaft_power,
        "Discharge temperature of the first": found.first_discharge_temperature - 273.15,
    }
    for title, value in cells.items():
        # the digits printed, a hundredth at the coarsest figure of this machine, COP 2
        assert number(table(rated, title).rows[0][1]) == pytest.approx(value, rel=5e-3), title
    point = next(each for each in rated.document["points"] if each["evaporating_temperature"] < 250.0)
    assert point["cooling_capacity"] == pytest.approx(found.cooling_capacity, rel=1e-12)


def test_each_stage_stands_beside_the_other_as_a_run_gives_it(plant, rated):
    stages = [each.performance for each in run_stages(read_stages(plant)).stages]
    rows = {row[0]: row[1:] for row in table(rated, "Each stage").rows}
    for title, figure, factor in (
        ("shaft power [kW]", "shaft_power", 1e-3),
        ("pressure ratio", "pressure_ratio", 1.0),
        ("volumetric efficiency [%]", "volumetric_efficiency", 100.0),
    ):
        assert [float(cell) for cell in rows[title]] == pytest.approx([factor * p[figure] for p in stages], abs=0.051)
    load = 100.0 * stages[1].shaft_power / 24e3
    assert rows["load of its motor [%]"][1] == f"{load:.0f}"
    assert [each["shaft_power"] for each in rated.document["stages"]] == [each.shaft_power for each in stages]


def test_figures_of_the_own_point_and_of_each_stage_have_their_errors(rated):
    for document in (rated.document["own_point"], *rated.document["stages"]):
        assert 0.0 < document["error"]["shaft_power"] < 1e-3


def test_both_motors_and_a_stated_limit_bound_the_table(rated):
    limits = {each["figure"]: each for each in rated.document["limits"]}
    assert {"discharge_temperature", "first_shaft_power", "second_shaft_power"} == set(limits)
    assert limits["second_shaft_power"]["from"] == "second.effects.motor.rated_power"
    assert all("discharge_temperature" in point["beyond"] for point in rated.document["points"])
    assert all("*" in cell for row in table(rated, "Cooling capacity").rows for cell in row[1:])


def test_part_load_slows_both_stages_in_proportion(plant, rated):
    (control,) = rated.document["part_load"]
    half = next(each for each in control["loads"] if each["load"] < 0.6)
    speeds = [
        f"{name}.operation.speed={half['setting'] * rpm} rpm" for name, rpm in (("first", 3000), ("second", 1500))
    ]
    found = run_stages(read_stages(plant, speeds)).performance
    assert found.cooling_capacity == pytest.approx(half["cooling_capacity"], rel=1e-4)
    full = rated.document["own_point"]["cooling_capacity"]
    assert half["cooling_capacity"] / full == pytest.approx(0.5, abs=2e-3)  # `part_load.NEAR`


def test_a_faster_second_stage_lowers_the_intermediate_pressure(rated):
    pressures = [each["intermediate_pressure"] for each in rated.document["by_speed_of_second_stage"]]
    assert pressures == sorted(pressures, reverse=True)
    assert "between the stages" in table(rated, "Intermediate pressure by the speed").note


def tried(*points):
    return [(1.0, Result("ok", performance=Figures(intermediate_pressure=p, cop=cop))) for p, cop in points]


def test_the_best_intermediate_pressure_is_the_top_of_a_parabola_in_its_logarithm():
    def cop(p):
        return 3.0 - (log(p) - log(3.3e5)) ** 2

    p, value, inside = best_intermediate(tried(*((p, cop(p)) for p in (2e5, 3e5, 4e5, 6e5))), "cop")
    assert (p, value, inside) == (pytest.approx(3.3e5, rel=1e-9), pytest.approx(3.0, rel=1e-12), True)
    p, _, inside = best_intermediate(tried((2e5, 3.0), (3e5, 2.0), (4e5, 1.0)), "cop")
    assert (p, inside) == (pytest.approx(exp(log(2e5))), False)
    assert best_intermediate(tried((2e5, 3.0), (3e5, 2.0)), "cop") is None


def test_a_point_without_a_pressure_keeps_its_reason(tmp_path):
    low = {**LOW, "operation": {**LOW["operation"], "speed": "100 rpm"}}  # hardly delivers
    ranges = {"--evaporating": "-30 degC..-20 degC", "--condensing": "35 degC..40 degC"}
    sheet = sheet_of(read_stages(written(tmp_path, low, HIGH)), SheetOptions(ranges, jobs=1))
    failed = [each for each in sheet.document["points"] if each["status"] != "ok"]
    assert failed and not sheet.ok
    assert any("failed" in note or "not closed" in note for note in sheet.notes)
    assert all(each["message"] for each in failed)


def test_gas_is_rated_by_pressures(tmp_path):
    low = {name: value for name, value in AIR_LOW.items() if not name.startswith("effects")}
    high = {name: value for name, value in AIR_HIGH.items() if not name.startswith("effects")}
    sweep = {"first.operation.suction.pressure": ["1 bar", "1.2 bar"], "second.operation.discharge.pressure": ["8 bar"]}
    path = written(tmp_path, low, high, sweep=sweep)
    sheet = sheet_of(read_stages(path), SheetOptions(jobs=1))
    found = run_stages(read_stages(path, ["first.operation.suction.pressure=1.2 bar"])).performance
    assert number(table(sheet, "Mass flow").rows[0][2]) == pytest.approx(3600.0 * found.gas_mass_flow, rel=5e-3)
    assert sheet.document["kind"] == "two_stage_gas"


def test_a_packages_figures_are_those_of_iso_1217(package):
    found = run_stages(read_stages(package))
    p, stages = found.performance, [each.performance for each in found.stages]
    volume = p.gas_mass_flow * constants.gas_constant("Air") * 293.15 / 1e5
    assert p.free_air_delivered == pytest.approx(volume, rel=1e-9)
    fan = 1e3 * volume / (20.0 / 60.0)  # in proportion to the flow
    assert p.package_input_power == pytest.approx(sum(each.electrical_power for each in stages) + fan, rel=1e-9)
    assert p.package_specific_power * p.free_air_delivered == pytest.approx(p.package_input_power, rel=1e-12)
    ideal = isentropic_power(p.free_air_delivered, 1e5, 8e5)
    assert p.package_isentropic_efficiency * p.package_input_power == pytest.approx(ideal, rel=1e-12)
    assert 0.0 < found.error.package_specific_power < 3e-4


def test_a_package_is_rated_at_other_outlet_pressures_at_the_speeds_of_its_sheet(package):
    sheet = sheet_of(read_stages(package), SheetOptions(ranges={"--discharge": "8, 9.5 bar"}, jobs=1))
    own, higher = sheet.document["pressures"]
    assert (own["outlet_pressure"], higher["outlet_pressure"]) == (8e5, 9.5e5)
    for kind, place in (("full_flow", 0), ("lowest_flow", -1)):
        point = sheet.document["points"][place]
        for name in ("first_speed", "second_speed", "free_air_delivered", "package_input_power"):
            assert own[kind][name] == pytest.approx(point[name], rel=1e-9)
    assert higher["full_flow"]["package_input_power"] > own["full_flow"]["package_input_power"]
    cells = dict(zip(table(sheet, "Full flow over").heads, table(sheet, "Full flow over").rows[1], strict=True))
    assert number(cells["bar over inlet"]) == 8.5
    found = higher["full_flow"]
    loads = [100.0 * found["first_shaft_power"] / 55e3, 100.0 * found["second_shaft_power"] / 45e3]
    assert [float(each) for each in cells["motors %"].split("/")] == pytest.approx(loads, abs=0.51)
    assert not higher["bounded_by_motor"] and "rpm" in table(sheet, "Full flow over").heads


def test_full_flow_of_two_stages_is_at_the_highest_speeds_that_both_motors_carry():
    """The second stage's motor of configs/two_stage, 55 kW, is loaded to 94 % at 8.5 bar, and beyond at 10.5 bar."""
    at = "second.operation.discharge.pressure=10.5 bar"
    chain = read_stages(PACKAGE, [at])
    document = sheet_of(chain, SheetOptions(jobs=1)).document
    full, *slower = document["points"]
    assert document["bounded_by_motor"] and full["first_speed"] == full["second_speed"] < 2950.0 * RPM
    assert full["second_shaft_power"] == pytest.approx(55e3, rel=2e-3) and full["second_shaft_power"] <= 55e3
    assert all(each["first_speed"] < full["first_speed"] for each in slower)
    sheet = sheet_of(read_stages(PACKAGE), SheetOptions({"--discharge": "10.5 bar"}))
    (higher,) = sheet.document["pressures"]
    assert not sheet.document["bounded_by_motor"] and higher["bounded_by_motor"]
    assert higher["full_flow"]["second_shaft_power"] == pytest.approx(full["second_shaft_power"], rel=1e-6)


def test_the_second_stage_alone_has_no_figure_of_free_air_as_it_draws_in_what_the_first_has_compressed(tmp_path):
    low, high = (each | {"effects.air_package": {"rated_flow": "20 m^3/min"}} for each in (AIR_LOW, AIR_HIGH))
    found = run_stages(read_stages(written(tmp_path, low, high)))
    first, second = found.stages
    assert first.performance.free_air_delivered == pytest.approx(found.performance.free_air_delivered, rel=1e-12)
    for name in ("free_air_delivered", "package_specific_power"):
        assert second.performance[name] is None and "both stages together" in second.notes[name]


@pytest.mark.parametrize("control", ["flow", "constant"])
def test_the_fan_is_told_as_it_is_controlled(tmp_path, control):
    low = AIR_LOW | {"effects.air_package": {"rated_flow": "20 m^3/min", "fan": {"power": "1 kW", "control": control}}}
    sheet = sheet_of(read_stages(written(tmp_path, low, AIR_HIGH)), SheetOptions(jobs=1))
    assert dict(sheet.lines)["fan"] == f"1 kW, {FAN_CONTROL[control]}"


def test_of_two_fans_each_has_its_scene(tmp_path):
    fan = {"power": "1 kW", "control": "constant"}
    low, high = (
        each | {"effects.air_package": {"rated_flow": "20 m^3/min", "fan": fan}} for each in (AIR_LOW, AIR_HIGH)
    )
    sheet = sheet_of(read_stages(written(tmp_path, low, high)), SheetOptions(jobs=1))
    assert dict(sheet.lines)["fan"] == "first scene 1 kW, at every flow; second scene 1 kW, at every flow"


def test_an_aftercooler_of_the_second_stage_states_its_coolant_and_the_sheet_the_outlet_and_the_heat(tmp_path):
    """First law over both stages: what comes in as power leaves as heat, but for what the air takes along."""
    cooler = {"pressure_loss": "0.1 bar", "approach": "8 K"}
    stage = {"effects.separator": {"cooler": {"discharge_temperature": "75 degC"}}, "oil_supply.temperature": DROP}
    low = AIR_LOW | stage | {"effects.air_package": {"rated_flow": "20 m^3/min"}}
    high = AIR_HIGH | stage | {"effects.air_package": {"rated_flow": "7 m^3/min", "aftercooler": cooler}}
    with pytest.raises(
        screwsim.SceneError, match=r"second scene's aftercooler .* \(state its coolant_temperature there"
    ):
        read_stages(written(tmp_path, low, high))
    high["effects.air_package"]["aftercooler"] = cooler | {"coolant_temperature": "15 degC"}
    chain = read_stages(written(tmp_path, low, high))
    lines, found = dict(sheet_of(chain, SheetOptions(jobs=1)).lines), run_stages(chain).performance
    assert lines["outlet"] == "air at 23.0 °C"
    taken = found.gas_mass_flow * PropsSI("C", "T", 295.0, "P", 1e3, "Air") * (23.0 - 20.0)
    heat, oil = (float(each) for each in re.findall(r"([\d.]+) kW", lines["heat"]))
    assert heat == pytest.approx(1e-3 * (found.package_input_power - taken), abs=0.06)
    assert oil == pytest.approx(1e-3 * (found.first_oil_cooler_duty + found.second_oil_cooler_duty), abs=0.06)


def test_an_aftercooler_behind_the_first_stage_is_refused(tmp_path):
    """Its gas would be as warm in front of the second stage as without it, with a duty that nobody takes."""
    package = {"rated_flow": "20 m^3/min", "aftercooler": {"pressure_loss": "0.1 bar", "approach": "8 K"}}
    low = AIR_LOW | {"effects.air_package": package, "effects.separator": {}}
    with pytest.raises(screwsim.SceneError, match=r"first scene names an aftercooler, .* intercooler: \{kind: cooler"):
        read_stages(written(tmp_path, low, AIR_HIGH))


def test_an_oil_cooler_of_the_second_stage_states_its_coolant(tmp_path):
    """The air at its inlet is that between the stages, and warm."""
    package, size = {"rated_flow": "7 m^3/min"}, {"conductance": "2 kW/K"}
    high = AIR_HIGH | {"effects.air_package": package, "oil_supply.temperature": DROP}
    whole = r"second scene's oil cooler .* \(state its coolant_temperature there\)"
    with pytest.raises(screwsim.SceneError, match=whole):
        read_stages(written(tmp_path, AIR_LOW, high | {"effects.separator": {"cooler": size}}))
    stated = high | {"effects.separator": {"cooler": size | {"coolant_temperature": "20 degC"}}}
    assert read_stages(written(tmp_path, AIR_LOW, stated)).second.effects["separator"].parameters.bounded


def test_pressure_ratios_of_a_package_are_those_of_its_stages(tmp_path):
    """The machine of the second stage delivers above the package's outlet by what is lost behind it."""
    high = AIR_HIGH | {
        "effects.air_package": {"rated_flow": "7 m^3/min", "separator_element": {"pressure_loss": "0.3 bar"}},
    }
    found = run_stages(read_stages(written(tmp_path, AIR_LOW, high)))
    first, second = (each.performance for each in found.stages)
    assert second.package_pressure_loss > 1e3
    whole = found.performance
    for ratio, stage in ((whole.first_pressure_ratio, first), (whole.second_pressure_ratio, second)):
        assert ratio == stage.pressure_ratio
        assert ratio == pytest.approx(stage.discharge_pressure / stage.suction_pressure, rel=1e-12)


@pytest.mark.parametrize("which", ["first", "second"])
def test_an_unloaded_stage_is_refused(tmp_path, which):
    idle = {"rated_flow": "20 m^3/min", "state": "unloaded"}
    idle["unloaded"] = {"intake_pressure": "0.5 bar", "separator_pressure": "1.5 bar"}
    scenes = [AIR_LOW, AIR_HIGH]
    scenes[which == "second"] = scenes[which == "second"] | {"effects.air_package": idle}
    with pytest.raises(screwsim.SceneError, match=f"the {which} scene is unloaded"):
        read_stages(written(tmp_path, *scenes))


def test_a_point_with_an_unloaded_stage_has_failed(tmp_path):
    package = {"rated_flow": "20 m^3/min", "unloaded": {"intake_pressure": "0.5 bar", "separator_pressure": "1.5 bar"}}
    chain = read_stages(written(tmp_path, AIR_LOW | {"effects.air_package": package}, AIR_HIGH))
    found = run_stages(replace(chain, first=with_values(chain.first, {"effects.air_package.state": "unloaded"})))
    assert found.status == "failed" and "the first stage is unloaded" in found.message


def test_a_packages_points_begin_at_full_flow(package, aired):
    rows = table(aired, "Points").rows
    assert [row[:2] for row in rows] == [["3000", "1200"], ["1500", "600"]]
    found = run_stages(read_stages(package)).performance
    point = aired.document["points"][0]
    assert point["free_air_delivered"] == pytest.approx(found.free_air_delivered, rel=1e-12)
    assert float(rows[0][5]) == pytest.approx(1e-3 * found.package_input_power, abs=0.051)
    assert table(aired, "Energy over the profile").rows
    assert any("10 CFR" in note for note in aired.notes)


def test_speeds_of_a_package_are_those_that_motors_on_the_mains_reach(package, monkeypatch):
    """Not those at which they give no torque; that of a stage without such a motor, or without a result, is as set."""
    chain, set_at = read_stages(package), (3000.0 * RPM, 1200.0 * RPM)
    found = run_stages(chain)
    low = replace(found.stages[0], performance=Figures({**found.stages[0].performance, "mean_speed": 2910.0 * RPM}))
    slow, failed = replace(found, stages=(low, found.stages[1])), ChainResult("failed", "no result")
    for one, rpm in ((slow, (2910.0, 1200.0)), (failed, (3000.0, 1200.0))):
        monkeypatch.setattr(stages_air, "_rated", lambda *_, one=one: ([set_at], [one]))
        sheet = stages_air.air_stages_sheet(chain, (), receiver=None, jobs=1, progress=None, units=METRIC)
        assert table(sheet, "Points").rows[0][:2] == [f"{each:.0f}" for each in rpm]
        point = sheet.document["points"][0]
        assert (point["first_speed"] / RPM, point["second_speed"] / RPM) == pytest.approx(rpm)


@pytest.mark.parametrize(
    ("which", "arguments", "words"),
    [
        ("plant", ["--suction", "1 bar..2 bar"], "--suction: belongs to a machine whose lines are stated by pressures"),
        ("plant", ["--evaporating", "-20 degC,"], "--evaporating -20 degC,: is neither LOW..HIGH nor one value or"),
        ("plant", ["--evaporating", "38 degC..40 degC", "--condensing", "39 degC..41 degC"], "no point of the table"),
        (
            "plant",
            ["--limit", "free_air<3 m^3/min"],
            "is not a figure of these two stages: it needs air",
        ),
        ("plant", ["--limit", "piston_speed<3 m/s"], "--limit piston_speed: is not"),
        ("plant", ["--profile", "x.csv"], "--profile: belongs to an air package"),
        ("plant", ["--without", "tip_leakage"], "stages have no --without"),
        ("plant", ["--set", "operation.speed=1 rpm"], "starts with neither first. nor second."),
        ("package", ["--suction", "1 bar..2 bar"], "--suction: belongs to"),
        ("package", ["--discharge", "0.9 bar, 8 bar"], "0.9 bar is not above the 1 bar of the inlet"),
        ("package", ["--heating"], "--heating: belongs to a refrigeration machine"),
    ],
)
def test_what_does_not_belong_to_them_is_one_line(request, capsys, which, arguments, words):
    path = request.getfixturevalue(which)
    assert exit_code(["datasheet", str(path), *arguments]) == 2
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1


def test_other_axes_are_refused(tmp_path):
    path = written(tmp_path, LOW, HIGH, sweep={"first.operation.speed": ["2000 rpm", "3000 rpm"]})
    with pytest.raises(screwsim.UsageError, match=r"but the file varies first\.operation\.speed"):
        sheet_of(read_stages(path), SheetOptions(jobs=1))
    path = written(tmp_path, AIR_LOW, AIR_HIGH, sweep={"first.operation.suction.pressure": ["1 bar", "0.9 bar"]})
    with pytest.raises(screwsim.UsageError, match=r"but the file varies first\.operation\.suction\.pressure"):
        sheet_of(read_stages(path), SheetOptions(jobs=1))


def test_the_command_writes_a_page_a_table_and_a_pdf(package, tmp_path, capsys):
    for ending in ("html", "csv", "pdf"):
        assert exit_code(["datasheet", str(package), "--jobs", "1", "-o", str(tmp_path / f"sheet.{ending}")]) == 0
    assert "Two-stage air package, rating by ISO 1217" in capsys.readouterr().out
    assert "Each stage at full flow" in (tmp_path / "sheet.html").read_text(encoding="utf-8")
    assert (tmp_path / "sheet.pdf").read_bytes().startswith(b"%PDF")
    with (tmp_path / "sheet.csv").open(encoding="utf-8", newline="") as stream:
        first, second = csv.DictReader(stream)
    assert (first["first_speed [rpm]"], second["second_speed [rpm]"]) == ("3000", "600")
    assert float(first["free_air_delivered [m^3/min]"]) > float(second["free_air_delivered [m^3/min]"]) > 0.0


def test_python_takes_the_path_of_a_two_stage_file(package):
    assert screwsim.datasheet(package, jobs=1).document["kind"] == "two_stage_air_package"
