"""Units of data frames: one style for axes, inputs and figures, and the same unit as in the scene."""

import pytest

from screwsim.export.inputs import exponents
from screwsim.inputs.declare import KINDS
from screwsim.outputs.display import cf_unit


@pytest.mark.parametrize("units", sorted({kind.si for kind in KINDS.values()}))
def test_a_unit_of_a_scene_is_the_same_unit_in_cf_style(units):
    told = cf_unit(units)
    assert exponents(told) == exponents(units)
    assert not set("/^()") & set(told) and cf_unit(told) == told


@pytest.mark.parametrize(
    ("units", "told"),
    [("rad/s", "rad s-1"), ("W/(m^2 K)", "W m-2 K-1"), ("1/K", "K-1"), ("m^3/s", "m3 s-1"), ("1", "1"), ("Pa", "Pa")],
)
def test_units_are_written_as_those_of_figures(units, told):
    assert cf_unit(units) == told
