"""Figures of a result: mappings whose names are attributes, and remain so in a copy."""

from screwsim.outputs.figures import Figures


def test_a_copy_has_the_same_names_as_attributes_and_is_apart():
    figures = Figures(shaft_power=2e4)
    other = figures.copy()
    other["shaft_power"] *= 2.0
    assert (other.shaft_power, figures.shaft_power) == (4e4, 2e4) and type(other) is Figures
