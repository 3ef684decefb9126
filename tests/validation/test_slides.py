"""Part load by slide valve in validation/templates: curves of chillers, and a new machine's own."""

from pathlib import Path

import pytest

from screwsim.study.validation import sibling

HERE = Path(__file__).parents[2] / "validation" / "templates"
slides = sibling(HERE / "slides.py")


def test_chillers_take_their_full_power_at_full_load():
    """The curves were fitted, to 0.4 %."""
    assert len(slides.chillers(HERE, 1.0)) == 24
    assert slides.chillers(HERE, 1.0) == pytest.approx([1.0] * 24, abs=4e-3)


def test_a_chiller_is_left_out_below_its_least_load():
    assert len(slides.chillers(HERE, 0.25)) < len(slides.chillers(HERE, 0.5)) == 24


@pytest.mark.around
def test_power_falls_with_the_load_by_slide_but_by_less():
    powers = [row.ours for row in slides.slides(HERE)]
    for load, power in zip(slides.LOADS, powers, strict=True):
        assert 100.0 * load < power < 100.0
    assert powers == sorted(powers, reverse=True)
