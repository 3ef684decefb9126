"""Numbers for programs and for people."""

import math

import numpy as np
import pytest

from screwsim.printing import engineering, plain


def test_plain_values_are_those_of_json():
    given = {"a": np.float64(1.5), "b": np.int64(2), "c": math.nan, "d": [np.inf, np.bool_(True)], "e": np.arange(2.0)}
    found = plain(given)
    assert found == {"a": 1.5, "b": 2, "c": None, "d": [None, True], "e": [0.0, 1.0]}
    assert [type(value) for value in (found["a"], found["b"])] == [float, int]


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("shaft_power", 61373.2, "61.373 kW"),
        ("oil_pump_power", 12.5, "12.5 W"),
        ("shaft_power", -2500.0, "-2.5 kW"),
        ("peak_pressure", 14.994e5, "14.994 bar"),
        ("isothermal_efficiency", 0.68, "68 %"),
        ("oil_ratio", 3.0, "3 "),
        ("trapped_mass", 3.9e-3, "3.9 g"),
        ("discharge_temperature", 300.0, "300.00 K (26.85 °C)"),
    ],
)
def test_figures_have_engineering_units(name, value, text):
    assert " ".join(engineering(name, value)) == text
