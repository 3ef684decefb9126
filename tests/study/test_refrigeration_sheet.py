"""The data sheet of a refrigeration machine: its tables, part load, envelope and limits, what it prints and refuses."""

import json
import re
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from CoolProp.CoolProp import PropsSI

import screwsim
from screwsim.cli import exit_code
from screwsim.outputs import Figures, Result
from screwsim.report.datasheet import page, write_sheet
from screwsim.scene import with_values
from screwsim.scene.operation import CONDENSING, EVAPORATING, GAS_COOLER_P
from screwsim.simulate import simulate_many
from screwsim.study.asked.goals import Bound
from screwsim.study.datasheet import SheetOptions, sheet_of
from screwsim.study.datasheet.assumed import oil_viscosity
from screwsim.study.datasheet.bounds import envelope, exceeded_bounds, limits_of
from screwsim.study.datasheet.marks import marks_of
from screwsim.study.datasheet.rated import rating
from screwsim.study.datasheet.refrigeration_sheet import (
    convention_notes,
    rating_request,
    refrigerant_line,
    refrigeration_sheet,
)
from screwsim.study.datasheet.sheet import warning_lines
from screwsim.study.datasheet.tables import part_load_note
from screwsim.study.datasheet.units import METRIC
from screwsim.study.part_load import LOADS, NEAR, RATIO_PATH, Control, controls, part_load, ratios
from screwsim.template import new_scene, request_of

pytestmark = pytest.mark.around
CONFIGS = Path(__file__).parents[2] / "configs"
DOCS = CONFIGS.parent / "docs"
CONTROL = CONFIGS / "control" / "point.yaml"
ROTORS = CONFIGS / "rotors" / "b.yaml"
RANGES = "0 degC..5 degC", "40 degC..50 degC"
LIMITS = ("discharge_temperature<72 degC",)


@pytest.fixture(scope="module")
def rated():
    scene = screwsim.load(CONTROL)
    return rating(rating_request(scene, *RANGES, limits_of(scene, LIMITS)), jobs=1)


@pytest.fixture(scope="module")
def sheet(rated):
    return refrigeration_sheet(rated)


def solved(rated, evaporating, condensing):
    scene = with_values(rated.asked.scene, {EVAPORATING: evaporating, CONDENSING: condensing})
    return screwsim.simulate(scene).performance


def test_a_point_of_the_table_is_that_of_a_run(rated, sheet):
    found, result = solved(rated, 278.15, 318.15), rated.points[1, 1].performance
    for name in ("cooling_capacity", "electrical_power", "gas_mass_flow", "discharge_temperature"):
        assert result[name] == pytest.approx(found[name], rel=3e-4)  # the scene's accuracy
    table = sheet.tables[0]
    assert (table.title, table.heads[2].split(), table.rows[1][0]) == ("Cooling capacity [kW]", ["5", "°C"], "45 °C")
    assert float(table.rows[1][2].strip("*\u00a0")) == pytest.approx(1e-3 * found.cooling_capacity, rel=1e-3)


@pytest.mark.parametrize(
    ("fluid", "points"),
    [("R407C", "condensing temperatures are bubble points"), ("R407C.mix", "temperatures are dew points"), ("R32", "")],
)
def test_a_sheet_says_which_points_its_temperatures_are(fluid, points):
    scene = screwsim.load(CONFIGS / "r134a" / "point.yaml", overrides=[f"gas.fluid={fluid}"])
    asked = rating_request(scene, *RANGES, {})
    assert refrigerant_line(asked)[1].endswith(f"; {points}" if points else "subcooling 0 K")
    notes = convention_notes(asked)
    assert [" 4.7 K above the bubble point" in note for note in notes] == ([True] if fluid == "R407C" else [])


@pytest.mark.parametrize(
    ("suction", "told"),
    [
        ({"pressure": "3 bar", "temperature": "20 degC"}, "suction gas of 20 °C"),
        ({"pressure": "3 bar", "superheat": "7 K"}, "superheat 7 K"),
    ],
)
def test_a_first_stage_that_states_its_suction_pressure_has_the_superheat_that_it_states(suction, told):
    """The second one states its condensing temperature, so that both have a sheet of refrigeration."""
    lines = {"evaporating_temperature": None, "condensing_temperature": None, "superheat": None}
    lines |= {"suction": suction, "discharge": {"pressure": "8 bar"}}
    machine = screwsim.load(CONFIGS / "r134a" / "point.yaml")
    asked = rating_request(machine, *RANGES, {})
    first = machine.with_({f"operation.{key}": value for key, value in lines.items()})
    both = replace(asked, scenes=(first, machine))
    assert refrigerant_line(both) == ("refrigerant", f"R134a, {told}, subcooling 0 K")


def test_the_tables_are_those_of_the_trade(sheet):
    titles = [table.title.split(" [")[0] for table in sheet.tables]
    assert titles[:6] == [
        "Cooling capacity",
        "Electrical power",
        "COP of the electrical power",
        "Mass flow",
        "Discharge temperature, gas and oil mixed",
        "Oil cooler duty",
    ]
    assert sheet.ok and len(sheet.tables) == 8 and len(sheet.drawings) == 4


def test_the_pressures_of_the_lines_are_those_of_saturation(sheet):
    told = dict(sheet.lines)["pressures"]
    by_side = dict(re.findall(r"(suction|discharge) ([\d., ]+) bar", told))
    for side, title in (
        ("suction", sheet.tables[0].heads[1:]),
        ("discharge", [row[0] for row in sheet.tables[0].rows]),
    ):
        bars = list(map(float, by_side[side].split(", ")))
        exact = [PropsSI("P", "T", float(each.split()[0]) + 273.15, "Q", 1, "R134a") for each in title]
        assert bars == pytest.approx([1e-5 * p for p in exact], rel=6e-4)  # four digits


def test_oil_colder_than_the_gas_condenses_is_outside_the_assumed_limits():
    """The dew point at discharge is the gas's temperature less its superheat: here 310 K."""
    limits = limits_of(screwsim.loads(new_scene("refrigeration", request_of(fluid="R717"))), ())
    good = {"shaft_power": 0.0, "discharge_temperature": 355.0, "discharge_superheat": 45.0}
    good |= {"mixture_discharge_temperature": 345.0, "oil_supply_temperature": 310.0}
    assert exceeded_bounds(good, limits) == []
    for figure, value, beyond in (
        ("oil_supply_temperature", 309.0, ["oil_over_dew_point"]),
        ("discharge_temperature", 376.0, ["gas_over_mixture", "oil_over_dew_point"]),
        ("mixture_discharge_temperature", 383.2, ["mixture_discharge_temperature"]),
        ("oil_supply_temperature", 420.0, ["oil_viscosity"]),
        ("discharge_superheat", None, []),  # above the critical pressure nothing condenses
    ):
        assert [bound.figure for bound in exceeded_bounds(good | {figure: value}, limits)] == beyond
    cold = good | {"oil_supply_temperature": 308.0}
    warm = good | {"oil_supply_temperature": 312.0}
    (reach,) = envelope({(0, 0): warm, (0, 1): cold}, ((1.0,), (30.0, 40.0)), limits)
    assert reach.high == pytest.approx(35.0) and reach.above.figure == "oil_over_dew_point"


def test_a_stated_limit_of_discharge_replaces_those_that_are_assumed_of_it():
    scene = screwsim.loads(new_scene("refrigeration", request_of()))
    stated = limits_of(scene, ["mixture_discharge_temperature<125 degC"])
    assert [bound.figure for bound, at in stated.items() if at == "assumed"] == ["oil_over_dew_point", "oil_viscosity"]
    dry = screwsim.loads(new_scene("reciprocating", request_of()))
    assert "assumed" not in limits_of(dry, ()).values()


def test_no_mixture_is_assumed_of_a_scene_that_does_not_mix_gas_and_oil():
    """Only a separator tells its temperature: a limit of it would hold at every point."""
    scene = screwsim.load(CONFIGS / "r454b" / "point.yaml")
    assert [bound.figure for bound in limits_of(scene, ())] == ["oil_over_dew_point"]


def test_the_oil_of_a_viscosity_of_ten_square_millimetres_per_second_is_at_its_limit():
    """ISO VG 46 mineral oil of 6.8 mm²/s at 100 °C has 10 between 80 and 90 °C."""
    assert oil_viscosity("mineral_46", 353.15, {}) > 10e-6 > oil_viscosity("mineral_46", 363.15, {})
    assert oil_viscosity("mineral_46", None, {"oil_supply_temperature": 373.15}) == pytest.approx(6.8e-6)


def test_a_heat_pumps_sheet_has_what_its_condenser_gives_beside_the_rest(rated, sheet):
    """COP of heating exceeds that of cooling by less than one: the oil's cooler takes some of the power."""
    both, own = refrigeration_sheet(rated, heating=True), rated.own.performance
    there = {table.title: table for table in both.tables}
    added = [title for title in there if title not in {table.title for table in sheet.tables}]
    assert added == ["Heating capacity [kW]", "COP of heating, of the electrical power"]
    found = rated.points[1, 1].performance
    cells = [float(there[title].rows[1][2].strip("*\u00a0")) for title in added]
    assert cells == [
        pytest.approx(1e-3 * found.heating_capacity, rel=1e-3),
        pytest.approx(found.electrical_heating_cop, abs=0.006),
    ]
    assert 0.0 < own.electrical_heating_cop - own.electrical_cop < 1.0
    (line,) = (text for name, text in both.lines if name == "heating")
    assert line.startswith(f"{1e-3 * own.heating_capacity:.1f} kW from the condenser, without the oil cooler; COP ")
    assert sheet.document["points"] == both.document["points"]  # programs get it in any case


def test_the_sheet_of_a_gas_cooler_has_its_words():
    scene = screwsim.load(CONFIGS / "co2" / "transcritical.yaml")
    p = scene.operation.gas_cooler.pressure
    asked = rating_request(scene, "-11 degC..-9 degC", f"{0.98e-5 * p} bar..{1e-5 * p} bar", {})
    sheet = refrigeration_sheet(rating(asked, jobs=1), heating=True)
    assert sheet.heading.endswith("rating by evaporating temperature and gas-cooler pressure")
    assert " from the gas cooler" in dict(sheet.lines)["heating"]


def test_the_heating_of_a_machine_without_oil_leaves_no_oil_cooler_out():
    scene = screwsim.loads(new_scene("reciprocating", request_of(fluid="R290", condition="7/55 degC, 8 K")))
    sheet = refrigeration_sheet(
        rating(rating_request(scene, "5 degC..7 degC", "54 degC..55 degC", {}), jobs=1), heating=True
    )
    (line,) = (text for name, text in sheet.lines if name == "heating")
    assert "kW from the condenser; COP " in line


def test_a_heat_pumps_part_loads_are_those_of_its_heat():
    scene = screwsim.load(CONTROL, without=["slide_valve", "suction_throttle", "bypass"])
    one = ("2 degC..4 degC", "44 degC..46 degC")
    pump = rating(rating_request(scene, *one, limits_of(scene, ()), heating=True), jobs=1)
    (speed,) = pump.loads
    for step in speed.steps:
        heat = step.result.performance.heating_capacity / pump.own.performance.heating_capacity
        assert heat == pytest.approx(step.load) and any(abs(step.load - load) < 2e-3 for load in LOADS)
    sheet = refrigeration_sheet(pump, heating=True)
    table = next(each for each in sheet.tables if each.title.startswith("Part load"))
    assert table.note.startswith("load: heating capacity relative to that of the scene itself")
    last = speed.steps[-1].result.performance
    assert float(table.rows[-1][3]) == pytest.approx(1e-3 * last.heating_capacity, abs=0.06)
    assert float(table.rows[-1][5]) == pytest.approx(last.electrical_heating_cop, abs=0.006)
    assert sheet.document["part_load_of"] == "heating_capacity"


def test_the_envelope_ends_where_a_limit_is_met(rated):
    """Power is all but linear over 5 K of condensing temperature: the interpolated end is met within 1 %."""
    for reach in rated.reach:
        assert 313.15 < reach.high < 323.15
        assert reach.ends_in_words() == ("end of the table", "shaft power < 50 kW")
    assert solved(rated, reach.at, reach.high).shaft_power == pytest.approx(50e3, rel=0.01)


def test_every_control_is_compared_at_equal_loads(rated):
    full = rated.own.performance.cooling_capacity
    names = [each.control.name for each in rated.loads]
    assert names == ["speed", "slide valve", "suction throttle", "bypass"]
    for each in rated.loads:
        assert [round(step.load, 2) for step in each.steps] == [1.0, 0.75, 0.5, 0.25]
        for step, load in zip(each.steps, (1.0, 0.75, 0.5, 0.25), strict=True):
            assert step.result.performance.cooling_capacity == pytest.approx(load * full, abs=NEAR * full)
        assert each.least < 0.25 and not each.why
    half = [each.steps[2].result.performance.cop for each in rated.loads]
    assert half == sorted(half, reverse=True)  # throttle and bypass waste the work that speed and slide save


def test_a_control_goes_from_the_scenes_own_setting_on():
    scene = screwsim.load(CONTROL, ["effects.slide_valve.position=0.4", "sweep.operation.speed=[1500 rpm, 3500 rpm]"])
    found = {control.name: control.settings for control in controls(scene)}
    assert found["slide valve"][0] == 0.4 and found["slide valve"][-1] == 1.0
    assert [round(each * 30 / 3.141592653589793) for each in found["speed"]] == [2950, 1500]  # no faster than full load


@pytest.fixture
def faked(monkeypatch):
    """Let the capacity follow from the speed alone, as a curve; below 100 rad/s nothing closes."""

    def simulate_many(scenes, trace):
        for scene in scenes:
            omega = scene.operation.speed
            found = Figures(cooling_capacity=omega**1.5)
            yield Result("ok", performance=found) if omega > 100.0 else Result("failed", message="too slow")

    monkeypatch.setattr(sys.modules["screwsim.simulate"], "simulate_many", simulate_many)


def test_a_control_that_ends_early_says_why(faked):
    scene = screwsim.load(CONTROL)
    speed, omega = controls(scene)[0], scene.operation.speed
    found = part_load(scene, speed._replace(settings=(omega, 0.6 * omega, 99.0)))
    assert found.why == "too slow" and found.least == pytest.approx(0.6**1.5)
    assert [step.load for step in found.steps] == pytest.approx([1.0, 0.75, 0.5], abs=NEAR)
    assert found.steps[2].setting == pytest.approx(0.5 ** (2.0 / 3.0) * omega, rel=2.0 * NEAR)


def close(theirs, ours):
    """Tell whether two cells are the same to one in the last digit, which another machine may round otherwise."""
    digit = 10.0 ** -len(ours.partition(".")[2])
    return float(theirs.strip("*†")) == pytest.approx(float(ours.strip("*†\u00a0")), abs=1.01 * digit)


def test_the_how_to_shows_what_the_command_prints(sheet):
    lines = (DOCS / "how-to" / "refrigeration-sheet.md").read_text(encoding="utf-8").splitlines()
    capacity = lines.index("    Cooling capacity [kW]")
    shown = {line.split()[0]: line.split()[2:] for line in lines[capacity + 2 : capacity + 8]}
    for row in sheet.tables[0].rows:
        evaporating = shown[row[0].split()[0]][3:5]  # 0 and 5 °C of -15 … 10 °C
        assert all(close(theirs, ours) for theirs, ours in zip(evaporating, row[1:], strict=True))
    (loads,) = (table for table in sheet.tables if table.title.startswith("Part load"))
    first = next(i for i, line in enumerate(lines) if line.startswith("    speed  "))
    for line, row in zip(lines[first : first + 16], loads.rows, strict=True):
        assert all(close(theirs, ours) for theirs, ours in zip(line.split()[-4:], row[3:], strict=True))


def test_limits_are_marked_and_warnings_reach_the_sheet(sheet):
    (power,) = (table for table in sheet.tables if table.title.startswith("Electrical power"))
    assert power.rows[0][1].endswith("\u00a0") and "*" in power.rows[2][2]
    assert sheet.tables[0].note == "beyond a limit: * shaft power < 50 kW, † discharge temperature < 72 °C"
    assert power.note == "marks: as above"
    assert "discharge temperature < 72 °C (--limit)" in dict(sheet.lines)["limits"]
    alike = list(warning_lines([("a", ["3 K too warm", "odd"]), ("b", ["5 K too warm"]), ("c", ["3 K too warm"])]))
    assert alike == ["a: 3 K too warm (the same at b, c)", "a: odd"]
    assert list(warning_lines([("a", ["same"]), ("b", ["same"])])) == ["same"]


def test_each_limit_has_a_mark_of_its_own():
    figures = (("discharge_temperature", 353.15), ("peak_pressure", 5e5), ("shaft_power", 1e4))
    limits = [Bound(name, "<", value) for name, value in figures]
    points = ((9e3, 4e5), (11e3, 4e5), (11e3, 6e5), (9e3, 6e5))
    results = [
        Result("ok", performance=Figures(shaft_power=power, peak_pressure=peak, discharge_temperature=300.0))
        for power, peak in points
    ]
    marks = marks_of(limits, [*results, None])
    blank = "\u00a0"
    assert marks.column(results) == [2 * blank, f"*{blank}", "*†", f"†{blank}"]
    assert marks.column(results[:1]) == [""]
    assert marks.note(results[:2], METRIC) == "beyond a limit: * shaft power < 10 kW"
    assert marks.note(results, METRIC).endswith(", † peak pressure < 5 bar") and not marks.note([None], METRIC)
    many = [Bound("shaft_power", "<", each) for each in range(8)]
    assert marks_of(many, results).note(results[:1], METRIC).count("shaft power") == 8
    assert list(marks_of(many, results).of.values()) == ["*", "†", "‡", "§", "¶", "#", "**", "††"]


def test_it_prints_within_a_terminal_and_writes_a_page_and_a_pdf(sheet, tmp_path, capsys):
    from screwsim.printing.machine import print_sheet

    print_sheet(sheet)
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 80
    assert "Part load at equal loads" in out and "Envelope: condensing temperature within all limits" in out
    text = page(sheet)
    assert text.count("<polyline") == sum(len(one.curves) for one in sheet.drawings)
    for foreign in ("<script", "http://", "https://", "@STYLE@"):
        assert foreign not in text
    assert Path(write_sheet(sheet, tmp_path / "sheet.pdf")).read_bytes().startswith(b"%PDF")


def test_it_says_what_the_command_line_changes_in_the_scene_of_its_title(capsys, tmp_path):
    narrow = ["--evaporating", "0 degC..5 degC", "--condensing", "40 degC..45 degC", "-o", str(tmp_path / "sheet.html")]
    words = ["datasheet", str(CONTROL), *narrow, "--set", "operation.superheat=8 K", "--without", "slide_valve"]
    assert exit_code(words) == 0
    assert "\nchanged      with operation.superheat=8 K, without slide_valve\n" in capsys.readouterr().out
    assert "with operation.superheat=8 K, without slide_valve" in (tmp_path / "sheet.html").read_text(encoding="utf-8")


def test_its_document_is_in_si(sheet):
    found = json.loads(json.dumps(sheet.document))
    assert found["kind"] == "refrigeration" and len(found["points"]) == 6
    point = found["points"][-1]
    assert (point["evaporating_temperature"], point["condensing_temperature"]) == pytest.approx((278.15, 323.15))
    assert point["cooling_capacity"] > 1e5 and "shaft_power" in point["beyond"]
    assert {each["control"] for each in found["part_load"]} == {"speed", "slide valve", "suction throttle", "bypass"}
    assert [each["figure"] for each in found["limits"]] == [
        "discharge_temperature",
        "shaft_power",
        "oil_over_dew_point",
    ]


def test_a_machine_with_an_economizer_has_what_its_port_draws(tmp_path):
    """The liquid is cooled to 5 K (`approach`) above what evaporates: CoolProp's enthalpies give the gain."""
    file = tmp_path / "eco.yaml"
    file.write_text(new_scene("refrigeration", request_of(economizer=True)), encoding="utf-8")
    ranges = {"--evaporating": RANGES[0], "--condensing": "40 degC..45 degC"}
    found = sheet_of(screwsim.load(file), SheetOptions(ranges, jobs=1))
    tables = {table.title: table for table in found.tables}
    flow, temperature = tables["Economizer mass flow [kg/h]"], tables["Economizer temperature [°C]"]
    T = float(temperature.rows[0][1].rstrip("*\u00a0"))
    p = PropsSI("P", "T", 313.15, "Q", 0, "R134a")
    liquid, cooled = (PropsSI("H", "T", t + 273.15, "P", p, "R134a") for t in (35.0, T + 5.0))
    drawn = (liquid - cooled) / (PropsSI("H", "T", T + 273.15, "Q", 1, "R134a") - liquid)
    sucked = float(tables["Mass flow [kg/h]"].rows[0][1].rstrip("*\u00a0"))
    assert float(flow.rows[0][1].rstrip("*\u00a0")) == pytest.approx(drawn * sucked, rel=3e-3)  # T has three digits
    line = dict(found.lines)["economizer"]
    suction = PropsSI("H", "T", 283.15, "P", PropsSI("P", "T", 273.15, "Q", 1, "R134a"), "R134a")
    gain = float(line.split("it adds ")[1].split(" %")[0])
    assert gain == pytest.approx(100.0 * (liquid - cooled) / (suction - liquid), rel=1e-2)  # of three digits
    assert found.document["own_point"]["economizer_capacity_gain"] == pytest.approx(gain / 100.0, rel=1e-2)


def test_points_that_fail_are_told_and_counted(capsys):
    ranges = ["--evaporating", "0 degC..5 degC", "--condensing", "40 degC..45 degC", "--jobs", "1"]
    assert exit_code(["datasheet", str(CONTROL), *ranges, "--set", "effects.motor.rated_power=10 kW"]) == 4
    told = " ".join(capsys.readouterr().out.split())
    assert "no motor carries more than" in told and "(the same at" in told and "Part load" not in told


def test_the_only_point_that_fails_is_told_with_its_place(rated):
    points = {**rated.points, (0, 1): Result("not_closed", message="a flow stays open")}
    notes = refrigeration_sheet(replace(rated, points=points)).notes
    assert "0/45 °C: not closed: a flow stays open" in notes


def test_the_envelope_of_points_is_interpolated_between_them():
    p, T = "shaft_power", "discharge_temperature"
    bounds = (Bound(p, "<", 10.0), Bound(T, "<", 100.0))
    one = [{p: 6.0, T: 80.0}, {p: 8.0, T: 90.0}, {p: 12.0, T: 130.0}]
    points = {(0, j): each for j, each in enumerate(one)} | {(1, 0): None, (1, 1): one[0], (1, 2): None}
    found = list(envelope(points, ((1.0, 2.0), (30.0, 40.0, 50.0)), bounds))
    assert found[0][:3] == pytest.approx((1.0, 30.0, 42.5))  # T is met at a quarter of the way, p at half of it
    assert found[0].above == bounds[1]
    assert found[1][:3] == (2.0, 40.0, 40.0) and found[1].above == found[1].below == "no result beyond"


def test_ranges_are_those_of_the_scene_or_of_steps_around_its_point():
    own = rating_request(screwsim.load(CONTROL), None, None, {})
    assert [round(T - 273.15, 6) for T in own.across.values] == [-15, -10, -5, 0, 5, 10]
    assert [round(T - 273.15, 6) for T in own.down.values] == [30, 35, 40, 45, 50, 55]
    swept = rating_request(screwsim.load(CONFIGS / "r134a" / "map.yaml"), None, None, {})
    assert len(swept.across.values) == 6 and len(swept.down.values) == 5
    cooled = rating_request(screwsim.load(CONFIGS / "co2" / "transcritical.yaml"), None, None, {})
    assert cooled.down.path == GAS_COOLER_P and cooled.down.values[3] == pytest.approx(90e5)


@pytest.mark.parametrize(
    ("scene", "more", "words"),
    [
        ("control/point", ["--limit", "discharge_temperature"], "is not FIGURE<VALUE or FIGURE>VALUE (write"),
        ("control/point", ["--limit", "discharge_temprature<90 degC"], "did you mean 'discharge_temperature'?"),
        ("control/point", ["--limit", "discharge_temperature<90"], "90 has no unit (write one of K"),
        ("control/point", ["--limit", "cop>much"], "'much' is not a number with a unit (write a number with one of"),
        ("control/point", ["--limit", "water_flow<1"], "is not a figure of this scene"),
        (
            "control/point",
            ["--evaporating", "5 degC,, 8 degC"],
            "8 degC: is neither LOW..HIGH nor one value or several (write e.g. --evaporating '-10",
        ),
        ("control/point", ["--condensing", "50 degC..40 degC"], "is empty (LOW must be below HIGH)"),
        (
            "control/point",
            ["--evaporating", "30 degC..40 degC", "--condensing", "20 degC..30 degC"],
            "no point of the table can be computed: all lifts are below 10 K (state other ranges with --evaporating",
        ),
        ("r134a/envelope", [], "the scene varies oil_supply.ratio in another way"),
        (
            "control/point",
            ["--suction", "2 bar..4 bar"],
            "--suction: belongs to a machine whose lines are stated",
        ),
    ],
)
def test_what_it_cannot_rate_is_told_in_one_line(scene, more, words, capsys):
    assert exit_code(["datasheet", str(CONFIGS / f"{scene}.yaml"), *more]) == 2
    out, err = capsys.readouterr()
    assert out == "" and words in err and len(err.strip().splitlines()) == 1


def test_a_sheet_is_made_from_python():
    scene = screwsim.load(CONFIGS / "air" / "fixed_speed_7.yaml")
    with pytest.raises(screwsim.UsageError, match="--evaporating: belongs to a refrigeration machine"):
        sheet_of(scene, SheetOptions({"--evaporating": "0 degC..5 degC"}))


def test_at_each_part_load_the_best_built_in_ratio_is_found_at_that_load(monkeypatch):
    """A machine whose COP is best at Vi = 2.5 ω/ω_full + 0.5, and whose capacity the ratio lowers a little."""
    full = screwsim.load(ROTORS).operation.speed

    def simulate_many(scenes, trace):
        for scene in scenes:
            share, ratio = scene.operation.speed / full, scene.machine.built_in_volume_ratio
            cop = 4.0 - 0.1 * (ratio - 0.5 - 2.5 * share) ** 2
            yield Result("ok", performance=Figures(cooling_capacity=1e5 * share * (1.0 - 0.01 * ratio), cop=cop))

    monkeypatch.setattr(sys.modules["screwsim.simulate"], "simulate_many", simulate_many)
    scene = screwsim.load(ROTORS, ["machine.built_in_volume_ratio=3", "machine.axial_volume_ratio=3.6"])
    found = part_load(scene, controls(scene)[0], among=ratios(scene))
    assert ratios(scene) == pytest.approx((1.8, 2.25, 2.7, 3.15, 3.6))
    for step in found.steps:
        assert step.ratio == pytest.approx(max(0.5 + 2.5 * step.setting / full, 1.8), abs=1e-6)
        assert step.best.performance.cop >= step.result.performance.cop
        if step.load < 1.0:
            assert step.best.performance.cooling_capacity == pytest.approx(step.load * 0.97e5, abs=2.0 * NEAR * 1e5)
    low = screwsim.load(ROTORS, ["machine.built_in_volume_ratio=2.2", "machine.axial_volume_ratio=5"])
    assert ratios(low) == pytest.approx((2.2, 2.9, 3.6, 4.3, 5.0))  # the machine's own is less than half of 5
    for step in part_load(low, controls(low)[0], among=ratios(low)).steps:
        assert step.best.performance.cop >= step.result.performance.cop
    assert ratios(screwsim.load(ROTORS)) == ()
    assert ratios(screwsim.load(ROTORS, ["sweep.machine.built_in_volume_ratio=[3, 2.2]"])) == (2.2, 3.0)


def test_a_ratio_that_the_machine_cannot_have_is_told_and_its_own_is_among_those_that_are_tried(monkeypatch):
    """Best at 2.5, where the machine stands; below 2.3 its slide would be too narrow, so that 2.7 seemed best."""

    def simulate_many(scenes, trace):
        for scene in scenes:
            ratio = scene.machine.built_in_volume_ratio
            known = {"cooling_capacity": scene.operation.speed, "cop": 4.0 - (ratio - 2.5) ** 2}
            yield Result("ok", performance=Figures(known)) if ratio > 2.3 else Result("failed", "too narrow")

    monkeypatch.setattr(sys.modules["screwsim.simulate"], "simulate_many", simulate_many)
    scene = screwsim.load(ROTORS, ["machine.built_in_volume_ratio=2.5", "machine.axial_volume_ratio=3.6"])
    found = part_load(scene, controls(scene)[0], among=ratios(scene))
    for step in found.steps:
        assert step.ratio == pytest.approx(2.5, abs=1e-6)
        assert step.missed == dict.fromkeys(ratios(scene)[:2], "failed: too narrow")
    rated = SimpleNamespace(asked=SimpleNamespace(ratios=ratios(scene)), loads=[found])
    told = part_load_note(rated, "its flow", "COP")
    assert told.endswith(
        "; not all points were solved at 1.8, 2.25, so a better one may be missed (failed: too narrow)"
    )


@pytest.mark.parametrize("condensing", [30, 45])
def test_the_best_built_in_ratio_of_real_cycles_is_that_of_a_scan(condensing):
    """Rotors of a profile, at full and half load: the ratio within a scan's step, the COP within 0.05 % of its best."""
    moved = ["machine.axial_volume_ratio=4", "numerics.accuracy=1e-3"]
    scene = screwsim.load(ROTORS, [*moved, f"operation.condensing_temperature={condensing} degC"])
    full, path = scene.operation.speed, "operation.speed"
    settings = (full, 0.6 * full, 0.4 * full)
    found = part_load(scene, Control("speed", path, settings), loads=(1.0, 0.5), among=ratios(scene))
    scanned = [2.0 + 0.1 * step for step in range(21)]
    for step in found.steps:
        cases = (with_values(scene, {path: step.setting, RATIO_PATH: ratio}) for ratio in scanned)
        cop = [result.performance.cop for result in simulate_many(cases, trace=False)]
        assert 2.0 < scanned[cop.index(max(cop))] < 4.0  # the scan has its best inside
        assert step.ratio == pytest.approx(scanned[cop.index(max(cop))], abs=0.1)
        assert step.best.performance.cop == pytest.approx(max(cop), rel=5e-4)
        assert step.best.performance.cop > 1.0005 * cop[-1]  # and the ratio matters


def test_a_slide_of_the_rotors_is_a_control():
    slide = "machine.slide_valve={position: 0.1, travel: 90 mm, male_span: 70 deg, female_span: 60 deg}"
    scene = screwsim.load(ROTORS, [slide, "effects.slide_valve={}"])
    (found,) = [control for control in controls(scene) if control.name == "slide valve"]
    assert found.path == "machine.slide_valve.position" and found.settings[0] == 0.1 and found.settings[-1] == 1.0
