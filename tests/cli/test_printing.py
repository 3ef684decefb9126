"""Numbers for programs and for people."""

import math

import numpy as np
from each_row import each_row

from screwsim.figures import known
from screwsim.outputs import KNOCK_OUT, Figure, Figures, Result, effect_words
from screwsim.outputs.customary import SCALES, scale
from screwsim.printing import _numerics, engineering, plain, print_result
from screwsim.printing.short import print_short
from screwsim.printing.stages import print_stages
from screwsim.printing.tables import column_heads, plain_table
from screwsim.report.ledger import waterfall_bars
from screwsim.scene import load
from screwsim.scene.left_out import idle_figures
from screwsim.study.asked import figure_units
from screwsim.study.stages import ChainResult


def test_plain_values_are_those_of_json():
    given = {"a": np.float64(1.5), "b": np.int64(2), "c": math.nan, "d": [np.inf, np.bool_(True)], "e": np.arange(2.0)}
    found = plain(given)
    assert found == {"a": 1.5, "b": 2, "c": None, "d": [None, True], "e": [0.0, 1.0]}
    assert [type(value) for value in (found["a"], found["b"])] == [float, int]


@each_row(
    ("name", "value", "text"),
    [
        ("shaft_power", 61373.2, "61.373 kW"),
        ("oil_pump_power", 12.5, "12.5 W"),
        ("shaft_power", -2500.0, "-2.5 kW"),
        ("peak_pressure", 14.994e5, "14.994 bar"),
        ("isothermal_efficiency", 0.68, "68 %"),
        ("oil_ratio", 3.0, "3 "),
        ("trapped_mass", 3.9e-3, "3.9 g"),
        ("discharge_temperature", 300.0, "300.00 K (26.85 °C)"),
        ("mean_speed", 100.0 * math.pi, "3000 rpm"),
        ("twist_mean", math.pi / 180.0, "1 °"),
        ("displacement", 2112e-6, "2112 cm³"),
        ("displacement_flow", 0.1, "360 m³/h"),
        ("shaft_torque", 123.0, "123 N m"),
    ],
)
def test_figures_have_engineering_units(name, value, text):
    assert " ".join(engineering(name, value)) == text


def printed(result: Result, capsys) -> list[str]:
    """Return the lines that `run` prints of a result."""
    print_result("a title", result)
    return capsys.readouterr().out.splitlines()


def test_effects_are_named_without_their_package():
    assert [effect_words(each) for each in ("blow_hole", "my_effects.slot_leak")] == ["blow hole", "slot leak"]
    assert effect_words("tip_leakage+my_effects.slot_leak+your.seal") == "tip leakage+slot leak+seal"


def test_effects_with_the_same_words_are_told_apart_in_table_knock_out_and_waterfall(capsys):
    mine, yours = "mine.slot_leak", "yours.slot_leak"
    ledger = {"shaft_power": 1e3, "gas_exergy_rise": 7e2, "oil_exergy_rise": 50.0, "residue": 0.0}
    ledger["ambient_temperature"] = 290.0
    destroyed = {"tip_leakage": 100.0, mine: 90.0, yours: 60.0}
    ledger |= {f"exergy_destroyed_{name}": power for name, power in destroyed.items()}
    costs = [{"effect": name, "status": "ok", "message": "", **dict.fromkeys(KNOCK_OUT)} for name in destroyed]
    result = Result("ok", performance=Figures(shaft_power=1e3), ledger=Figures(**ledger), knock_out=tuple(costs))
    lines = printed(result, capsys)
    for name in (mine, yours, "tip leakage"):
        assert sum(line.startswith(f"{name} ") for line in lines) == 2  # of the ledger and of the knock-outs
    assert [bar.words for bar in waterfall_bars(ledger)][1:4] == ["tip leakage", mine, yours]


def test_the_essentials_of_a_heat_pump_have_both_coefficients(capsys):
    both = Figures(cooling_capacity=3e5, heating_capacity=4e5, cop=3.5, heating_cop=4.5)
    print_short("a title", Result("ok", performance=both))
    shown = capsys.readouterr().out
    assert "\nCOP " in shown and "\nheating COP " in shown
    electrical = Figures(**both, electrical_cop=3.0, electrical_heating_cop=4.0)
    print_short("a title", Result("ok", performance=electrical))
    shown = capsys.readouterr().out
    assert "electrical heating COP" in shown and "\nheating COP" not in shown


def test_the_essentials_name_every_change_of_the_command_line(capsys):
    changed = ["with gas.fluid=R410A", *(f"with operation.{side}_temperature=35 degC" for side in ("a", "b", "c"))]
    print_short("a title", Result("ok"), changed)
    shown = " ".join(capsys.readouterr().out.split())
    assert f"a title, changed {', '.join(changed)} status: ok" in shown


def test_the_essentials_of_a_package_have_its_outlet_absolute_and_gauge(capsys):
    hot = {"mixture_discharge_temperature": 353.15, "discharge_temperature": 350.0, "pressure_ratio": 8.0}
    figures = Figures(free_air_delivered=0.2, package_discharge_pressure=7.5e5, **hot)
    print_short("a title", Result("ok", performance=figures), ambient=1e5)
    shown = capsys.readouterr().out
    assert " 7.5 " in shown and "bar (6.5 bar(g))" in shown and "pressure ratio" not in shown
    assert shown.index("mixture discharge temperature") < shown.index("discharge temperature, gas alone")


FEW = Figures(shaft_power=1e3, displacement=2112e-6, cop=None)


def test_a_narrow_terminal_cuts_no_number(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "30")
    lines = printed(Result("ok", performance=FEW), capsys)
    assert not any("…" in line for line in lines)
    assert any(line.split()[-2:] == ["2112", "cm³"] for line in lines)


def test_warnings_stand_before_the_figures_and_are_counted_beside_the_status(capsys):
    lines = printed(Result("ok", warnings=("the first", "the second " * 9), performance=FEW), capsys)
    assert lines[:4] == ["a title", "status: ok, with 2 warnings", "warning: the first", lines[3]]
    assert lines[3].startswith("warning: the second") and lines[4].startswith("  ")
    assert lines.index("warning: the first") < next(i for i, line in enumerate(lines) if line.startswith("figure"))
    assert sum(line.startswith("warning") for line in lines) == 2


def test_a_message_follows_the_number_of_warnings(capsys):
    result = Result("not_closed", "mass 1e-3", ("one",), performance=FEW)
    assert printed(result, capsys)[1] == "status: not_closed, with 1 warning; mass 1e-3"
    assert printed(Result("ok", performance=FEW), capsys)[1] == "status: ok"


def test_a_figure_without_a_value_is_told_with_its_reason_once(capsys):
    performance = Figures(FEW, isothermal_efficiency=None, isentropic_efficiency=None)
    notes = {"cop": "no power", "isothermal_efficiency": "it leaks", "isentropic_efficiency": "it leaks"}
    lines = printed(Result("ok", performance=performance, notes=notes), capsys)
    assert lines.count("no COP: no power") == 1
    assert lines.count("no isothermal efficiency, isentropic efficiency: it leaks") == 1


@each_row("units", sorted({about.units for about in known().values()} - {"1", "K", "Hz"}))
def test_every_unit_of_a_figure_has_a_customary_one(units):
    assert scale(units, 1.0)[1] not in ("rad", "rad s-1", "m3", "m3 s-1", "W s m-3", "J m-3", "kg s-1")
    assert units in SCALES


def test_warnings_of_two_stages_name_their_stage(capsys):
    """Told like those of one scene, before the figures."""
    stages = (Result("ok", warnings=("too much oil",)), Result("ok"))
    print_stages("", ChainResult("ok", stages=stages, performance=Figures(shaft_power=1.0), warnings=("of both",)))
    lines = capsys.readouterr().out.splitlines()
    assert lines[:3] == ["status: ok", "warning: of both", "warning: first stage: too much oil"]


def test_figures_of_two_stages_stand_beside_their_errors(capsys):
    whole = Figures(shaft_power=1e3, flow_mismatch=1e-6)
    print_stages("", ChainResult("ok", performance=whole, error=Figures(shaft_power=2.5e-4, flow_mismatch=None)))
    lines = capsys.readouterr().out.splitlines()
    assert [line.split() for line in lines[1:]] == [
        ["error"],
        ["shaft", "power", "1", "kW", "2.5e-04"],
        ["flow", "mismatch", "1e-06"],
    ]


def test_a_machine_through_which_more_flows_back_says_so_in_its_first_line(capsys):
    lines = printed(Result("ok", performance=Figures(FEW, volumetric_efficiency=-0.0321)), capsys)
    assert lines[1] == "status: ok; the volumetric efficiency is -0.0321: more gas flows back than is"
    assert "more flows back" not in "\n".join(printed(Result("ok", performance=Figures(FEW)), capsys))


def test_a_case_that_failed_before_it_was_integrated_has_no_line_on_numerics(capsys):
    """It was a head without a word behind it."""
    assert not any(line.startswith("numerics") for line in printed(Result("failed", "no such state"), capsys))


def test_what_is_left_out_stands_below_the_numerics(capsys):
    print_result("a title", Result("ok", performance=Figures(FEW)), ["leaks simulated: tip only; typical scenes name"])
    assert capsys.readouterr().out.splitlines()[-1] == "leaks simulated: tip only; typical scenes name"


def test_a_name_that_leaves_its_row_no_room_stands_above_it():
    rows = [("short.name", *["123.45"] * 6), ("effects.separator.cooler.discharge_temperature", *["+0.12345"] * 6)]
    lines = plain_table(["", *["head"] * 6], rows, 1)
    assert max(map(len, lines)) <= 80 and len(lines) == 4
    assert lines[2] == "effects.separator.cooler.discharge_temperature"
    assert lines[1].split() == list(rows[0]) and lines[3].split() == list(rows[1][1:])
    assert {len(line) for line in (lines[0], lines[1], lines[3])} == {len(lines[0])}


def test_what_fits_stays_in_one_line():
    lines = plain_table(["", "head"], [("a" * 60, "1"), ("b", "2")], 1)
    assert [len(line.split()) for line in lines] == [1, 2, 2]


def test_no_temperature_is_minus_nothing():
    """273.15 K less a rounding is 0.00 °C, and what lies below keeps its sign."""
    assert engineering("evaporating_temperature", 273.15 - 1e-9) == ("273.15", "K (0.00 °C)")
    assert engineering("evaporating_temperature", 273.14) == ("273.14", "K (-0.01 °C)")


def test_one_of_a_count_is_said_as_one():
    assert _numerics({"turns": 1.0, "steps": 2}) == "numerics: 1 turn, 2 steps"


@each_row(
    ("paths", "heads"),
    [
        (["operation.speed"], ["speed"]),
        (["operation.suction.pressure", "operation.discharge.pressure"], ["suction pressure", "discharge pressure"]),
        (["first.operation.speed", "second.operation.speed"], ["first speed", "second speed"]),
        (["first.operation.speed", "oil_supply.ratio"], ["speed", "ratio"]),
        (
            ["first.a.gap_width", "first.b.gap_width", "second.a.gap_width"],
            ["first a gap width", "first b gap width", "second a gap width"],
        ),
    ],
)
def test_columns_of_paths_have_different_heads(paths, heads):
    assert column_heads(paths) == heads


def test_the_cop_of_catalogues_comes_first_and_that_of_the_shaft_is_called_so(capsys):
    both = Figures(cop=4.37, heating_cop=5.46, electrical_cop=4.03, electrical_heating_cop=5.03)
    lines = printed(Result("ok", performance=both), capsys)
    names = [line.rsplit(maxsplit=1)[0].strip() for line in lines if "COP" in line and ":" not in line]
    assert names == ["electrical COP", "COP, shaft power", "electrical heating COP", "heating COP, shaft power"]
    assert any(line.startswith("heating COP, shaft power: the capacity has heat that is not in") for line in lines)
    shaft = "\n".join(printed(Result("ok", performance=Figures(cop=4.37, heating_cop=5.37)), capsys))
    assert "\nCOP " in shaft and "shaft power" not in shaft


def test_the_duty_of_a_cooler_that_a_scene_lacks_is_left_out(capsys):
    duty = Result("ok", performance=Figures(FEW, oil_cooler_duty=0.0))
    for override, shown in (("null", False), ("{discharge_temperature: 60 degC}", True)):
        scene = load("configs/r134a/separator.yaml", [f"effects.separator.cooler={override}"])
        print_result("a title", duty, idle=idle_figures(scene))
        assert ("oil cooler duty" in capsys.readouterr().out) == shown


def test_the_quality_of_gas_that_leaves_dry_is_left_out(capsys):
    scene = load("configs/ammonia/flooded.yaml")
    for quality, shown in ((1.0, False), (0.95, True), (0.0, True)):
        print_result(
            "a title", Result("ok", performance=Figures(FEW, discharge_quality=quality)), idle=idle_figures(scene)
        )
        assert ("discharge quality" in capsys.readouterr().out) == shown


def test_effects_without_which_there_is_no_solution_are_told_in_one_line(capsys):
    no = {"message": "7:3: needs what is left out", **dict.fromkeys(KNOCK_OUT)}
    there = dict.fromkeys(KNOCK_OUT, 1.0)
    costs = (
        {**no, "effect": "suction_port", "status": "failed"},
        {**no, "effect": "droplets", "status": "needed"},
        {**no, "effect": "separator", "status": "needed"},
        {**there, "effect": "motor", "status": "ok", "message": "a doubt"},
    )
    out = printed(Result("ok", performance=Figures(shaft_power=1e3), knock_out=costs), capsys)
    told = "no solution without suction_port (failed); droplets, separator (needed): run with --without NAME says why"
    assert told in " ".join(" ".join(out).split()) and "without motor: a doubt" in out
    assert "needs what is left out" not in "\n".join(out)


@each_row(("units", "printed", "written"), [("W m-2", "W/m²", "W/m^2"), ("Pa s3 K-1", "Pa s³/K", "Pa s^3/K")])
def test_a_unit_that_only_an_effect_of_ones_own_has_needs_no_table(units, printed, written, monkeypatch):
    figure = Figure("flux", units, "flux through the skin")
    assert engineering(figure, 12.0) == ("12", printed)
    monkeypatch.setattr(figure_units, "declared", lambda name: figure)
    assert figure_units.units_of("flux")[written] == 1.0
