"""R134a in POE: the content that the source's formula gives, its inverse, and that it grows as it must."""

from functools import lru_cache

import numpy as np
import pytest
from each_row import each_row

from screwsim.effects import refrigerant_solubility as effect
from screwsim.fluid.real_gas import RealGas


@pytest.mark.parametrize(("bar", "share"), [(3.15, 0.034), (8.87, 0.127), (11.6, 0.190)])
def test_content_at_70_degrees_is_that_of_the_source(bar, share):
    """Per kilogram of solution, printed to three digits."""
    content = effect.content(1e5 * bar, 343.15)
    assert content / (1.0 + content) == pytest.approx(share, abs=6e-4)


@each_row("T", [283.0, 313.0, 343.0])
@each_row("ratio", [0.02, 0.1, 0.3])
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


GAS = RealGas(effect.solubility.FLUID, "refuse")


@lru_cache
def solved(T):
    return effect.solution(GAS, 345.0, T, 12e5, 1.0, 1.0)


def in_equilibrium(p, T, T_supply=325.0):
    """Return what the oil of a chamber holds in equilibrium with gas of its own temperature (M232)."""
    solution, gas = solved(T_supply), GAS.vapour(p, T)
    found = np.interp(gas.s - (gas.h - solution.enthalpy) / T, solution.entropy[::-1], solution.log_held[::-1])
    return float(np.exp(found))


@pytest.mark.parametrize("p", [1e5, 4e5, 12e5])
def test_equilibrium_of_the_rate_is_the_content_at_the_supply(p):
    assert in_equilibrium(p, 325.0) == pytest.approx(effect.content(p, 325.0), rel=2e-3)  # linear between rows here


def test_equilibrium_of_the_rate_is_the_content_in_the_separator():
    assert in_equilibrium(12e5, 345.0) == pytest.approx(effect.content(12e5, 345.0), rel=2e-3)


@each_row("T", [325.0, 330.0, 335.0, 340.0, 345.0])
@each_row("p", [4e5, 8e5, 12e5])
def test_equilibrium_of_the_rate_is_near_the_content_between_them(p, T):
    assert in_equilibrium(p, T) == pytest.approx(effect.content(p, T), rel=0.1)


def test_heat_of_solution_passes_over_to_its_slope_where_both_are_as_warm():
    near, same = (effect.heat_enthalpy(GAS, T, 325.0, 8e5) for T in (330.01, 325.0))
    assert near == pytest.approx(same, abs=6e3)
