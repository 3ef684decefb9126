"""The numbers of docs/reference/rotors.md, each to the last digit printed there (half a unit, or as stated)."""

import math
from dataclasses import replace

import numpy as np
import pytest

from screwsim.machine.rotors import closed_form, leakage, ports
from screwsim.machine.rotors.leakage import blow_hole_opening
from screwsim.machine.rotors.pair import Chain, Pair
from screwsim.machine.rotors.sections import sections, sweep

MM, DEG = 1e-3, math.pi / 180.0
NAMES = ("a", "b", "c")


def column(name, *values):
    """Return the value of a pair out of those for (a), (b), (c)."""
    return values[NAMES.index(name)]


def near(found, expected, digits):
    """Compare with a printed number: one unit of its last digit covers the rounding and our own 1e-6."""
    assert abs(found - expected) <= 10.0**-digits, (found, expected)


@pytest.mark.parametrize("name", NAMES)
def test_widths_of_lobe_and_flat(pairs, name):
    chain, pair = pairs[name].chain, pairs[name].pair
    near(-chain.land_end * pair.r1 / MM, column(name, 21.374, 27.018, 24.692), 3)
    near(chain.land_start * pair.r1 / MM, column(name, 21.374, 14.738, 14.997), 3)
    flat = (pair.pitch - chain.land_start + chain.land_end) * pair.r1 / MM
    near(flat, column(name, 7.517, 8.510, 2.008), 3)


def delay(cut):
    """Return the angle [rad] that meshing takes off the linear range: ∫(1 − a/(A01 + A02)) dψ up to 0."""
    start = float(cut.psi[np.searchsorted(cut.psi, 0.5 * (cut.psi[0] + cut.psi[-1]))])
    return -start - float(cut.integral[-1] - cut.integral_at(np.array([start]))[0]) / cut.grooves


@pytest.mark.parametrize("name", NAMES)
def test_groove_areas_and_their_coefficients(pairs, name):
    rotors = pairs[name]
    cut, table = rotors.sections, rotors.coefficients()
    near(cut.male_groove / MM**2, column(name, 609.06, 688.70, 492.80), 2)
    near(cut.female_groove / MM**2, column(name, 547.55, 508.06, 474.77), 2)
    near(table["area_coefficient"][0], column(name, 0.46264, 0.47870, 0.48378), 5)
    near(table["wrap_coefficient"][0], column(name, 0.9812, 0.9784, 0.9888), 4)
    near(cut.male_share, column(name, 0.899, 0.949, 0.906), 3)
    near(delay(cut) / DEG, column(name, 55.50, 64.57, 54.08), 2)
    crossed = leakage.crossing(rotors.pair, rotors.chain, rotors.blow_hole)[1][:, 1]
    near(crossed.sum() / MM**2, column(name, 134.98, 1.90, 2.95), 2)


@pytest.mark.parametrize("name", NAMES)
def test_cusp_and_end_of_the_contact_line(pairs, name):
    rotors = pairs[name]
    chain, hole = rotors.chain, rotors.blow_hole
    H, S = rotors.pair.cusp, (chain.x[chain.trail], chain.y[chain.trail])
    for found, expected in zip(H, column(name, (40, 30), (40, 30), (40.959, 28.677)), strict=True):
        near(found / MM, expected, 3)
    for found, expected in zip(S, column(name, (36.786, 17.352), (42.167, 26.488), (43.716, 23.829)), strict=True):
        near(found / MM, expected, 3)
    near(hole.psi_male[0] / DEG, column(name, -36.87, -36.87, -35.00), 2)
    near(chain.psi[chain.trail] / DEG, column(name, 0.0, -31.43, -27.88), 2)
    near(hole.psi_female[0] / DEG, column(name, -17.03, -28.92, -24.30), 2)


@pytest.mark.parametrize("name", NAMES)
def test_largest_volume_and_life(pairs, long_pairs, name):
    rotors = pairs[name]
    angle, volume = rotors.largest
    near(angle / DEG, column(name, -80.4, -86.3, -76.5), 1)
    near(volume / MM**3 * 1e-3, column(name, 124.83, 128.80, 105.24), 2)
    near(long_pairs[name].largest[1] / MM**3 * 1e-3, column(name, 187.25, 193.19, 157.87), 2)
    near(rotors.life / DEG, column(name, 750.0, 781.4, 759.9), 1)


@pytest.mark.parametrize("name", NAMES)
def test_discharge_angles_of_volume_ratios(pairs, name):
    expected = column(
        name, (110.70, 131.28, 152.51, 170.91), (102.02, 122.55, 143.71, 162.06), (111.08, 131.82, 153.22, 171.76)
    )
    for ratio, angle in zip((2.2, 2.6, 3.2, 4.0), expected, strict=True):
        near(pairs[name].discharge_angle(ratio) / DEG, angle, 2)


@pytest.mark.parametrize("name", NAMES)
def test_whole_sealing_line_and_blow_hole(pairs, long_pairs, name):
    for rotors, line, hole in (
        (pairs[name], column(name, 102.9, 114.7, 109.0), column(name, 15.71, 2.874, 5.40)),
        (long_pairs[name], column(name, 114.2, 132.3, 122.9), column(name, 23.57, 4.310, 8.11)),
    ):
        branches = leakage.sealing_line(rotors.pair, rotors.chain, rotors.h)
        near((branches.rising[1][-1] + branches.falling[1][-1]) / MM, line, 1)
        assert rotors.blow_hole.area(rotors.h) / MM**2 == pytest.approx(hole, rel=1e-3)


def test_areas_volumes_and_slope_of_b(pairs):
    rotors, cut = pairs["b"], pairs["b"].sections
    area = cut.area_at(np.radians([-120, -100, -80, -60, -40, -20])) / MM**2
    # rel 3e-6: the numbers were made with half the points a segment
    assert area == pytest.approx([1191.10, 1058.50, 819.79, 541.74, 262.16, 47.57], abs=0.006)
    volume = rotors.volume(np.radians([-100, 0, 100, 200, 250])) / MM**3
    assert volume == pytest.approx([127917.5, 103311.0, 59429.8, 15995.8, 2336.9], rel=3e-6, abs=0.05)
    slope = rotors.volume_slope(np.radians([100]))[0] / MM**3
    assert slope == pytest.approx(-25142.0, rel=3e-6)


def test_joints_of_b(pairs):
    chain, pair = pairs["b"].chain, pairs["b"].pair
    expected = {
        2: (-10.2284, (37.7875, -19.3259), (-37.6413, -16.8975)),
        3: (0.0, (50.0, 0.0), (-30.0, 0.0)),
        4: (-31.4345, (49.7926, 0.6097), (-44.8042, 11.2049)),
        5: (26.3876, (26.8742, 13.3332), (-47.6617, 15.1116)),
    }
    for joint, (psi, male, female) in expected.items():
        i = chain.joints[joint]
        near(chain.psi[i] / DEG, psi, 4)
        for curve, points in ((chain.male, male), (chain.female(pair), female)):
            for found, value in zip(curve, points, strict=True):
                near(found[i] / MM, value, 4)


def test_sealing_line_of_b_by_angle(pairs):
    rotors = pairs["b"]
    line = leakage.sealing_line(rotors.pair, rotors.chain, rotors.h)
    phi = np.radians([-90, -60, -30, 0, 170, 200, 240, 270, 290])
    found = sum(line.lengths_at(phi, rotors.wrap)) / MM
    assert found == pytest.approx([20.6, 39.7, 56.8, 114.7, 114.7, 100.6, 75.0, 57.9, 27.0], abs=0.06)


def test_blow_hole_of_b_by_female_tip_radius(pairs):
    pair, h = pairs["b"].pair, pairs["b"].h
    for r4, area in ((2.5, 2.05), (3.0, 2.87), (4.0, 4.92), (6.0, 10.4)):
        chain = closed_form.rack(pair, 1 * MM, r4 * MM, 22 * MM, 35 * DEG, 3 * MM)
        half = 0.05 if r4 == 6.0 else 0.005  # of the last digit; and 1e-3, the accuracy of the printed numbers
        assert blow_hole_opening(pair, chain).area(h) / MM**2 == pytest.approx(area, abs=half + 1e-3 * area)


def test_axial_discharge_port_of_b(pairs):
    rotors = pairs["b"]
    opens, delta = rotors.discharge_angle(3.2), np.radians([10, 20, 40, 60, 90, 110])
    grooves = ports.uncovered_area(rotors)
    area = ports.axial_discharge(rotors, grooves, opens + delta, opens) / MM**2
    assert area == pytest.approx([232.5, 463.7, 850.5, 960.6, 629.5, 350.2], abs=0.11)


def test_radial_discharge_port_of_b(pairs):
    """The female's at Vi 2.2 is 908 mm², not the 948 of a groove that is wider than the port (see test_ports)."""
    rotors = pairs["b"]
    for ratio, male, female in ((2.2, 809.0, 908.0), (3.2, 138.5, 295.0), (4.0, 19.6, 125.0)):
        opens = rotors.discharge_angle(ratio)
        phi = np.linspace(opens, rotors.wrap, 2001)
        areas = ports.radial_discharge(rotors, phi, opens)
        assert areas[0].max() / MM**2 == pytest.approx(male, rel=4e-3)
        assert areas[1].max() / MM**2 == pytest.approx(female, rel=2e-3)


def test_tip_helices_of_a_male_turn(pairs, long_pairs):
    """5.88 D and 6.60 D are one tip of each rotor over 360° of the male; on the bore, at most 4.77 D at once."""
    for rotors, length in ((pairs["b"], 5.88), (long_pairs["b"], 6.60)):
        male = leakage.male_tip(rotors.pair, rotors.h)
        female = leakage.female_tip(rotors.pair, rotors.chain, rotors.h)
        near((male.slope + female.slope) * 2 * math.pi / 0.1, length, 2)


@pytest.mark.parametrize("name", NAMES)
def test_swept_areas_sum_to_both_grooves(pairs, name):
    """The identity is exact; what is left is the chain's discretisation, below 1e-6 and falling as its square."""
    rotors = pairs[name]
    male, female = sweep(rotors.pair, rotors.chain)
    assert male.sum() + female.sum() == pytest.approx(rotors.sections.grooves, rel=1e-6)


def test_circles_without_tips_give_the_lens():
    """Symmetric, hf = 0, r4 → 0: the female groove is a lens of two circles (closed form)."""
    pair = Pair(4, 6, 80 * MM, 50 * MM, 48 * MM)
    chain: Chain = closed_form.circular(pair, 1e-9)
    r, R = 18.0, 48.0
    lens = (
        r**2 * math.acos(r / (2 * R)) + R**2 * math.acos(1 - r**2 / (2 * R**2)) - 0.5 * r * math.sqrt(4 * R**2 - r**2)
    )
    assert lens == pytest.approx(468.2940, abs=5e-5)
    assert sections(pair, chain).female_groove / MM**2 == pytest.approx(lens, rel=2e-6)


def test_slope_is_the_derivative_of_volume(pairs):
    """V is quadratic between nodes and dV its derivative: a centred difference over 1e-4 rad errs by a''·1e-8."""
    for rotors in pairs.values():
        phi, step = np.linspace(rotors.start + 0.01, rotors.wrap - 0.01, 300), 1e-4
        found = (rotors.volume(phi + step) - rotors.volume(phi - step)) / (2 * step)
        scale = np.abs(rotors.volume_slope(phi)).max()
        assert found == pytest.approx(rotors.volume_slope(phi), abs=1e-4 * scale)


def test_points_a_segment_converge_in_second_order(pairs):
    pair, errors = pairs["b"].pair, []
    for points in (101, 201, 401):
        male, female = sweep(pair, closed_form.rack(pair, 1 * MM, 3 * MM, 22 * MM, 35 * DEG, 3 * MM, points))
        cut = sections(pair, closed_form.rack(pair, 1 * MM, 3 * MM, 22 * MM, 35 * DEG, 3 * MM, points))
        errors.append(abs((male.sum() + female.sum()) / cut.grooves - 1))
    assert errors[0] / errors[1] > 2**1.9
    assert errors[1] / errors[2] > 2**1.9


def test_volume_scales_with_length_at_given_wrap(pairs):
    double = replace(pairs["c"], length=2 * pairs["c"].length)
    phi = np.linspace(-6, 5, 50)
    assert double.volume(phi) == pytest.approx(2 * pairs["c"].volume(phi), rel=1e-12)
