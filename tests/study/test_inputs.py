"""Values of a scene as studies print them: temperatures in °C, differences of them in K."""

import pytest

from screwsim.figures.engineering import error_text, figure_text
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import with_printed_units
from screwsim.scene import load, with_values
from screwsim.study.asked.inputs import check_fit, in_customary, read_text, shown_number, shown_value, unit_of_change

CONDENSING = "operation.condensing_temperature"


@pytest.fixture(scope="module")
def scene():
    return load("configs/r134a/point.yaml")


@pytest.mark.parametrize(
    ("T", "digits", "text"),
    [(313.15, 5, "40 °C"), (273.15, 5, "0 °C"), (263.144, 5, "-10.01 °C"), (314.4551234, 7, "41.3051 °C")],
)
def test_a_temperature_is_shown_in_degrees_celsius_and_reads_back(scene, T, digits, text):
    """As finely as so many digits of it in K: 0.5 of the last decimal."""
    assert shown_value(scene, CONDENSING, T, digits) == text
    assert shown_number(scene, CONDENSING, T, digits) == text.removesuffix(" °C")
    assert read_text(scene, CONDENSING, text) == pytest.approx(T, abs=0.5 * 10.0 ** (3 - digits))


def test_no_temperature_of_a_scene_has_the_dust_of_273_15(scene):
    assert in_customary(scene, CONDENSING, 273.15 + 0.1) == (0.1, "°C")


def test_a_difference_of_temperatures_stays_in_kelvin(scene):
    assert shown_value(scene, "operation.superheat", 10.0) == "10 K"
    assert unit_of_change(scene, CONDENSING, 313.15) == (1.0, "K")


def test_a_figure_in_a_sentence_is_in_degrees_celsius_and_its_error_in_kelvin():
    assert figure_text("discharge_temperature", 345.15) == "72.00 °C"
    assert error_text("discharge_temperature", 345.15, 0.0034) == "0.003 K"
    assert figure_text("discharge_superheat", 10.0) == "10 K"


def test_a_fault_is_told_with_its_path_once(scene):
    with pytest.raises(UsageError) as refusal:
        check_fit(scene, {CONDENSING: 275.15}, CONDENSING)
    assert str(refusal.value).count(CONDENSING) == 1


def test_a_fault_that_the_values_do_not_cause_is_told_with_its_own_path_alone(scene):
    """It was told as one of the varied path."""
    broken = with_values(scene, {"operation.tip_speed": 20.0})
    with pytest.raises(UsageError, match=r"^operation\.tip_speed: is given as well as"):
        check_fit(broken, {CONDENSING: 313.15}, CONDENSING)


def test_a_title_has_its_units_as_they_are_printed():
    assert with_printed_units("R134a, 0/40 degC, 600 m^3/h") == "R134a, 0/40 °C, 600 m³/h"
    assert with_printed_units("degCelsius, rdegC") == "degCelsius, rdegC"
