"""Curves: ends, breakpoints, the spline of `pack_curve` against the exact functions, files that `law: table` reads."""

import math
from dataclasses import replace

import numpy as np
import pytest

from screwsim.machine.profile_law import area_table
from screwsim.machine.rotors import curves as module
from screwsim.machine.rotors import ports
from screwsim.machine.rotors.curves import make_curves
from screwsim.machine.rotors.export import coefficients_csv, curve_csv, curves_csv, outline_dxf
from screwsim.machine.rotors.leakage import face_lengths
from screwsim.machine.rotors.pair import outlines
from screwsim.numerics.spline import pack_curve, read_curve, table_slope, table_value


@pytest.fixture(scope="module")
def curves(pairs):
    return {name: make_curves(rotors, 3.2) for name, rotors in pairs.items()}


def every(made):
    """Return all curves of a machine by name."""
    named = {"volume": made.volume}
    named |= {f"suction_{n}": c for n, c in made.suction.items()} | {
        f"discharge_{n}": c for n, c in made.discharge.items()
    }
    return named | {path.name: path.curve for path in made.paths}


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_curves_live_as_long_as_the_chamber_and_begin_and_end_with_nothing(curves, name):
    made = curves[name]
    for label, curve in every(made).items():
        assert (curve.angle[0], curve.angle[-1]) == pytest.approx((0.0, made.life))
        assert np.all(np.diff(curve.angle) > 0.0)
        assert np.isfinite(curve.value).all()
        assert curve.value.min() > -1e-15
        first = 0.0 if label.startswith("suction_face") else curve.value[0]  # lobes stand there before a chamber does
        assert max(first, curve.value[-1]) <= 1e-9 * curve.value.max()


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_the_spline_of_the_volume_table_meets_volume_and_slope(pairs, curves, name):
    """Rows every 0.5° and breakpoints: V to 5e-6 of its maximum; the slope to 1 % of its own beside kinks of dV/dφ."""
    rotors, made = pairs[name], curves[name]
    TAB = pack_curve(made.volume.angle, made.volume.value)
    theta = np.linspace(0.0, made.life, 1501)
    volume = np.array([table_value(x, TAB, 0) for x in theta])
    slope = np.array([table_slope(x, TAB, 0) for x in theta])
    exact = rotors.volume_slope(theta + rotors.start)
    assert volume == pytest.approx(rotors.volume(theta + rotors.start), abs=5e-6 * rotors.largest[1])
    assert slope == pytest.approx(exact, abs=1e-2 * np.abs(exact).max())


def test_male_and_female_torque_share_the_work(pairs, curves):
    """Over a life the male's ∂V/∂φ sums to its share of what is swept: both integrals vanish, their halves do not."""
    for name, rotors in pairs.items():
        phi = curves[name].volume.angle + rotors.start
        slope = rotors.volume_slope(phi)
        male, all_ = (np.trapezoid(np.where(slope < 0.0, x, 0.0), phi) for x in (rotors.male_slope(phi), slope))
        assert male / all_ == pytest.approx(rotors.sections.male_share, abs=0.02)


def test_offsets_are_those_of_the_interfaces(curves):
    offsets = {path.name: path.offset for path in curves["c"].paths}
    assert offsets["sealing_line"] == 5
    assert offsets["sealing_line_over_tip"] == 6
    assert all(
        offsets[name] == 1 for name in ("male_tip", "female_tip", "blow_hole", "suction_blow_hole", "end_face_1")
    )
    assert {name: n for name, n in offsets.items() if name.startswith("end_face")} == {
        f"end_face_{n}": n for n in (1, 4, 5, 6)
    }


def test_whole_lobes_separate_neighbours_on_the_end_face(pairs):
    """Before the mesh at the discharge face (ψ = −145°) both lobes do so with their whole heights."""
    for rotors in pairs.values():
        lengths = face_lengths(rotors.pair, rotors.chain, np.array([math.radians(-145.0)]))
        pair = rotors.pair
        heights = 2.0 * (pair.male_radius + pair.female_radius - pair.centre_distance)
        assert lengths.pop(1)[0] == pytest.approx(heights, rel=1e-6)
        assert all(length[0] < 1e-12 for length in lengths.values())


def test_curve_of_the_trailing_chamber_is_shifted_by_its_offset(pairs, curves):
    path = next(path for path in curves["b"].paths if path.name == "sealing_line")
    assert path.curve.angle - path.behind.angle == pytest.approx(2 * math.pi)


def test_more_chambers_live_than_720_degrees_hold(pairs, curves):
    alive = {name: math.ceil(made.life / pairs[name].pair.pitch - 1e-9) for name, made in curves.items()}
    assert alive == {"a": 9, "b": 9, "c": 11}


def test_discharge_opens_at_the_built_in_ratio(pairs, curves):
    for name, rotors in pairs.items():
        volume = rotors.volume(np.array([curves[name].discharge_opens + rotors.start]))[0]
        assert rotors.largest[1] / volume == pytest.approx(3.2, rel=1e-9)


@pytest.mark.parametrize("ratio", [3.2, 4.8])
def test_the_table_of_the_discharge_port_has_a_corner_where_the_part_on_the_end_face_opens(pairs, ratio):
    """Cut at 4.8, the edge on the end face is passed 1.9° before it has uncovered more than the mesh has taken.

    Rows that lay beside that corner were off by 1.6 % of the largest area, within a step that saw no error.
    """
    rotors, opens = pairs["a"], pairs["a"].discharge_angle(ratio)
    table = area_table(sum_of(make_curves(rotors, ratio).discharge), 0.0)
    phi = np.linspace(opens, opens + math.radians(5.0), 1001)
    grooves = ports.uncovered_area(rotors)
    open_area = ports.axial_discharge(rotors, grooves, phi, opens)
    open_area += sum(ports.radial_discharge(rotors, phi, opens))
    TAB = pack_curve(*table.curve)
    found = np.array([table_value(x, TAB, 0) for x in phi - rotors.start])
    assert found == pytest.approx(open_area, abs=1e-4 * open_area.max())
    later = math.degrees(ports.axial_opening(rotors, grooves, opens) - opens)
    assert later == pytest.approx({3.2: 0.0, 4.8: 1.9057}[ratio], abs=1e-3)


def sum_of(parts):
    """Return the areas of a port's parts together."""
    first = next(iter(parts.values()))
    return replace(first, value=np.sum([part.value for part in parts.values()], axis=0))


def test_tables_are_those_that_a_scene_reads(tmp_path, curves):
    for name, text in curves_csv(curves["b"]).items():
        path = tmp_path / name
        path.write_text(text)
        column = "volume_m3" if name == "volume.csv" else "area_m2"
        if f"angle_deg,{column}\n" in text:
            angles, values = read_curve(str(path), column)
            assert len(angles) > 1000
            assert values.max() > 0.0


@pytest.mark.parametrize(("unit", "name"), [("m", "length_m"), ("m^2", "area_m2")])
def test_a_curve_is_written_with_the_column_of_its_unit(curves, unit, name):
    path = next(path for path in curves["b"].paths if path.name == "male_tip")
    text = curve_csv(replace(path.curve, value=2e-5 * path.curve.value, unit=unit))
    rows = np.loadtxt(text.splitlines()[1:], delimiter=",")
    assert text.startswith(f"angle_deg,{name}\n")
    assert rows[:, 1] == pytest.approx(2e-5 * path.curve.value, rel=1e-9)


def test_drawing_has_every_point_of_the_outline(pairs):
    x, y = outlines(pairs["b"].pair, pairs["b"].chain)[0]
    assert outline_dxf(x, y).count("VERTEX") == len(x)
    assert outline_dxf(x, y).startswith("999\nlengths in mm\n0\nSECTION\n")


def test_coefficients_are_listed_with_units(pairs):
    rows = coefficients_csv(pairs["a"]).splitlines()
    assert rows[0] == "name,value,unit,meaning"
    assert all(len(row.split(",")) == 4 for row in rows)


def test_rows_lie_on_breakpoints(pairs, curves):
    assert module.STEP == pytest.approx(math.radians(0.5))
    curve = curves["b"].volume
    assert all(np.min(np.abs(curve.angle - at)) < 1e-9 for at in curve.breakpoints)


def test_suction_closes_as_compression_begins_whatever_the_wrap(pairs):
    """A chamber of a short wrap stays at its largest volume until its lobe ahead leaves the cusp at high pressure."""
    pair = pairs["c"].pair
    leaves = -pair.beta1 - pair.pitch
    for wrap in (200.0, 201.0, 220.0, 240.0):
        angle, largest = replace(pairs["c"], wrap=math.radians(wrap)).largest
        assert angle == pytest.approx(leaves, abs=1e-6)
        assert largest == pytest.approx(pairs["c"].length * pairs["c"].sections.grooves, rel=1e-6)
    later = [replace(pairs["c"], wrap=math.radians(wrap)).largest[0] for wrap in (255.0, 270.0, 300.0)]
    assert leaves < later[0] < later[1] < later[2]  # with a longer wrap it is largest when compression has begun
