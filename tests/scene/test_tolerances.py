"""Values with a tolerance: what they mean, that they are written as they are read, and what is wrong at its line."""

import math

import pytest
from each_row import each_row

from screwsim.inputs.faults import SceneError
from screwsim.scene import loads, value_at
from screwsim.scene.types import Tolerance

SCENE = """\
machine:
  kind: twin_screw
  male_lobes: 4
  female_lobes: 6
  rotor_diameter: 160 mm
  rotor_length: 176 mm
  volume: {law: paper, max: 528 cm^3, phi_A: 65 deg}
  suction_port: {law: paper, area: 104 cm^2, phi_B: 60 deg}
  discharge_port: {law: paper, area: 81 cm^2, opens: 650 deg, phi_C: 660 deg}
gas: {fluid: R134a, model: ideal}
operation:
  speed: 1000 rpm
  suction: {pressure: 1.23 bar, temperature: 279 K}
  discharge: {pressure: 11.5 bar}
effects:
  suction_port: {}
  discharge_port: {}
  tip_leakage: {gap: 27.5 um}
  interlobe_leakage: {gap: 29.5 um, length: 184 mm}
"""
GAP, OTHER = "effects.tip_leakage.gap", "effects.interlobe_leakage.gap"
TOGETHER = f"uncertainty.correlated=[[{GAP}, {OTHER}]]"
CORRELATED = f"uncertainty: {{correlated: [[{GAP}, {OTHER}]]}}\n"
BOTH = (f"{GAP}=27 um ± 5 um", f"{OTHER}=29 um ± 5 um")


def read(*changes):
    """Return the scene with changes as --set takes them."""
    return loads(SCENE, overrides=changes)


@each_row(
    ("path", "text", "value", "tolerance"),
    [
        (GAP, "27 um ± 5 um", 27e-6, Tolerance(5e-6)),
        (GAP, "27 um +/- 5 um", 27e-6, Tolerance(5e-6)),
        (GAP, "27 ± 5 um", 27e-6, Tolerance(5e-6)),
        (GAP, "0.027 mm ± 5 um", 27e-6, Tolerance(5e-6)),
        (GAP, "27 um ± 10 %", 27e-6, Tolerance(2.7e-6)),
        (GAP, "27 um ×/÷ 2", 27e-6, Tolerance(2.0, factor=True)),
        (GAP, "27 um */ 2", 27e-6, Tolerance(2.0, factor=True)),
        (GAP, "27 um ± 5 um (k=2)", 27e-6, Tolerance(5e-6)),
        (GAP, "27 um ± 2.5 um (k=1)", 27e-6, Tolerance(5e-6)),
        (GAP, "27 ± 2.5 um (k=1)", 27e-6, Tolerance(5e-6)),
        (GAP, "27 um ×/÷ 1.5 (k=1)", 27e-6, Tolerance(2.25, factor=True)),
        ("effects.tip_leakage.flow_coefficient", "0.7 ± 0.025 (k=1)", 0.7, Tolerance(0.05)),
        ("effects.tip_leakage.flow_coefficient", "0.7 ± 0.05", 0.7, Tolerance(0.05)),
        ("operation.suction.temperature", "6 degC ± 2 K", 279.15, Tolerance(2.0)),
        ("operation.discharge.pressure", "7 bar(g) ± 0.1 bar", 801325.0, Tolerance(1e4)),
        ("operation.discharge.pressure", "7 barg ± 0.1", 801325.0, Tolerance(1e4)),
    ],
)
def test_a_tolerance_is_half_of_a_95_percent_interval_or_a_factor(path, text, value, tolerance):
    scene = read(f"{path}={text}")
    assert value_at(scene, path) == pytest.approx(value, rel=1e-12)
    found = scene.uncertain[path]
    assert (found.size, found.factor) == (pytest.approx(tolerance.size, rel=1e-12), tolerance.factor)


@pytest.mark.parametrize("text", ["2000 ± 100 J/(kg K)", "2 ± 0.05 kJ/(kg K) (k=1)"])
def test_a_bare_value_has_the_unit_of_its_tolerance_with_brackets_too(text):
    scene = read("oil.density=980 kg/m^3", f"oil.heat_capacity={text}")
    assert scene.oil.heat_capacity == 2000.0
    assert scene.uncertain["oil.heat_capacity"].size == pytest.approx(100.0)


def test_the_standard_uncertainty_is_half_of_a_tolerance_and_of_the_logarithm_of_a_factor():
    assert Tolerance(4.0).standard == 2.0
    assert Tolerance(4.0, factor=True).standard == pytest.approx(math.log(2.0))
    assert Tolerance(4.0, factor=True).at(3.0, 2.0) == pytest.approx(12.0)
    assert Tolerance(4.0, factor=True).ends(3.0) == (0.75, 12.0)


def test_a_scene_with_tolerances_is_written_as_it_is_read():
    scene = read(
        *BOTH,
        TOGETHER,
        "operation.speed=1000 rpm ×/÷ 1.1",
        "machine.volume.max=528 cm^3 ± 7 %",
        "uncertainty.model=bitzer",
    )
    again = loads(scene.text)
    assert (again.uncertain, again.correlated, again.text) == (scene.uncertain, scene.correlated, scene.text)
    assert again.correlated == ((GAP, OTHER),)
    assert (again.model_error, again.uncertain["machine.volume.max"].percent) == ("bitzer", 7.0)


def test_a_scene_without_tolerances_is_written_as_before():
    assert "±" not in read().text and "uncertainty" not in read().text


@each_row(
    ("change", "told"),
    [
        (f"{GAP}=27 um ± 5 bar", "the tolerance '5 bar' is not a length"),
        (f"{GAP}=27 um ± -5 um", "the tolerance '-5 um' is negative (write its size)"),
        (f"{GAP}=27 um ± 0 um", "the tolerance '0 um' is zero"),
        (f"{GAP}=27 um ± 30 um", "its 95 % interval reaches -0.003"),
        (f"{GAP}=27 um ×/÷ 0.5", "is not a factor above 1"),
        (f"{GAP}=27 um ±", "the tolerance '' is not a length"),
        ("effects.tip_leakage.flow_coefficient=0.7 ± a", "the tolerance 'a' is not a number"),
        ("operation.suction.temperature=279 K ± 1 %", "is a share of a temperature (write it in kelvin"),
        ("operation.suction.temperature=279 K ± 2 degC", "is a temperature, not a difference"),
        ("operation.suction.temperature=279 K ×/÷ 2", "a factor is only for quantities that are positive by nature"),
        ("machine.male_lobes=4 ± 1", "is not written as a whole number"),
        ("numerics.accuracy=3e-4 ± 10 %", "which only values that describe the machine and its operation may have"),
        (
            "operation.discharge.pressure=7 bar(g) ± 1 %",
            "the tolerance '1 %' is a share of a gauge pressure (write its",
        ),
        ("operation.discharge.pressure=7 barg ×/÷ 1.1", "a factor is only for quantities that are positive by nature"),
        ("operation.ambient_pressure=1 bar ± 1 %", "gauge pressures were read relative to it (write theirs instead)"),
        ("sweep.operation.speed=[900 rpm ± 2 rpm]", "has a tolerance of its own (write it after the value of"),
        (TOGETHER, f"'{GAP}' has no tolerance in this scene"),
        ("uncertainty.correlated=[[gap, [1]]]", "a list is not a path"),
        ("uncertainty.correlated=[[gap]]", "one path is not a group of paths"),
        ("uncertainty.model=bitzr", "did you mean 'bitzer'? known: bitzer"),
        ("uncertainty={correlated: 3}", "3 is not a group of paths"),
        ("uncertainty={together: []}", "does not list correlated groups"),
    ],
)
def test_a_tolerance_that_makes_no_sense_is_told_at_its_line(change, told):
    with pytest.raises(SceneError) as error:
        read(change)
    assert told in str(error.value)
    path = change.partition("=")[0]
    assert str(error.value).startswith((f"--set {change}: ", f"--set {path}=…: "))  # the latter for a long value


@each_row(
    ("changes", "groups"),
    [
        ((*BOTH, TOGETHER), ((GAP, OTHER),)),
        ((*BOTH, TOGETHER, f"{GAP}=20 um"), ()),
        ((*BOTH, TOGETHER, f"{GAP}=20 um ± 1 um"), ((GAP, OTHER),)),
    ],
)
def test_a_value_that_replaces_one_with_a_tolerance_leaves_its_group(changes, groups):
    assert read(*changes).correlated == groups


def test_a_scene_may_state_a_value_of_a_group_of_its_base(tmp_path):
    held = SCENE.replace("27.5 um", "27 um ± 5 um").replace("29.5 um", "29 um ± 5 um") + CORRELATED
    (tmp_path / "machine.yaml").write_text(held, encoding="utf-8")
    own = "base: machine.yaml\neffects: {tip_leakage: {gap: 20 um}}\n"
    assert loads(own, folder=str(tmp_path)).correlated == ()
    with pytest.raises(SceneError, match="has no tolerance in this scene"):
        loads(own + CORRELATED, folder=str(tmp_path))


@pytest.mark.parametrize(
    ("tolerance", "values", "told"),
    [
        ("27 um ± 5 um", "[3 um, 27 um]", "at 0.003 mm of the sweep its 95 % interval reaches -0.002 mm"),
        ("27 um ± 110 %", "[3 um, 27 um]", "its 95 % interval reaches -0.0027 mm"),
    ],
)
def test_a_tolerance_that_does_not_go_with_a_value_of_the_sweep_is_told(tolerance, values, told):
    with pytest.raises(SceneError) as error:
        read(f"{GAP}={tolerance}", f"sweep.{GAP}={values}")
    assert told in str(error.value)
    assert str(error.value).startswith(f"--set {GAP}={tolerance}")


def test_a_tolerance_holds_at_every_value_of_the_sweep_but_a_share_of_nothing_is_none():
    assert read(f"{GAP}=27 um ± 5 um", f"sweep.{GAP}=[10 um, 27 um]").uncertain[GAP].size == pytest.approx(5e-6)
    superheat = "operation.suction.superheat"
    with pytest.raises(SceneError) as error:
        read("operation.suction.temperature=null", f"{superheat}=10 K ± 10 %", f"sweep.{superheat}=[0 K, 10 K]")
    told = "has a tolerance that is 0 at the value 0 K of the sweep (write ± with a unit)"
    assert error.value.lines == [f"--set {superheat}=10 K ± 10 %: {superheat}: {told}"]


def test_a_share_is_that_of_every_value_and_another_tolerance_the_same_for_all():
    share, half, factor = Tolerance(1.0, percent=10.0), Tolerance(1.0), Tolerance(2.0, factor=True)
    assert [each.around(4.0).size for each in (share, half, factor)] == [pytest.approx(0.4), 1.0, 2.0]
    assert share.standard_at(4.0) == pytest.approx(0.2)
    assert factor.standard_at(4.0) == pytest.approx(2.0 * math.log(2.0))


def test_a_group_is_without_what_the_scene_leaves_out():
    found = loads(
        SCENE,
        overrides=(*BOTH, "effects.blow_hole.area=9 mm^2 ± 1 mm^2", f"{TOGETHER[:-2]}, effects.blow_hole.area]]"),
        without=["blow_hole"],
    )
    assert found.correlated == ((GAP, OTHER),)
    assert loads(SCENE, overrides=(*BOTH, TOGETHER), without=["tip_leakage"]).correlated == ()


def test_a_path_in_two_groups_is_told_once():
    with pytest.raises(SceneError, match="is in two groups") as error:
        read(*BOTH, f"uncertainty.correlated=[[{GAP}, {OTHER}], [{GAP}, {OTHER}]]")
    assert len(str(error.value).splitlines()) == 2  # one for each of its paths


def test_a_tolerance_of_a_file_is_told_at_the_line_of_the_file():
    with pytest.raises(SceneError, match=r"<text>:18:22: effects.tip_leakage.gap: the tolerance '5 K'"):
        loads(SCENE.replace("gap: 27.5 um", "gap: 27.5 um ± 5 K"))
