"""An air package over its outlet pressure: each row is a run's, motors bound variable speed, gears load fixed speed."""

import csv
import json
from pathlib import Path

import pytest

import screwsim
from screwsim.cli import exit_code
from screwsim.effects.motor import Parameters as Motor
from screwsim.effects.parts.inverter import Inverter
from screwsim.outputs.customary import RPM
from screwsim.outputs.us_units import PSI
from screwsim.scene import without_sweep
from screwsim.scene.operation import P_D, SPEED
from screwsim.study.datasheet import SheetOptions, carried, sheet_of
from screwsim.study.datasheet.bounds import Bound, Carried, excess_of, limits_document
from screwsim.study.seek import GoalSeekAnswer

pytestmark = pytest.mark.around
AIR = Path(__file__).parents[2] / "configs" / "air"
PRESSURES = "8, 8.5, 11, 14 bar"
PASCAL = [8e5, 8.5e5, 11e5, 14e5]
RATED = 110e3  # W
FULL, GEARED = "Full flow over the outlet pressure", "The same machine geared for each outlet pressure"


def sheet(name, text=PRESSURES, *changes, **options):
    asked = SheetOptions(ranges={"--discharge": text}, **options)
    return sheet_of(screwsim.load(AIR / f"{name}.yaml", changes), asked)


@pytest.fixture(scope="module")
def fixed():
    return sheet("fixed_speed_7")


@pytest.fixture(scope="module")
def variable():
    return sheet("variable_speed_7")


def table(of, title):
    return next(each for each in of.tables if each.title == title)


def column(of, title, head):
    found = table(of, title)
    return [float(row[found.heads.index(head)].strip("*\u00a0")) for row in found.rows]


def run_at(name, pressure, speed):
    changes = [f"{P_D}={pressure} Pa", f"operation.speed={speed / RPM!r} rpm"]
    scene = screwsim.load(AIR / f"{name}.yaml", changes)
    return screwsim.simulate(without_sweep(scene), trace=False).performance


@pytest.mark.parametrize("name", ["fixed", "variable"])
def test_every_point_is_that_of_a_run_at_its_pressure_and_speed(name, request):
    of = request.getfixturevalue(name)
    assert of.ok
    assert [each["outlet_pressure"] for each in of.document["pressures"]] == PASCAL
    for each in of.document["pressures"]:
        for kind in {"full_flow", "lowest_flow", "geared"} & each.keys():
            point = each[kind]
            found = run_at(f"{name}_speed_7", each["outlet_pressure"], point["speed"])
            assert found.package_discharge_pressure == pytest.approx(each["outlet_pressure"], rel=1e-9)
            for figure in ("free_air_delivered", "package_input_power", "shaft_power"):
                assert point[figure] == pytest.approx(found[figure], rel=2e-4), (kind, figure)  # accuracy: 3e-4


def test_the_row_of_its_own_pressure_is_the_point_of_the_sheet(fixed, variable):
    for of in (fixed, variable):
        own, again = of.document["points"][0], of.document["pressures"][1]["full_flow"]
        assert again["free_air_delivered"] == pytest.approx(own["free_air_delivered"], rel=1e-9)
    geared = fixed.document["pressures"][1]["geared"]
    assert geared["speed"] / RPM == pytest.approx(2950.0, abs=1e-6)


def test_at_fixed_speed_a_motor_beyond_its_rating_is_marked(fixed):
    loads = [each["full_flow"]["shaft_power"] for each in fixed.document["pressures"]]
    marked = [row[0].endswith("*") for row in table(fixed, FULL).rows]
    assert marked == [load > RATED for load in loads] == [False, False, True, True]
    assert "beyond a limit: * shaft power < 110 kW" in table(fixed, FULL).note
    assert len({row[2] for row in table(fixed, FULL).rows}) == 1  # one speed


def test_gears_load_the_motor_as_at_the_own_point(fixed):
    """To half a revolution per minute of some 2200: 0.03 %."""
    own = fixed.document["points"][0]["shaft_power"]
    speeds = []
    for each in fixed.document["pressures"]:
        assert each["geared"]["shaft_power"] == pytest.approx(own, rel=5e-4)
        speeds.append(each["geared"]["speed"] / RPM)
        assert speeds[-1] == pytest.approx(round(speeds[-1]), abs=1e-6)
    assert speeds == sorted(speeds, reverse=True)


def test_at_variable_speed_the_motor_bounds_the_speed(variable):
    """A whole number of revolutions per minute, one more would overload it."""
    for each in variable.document["pressures"]:
        full, lowest = each["full_flow"], each["lowest_flow"]
        assert full["shaft_power"] <= RATED
        assert each["bounded_by_motor"] == (each["outlet_pressure"] > 10e5)
        assert lowest["speed"] / RPM == pytest.approx(950.0)
        assert lowest["free_air_delivered"] < full["free_air_delivered"]
        if each["bounded_by_motor"]:
            faster = run_at("variable_speed_7", each["outlet_pressure"], full["speed"] + 1.1 * RPM)
            assert full["speed"] < 2950.0 * RPM and faster.shaft_power > RATED
    assert not [row for row in table(variable, FULL).rows if "*" in row[0]]
    assert column(variable, FULL, "motor %")[2:] == [100.0, 100.0]
    assert GEARED not in [each.title for each in variable.tables]


def test_a_motor_too_small_for_the_lowest_speed_leaves_the_highest_with_a_mark():
    of = sheet("variable_speed_7", "8.5 bar, 8.6 bar", "effects.motor.rated_power=31.5 kW")
    assert not any(each["bounded_by_motor"] for each in of.document["pressures"])
    assert all("*" in row[0] for row in table(of, FULL).rows)


def test_a_speed_that_only_comes_near_the_rated_power_bounds_nothing(monkeypatch):
    def near(scene, question, jobs):
        return [GoalSeekAnswer("none", question.spans, question.goals, values={SPEED: 1500.0 * RPM})]

    monkeypatch.setattr(carried, "find_each", near)
    of = sheet("variable_speed_7", "8.5 bar, 11 bar")
    assert not any(each["bounded_by_motor"] for each in of.document["pressures"])
    assert table(of, FULL).rows[1][0].endswith("*") and float(table(of, FULL).rows[1][2]) == 2950.0


def test_gears_that_no_speed_gives_are_told():
    of = sheet("fixed_speed_7", "8.5 bar, 45 bar")
    assert not of.ok
    own, last = of.document["pressures"]
    assert (own["geared"]["status"], last["geared"]["status"]) == ("ok", "failed")
    assert any("no speed loads the motor as at its own point" in note for note in of.notes)


def test_pressures_of_a_sweep_are_rated_and_a_range_has_five():
    swept = sheet("fixed_speed_7", None, f"sweep.{P_D}=[11 bar, 8 bar]")
    assert [each["outlet_pressure"] for each in swept.document["pressures"]] == [8e5, 11e5]
    ranged = sheet("fixed_speed_7", "8..12 bar")
    assert [each["outlet_pressure"] for each in ranged.document["pressures"]] == [8e5, 9e5, 10e5, 11e5, 12e5]
    assert "pressures" not in sheet("fixed_speed_7", None).document


def test_one_pressure_is_a_row():
    (only,) = sheet("fixed_speed_7", "11 bar").document["pressures"]
    assert only["outlet_pressure"] == 11e5 and only["geared"]["shaft_power"] < only["full_flow"]["shaft_power"]


def test_full_flow_of_the_sheet_is_at_the_highest_speed_that_the_motor_carries(variable):
    """As in the row of the same pressure of another sheet, to a revolution per minute."""
    of = sheet("variable_speed_7", None, f"{P_D}=11 bar")
    found = of.document
    speeds = [each["speed"] / RPM for each in found["points"]]
    row = variable.document["pressures"][2]["full_flow"]
    assert found["bounded_by_motor"] and not variable.document["bounded_by_motor"]
    assert speeds[0] == pytest.approx(row["speed"] / RPM, abs=1.01)
    assert speeds[1:] == pytest.approx([2550.0, 2150.0, 1750.0, 1350.0, 950.0])
    power = run_at("variable_speed_7", 11e5, 2950.0 * RPM).shaft_power
    (told,) = [text for name, text in of.lines if name == "speed"]
    assert told == (
        f"full flow at {speeds[0]:.0f} rpm, the highest that the motor carries: the 2950 rpm of the sweep take "
        f"{power / 1e3:.1f} kW ({power / RATED:.0%})".replace("%)", " %)")
    )
    assert "speed" not in [name for name, _ in variable.lines]


def test_a_sweep_of_one_speed_is_variable_in_all_tables():
    """No gears, and the speed of the other pressure is lowered; the package is not rated at one load."""
    of = sheet("variable_speed_7", "8.5 bar, 11 bar", "sweep.operation.speed=[2950 rpm]")
    own, high = of.document["pressures"]
    assert (own["bounded_by_motor"], high["bounded_by_motor"]) == (False, True)
    assert "geared" not in own and "lowest_flow" not in own and GEARED not in [each.title for each in of.tables]
    assert own["full_flow"]["speed"] / RPM == pytest.approx(2950.0) and high["full_flow"]["shaft_power"] <= RATED
    assert "variable speed, 1 point" in dict(of.lines)["package"]
    assert "variable speed" in of.verdict[0]


def test_a_motor_whose_field_stays_above_its_rated_speed_carries_more_there():
    """Windings for 230 V on 400 V: up to 87 Hz the power at the rated current rises with the speed."""
    inverter = "{rated_speed: 2000 rpm, loss: 3 kW, full_field_speed: 3480 rpm}"
    values = "{rated_power: 75 kW, efficiency: null, efficiency_file: null, drive_efficiency: 1, efficiency_class: IE3"
    speeds = "sweep.operation.speed=[2950 rpm, 950 rpm]"
    of = sheet("variable_speed_7", None, f"effects.motor={values}, inverter: {inverter}}}", speeds)
    full = of.document["points"][0]
    assert full["speed"] / RPM == pytest.approx(2950.0) and full["shaft_power"] > 1.15 * 75e3
    assert not of.document["bounded_by_motor"]
    words = dict(of.lines)
    assert "above its rating" not in words["motor"]
    assert (
        "shaft power < 110.6 kW at 2950 rpm, at others by the speed (effects.motor.inverter" in words["limits"]
    )  # 75 kW × 2950/2000


def test_gauge_pressures_and_us_units():
    ambient = "operation.ambient_pressure=1 bar"
    of = sheet("variable_speed_7", "100, 125 psi(g)", ambient, units="us")
    assert column(of, FULL, "psi over inlet") == [100.0, 125.0]
    flow = of.document["pressures"][1]["full_flow"]["package_discharge_pressure"]
    assert (flow - 1e5) / PSI == pytest.approx(125.0, rel=1e-9)
    assert "lowest acfm" in table(of, FULL).heads and "m³/min" not in table(of, FULL).heads


def test_tables_fit_a_terminal_and_points_are_rows(tmp_path, capsys):
    file = tmp_path / "sheet.csv"
    assert exit_code(["datasheet", str(AIR / "variable_speed_7.yaml"), "--discharge", PRESSURES, "-o", str(file)]) == 0
    out = capsys.readouterr().out
    assert max(len(line) for line in out.splitlines() if str(tmp_path) not in line) <= 80
    rows = list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))
    others = [pressure for pressure in ("8", "8.5", "11", "14") for _ in range(2)]
    assert [row["outlet_pressure [bar]"] for row in rows] == [*["8.5"] * 6, *others]
    assert [row["flow"] for row in rows[6:8]] == ["full flow", "lowest flow"]
    assert {row["package_discharge_pressure [bar]"] for row in rows[-2:]} == {"14"}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("8 bar;9 bar", "'8 bar;9 bar' is not a pressure"),
        (",", "is neither LOW..HIGH nor one value or several (write e.g. --discharge '8 bar, 9.5 bar, 11 bar')"),
        ("7,5 bar", "does not rise from value to value (a decimal point is a dot)"),
        ("8 bar,, 9 bar", "is neither LOW..HIGH nor one value or several"),
        ("8 bar, 9", "'9' has no unit"),
        ("0.5 bar, 8 bar", "0.5 bar is not above the 1 bar of the inlet"),
        ("11 bar..8 bar", "is empty (LOW must be below HIGH)"),
    ],
)
def test_what_is_no_list_of_pressures_is_told_in_one_line(text, words, capsys):
    assert exit_code(["datasheet", str(AIR / "fixed_speed_7.yaml"), "--discharge", text]) == 2
    out, err = capsys.readouterr()
    assert out == "" and words in err and err.count("\n") == 1


def test_the_json_has_them(capsys):
    assert exit_code(["datasheet", str(AIR / "fixed_speed_7.yaml"), "--discharge", "8, 11 bar", "--json"]) == 0
    out = json.loads(capsys.readouterr().out)
    assert [each["outlet_pressure"] for each in out["pressures"]] == [8e5, 11e5]


def test_a_motor_whose_field_stays_carries_less_at_lower_speeds():
    """75 kW at 2000 rpm and 110.6 at 2950: 90 kW are too much at 2300 rpm, where it carries 86.25."""
    inverter = {"rated_speed": 2000.0 * RPM, "loss": 3e3, "full_field_speed": 3480.0 * RPM}
    motor = Motor(rated_power=75e3, inverter=Inverter(**inverter))
    limit = Carried("shaft_power", motor, 2950.0 * RPM)
    assert limit.value == pytest.approx(110.625e3, rel=1e-9)
    displaced = {"displacement": 1e-3, "shaft_power": 90e3}
    for speed, most in ((2950.0, 110.625e3), (2300.0, 86.25e3), (1000.0, 75e3)):
        found = {**displaced, "displacement_flow": 1e-3 * speed / 60.0}
        assert excess_of(limit, found) == pytest.approx(90e3 - most, rel=1e-9)
    (first, second) = limits_document({limit: "where", Bound("shaft_power", "<", 75e3): "there"})
    assert first == {
        "figure": "shaft_power",
        "below": True,
        "value": limit.value,
        "from": "where",
        "speed": 2950.0 * RPM,
    }
    assert "speed" not in second  # it holds at any
    assert excess_of(limit, {}) != excess_of(limit, {})  # NaN: a point without a power is within no limit


@pytest.mark.parametrize("full_field", ["3480 rpm", "2500 rpm"])
def test_full_flow_is_where_a_motor_whose_field_stays_carries_it(full_field):
    """Torque hardly changes with speed: what is too much of it at the highest speed is so down to the rated one."""
    inverter = f"{{rated_speed: 2000 rpm, loss: 2 kW, full_field_speed: {full_field}}}"
    values = "{rated_power: 66 kW, efficiency: null, efficiency_file: null, drive_efficiency: 1, efficiency_class: IE3"
    speeds = "sweep.operation.speed=[2950 rpm, 950 rpm]"
    of = sheet("variable_speed_7", None, f"effects.motor={values}, inverter: {inverter}}}", speeds)
    full = of.document["points"][0]
    speed = full["speed"] / RPM
    assert of.document["bounded_by_motor"] and speed == pytest.approx(round(speed), rel=1e-9)
    assert 0.99 < full["shaft_power"] / (66e3 * max(min(speed, float(full_field.split()[0])) / 2000.0, 1.0)) <= 1.0
