"""R134a in POE: limits of Heil's model, its inverse, and that the content grows as it must."""

import math
from functools import lru_cache

import numpy as np
import pytest
from CoolProp.CoolProp import PT_INPUTS, QT_INPUTS, AbstractState, iphase_gas
from each_row import each_row

from screwsim.effects import refrigerant_solubility as effect
from screwsim.fluid.real_gas import RealGas
from screwsim.fluid.solubility import FLUID, log_activity
from screwsim.fluid.solubility_laws import ESTER


@each_row("volumes", [0.2, 1.0, 7.0])
def test_without_interaction_heils_model_is_that_of_flory_and_huggins(volumes):
    """ln a = ln φ + 1 − v/v_mixture, with the volume fraction φ; `volumes`: the oil's molar volume over the gas's."""
    for x in (1e-3, 0.2, 0.9):
        mixture = x + volumes * (1.0 - x)
        athermal = math.log(x / mixture) + 1.0 - 1.0 / mixture
        assert log_activity(x, volumes, 1.0 / volumes, 0.0, 0.0) == pytest.approx(athermal, abs=1e-14)


@each_row("T", [263.0, 303.0, 343.0])
def test_activity_is_the_slope_of_heils_excess_energy(T):
    """ln γ₁ = g + (1 − x) dg/dx, of g^E/RT as the local volume fractions around each molecule give it."""
    _p, l_12, l_21, t_12, t_21, _m = ESTER.pair(T)

    def excess(x):
        y, a, b = 1.0 - x, x + l_12 * (1.0 - x), l_21 * x + 1.0 - x
        return -x * math.log(a) - y * math.log(b) + x * y * (t_12 * l_12 / a + t_21 * l_21 / b)

    for x in (0.05, 0.4, 0.9):
        step = 1e-5
        slope = (excess(x + step) - excess(x - step)) / (2.0 * step)
        found = log_activity(x, l_12, l_21, t_12, t_21) - math.log(x)
        assert found == pytest.approx(excess(x) + (1.0 - x) * slope, abs=1e-8)  # step² times the third derivative


@each_row("T", [256.0, 300.0, 343.0, 369.0])
def test_over_a_solution_vapour_has_the_potential_that_the_activity_gives_it(T):
    """g(p) = g_sat + R T ln(γ₁x₁), with h − T s of CoolProp's vapour: fugacities, not pressures (M195)."""
    state, found = AbstractState("HEOS", FLUID), ESTER.pair(T)
    state.update(QT_INPUTS, 1.0, T)
    p_sat, saturated = state.p(), state.hmass() - T * state.smass()
    state.specify_phase(iphase_gas)
    for held in (1e-3, 0.03, 0.2, 1.0):
        x = held / (held + found.mass_ratio)
        p = ESTER.equilibrium_pressure(held, T) / found.p_sat * p_sat
        state.update(PT_INPUTS, p, T)
        potential = (state.hmass() - T * state.smass() - saturated) * state.molar_mass() / (state.gas_constant() * T)
        assert potential == pytest.approx(log_activity(x, *found[1:5]), rel=0.0, abs=1e-5)  # of the table of ln φ
        assert ESTER.content(p, T) == pytest.approx(held, rel=1e-5)  # and between two tables of p_sat


@each_row("T", [256.0, 300.0, 343.0, 369.0])
def test_thin_solutions_obey_henrys_law(T):
    """p/w has a limit, from which it is far by no more than w in the order of the oil's ratio of moles."""
    thin, thinner = (ESTER.equilibrium_pressure(w, T) / w for w in (1e-4, 1e-6))
    assert thin == pytest.approx(thinner, rel=2e-3)


@each_row("T", [256.0, 273.0, 300.0, 343.0, 369.0])
def test_pressure_grows_with_content_so_that_oil_and_refrigerant_mix(T):
    """R134a and ester oils are one liquid; in two the pressure over the solution would fall somewhere."""
    contents = np.geomspace(1e-6, 3.9, 500)
    assert (np.diff([ESTER.equilibrium_pressure(float(w), T) for w in contents]) > 0.0).all()


@each_row("T", [256.0, 280.0, 325.0])
def test_entropy_of_what_is_dissolved_falls_over_the_whole_table(T):
    """Cold, too, where the fit is flat at many times as much gas as oil, and the table ends before."""
    assert (np.diff(solved(T).entropy) < 0.0).all()
    assert 3.9 < effect.most_held(ESTER, T) <= ESTER.most


@each_row("T", [283.0, 313.0, 343.0])
@each_row("ratio", [0.02, 0.1, 0.3])
def test_pressure_over_a_solution_is_the_inverse_of_its_content(T, ratio):
    assert ESTER.content(ESTER.equilibrium_pressure(ratio, T), T) == pytest.approx(ratio, rel=1e-7)


def test_content_grows_with_pressure_and_falls_with_temperature():
    by_pressure = [ESTER.content(1e5 * bar, 333.0) for bar in range(1, 16)]
    assert by_pressure == sorted(by_pressure)
    by_temperature = [ESTER.content(6e5, float(T)) for T in range(300, 370, 5)]
    assert by_temperature == sorted(by_temperature, reverse=True)


def test_no_gas_nothing_dissolved():
    assert ESTER.content(0.0, 330.0) == 0.0
    assert ESTER.content(10.0, 330.0) < 2e-6


def test_what_flashes_leaves_equilibrium_behind():
    supply, latent, c_oil = 0.2, 150e3, 1950.0
    flash = effect.flashed(ESTER, 3e5, 325.0, supply, latent, c_oil)
    assert 0.0 < flash < supply
    assert ESTER.content(3e5, 325.0 - flash * latent / c_oil) == pytest.approx(supply - flash, rel=1e-8)


def test_oil_that_could_hold_more_does_not_flash():
    assert effect.flashed(ESTER, 3e5, 280.0, 0.05, 190e3, 1950.0) == 0.0


GAS = RealGas(FLUID, "refuse")


@lru_cache
def solved(T):
    return effect.solution(ESTER, GAS, 345.0, T, 12e5, 1.0, 1.0)


def in_equilibrium(p, T, T_supply=325.0):
    """Return what the oil of a chamber holds in equilibrium with gas of its own temperature (M232)."""
    solution, gas = solved(T_supply), GAS.vapour(p, T)
    found = np.interp(gas.s - (gas.h - solution.enthalpy) / T, solution.entropy[::-1], solution.log_held[::-1])
    return float(np.exp(found))


@pytest.mark.parametrize("p", [1e5, 4e5, 12e5])
def test_equilibrium_of_the_rate_is_the_content_at_the_supply(p):
    assert in_equilibrium(p, 325.0) == pytest.approx(ESTER.content(p, 325.0), rel=2e-3)  # linear between rows here


def test_equilibrium_of_the_rate_is_the_content_in_the_separator():
    assert in_equilibrium(12e5, 345.0) == pytest.approx(ESTER.content(12e5, 345.0), rel=2e-3)


@each_row("T", [325.0, 330.0, 335.0, 340.0, 345.0])
@each_row("p", [4e5, 8e5, 12e5])
def test_equilibrium_of_the_rate_is_near_the_content_between_them(p, T):
    assert in_equilibrium(p, T) == pytest.approx(ESTER.content(p, T), rel=0.1)


def test_heat_of_solution_passes_over_to_its_slope_where_both_are_as_warm():
    near, same = (effect.heat_enthalpy(ESTER, GAS, T, 325.0, 8e5) for T in (330.01, 325.0))
    assert near == pytest.approx(same, abs=6e3)
