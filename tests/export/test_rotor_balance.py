"""Rotors stand but for their turning: gas, contact and bearings balance; a uniform pressure does nothing."""

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from screwsim.export.rotor_loads import (
    NAMES,
    PITCH_POINTS,
    Pressures,
    _gas_loads_at,
    contact_force,
    end_face,
    end_forces,
    loads_of,
    slope_at_pitch,
)
from screwsim.export.rotor_surface import ALONG, surfaces
from screwsim.export.source import spans_of
from screwsim.inputs.faults import UsageError
from screwsim.machine.profile_law import LaidCurves, laid_curves
from screwsim.machine.rotors.pair import outlines
from screwsim.machine.rotors.sections import polygon_area
from screwsim.scene import load

ROOT = Path(__file__).parents[2]
SPANS, SHAFTS = (0.04, 0.06), (0.06, 0.05)


@cache
def laid_of(name: str) -> LaidCurves:
    return laid_curves(load(ROOT / "configs" / "rotors" / f"{name}.yaml").machine)


def compressed(laid: LaidCurves) -> Pressures:
    """Return a polytropic compression from 3 bar."""
    angle = np.radians(np.arange(0.0, math.degrees(laid.life)))
    volume = laid.rotors.volume(np.clip(angle - laid.born, 0.0, laid.curves.life) + laid.rotors.start)
    ratio = np.where(angle > laid.injection, volume.max() / np.maximum(volume, 0.2 * volume.max()), 1.0)
    return Pressures(laid, angle, 3e5 * ratio**1.1, 3e5)


class Uniform(Pressures):
    """Every chamber, and all that is open to suction, at one pressure."""

    def at(self, phi):
        return np.full_like(phi, self.low + 1e5)


@pytest.fixture(scope="module", params=["a", "b", "c"])
def pressures(request) -> Pressures:
    return compressed(laid_of(request.param))


@pytest.fixture(scope="module")
def loads(pressures):
    return loads_of(pressures, SPANS, SHAFTS)


def test_forces_and_moments_of_gas_contact_and_bearings_balance(pressures, loads):
    """Moments are added up anew, of each force at its place, about a point that no force is given at."""
    rotors, c = pressures.laid.rotors, loads.columns
    z = np.linspace(0.0, rotors.length, ALONG + 1)
    about, step = 0.3 * rotors.length, 7
    angle = float(loads.angle[step])
    touch = contact_force(rotors, c["female_torque"])
    places = {"suction": -SPANS[0], "discharge": rotors.length + SPANS[1]}
    for name, surface, shaft, arm in zip(
        NAMES, surfaces(rotors), SHAFTS, (rotors.pair.r1, -rotors.pair.r2), strict=True
    ):
        gas = _gas_loads_at(pressures, surface, angle, z)
        ends = end_forces(surface, rotors, angle, 0.5 * shaft, pressures.excess)
        push = ends["suction_end_force"] + ends["discharge_end_force"]
        meets = {way: float(touch[name][f"contact_force_{way}"][step]) for way in "xyz"}
        size = abs(c[f"{name}_thrust_bearing"][step])
        assert abs(gas["axial_force"] + push + meets["z"] - c[f"{name}_thrust_bearing"][step]) < 1e-12 * size
        for way, lever in (("x", arm), ("y", 0.0)):
            bearings = {end: c[f"{name}_{end}_bearing_total_{way}"][step] for end in places}
            force = gas[f"force_{way}"] + meets[way]
            assert abs(force - sum(bearings.values())) < 1e-12 * size
            moment = gas[f"moment_{way}"] - about * gas[f"force_{way}"] + ends[f"end_moment_{way}"]
            moment += (0.5 * rotors.length - about) * meets[way] - lever * meets["z"]
            carried = sum(bearings[end] * (place - about) for end, place in places.items())
            assert abs(moment - carried) < 1e-12 * size * rotors.length
    for name, end in ((name, end) for name in NAMES for end in places):
        both = (c[f"{name}_{end}_bearing_total_{way}"] for way in "xy")
        np.testing.assert_allclose(c[f"{name}_{end}_bearing_total"], np.hypot(*both))


def test_the_torques_close_at_the_pitch_point(pressures, loads):
    pair, c = pressures.laid.rotors.pair, loads.columns
    on_female = -pair.r2 * c["female_contact_force_y"]  # it turns counter-clockwise, and the gas holds it back
    np.testing.assert_allclose(on_female, c["female_torque"], rtol=1e-13, atol=1e-13)
    on_male = pair.r1 * c["male_contact_force_y"]
    np.testing.assert_allclose(c["shaft_torque"], c["male_torque"] + on_male, rtol=1e-13)
    power = c["male_torque"] + pair.k * c["female_torque"]  # over the male's speed
    np.testing.assert_allclose(c["shaft_torque"], power, rtol=1e-13)
    for way in "xyz":
        np.testing.assert_array_equal(c[f"male_contact_force_{way}"], -c[f"female_contact_force_{way}"])
    assert c["female_contact_force_x"].min() >= 0.0  # flanks push, whichever of them touch


def test_the_contact_is_normal_to_the_helix_and_takes_up_the_female_s_flank_thrust(pressures, loads):
    """Σ over each helical surface: F_z h = −M_z of the male, and k M_z of the female, of gas as of the contact."""
    rotors, c = pressures.laid.rotors, loads.columns
    size = np.abs(c["male_axial_force"]).mean()
    assert np.max(np.abs(c["male_axial_force"] + c["male_torque"] / rotors.h)) < 1e-3 * size
    assert np.max(np.abs(c["male_contact_force_z"] + rotors.pair.r1 * c["male_contact_force_y"] / rotors.h)) < 1e-9
    ends = c["female_suction_end_force"] + c["female_discharge_end_force"]
    assert np.max(np.abs(c["female_thrust_bearing"] - ends)) < 1e-3 * size
    assert c["male_thrust_bearing"].max() < 0.0 and c["female_thrust_bearing"].max() < 0.0  # towards suction


@pytest.mark.parametrize("name", ["a", "b"])
def test_a_uniform_pressure_loads_no_bearing(name):
    one = compressed(laid_of(name))
    columns = loads_of(Uniform(one.laid, one.angle, one.pressure, one.low), SPANS, SHAFTS).columns
    for rotor, shaft, outline in zip(NAMES, SHAFTS, outlines(one.laid.rotors.pair, one.laid.rotors.chain), strict=True):
        area = polygon_area(*outline) - 0.25 * math.pi * shaft**2
        np.testing.assert_allclose(columns[f"{rotor}_suction_end_force"], 1e5 * area, rtol=0.01)  # of straight pieces
        np.testing.assert_allclose(columns[f"{rotor}_discharge_end_force"], -columns[f"{rotor}_suction_end_force"])
    for key, values in columns.items():
        if "end_force" not in key:
            assert np.max(np.abs(values)) < 1e-8, key
    assert len(columns["shaft_torque"]) == PITCH_POINTS


def test_sectors_of_an_end_face_have_area_and_centroid_of_what_they_are():
    rotors = laid_of("b").rotors
    for surface in surfaces(rotors):
        whole, cut = (end_face(surface, rotors, 0.4, rotors.length, shaft) for shaft in (0.0, 0.02))
        assert whole.area.sum() - cut.area.sum() == pytest.approx(math.pi * 0.02**2, rel=1e-12)
        size = 1e-12 * whole.area.sum() * rotors.pair.centre_distance
        for found in (whole, cut):
            assert abs(found.x.sum()) < size and abs(found.y.sum()) < size  # lobes alike all round
        # what the shaft takes of each: a narrow sector of its circle, with its centroid two thirds out, below the piece
        x, y, area = (getattr(whole, key) - getattr(cut, key) for key in ("x", "y", "area"))
        np.testing.assert_allclose(np.hypot(x, y), 2.0 / 3.0 * 0.02 * np.abs(area), rtol=0.01, atol=1e-15)
        below = (x * whole.x + y * whole.y) / (np.hypot(x, y) * np.hypot(whole.x, whole.y) + 1e-30)
        assert below[np.abs(area) > 1e-9].min() > 0.99


def test_the_normal_at_the_pitch_point_is_that_of_the_profile():
    for name in ("b", "c"):  # a straight rack flank at the pitch line
        scene = load(ROOT / "configs" / "rotors" / f"{name}.yaml")
        found = math.atan(slope_at_pitch(laid_curves(scene.machine).rotors, leading=True))
        assert found == pytest.approx(scene.machine.profile.pressure_angle, abs=math.radians(0.1))
    rotors = laid_of("a").rotors  # both flanks alike
    assert slope_at_pitch(rotors, True) == pytest.approx(slope_at_pitch(rotors, False), rel=1e-9)


def test_a_shaft_as_thick_as_the_root_is_told():
    one = compressed(laid_of("b"))
    with pytest.raises(UsageError, match=r"--shafts: 100 mm is not less than 96 mm, the male rotor's diameter"):
        loads_of(one, SPANS, (0.1, 0.05))
    with pytest.raises(UsageError, match=r"--shafts -1 mm,2 mm: a diameter cannot be negative"):
        spans_of("-1 mm,2 mm", "--shafts")
