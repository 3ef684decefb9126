"""Sizes of two new stages are found from any first guess that is not too far off."""

import pytest

from screwsim.study.sizing_of_two import EQUAL, NEARLY, sized_stages
from screwsim.template import request_of


@pytest.mark.parametrize(("condition", "equal"), [("-35/35 degC", EQUAL), ("-40/20 degC", NEARLY)])
def test_ammonia_in_two_stages_finds_its_sizes(condition, equal):
    """Vapour of the flash tank makes the first guess of the second stage too small; rounded numbers let it jump."""
    found = sized_stages("refrigeration", request_of(fluid="Ammonia", condition=condition))
    assert found.result.status == "ok"
    assert found.result.performance["intermediate_pressure"] == pytest.approx(found.ends.between, rel=equal)
