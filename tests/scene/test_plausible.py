"""What cannot be is refused at its path with a remedy, what hardly is so is warned of; shipped scenes are neither."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from CoolProp.CoolProp import PropsSI
from each_row import each_row

from screwsim.effects import catalogue
from screwsim.fluid import constants
from screwsim.inputs.declare import AREA, KINDS
from screwsim.inputs.faults import SceneError
from screwsim.machine.kinds import MACHINES
from screwsim.machine.profile_law import laid_curves
from screwsim.machine.rotors.export import lobe_csv
from screwsim.scene import load
from screwsim.scene.fields import leaf_paths
from screwsim.scene.plausible import scene_warnings, virial_compressibility
from screwsim.scene.sizes import sizes_of_effect

CONFIGS = Path(__file__).parents[2] / "configs"
REAL = Path(__file__).parents[1] / "plain" / "r134a.yaml"
SCENES = sorted(path for path in CONFIGS.rglob("*.yaml") if not {".fit", ".stages"} & set(path.suffixes))
PARAMETERS = {name: effect.parameters for name, effect in catalogue().items()}


def said(path: Path, *overrides: str) -> str:
    """Return what a scene with overrides is refused with, in one line."""
    with pytest.raises(SceneError) as refused:
        load(path, overrides=overrides)
    (line,) = refused.value.lines
    return line


CANNOT = {
    "oil_supply.temperature=1 K": "at least 150 K and at most 700 K",
    "oil_supply.temperature=900 K": "at least 150 K and at most 700 K",
    "operation.ambient_temperature=3 K": "at least 50 K",
    "machine.volume.max=1000 m^3": "which is impossible (choose a smaller volume, or a larger rotor_diameter or",
    "machine.volume.min=1 m^3": "times the volume that both rotors' bores offer a chamber, which is impossible",
    "machine.rotor_length=20 m": "is 125 rotor diameters, which is impossible (choose shorter rotors",
    "machine.rotor_diameter=10000 km": "is beyond any machine (at most 1000000000 mm; is the unit right?)",
    "machine.suction_port.area=100 m^2": "times the area of both bores and their ends, which is impossible",
    "gas.isentropic_exponent=1e9": "at least 1.001 and at most 2",
    "gas.isentropic_exponent=1.0000001": "at least 1.001 and at most 2",
    "operation.speed=1e6 rpm": "moves the rotors' tips at 8378 m/s, and no machine withstands 1000 m/s (choose a lower",
    "operation.suction.pressure=1e-9 bar": "at least 1e-05 bar",
    "operation.discharge.pressure=1e6 bar": "at most 10000 bar",
    "oil.density=1 kg/m^3": "at least 10 kg/m^3",
    "oil.heat_capacity=1 MJ/(kg K)": "at most 20 kJ/(kg K)",
    "oil.viscosity=1e-9 mPa s": "at least 0.001 mPa s",
    "effects.tip_leakage.gap=50 mm": "is 1.56 times the height of a lobe, which is impossible",
    "effects.interlobe_leakage.gap=50 mm": "times the height of a lobe, which is impossible",
    "effects.end_face_leakage.gap=50 mm": "times the height of a lobe, which is impossible",
    "effects.blow_hole.area=1 m^2": "times the rotor diameter's square, which is impossible",
    "effects.tip_leakage.flow_coefficient=1000": "at most 100",
    "effects.mechanical.fraction=1000": "at most 100",
}


@each_row(("override", "what"), CANNOT.items())
def test_what_cannot_be_is_refused_at_its_path_with_a_remedy(override, what):
    path = override.partition("=")[0]
    line = said(CONFIGS / "paper" / "point.yaml", override)
    assert line.startswith(f"--set {override}: {path}: ")
    assert what in line
    assert line.endswith(")")


HARDLY = {
    "oil_supply.ratio=0": "0 kg of oil per kg of gas hardly lubricate rotors that drive each other (usual: at le",
    "oil_supply.temperature=200 K": "200 K is unusual (usual: at least 210 K)",
    "operation.speed=20000 rpm": "moves the rotors' tips at 167.6 m/s (usual with oil: at most 80 m/s)",
    "effects.tip_leakage.gap=1.1 mm": "1.1 mm is unusual (usual: at most 1 mm)",
    "effects.tip_leakage.flow_coefficient=1.2": "1.2 is unusual (usual: at most 1)",
    "gas.isentropic_exponent=1.7": "1.7 is unusual (usual: at most 1.66667)",
    "machine.volume.max=5 cm^3": "that both rotors' bores offer a chamber (usual: at least 0.03)",
    "machine.suction_port.area=4000 cm^2": "1.55 times the area of both bores and their ends (usual: at most 0.5)",
    "operation.suction.temperature=200 K": "R134a of 1.23 bar is a liquid at -73.15 degC, and a gas above -21",
    "operation.discharge.pressure=50 bar": "the pressure ratio of a single machine is 40.65 (usual: at most 30)",
}


@each_row(("override", "what"), HARDLY.items())
def test_what_hardly_is_so_is_taken_and_warned_of_at_its_path(override, what):
    warnings = scene_warnings(load(CONFIGS / "paper" / "point.yaml", overrides=[override]))
    dense = [line for line in warnings if line.startswith("gas.model: ")]
    assert len(dense) == ("50 bar" in override)
    (warning,) = (line for line in warnings if line not in dense)
    assert warning.startswith(f"{override.partition('=')[0]}: ")
    assert what in warning
    assert "\n" not in warning


@each_row(("oil", "tip_speed", "usual"), [(True, 79, None), (True, 100, 80), (False, 100, None), (False, 160, 150)])
def test_tips_are_usually_slower_with_oil_than_without(oil, tip_speed, usual):
    dry = [] if oil else ["oil=null", "oil_supply=null", "effects=null"]
    speed = ["operation.speed=null", f"operation.tip_speed={tip_speed} m/s"]
    told = scene_warnings(load(CONFIGS / "paper" / "point.yaml", overrides=[*dry, *speed]))
    (fast,) = [line for line in told if "tips at" in line] or [""]
    assert ("usual with oil" in fast) == (oil and usual is not None)
    assert (f"at most {usual} m/s" in fast) == bool(fast) == (usual is not None)


@each_row(
    ("fluid", "p", "T"),
    [("R134a", 12e5, 330.0), ("Propane", 15e5, 340.0), ("CarbonDioxide", 80e5, 350.0), ("Methane", 50e5, 300.0)],
)
def test_the_virial_estimate_of_a_gas_is_near_its_equation_of_state(fluid, p, T):
    """By two coefficients, of which the third is left out: rather too light, by 0.05 of the ideal gas here at most."""
    limits = constants.limits(fluid)
    estimate, exact = virial_compressibility(limits, p, T), PropsSI("Z", "P", p, "T", T, fluid)
    assert exact - 0.005 < estimate < exact + 0.051
    assert 1.0 - virial_compressibility(limits, 1.0, T) < 1e-6  # a thin gas is ideal


def test_a_dense_gas_that_is_taken_as_ideal_is_warned_of():
    point = CONFIGS / "paper" / "point.yaml"
    (warning,) = scene_warnings(load(point, overrides=["operation.discharge.pressure=25 bar"]))
    assert warning.startswith("gas.model: R134a of 25 bar, 106.15 degC is about 25% denser than the ideal gas")
    assert not scene_warnings(load(point))


@each_row(("film", "beyond"), [("360 K", False), ("430 K", True), ("240 K", True)])
def test_a_film_beyond_the_viscosity_data_of_its_oil_is_warned_of(film, beyond):
    drag = f"effects.oil_drag={{tip_gap: 0.1 mm, tip_land: 1.5 mm, film_temperature: {film}}}"
    oil = "oil={name: mineral_46, density: null, heat_capacity: null, viscosity: null}"
    warnings = scene_warnings(load(CONFIGS / "paper" / "point.yaml", overrides=[oil, drag]))
    told = [line for line in warnings if line.startswith("effects.oil_drag.film_temperature: ")]
    assert [("extrapolated to" in line) for line in told] == [True] * beyond


def test_sizes_are_told_of_the_section_that_states_them_whatever_was_asked_before():
    machine, effects = "machine.volume.max", "effects.blow_hole.area"
    stated = [], [f"{machine}=5 cm^3"], [f"{effects}=40 cm^2"]
    plain, small, wide = (load(CONFIGS / "paper" / "point.yaml", overrides=some) for some in stated)
    both = replace(wide, machine=small.machine)
    for scene, paths in 2 * [(plain, []), (small, [machine]), (wide, [effects]), (both, [machine, effects])]:
        assert [line.partition(":")[0] for line in scene_warnings(scene)] == paths


def test_the_oil_with_which_rotors_still_ran_on_each_other_is_warned_of_nothing():
    assert scene_warnings(load(CONFIGS / "paper" / "point.yaml", overrides=["oil_supply.ratio=0.01"])) == ()


@pytest.mark.parametrize("path", SCENES, ids=lambda path: str(path.relative_to(CONFIGS)))
def test_shipped_scenes_are_warned_of_nothing(path):
    assert scene_warnings(load(path)) == ()


ANGLES = np.linspace(0.0, 720.0, 73)
SMOOTH = 3e-4 * (1.0 - np.cos(np.radians(ANGLES) / 2.0))
TEETH = SMOOTH * (1.0 + 0.01 * (-1.0) ** np.arange(len(ANGLES)))


def rough(folder, volumes, angles=ANGLES):
    """Return the warnings of a machine whose volume is that of a table."""
    rows = "".join(f"{angle:g},{volume:.17g}\n" for angle, volume in zip(angles, volumes, strict=True))
    (folder / "v.csv").write_text(f"angle_deg,volume_m3\n{rows}", encoding="utf-8")
    table = f"machine.volume={{law: table, max: 600 cm^3, phi_A: null, file: {folder / 'v.csv'}}}"
    return scene_warnings(load(CONFIGS / "paper" / "point.yaml", overrides=[table]))


def test_a_table_of_the_swept_volume_that_keeps_some_of_it_is_warned_of(tmp_path):
    """With 600 cm³ of `volume.max` such a machine sweeps 480 cm³."""
    (warning,) = rough(tmp_path, 0.8 * SMOOTH + 1.2e-4)
    assert warning.startswith("machine.volume.file: the smallest volume of the table is 20.00% of its largest, which ")
    assert "write it as machine.volume.min" in warning


def test_a_volume_that_goes_to_and_fro_from_row_to_row_is_warned_of(tmp_path):
    (warning,) = rough(tmp_path, TEETH)
    assert warning.startswith("machine.volume.file: the slope of the volume jumps back and forth from row to row, at ")
    assert "a smoother table" in warning


@pytest.mark.parametrize(("top", "share"), [(420, "95.0%"), (240, "85.4%")])
def test_a_table_whose_angles_begin_elsewhere_is_warned_of(tmp_path, top, share):
    """What lies at 360 deg counts as trapped, whatever the chamber does there."""

    def largest_at(top):
        return np.interp(np.interp(ANGLES, (0.0, top, 720.0), (0.0, 360.0, 720.0)), ANGLES, SMOOTH)

    (warning,) = rough(tmp_path, largest_at(top))
    told = f"machine.volume.file: the volume of the table is largest at {top} deg, and {share} of that at 360 deg, "
    assert warning.startswith(told)
    assert "machine.volume.injection_angle" in warning
    assert rough(tmp_path, largest_at(370.0)) == rough(tmp_path, largest_at(320.0)) == ()


def test_a_table_that_is_scaled_to_another_size_is_warned_of(tmp_path):
    """350 cm³ on a base that states 600 were simulated as 600 without a word; a rounding of 1 % is none."""
    (warning,) = rough(tmp_path, SMOOTH * (350.0 / 600.0))
    told = (
        "machine.volume.max: a table whose largest volume is 350 cm^3 is scaled to 600 cm^3 (max: 350 cm^3 keeps it "
        "as it is)"
    )
    assert warning == f"{told}; is that intended?"
    assert rough(tmp_path, SMOOTH * 1.009) == ()


@pytest.mark.parametrize(
    ("volumes", "angles"),
    [
        (SMOOTH, ANGLES),
        (np.round(SMOOTH, 6), ANGLES),  # three digits
        (np.interp(ANGLES, (0.0, 200.0, 360.0, 720.0), (0.0, 4e-4, 6e-4, 0.0)), ANGLES),  # corners
        (np.array((0.0, 6e-4, 0.0)), np.array((0.0, 360.0, 720.0))),
    ],
)
def test_a_table_of_few_digits_or_with_corners_is_warned_of_nothing(tmp_path, volumes, angles):
    assert rough(tmp_path, volumes, angles) == ()


def test_gaps_of_a_millimetre_and_ports_a_hundred_times_as_wide_are_allowed():
    changes = [f"effects.{name}_leakage.gap=1 mm" for name in ("tip", "interlobe", "end_face")]
    assert scene_warnings(load(CONFIGS / "paper" / "point.yaml", overrides=changes)) == ()


@pytest.mark.parametrize("kind", MACHINES)
def test_usual_bounds_lie_within_those_of_what_can_be_and_hold_the_default(kind):
    for path, leaf in leaf_paths(PARAMETERS, kind).items():
        low, high = leaf.hardly
        ends = [end for end in leaf.hardly if end is not None]
        least = max((leaf.limits[name] for name in ("gt", "ge") if name in leaf.limits), default=-1e300)
        most = min((leaf.limits[name] for name in ("lt", "le") if name in leaf.limits), default=1e300)
        assert all(least <= end <= most for end in ends), path
        if ends and isinstance(leaf.default, float):
            assert (low is None or low <= leaf.default) and (high is None or leaf.default <= high), path


@pytest.mark.parametrize("kind", MACHINES)
def test_the_table_of_sizes_names_paths_that_scenes_have(kind):
    leaves, machine = leaf_paths(PARAMETERS, kind), MACHINES[kind]
    of_effects = [size for name, effect in catalogue().items() for size in sizes_of_effect(machine, name, effect)]
    for size in (*machine.sizes, *of_effects):
        leaf = leaves[size.path]
        assert leaf.kind in ("length", "area", "volume") or leaf.limits.get("curve") == AREA, size.path
        assert size.usual[0] < size.usual[1] <= size.most, size.path


def test_every_scale_by_which_an_effect_measures_a_size_is_one_of_a_machine_that_can_have_it():
    for name, effect in catalogue().items():
        fitting = [kind for kind in MACHINES.values() if effect.fits(kind)]
        for size in effect.sizes:
            assert any(size.scale in kind.scales for kind in fitting), f"effects.{name}.{size.key}"


@each_row("kind", [kind for kind in KINDS.values() if kind.most < 1e300])
def test_what_no_machine_has_is_beyond_the_bounds_of_every_kind(kind):
    assert kind.least < kind.most


@pytest.mark.parametrize("path", ["operation.superheat", "operation.suction.superheat"])
def test_less_than_no_superheat_names_what_states_wet_gas(path):
    line = said(REAL, f"{path}=-3 K")
    assert "operation.suction.quality" in line
    assert "gas.two_phase: equilibrium" in line


def test_liquid_colder_than_the_evaporator_is_refused():
    line = said(REAL, "operation.subcooling=60 K")
    assert "operation.subcooling: makes liquid of -15 degC: colder than the evaporator" in line
    load(REAL, overrides=["operation.subcooling=43 K"])


STATED = {
    "operation.evaporating_temperature": "null",
    "operation.condensing_temperature": "null",
    "operation.superheat": "null",
    "operation.suction.pressure": "3 bar",
    "operation.discharge.pressure": "12 bar",
}


@each_row(
    ("path", "value", "liquid"),
    [
        ("operation.suction.temperature", "273 K", True),
        ("operation.suction.temperature", "275 K", False),
        ("operation.discharge.temperature", "319 K", True),
        ("operation.discharge.temperature", "320 K", False),
    ],
)
@each_row("two_phase", ["refuse", "equilibrium"])
def test_a_line_of_a_real_gas_is_no_liquid(path, value, liquid, two_phase):
    lines = {"operation.suction.temperature": "285 K", **STATED, path: value, "gas.two_phase": two_phase}
    changes = [f"{name}={text}" for name, text in lines.items()]
    if not liquid:
        load(REAL, overrides=changes)
        return
    line = said(REAL, *changes)
    assert f"{path}: " in line
    assert "a liquid: it is a gas above" in line


def test_dense_fluid_below_the_critical_temperature_is_a_liquid():
    lines = {**STATED, "operation.suction.pressure": "45 bar", "operation.discharge.pressure": "60 bar"}
    lines["operation.suction.temperature"] = "350 K"
    assert "a liquid" in said(REAL, *(f"{name}={text}" for name, text in lines.items()))


def test_a_table_of_areas_in_another_unit_is_refused(tmp_path):
    rows = "angle_deg,area_m2\n0,0\n180,104\n360,0\n"  # cm²
    (tmp_path / "area.csv").write_text(rows)
    port = f"machine.suction_port={{law: table, area: null, phi_B: null, file: {tmp_path / 'area.csv'}}}"
    line = said(CONFIGS / "paper" / "point.yaml", port)
    assert "its largest area of 104 m² is 404 times the area of both bores and their ends, which is impossible" in line


CYLINDER = CONFIGS / "slider_crank" / "air.yaml"


def test_a_piston_as_fast_as_none_and_valves_wider_than_the_piston():
    assert "moves the piston at a mean speed of 366.9 m/s" in said(CYLINDER, "operation.speed=60000 rpm")
    assert "times the piston's area, which is impossible" in said(
        CYLINDER, "effects.reed_valves.suction_port_area=4 m^2"
    )
    (warning,) = scene_warnings(load(CYLINDER, overrides=["effects.reed_valves.suction_port_area=400 cm^2"]))
    assert "1.27 times the piston's area (usual: at most 1)" in warning


def test_rotors_of_another_size_than_their_profile():
    b = CONFIGS / "rotors" / "b.yaml"
    line = said(b, "machine.rotor_diameter=320 mm")
    assert "to change the size of a machine, scale all lengths of its profile" in line
    warnings = scene_warnings(load(b, overrides=["machine.rotor_diameter=140 mm"]))
    assert any(each.startswith("machine.profile.centre_distance: 128 mm is 0.914 rotor diameters") for each in warnings)


def by_points(lobe):
    """Return the overrides that state the lobe of configs/rotors/b.yaml by a file of points."""
    shape = ("male_tip_radius", "flank_radius", "pressure_angle", "female_tip_radius", "root_radius")
    gone = [f"machine.profile.{name}=null" for name in shape]
    return [*gone, "machine.profile.kind=points", f"machine.profile.file={lobe}"]


def test_a_lobe_of_the_other_hand_is_warned_of(tmp_path):
    """Its larger blow-hole is that of high pressure, which no maker wants."""
    b = CONFIGS / "rotors" / "b.yaml"
    head, *rows = lobe_csv(laid_curves(load(b).machine).rotors).splitlines()
    turned = [f"{x},{-float(y)!r}" for x, y in (row.split(",") for row in reversed(rows))]
    for name, lines in (("right.csv", rows), ("other.csv", turned)):
        (tmp_path / name).write_text("\n".join([head, *lines]) + "\n")
    assert scene_warnings(load(b, overrides=by_points(tmp_path / "right.csv"))) == ()
    (warning,) = scene_warnings(load(b, overrides=by_points(tmp_path / "other.csv")))
    assert warning.startswith("machine.profile.file: the larger blow-hole is the high-pressure one (128.5 mm²")


def test_points_of_a_profile_are_those_of_the_rotor_diameter(tmp_path):
    b = CONFIGS / "rotors" / "b.yaml"
    lobe = tmp_path / "lobe.csv"
    lobe.write_text(lobe_csv(laid_curves(load(b).machine).rotors))
    points = by_points(lobe)
    load(b, overrides=points)
    line = said(b, *points, "machine.rotor_diameter=170 mm")
    assert "machine.rotor_diameter: is 170 mm, and the points of machine.profile.file reach to 160 mm (write" in line


@pytest.mark.parametrize("largest", [9.0, 0.2])
def test_a_port_of_a_table_as_wide_as_no_housing_is_warned_of_as_a_stated_area(tmp_path, largest):
    (tmp_path / "port.csv").write_text(f"angle_deg,area_m2\n0,0\n90,{largest}\n300,{largest}\n360,0\n")
    tabled = f"machine.suction_port={{law: table, area: null, phi_B: null, file: {tmp_path / 'port.csv'}}}"
    paper = CONFIGS / "paper" / "point.yaml"
    (told,) = scene_warnings(load(paper, overrides=[tabled]))
    (stated,) = scene_warnings(load(paper, overrides=[f"machine.suction_port.area={largest} m^2"]))
    assert told.startswith("machine.suction_port.file: ")
    assert "port.csv': its largest area, " in told
    assert told.partition(" is ")[2] == stated.partition(" is ")[2]


def test_a_leak_of_a_table_far_wider_than_any_gap_is_warned_of_or_refused(tmp_path):
    def warnings_of(area):
        (tmp_path / "leak.csv").write_text(f"angle_deg,area_m2\n0,0\n400,{area}\n600,{area}\n720,0\n")
        changes = ["effects.blow_hole.area=null", f"effects.blow_hole.area_file={tmp_path / 'leak.csv'}"]
        return scene_warnings(load(CONFIGS / "paper" / "point.yaml", overrides=changes))

    assert warnings_of(1.5e-5) == ()
    (told,) = warnings_of(0.015)  # 150 cm² by a table in which cm² were taken for m²
    assert "its largest area, 150 cm^2, is 0.586 of the rotor diameter's square (usual: at most 0.05)" in told
    with pytest.raises(
        SceneError, match=r"area_file: .*5.86 times .* impossible \(areas are in m\^2; is the unit right"
    ):
        warnings_of(0.15)
