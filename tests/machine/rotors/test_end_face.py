"""Where contacts divide the flanks on an end face: against distances between the polygons of both rotors."""

import math

import numpy as np
import pytest
from scipy.spatial import KDTree

from screwsim.machine.rotors.curves import make_curves
from screwsim.machine.rotors.leakage import contacts, mean_widths
from screwsim.machine.rotors.pair import outlines

DEG, MM = math.pi / 180.0, 1e-3
TOUCHING = 0.5e-6  # [m]: polygons of 801 points a segment err by less
NEAR = 0.05 * MM  # rolling curves touch over some hundredths of a millimetre


def distances(points, polygon):
    """Return the distances [m] of points from a closed polygon."""
    nearest = KDTree(polygon).query(points)[1]
    best = np.full(len(points), np.inf)
    for i in (nearest - 1, nearest):
        p, q = polygon[i], polygon[(i + 1) % len(polygon)]
        d, r = q - p, points - p
        t = np.clip((r * d).sum(axis=1) / np.maximum((d * d).sum(axis=1), 1e-300), 0.0, 1.0)
        best = np.minimum(best, np.hypot(*(r - t[:, None] * d).T))
    return best


def touching_radii(rotors, psi):
    """Return the male radii [m] at which the flanks of lobe 0, (ahead, behind), touch the female polygon at ψ."""
    pair, chain = rotors.pair, rotors.chain
    x, y = chain.male
    c, s = np.cos(psi), np.sin(psi)
    X, Y = c * x + s * y - pair.centre_distance, c * y - s * x
    c, s = np.cos(pair.k * psi), np.sin(pair.k * psi)
    female = np.column_stack(outlines(pair, chain)[1])
    gap = distances(np.column_stack([c * X + s * Y, c * Y - s * X]), female)
    found = []
    for part in (slice(chain.edges[0], chain.tip + 1), slice(chain.tip, chain.edges[1] + 1)):
        radii, g = np.hypot(x, y)[part], gap[part]
        close = np.flatnonzero(g < TOUCHING)
        runs = np.split(close, np.flatnonzero(np.diff(radii[close]) ** 2 > (0.3 * MM) ** 2) + 1) if len(close) else []
        found.append([float(radii[run[np.argmin(g[run])]]) for run in runs])
    return found


@pytest.mark.parametrize(
    ("name", "angles"), [("b", (-44.0, -30.0, -20.0, -8.0, 4.0, 20.0)), ("c", (-40.0, -25.0, -12.0, 5.0))]
)
def test_contacts_divide_the_flanks_where_the_polygons_touch(pairs, name, angles):
    rotors = pairs[name]
    chain = rotors.chain
    division = contacts(rotors.pair, chain, chain.male_radii, rotors.pair.male_radius)
    S, lead = float(chain.psi[chain.trail]), float(chain.psi[chain.lead])
    for psi in np.radians(angles):
        ahead = [division.lead] if psi < lead else []
        behind = [division.trail] if S < psi else []
        behind += [division.tip] if S < psi < lead else []
        for levels, touching in zip((ahead, behind), touching_radii(rotors, psi), strict=True):
            expected = sorted(float(np.interp(psi, *level)) for level in levels)
            assert sorted(touching) == pytest.approx(expected, abs=NEAR), math.degrees(psi)


def test_lobes_on_the_suction_face_are_those_on_the_discharge_face_a_wrap_earlier(pairs):
    rotors = pairs["b"]
    paths = {path.name: path.curve for path in make_curves(rotors, 3.2).paths}
    z1 = rotors.pair.male_lobes
    for offset in (1, z1 - 1, z1, z1 + 1):
        early, late = paths[f"suction_face_{offset}"], paths[f"end_face_{offset}"]
        own = np.radians(np.arange(0.0, 480.0, 1.3))
        there = np.interp(own + rotors.wrap, late.angle, late.value)
        assert np.interp(own, early.angle, early.value) == pytest.approx(there, abs=0.3 * MM), offset
        assert early.value[early.angle > own[-1] + 5.0 * DEG].max() < 1e-12  # the section at the inlet has ended


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_lobes_and_grooves_fill_the_ring_between_root_and_tip(pairs, name):
    rotors = pairs[name]
    pair, chain, own = rotors.pair, rotors.chain, rotors.coefficients()
    roots = chain.male_radii.min(), chain.female_radii(pair).min()
    tips, lobes = (pair.male_radius, pair.female_radius), (pair.male_lobes, pair.female_lobes)
    widths = mean_widths(pair, chain)
    for rotor, root, tip, count, width in zip(("male", "female"), roots, tips, lobes, widths, strict=True):
        ring = math.pi * (tip**2 - root**2) / count
        assert width * (tip - root) == pytest.approx(ring - own[f"{rotor}_groove_area"][0], rel=2e-3)
