"""Figures of the flexible connecting rod: all there, all text inside the figure."""

import numpy as np
import pytest
from inside import assert_text_inside

from screwsim.machine.slider_crank.rod import FlexibleRod, bend
from screwsim.report import slider_crank as figures

pytestmark = pytest.mark.around
ROD = FlexibleRod(width=9e-3, thickness=0.46e-3, flexible=23e-3, length=45.5e-3, crank_radius=1.5e-3, modulus=206e9)
ALPHA = np.linspace(0.0, 2.0 * np.pi, 72, endpoint=False)
BENDING = bend(ROD, ALPHA, -100.0 * np.sin(ALPHA))


@pytest.mark.parametrize("name", ["stability_figure", "bending_figure"])
def test_all_text_lies_inside_the_figure(name):
    assert_text_inside(lambda: getattr(figures, name)(ROD, BENDING))


def test_all_figures_are_written(sketched, tmp_path):
    written = figures.draw_rod(ROD, BENDING, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(path.rpartition("/")[2] for path in written)
    assert len(written) == 4
