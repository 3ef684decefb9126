"""A length as small as a gap is told with an example of its size."""

import pytest
from folders import POINT

import screwsim
from screwsim.inputs.faults import SceneError, UsageError


@pytest.mark.parametrize(
    ("path", "example"), [("effects.tip_leakage.gap", "27 um"), ("machine.rotor_diameter", "128 mm")]
)
def test_example_is_of_the_size_of_what_is_asked(path, example):
    with pytest.raises((SceneError, UsageError), match=f"'5 bar' is not a length \\(write e.g. '{example}'\\)"):
        screwsim.load(POINT).with_({path: "5 bar"})
