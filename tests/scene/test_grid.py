"""Rules of a sweep: paths and values are checked like the fields, cases are made on demand."""

import math
from pathlib import Path

import pytest
from each_row import each_row

from screwsim.inputs.faults import SceneError, UsageError
from screwsim.scene import (
    case,
    case_count,
    case_values,
    cross_check,
    leaf_of,
    load,
    loads,
    read_value,
    value_at,
    with_values,
)
from screwsim.scene.fields import leaves_of, varies
from screwsim.scene.grid import unit_of


def swept(example, sweep):
    return loads(f"sweep: {sweep}\n{example}", "x.yaml")


def faults_of(example, sweep):
    with pytest.raises(SceneError) as error:
        swept(example, sweep)
    return error.value.lines


def test_axes_keep_their_order_and_are_in_si(example):
    scene = swept(example, "{oil_supply.ratio: [1, 2.5], operation.suction.temperature: [10 degC]}")
    assert scene.sweep == {"oil_supply.ratio": (1.0, 2.5), "operation.suction.temperature": (283.15,)}
    assert list(scene.sweep) == ["oil_supply.ratio", "operation.suction.temperature"]


def test_the_last_axis_runs_fastest(example):
    scene = swept(example, "{oil_supply.ratio: [1, 2], machine.male_lobes: [3, 4, 5]}")
    assert case_count(scene) == 6
    assert [tuple(case_values(scene, index).values()) for index in range(6)] == [
        (1.0, 3),
        (1.0, 4),
        (1.0, 5),
        (2.0, 3),
        (2.0, 4),
        (2.0, 5),
    ]


def test_a_scene_without_a_sweep_is_one_case(example):
    assert case_count(loads(example)) == 1
    assert case(loads(example), 0).machine == loads(example).machine


def test_a_case_has_its_values_and_no_sweep(example):
    scene = swept(example, "{oil_supply.ratio: [1, 2], effects.oil_heat.droplet_radius: [1 mm, 2 mm]}")
    one = case(scene, 3)
    assert (one.oil_supply.ratio, one.effects["oil_heat"].parameters.droplet_radius) == (2.0, 2e-3)
    assert one.sweep == {}
    assert scene.oil_supply.ratio == 3.0


def test_a_case_outside_the_grid_is_refused(example):
    with pytest.raises(IndexError):
        case(loads(example), 1)


def test_a_huge_grid_costs_nothing_until_asked(example):
    axis = "{from: 0.001, to: 5, count: 100000}"
    scene = swept(
        example, f"{{oil_supply.ratio: {axis}, effects.oil_pump.efficiency: [0.5], gas.isentropic_exponent: [1.2]}}"
    )
    assert case_count(scene) == 100_000
    assert case(scene, 99_999).oil_supply.ratio == 5.0


def test_a_linear_range_is_even_in_the_unit_and_hits_its_ends(example):
    speeds = swept(example, "{operation.speed: {from: 1000 rpm, to: 3000 rpm, count: 5}}").sweep["operation.speed"]
    assert [f"{speed * 30 / math.pi:.10g}" for speed in speeds] == ["1000", "1500", "2000", "2500", "3000"]


def test_a_log_range_has_equal_ratios(example):
    sweep = "{oil_supply.ratio: {from: 1, to: 1000, count: 4, spacing: log}}"
    assert swept(example, sweep).sweep["oil_supply.ratio"] == (1.0, 10.0, 100.0, 1000.0)


def test_a_range_of_one_is_its_beginning(example):
    assert swept(example, "{oil_supply.ratio: {from: 2, to: 3, count: 1}}").sweep == {"oil_supply.ratio": (2.0,)}


def test_a_choice_is_swept_by_its_words(example):
    scene = swept(example, "{oil.transport: [paper, carried]}")
    assert case(scene, 1).oil.transport == "carried"


@each_row(
    ("sweep", "line"),
    [
        ("[1]", "x.yaml:1:8: sweep: a list is not a mapping (write e.g. operation.speed: [1000 rpm, 2000 rpm])"),
        (
            "{operation.sped: [1]}",
            "x.yaml:1:9: sweep.operation.sped: is not known; did you mean 'operation.speed'?",
        ),
        (
            "{operation: [1]}",
            "x.yaml:1:9: sweep.operation: is a section, not a value (write e.g. operation.speed)",
        ),
        (
            "{title: [a]}",
            "x.yaml:1:9: sweep.title: cannot be varied (only quantities, numbers, choices and the fluid can)",
        ),
        (
            "{operation.speed: [1000 rpm, 2 bar]}",
            "x.yaml:1:37: sweep.operation.speed: '2 bar' is not a speed (write e.g. '3000 rpm')",
        ),
        (
            "{oil_supply.ratio: [1, -2]}",
            "x.yaml:1:31: sweep.oil_supply.ratio: -2 is out of range (it must be at least 0)",
        ),
        (
            "{oil_supply.ratio: [1, 1.0]}",
            "x.yaml:1:27: sweep.oil_supply.ratio: has 1 twice (remove one)",
        ),
        ("{oil_supply.ratio: []}", "x.yaml:1:27: sweep.oil_supply.ratio: has no values (write e.g. [1, 2])"),
        (
            "{oil_supply.ratio: 3}",
            "x.yaml:1:27: sweep.oil_supply.ratio: 3 is neither a list nor {from, to, count} (write e.g. [1, 2])",
        ),
        (
            "{oil_supply.ratio: {from: 1, to: 2, count: 0}}",
            "x.yaml:1:51: sweep.oil_supply.ratio.count: 0 is out of range (it must be at least 1 and at most 100000)",
        ),
        (
            "{oil_supply.ratio: {from: 1, to: 2}}",
            "x.yaml:1:9: sweep.oil_supply.ratio.count: is missing (write {from: …, to: …, count: …})",
        ),
        (
            "{oil_supply.ratio: {from: 0, to: 2, count: 3, spacing: log}}",
            "x.yaml:1:27: sweep.oil_supply.ratio: log spacing needs ends above zero "
            "(choose others, or spacing: linear)",
        ),
        (
            "{machine.male_lobes: {from: 4, to: 6, count: 4}}",
            "x.yaml:1:29: sweep.machine.male_lobes: does not give whole numbers (change count, or write a list)",
        ),
    ],
)
def test_an_axis_is_checked_like_its_field(example, sweep, line):
    assert faults_of(example, sweep) == [line]


def test_a_path_of_an_inactive_effect_is_refused(example):
    text = example.replace("  blow_hole: {area: 6 mm^2}\n", "")
    assert faults_of(text, "{effects.blow_hole.area: [1 mm^2]}") == [
        "x.yaml:1:9: sweep.effects.blow_hole.area: the effect blow_hole is not active "
        "(name it under effects, or remove this axis)"
    ]


def test_a_path_of_an_absent_section_is_refused(example):
    text = example[: example.index("oil_supply:")] + "effects:\n  tip_leakage: {gap: 1 mm}\n"
    assert faults_of(text, "{oil_supply.ratio: [1]}") == [
        "x.yaml:1:9: sweep.oil_supply.ratio: the section oil_supply is not in this scene (write it first)"
    ]


def test_values_that_do_not_fit_together_are_found_per_case(example):
    scene = swept(example, "{operation.discharge.pressure: [1 bar, 12 bar]}")
    assert [fault.path for fault in cross_check(case(scene, 0))] == ["operation.discharge.pressure"]
    assert cross_check(case(scene, 1)) == []


def test_other_values_leave_the_rest_alone(example):
    scene = loads(example)
    changed = with_values(scene, {"operation.suction.pressure": 2e5, "numerics.accuracy": 1e-3})
    assert value_at(changed, "operation.suction.pressure") == 2e5
    assert changed.numerics.accuracy == 1e-3
    assert changed.machine is scene.machine
    assert scene.operation.suction.pressure == 1.5e5


def test_axes_have_units_for_files(example):
    scene = loads(example)
    assert unit_of(leaf_of(scene, "operation.speed")) == "rad/s"
    assert unit_of(leaf_of(scene, "oil_supply.ratio")) == unit_of(leaf_of(scene, "machine.male_lobes")) == "1"
    assert unit_of(leaf_of(scene, "oil.transport")) == ""


def test_a_value_for_a_path_is_read_and_checked(example):
    scene = loads(example)
    assert read_value(scene, "operation.discharge.pressure", "9 bar") == 9e5
    with pytest.raises(UsageError, match=r"^operation\.speed: 3 has no unit"):
        read_value(scene, "operation.speed", 3)
    with pytest.raises(UsageError, match=r"^operation\.sped: is not known; did you mean 'operation\.speed'\?$"):
        leaf_of(scene, "operation.sped")


DRIVE = Path(__file__).parents[2] / "configs" / "drive" / "point.yaml"


def test_a_parameter_in_a_section_of_an_effect_is_varied():
    path = "effects.drive.coupling.linear.spring"
    scene = load(DRIVE, [f"sweep.{path}=[2 kN m/rad, 9 kN m/rad]"])
    assert [value_at(case(scene, i), path) for i in range(2)] == [2000.0, 9000.0]
    assert value_at(case(scene, 0), "effects.drive.coupling.damping") == 6.0
    assert value_at(scene, "effects.drive.coupling.rubber_cord.cords") is None


def test_a_section_of_an_effect_that_is_not_there_cannot_be_varied():
    with pytest.raises(SceneError, match=r"the section effects\.drive\.coupling\.rubber_cord is not in this scene"):
        load(DRIVE, ["sweep.effects.drive.coupling.rubber_cord.cords=[100, 200]"])
    with pytest.raises(UsageError, match="is not in this scene"):
        leaf_of(load(DRIVE), "effects.drive.coupling.rubber_cord.discs")


@pytest.mark.parametrize("file", ["everything.yaml", "slider_crank/r134a.yaml", "drive/point.yaml", "rotors/b.yaml"])
def test_whatever_a_sweep_may_vary_can_be_given_its_own_value(file):
    """No name of an input may be taken for something else on the way, as `effects.mechanical.of` once was."""
    scene = load(DRIVE.parents[1] / file)
    own = {path: value_at(scene, path) for path, leaf in leaves_of(scene).items() if varies(path, leaf)}
    stated = {path: value for path, value in own.items() if value is not None and path != "gas.fluid"}
    assert len(stated) > 20 and all(value_at(with_values(scene, {path: v}), path) == v for path, v in stated.items())
