"""Whole cycles of machines with a rotor profile: balances, both closings, tables in place of the profile, sweeps."""

import math
from pathlib import Path

import numpy as np
import pytest

from screwsim.build import build_parts
from screwsim.inputs.faults import UsageError
from screwsim.machine.profile_law import laid_curves
from screwsim.report.rotors_scene import table_files
from screwsim.scene import load
from screwsim.simulate import simulate
from screwsim.study.sweep import run_sweep

CONFIGS = Path(__file__).parents[2] / "configs" / "rotors"
IDEAL = (  # one small compiled model for what needs no real gas
    "gas.model=ideal",
    "effects.oil_heat=off",
    "effects.end_face_leakage=off",
    "effects.oil_pump=off",
)
SEEN = ("gas_mass_flow", "shaft_power", "trapped_mass", "discharge_temperature", "volumetric_efficiency")


def difference(one, other):
    """Return the largest relative difference of figures."""
    return max(abs(one.performance[name] / other.performance[name] - 1.0) for name in SEEN)


def ideal(*overrides):
    return load(CONFIGS / "b.yaml", (*IDEAL, *overrides))


@pytest.fixture(scope="module")
def cycle():
    """Return the closed cycle of (b) with an ideal gas."""
    return simulate(ideal())


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_the_shipped_machines_close_and_keep_their_balances(name):
    result = simulate(load(CONFIGS / f"{name}.yaml"))
    assert result.status == "ok"
    assert result.balance.mass <= result.balance.bound
    assert result.balance.energy <= result.balance.bound
    assert result.balance.oil_mass <= 10 * result.balance.bound  # not part of the bound itself
    assert abs(result.ledger["relative_residue"]) < 1e-3
    assert result.numerics["rhs_evaluations"] < 20_000  # the paper's laws: 12 000; rows that jump in slope: 28 000
    assert result.cycle["angle"][-1] == pytest.approx(900.0 if name != "c" else 864.0)


def test_all_chambers_at_once_give_the_same_cycle(cycle):
    together = simulate(ideal("numerics.closing=coupled"))
    assert together.numerics["closing"] == "coupled"
    assert together.status == cycle.status == "ok"
    assert difference(together, cycle) < 2 * ideal().numerics.accuracy  # either may be off by the accuracy


@pytest.mark.slow
def test_tables_of_the_profile_give_the_same_cycle(cycle, tmp_path):
    found = simulate(tabled(ideal(), tmp_path))
    one_path = simulate(ideal(f"effects.interlobe_leakage.area_file={tmp_path / 'interlobe_leakage.csv'}"))
    assert found.status == one_path.status == "ok"
    assert difference(found, one_path) < 2 * ideal().numerics.accuracy  # either may be off by the accuracy
    assert one_path.performance["volumetric_efficiency"] > cycle.performance["volumetric_efficiency"]  # a path less


def tabled(scene, folder):
    """Return the scene that `screwsim rotors` writes of a scene, read again."""
    for name, text in table_files(scene, folder).items():
        (folder / name).write_text(text, encoding="utf-8")
    return load(folder / "scene.yaml")


def test_tables_of_the_profile_end_where_the_curves_do(tmp_path):
    """That of the suction port closed a degree after suction ends, with one more row of zero."""
    files, geometry = table_files(ideal(), tmp_path), build_parts(ideal()).geometry
    rows = {name: text.split()[-2:] for name, text in files.items() if name.endswith(".csv")}
    angles = {name: [float(row.partition(",")[0]) for row in last] for name, last in rows.items()}
    assert all(last[1].endswith(",0") and not last[0].endswith(",0") for last in rows.values())
    assert angles["suction_port.csv"][1] == pytest.approx(math.degrees(geometry.injection_angle), abs=1e-6)
    assert angles["discharge_port.csv"][1] == pytest.approx(angles["volume.csv"][1], abs=1e-6)


def test_tables_of_the_profile_hold_the_stated_blow_hole(tmp_path):
    scene = ideal("effects.blow_hole.area=40 mm^2")  # the profile's own is 7.4 mm²

    at = np.radians(np.arange(300.0, 800.0, 5.0))

    def area(each):
        curves = [path.tables["curve"] for path in build_parts(each).effects["blow_hole"]]
        return np.sum([np.interp(at, curve[0], curve[1], left=0.0, right=0.0) for curve in curves], axis=0)

    assert area(scene)[60] == pytest.approx(40e-6, rel=1e-3)  # at 600 degrees
    np.testing.assert_allclose(area(tabled(scene, tmp_path)), area(scene), atol=1e-9)


def test_tables_keep_the_lengths_that_effects_take_from_the_profile(tmp_path):
    warm = "effects.thermal_clearances={rotor_temperature: 330 K, housing_temperature: 320 K}"
    drag = "effects.oil_drag={tip_gap: 40 um, tip_land: 2 mm}"
    scene = load(CONFIGS / "c.yaml", (*IDEAL, warm, drag))
    found, profile = tabled(scene, tmp_path).effects, scene.machine.profile
    assert found["oil_drag"].parameters.female_diameter == pytest.approx(profile.female_diameter)
    assert found["thermal_clearances"].parameters.axis_distance == pytest.approx(profile.centre_distance)


SLIDE = "machine.slide_valve={{position: {}, travel: 90 mm, male_span: 70 deg, female_span: 60 deg}}"


def test_tables_of_a_slide_at_full_load_leave_it_out(tmp_path):
    scene = ideal(SLIDE.format(0), "effects.slide_valve={}")
    assert "slide_valve" in scene.effects and "slide_valve" not in tabled(scene, tmp_path).effects


def test_a_table_of_a_slot_ends_where_the_slot_does_whatever_zeros_follow(tmp_path):
    """The volume ratio counts from there: with zeros to 899° it was that of an empty chamber."""
    scene = ideal(SLIDE.format(0.5), "effects.slide_valve={}")
    tabled(scene, tmp_path)
    with open(tmp_path / "slide_valve.csv", "a", encoding="utf-8") as file:
        file.write("899,0\n")
    (slot,) = build_parts(load(tmp_path / "scene.yaml")).effects["slide_valve"]
    laid = laid_curves(scene.machine)
    assert max(slot.breakpoints) == pytest.approx(laid.born + laid.curves.compresses, abs=math.radians(1.1))  # a row


def test_an_idle_chamber_keeps_its_charge(cycle):
    mass, angle = cycle.cycle["gas_mass"], cycle.cycle["angle"]
    laid = laid_curves(ideal().machine)
    ends, born = math.degrees(laid.ends), math.degrees(laid.born)
    for idle in (angle > ends + 1.0, angle < born - 1.0):
        assert idle.sum() > 50
        assert mass[idle] == pytest.approx([mass[idle][0]] * int(idle.sum()), rel=1e-9)  # nothing flows: rounding
    # as the cycle closes: figures are held to the accuracy, of which so small a charge may keep some times as much open
    assert mass[0] < 0.01 * cycle.performance["trapped_mass"]
    assert mass[0] == pytest.approx(mass[-1], rel=4.0 * ideal().numerics.accuracy)


def test_a_finer_accuracy_changes_figures_by_less_than_the_coarse_one(cycle):
    fine = simulate(ideal("numerics.accuracy=1e-5"))
    assert difference(cycle, fine) < ideal().numerics.accuracy


@pytest.mark.slow
def test_formulas_of_the_gaps_leak_as_rotors_do_where_volume_and_ports_are_the_rotors(tmp_path):
    """Volume and ports of (b) around the largest volume on an axis of 720°, all gaps by the formulas M22, M260–M263."""
    rotors = simulate(load(CONFIGS / "b.yaml", ("gas.model=ideal",)))
    scene = load(CONFIGS / "b.yaml")
    curves, closes = laid_curves(scene.machine).curves, laid_curves(scene.machine).curves.suction_closes
    angle = np.arange(0.0, 721.0)
    around = np.radians(angle - 360.0) + closes

    def table(name, column, *parts):
        values = sum(np.interp(around, part.angle, part.value) for part in parts)
        if column == "volume_m3":  # what is cut off, 0.2 % of the largest, on either side
            lost = np.where(angle < 360.0, values[0], values[-1])
            values = (values - lost) * values.max() / (values.max() - lost)
        rows = "".join(f"{x},{max(value, 0.0):.8e}\n" for x, value in zip(angle, values, strict=True))
        (tmp_path / name).write_text(f"angle_deg,{column}\n{rows}", encoding="utf-8")
        return f"law: table, file: {tmp_path / name}"

    swept = 1e6 * float(curves.volume.value.max())
    laws = (
        f"machine.volume={{{table('v.csv', 'volume_m3', curves.volume)}, max: {swept:.6f} cm^3}}",
        f"machine.suction_port={{{table('s.csv', 'area_m2', *curves.suction.values())}}}",
        f"machine.discharge_port={{{table('d.csv', 'area_m2', *curves.discharge.values())}}}",
        "machine.profile=null",
        "machine.built_in_volume_ratio=null",
    )
    whole = {
        "interlobe_leakage": "{gap: 40 um, length: 183.5 mm, tip_length: 48.4 mm}",
        "blow_hole": "{area: 7.36 mm^2, suction_area: 128.6 mm^2}",
        "end_face_leakage": "{gap: 40 um, length: 64 mm}",
    }
    without = {**whole, "interlobe_leakage": "{gap: 40 um, length: 183.5 mm}", "blow_hole": "{area: 7.36 mm^2}"}

    def by_formulas(sizes):
        gaps = (f"effects.{name}={values}" for name, values in sizes.items())
        found = simulate(load(CONFIGS / "b.yaml", ("gas.model=ideal", *laws, *gaps)))
        assert found.status == "ok"
        return found.performance

    found, lacking = by_formulas(whole), by_formulas(without)
    filling = rotors.performance["volumetric_efficiency"]
    assert abs(found["volumetric_efficiency"] - filling) < 0.005
    assert abs(found["isentropic_efficiency"] - rotors.performance["isentropic_efficiency"]) < 0.005
    assert lacking["volumetric_efficiency"] - filling > 0.015


@pytest.mark.parametrize(
    ("path", "low", "high"),
    [
        ("effects.interlobe_leakage.gap", "20 um", "60 um"),
        ("effects.tip_leakage.gap", "20 um", "60 um"),
        ("machine.profile.wrap_angle", "260 deg", "320 deg"),
    ],
)
def test_longer_or_wider_gaps_fill_less(path, low, high):
    one, two = (simulate(ideal(f"{path}={value}")).performance["volumetric_efficiency"] for value in (low, high))
    assert two < one


def test_a_sweep_over_lives_keeps_figures_and_refuses_cycles_in_one_line(tmp_path):
    """At 180° of wrap a chamber lives 720°, at 300° it lives 900°."""
    text = f"base: {CONFIGS / 'b.yaml'}\nsweep: {{machine.profile.wrap_angle: [180 deg, 300 deg]}}\n"
    text += "output: {keep: KEPT}\n"
    scenes = {}
    for keep in ("performance", "cycle"):
        path = tmp_path / f"{keep}.yaml"
        path.write_text(text.replace("KEPT", keep))
        scenes[keep] = load(path, IDEAL)
    summary = run_sweep(scenes["performance"], tmp_path / "performance.h5", jobs=1)
    assert (summary.ok, summary.cases) == (2, 2)
    with pytest.raises(UsageError, match=r"^output.keep: chambers live 720 and 900 deg"):
        run_sweep(scenes["cycle"], tmp_path / "cycle.h5", jobs=1)
