"""Rotors stand but for their turning: gas, contact and bearings balance; a uniform pressure does nothing."""

import math
from functools import cache

import numpy as np
import pytest
from folders import CONFIGS
from rotor_mesh import end_loads, gas_loads

from screwsim.export.rotor_loads import PITCH_POINTS, Pressures, Supports, loads_of
from screwsim.export.source import spans_of
from screwsim.inputs.faults import UsageError
from screwsim.machine.profile_law import LaidCurves, laid_curves
from screwsim.machine.rotors.contact import contact_force, slope_at_pitch
from screwsim.machine.rotors.loads import NAMES, bearing_forces, chambers_at, pressed_areas, rotor_loads, sectors
from screwsim.machine.rotors.pair import outlines
from screwsim.machine.rotors.sections import polygon_area
from screwsim.machine.rotors.surface import surfaces
from screwsim.scene import load

SPANS, SHAFTS = (0.04, 0.06), (0.06, 0.05)
SUPPORTS = Supports((SPANS, SPANS), SHAFTS)


@cache
def laid_of(name: str) -> LaidCurves:
    return laid_curves(load(CONFIGS / "rotors" / f"{name}.yaml").machine)


def compressed(laid: LaidCurves) -> Pressures:
    """Return a polytropic compression from 3 bar."""
    angle = np.radians(np.arange(0.0, math.degrees(laid.life)))
    volume = laid.rotors.volume(np.clip(angle - laid.born, 0.0, laid.curves.life) + laid.rotors.start)
    ratio = np.where(angle > laid.injection, volume.max() / np.maximum(volume, 0.2 * volume.max()), 1.0)
    return Pressures(laid, laid.on_rotors(angle, False), 3e5 * ratio**1.1, 3e5)


class Uniform(Pressures):
    """Every chamber, and all that is open to suction, at one pressure."""

    def at(self, phi):
        return np.full_like(phi, self.low + 1e5)


@pytest.fixture(scope="module", params=["a", "b", "c"])
def pressures(request) -> Pressures:
    return compressed(laid_of(request.param))


@pytest.fixture(scope="module")
def loads(pressures):
    return loads_of(pressures, SUPPORTS)


def own_loads(pressures: Pressures, angle: float) -> dict[str, dict[str, float]]:
    """Return the loads of both rotors at one angle."""
    rotors, areas = pressures.laid.rotors, pressed_areas(pressures.laid.rotors, SHAFTS)
    phi = chambers_at(rotors, areas, np.array([angle]))
    found = rotor_loads(rotors, [of.at(phi) for of in areas], pressures.excess(phi))
    return {name: {key: float(values[0]) for key, values in own.items()} for name, own in found.items()}


def test_areas_by_sections_press_as_a_mesh_of_both_surfaces_does(pressures):
    """M158, of the flanks within a hundredth of the thrust, moments of the ends within four thousandths."""
    rotors = pressures.laid.rotors
    for angle in (0.1, 0.53, 1.24):
        found = own_loads(pressures, angle)
        for name, surface, shaft in zip(NAMES, surfaces(rotors), SHAFTS, strict=True):
            meshed = gas_loads(pressures, surface, angle) | end_loads(pressures, surface, angle, shaft)
            size = abs(found["male"]["thrust"])
            for key, value in meshed.items():
                scale = size if "force" in key else size * rotors.length
                within = 0.004 if key.startswith("end_moment") else 0.01
                assert abs(found[name][key] - value) < within * scale, (name, key)


def test_forces_and_moments_of_gas_contact_and_bearings_balance(pressures, loads):
    """Moments are added up anew, of each force at its place, about a point that no force is given at."""
    rotors, (angles, c) = pressures.laid.rotors, loads
    about, step = 0.3 * rotors.length, 7
    angle = float(angles[step])
    touch, found = contact_force(rotors, c["female_torque"]), own_loads(pressures, angle)
    places = {"suction": -SPANS[0], "discharge": rotors.length + SPANS[1]}
    for name, arm in zip(NAMES, (rotors.pair.r1, -rotors.pair.r2), strict=True):
        gas = found[name]
        push = gas["suction_end_force"] + gas["discharge_end_force"]
        meets = {way: float(touch[name][f"contact_force_{way}"][step]) for way in "xyz"}
        size = abs(c[f"{name}_thrust_bearing"][step])
        assert abs(gas["axial_force"] + push + meets["z"] - c[f"{name}_thrust_bearing"][step]) < 1e-12 * size
        for way, lever in (("x", arm), ("y", 0.0)):
            bearings = {end: c[f"{name}_{end}_bearing_total_{way}"][step] for end in places}
            force = gas[f"force_{way}"] + meets[way]
            assert abs(force - sum(bearings.values())) < 1e-12 * size
            moment = gas[f"moment_{way}"] - about * gas[f"force_{way}"] + gas[f"end_moment_{way}"]
            moment += (0.5 * rotors.length - about) * meets[way] - lever * meets["z"]
            carried = sum(bearings[end] * (place - about) for end, place in places.items())
            assert abs(moment - carried) < 1e-12 * size * rotors.length
    for name, end in ((name, end) for name in NAMES for end in places):
        both = (c[f"{name}_{end}_bearing_total_{way}"] for way in "xy")
        np.testing.assert_allclose(c[f"{name}_{end}_bearing_total"], np.hypot(*both))


def test_bearings_hold_the_moments_of_a_mesh_about_each_other(pressures):
    """M480: Σ of moments of the meshed surfaces and of the contact about one bearing gives the other's force."""
    rotors = pressures.laid.rotors
    places = {"suction": -SPANS[0], "discharge": rotors.length + SPANS[1]}
    for angle in (0.1, 0.53, 1.24):
        own = own_loads(pressures, angle)
        thrust = abs(own["male"]["thrust"])
        touch = contact_force(rotors, np.array([own["female"]["torque"]]))
        arms = {"male": rotors.pair.r1, "female": -rotors.pair.r2}
        for name, surface, shaft in zip(NAMES, surfaces(rotors), SHAFTS, strict=True):
            carried = bearing_forces(own[name], rotors.length, SPANS)
            gas = gas_loads(pressures, surface, angle) | end_loads(pressures, surface, angle, shaft)
            meets = {way: float(touch[name][f"contact_force_{way}"][0]) for way in "xyz"}
            for end, about in (("suction", places["discharge"]), ("discharge", places["suction"])):
                for way, lever in (("x", arms[name]), ("y", 0.0)):
                    moment = gas[f"moment_{way}"] - about * gas[f"force_{way}"] + gas[f"end_moment_{way}"]
                    moment += (0.5 * rotors.length - about) * meets[way] - lever * meets["z"]
                    force = moment / (places[end] - about)
                    assert abs(carried[f"{end}_bearing_{way}"] - force) < 0.01 * thrust, (name, end, way)
            for way in "xy":
                both = sum(carried[f"{end}_bearing_{way}"] for end in places)
                assert both == pytest.approx(own[name][f"total_{way}"], rel=1e-12, abs=1e-9 * thrust)


def test_the_torques_close_at_the_pitch_point(pressures, loads):
    pair, c = pressures.laid.rotors.pair, loads[1]
    on_female = -pair.r2 * c["female_contact_force_y"]  # it turns counter-clockwise, and the gas holds it back
    np.testing.assert_allclose(on_female, c["female_torque"], rtol=1e-13, atol=1e-13)
    on_male = pair.r1 * c["male_contact_force_y"]
    np.testing.assert_allclose(c["gas_torque"], c["male_torque"] + on_male, rtol=1e-13)
    power = c["male_torque"] + pair.k * c["female_torque"]  # over the male's speed
    np.testing.assert_allclose(c["gas_torque"], power, rtol=1e-13)
    for way in "xyz":
        np.testing.assert_array_equal(c[f"male_contact_force_{way}"], -c[f"female_contact_force_{way}"])
    assert c["female_contact_force_x"].min() >= 0.0  # flanks push, whichever of them touch


def test_the_contact_is_normal_to_the_helix_and_takes_up_the_female_s_flank_thrust(pressures, loads):
    """Σ over each helical surface: F_z h = −M_z of the male, and k M_z of the female, of gas as of the contact."""
    rotors, c = pressures.laid.rotors, loads[1]
    size = np.abs(c["male_axial_force"]).mean()
    assert np.max(np.abs(c["male_axial_force"] + c["male_torque"] / rotors.h)) < 1e-3 * size
    assert np.max(np.abs(c["male_contact_force_z"] + rotors.pair.r1 * c["male_contact_force_y"] / rotors.h)) < 1e-9
    ends = c["female_suction_end_force"] + c["female_discharge_end_force"]
    assert np.max(np.abs(c["female_thrust_bearing"] - ends)) < 1e-3 * size
    assert c["male_thrust_bearing"].max() < 0.0 and c["female_thrust_bearing"].max() < 0.0  # towards suction


OTHER_LOBES = {  # lobes; A, R1, R2, flank radius, wrap [mm, deg]
    "3/5": (3, 5, 100, 53, 65, 24, 250),
    "5/6": (5, 6, 100, 62, 58, 14, 210),
    "6/7": (6, 7, 100, 60, 58, 12, 330),
}


@pytest.mark.parametrize("lobes", OTHER_LOBES)
def test_the_torques_are_those_of_virtual_work_whatever_lobes_and_wrap(lobes):
    """Male within 0.5 %, female within 2 % of the male's (open blow-hole); both do −Σ p dV/dφ of all chambers."""
    male, female, A, R1, R2, rho, wrap = OTHER_LOBES[lobes]
    profile = f"centre_distance: {A} mm, female_diameter: {2 * R2} mm, wrap_angle: {wrap} deg, male_tip_radius: 1 mm, "
    profile += f"female_tip_radius: 6 mm, flank_radius: {rho} mm, pressure_angle: 33 deg, root_radius: 3 mm"
    sizes = f"male_lobes: {male}, female_lobes: {female}, rotor_diameter: {2 * R1} mm, rotor_length: 130 mm"
    changes = [f"machine={{{sizes}, built_in_volume_ratio: 2.5, profile: {{kind: rack, {profile}}}}}"]
    one = compressed(laid_curves(load(CONFIGS / "rotors" / "b.yaml", changes).machine))
    angles, c = loads_of(one, SUPPORTS)
    size, pair = np.abs(c["male_torque"]).max(), one.laid.rotors.pair
    for name, within in (("male", 0.005), ("female", 0.02)):
        assert np.max(np.abs(c[f"{name}_torque"] - c[f"{name}_torque_by_virtual_work"])) < within * size
    both = c["male_torque_by_virtual_work"] + pair.k * c["female_torque_by_virtual_work"]
    phi = angles[:, None] + pair.pitch * np.arange(-20, 21)
    work = np.where((phi >= one.laid.rotors.start) & (phi <= one.laid.rotors.wrap), one.excess(phi), 0.0)
    np.testing.assert_allclose(both, -(work * one.laid.rotors.volume_slope(phi)).sum(axis=1), rtol=1e-9)


@pytest.mark.parametrize("name", ["a", "b"])
def test_a_uniform_pressure_loads_no_bearing(name):
    one = compressed(laid_of(name))
    columns = loads_of(Uniform(one.laid, one.angle, one.pressure, one.low), SUPPORTS)[1]
    for rotor, shaft, outline in zip(NAMES, SHAFTS, outlines(one.laid.rotors.pair, one.laid.rotors.chain), strict=True):
        area = polygon_area(*outline) - 0.25 * math.pi * shaft**2
        np.testing.assert_allclose(columns[f"{rotor}_suction_end_force"], 1e5 * area, rtol=0.01)  # of straight pieces
        np.testing.assert_allclose(columns[f"{rotor}_discharge_end_force"], -columns[f"{rotor}_suction_end_force"])
    for key, values in columns.items():
        if "end_force" not in key:
            assert np.max(np.abs(values)) < 1e-6, key  # of thousands of newtons
    assert len(columns["gas_torque"]) == PITCH_POINTS


def test_sectors_of_an_end_face_have_area_and_centroid_of_what_they_are():
    for surface in surfaces(laid_of("b").rotors):
        whole, cut = (sectors(surface, shaft) for shaft in (0.0, 0.02))
        taken, x, y = (before - after for before, after in zip(whole, cut, strict=True))
        assert surface.lobes * taken.sum() == pytest.approx(math.pi * 0.02**2, rel=1e-12)
        # what the shaft takes of each: a narrow sector of its circle, with its centroid two thirds out, below the piece
        np.testing.assert_allclose(np.hypot(x, y), 2.0 / 3.0 * 0.02 * np.abs(taken), rtol=0.01, atol=1e-15)
        below = (x * whole[1] + y * whole[2]) / (np.hypot(x, y) * np.hypot(whole[1], whole[2]) + 1e-30)
        assert below[np.abs(taken) > 1e-9].min() > 0.99


def test_the_normal_at_the_pitch_point_is_that_of_the_profile():
    for name in ("b", "c"):  # a straight rack flank at the pitch line
        scene = load(CONFIGS / "rotors" / f"{name}.yaml")
        found = math.atan(slope_at_pitch(laid_curves(scene.machine).rotors, leading=True))
        assert found == pytest.approx(scene.machine.profile.pressure_angle, abs=math.radians(0.1))
    rotors = laid_of("a").rotors  # both flanks alike
    assert slope_at_pitch(rotors, True) == pytest.approx(slope_at_pitch(rotors, False), rel=1e-9)


def test_a_shaft_as_thick_as_the_root_is_told():
    one = compressed(laid_of("b"))
    with pytest.raises(UsageError, match=r"--shafts: 100 mm is not less than 96 mm, the male rotor's diameter"):
        loads_of(one, Supports(shafts=(0.1, 0.05)))
    with pytest.raises(UsageError, match=r"--shafts -1 mm,2 mm: a diameter cannot be negative"):
        spans_of("-1 mm,2 mm", "--shafts")
