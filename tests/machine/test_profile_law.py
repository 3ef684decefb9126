"""Curves of a rotor profile on the scene's angle axis: idle ends, whole pitches, areas that are the geometry's."""

import gc
import math
import re
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from screwsim.build import build_parts
from screwsim.effects import catalogue
from screwsim.effects.base import FlowPath
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.machine import laws, profile_law
from screwsim.machine.profile_law import BEND, KINK, laid_curves
from screwsim.machine.protocol import BLOW_HOLE
from screwsim.machine.rotors.flanks import FEW, female_flanks, male_flanks
from screwsim.machine.rotors.rotors import MOST_CACHED
from screwsim.numerics.spline import pack_curve
from screwsim.scene import load

CONFIGS = Path(__file__).parents[2] / "configs" / "rotors"
DEG = math.pi / 180.0
SCENES = {name: load(CONFIGS / f"{name}.yaml") for name in "abc"}
# tables have a row a degree: narrow bends of end-face lengths are rounded by a few percent, all else far less
NARROW, IN_THE_MEAN = 0.08, 2e-4


def area(path: FlowPath, angles):
    """Return the area [m²] of a path over angles [rad]."""
    values = {name: (pack_curve(*curve), 0) for name, curve in path.tables.items()}
    named = {**path.values, "TAB": values["curve"][0], "curve": 0.0}
    order = [name for name in path.area.arguments if name != "phi"]
    return np.array([path.area(phi, *(named[name] for name in order)) for phi in angles])


def paths(name: str) -> list[tuple[str, FlowPath]]:
    """Return (effect, path) of all paths of a scene, those of one effect in the order of its interfaces."""
    built = build_parts(SCENES[name]).effects
    return [(effect, p) for effect, items in built.items() for p in items if isinstance(p, FlowPath)]


def port(name: str, effect: str) -> FlowPath:
    return next(path for own, path in paths(name) if own == effect)


@pytest.mark.parametrize("name", SCENES)
def test_life_and_closing_are_whole_pitches_and_no_longer_than_they_must_be(name):
    laid = laid_curves(SCENES[name].machine)
    pitch = laid.rotors.pair.pitch
    for angle in (laid.life, laid.injection):
        assert angle / pitch == pytest.approx(round(angle / pitch), abs=1e-12)
    assert 0.0 <= laid.born < pitch
    assert 0.0 <= laid.life - laid.ends < pitch
    assert laid.ends - laid.born == pytest.approx(laid.rotors.life, abs=1e-12)


@pytest.mark.parametrize("name", SCENES)
def test_volume_is_that_of_the_rotors_and_largest_where_suction_closes(name):
    laid = laid_curves(SCENES[name].machine)
    phi = np.radians(np.arange(0.0, laid.life / DEG, 0.37))
    exact = laid.rotors.volume(phi - laid.born + laid.rotors.start)
    packed = pack_curve(*laid.volume.curve)
    found = np.array([laws.volume(x, packed, 0.0, 0.0) for x in phi])
    assert np.max(np.abs(found - exact)) < 1e-8 * laid.swept
    slopes = np.array([laws.volume_slope(x, packed, 0.0) for x in phi])
    inside = (phi > laid.born) & (phi < laid.ends)
    exact = laid.rotors.volume_slope(phi - laid.born + laid.rotors.start)
    assert np.mean(np.abs(slopes - exact)[inside]) < 1e-7 * np.abs(exact).max()
    assert np.max(np.abs(slopes - exact)[inside]) < 2e-6 * np.abs(exact).max()
    assert laws.volume(laid.injection, packed, 0.0, 0.0) == pytest.approx(laid.swept, rel=1e-12)


@pytest.mark.parametrize("name", SCENES)
def test_the_slope_of_the_table_is_that_of_the_rotors_at_every_row_on_both_sides(name):
    laid = laid_curves(SCENES[name].machine)
    exact = laid.rotors.volume_slope(laid.volume.angle - laid.born + laid.rotors.start)
    both = np.column_stack([exact[:-1], exact[1:]])
    assert laid.volume.slope == pytest.approx(both, abs=1e-12 * np.abs(exact).max())


@pytest.mark.parametrize("name", SCENES)
def test_steps_end_where_a_curve_bends(name):
    """Off the breakpoints the second derivative of V changes little from row to row, and no area has a kink."""
    laid = laid_curves(SCENES[name].machine)
    angle, slope = laid.volume.angle, laid.volume.slope[:, 0]
    bends = np.diff(slope) / np.diff(angle[:-1]) / laid.swept
    free = _free(laid.volume, 2.0 * DEG)[:-1]
    assert np.max(np.abs(np.diff(bends))[free]) < 2.0 * BEND
    for interfaces in laid.interfaces.values():
        for table in (one.table for one in interfaces):
            jump = np.abs(table.slope[1:, 0] - table.slope[:-1, 1]) / table.value.max()
            assert np.max(jump[_free(table, 1e-9)]) <= KINK


def _free(table, distance):
    """Return which inner rows of a table lie farther than an angle [rad] from all its breakpoints."""
    return np.min(np.abs(table.angle[1:-1, None] - np.array(table.breakpoints)), axis=1) > distance


@pytest.mark.parametrize("name", SCENES)
def test_an_idle_chamber_has_no_opening_and_its_volume_rests(name):
    laid, geometry = laid_curves(SCENES[name].machine), build_parts(SCENES[name]).geometry
    before, after = np.linspace(0.0, laid.born - 1e-9, 20), np.linspace(laid.ends + 1e-9, laid.life, 20)
    for _, path in paths(name):
        offset, own = path.offset, np.concatenate([before, after])
        assert not area(path, own).any()  # as the trailing one
        assert not area(path, own - offset * geometry.pitch).any()  # as the leading one
    law = geometry.volume_law()
    TAB = pack_curve(*law.tables["volume_curve"])
    dead = [law.volume(phi, TAB, 0.0, law.values["V_min"]) for phi in (*before, *after)]
    assert dead == pytest.approx([1e-4 * laid.swept] * 40, rel=1e-6)


@pytest.mark.parametrize("name", ["b", "c"])
def test_areas_are_clearance_times_the_lengths_of_the_geometry(name):
    laid, clearance = laid_curves(SCENES[name].machine), 40e-6
    for gap, groups in profile_law.PATHS.items():
        found = [path for own, path in paths(name) if gap in catalogue()[own].needs]
        assert [path.offset for path in found] == [one.offset for one in laid.interfaces[gap]]
        for kinds in groups:
            curves = {}
            for path in laid.curves.paths:
                if path.name in kinds or path.name.rpartition("_")[0] in kinds:
                    curves.setdefault(path.offset, []).append(path)
            for offset, parts in sorted(curves.items()):
                trapped = laid.curves.suction_closes - offset * laid.rotors.pair.pitch
                # past the birth, where a path opens from nothing, and past the closing of the leading chamber's suction
                own = np.radians(np.arange(20.5, 700.0, 0.5))
                own = own[own > trapped] if any(p.name.startswith("suction") for p in parts) else own
                exact = sum(np.interp(own, p.behind.angle, p.behind.value, left=0.0, right=0.0) for p in parts)
                if not np.max(exact) > 0.0:
                    continue
                exact = exact * (1.0 if gap == BLOW_HOLE else clearance)
                error = np.abs(area(found.pop(0), own + laid.born) - exact)
                assert np.max(error) < NARROW * exact.max(), (gap, offset)
                assert np.mean(error) < IN_THE_MEAN * exact.max(), (gap, offset)
        assert not found


@pytest.mark.parametrize("name", SCENES)
def test_paths_on_the_suction_side_open_as_suction_closes(name):
    """The blow-hole at the suction cusp is whole when suction closes, and nothing 30° before."""
    laid = laid_curves(SCENES[name].machine)
    pitch, table = laid.rotors.pair.pitch, laid.interfaces[BLOW_HOLE][1].table
    before, closed = (np.interp(laid.injection - pitch - x, table.angle, table.value) for x in (30.0 * DEG, 0.0))
    assert before < 1e-6 * table.value.max()
    assert closed == pytest.approx(laid.rotors.suction_blow_hole.area(laid.rotors.h), rel=1e-3)
    assert table.angle[-1] + pitch < laid.opens  # it is shut long before discharge


@pytest.mark.parametrize("name", SCENES)
def test_the_port_opens_at_the_built_in_ratio_and_suction_is_shut_from_the_largest_volume_on(name):
    laid, discharge = laid_curves(SCENES[name].machine), port(name, "discharge_port")
    volume = laid.rotors.volume(np.array([laid.opens - laid.born + laid.rotors.start]))[0]
    assert laid.swept / volume == pytest.approx(3.2, rel=1e-9)
    assert not area(discharge, [laid.opens - 1.001 * DEG]).any()
    assert area(discharge, [laid.opens + 1.0 * DEG]).all()
    assert not area(port(name, "suction_port"), np.linspace(laid.injection + 1e-9, laid.life, 50)).any()


def test_the_same_rotors_are_computed_once():
    machine = SCENES["b"].machine
    other = replace(machine, built_in_volume_ratio=2.6)
    assert laid_curves(machine) is laid_curves(replace(machine))
    assert laid_curves(other).rotors is laid_curves(machine).rotors
    longer = replace(machine, rotor_length=0.2)
    assert laid_curves(longer).rotors.chain is laid_curves(machine).rotors.chain


def test_a_given_blow_hole_scales_the_profile_s():
    scene = load(CONFIGS / "b.yaml", ["effects.blow_hole.area=20 mm^2"])
    own = build_parts(scene).effects["blow_hole"][0]
    assert own.tables["curve"][1].max() == pytest.approx(20e-6, rel=1e-12)


def test_without_a_ratio_there_is_one_line():
    with pytest.raises(UsageError, match=r"^machine.built_in_volume_ratio: is missing"):
        laid_curves(replace(SCENES["b"].machine, built_in_volume_ratio=None))


def test_of_many_profiles_no_more_are_kept_than_is_stated():
    machine, made = SCENES["b"].machine, []
    for i in range(MOST_CACHED + 10):
        radius = machine.profile.flank_radius + 1e-6 * (i + 1)
        laid = laid_curves(replace(machine, profile=replace(machine.profile, flank_radius=radius)))
        flanks = male_flanks(laid.rotors.pair, laid.rotors.chain), female_flanks(laid.rotors.pair, laid.rotors.chain)
        made.append([weakref.ref(each) for each in (laid, laid.rotors, laid.rotors.chain, *flanks)])
    del laid, flanks
    gc.collect()
    alive = [sum(each() is not None for each in kind) for kind in zip(*made, strict=True)]
    assert alive[:3] == [MOST_CACHED] * 3  # the last ones, with their rotors and chains
    assert alive[3:] == [FEW] * 2


@pytest.mark.parametrize(
    ("window", "told"),
    [
        ("opens: 10 deg, closes: 50 deg", "opens: lies before 54.85 deg, where the chamber's volume begins"),
        ("opens: 10 deg, closes: 110 deg", "opens: lies before 54.85 deg, where the chamber's volume begins"),
        ("opens: 700 deg, closes: 840 deg", "closes: lies beyond 836.27 deg, where the chamber's volume ends"),
        ("opens: 700 deg, closes: 901 deg", "closes: lies beyond the chamber's life of 900 deg"),
        ("opens: 54.85 deg, closes: 836.27 deg", None),
    ],
)
@pytest.mark.parametrize("effect", ["oil_injection={", "economizer={temperature: 20 degC, area: 1 cm^2, "])
def test_a_port_faces_a_chamber_only_while_it_has_a_volume(effect, window, told):
    change = f"effects.{effect}{window}}}"
    if told is None:
        assert load(CONFIGS / "b.yaml", [change])
        return
    with pytest.raises(SceneError, match=re.escape(f".{told}")):
        load(CONFIGS / "b.yaml", [change])
