"""Profiles from points, and the refusals: each in one line with its remedy."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from screwsim.inputs.faults import UsageError
from screwsim.machine.rotors import imported
from screwsim.machine.rotors.checks import check_pair, check_profile, crosses_itself, mesh
from screwsim.machine.rotors.closed_form import circular, rack, rack_line
from screwsim.machine.rotors.export import lobe_csv, profile_csv
from screwsim.machine.rotors.fairing import faired_curve
from screwsim.machine.rotors.pair import Chain, Pair
from screwsim.machine.rotors.rotors import make_rotors
from screwsim.machine.rotors.settings import Profile
from screwsim.study.validation import sibling

measured_rotors = sibling(Path(__file__).parents[3] / "docs" / "tools" / "measured_rotors.py")

MM, DEG = 1e-3, math.pi / 180.0
PAIR = Pair(4, 6, 80 * MM, 50 * MM, 50 * MM)


def points(path, curve="male", **more):
    return Profile(
        kind="points",
        centre_distance=80 * MM,
        female_diameter=100 * MM,
        wrap_angle=300 * DEG,
        file=str(path),
        curve=curve,
        **more,
    )


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_an_exported_lobe_gives_the_same_machine(pairs, name):
    """The tangent of three points errs by their spacing times jumps of curvature: 2e-5 of V_max at 50 µm.

    (a) has its whole arc in contact at once; where that ends is found to 1e-3 rad only, so Δ errs by 0.3 %: 6e-5.
    """
    rotors = pairs[name]
    first, last = rotors.chain.edges
    x, y = (line[first : last + 1 : 2] for line in rotors.chain.male)
    chain = imported.from_male(rotors.pair, x, y)
    phi = np.linspace(-1.5, 4.0, 50)
    expected, found = (each.volume(phi) for each in (rotors, replace(rotors, chain=chain)))
    assert found == pytest.approx(expected, abs=(6e-5 if name == "a" else 2e-5) * rotors.largest[1])
    assert check_profile(rotors.pair, chain) == []


@pytest.mark.parametrize("angle", [0.1, -0.5, 2.0])
def test_a_lobe_whose_frame_is_turned_is_the_same_lobe(pairs, angle):
    """Its phase is that of its tip, which lies on the centre line at ψ = 0, however its points were laid down."""
    rotors = pairs["b"]
    first, last = rotors.chain.edges
    x, y = (line[first : last + 1 : 2] for line in rotors.chain.male)
    turned = math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y
    chains = (imported.from_male(rotors.pair, *points) for points in ((x, y), turned))
    phi = np.linspace(-1.5, 4.0, 50)
    expected, found = (replace(rotors, chain=chain).volume(phi) for chain in chains)
    assert found == pytest.approx(expected, abs=2e-5 * rotors.largest[1])


RHO, ALPHA, R5 = 18 * MM, 35 * DEG, 3 * MM


def symmetric_rack():
    """Return the rack of (b), mirrored on its trailing side: x above the pitch line, y from the tip [m]."""
    length, yL = rack_line(PAIR, RHO, ALPHA, R5)
    g = np.linspace(0.0, 0.5 * math.pi - ALPHA, 200)
    line = np.linspace(0.0, length, 100)[1:-1]
    x = [R5 - PAIR.dedendum - R5 * np.cos(g), PAIR.addendum - RHO + RHO * np.cos(g[::-1])]
    y = [-yL + R5 * np.sin(g), -RHO * np.sin(g[::-1])]
    x.insert(1, x[0][-1] + line * math.cos(ALPHA))
    y.insert(1, y[0][-1] + line * math.sin(ALPHA))
    left, along = np.concatenate(x), np.concatenate(y)
    return np.append(left, left[-2::-1]), np.append(along, -along[-2::-1])


def test_a_rack_in_points_gives_the_leading_flank():
    """Its leading contact is that of (b)."""
    chain = imported.from_rack(PAIR, *symmetric_rack())
    exact = rack(PAIR, 1 * MM, 3 * MM, RHO, ALPHA, R5)
    i = slice(exact.edges[0], exact.lead)
    lead = slice(chain.edges[0], chain.lead)
    psi = np.linspace(-0.6, -0.05, 50)
    found, expected = (np.interp(psi, part.psi[cut], part.x[cut]) for part, cut in ((chain, lead), (exact, i)))
    assert found == pytest.approx(expected, abs=2e-3 * MM)


@pytest.mark.parametrize("moved", [3 * MM, -40 * MM, PAIR.r1 * PAIR.pitch])
def test_a_rack_is_the_same_wherever_its_y_begins(moved):
    """Its phase is that of the lobe's tip, as of points of the lobe; y often counts from the root."""
    x, y = symmetric_rack()
    one, other = (imported.from_rack(PAIR, x, y + by) for by in (0.0, moved))
    assert other.psi == pytest.approx(one.psi, abs=1e-9)
    assert other.male[1] == pytest.approx(one.male[1], abs=1e-12)


def test_smoothing_averages_the_tangent_only():
    """A straight line plus noise gives the line's direction back; a circle keeps its linear angle."""
    way = np.linspace(0.0, 1.0, 400)
    assert imported.averaged(way, 3.0 * way, 0.1) == pytest.approx(3.0 * way, abs=1e-6)
    noise = np.where(np.arange(400) % 2, 1e-3, -1e-3)
    assert np.abs(imported.averaged(way, noise, 0.1)[30:-30]).max() < 1e-4


def test_noise_of_a_tenth_of_a_micrometre_is_smoothed(pairs):
    rotors, random = pairs["c"], np.random.default_rng(1)
    x, y = rotors.chain.male
    first, last = rotors.chain.edges
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])[first : last + 1]
    keep = np.unique(np.searchsorted(way, np.linspace(way[0], way[-1], 1500)).clip(0, last - first))
    px, py = (line[first : last + 1][keep] + 1e-7 * random.standard_normal(len(keep)) for line in (x, y))
    chain = imported.from_male(rotors.pair, px, py, 0.2 * MM)
    assert check_profile(rotors.pair, chain) == []
    largest = replace(rotors, chain=chain).volume(np.array([rotors.largest[0]]))[0]
    assert largest == pytest.approx(rotors.largest[1], rel=1e-3)


@pytest.mark.parametrize("name, seed", [("b", 1), ("b", 2), ("c", 1)])
def test_points_with_a_micrometre_of_noise_are_faired_within_their_tolerance(pairs, tmp_path, name, seed):
    """V_max within 1.5e-3 and blow-holes within 3 % of the rotors that were measured; no point is passed by farther."""
    rotors, path = pairs[name], tmp_path / "measured.csv"
    x, y = measured_rotors.measured(rotors, seed)
    path.write_text(profile_csv(x, y))
    pair = rotors.pair
    own = replace(
        points(path), tolerance=4e-6, centre_distance=pair.centre_distance, female_diameter=2 * pair.female_radius
    )
    with pytest.raises(UsageError):
        make_rotors(replace(own, tolerance=0.0), pair.male_lobes, pair.female_lobes, 100 * MM, 110 * MM)
    again = make_rotors(own, pair.male_lobes, pair.female_lobes, 100 * MM, 110 * MM)
    assert again.largest[1] == pytest.approx(rotors.largest[1], rel=1.5e-3)
    for found, expected in ((again.blow_hole, rotors.blow_hole), (again.suction_blow_hole, rotors.suction_blow_hole)):
        assert found.area(again.h) == pytest.approx(expected.area(rotors.h), rel=0.03)
    curve = faired_curve(x, y, 4e-6, pair.r1)
    assert 0.9e-6 < curve.rms < 1.2e-6 and curve.farthest <= 4e-6
    assert again.chain.faired == curve.words(len(x))


def test_a_fair_curve_keeps_jumps_of_curvature(pairs):
    """Exact points of a straight line and an arc: both stay within a tenth of the tolerance, the joint too."""
    line, arc = np.linspace(-10.0, 0.0, 200)[:-1], np.linspace(0.0, 1.0, 200)
    x, y = np.append(line, 5.0 * np.sin(arc)) * MM, np.append(0.0 * line, 5.0 - 5.0 * np.cos(arc)) * MM
    curve = faired_curve(x, y, 2e-6, 30 * MM)
    straight = curve.x < -0.2 * MM
    round_ = curve.x > 0.2 * MM
    assert np.abs(curve.y[straight]).max() < 2e-6
    assert np.abs(np.hypot(curve.x, curve.y - 5.0 * MM)[round_] - 5.0 * MM).max() < 2e-6
    step, turn = np.hypot(np.diff(curve.x), np.diff(curve.y)), np.arctan2(np.diff(curve.y), np.diff(curve.x))
    curvature = np.diff(turn) / (0.5 * (step[1:] + step[:-1]))
    inner = curve.x[1:-1]
    assert np.abs(curvature[inner < -0.2 * MM]).max() < 2.0 and curvature[inner > 0.2 * MM] == pytest.approx(
        200.0, rel=0.02
    )


def test_messages_of_points_name_keys_of_points(pairs, tmp_path):
    path = tmp_path / "measured.csv"
    path.write_text(profile_csv(*measured_rotors.measured(pairs["b"], 1)))
    for tolerance, words in ((0.0, "tolerance"), (1e-6, "tolerance"), (1e-3, "smaller tolerance")):
        own = replace(points(path), tolerance=tolerance)
        text = _refusal(make_rotors, own, 4, 6, 100 * MM, 110 * MM)
        assert words in text and "tip_radius" not in text


def test_file_round_trip(tmp_path, pairs):
    path = tmp_path / "lobe.csv"
    path.write_text(lobe_csv(pairs["b"]))
    again = make_rotors(points(path), 4, 6, 100 * MM, 110 * MM)
    assert again.largest[1] == pytest.approx(pairs["b"].largest[1], rel=2e-5)
    head, *rows = lobe_csv(pairs["b"]).splitlines()
    path.write_text("\n".join([head, *reversed(rows)]))
    assert make_rotors(points(path), 4, 6, 100 * MM, 110 * MM).largest == again.largest  # clockwise


def _refusal(function, *arguments):
    with pytest.raises(UsageError) as error:
        function(*arguments)
    text = str(error.value)
    assert "\n" not in text
    return text


def test_undercut_of_the_female_tip_is_refused():
    assert "1.25 times" in _refusal(rack, PAIR, 1 * MM, 2 * MM, 22 * MM, 35 * DEG, 3 * MM)
    chain = rack(PAIR, 1 * MM, 2.01 * MM, 22 * MM, 35 * DEG, 3 * MM)
    (fault,) = check_profile(PAIR, chain)
    assert "choose" in fault.what
    assert check_profile(PAIR, rack(PAIR, 1 * MM, 2.5 * MM, 22 * MM, 35 * DEG, 3 * MM)) == []


def test_a_flank_that_turns_back_is_told_with_its_place(pairs):
    """A hundred points of (b) are too few; with more of them about the place that is told it turns back no more."""
    rotors = pairs["b"]
    (x, y), (first, last) = rotors.chain.male, rotors.chain.edges
    few = np.arange(first, last + 1, 40)

    def turning(kept):
        chain = imported.from_male(rotors.pair, x[kept], y[kept])
        told = "".join(fault.what for fault in check_profile(rotors.pair, chain, interference=False, tolerance=0.0))
        place = re.search(r"flank turns back: undercut, where it meets the male lobe at a radius of ([\d.]+) mm", told)
        return float(place[1]) * MM if place else None

    radius = turning(few)
    assert radius is not None
    about = np.flatnonzero(np.abs(np.hypot(x, y) - radius) < 3 * MM)  # of a lobe from 30 to 50 mm
    assert turning(np.union1d(few, about[(about > first) & (about < last)])) is None


def test_a_lobe_wider_than_the_pitch_is_refused():
    assert "wider than the pitch" in _refusal(rack, PAIR, 1 * MM, 3 * MM, 22 * MM, 60 * DEG, 3 * MM)


def test_overlapping_arcs_of_the_rack_are_refused():
    assert "overlap" in _refusal(rack, PAIR, 1 * MM, 3 * MM, 80 * MM, 35 * DEG, 3 * MM)


def test_thin_lobes_are_refused():
    (fault,) = check_profile(PAIR, rack(PAIR, 1 * MM, 3 * MM, 22 * MM, 53.0 * DEG, 3 * MM), interference=False)
    assert "thick" in fault.what


def test_interference_is_found():
    """Points that meet 0.06° too early or too late break the law of gearing: the curves through them cut each other."""
    chain = rack(PAIR, 1 * MM, 3 * MM, 22 * MM, 35 * DEG, 3 * MM)
    assert mesh(PAIR, chain)[1] < 2e-8
    wrong = 0.001 * np.sin(2.0 * PAIR.male_lobes * chain.psi)
    spoiled = Chain(chain.psi + wrong, chain.x, chain.y, chain.lead, chain.trail, chain.edges)
    (fault,) = check_profile(PAIR, spoiled)
    assert "cut into each other" in fault.what


def test_main_dimensions_that_cannot_mesh_are_refused():
    for centre, word in ((110.0, "do not mesh"), (49.0, "inside a rotor"), (81.0, None)):
        faults = check_pair(Pair(4, 6, centre * MM, 50 * MM, 50 * MM))
        assert (not faults) if word is None else (word in faults[0].what)


def test_a_figure_of_eight_crosses_itself():
    t = np.linspace(0.3, 2.0 * math.pi + 0.3, 400)
    assert crosses_itself(0.04 + 0.01 * np.sin(2 * t), 0.01 * np.sin(t), math.pi)


def test_missing_parameters_are_named():
    bare = Profile(kind="circular", centre_distance=80 * MM, female_diameter=100 * MM, wrap_angle=5.0)
    assert "female_tip_radius" in _refusal(make_rotors, bare, 4, 6, 100 * MM, 110 * MM)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a,b\n1,2\n", "columns x_mm and y_mm"),
        ("x_mm,y_mm\n1,2\n", "at least 20"),
        ("x_mm,y_mm\n1,two\n", "a number"),
        ("x_mm,y_mm\n" + 25 * "1,2\n" + "nan,3\n", "point 26, nan, 3, is not finite"),
    ],
)
def test_bad_files_are_refused(tmp_path, text, words):
    path = tmp_path / "points.csv"
    path.write_text(text)
    assert words in _refusal(imported.read_profile, str(path))


@pytest.mark.parametrize("name", ["male.dxf", "MALE.DXF", "rotor.step"])
def test_a_drawing_is_refused_with_what_to_export(tmp_path, name):
    (tmp_path / name).write_text("0\nSECTION\n")
    refusal = _refusal(imported.read_profile, str(tmp_path / name))
    assert "is a drawing (export the points of one male lobe, from root to root" in refusal


def test_a_corner_in_the_points_is_refused():
    x = np.concatenate([np.linspace(30, 50, 30), np.linspace(50, 30, 30)[1:]]) * MM
    y = np.concatenate([np.linspace(-8, 0, 30), np.linspace(0, 8, 30)[1:]]) * MM
    assert "round the corner" in _refusal(imported.from_male, PAIR, x, y)


def test_circle_that_misses_the_tip_is_refused():
    assert "do not touch" in _refusal(circular, Pair(4, 6, 80 * MM, 33 * MM, 58 * MM), 3 * MM)


@pytest.mark.parametrize("r4", [3.0, 4.0, 5.0])
def test_a_wide_female_tip_goes_on_where_the_circle_ends(r4):
    """From the pitch point the tip's centre may lie on the near side of its circle: the flanks meet there, too."""
    pair = Pair(3, 5, 100 * MM, 53.5 * MM, 62.5 * MM)
    distance = pair.addendum + r4 * MM
    assert distance**2 < pair.r2**2 - (pair.female_radius - r4 * MM) ** 2  # the near side
    chain = circular(pair, r4 * MM)
    assert np.hypot(np.diff(chain.x), np.diff(chain.y)).max() < 0.1 * MM  # a point's spacing: no jump
    assert max(mesh(pair, chain)) < 1e-3 * MM
    assert check_profile(pair, chain) == []


def test_points_of_which_a_stretch_of_contact_is_lost_are_refused(pairs, tmp_path):
    """Points 0.2 mm apart, exact: a loop beside the tip takes 10 mm of the flank with it, and 0.4 % of V_max."""
    x, y = (line[slice(pairs["b"].chain.edges[0], pairs["b"].chain.edges[1] + 1)] for line in pairs["b"].chain.male)
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    path = tmp_path / "lobe.csv"

    def made(count):
        even = np.linspace(0.0, way[-1], count)
        path.write_text(profile_csv(np.interp(even, way, x), np.interp(even, way, y)))
        return make_rotors(points(path), 4, 6, 100 * MM, 110 * MM)

    assert re.search(r"differ from those of their grooves by 0\.61 %: stretches", _refusal(made, 500))
    assert made(1000).largest[1] == pytest.approx(pairs["b"].largest[1], rel=5e-5)
