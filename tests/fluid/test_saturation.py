"""Saturation and two phases: both phases have one pressure and one Gibbs energy, and the dome follows from them."""

import math

import numpy as np
import pytest
from differences import difference
from each_row import each_row

from screwsim.fluid import constants
from screwsim.fluid.dome import inside_kernel, margin_kernel, saturation_kernels
from screwsim.fluid.helmholtz import entropy_kernel, potentials_kernel, state_kernel
from screwsim.fluid.real_gas import RealGas
from screwsim.fluid.saturation import fitted, nodes, saturation
from screwsim.fluid.transport import transport

PURE = ("R134a", "R1234yf", "R1234ze(E)", "R32", "Ammonia", "CarbonDioxide", "n-Propane", "Nitrogen")
REACH = (0.0, 0.3, 0.6, 0.9, 0.97, 0.99, 0.999, 0.9999)  # from the lowest temperature towards T_c


def temperatures(fluid):
    found = saturation(fluid)
    return [found.T_low + x * (found.T_c - found.T_low) for x in REACH]


def test_a_table_is_exact_for_a_polynomial_of_its_degree():
    edges = np.array([1.0, 1.5, 3.0])
    x = nodes(edges)
    table = fitted(edges, x**9 - 3.0 * x)
    at = np.linspace(1.0, 3.0, 50)
    assert table(at) == pytest.approx(at**9 - 3.0 * at, rel=1e-12)  # 3⁹ = 2e4 is summed from terms of its size


@each_row("fluid", PURE)
def test_both_phases_have_one_pressure_and_one_gibbs_energy(fluid):
    kernels, potentials, R = saturation_kernels(fluid), potentials_kernel(fluid), RealGas(fluid).R
    for T in temperatures(fluid):
        rho_l, rho_v = kernels.liquid(T), kernels.vapour(T)
        p_l, slope_l, g_l = potentials(T, rho_l)
        p_v, _, g_v = potentials(T, rho_v)
        p = kernels.pressure(T)[0]
        # densities are good to 1e-11: p follows that of the vapour, p of the liquid is that much of its own stiffness
        assert p_v == pytest.approx(p, rel=2e-11)
        assert abs(p_l - p) < 2e-11 * rho_l * slope_l + 1e-13 * rho_l * R * T
        assert abs(g_l - g_v) < 1e-11 * R * T
        assert kernels.gibbs(T)[0] == pytest.approx(g_v, abs=1e-11 * R * T)


def test_both_phases_agree_where_coolprops_vapour_is_a_tenth_of_its_equations():
    kernels, potentials = saturation_kernels("PropyleneGlycol"), potentials_kernel("PropyleneGlycol")
    for T in (255.0, 293.0, 400.0, 600.0):
        rho_v, p = kernels.vapour(T), kernels.pressure(T)[0]
        p_v, _, g_v = potentials(T, rho_v)
        assert p_v == pytest.approx(p, rel=1e-6)
        assert abs(potentials(T, kernels.liquid(T))[2] - g_v) < 1e-9 * RealGas("PropyleneGlycol").R * T


@each_row("fluid", PURE)
def test_saturation_is_coolprops(fluid):
    CP = pytest.importorskip("CoolProp.CoolProp")
    kernels, state = saturation_kernels(fluid), CP.AbstractState("HEOS", fluid)
    for T in temperatures(fluid)[:-2]:
        state.update(CP.QT_INPUTS, 1.0, T)
        p, rho_v = state.p(), state.rhomass()
        state.update(CP.QT_INPUTS, 0.0, T)
        # 1e-10: CoolProp's own fits; its pressure is coarser (up to 1e-3 far below 0.1 bar)
        assert kernels.vapour(T) == pytest.approx(rho_v, rel=1e-10)
        assert kernels.liquid(T) == pytest.approx(state.rhomass(), rel=1e-10)
        assert kernels.pressure(T)[0] == pytest.approx(p, rel=1e-9 if p > 1e4 else 1e-2)


@each_row("fluid", PURE)
def test_the_slope_of_pressure_is_clapeyrons(fluid):
    """dp_sat/dT = (s_v − s_l)/(v_v − v_l): the derivative of one table from the others and the equation."""
    kernels, entropy = saturation_kernels(fluid), entropy_kernel(fluid)
    for T in temperatures(fluid)[:-2]:
        rho_l, rho_v = kernels.liquid(T), kernels.vapour(T)
        clapeyron = (entropy(T, rho_v) - entropy(T, rho_l)) / (1.0 / rho_v - 1.0 / rho_l)
        assert kernels.pressure(T)[1] == pytest.approx(clapeyron, rel=1e-8)  # a differentiated fit of degree nine


@each_row("fluid", PURE)
def test_the_saturation_temperature_inverts_the_pressure(fluid):
    kernels = saturation_kernels(fluid)
    for T in temperatures(fluid):
        # one Newton step from a table good to 1e-6, and better far from the critical point
        assert kernels.temperature(kernels.pressure(T)[0]) == pytest.approx(T, rel=1e-10)


@each_row("fluid", PURE)
def test_the_phases_meet_at_the_critical_point(fluid):
    kernels, found = saturation_kernels(fluid), saturation(fluid)
    gaps = [kernels.liquid(T) / kernels.vapour(T) - 1.0 for T in temperatures(fluid)]
    assert all(np.diff(gaps) < 0.0) and gaps[-1] > 0.0
    assert kernels.liquid(found.T_c) == pytest.approx(found.rho_c, rel=1e-3)  # carbon dioxide: not analytic there
    assert kernels.liquid(found.T_c + 1.0) == kernels.vapour(found.T_c + 1.0)


@pytest.mark.parametrize("fluid", ["R410A", "R407C", "R404A", "Air"])
def test_a_pseudo_pure_fluid_condenses_at_coolprops_dew_line(fluid):
    CP = pytest.importorskip("CoolProp.CoolProp")
    gas, state = RealGas(fluid), CP.AbstractState("HEOS", fluid)
    for T in (x * gas.known.T_c for x in (0.65, 0.75, 0.85, 0.95)):
        state.update(CP.QT_INPUTS, 1.0, T)
        # 1e-6: tables through values of CoolProp, which finds the density from a fitted pressure by iteration
        assert gas.saturation_pressure(T) == pytest.approx(state.p(), rel=1e-6)
        assert saturation_kernels(fluid).vapour(T) == pytest.approx(state.rhomass(), rel=1e-6)
        margin, rho = margin_kernel(fluid), state.rhomass()
        assert margin(T, 0.99 * rho) > 0.0 > margin(T, 1.01 * rho)


# ---- the dome ---------------------------------------------------------------------------------------------------

DOME = [
    (fluid, T_r, x)
    for fluid in ("R134a", "Ammonia", "CarbonDioxide")
    for T_r in (0.75, 0.9, 0.99)
    for x in (0.02, 0.5, 0.97)
]


def wet(fluid, T_r, x):
    """Return T, ρ of a mixture with vapour share x by mass."""
    T, kernels = T_r * saturation(fluid).T_c, saturation_kernels(fluid)
    return T, 1.0 / (x / kernels.vapour(T) + (1.0 - x) / kernels.liquid(T))


@each_row(("fluid", "T_r", "x"), DOME)
def test_two_phases_are_their_masses_of_each(fluid, T_r, x):
    """u, h, s by the lever rule between the single phases' own values; p = p_sat."""
    gas, kernels, (T, rho) = RealGas(fluid, "equilibrium"), saturation_kernels(fluid), wet(fluid, T_r, x)
    state, entropy = state_kernel(fluid), entropy_kernel(fluid)
    v, liq = kernels.vapour(T), kernels.liquid(T)
    p, h, *_ = gas.state(T, rho)
    assert p == kernels.pressure(T)[0]
    # dp/dT and dg/dT of the fits are good to some 1e-10
    assert h == pytest.approx(x * state(T, v)[1] + (1 - x) * state(T, liq)[1], abs=1e-8 * gas.R * T)
    assert gas.specific_entropy(T, rho) == pytest.approx(
        x * entropy(T, v) + (1 - x) * entropy(T, liq), abs=1e-8 * gas.R
    )


@each_row(("fluid", "T_r", "x"), DOME)
def test_cv_of_two_phases_is_the_slope_of_inner_energy(fluid, T_r, x):
    gas, (T, rho) = RealGas(fluid, "equilibrium"), wet(fluid, T_r, x)
    slope = difference(lambda y: gas.state(y, rho)[1] - gas.state(y, rho)[0] / rho, T, 2e-5 * T)
    assert gas.state(T, rho)[2] == pytest.approx(slope, rel=1e-6)  # cancellation: 1e-15 h / 2e-5 T c_v


@each_row(("fluid", "T_r", "x"), DOME)
def test_cv_of_two_phases_is_that_of_the_phases(fluid, T_r, x):
    """−T g'' + v T p'' is the slope of the inner energy that the phases' own equation and densities give."""
    gas, kernels, (T, rho) = RealGas(fluid, "equilibrium"), saturation_kernels(fluid), wet(fluid, T_r, x)
    state = state_kernel(fluid)

    def inner(T):
        v, liq = kernels.vapour(T), kernels.liquid(T)
        share = (1.0 / rho - 1.0 / liq) / (1.0 / v - 1.0 / liq)
        u_v, u_l = (state(T, r)[1] - state(T, r)[0] / r for r in (v, liq))
        return share * u_v + (1.0 - share) * u_l

    assert gas.state(T, rho)[2] == pytest.approx(difference(inner, T, 1e-4 * T), rel=1e-6)  # second derivatives of fits


@each_row(("fluid", "T_r", "x"), DOME)
def test_sound_in_two_phases_is_the_isentropes_slope(fluid, T_r, x):
    """1/k = p/(ρ w²) with w² = (∂p/∂ρ)_s by differences along s = const."""
    gas, (T, rho) = RealGas(fluid, "equilibrium"), wet(fluid, T_r, x)
    s, (p, _, c_v, _, a, *_) = gas.specific_entropy(T, rho), gas.state(T, rho)

    def isentrope(r):
        at = T
        for _ in range(30):
            at += (s - gas.specific_entropy(at, r)) * at / c_v
        return gas.state(at, r)[0]

    assert a == pytest.approx(p / (rho * difference(isentrope, rho, 2e-4 * rho)), rel=1e-6)


@each_row("fluid", PURE)
def test_the_state_is_continuous_across_saturation(fluid):
    """p, h and s have one value on both sides of saturated vapour and liquid; c_v and k have two."""
    gas, kernels = RealGas(fluid, "equilibrium"), saturation_kernels(fluid)
    for T in temperatures(fluid)[1:-2]:
        for rho, outward in ((kernels.vapour(T), -1.0), (kernels.liquid(T), 1.0)):
            dry, damp = rho * (1.0 + 1e-12 * outward), rho * (1.0 - 1e-12 * outward)
            (p, h, c_v, _, a, *_), (p_2, h_2, c_v2, *_) = gas.state(T, dry), gas.state(T, damp)
            assert c_v != pytest.approx(c_v2, rel=1e-6)  # so they do lie on either side
            # a density good to 1e-11 moves p by that much of ρ p_ρ (liquids are stiff), and h by v of it
            stiff = p / a + gas.R * T * rho
            assert abs(p - p_2) < 1e-11 * stiff
            assert abs(h - h_2) < 1e-8 * gas.R * T
            assert abs(gas.specific_entropy(T, dry) - gas.specific_entropy(T, damp)) < 1e-8 * gas.R


@pytest.mark.parametrize("fluid", ["R134a", "CarbonDioxide"])
def test_outside_the_dome_both_variants_are_the_same_equation(fluid):
    single, both, found = RealGas(fluid).state, RealGas(fluid, "equilibrium").state, saturation(fluid)
    kernels = saturation_kernels(fluid)
    points = [(T, kernels.vapour(T) * (1.0 - 1e-6)) for T in temperatures(fluid)]
    points += [(T, kernels.liquid(T) * (1.0 + 1e-6)) for T in temperatures(fluid)]
    points += [(1.001 * found.T_c, found.rho_c), (found.T_low - 1.0, 1e-3)]
    assert all(single(T, rho) == both(T, rho) for T, rho in points)


@pytest.mark.parametrize("fluid", PURE)
def test_the_quick_table_never_misses_a_wet_state(fluid):
    inside, kernels, found = inside_kernel(fluid), saturation_kernels(fluid), saturation(fluid)
    for T in np.random.default_rng(0).uniform(found.T_low, found.T_c - 1e-4, 300):
        assert inside(T, kernels.vapour(T) * (1.0 + 1e-10)) and inside(T, kernels.liquid(T) * (1.0 - 1e-10))
        assert not inside(T, kernels.vapour(T) * (1.0 - 1e-10)) and not inside(T, kernels.liquid(T) * (1.0 + 1e-10))


@each_row(("fluid", "T_r", "x"), DOME)
def test_two_phases_are_coolprops(fluid, T_r, x):
    CP = pytest.importorskip("CoolProp.CoolProp")
    gas, (T, rho) = RealGas(fluid, "equilibrium"), wet(fluid, T_r, x)
    state = CP.AbstractState("HEOS", fluid)
    state.update(CP.DmassT_INPUTS, rho, T)
    p, h, *_ = gas.state(T, rho)
    assert p == pytest.approx(state.p(), rel=1e-7)  # CoolProp's own saturation solver
    assert h == pytest.approx(state.hmass(), abs=1e-6 * gas.R * T)
    assert gas.specific_entropy(T, rho) == pytest.approx(state.smass(), abs=1e-6 * gas.R)


def test_an_isenthalpic_state_in_the_dome_has_the_share_of_vapour_that_its_enthalpy_says():
    gas, kernels = RealGas("R134a", "equilibrium"), saturation_kernels("R134a")
    T, rho = wet("R134a", 0.85, 0.3)
    p, h, *_ = gas.state(T, rho)
    found = gas.port_state_of_enthalpy(p, h)
    assert found[1] == pytest.approx(rho, rel=1e-9) and found[2] == pytest.approx(h, rel=1e-12)
    assert gas.temperature(p, h) == pytest.approx(T, rel=1e-11)
    assert math.isclose(kernels.pressure(T)[0], p)


def test_saturated_vapour_has_the_transport_properties_of_vapour_next_to_it():
    """Pressure and temperature on the line of saturation leave the phase open; what flows in gaps there is vapour."""
    T = 263.15
    p = constants.dew_pressure("Ammonia", T)
    saturated, beside = (transport("Ammonia", p, T + warmer) for warmer in (0.0, 0.01))
    assert saturated == pytest.approx(beside, rel=1e-3)
