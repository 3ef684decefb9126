"""Against solids: sections, volume, ports, blow-holes and end faces counted in pixels of both rotors (`solids`).

Pixels of 20 µm make the rotors about 10 µm too thick: 2 mm² of the 1200 mm² of a section whose walls are 200 mm long.
"""

import math
from functools import cache

import numpy as np
import pytest
from solids import STEP, Solids

from screwsim.machine.rotors import closed_form, leakage, ports
from screwsim.machine.rotors.checks import mesh
from screwsim.machine.rotors.flanks import male_flanks
from screwsim.machine.rotors.leakage import blow_hole_opening, mirrored
from screwsim.machine.rotors.pair import outlines
from screwsim.machine.rotors.rotors import make_rotors
from screwsim.machine.rotors.settings import Profile

MM, DEG = 1e-3, math.pi / 180.0
THICK = 2.2 * MM**2  # what the thickness of the pixels takes off a section


@pytest.fixture(scope="module")
def pixels_of(pairs):
    """Return a function that gives a pair as pixels, drawn once."""
    return cache(lambda name: Solids(pairs[name]))


@pytest.fixture(scope="module")
def solids(pixels_of):
    """Return (b) as pixels."""
    return pixels_of("b")


@pytest.mark.parametrize(
    ("name", "angles"), [("a", (-250, -60, -40)), ("b", (-250, -100, -30)), ("c", (-110, -80, -25))]
)
def test_sections_are_the_free_pixels(pairs, pixels_of, name, angles):
    rotors, pixels = pairs[name], pixels_of(name)
    for angle in angles:
        counted = pixels.chamber(angle * DEG).sum() * STEP**2
        expected = rotors.sections.area_at(np.array([angle * DEG]))[0]
        assert counted == pytest.approx(expected, abs=THICK)


def test_volume_is_that_of_the_solids(pairs, solids):
    """V at 0°, 100°, 200° from counted sections 10° apart, none of them where a blow-hole is open (−125°, −35°)."""
    from scipy.interpolate import PchipInterpolator

    psi = np.array([-300, -200, -128, -120, -110, -100, -90, -80, -70, -60, -50, -40, -30, -20, -10, 0]) * DEG
    area = np.array([solids.chamber(angle).sum() * STEP**2 for angle in psi])
    rotors, total = pairs["b"], PchipInterpolator(psi, area).antiderivative()
    for phi in (0.0, 100.0 * DEG, 200.0 * DEG):
        counted = rotors.h * float(total(0.0) - total(phi - rotors.wrap))
        thick = rotors.h * THICK * (rotors.wrap - phi)
        assert counted == pytest.approx(rotors.volume(np.array([phi]))[0], abs=thick + 2e-4 * rotors.largest[1])


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_the_mesh_is_closed_and_free_of_interference(pairs, name):
    """Polygons of 4801 points a segment: their chords err by 1e-6 mm at most."""
    pair = pairs[name].pair
    if name == "a":
        chain = closed_form.circular(pair, 3 * MM, 4801)
    else:
        rho, alpha, r4 = (22, 35, 3) if name == "b" else (19, 32, 4)
        chain = closed_form.rack(pair, 1 * MM, r4 * MM, rho * MM, alpha * DEG, 3 * MM, 4801)
    gap, depth = mesh(pair, chain, 24)
    assert gap < 1e-5 * MM
    assert depth < 1e-5 * MM


@pytest.mark.parametrize(("name", "side"), [("a", 1), ("b", 1), ("c", 1), ("b", -1)])
def test_blow_hole_is_the_open_part_of_its_plane(pairs, pixels_of, name, side):
    """Points of the plane H–S that lie in no rotor between the departure of one and the arrival of the other.

    side −1: suction. Both flanks move past the plane at some 20 µm a pixel's angle: 3 %.
    """
    rotors = pairs[name]
    pixels, chain = pixels_of(name), rotors.chain if side > 0 else mirrored(rotors.chain)
    hole, H = blow_hole_opening(rotors.pair, chain), rotors.pair.cusp
    x, y = chain.x[chain.trail], chain.y[chain.trail]
    part, psi = np.linspace(0.002, 0.998, 250), np.linspace(-75, 60, 4001) * DEG
    grid_psi, grid_x = np.meshgrid(psi, H[0] + part * (x - H[0]), indexing="ij")
    grid_y = np.broadcast_to(H[1] + part * (y - H[1]), grid_x.shape)
    male = pixels.in_male(grid_x, side * grid_y, side * grid_psi)
    female = pixels.in_female(grid_x, side * grid_y, side * grid_psi)
    i = np.arange(len(psi))[:, None]
    arrives = np.argmax(female & (i > np.argmax(male, axis=0)), axis=0)
    leaves = len(psi) - 1 - np.argmax((male & (i < arrives))[::-1], axis=0)
    length = math.hypot(x - H[0], y - H[1]) * 0.996
    counted = rotors.h * np.mean((arrives - leaves - 1) * (psi[1] - psi[0])) * length
    assert counted == pytest.approx(hole.area(rotors.h), rel=0.03)


def _end_face_port(rotors, solids, opens):
    """Return the pixels of the axial discharge port: where, at φ_dis, the chamber's grooves have not yet been."""
    pair, psi = rotors.pair, opens - rotors.wrap
    x, y, A = solids.x, solids.y, rotors.pair.centre_distance
    grooves = solids.chamber(psi)
    ahead_male = solids.male_bore & (np.arctan2(y, x) < pair.pitch * 0.5 - psi)  # beyond the middle of the chamber
    ahead_female = solids.female_bore & (np.arctan2(y, A - x) < -pair.k * psi)
    return (np.where(x > pair.cusp[0], ahead_female, ahead_male)) & ~grooves


@pytest.mark.parametrize("delta", [10.0, 40.0, 60.0, 90.0])
def test_axial_discharge_port_is_what_the_grooves_uncover(pairs, solids, delta):
    rotors = pairs["b"]
    opens = rotors.discharge_angle(3.2)
    phi = opens + delta * DEG
    counted = (_end_face_port(rotors, solids, opens) & solids.chamber(phi - rotors.wrap)).sum() * STEP**2
    grooves = ports.uncovered_area(rotors)
    area = ports.axial_discharge(rotors, grooves, np.array([phi]), opens)[0]
    assert counted == pytest.approx(area, abs=3 * THICK)  # the port's edge adds walls to those of the chamber


@pytest.mark.parametrize("delta", [10.0, 25.0])
def test_axial_suction_port_is_what_the_grooves_still_cover(pairs, solids, delta):
    """Before suction closes the part of the grooves behind their trailing flanks, as they will stand, is open."""
    rotors = pairs["b"]
    closes, pair = rotors.largest[0], rotors.pair
    phi = closes - delta * DEG
    x, y, A = solids.x, solids.y, pair.centre_distance
    behind_male = solids.male_bore & (np.mod(np.arctan2(y, x) + closes + 0.5 * pair.pitch, 2 * math.pi) < math.pi)
    behind_female = solids.female_bore & (np.arctan2(y, A - x) > -pair.k * closes)
    port = np.where(x > pair.cusp[0], behind_female, behind_male) & ~solids.chamber(closes)
    counted = (port & solids.chamber(phi)).sum() * STEP**2
    grooves = ports.uncovered_area(rotors)
    area = ports.axial_suction(rotors, grooves, np.array([phi]), closes)[0]
    assert counted == pytest.approx(area, abs=3 * THICK)


def _groove(pair, chain):
    """Return the angles [rad] between which the outline of the female leaves its outer circle at groove 0, forwards."""
    x, y = outlines(pair, chain)[1]
    land = np.sort(-np.arctan2(y, -x)[np.hypot(x, y) > pair.female_radius - 1e-9])
    return land[land < 0.0].max(), land[land > 0.0].min()


def _bore_area(rotors, phi, female, port):
    """Return the bore's area [m²] that lies on the groove of the chamber and in a port(b, s), counted on a grid.

    b: where on the bore, as the ψ at which a tip of lobe 0 is there; s = τ z/L.
    """
    pair, wrap = rotors.pair, rotors.wrap
    radius, ratio = (pair.female_radius, pair.k) if female else (pair.male_radius, 1.0)
    cusp = (pair.beta2 if female else pair.beta1) / ratio
    b, s = np.meshgrid(
        np.linspace(-2 * math.pi / ratio + cusp, -cusp, 2001), np.linspace(0.0, wrap, 1601), indexing="ij"
    )
    at = ratio * (b - (phi - s))  # angle on the rotor, from the middle of groove 0 or the tip of lobe 0 forwards
    low, high = _groove(pair, rotors.chain) if female else (0.0, pair.pitch)
    on = (at > low) & (at < high)
    cell = (b[1, 0] - b[0, 0]) * (s[0, 1] - s[0, 0])
    return ratio * radius * rotors.h * cell * np.count_nonzero(on & port(b, s))


@pytest.mark.parametrize("ratio", [2.2, 3.2])
def test_radial_discharge_port_is_what_the_grooves_uncover(pairs, solids, ratio):
    rotors = pairs["b"]
    opens, chain = rotors.discharge_angle(ratio), rotors.chain
    for delta in (10.0, 40.0, 75.0, 90.0):
        phi = opens + delta * DEG
        areas = ports.radial_discharge(rotors, np.array([phi]), opens)
        for female, area in zip((False, True), areas, strict=True):
            edge = opens + (-chain.land_end if female else rotors.pair.pitch)  # the leading tip of the chamber
            counted = _bore_area(rotors, phi, female, lambda b, s, edge=edge: b > edge - s)
            assert counted == pytest.approx(area[0], rel=0.01, abs=3 * MM**2)


def test_radial_suction_port_is_what_the_grooves_still_cover(pairs, solids):
    rotors = pairs["b"]
    closes, chain = rotors.largest[0], rotors.chain
    for phi in closes - np.array([200.0, 120.0, 60.0, 20.0]) * DEG:
        areas = ports.radial_suction(rotors, np.array([phi]), closes)
        for female, area in zip((False, True), areas, strict=True):
            edge = closes - (chain.land_start if female else 0.0)  # the trailing tip of the chamber
            counted = _bore_area(rotors, phi, female, lambda b, s, edge=edge: b < edge - s)
            assert counted == pytest.approx(area[0], rel=0.01, abs=3 * MM**2)


@pytest.mark.parametrize("angle", [-150.0, -45.0, -20.0])
def test_end_face_lengths_are_radii_between_two_chambers(pairs, solids, angle):
    """Along the radii of lobe 0: which chambers lie 0.15 mm beside its flanks?

    Near a contact the rotors are that close over some 2 mm on each side (rolling curves): 3 mm of 20.
    """
    rotors, psi = pairs["b"], angle * DEG
    own, behind = solids.chamber(psi), solids.chamber(psi, lobe=1)
    flanks = male_flanks(rotors.pair, rotors.chain, 801)

    def beside(chamber, angles):
        x, y = flanks.radii * np.cos(angles - psi), flanks.radii * np.sin(angles - psi)
        return chamber[solids.row(y), solids.column(x)]

    step = 0.15 * MM / flanks.radii
    hit = beside(own, flanks.lead - step) & beside(behind, flanks.trail + step)
    counted = np.trapezoid(hit.astype(float), flanks.radii)
    length = leakage.male_lengths(rotors.pair, rotors.chain, np.array([psi]))[1][0]
    assert counted == pytest.approx(length, abs=3.0 * MM)


@pytest.mark.parametrize(("lobes", "flank", "angles"), [((3, 5), 24, (-250, -90, -25)), ((6, 7), 12, (-150, -60, -20))])
def test_sections_of_other_lobes_are_the_free_pixels(lobes, flank, angles):
    A, (male, female) = 100.0, lobes
    R1, R2 = A * male / (male + female) + 15.5, A * female / (male + female) + 2.5
    radii = {"male_tip_radius": 1.0, "female_tip_radius": 6.0, "flank_radius": flank, "root_radius": 3.0}
    lengths = {"centre_distance": A, "female_diameter": 2.0 * R2, **radii}
    profile = Profile(
        kind="rack", wrap_angle=300 * DEG, pressure_angle=33 * DEG, **{name: x * MM for name, x in lengths.items()}
    )
    rotors = make_rotors(profile, male, female, 2.0 * R1 * MM, 110 * MM)
    pixels = Solids(rotors)
    for angle in angles:
        counted = pixels.chamber(angle * DEG).sum() * STEP**2
        expected = rotors.sections.area_at(np.array([angle * DEG]))[0]
        assert counted == pytest.approx(expected, abs=THICK)
