"""Figures of the tolerance study: all there, all text inside the figure."""

import numpy as np
import pytest
from inside import assert_text_inside

from screwsim.machine.slider_crank.tolerance import links_of, tabulated
from screwsim.report import slider_crank as figures

pytestmark = pytest.mark.around
NOMINAL = links_of(4.4, 12.0, 4.5, 0.015)
ALPHA = np.linspace(-np.pi, np.pi, 24, endpoint=False)
POINTS = (ALPHA, tabulated(ALPHA, NOMINAL))


@pytest.mark.parametrize("name", ["functions_figure", "surface_figure", "contour_figure", "law_figure"])
def test_all_text_lies_inside_the_figure(name):
    asked = {"functions_figure": (NOMINAL, POINTS), "law_figure": (NOMINAL,)}
    assert_text_inside(lambda: getattr(figures, name)(*asked.get(name, (ALPHA, NOMINAL))))


def test_all_figures_are_written(sketched, tmp_path):
    written = figures.draw_tolerance(ALPHA, NOMINAL, POINTS, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(path.rpartition("/")[2] for path in written)
    assert len(written) == 6
