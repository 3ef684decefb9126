"""Areas of all flow paths: never negative, continuous, zero outside their windows, kinked at their breakpoints only."""

import math
from pathlib import Path

import numpy as np
import pytest
from each_row import each_row
from scenes import make

from screwsim.build import build_parts
from screwsim.effects import blow_hole, catalogue, find_effect, interlobe_leakage, tip_leakage
from screwsim.effects.base import Effect, FlowPath
from screwsim.effects.parts import gap
from screwsim.inputs.faults import SceneError
from screwsim.machine.profile_law import laid_curves
from screwsim.machine.protocol import TIP_GAP
from screwsim.model.numbers import symbols_of
from screwsim.numerics.spline import pack_curve
from screwsim.scene import load

PARTS = build_parts(make({"effects.tip_leakage": {"gap": "50 um"}}))
PITCH, LIFE, DEG = PARTS.geometry.pitch, PARTS.geometry.life, math.pi / 180
FINE = np.radians(np.arange(-10.0, 730.0, 0.05)) + 1e-9
PATHS = {
    f"{name} {path.to} {path.offset}": path
    for name, items in PARTS.effects.items()
    for path in items
    if isinstance(path, FlowPath)
}
GAPS = {name: path for name, path in PATHS.items() if path.to == "neighbour"}


def areas(path, angles):
    """Return the area [m²] over the angles, arguments taken by name as the composer does."""
    numbers = {**symbols_of(PARTS), **path.values}
    names = [name for name in path.area.arguments if name != "phi"]
    return np.array([path.area(phi, *(numbers[name] for name in names)) for phi in angles])


def degrees(values):
    return np.degrees(FINE[np.nonzero(values)[0]])


@pytest.mark.parametrize("name", PATHS)
def test_no_area_is_negative(name):
    assert areas(PATHS[name], FINE).min() >= 0.0


@pytest.mark.parametrize("name", PATHS)
def test_areas_are_continuous(name):
    found = areas(PATHS[name], FINE[(FINE >= 0.0) & (FINE <= LIFE)])
    # the steepest goes from nothing to its most within 20°, 1.5 times as steep in the middle: 0.4 % in 0.05°
    assert np.max(np.abs(np.diff(found))) < 0.005 * found.max()


def kinks(path):
    """Return the angles [degree] inside a life at which the slope of the area jumps."""
    inside = FINE[(FINE >= 0.0) & (FINE <= LIFE)]
    slopes = np.diff(areas(path, inside))
    # a ramp of 20° is the most curved: in 0.05° its slope changes by 1 % of its steepest
    return np.degrees(inside[1:-1][np.abs(np.diff(slopes)) > 0.02 * np.max(np.abs(slopes))])


@pytest.mark.parametrize("name", PATHS)
def test_areas_are_kinked_at_their_breakpoints_only(name):
    """Where the slope jumps, a breakpoint of the path (or an end of life) stands; the curvature may jump without."""
    known = np.degrees([*PATHS[name].breakpoints, 0.0, LIFE])
    assert all(np.min(np.abs(known - kink)) < 0.1 for kink in kinks(PATHS[name]))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("tip_leakage neighbour 1", [315, 675]),
        ("interlobe_leakage neighbour 4", [60, 230, 360]),
        ("blow_hole neighbour 1", []),  # C1 ramps
        ("end_face_leakage neighbour 1", []),
    ],
)
def test_kinks_are_where_the_formulas_have_them(name, expected):
    found = kinks(PATHS[name])
    assert [angle for angle in expected if np.min(np.abs(found - angle), initial=720.0) < 0.1] == expected
    assert all(min((abs(angle - kink) for angle in expected), default=720.0) < 0.1 for kink in found)


@pytest.mark.parametrize(
    ("name", "opens", "closes"),
    [
        ("suction_port suction 0", 0.0, 360.0),
        ("discharge_port discharge 0", 600.0, 720.0),
        ("tip_leakage neighbour 1", 0.0, 720.0 - 45.0),  # of the middle of both chambers, half a pitch of 90° ahead
        ("interlobe_leakage neighbour 4", 0.0, 360.0),  # of the filling chamber, a turn behind the compressing one
        ("blow_hole neighbour 1", 373.0 - 90.0, 693.0 - 90.0),  # of the trailing chamber, a pitch of 90° behind
        ("end_face_leakage neighbour 1", 360.0 - 90.0, 720.0 - 90.0),
        ("end_face_leakage neighbour 4", 0.0, 360.0),
    ],
)
def test_a_path_is_open_inside_its_window_and_nowhere_else(name, opens, closes):
    at = degrees(areas(PATHS[name], FINE))
    assert (at.min(), at.max()) == pytest.approx((opens, closes), abs=0.06)  # the grid


def test_every_path_of_the_scene_has_a_window_above():
    assert len(PATHS) == 7


EVERY_INTERFACE = build_parts(make({"effects.tip_leakage": {"gap": "50 um", "reading": "interface"}}))


def every_interface(angles):
    """Return the tip areas [m²] where (19) is read as that of every interface."""
    return areas(EVERY_INTERFACE.effects["tip_leakage"][0], angles)


def test_tip_area_is_the_papers_at_360_degrees():
    assert every_interface([2 * math.pi])[0] == pytest.approx(9.83 * 50e-6 * 0.16, rel=1e-12)  # (19)


@pytest.mark.parametrize(("phi", "share"), [(90.0, 0.25), (180.0, 0.5), (540.0, 0.5), (720.0, 0.0)])
def test_tip_area_is_linear_up_and_down(phi, share):
    full = tip_leakage.TIP_LENGTH * 50e-6 * 0.16
    assert every_interface([phi * DEG])[0] == pytest.approx(share * full, abs=1e-15 * full + 1e-20)


def test_both_interfaces_of_a_chamber_together_are_the_papers_tips():
    """But within half a pitch of its top and its ends, and while the chamber behind is born."""
    path = PATHS["tip_leakage neighbour 1"]
    phi = np.radians([120.0, 200.0, 300.0, 315.0, 405.0, 500.0, 600.0, 675.0])
    assert areas(path, phi) + areas(path, phi - PITCH) == pytest.approx(every_interface(phi), rel=1e-12)
    top = areas(path, [2 * math.pi]) + areas(path, [2 * math.pi - PITCH])
    assert top == pytest.approx(0.875 * every_interface([2 * math.pi]), rel=1e-12)  # 1 − 90°/720°


# ---- beside the rotors of configs/rotors ----

ROTORS = {
    name: load(Path(__file__).parents[2] / "configs" / "rotors" / f"{name}.yaml").machine for name in ("a", "b", "c")
}


@pytest.mark.parametrize(("name", "off"), [("a", 0.52), ("b", 0.50), ("c", 0.40)])
def test_tip_area_is_that_of_rotors_with_a_profile(name, off):
    """Lengths over D around the largest volume of the trailing chamber; (19) at every interface is twice as much."""
    machine = ROTORS[name]
    laid, diameter, pitch = laid_curves(machine), machine.rotor_diameter, 2 * math.pi / machine.male_lobes
    around = np.radians(np.arange(-180.0, 181.0))
    tips = laid.interfaces[TIP_GAP][0].table
    rotors = np.interp(laid.injection + around, tips.angle, tips.value) / diameter
    law = np.array([tip_leakage.area(2 * math.pi + x, 1.0, 1.0, pitch) for x in around])
    twice = np.array([tip_leakage.all_tips(2 * math.pi + x, 1.0, 1.0) for x in around])
    assert np.max(np.abs(law - rotors)) < off
    assert 1.01 < law.mean() / rotors.mean() < 1.04
    assert twice.mean() / rotors.mean() > 1.9


def curve_of(name, path, after):
    """Return a path of rotors over its largest value, by the leading chamber's angle after its largest volume [rad]."""
    curves = laid_curves(ROTORS[name]).curves
    curve = next(each.curve for each in curves.paths if each.name == path)
    return np.interp(after + curves.suction_closes, curve.angle, curve.value) / curve.value.max()


def late(name):
    """Return by how much longer rotors close than law (16) [rad]."""
    curves = laid_curves(ROTORS[name]).curves
    return curves.life - curves.suction_closes - 2 * math.pi


@pytest.mark.parametrize(("name", "off"), [("a", 0.15), ("b", 0.14), ("c", 0.16)])
def test_contact_line_on_the_flanks_is_that_of_rotors(name, off):
    """From 20° on: before that, the chamber behind is born. Both end together."""
    phi = np.radians(np.arange(20.0, 360.0))
    law = np.array([interlobe_leakage.flank_area(x, 1.0, 1.0) for x in phi])
    rotors = curve_of(name, "sealing_line", phi + late(name))
    assert np.max(np.abs(law - rotors)) < off
    assert law.mean() == pytest.approx(rotors.mean(), abs=0.02)


@pytest.mark.parametrize("name", ["b", "c"])
def test_contact_line_over_the_tip_is_that_of_rotors(name):
    pitch = 2 * math.pi / ROTORS[name].male_lobes
    phi = np.arange(20.0 * DEG, 2 * math.pi - pitch, DEG)
    law = np.array([interlobe_leakage.tip_area(x, 1.0, 1.0, pitch) for x in phi])
    rotors = curve_of(name, "sealing_line_over_tip", phi + pitch + late(name))
    assert np.max(np.abs(law - rotors)) < 0.14
    assert law.mean() == pytest.approx(rotors.mean(), abs=0.01)


@pytest.mark.parametrize(("name", "closes"), [("a", 420.0), ("b", 420.0), ("c", 411.0)])
def test_blow_hole_at_the_suction_cusp_is_that_of_rotors(name, closes):
    pitch = 2 * math.pi / ROTORS[name].male_lobes
    leading = np.radians(np.arange(360.0, 720.0))
    law = np.array([blow_hole.suction_side(x - pitch, 1.0, pitch, closes * DEG) for x in leading])
    rotors = curve_of(name, "suction_blow_hole", leading - 2 * math.pi)
    assert np.max(np.abs(law - rotors)) < 0.19
    assert law.mean() == pytest.approx(rotors.mean(), abs=0.005)


LINED = build_parts(
    make(
        {
            "effects.interlobe_leakage": {"gap": "50 um", "length": "184 mm", "tip_length": "48 mm"},
            "effects.blow_hole": {"area": "12 mm^2", "suction_area": "129 mm^2"},
        }
    )
)


@pytest.mark.parametrize(
    ("effect", "number", "offset", "opens", "closes", "largest"),
    [
        ("interlobe_leakage", 0, 4, 0.0, 360.0, 50e-6 * 0.136),
        ("interlobe_leakage", 1, 5, 0.0, 360.0 - 90.0, 50e-6 * 0.048),
        ("blow_hole", 0, 1, 373.0 - 90.0, 693.0 - 90.0, 12e-6),
        ("blow_hole", 1, 1, 340.0 - 90.0, 420.0 - 90.0, 129e-6),
    ],
)
def test_parts_of_the_line_and_both_blow_holes_are_paths_of_their_own(effect, number, offset, opens, closes, largest):
    path = LINED.effects[effect][number]
    found = areas(path, FINE)
    assert (path.to, path.offset, len(LINED.effects[effect])) == ("neighbour", offset, 2)
    assert (degrees(found).min(), degrees(found).max()) == pytest.approx((opens, closes), abs=0.06)
    assert found.max() == pytest.approx(largest, rel=1e-12)
    assert found.min() >= 0.0
    known = np.degrees([*path.breakpoints, 0.0, LIFE])
    assert all(np.min(np.abs(known - kink)) < 0.1 for kink in kinks(path))


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"effects.interlobe_leakage": {"gap": "50 um", "length": "4 cm", "tip_length": "5 cm"}}, "longer than length"),
        ({"effects.blow_hole": {"area": "12 mm^2", "suction_area": "0 mm^2"}}, "greater than 0"),
        (
            {"effects.blow_hole": {"area": "6 mm^2", "suction_area": "5 mm^2", "suction_closes": "390 deg"}},
            "at least 400",
        ),
    ],
)
def test_parts_that_cannot_be_are_refused(changes, what):
    with pytest.raises(SceneError, match=what):
        make(changes)


PROFILED = Path(__file__).parents[2] / "configs" / "rotors" / "b.yaml"
FOUND = (
    "blow_hole.suction_area=5 mm^2",
    "blow_hole.opens=300 deg",
    "blow_hole.closes=600 deg",
    "blow_hole.suction_closes=430 deg",
    "end_face_leakage.suction_share=0.4",
    "interlobe_leakage.tip_length=5 mm",
)


@pytest.mark.parametrize("name", FOUND)
def test_a_profile_finds_these_parts_itself(name):
    with pytest.raises(SceneError, match=rf"{name.partition('=')[0]}: is given as well as"):
        load(PROFILED, (f"effects.{name}",))


def test_defaults_that_a_profile_does_not_use_may_be_written_out():
    """As a scene that a program wrote has them."""
    load(PROFILED, ("effects.blow_hole.opens=373 deg", "effects.end_face_leakage.suction_share=0.25"))


@pytest.mark.parametrize(
    ("angle", "tabled", "what"),
    [
        ({"opens": "380 deg"}, True, "is stated as well as area_file"),
        ({"closes": "680 deg"}, True, "is stated as well as area_file"),
        ({"suction_closes": "430 deg"}, False, "has no meaning without suction_area"),
    ],
)
def test_angles_that_nothing_uses_are_refused(angle, tabled, what, tmp_path):
    (tmp_path / "a.csv").write_text("angle_deg,area_m2\n100,0\n200,3e-6\n300,0\n")
    sized = {"area_file": str(tmp_path / "a.csv")} if tabled else {"area": "6 mm^2"}
    with pytest.raises(SceneError, match=rf"blow_hole\.{next(iter(angle))}: {what}"):
        make({"effects.blow_hole": {**sized, **angle}})
    make({"effects.blow_hole": sized})
    make({"effects.blow_hole": {"area": "6 mm^2", "suction_area": "5 mm^2", **angle}})


def test_suction_closes_beside_a_table_on_a_profile_is_refused(tmp_path):
    (tmp_path / "a.csv").write_text("angle_deg,area_m2\n100,0\n200,3e-6\n300,0\n")
    table = f"effects.blow_hole.area_file={tmp_path / 'a.csv'}"
    with pytest.raises(SceneError, match=r"suction_closes: is stated as well as area_file"):
        load(PROFILED, (table, "effects.blow_hole.suction_closes=430 deg"))
    load(PROFILED, (table,))


def test_both_end_face_paths_together_are_the_whole_length():
    most = [areas(PATHS[f"end_face_leakage neighbour {offset}"], FINE).max() for offset in (1, 4)]
    assert sum(most) == pytest.approx(50e-6 * 0.08, rel=1e-12)


@each_row("name", GAPS)
def test_gap_areas_are_proportional_to_their_clearance(name):
    path = GAPS[name]
    key = "size" if "size" in path.values else "gap"
    twice = FlowPath(path.to, path.area, {**path.values, key: 2 * path.values[key]}, path.breakpoints, path.offset)
    np.testing.assert_allclose(areas(twice, FINE[::50]), 2 * areas(path, FINE[::50]), rtol=1e-13)


@pytest.mark.parametrize("name", ["tip_leakage", "interlobe_leakage", "blow_hole"])
def test_a_table_takes_the_place_of_the_built_in_area(name, tmp_path):
    from scenes import make, scene_dict

    (tmp_path / "a.csv").write_text("angle_deg,area_m2\n100,0\n200,3e-6\n300,0\n")
    parameters = {**scene_dict()["effects"][name], "area_file": str(tmp_path / "a.csv")}
    path = build_parts(make({f"effects.{name}": parameters})).effects[name][0]
    assert gap.table_area(200 * DEG, pack_curve(*path.tables["curve"]), 0.0) == pytest.approx(3e-6, rel=1e-12)


@pytest.mark.parametrize("x", [-1.0, 0.0, 5.0, 6.0])
def test_ramp_is_zero_outside(x):
    assert gap.ramp(x, 0.0, 1.0, 4.0, 5.0) == 0.0


def test_ramp_is_c1():
    x = np.arange(-0.5, 5.5, 1e-4)
    slope = np.diff([gap.ramp(a, 0.0, 1.0, 4.0, 5.0) for a in x]) / 1e-4
    assert np.max(np.abs(np.diff(slope))) < 1e-3  # a curvature of 6 over 1e-4: no jump


# ---- the catalogue ----


def test_every_effect_states_what_it_is():
    for name, effect in catalogue().items():
        assert effect.name == name
        assert effect.title and effect.source and effect.equations


def test_ports_come_first():
    assert list(catalogue())[:2] == ["suction_port", "discharge_port"]


def test_an_effect_of_ones_own_is_found_by_its_dotted_name():
    assert isinstance(find_effect("screwsim.effects.tip_leakage"), Effect)


def test_a_module_without_effect_is_refused():
    with pytest.raises(ImportError, match="defines no EFFECT"):
        find_effect("screwsim.effects.parts.gap")


def test_an_unknown_name_is_a_key_error():
    with pytest.raises(KeyError):
        find_effect("tip_leakge")
