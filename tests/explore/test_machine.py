"""The drawing has the machine's angles: chambers end where its laws say, and rotors mesh."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from screwsim.explore.machine import document
from screwsim.machine.rotors.sections import polygon_area
from screwsim.scene import load

pytestmark = pytest.mark.around
CONFIGS = Path(__file__).parents[2] / "configs"


def machine_of(name):
    return load(CONFIGS / name, ["sweep=null"]).machine


@pytest.mark.parametrize(("male", "female"), [(2, 3), (3, 4), (3, 5), (4, 5), (4, 6), (5, 6), (5, 7), (6, 8), (8, 10)])
def test_sketched_rotors_end_a_chamber_with_its_law(male, female):
    found = document(replace(machine_of("paper/point.yaml"), male_lobes=male, female_lobes=female))
    assert found["kind"] == "rotors" and found["sketch"]
    assert found["start"] + found["life"] - found["wrap"] == pytest.approx(0.0, abs=1e-9)  # ψ = 0 at the outlet
    assert found["chambers"] * found["pitch"] == pytest.approx(found["life"])
    assert found["k"] == pytest.approx(male / female)


def outline(path):
    points = [tuple(map(float, each.split(","))) for each in path.strip("MZ").split("L")]
    return np.array(points).T


def test_sketched_rotors_are_no_larger_than_the_machine():
    found = document(machine_of("paper/point.yaml"))
    x, y = outline(found["male"])
    assert np.hypot(x, y).max() == pytest.approx(80.0, abs=0.05)  # half of 160 mm; outlines have two decimals
    assert polygon_area(x, y) < math.pi * 80.0**2


def test_rotors_of_a_profile_are_drawn_as_they_are():
    machine = machine_of("rotors/c.yaml")
    found = document(machine)
    assert not found["sketch"] and found["lobes"] == [5, 6]
    assert pytest.approx(116.8) == found["A"]
    assert pytest.approx(68.8) == found["R2"]
    assert found["wrap"] == pytest.approx(300.0)


def test_sketched_and_true_rotors_do_not_cut_into_each_other():
    """At any angle no point of the male outline lies inside the female one, seen by its nearest neighbours' side."""
    for name in ("paper/point.yaml", "rotors/c.yaml"):
        found = document(machine_of(name))
        male, female = outline(found["male"]), outline(found["female"])
        for psi in np.radians(np.linspace(0.0, 360.0 / found["lobes"][0], 7)):
            x, y = turned(male, -psi)
            u, v = turned(np.array([x - found["A"], y]), -found["k"] * psi)
            inside = depth_inside(u, v, *female)
            assert inside < 0.15  # mm: half of the longest straight piece of an outline bulges by less


def turned(points, angle):
    c, s = math.cos(angle), math.sin(angle)
    return c * points[0] - s * points[1], s * points[0] + c * points[1]


def depth_inside(x, y, u, v):
    """Return how far the deepest of some points lies inside a polygon; 0 where none does."""
    from matplotlib.path import Path as Polygon

    edges = np.column_stack([u, v])
    within = Polygon(edges).contains_points(np.column_stack([x, y]))
    if not within.any():
        return 0.0
    starts, ends = edges, np.roll(edges, -1, axis=0)
    along = ends - starts
    deepest = 0.0
    for point in np.column_stack([x, y])[within]:
        part = np.clip(np.sum((point - starts) * along, axis=1) / np.maximum(np.sum(along**2, axis=1), 1e-12), 0.0, 1.0)
        deepest = max(deepest, float(np.min(np.hypot(*(starts + part[:, None] * along - point).T))))
    return deepest


def test_a_cylinder_and_an_expander_say_what_they_are():
    assert document(machine_of("slider_crank/air.yaml"))["kind"] == "cylinder"
    assert document(machine_of("expander/point.yaml"))["backwards"]
    assert not document(machine_of("paper/point.yaml"))["backwards"]
