"""Rules of quantities: what is read, what is refused, and that text gives the same float back."""

import math
import re
import subprocess
import sys

import pytest
from each_row import each_row
from hypothesis import given
from hypothesis import strategies as st

from screwsim.inputs.declare import KINDS
from screwsim.scene.numerals import odd_number
from screwsim.scene.units import Refused, format_quantity, parse_quantity, readable_quantity


@each_row(
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
        ("conductance", "0.5 kW/K", 500.0),
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
        ("temperature_difference", "18 delta_degF", 10.0),
        ("temperature_difference", "18 degR", 10.0),
        ("heat_capacity", "1 cal/(g K)", 4184.0),
        *(("volume_flow", f"350 {unit}", 350.0 * 0.3048**3 / 60.0) for unit in ("ft^3/min", "cfm", "CFM", "acfm")),
        ("displacement", "350 acfm", 350.0 * 0.3048**3 / 60.0),
    ],
)
def test_other_units_are_read_with_pint(kind, text, value):
    assert parse_quantity(KINDS[kind], text) == pytest.approx(value, rel=1e-12)


@each_row(
    ("kind", "text", "what"),
    [
        ("length", "abc", "'abc' is not a length (write e.g. '128 mm')"),
        ("length", "128", "'128' has no unit (write e.g. '128 mm')"),
        ("length", "0", "'0' has no unit (write e.g. '128 mm')"),
        ("length", "5 kg", "'5 kg' is not a length (write e.g. '128 mm')"),
        ("length", "5 mmm", "'5 mmm' is not a length (write e.g. '128 mm')"),
        ("length", "1 000 mm", "'1 000 mm' has marks between its digits (write '1000 mm')"),
        ("length", "nan mm", "'nan mm' is not a length (write e.g. '128 mm')"),
        ("length", "1e999 mm", "'1e999 mm' is not finite (write e.g. '128 mm')"),
        ("length", "9**9**9 m", "'9**9**9 m' is not a length (write e.g. '128 mm')"),
        ("length", "1 m**9**9**9", "'1 m**9**9**9' is not a length (write e.g. '128 mm')"),
        ("pressure", "1,5 bar", "'1,5 bar' has a decimal comma (write a point, e.g. '1.5 bar')"),
        ("pressure", "5 barg", "'5 barg' is a gauge pressure (write the absolute pressure, e.g. '2 bar')"),
        ("pressure", "5 bar(g)", "'5 bar(g)' is a gauge pressure (write the absolute pressure, e.g. '2 bar')"),
        ("pressure", "5 psig", "'5 psig' is a gauge pressure (write the absolute pressure, e.g. '2 bar')"),
        ("speed", "50 Hz", "'50 Hz' is ambiguous: turns or radians (write rpm, rev/s or rad/s, e.g. '3000 rpm')"),
        ("speed", "50 m/s", "'50 m/s' is not a speed (write e.g. '3000 rpm')"),
        ("angle", "5 percent", "'5 percent' is not an angle (write e.g. '60 deg')"),
        (
            "temperature_difference",
            "5 degC",
            "'5 degC' is a temperature, not a difference (write K or delta_degF, e.g. '10 K')",
        ),
        (
            "temperature_difference",
            "5 degreeC",
            "'5 degreeC' is a temperature, not a difference (write K or delta_degF, e.g. '10 K')",
        ),
        (
            "temperature_difference",
            "5 degree_Fahrenheit",
            "'5 degree_Fahrenheit' is a temperature, not a difference (write K or delta_degF, e.g. '10 K')",
        ),
        ("volume", "128 cm^3/turn", "'128 cm^3/turn' is not a volume (write e.g. '500 cm^3')"),
        ("volume_flow", "128 cm^3 rpm", "'128 cm^3 rpm' is not a volume flow (write e.g. '20 m^3/min')"),
        (
            "temperature_difference",
            "5 C",
            "'5 C' is a temperature, not a difference (write K or delta_degF, e.g. '10 K')",
        ),
        ("temperature", "50 F", "'50 F' is not a temperature (write '50 degF')"),
        (
            "speed",
            "3000 1/min",
            "'3000 1/min' is ambiguous: turns or radians (write rpm, rev/s or rad/s, e.g. '3000 rpm')",
        ),
        (
            "displacement",
            "350 ICFM",
            "'350 ICFM' counts gas at a compressor's inlet (write acfm, where that is the state of this flow)",
        ),
        ("displacement", "350 lpm", "'350 lpm' is not a displacement (write '350 L/min')"),
        ("speed", "3000 U/min", "'3000 U/min' is not a speed (write '3000 rpm')"),
        ("power", "200 HP", "'200 HP' is not a power (write '200 hp')"),
        ("power", "100 tons", "'100 tons' is not a power (write '100 refrigeration_ton')"),
        (
            "power",
            "1200 MBtu/h",
            "'1200 MBtu/h' is ambiguous: a thousand or a million Btu (write kBtu/h or kW, e.g. '75 kW')",
        ),
        (
            "power",
            "2 MMBtu/h",
            "'2 MMBtu/h' is in a million Btu (write 1000 kBtu/h for each MMBtu/h, or e.g. '75 kW')",
        ),
        *(
            (
                "volume_flow",
                f"300 {unit}",
                f"'300 {unit}' counts gas at a standard state (write the flow at its own state, e.g. '20 m^3/min')",
            )
            for unit in ("scfm", "SCFM", "Nm3/h", "Nm^3/min", "MMSCFD", "Nl/min", "Sm³/h")
        ),
        ("power", "1200 MBH", "'1200 MBH' is not a power (write '1200 kBtu/h')"),
        ("pressure", "2 Bar", "'2 Bar' is not a pressure (write '2 bar')"),
        ("pressure", "2 bar(a)", "'2 bar(a)' is not a pressure (write '2 bar')"),
        ("pressure", "2 mpa", "'2 mpa' is not a pressure (write e.g. '2 bar')"),  # mPa or MPa
        ("pressure", "2 psid", "'2 psid' is a difference, not an absolute pressure (write e.g. '2 bar')"),
        ("pressure_difference", "2 psid", "'2 psid' is not a pressure difference (write '2 psi')"),
        ("power", "2 mw", "'2 mw' is not a power (write e.g. '75 kW')"),
        ("viscosity", "20 MPas", "'20 MPas' is not a viscosity (write e.g. '20 mPa s')"),  # not milli
        ("viscosity", "20 mPas", "'20 mPas' is not a viscosity (write '20 mPa s')"),
        (
            "viscosity",
            "20 cSt",
            "'20 cSt' is a kinematic viscosity (multiply it by the density; write e.g. '20 mPa s')",
        ),
        ("pressure", "50 %", "'50 %' is a share, not a pressure (write e.g. '2 bar')"),
    ],
)
def test_traps_are_refused_with_a_remedy(kind, text, what):
    with pytest.raises(Refused) as refusal:
        parse_quantity(KINDS[kind], text)
    assert str(refusal.value) == what


TWO = "that may separate thousands or decimals (write"
DECIMALS = "if decimals are meant)"
ONE = "has marks between its digits (write"
ALIEN = "has a sign or digits that are not ASCII (write"
NUMBERS = [
    # (number, what is said of it with the unit rpm)
    ("3,000", f"has a comma {TWO} '3000 rpm', or '3 rpm' {DECIMALS}"),
    ("1,250", f"has a comma {TWO} '1250 rpm', or '1.25 rpm' {DECIMALS}"),
    ("-3,000", f"has a comma {TWO} '-3000 rpm', or '-3 rpm' {DECIMALS}"),
    ("3·000", f"has a dot {TWO} '3000 rpm', or '3 rpm' {DECIMALS}"),
    ("3,5", "has a decimal comma (write a point, e.g. '3.5 rpm')"),
    ("0,500", "has a decimal comma (write a point, e.g. '0.500 rpm')"),
    ("3,0000", "has a decimal comma (write a point, e.g. '3.0000 rpm')"),
    ("1,000,000", f"{ONE} '1000000 rpm')"),
    ("1.000.000", f"{ONE} '1000000 rpm')"),
    ("1.000,5", f"{ONE} '1000.5 rpm')"),
    ("1,000.5", f"{ONE} '1000.5 rpm')"),
    ("1 000", f"{ONE} '1000 rpm')"),
    ("1 000,5", f"{ONE} '1000.5 rpm')"),
    ("1\u202f000", f"{ONE} '1000 rpm')"),
    ("1\u00a0000", f"{ONE} '1000 rpm')"),
    ("1'000", f"{ONE} '1000 rpm')"),
    ("1’000", f"{ONE} '1000 rpm')"),
    ("1_000", f"{ONE} '1000 rpm')"),
    ("12,34,567", "is not one number (write one number: digits, and a point before decimals)"),
    ("3000.0.0", "is not one number (write one number: digits, and a point before decimals)"),
    ("１０００", f"{ALIEN} '1000 rpm')"),
    ("٣٠٠٠", f"{ALIEN} '3000 rpm')"),
    ("−10", f"{ALIEN} '-10 rpm')"),
    ("½", "is a fraction (write '0.5 rpm')"),
    ("1½", "is a fraction (write '1.5 rpm')"),
    ("1/2", "is a fraction (write '0.5 rpm')"),
    ("3×10³", "is a product (write '3e3 rpm')"),
    ("3*10^-3", "is a product (write '3e-3 rpm')"),
    ("~3000", "contains more than a number (write '3000 rpm')"),
    ("3000 … 4000", "is a range (write one number: digits, and a point before decimals)"),
    ("3000±5", "states more than one number (write one number: digits, and a point before decimals)"),
    ("“3000", "has typographic quotes (write '3000 rpm')"),
]


@each_row(("number", "told"), NUMBERS)
def test_a_number_of_two_readings_or_of_another_script_is_told_and_not_read(number, told):
    with pytest.raises(Refused) as refusal:
        parse_quantity(KINDS["speed"], f"{number} rpm")
    assert str(refusal.value) == f"{f'{number} rpm'!r} {told}"


@each_row(("number", "told"), NUMBERS)
def test_what_is_offered_for_a_number_is_read(number, told):
    for offered in re.findall(r"'([^']* rpm)'", told):
        assert parse_quantity(KINDS["speed"], offered) != 0.0


@each_row("text", ["1e3rpm", "1.0e3 rpm", "+1000 rpm", "1000rpm", "1000.\u00a0rpm"])
def test_a_number_of_one_reading_is_read(text):
    assert parse_quantity(KINDS["speed"], text) == pytest.approx(1000.0 * math.pi / 30.0)


@each_row("text", ["-10 C", "-10 °C", "-10 degC", "-10C", "-10 ℃", "-10 Celsius"])
def test_a_temperature_may_be_below_zero_celsius(text):
    assert parse_quantity(KINDS["temperature"], text) == pytest.approx(263.15)


def test_a_unit_that_lacks_is_offered_as_an_example_only():
    with pytest.raises(Refused, match=r"^'3,5' has a decimal comma \(write a point, e\.g\. '3\.5 bar'\)$"):
        parse_quantity(KINDS["pressure"], "3,5")
    with pytest.raises(Refused, match=r"\(write e\.g\. '3000 bar', or '3 bar' if decimals are meant\)$"):
        parse_quantity(KINDS["pressure"], "3,000")


@each_row("kind", KINDS.values(), ids=lambda kind: kind.name)
def test_the_example_of_a_kind_reads_back(kind):
    value = parse_quantity(kind, kind.example)
    assert parse_quantity(kind, format_quantity(kind, value)) == value


@each_row(
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
    heavy = "('pint', 'CoolProp', 'llvmlite', 'matplotlib', 'scipy', 'pydantic')"
    code = f"import sys, screwsim.scene; print([name for name in {heavy} if name in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


@pytest.mark.parametrize("text", ["1" * 10**6, "1" * 10**6 + " x", "1," * 10**5 + "1", "1/" * 10**5, "~" * 10**5 + "1"])
def test_a_text_longer_than_any_number_is_told_at_once(text):
    """Patterns that try every division of so many digits would take days."""
    assert odd_number(text) is None
    with pytest.raises(Refused):
        parse_quantity(KINDS["pressure"], text)
