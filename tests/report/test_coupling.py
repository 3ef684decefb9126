"""Figures of the rubber-cord coupling: all there, all text inside the figure."""

from math import radians

import pytest
from inside import assert_text_inside

from screwsim.machine.drive.rubber_cord_coupling import RubberCordCoupling
from screwsim.report import drive as figures

pytestmark = pytest.mark.around
COUPLING = RubberCordCoupling()
DRAWN = RubberCordCoupling(cords=60, lean_plus=radians(36.0), lean_minus=radians(36.0))
LEANS = (figures.CordLean(radians(27.9), radians(21.9), radians(34.1)),)


def draw(name):
    return figures.torque_figure(COUPLING, LEANS, 11768.0) if name == "torque_figure" else getattr(figures, name)(DRAWN)


@pytest.mark.parametrize("name", ["cords_figure", "crossing_figure", "torque_figure"])
def test_all_text_lies_inside_the_figure(name):
    assert_text_inside(lambda: draw(name))


def test_all_figures_are_written(sketched, tmp_path):
    written = figures.draw_coupling(COUPLING, DRAWN, LEANS, 11768.0, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(path.rpartition("/")[2] for path in written)
    assert len(written) == 6
