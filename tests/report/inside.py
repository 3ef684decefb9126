"""Whether all text of a figure lies inside it."""

from collections.abc import Callable
from typing import Any

from screwsim.report.style import journal


def assert_text_inside(draw: Callable[[], Any]) -> None:
    """Check it of the figure that a function draws."""
    with journal():
        figure = draw()
        figure.draw_without_rendering()
        box = figure.get_tightbbox(figure.canvas.get_renderer())  # [inch]
    assert box.x0 >= -0.01 and box.y0 >= -0.01
    assert box.x1 <= figure.get_figwidth() + 0.01 and box.y1 <= figure.get_figheight() + 0.01
