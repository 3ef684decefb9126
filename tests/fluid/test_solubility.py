"""R134a in POE: the content that the source's formula gives, its inverse, and that it grows as it must."""

import pytest

from screwsim.effects import refrigerant_solubility as effect


@pytest.mark.parametrize(("bar", "share"), [(3.15, 0.034), (8.87, 0.127), (11.6, 0.190)])
def test_content_at_70_degrees_is_that_of_the_source(bar, share):
    """Per kilogram of solution, printed to three digits."""
    content = effect.content(1e5 * bar, 343.15)
    assert content / (1.0 + content) == pytest.approx(share, abs=6e-4)


@pytest.mark.parametrize("T", [283.0, 313.0, 343.0])
@pytest.mark.parametrize("ratio", [0.02, 0.1, 0.3])
def test_pressure_over_a_solution_is_the_inverse_of_its_content(T, ratio):
    assert effect.content(effect.equilibrium_pressure(ratio, T), T) == pytest.approx(ratio, rel=1e-7)


def test_content_grows_with_pressure_and_falls_with_temperature():
    by_pressure = [effect.content(1e5 * bar, 333.0) for bar in range(1, 16)]
    assert by_pressure == sorted(by_pressure)
    by_temperature = [effect.content(6e5, float(T)) for T in range(300, 370, 5)]
    assert by_temperature == sorted(by_temperature, reverse=True)


def test_no_gas_nothing_dissolved():
    assert effect.content(0.0, 330.0) == 0.0
    assert effect.content(10.0, 330.0) < 1e-6


def test_what_flashes_leaves_equilibrium_behind():
    supply, latent, c_oil = 0.2, 150e3, 1950.0
    flash = effect.flashed(3e5, 325.0, supply, latent, c_oil)
    assert 0.0 < flash < supply
    assert effect.content(3e5, 325.0 - flash * latent / c_oil) == pytest.approx(supply - flash, rel=1e-8)


def test_oil_that_could_hold_more_does_not_flash():
    assert effect.flashed(3e5, 280.0, 0.05, 190e3, 1950.0) == 0.0
