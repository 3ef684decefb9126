"""Rules of quantities: what is read, what is refused, and that text gives the same float back."""

import math
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from screwsim.declare import KINDS
from screwsim.scene.units import Refused, format_quantity, parse_quantity, readable_quantity


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        ("length", "128 mm", 0.128),
        ("length", "128mm", 0.128),
        ("length", "1e-3 m", 1e-3),
        ("length", "50 µm", 50e-6),
        ("length", "50 um", 50e-6),
        ("area", "20 cm²", 20e-4),
        ("area", "20 cm2", 20e-4),
        ("volume", "0.5 L", 0.5e-3),
        ("pressure", "1.5 bar", 1.5e5),
        ("temperature", "20 °C", 293.15),
        ("temperature", "20 degC", 293.15),
        ("temperature_difference", "5 K", 5.0),
        ("speed", "3000 rpm", 100 * math.pi),
        ("speed", "50 rev/s", 100 * math.pi),
        ("angle", "60 °", math.radians(60)),
        ("heat_capacity", "2 kJ/kg/K", 2000.0),
        ("viscosity", "20 cP", 0.02),
        ("viscosity", "20 mPa·s", 0.02),
        ("heat_transfer_coefficient", "0.5 kW/m²/K", 500.0),
    ],
)
def test_usual_units_are_read(kind, text, value):
    assert parse_quantity(KINDS[kind], text) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        ("length", "5 inch", 0.127),
        ("pressure", "1 atm", 101325.0),
        ("temperature", "50 degF", 283.15),
        ("heat_capacity", "1 cal/(g K)", 4184.0),
    ],
)
def test_other_units_are_read_with_pint(kind, text, value):
    assert parse_quantity(KINDS[kind], text) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("kind", "text", "what"),
    [
        ("length", "abc", "'abc' is not a length (write e.g. '128 mm')"),
        ("length", "128", "'128' has no unit (write e.g. '128 mm')"),
        ("length", "0", "'0' has no unit (write e.g. '128 mm')"),
        ("length", "5 kg", "'5 kg' is not a length (write e.g. '128 mm')"),
        ("length", "5 mmm", "'5 mmm' is not a length (write e.g. '128 mm')"),
        ("length", "1 000 mm", "'1 000 mm' is not a length (write e.g. '128 mm')"),
        ("length", "nan mm", "'nan mm' is not a length (write e.g. '128 mm')"),
        ("length", "1e999 mm", "'1e999 mm' is not finite (write e.g. '128 mm')"),
        ("length", "9**9**9 m", "'9**9**9 m' is not a length (write e.g. '128 mm')"),
        ("length", "1 m**9**9**9", "'1 m**9**9**9' is not a length (write e.g. '128 mm')"),
        ("pressure", "1,5 bar", "'1,5 bar' has a decimal comma (write a point, e.g. '1.5 bar')"),
        ("pressure", "5 barg", "'5 barg' is a gauge pressure (write the absolute pressure, e.g. '2 bar')"),
        ("pressure", "5 bar(g)", "'5 bar(g)' is a gauge pressure (write the absolute pressure, e.g. '2 bar')"),
        ("pressure", "5 psig", "'5 psig' is a gauge pressure (write the absolute pressure, e.g. '2 bar')"),
        ("speed", "50 Hz", "'50 Hz' is ambiguous, turns or radians (write rpm, rev/s or rad/s, e.g. '3000 rpm')"),
        ("speed", "50 m/s", "'50 m/s' is not a speed (write e.g. '3000 rpm')"),
        ("angle", "5 percent", "'5 percent' is not an angle (write e.g. '60 deg')"),
        (
            "temperature_difference",
            "5 degC",
            "'5 degC' is a temperature, not a difference (write kelvin, e.g. '10 K')",
        ),
        ("temperature", "10 C", "'10 C' is not a temperature (write e.g. '285 K')"),
    ],
)
def test_traps_are_refused_with_a_remedy(kind, text, what):
    with pytest.raises(Refused) as refusal:
        parse_quantity(KINDS[kind], text)
    assert str(refusal.value) == what


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda kind: kind.name)
def test_the_example_of_a_kind_reads_back(kind):
    value = parse_quantity(kind, kind.example)
    assert parse_quantity(kind, format_quantity(kind, value)) == value


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        ("speed", 100 * math.pi, "3000 rpm"),
        ("pressure", 1.5e5, "1.5 bar"),
        ("length", 50e-6, "0.05 mm"),
        ("angle", 4 * math.pi, "720 deg"),
        ("volume", 6e-4, "600 cm^3"),
    ],
)
def test_values_are_written_in_customary_units(kind, value, text):
    assert format_quantity(KINDS[kind], value) == text


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        ("length", 60e-6 + 1e-20, "0.06 mm"),
        ("temperature", 313.15 + 1e-13, "313.15 K"),
        ("pressure", 1.23456789012e5, "1.23456789 bar"),
    ],
)
def test_values_for_people_show_no_rounding(kind, value, text):
    assert readable_quantity(KINDS[kind], value) == text


@given(kind=st.sampled_from(list(KINDS.values())), value=st.floats(1e-12, 1e12))
def test_written_quantities_read_back_exactly(kind, value):
    assert parse_quantity(kind, format_quantity(kind, value)) == value


def test_importing_the_layer_leaves_heavy_libraries_alone():
    heavy = "('pint', 'CoolProp', 'numba', 'matplotlib', 'scipy', 'pydantic')"
    code = f"import sys, screwsim.scene; print([name for name in {heavy} if name in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"
