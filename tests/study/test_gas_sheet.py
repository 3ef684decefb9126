"""The data sheets of machines whose lines are stated by pressures: gas compressors and expanders."""

import json
import math
from pathlib import Path

import pytest

import screwsim
from screwsim.cli import exit_code
from screwsim.outputs import Result
from screwsim.scene import loads
from screwsim.scene.operation import P_D, P_S, SPEED
from screwsim.study.asked.inputs import ends_of
from screwsim.study.datasheet.air_points import Point
from screwsim.study.datasheet.gas_sheet import rating_request
from screwsim.study.datasheet.machine_lines import machine_line, oil_line
from screwsim.study.datasheet.rated import case_scene
from screwsim.template import new_scene, request_of

pytestmark = pytest.mark.around
CONFIGS = Path(__file__).parents[2] / "configs"
NONE = {"--suction": None, "--discharge": None}
LAX = "numerics.accuracy=3e-3"
MASS = "Mass flow [kg/h]"


def new(tmp_path_factory, kind):
    file = tmp_path_factory.mktemp(kind) / f"{kind}.yaml"
    file.write_text(new_scene(kind, request_of()), encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def booster(tmp_path_factory):
    return new(tmp_path_factory, "booster")


@pytest.fixture(scope="module")
def expander(tmp_path_factory):
    return new(tmp_path_factory, "expander")


@pytest.fixture(scope="module")
def boosted(booster):
    over = [
        "suction.pressure=[4 bar, 5 bar, 6 bar]",
        "discharge.pressure=[18 bar, 20 bar]",
        "speed=[2000 rpm, 2950 rpm]",
    ]
    scene = screwsim.load(booster, [LAX, *(f"sweep.operation.{axis}" for axis in over)])
    return scene, screwsim.datasheet(scene, limits=["shaft_power<150 kW"], jobs=1)


@pytest.fixture(scope="module")
def expanded(expander):
    changes = ["sweep.operation.speed=[1475 rpm, 2950 rpm]", "sweep.operation.discharge.pressure=[6 bar, 8 bar]"]
    scene = screwsim.load(expander, [LAX, *changes])
    return scene, screwsim.datasheet(scene, jobs=1)


def solved(scene, **operation):
    text = [f"operation.{path.replace('__', '.')}={value}" for path, value in operation.items()]
    return screwsim.simulate(screwsim.load(scene, [LAX, *text]), trace=False).performance


def test_a_boosters_cell_is_that_of_a_run(booster, boosted):
    _, sheet = boosted
    found = solved(booster, suction__pressure="5 bar", discharge__pressure="20 bar")
    tables = {table.title: table for table in sheet.tables}
    flow = tables["Mass flow [kg/h]"]
    assert flow.heads == ["discharge", *(f"{p}\u00a0bar" for p in "456")]
    assert [row[0] for row in flow.rows] == ["18 bar", "20 bar"]
    cells = {
        "Mass flow [kg/h]": 3600.0 * found.gas_mass_flow,
        "Electrical power [kW]": 1e-3 * found.electrical_power,
        "Volumetric efficiency [%]": 100.0 * found.volumetric_efficiency,
        "Oil cooler duty [kW]": 1e-3 * found.oil_cooler_duty,
    }
    for title, value in cells.items():
        assert float(tables[title].rows[1][2].strip("*\u00a0")) == pytest.approx(value, rel=5e-3)  # its accuracy


def test_normal_volume_is_that_of_the_ideal_gas(boosted):
    """16.043 g/mol of methane, 22.414 L/mol at 0 °C and 1.01325 bar (CODATA)."""
    _, sheet = boosted
    tables = {table.title: table for table in sheet.tables}
    mass, volume = (float(tables[title].rows[1][2].strip("*\u00a0")) for title in ("Mass flow [kg/h]", "Flow [Nm³/h]"))
    assert volume / mass == pytest.approx(22.414 / 16.043, rel=1e-3)  # four digits of each


def test_normal_volume_of_humid_air_is_that_of_its_dry_air():
    """28.965 g/mol of dry air; 0.0317 bar of saturated vapour at 25 °C (IAPWS), of which 60 % are there."""
    over = ["suction.pressure=[0.9 bar, 1 bar]", "discharge.pressure=[9 bar]", "speed=[3000 rpm]"]
    scene = screwsim.load(CONFIGS / "air" / "moist.yaml", [LAX, *(f"sweep.operation.{axis}" for axis in over)])
    sheet = screwsim.datasheet(scene, jobs=1)
    flow, mass = (next(each for each in sheet.tables if each.title == title) for title in ("Flow [Nm³/h]", MASS))
    for column, p in ((1, 0.9), (2, 1.0)):
        vapour = 0.6 * 0.03170
        water = 18.015 / 28.965 * vapour / (p - vapour)
        wanted = float(mass.rows[0][column]) / (1.0 + water) * 22.414 / 28.965
        assert float(flow.rows[0][column]) == pytest.approx(wanted, rel=1.5e-3)  # four digits of each; water is 1.2 %
    assert "relative humidity 60 %" in dict(sheet.lines)["gas"]
    assert any("without the water of humid air" in note for note in sheet.notes)
    assert sheet.document["normal_volume"] == pytest.approx(22.414 / 28.965 / (1.0 + water), rel=3e-4)


def test_points_without_a_rise_of_the_pressure_are_left_out(booster):
    scene = screwsim.load(booster, [LAX, "sweep.operation.speed=[2950 rpm]"])
    ranges = {**NONE, "--suction": "10 bar..20 bar", "--discharge": "15 bar..25 bar"}
    asked = rating_request(scene, ranges, {})
    cases = {(p, q): case_scene(asked, p, q) for p in asked.across.values for q in asked.down.values}
    assert {place for place, case in cases.items() if case is None} == {(p, q) for p, q in cases if q < 1.2 * p}
    assert all(isinstance(case, screwsim.Scene) for case in cases.values() if case is not None)


def test_a_table_without_a_point_is_refused(booster, expander, capsys):
    ranges = ["--suction", "30 bar..40 bar", "--discharge", "10 bar..20 bar"]
    assert exit_code(["datasheet", str(booster), *ranges]) == 2
    told = "all pressure ratios are below 1.2 (state other ranges with --suction and --discharge)"
    assert told in capsys.readouterr().err
    assert exit_code(["datasheet", str(expander), "--suction", "4 bar..6 bar", "--discharge", "7 bar..9 bar"]) == 2
    assert told in capsys.readouterr().err


def test_a_boosters_limits_part_load_and_best_point(boosted):
    _, sheet = boosted
    (power,) = (table for table in sheet.tables if table.title.startswith("Electrical power"))
    marked = [cell.endswith("*") for row in power.rows for cell in row[1:]]
    assert any(marked) and not all(marked)
    (loads_,) = (table for table in sheet.tables if table.title.startswith("Part load"))
    assert [row[1] for row in loads_.rows] == ["100*", "75\u00a0"] and loads_.heads[3] == "flow kg/h"
    assert float(loads_.rows[1][3]) == pytest.approx(0.75 * float(loads_.rows[0][3]), rel=5e-3)
    assert any(table.title == "Envelope: discharge pressure within all limits" for table in sheet.tables)
    assert "shaft power < 150 kW (--limit)" in dict(sheet.lines)["limits"]


def test_its_document_is_in_si(boosted, expanded):
    document = json.loads(json.dumps(boosted[1].document))
    assert (document["kind"], len(document["points"]), document["pressure_ratio"]) == ("gas", 6, 4.0)
    assert document["points"][0]["suction_pressure"] == pytest.approx(4e5)
    assert json.loads(json.dumps(expanded[1].document))["kind"] == "expander"


def test_an_expanders_sheet_gives_power_efficiency_and_filling_over_speed_and_outlet(expander, expanded):
    _, sheet = expanded
    assert sheet.ok and sheet.heading == "Expander, rating by speed and outlet pressure"
    tables = {table.title: table for table in sheet.tables}
    found = solved(expander, speed="1475 rpm", discharge__pressure="6 bar")
    cells = {
        "Electrical power given [kW]": -1e-3 * found.electrical_power,
        "Electrical isentropic efficiency [%]": 100.0 * found.electrical_isentropic_efficiency,
        "Filling factor": found.filling_factor,
    }
    for title, value in cells.items():
        assert tables[title].heads == ["outlet", "1475\u00a0rpm", "2950\u00a0rpm"]
        assert float(tables[title].rows[0][1]) == pytest.approx(value, rel=5e-3)  # the scene's accuracy
    assert value > 1.0 and not any(table.title.startswith("Part load") for table in sheet.tables)
    assert [drawing.x_label for drawing in sheet.drawings] == ["pressure ratio"] * 2
    assert "generator" in dict(sheet.lines) and "output power < 90 kW" in dict(sheet.lines)["limits"]


def test_the_sheet_of_a_bare_air_compressor_says_what_rates_a_package(capsys):
    over = ["suction.pressure=[1 bar]", "discharge.pressure=[3 bar, 3.5 bar]", "speed=[720 rpm]"]
    given = [word for axis in over for word in ("--set", f"sweep.operation.{axis}")]
    assert exit_code(["datasheet", str(CONFIGS / "slider_crank" / "air.yaml"), *given, "--jobs", "1"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "rated by ISO 1217 (name effects.air_package)" in told and "Nm³/h: as an ideal gas" in told


def test_axes_are_the_sweeps_the_options_or_shares_of_the_scenes_own():
    gas = loads(new_scene("booster", request_of()))
    own = rating_request(gas, NONE, {})
    assert (own.across.path, own.down.path) == (P_S, P_D)
    assert own.across.values == pytest.approx([4e5, 4.5e5, 5e5, 5.5e5, 6e5])
    expands = loads(new_scene("expander", request_of()))
    assert rating_request(expands, NONE, {}).across.path == SPEED
    inlets = rating_request(expands, {**NONE, "--suction": "18 bar..22 bar"}, {})
    assert inlets.across.path == P_S and inlets.across.values[0] == pytest.approx(18e5)
    one = rating_request(gas, {"--suction": "4 bar", "--discharge": "15 bar"}, {})
    assert one.across.values + one.down.values == pytest.approx([4e5, 15e5])


@pytest.mark.parametrize(
    ("scene", "more", "words"),
    [
        (
            "paper/point",
            ["--condensing", "30 degC..40 degC"],
            "--condensing: belongs to a refrigeration machine, and the",
        ),
        (
            "paper/point",
            ["--suction", "1 bar,"],
            "1 bar,: is neither LOW..HIGH nor one value or several (write e.g. --suction '4 bar..6 bar')",
        ),
        ("paper/point", ["--discharge", "9 bar..7 bar"], "is empty (LOW must be below HIGH)"),
        ("paper/point", ["--discharge", "7..9"], "--discharge 7..9: '7' has no unit"),
        ("paper/fig1", [], "but the scene varies"),
        ("air/fixed_speed_7", ["--suction", "1 bar..2 bar"], "and the scene is an air package (remove it)"),
    ],
)
def test_what_it_cannot_rate_is_told_in_one_line(scene, more, words, capsys):
    assert exit_code(["datasheet", str(CONFIGS / f"{scene}.yaml"), *more]) == 2
    out, err = capsys.readouterr()
    assert out == "" and words in err and len(err.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("text", "both"),
    [
        ("-10..0 degC", ("-10 degC", "0 degC")),
        ("1000 .. 4.5e3 rpm", ("1000 rpm", "4.5e3 rpm")),
        ("0.3..2", ("0.3", "2")),
        ("4 bar..600 kPa", ("4 bar", "600 kPa")),
        ("0...5", None),
        ("..5 bar", None),
        ("5 bar", None),
    ],
)
def test_the_lower_end_of_a_range_has_the_unit_of_the_upper_one(text, both):
    assert ends_of(text) == both


def test_the_speed_beside_the_swept_volume_is_the_one_that_a_motor_on_the_mains_reaches():
    scene = screwsim.load(CONFIGS / "drive" / "induction.yaml")
    found = screwsim.simulate(scene).performance
    ((_, text),) = machine_line(scene, found)
    assert text.endswith(f" swept at {found.mean_speed * 30.0 / math.pi:.5g} rpm")
    point = Point(scene.operation.speed, Result("ok", performance=found))
    assert point.rotor_speed == found.mean_speed < 0.98 * point.speed


def test_an_expanders_oil_comes_from_a_pump_and_is_warmed_elsewhere():
    for changes, warms in (
        ([], "39.6 kW warm it again, which no efficiency counts"),
        (["effects.separator=off"], "what warms it again is not simulated (effects.separator)"),
    ):
        scene = screwsim.load(CONFIGS / "expander" / "oil.yaml", changes)
        (told,) = dict(oil_line(scene, screwsim.simulate(scene).performance)).values()
        assert told.startswith("from a pump") and told.endswith(f"at 95.0 °C; {warms}")


def test_a_sheet_shows_the_heat_of_an_expanders_oil_as_heat_it_takes():
    over = ["sweep.operation.speed=[3000 rpm]", "sweep.operation.discharge.pressure=[7 bar]"]
    scene = screwsim.load(CONFIGS / "expander" / "oil.yaml", over)
    tables = {table.title: table for table in screwsim.datasheet(scene, jobs=1).tables}
    (row,) = tables["Heat that warms the oil [kW]"].rows
    assert float(row[1].strip("*\u00a0")) == pytest.approx(39.6, abs=0.06)
