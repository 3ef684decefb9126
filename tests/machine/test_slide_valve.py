"""A slide valve of rotors with a profile: areas of its ports, and what a machine with it does."""

import re
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from each_row import each_row
from scenes import balanced

from screwsim.explain import explain
from screwsim.inputs.faults import SceneError
from screwsim.machine.kinds import kind_of
from screwsim.machine.rotors.curves import closed_in
from screwsim.scene import load
from screwsim.scene.plausible import scene_warnings
from screwsim.simulate import simulate_many

ROTORS = Path(__file__).parents[2] / "configs" / "rotors"
POSITIONS = (0.0, 0.001, 0.25, 0.5, 0.75, 1.0)
SPANS = "male_span: 70 deg, female_span: 60 deg"
LEFT_OUT = (
    "tip_leakage",
    "interlobe_leakage",
    "blow_hole",
    "end_face_leakage",
    "oil_heat",
    "oil_pump",
    "hydromechanical",
    "mechanical",
)
SLOW = (  # an ideal machine, so slow that no port throttles
    "gas.model=ideal",
    "operation={speed: 6 rpm, evaporating_temperature: null, condensing_temperature: null, superheat: null, "
    "suction: {pressure: 3 bar, temperature: 285 K}, discharge: {pressure: 8 bar}}",
    "oil_supply=null",
    "numerics.error=none",
    "effects.slide_valve={}",
)


def slide(position, more="", travel="90 mm"):
    return f"machine.slide_valve={{position: {position}, travel: {travel}, {SPANS}{more}}}"


@cache
def laid(position, more="", *others):
    scene = load(ROTORS / "b.yaml", [slide(position, more), "effects.slide_valve={}", *others])
    return kind_of(scene.machine).geometry(scene.machine).profile


@cache
def results(speed="6 rpm"):
    changes = [*SLOW, f"operation.speed={speed}"]
    scenes = [load(ROTORS / "b.yaml", [*changes, slide(x)], LEFT_OUT) for x in POSITIONS]
    return dict(zip(POSITIONS, simulate_many(scenes, trace=True), strict=True))


def strip(rotors, side, low, high, span, phi, n=1200):
    """Return the area [m²] of a strip of a bore that a chamber covers, counted in cells; shares no formula."""
    pair, chain, h = rotors.pair, rotors.chain, rotors.h
    if side == "male":
        radius, turned, end, width = pair.male_radius, 1.0, pair.beta1, pair.pitch
    else:
        radius, turned, width = pair.female_radius, pair.k, chain.land_start - chain.land_end
        end = pair.beta2 / pair.k - chain.land_start
    z = low + (high - low) * (np.arange(n) + 0.5) / n
    theta = span * (np.arange(n) + 0.5) / n  # of the rotor's own turn, from the cusp back
    behind = (phi - z / h)[:, None] + end + theta[None, :] / turned  # male angle since the trailing tip passed the cell
    covered = (behind <= 0.0) & (behind >= -width)
    return float(covered.mean()) * radius * span * (high - low)


def test_at_full_load_the_port_is_the_one_without_a_slide():
    plain = load(ROTORS / "b.yaml")
    fixed = kind_of(plain.machine).geometry(plain.machine).profile
    full = laid(0.0)
    assert np.array_equal(full.discharge.value, fixed.discharge.value)
    assert full.discharge.breakpoints == fixed.discharge.breakpoints
    assert full.slot.value.max() == 0.0
    assert full.volume_ratio is None


@pytest.mark.parametrize("degrees", [360.0, 420.0, 480.0, 540.0])
def test_the_slot_has_the_area_that_is_counted_on_the_bores(degrees):
    found = laid(0.7)
    rotors, low, high = found.rotors, 0.0, 0.7 * 90e-3
    phi = np.radians(degrees) + rotors.start
    counted = sum(
        strip(rotors, side, low, high, np.radians(span), phi) for side, span in (("male", 70.0), ("female", 60.0))
    )
    at = float(np.interp(phi - rotors.start, found.curves.slot.angle, found.curves.slot.value))
    assert at == pytest.approx(counted, rel=3e-3, abs=1e-6)  # 1200 cells a side


@pytest.mark.parametrize("position", [0.25, 1.0])
def test_over_the_angle_each_point_of_the_slot_is_open_for_the_width_of_a_groove(position):
    """∫ S dφ = Σ (span's arc) (its length) (groove's width): exact, whatever the shape."""
    found = laid(position)
    rotors, curve = found.rotors, found.curves.slot
    pair, moved = rotors.pair, position * 90e-3
    groove = rotors.chain.land_end - rotors.chain.land_start
    exact = moved * pair.male_radius * np.radians(70.0) * pair.pitch
    exact += moved * pair.female_radius * np.radians(60.0) * -groove
    assert np.trapezoid(curve.value, curve.angle) == pytest.approx(exact, rel=2e-4)  # trapezia of 0.5°


def test_the_edge_of_the_radial_port_moves_by_the_slides_way_and_the_axial_port_stays():
    full, part = laid(0.0).curves.discharge, laid(0.2).curves.discharge
    rotors = laid(0.2).rotors
    angle = np.radians(np.arange(600.0, 780.0, 1.0))
    one, two = (np.interp(angle, each["axial"].angle, each["axial"].value) for each in (full, part))
    assert one == pytest.approx(two, abs=5e-4 * one.max())  # rows of 0.5° at other angles
    radial = part["radial"]
    first = radial.angle[np.flatnonzero(radial.value > 0.0)[0]]
    edge = laid(0.0).curves.discharge_opens + 0.2 * 90e-3 / rotors.h
    assert edge < first <= edge + np.radians(1.0)
    assert 0.0 < radial.value.max() < 0.5 * full["radial"].value.max()


def test_the_radial_port_of_a_moved_slide_is_that_of_a_higher_ratio():
    """Moved by s its edge is at φ_dis + s/h: the fixed radial port of the ratio at that angle."""
    rotors = laid(0.0).rotors
    at = laid(0.0).curves.discharge_opens + rotors.start + 0.2 * 90e-3 / rotors.h
    ratio = rotors.largest[1] / float(rotors.volume(np.array([at]))[0])
    scene = load(ROTORS / "b.yaml", [f"machine.built_in_volume_ratio={ratio!r}"])
    other = kind_of(scene.machine).geometry(scene.machine).profile.curves.discharge["radial"]
    angle = np.radians(np.arange(640.0, 760.0, 7.0))
    mine = laid(0.2).curves.discharge["radial"]
    found, fixed = (np.interp(angle, each.angle, each.value) for each in (mine, other))
    assert found == pytest.approx(fixed, abs=2e-3 * other.value.max())  # rows of 0.5° at other angles


def test_volume_and_volume_ratio_over_the_position_are_those_of_the_rotors():
    """The slot is passed where the trailing tip leaves its end at the cusp, φ = s/h − β: V there, linear between."""
    rotors = laid(1.0).rotors
    pair, chain = rotors.pair, rotors.chain
    last = max(-pair.beta1, chain.land_start - pair.beta2 / pair.k)
    opens = laid(0.0).curves.discharge_opens + rotors.start
    for x in POSITIONS[1:]:
        passed = x * 90e-3 / rotors.h + last
        V, end = (float(rotors.volume(np.array([at]))[0]) for at in (passed, opens))
        assert closed_in(rotors, laid(x).curves) == pytest.approx((V / rotors.largest[1], V / end), rel=1e-12)
        area = laid(x).curves.slot
        shut = area.angle[np.flatnonzero(area.value > 0.0)[-1]] + rotors.start
        assert passed - np.radians(0.6) < shut <= passed + 1e-9


def test_a_stop_that_gives_another_ratio_takes_the_slot_with_it():
    """The slide keeps its length: where its edge stands earlier its other end does, by the same way."""
    apex = {}
    for ratio in (3.2, 2.6):
        found = laid(0.01, ", length: 130 mm", f"machine.built_in_volume_ratio={ratio}", "machine.axial_volume_ratio=5")
        apex[ratio] = found.curves.discharge_opens - found.curves.compresses
    assert apex[2.6] == pytest.approx(apex[3.2], abs=1e-9)


def test_every_position_closes_mass_energy_and_entropy():
    for result in results("600 rpm").values():
        assert abs(balanced(result).ledger.relative_residue) < 1e-3


def test_the_flow_follows_the_volume_that_is_closed_in():
    """No leaks, and ports that hardly throttle: λ = V/V_max; the slot of a thousandth lets hardly anything out."""
    found = {x: result.performance.volumetric_efficiency for x, result in results().items()}
    values = list(found.values())
    assert all(one > two for one, two in pairwise(values))
    assert found[0.0] == pytest.approx(1.0, abs=1e-3)
    for x in POSITIONS[2:]:
        share = closed_in(laid(x).rotors, laid(x).curves)[0]
        assert (
            share - 1e-3 < found[x] < share + 0.015
        )  # the slot throttles as it shuts, with the cube root of the speed
        assert results()[x].performance.built_in_volume_ratio == pytest.approx(laid(x).volume_ratio)


def test_explain_tells_what_the_slide_closes_in():
    text = explain(load(ROTORS / "b.yaml", [slide(0.5), "effects.slide_valve={}"]))
    assert "traps 63.9 % of the volume" in " ".join(str(text).split())


@each_row(
    ("changes", "told"),
    [
        ((slide(0.5, travel="1 m"),), "travel: 1000 mm brings the slot to chambers whose axial port is open (choose"),
        ((slide(0.5, ", length: 5 mm"),), "length: 5 mm lets the slot reach a chamber whose radial port is open"),
        (
            (slide(0.5).replace("70 deg", "20 deg"),),
            "male_span: 20 deg: the radial port at full load reaches 29.42 deg from the cusp (choose a wider slide",
        ),
        ((slide(0.5).replace("60 deg", "300 deg"),), "female_span: 300 deg is more than the bore's"),
        (
            (slide(0.5), "effects.slide_valve={position: 0.5}"),
            "effects.slide_valve.position: is given as well as machine.slide_valve, which finds it from the rotors "
            "(remove it)",
        ),
        (("effects.slide_valve={}",), "effects.slide_valve.slot_area: is missing (write e.g. slot_area: 40 cm^2, or"),
    ],
)
def test_a_slide_that_cannot_be_is_refused_in_one_line(changes, told):
    with pytest.raises(SceneError, match=re.escape(told)):
        load(ROTORS / "b.yaml", changes)


def test_a_slide_needs_rotors():
    with pytest.raises(
        SceneError, match=re.escape("machine.slide_valve: needs rotors: machine.volume.law and machine")
    ):
        load(ROTORS.parent / "r134a" / "point.yaml", [slide(0.5)])


def test_a_moved_slide_without_its_effect_is_warned_of():
    """Its radial port moves, and no slot opens: the machine would keep its full flow at any position."""
    moved = [slide(0.5)]
    (warning,) = scene_warnings(load(ROTORS / "b.yaml", moved))
    assert warning.startswith("machine.slide_valve.position: moves the radial port alone")
    assert "write effects.slide_valve: {}" in warning
    for changes in ([*moved, "effects.slide_valve={}"], [slide(0.0)]):
        assert scene_warnings(load(ROTORS / "b.yaml", changes)) == ()
