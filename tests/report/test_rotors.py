"""Figures of a pair of rotors: all text inside; that files are the same again stands in tests/cli/test_rotors.py."""

import math

import pytest
from inside import assert_text_inside

from screwsim.machine.rotors.curves import make_curves
from screwsim.machine.rotors.rotors import Rotors, make_rotors
from screwsim.machine.rotors.settings import Profile
from screwsim.report import rotors as figures

pytestmark = pytest.mark.around


@pytest.fixture(scope="module")
def pair() -> Rotors:
    """Return the asymmetric 4/6 pair (b) of docs/reference/rotors.md."""
    profile = Profile(
        kind="rack",
        centre_distance=0.08,
        female_diameter=0.1,
        wrap_angle=math.radians(300.0),
        male_tip_radius=1e-3,
        female_tip_radius=3e-3,
        flank_radius=22e-3,
        pressure_angle=math.radians(35.0),
        root_radius=3e-3,
    )
    return make_rotors(profile, 4, 6, 0.1, 0.11)


def draw(pair, name):
    """Return one of the four figures."""
    curves = make_curves(pair, 3.2)
    given = {"volume_figure": (pair, curves), "areas_figure": (curves,)}
    return getattr(figures, name)(*given.get(name, (pair,)))


@pytest.mark.parametrize("name", ["mesh_figure", "sealing_figure", "volume_figure", "areas_figure"])
def test_all_text_lies_inside_the_figure(pair, name):
    assert_text_inside(lambda: draw(pair, name))
