"""Blends in two phases in equilibrium: flashes against teqp and CoolProp, the table against flashes, its laws."""

import math

import numpy as np
import pytest
from blend_references import R, coolprop, reference, teqp_model

from screwsim.fluid import constants
from screwsim.fluid.blend_dome import blend_equilibrium_kernels, blend_wet, surface_kernel
from screwsim.fluid.blend_flash import Flashes, dome, references
from screwsim.fluid.composition import own_blend
from screwsim.fluid.description import describe
from screwsim.fluid.dome import equilibrium_kernels
from screwsim.fluid.helmholtz import entropy_kernel, state_kernel
from screwsim.fluid.phase_envelope import _followed
from screwsim.fluid.real_gas import RealGas

FLUID = "R454B"


@pytest.fixture(scope="module")
def flashes():
    return Flashes(describe(FLUID))


@pytest.fixture(scope="module")
def states(flashes):
    """Return random T [K] and v [m³/kg] in the whole of the table, from bubble to dew point."""
    random, edges = np.random.default_rng(5), dome(FLUID).edges
    T = random.uniform(edges[0] + 1.0, edges[-1] - 1.0, 120)
    liquid, vapour = flashes.borders(T)[2] / flashes.known.molar_mass
    return T, liquid + random.uniform(0.02, 0.98, T.size) * (vapour - liquid)


def direct(flashes, T, v):
    """Return f [J/kg] and p [Pa] of flashes."""
    known, found = flashes.known, flashes(T, v * flashes.known.molar_mass)
    own = references(known, flashes.f, T, 1.0 / flashes.borders(T)[2][1])
    return (found.f + own) / known.molar_mass, found.p


def test_flashes_have_teqps_pressure_and_fugacities(flashes, states):
    model = teqp_model(FLUID)
    T, v = (one[:12] for one in states)
    found = flashes(T, v * flashes.known.molar_mass)
    for i, temperature in enumerate(T):
        parts = [x[:, i] * rho for x, rho in zip((found.liquid, found.vapour), found.densities[:, i], strict=True)]
        p = [x.sum() * R * temperature * (1.0 + model.get_Ar01(temperature, x.sum(), x / x.sum())) for x in parts]
        each = [
            np.array(model.get_fugacity_coefficients(temperature, x)) * x / x.sum() * pressure
            for x, pressure in zip(parts, p, strict=True)
        ]
        assert p[1] == pytest.approx(found.p[i], rel=1e-9)
        assert p[0] == pytest.approx(p[1], rel=1e-7)  # the liquid's pressure amplifies its density's rounding
        assert each[0] == pytest.approx(each[1], rel=1e-7)
        share = found.beta[i]
        assert share * found.vapour[:, i] + (1.0 - share) * found.liquid[:, i] == pytest.approx(flashes.f.z, rel=1e-9)
        volumes = 1.0 / found.densities[:, i]
        assert share * volumes[1] + (1.0 - share) * volumes[0] == pytest.approx(v[i] * flashes.known.molar_mass)


def test_the_table_is_what_flashes_find(flashes, states):
    """The errors that docs/reference/blend-domes.md states; of s and c_v by differences of flashes."""
    T, v = states
    step, known = 0.05, flashes.known
    f, p = np.array([direct(flashes, T + k * step, v) for k in range(-2, 3)]).transpose(1, 0, 2)
    table = np.array([surface_kernel(FLUID)(*state) for state in zip(T, v, strict=True)]).T
    s = -np.array([1, -8, 0, 8, -1]) @ f / (12.0 * step)
    f_TT = np.array([-1, 16, -30, 16, -1]) @ f / (12.0 * step**2)
    assert -table[2] == pytest.approx(p[2], rel=1e-7)
    assert -table[1] == pytest.approx(s, abs=1e-6 * known.R)
    assert table[3] == pytest.approx(f_TT, rel=1e-5)


def test_all_follows_from_one_potential(states):
    """Maxwell's relations, du = T ds − p dv and the isentrope's slope, by differences of the kernels themselves."""
    kernels = blend_equilibrium_kernels(FLUID)
    state, entropy = kernels["state"], kernels["specific_entropy"]
    for T, v in zip(*(one[::10] for one in states), strict=True):
        p, _h, c_v, tpt, a, *_ = state(T, 1.0 / v)

        def slope(function, T=T, v=v, by_T=True, of=1e-4):
            at = [(T * (1 + k * of), v) if by_T else (T, v * (1 + k * of)) for k in (-2, -1, 1, 2)]
            values = [function(x, 1.0 / y) for x, y in at]
            return (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * of * (T if by_T else v))

        def energy(T, rho):
            p, h, *_ = state(T, rho)
            return h - p / rho

        assert slope(energy) == pytest.approx(c_v, rel=1e-5)
        assert T * slope(entropy) == pytest.approx(c_v, rel=1e-5)
        assert T * slope(entropy, by_T=False) == pytest.approx(tpt, rel=1e-5)
        assert slope(energy, by_T=False) == pytest.approx(tpt - p, rel=1e-4, abs=1e-4 * p)
        p_v = slope(lambda T, rho: state(T, rho)[0], by_T=False)
        assert 1.0 / a == pytest.approx(v / p * (tpt**2 / (T * c_v) - p_v), rel=1e-4)


def test_the_table_meets_the_equation_at_both_borders(flashes):
    known, edges = flashes.known, dome(FLUID).edges
    T = np.linspace(edges[0], edges[-1] - 1e-6, 40)
    for side in (0, 1):
        for temperature, v in zip(T, flashes.borders(T)[2][side] / known.molar_mass, strict=True):
            f, f_T, f_v, *_ = surface_kernel(FLUID)(temperature, v)
            p, h, *_ = state_kernel(FLUID)(temperature, 1.0 / v)
            if side == 1:  # the equation's pressure of cold liquid has few digits
                assert -f_v == pytest.approx(p, rel=3e-7)
            assert -f_T == pytest.approx(entropy_kernel(FLUID)(temperature, 1.0 / v), abs=3e-6 * known.R)
            assert f - temperature * f_T - v * f_v == pytest.approx(h, abs=3e-6 * known.R * temperature)


def test_two_phases_of_a_near_azeotrope_are_coolprops():
    """R513A, whose mixture flashes converge there: p, h, s and density by T and vapour's share of mass."""
    CP, state, known = coolprop(), reference("R513A"), describe("R513A")
    gas = RealGas("R513A", "equilibrium")
    for T in (250.0, 310.0):
        for quality in (0.3, 0.8):
            state.update(CP.QT_INPUTS, quality, T)  # by moles
            M_v = sum(
                x * describe(name).molar_mass
                for x, name in zip(state.mole_fractions_vapor(), known.components, strict=True)
            )
            share = quality * M_v / known.molar_mass
            found = constants.wet_temperature("R513A", state.p(), share)
            h = constants.wet_enthalpy("R513A", state.p(), share)
            assert found == pytest.approx(T, abs=1e-6)
            assert h == pytest.approx(state.hmass(), abs=1e-6 * known.R * T)
            assert gas.port_state_of_enthalpy(state.p(), h)[1] == pytest.approx(state.rhomass(), rel=1e-6)


@pytest.mark.parametrize("fluid", ["R454B.mix", "R449A.mix"])
def test_wet_gas_of_no_and_of_all_vapour_lies_on_bubble_and_dew_line(fluid):
    """At any pressure: there the quality of a flash is rounding."""
    wet = blend_wet(fluid)
    for p in np.random.default_rng(1).uniform(1.5e5, 15e5, 40):
        for quality, side in ((0.0, 1e-7), (1.0, -1e-7)):
            found, near = wet.of_quality(p, quality), wet.of_quality(p, quality + side)
            assert found[0] == pytest.approx(near[0], abs=1e-4)
            assert found[1] == pytest.approx(near[1], rel=1e-3 if quality else 0.02)


def test_a_blend_of_almost_one_component_condenses_as_that():
    """1e-4 of R1234yf in R134a: p, c_v, T ∂p/∂T, 1/k of both phases are those of R134a, to what 1e-4 does to them."""
    mixed = own_blend(("R134a", "R1234yf"), (1.0 - 1e-4, 1e-4), by_mole=True)
    found, pure = (
        kernels["state"](290.0, 60.0) for kernels in (blend_equilibrium_kernels(mixed), equilibrium_kernels("R134a"))
    )
    assert (found[0], found[2], found[3], found[4]) == pytest.approx((pure[0], pure[2], pure[3], pure[4]), rel=1e-3)


def test_enthalpy_and_entropy_at_a_pressure_find_their_state():
    gas = RealGas(FLUID, "equilibrium")
    for T, rho in ((250.0, 30.0), (320.0, 400.0)):
        p, h, *_ = gas.state(T, rho)
        assert gas._at(p, h, False) == pytest.approx((T, rho), rel=1e-10)
        assert gas._at(p, gas.specific_entropy(T, rho), True) == pytest.approx((T, rho), rel=1e-10)
        assert gas.isentrope(p, gas.specific_entropy(T, rho))[2] == pytest.approx(h, rel=1e-9)
        assert gas.phased_state[0](T, rho) == 1 and gas.why_outside(T, rho) is None
    assert "followed from" in gas.why_outside(350.5, 350.0).what
    beyond = gas.first_outside(np.array([320.0, 350.5, 300.0]), np.array([400.0, 350.0, 900.0]))
    assert beyond == 1 and not math.isnan(gas.state(350.5, 350.0)[0])


def test_an_envelope_is_the_same_to_the_last_bit_whenever_it_is_found():
    """Found from scratch twice: random numbers of the process, as an interpolation may draw them, change nothing."""
    known = describe("R454B")
    found = [(one.T_m, one.log_z_m, one.columns.c.tobytes()) for one in (_followed(known), _followed(known))]
    assert found[0] == found[1]
