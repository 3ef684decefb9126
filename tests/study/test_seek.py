"""Goal seek: values that meet goals with their error, in few solutions; and what is said where none exists."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from each_row import each_row
from seek_fakes import RPM, edged, figures_of, leaping, saturating, torn, turning
from study_fakes import scene

import screwsim
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.scene import loads, value_at, with_values
from screwsim.study.asked.goals import read_bounds, read_figure, read_goals
from screwsim.study.scene_files import write_found
from screwsim.study.seek import find, find_each, question
from screwsim.study.uncertainty.slopes import Sensitivities
from screwsim.template import new_scene, request_of

SPEED = "operation.speed"
RANGE = f"{SPEED}=1000 rpm..5000 rpm"
CONFIGS = Path(__file__).parents[2] / "configs"


@pytest.mark.parametrize("flow", [0.8, 1.2, 1.8])
def test_one_goal_is_met_within_its_error_in_few_solutions(flow):
    found = find(scene(), [RANGE], [f"gas_mass_flow={flow} kg/s"], simulate=saturating)
    n = -2000.0 * RPM * math.log(1.0 - 0.5 * flow)
    assert (found.status, found.failed) == ("ok", 0)
    # half the figure's error, 1e-6 of it, over the slope 2 exp(-n/2000)/2000 per rpm
    assert found.values[SPEED] == pytest.approx(n, abs=0.5e-6 * flow / (1.0 - 0.5 * flow) * 2000.0 * RPM + 1e-6 * n)
    assert found.solutions <= 9
    assert found.result.performance.gas_mass_flow == pytest.approx(flow, abs=1e-6 * flow)


@pytest.mark.parametrize("power", [23.0, 28.0, 28.5])
def test_a_figure_without_numerical_error_does_not_jump_over_its_goal(power):
    """It is a law of the input alone, as a pressure of a condensing temperature; it "jumped" from 23 to 23 kW."""

    def exact(scene):
        found = saturating(scene)
        return replace(found, error=Figures(dict.fromkeys(found.error, 0.0)))

    found = find(scene(), [RANGE], [f"shaft_power={power} kW"], simulate=exact)
    assert found.status == "ok" and found.figures["shaft_power"] == pytest.approx(1e3 * power, rel=1e-6)


def test_the_error_of_a_value_is_that_of_the_figure_over_its_slope():
    found = find(scene(), [RANGE], ["gas_mass_flow=1.2 kg/s"], simulate=saturating)
    error, slope = 1.2e-6, (2.0 - 1.2) / (2000.0 * RPM)
    # the slope is that to the nearest solution that is clearly another
    assert found.uncertainties[SPEED] == pytest.approx(error / slope, rel=0.1)


def test_two_goals_are_met_together():
    # 0.4 kg/s: n = 446.3 rpm would be below the range
    goals = ["gas_mass_flow=1.2 kg/s", "discharge_temperature=60 degC"]
    found = find(scene(), [RANGE, "oil_supply.ratio=0.5..5"], goals, simulate=saturating)
    assert found.status == "ok" and found.solutions < 40
    assert found.values["oil_supply.ratio"] == pytest.approx(40.0 / 33.15, rel=1e-4)
    assert found.values[SPEED] == pytest.approx(-2000.0 * RPM * math.log(0.4), rel=1e-5)
    # d = 40/(T - 300): one per mille of the error of T over its slope
    assert found.uncertainties["oil_supply.ratio"] == pytest.approx(333.15e-6 * (40.0 / 33.15) ** 2 / 40.0, rel=0.1)


def test_a_goal_above_zero_of_a_power_that_is_given_off_is_told_its_sign():
    def giving(one):
        return Result(
            "ok", performance=Figures(shaft_power=-20.0 * one.operation.speed), error=Figures(shaft_power=1e-6)
        )

    found = find(scene(), [RANGE], ["shaft_power=2 kW"], simulate=giving)
    assert found.status == "none"
    assert found.message.endswith(" (shaft power is below zero throughout: write e.g. shaft_power=-2 kW)")


def test_a_goal_beyond_the_range_is_said_with_how_far_the_search_came():
    found = find(scene(), [RANGE], ["gas_mass_flow=1.9 kg/s"], simulate=saturating)
    assert (found.status, found.borders) == ("none", {SPEED: "upper border"})
    assert found.values[SPEED] == pytest.approx(5000.0 * RPM)
    shown = f"{2.0 * (1.0 - math.exp(-2.5)):.5g} kg/s"
    assert f"the nearest is {shown}, at operation.speed 5000 rpm, its upper border (widen the range)" in found.message
    assert found.solutions <= 12


def test_of_a_border_beyond_which_nothing_is_simulated_it_is_said_in_place_of_widen():
    """`torn` has no solution from 2500 rpm on, where it would reach 0.833 kg/s."""
    found = find(scene(), [f"{SPEED}=1000 rpm..2490 rpm"], ["gas_mass_flow=0.9 kg/s"], simulate=torn)
    assert (found.status, found.borders) == ("none", {SPEED: "upper border"})
    end = "its upper border, and beyond there is no solution: failed: pressure left the range (choose a smaller gap)"
    assert found.message.endswith(end)


def test_a_figure_that_turns_before_its_goal_is_followed_to_where_it_turns():
    found = find(scene(), [RANGE], ["gas_mass_flow=1.01 kg/s"], simulate=turning)
    assert (found.status, found.borders) == ("none", {})
    # a parabola's top, 3000 rpm, known to a thousandth of the range
    assert found.values[SPEED] / RPM == pytest.approx(3000.0, abs=10.0)
    assert "change what else limits it" in found.message


def test_a_goal_on_both_sides_of_a_turn_is_met():
    found = find(scene(), [RANGE], ["gas_mass_flow=0.99 kg/s"], simulate=turning)
    assert found.status == "ok"
    assert abs(found.values[SPEED] / RPM - 3000.0) == pytest.approx(300.0, rel=1e-4)


def test_a_figure_that_does_not_depend_on_the_path_is_said():
    found = find(scene(), ["oil.viscosity=10 mPa s..30 mPa s"], ["gas_mass_flow=2 kg/s"], simulate=turning)
    assert found.status == "none" and found.solutions < 12
    assert found.message.endswith("it is 1 kg/s throughout (vary something it depends on)")


def test_a_leap_over_the_goal_is_said():
    found = find(scene(), [RANGE], ["gas_mass_flow=1 kg/s"], simulate=leaping)
    assert found.status == "none"
    assert "it jumps from 0.53 kg/s at 3000 rpm to 1.53 kg/s at 3000 rpm" in found.message


@pytest.mark.parametrize(("flow", "status"), [(1.2, "ok"), (0.7, "ok"), (1.0, "none")])
def test_failing_solutions_on_the_way_are_gone_round(flow, status):
    found = find(scene(), [RANGE], [f"gas_mass_flow={flow} kg/s"], simulate=torn)
    assert found.status == status
    if status == "ok":
        assert found.values[SPEED] / RPM == pytest.approx(3000.0 * flow, rel=1e-5)
    else:
        assert "where solutions fail: failed: pressure left the range" in found.message


@pytest.mark.parametrize("speed", [2450.0, 2490.0])
def test_a_goal_just_before_values_that_fail_is_met(speed):
    goal = 2.0 - (speed / 2500.0) ** 4
    found = find(scene(), [RANGE], [f"gas_mass_flow={goal} kg/s"], simulate=edged)
    assert found.status == "ok"
    assert found.values[SPEED] / RPM == pytest.approx(speed, rel=1e-5)


def test_a_goal_beyond_values_that_fail_is_said_at_their_edge():
    found = find(scene(), [RANGE], ["gas_mass_flow=0.9 kg/s"], simulate=edged)
    assert (found.status, found.borders) == ("none", {})
    assert found.values[SPEED] / RPM == pytest.approx(2500.0, abs=5.0)  # a thousandth of the range
    assert "rpm, next to values that fail (change what else limits it); " in found.message


def test_without_a_range_it_is_the_axis_or_what_machines_have():
    with_axis = scene("sweep:\n  operation.speed: [2000 rpm, 4000 rpm]\n")
    (span,) = question(with_axis, [SPEED], ["gas_mass_flow=1 kg/s"]).spans
    assert (span.low / RPM, span.high / RPM) == pytest.approx((2000.0, 4000.0))
    (span,) = question(scene(), [SPEED], ["gas_mass_flow=1 kg/s"]).spans
    # at most 150 m/s at the tips of the rotors, or twenty times the scene's speed
    tips = 150.0 / scene().machine.surface_speed(1.0)
    assert span.high == pytest.approx(min(tips, 20.0 * scene().operation.speed))


def test_a_path_at_zero_has_the_range_of_its_limits():
    machine = loads(new_scene("refrigeration", request_of(slide=True)))
    asked = question(machine, ["machine.slide_valve.position"], ["cooling_capacity=100 kW"])
    assert [(span.low, span.high, span.start) for span in asked.spans] == [(0.0, 1.0, 0.0)]


def test_a_path_at_zero_whose_limits_are_far_beyond_what_machines_have_needs_a_range():
    sealed = with_values(scene(), {"effects.tip_leakage.flow_coefficient": 0.0})
    with pytest.raises(UsageError, match="has no range"):
        question(sealed, ["effects.tip_leakage.flow_coefficient"], ["shaft_power=21 kW"])


def test_each_point_of_the_other_axes_has_its_answer():
    swept = scene("sweep:\n  oil_supply.ratio: [1, 2]\n")
    rows = find_each(swept, question(swept, [RANGE], ["shaft_power=21 kW"]), jobs=1, simulate=saturating)
    assert [row.at["oil_supply.ratio"] for row in rows] == [1.0, 2.0]
    speeds = [2000.0 * math.sqrt((21.0 - d) / 10.0) for d in (1.0, 2.0)]
    assert [row.values[SPEED] / RPM for row in rows] == pytest.approx(speeds, rel=1e-5)


def test_the_next_size_of_a_catalogue_is_taken():
    sizes = "1500, 2200, 3000, 4000 rpm"
    found = find(scene(), [SPEED], ["gas_mass_flow=1.2 kg/s"], catalogue=sizes, simulate=saturating)
    assert found.values[SPEED] / RPM == pytest.approx(-2000.0 * math.log(0.4), rel=1e-5)  # 1833 rpm
    assert found.size.value / RPM == pytest.approx(2200.0)
    assert found.size.figure == pytest.approx(2.0 * (1.0 - math.exp(-1.1)))
    assert found.scene.operation.speed == found.size.value


@pytest.mark.parametrize(("flow", "size"), [(0.5, 1500.0), (1.9, None)])
def test_a_goal_below_the_smallest_size_takes_it_and_one_above_the_largest_none(flow, size):
    found = find(scene(), [SPEED], [f"gas_mass_flow={flow} kg/s"], catalogue="1500,3000 rpm", simulate=saturating)
    assert found.status == ("none" if size is None else "ok")
    if size is None:
        assert found.message.startswith("no size in the catalogue, up to 3000 rpm, meets the goal")
    else:
        assert found.size.value / RPM == pytest.approx(size)


@pytest.mark.parametrize("flow", [0.5, 1.9])
def test_no_size_meets_a_goal_of_a_figure_that_the_size_does_nothing_to(flow):
    def flat(one):  # falls by less than its error
        return figures_of(one, gas_mass_flow=1.0 - 1e-11 * one.operation.speed / RPM)

    goals = [f"gas_mass_flow={flow} kg/s"]
    found = find(scene(), [SPEED], goals, catalogue="1500,3000 rpm", simulate=flat)
    assert (found.status, found.size) == ("none", None)
    assert "it is 1 kg/s throughout (vary something it depends on)" in found.message


@each_row(
    ("vary", "goals", "message"),
    [
        ([RANGE], ["gas_mas_flow=1 kg/s"], "--for gas_mas_flow: is not known; did you mean 'gas_mass_flow'?"),
        (
            [RANGE],
            ["shaft_power=20 tons"],
            "--for shaft_power=20 tons: unit 'tons' is not known (write refrigeration_ton",
        ),
        ([RANGE], ["gas_mass_flow=1 kW"], "--for gas_mass_flow=1 kW: gas_mass_flow has no unit 'kW' (write one of kg"),
        ([RANGE], ["gas_mass_flow=1"], "--for gas_mass_flow=1: gas_mass_flow 1 has no unit (write one of kg/s"),
        (
            [RANGE],
            ["specific_power=6 kW/m3/min"],
            "--for specific_power=6 kW/m3/min: specific_power has no unit 'kW/m3/mi",
        ),
        ([RANGE], ["peak_pressure=100 psia"], "--for peak_pressure=100 psia: unit 'psia' is not known (write psi)"),
        (
            [RANGE],
            ["displacement_flow=9 scfm"],
            "--for displacement_flow=9 scfm: unit 'scfm' counts gas at a standard state",
        ),
        ([RANGE], ["shaft_power=9 MMBtu/h"], "--for shaft_power=9 MMBtu/h: unit 'MMBtu/h' is in a million Btu"),
        ([RANGE], ["shaft_power=9 HP"], "--for shaft_power=9 HP: unit 'HP' is not known (write hp)"),
        ([RANGE], ["gas_mass_flow"], "--for gas_mass_flow: is not FIGURE=VALUE (write e.g. --for 'cooling_capacity="),
        ([RANGE], ["gas ma flow=1 kg/s"], "--for gas ma flow: is not known; did you mean 'gas_mass_flow'?"),
        (
            [RANGE],
            ["volumetric_efficiency=85"],
            "--for volumetric_efficiency=85: volumetric_efficiency 85 is 8500 %",
        ),
        ([RANGE], [], "no goal is given (write --for FIGURE=VALUE"),
        ([], ["gas_mass_flow=1 kg/s"], "nothing varies (write one or more --vary"),
        (["operation.sped"], ["gas_mass_flow=1 kg/s"], "operation.sped: is not known; did you mean 'operation.speed'?"),
        (["machine.male_lobes=3..5"], ["gas_mass_flow=1 kg/s"], "machine.male_lobes: is a whole number"),
        ([f"{SPEED}=3000 rpm..2000 rpm"], ["gas_mass_flow=1 kg/s"], "--vary operation.speed: the range 3000 rpm"),
        ([f"{SPEED}=3000 rpm"], ["gas_mass_flow=1 kg/s"], "--vary operation.speed=3000 rpm: is not PATH=LOW..HIGH"),
        ([RANGE, "oil_supply.ratio=1..2"], ["gas_mass_flow=1 kg/s"], "--vary: 2 paths vary for 1 goal (vary as many"),
        ([RANGE], ["gas_mass_flow=1 kg/s", "shaft_power=9 kW"], "--for: 2 goals for 1 varied paths (vary as many"),
        ([RANGE], ["cooling_capacity=9 kW"], "--for cooling_capacity: is not a figure of this scene: it needs"),
        ([], [], "no goal is given (write --for FIGURE=VALUE"),
        ({}, {}, "no goal is given (write --for FIGURE=VALUE"),
    ],
)
def test_a_wrong_question_is_refused_in_one_line(vary, goals, message):
    with pytest.raises(UsageError) as refusal:
        question(scene(), vary, goals)
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)


@each_row(
    ("figure", "stated", "value"),
    [
        ("specific_power", "6.5 kW/(m3/min)", 6.5 * 60e3),  # 1 kW/(m³/min) = 1000 W/(1 m³/60 s)
        ("specific_power", "6.5 kW/(m³/min)", 6.5 * 60e3),
        ("shaft_power", "100 hp", 100.0 * 550.0 * 0.3048 * 0.45359237 * 9.80665),  # 550 ft lbf/s
        ("gas_mass_flow", "30 lb/min", 30.0 * 0.45359237 / 60.0),
        (
            "specific_power",
            "20 hp/(100 cfm)",
            20.0 * 550.0 * 0.3048 * 0.45359237 * 9.80665 / (100.0 * 0.3048**3 / 60.0),
        ),
        ("gas_mass_flow", "1500 lb/h", 1500.0 * 0.45359237 / 3600.0),
        ("displacement_flow", "700 ft^3/min", 700.0 * 0.3048**3 / 60.0),
        ("displacement_flow", "700 CFM", 700.0 * 0.3048**3 / 60.0),
        ("peak_pressure", "100 psi", 100.0 * 0.45359237 * 9.80665 / 0.0254**2),
        ("discharge_temperature", "194 degF", 363.15),
        ("discharge_temperature", "90 ℃", 363.15),
        ("tip_gap", "50 µm", 50e-6),
        ("trapped_mass", "3 mg", 3e-6),
    ],
)
def test_a_goal_has_any_unit_of_the_dimension_of_its_figure(figure, stated, value):
    assert read_figure(figure, stated, "--for") == pytest.approx(value, rel=1e-12)


def test_a_goal_and_a_bound_of_a_gauge_are_over_the_scenes_ambient_pressure():
    high = with_values(scene(), {"operation.ambient_pressure": 0.9e5})
    (goal,) = read_goals(high, ["peak_pressure=7 bar(g)"])
    (bound,) = read_bounds(high, ["peak_pressure<7 barg"])
    assert goal.value == bound.value == pytest.approx(7.9e5, rel=1e-12)
    (named,) = question(high, [RANGE], {"peak_pressure": "7 barg"}).goals
    assert named == goal


@pytest.mark.parametrize("overrides", [[], ["oil_supply.ratio=2", "effects.interlobe_leakage=off"]])
def test_the_scene_found_is_written_over_its_base(tmp_path, overrides):
    file = CONFIGS / "paper" / "point.yaml"
    one = screwsim.load(file, overrides, ["blow_hole"])
    found = find(one, [RANGE], ["gas_mass_flow=1.2 kg/s"], simulate=saturating)
    path = tmp_path / "found.yaml"
    write_found(path, found.scene, found.values, str(file), overrides, ["blow_hole"], "find point.yaml")
    text = path.read_text()
    assert "base:" in text and text.startswith("# Found by: screwsim find point.yaml\n")
    assert screwsim.load(path).text == found.scene.text


def test_a_machine_gives_the_capacity_that_was_sought():
    one = screwsim.load(Path(__file__).parents[1] / "plain" / "r134a.yaml")
    before = screwsim.simulate(one).performance.cooling_capacity
    found = find(one, [SPEED], {"cooling_capacity": 1.1 * before})
    again = screwsim.simulate(found.scene)
    # a solution that begins from another differs by less than the accuracy asked for
    assert again.performance.cooling_capacity == pytest.approx(1.1 * before, rel=3e-4)
    assert found.solutions < 8


def test_a_scene_of_another_size_says_so_in_its_title(tmp_path):
    """The title of a new scene has the size that was asked for; of a machine that was sized anew that is not true."""
    from screwsim.scene import with_values

    base = tmp_path / "machine.yaml"
    base.write_text(new_scene("refrigeration", request_of(displacement="600 m^3/h")), encoding="utf-8")
    values = {"machine.displacement.flow": 1250.0 / 3600.0}
    path = tmp_path / "sized.yaml"
    write_found(path, with_values(screwsim.load(base), values), values, str(base), [], [], "find machine.yaml")
    again = screwsim.load(path)
    assert again.title.endswith("600 m^3/h at 2950 rpm; resized: machine.displacement.flow = 1250 m^3/h")
    assert again.machine.displacement.flow == pytest.approx(1250.0 / 3600.0, rel=1e-12)


def test_the_uncertainty_of_a_value_by_tolerances_is_that_of_other_searches():
    gaps = ("effects.tip_leakage.gap", "effects.interlobe_leakage.gap")
    stated = {"oil_supply.ratio": "3 ± 10 %", gaps[0]: "27.5 um ± 5 um", gaps[1]: "29.5 um ± 5 um"}
    tolerant = screwsim.load(
        CONFIGS / "paper/point.yaml",
        [
            *(f"{path}={text}" for path, text in stated.items()),
            f"{SPEED}=1000 rpm ± 1 %",  # of what is sought: it has no part
            f"uncertainty.correlated=[[{gaps[0]}, {gaps[1]}]]",
            "numerics.accuracy=1e-6",
        ],
    )

    def sought(changed: dict[str, float]):
        goals = ["gas_mass_flow=0.3 kg/s", "discharge_temperature=15 degC"]
        vary = [f"{SPEED}=1000 rpm..3000 rpm", "oil_supply.temperature=275 K..300 K"]
        return find(with_values(tolerant, changed), vary, goals, progress=False)

    found = sought({})
    for path, spread in found.by_inputs.items():
        assert {each.paths for each in spread.contributors} == {gaps, ("oil_supply.ratio",)}
        for each in spread.contributors:
            standard = {one: tolerant.uncertain[one].standard_at(float(value_at(tolerant, one))) for one in each.paths}
            ends = []
            for way in (0.5, -0.5):
                off = {one: float(value_at(tolerant, one)) + way * size for one, size in standard.items()}
                ends.append(sought(off).values[path])
            assert each.change == pytest.approx(2.0 * (ends[0] - ends[1]), rel=0.02)
    assert set(found.by_inputs) == set(found.values)


def test_an_input_without_a_derivative_is_left_out_of_what_the_others_do_and_named(monkeypatch):
    """No input had a part in it then."""
    gap, ratio = "effects.tip_leakage.gap", "oil_supply.ratio"
    tolerant = scene().with_({gap: "50 um ± 10 um", ratio: "3 ± 10 %"})
    slopes = {"gas_mass_flow": {SPEED: 1e-3, gap: -2e3}}
    known = Sensitivities(Result("ok"), {SPEED: 100.0, gap: 50e-6}, derivatives=slopes, left_out={ratio: "too hot"})
    performance = Figures(gas_mass_flow=1.2)
    known = replace(known, result=Result("ok", performance=performance))
    monkeypatch.setattr("screwsim.study.uncertainty.point.sensitivities", lambda *asked, **more: known)
    found = find(tolerant, [RANGE], ["gas_mass_flow=1.2 kg/s"], simulate=saturating)
    assert found.by_inputs[SPEED].standard == pytest.approx(2e3 * 5e-6 / 1e-3)
    assert found.message == f"the tolerance of {ratio} is not included in the uncertainties: too hot"


def test_without_tolerances_of_others_a_value_has_none_by_them():
    tolerant = scene().with_({SPEED: "1000 rpm ± 1 %"})
    found = find(tolerant, [RANGE], ["gas_mass_flow=1.2 kg/s"], simulate=saturating)
    assert (found.by_inputs, found.message) == ({}, "")
