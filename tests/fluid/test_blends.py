"""Blends of fixed composition: their equation against CoolProp, their phases against teqp, and the laws of both."""

import contextlib
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from blend_references import DEPARTURES, R, coolprop, phases, reference, teqp_model

from screwsim.fluid import constants
from screwsim.fluid.blend_border import blend_border
from screwsim.fluid.composition import composition, own_blend, predefined
from screwsim.fluid.description import describe
from screwsim.fluid.dome import margin_kernel
from screwsim.fluid.fugacity import Fugacities
from screwsim.fluid.helmholtz import entropy_kernel, potentials_kernel, state_kernel
from screwsim.fluid.limits import Limit
from screwsim.fluid.mixture import departure_terms
from screwsim.fluid.real_gas import RealGas
from screwsim.fluid.saturation import saturation
from screwsim.fluid.transport import transport
from screwsim.inputs.faults import UsageError

OWN = own_blend(("R32", "R1234yf"), (0.689, 0.311), by_mole=False)
BLENDS = ("R454B", "R513A", "R448A", OWN)
HERE = Path(__file__).parent


def off(known):
    """Return by how much the weights of CoolProp's ideal parts miss 1: its s and p do not go together by that.

    Here ln ρ has the weight 1, and a closed chamber keeps its entropy.
    """
    parts = [describe(name) for name in known.components]
    weights = [x * one.R * one.molar_mass for x, one in zip(known.fractions, parts, strict=True)]
    return sum(weights) / (known.R * known.molar_mass) - 1.0


def differences(fluid, T, rho, state):
    """Return errors of p, c_v, T ∂p/∂T, w (relative), h over R T and s over R against CoolProp."""
    CP, known = coolprop(), describe(fluid)
    state.update(CP.DmassT_INPUTS, rho, T)
    p, h, c_v, tpt, a, *_ = state_kernel(fluid)(T, rho)
    relative = (
        p / state.p(),
        c_v / state.cvmass(),
        tpt / (T * state.first_partial_deriv(CP.iP, CP.iT, CP.iDmass)),
        math.sqrt(p / (rho * a)) / state.speed_sound(),
    )
    s = entropy_kernel(fluid)(T, rho) - known.R * off(known) * math.log(rho / known.rho_r)
    return [*(x - 1.0 for x in relative), (h - state.hmass()) / (known.R * T), (s - state.smass()) / known.R]


# ---- the equation ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fluid", BLENDS)
def test_the_state_is_coolprops(fluid):
    """Over 0.5-40 bar from the dew point to 150 °C, at the same T and ρ."""
    gas, state = RealGas(fluid), reference(fluid)
    state.specify_phase(coolprop().iphase_gas)
    for p in (0.5e5, 2e5, 10e5, 25e5, 40e5):
        T_dew = gas.saturation_temperature(p)
        first = 1.02 * saturation(fluid).T_c if T_dew is None else T_dew + 0.1
        for T in np.linspace(first, 423.15, 4):
            # some hundred terms of either sign are summed; asked for is 1e-7
            assert np.max(np.abs(differences(fluid, T, gas.density(p, T), state))) < 1e-12


def pair_with(function):
    """Return two fluids whose departure function that is."""
    CP = coolprop()
    for each in CP.get_global_param_string("mixture_binary_pairs_list").split(","):
        first, second = each.split("&")
        with contextlib.suppress(ValueError):  # a pair without a function
            if CP.get_mixture_binary_pair_data(first, second, "function") != function:
                continue
            return [CP.get_mixture_binary_pair_data(first, second, name) for name in ("name1", "name2")]
    raise AssertionError(f"no pair has the function {function}")


@pytest.mark.parametrize("function", sorted(DEPARTURES))
def test_every_departure_function_is_coolprops(function):
    """The stored terms: what CoolProp itself sums them up to, in the gas and in the liquid's densities."""
    fluid = own_blend(pair_with(function), (0.4, 0.6), by_mole=True)
    known, state = describe(fluid), reference(fluid)
    assert departure_terms(function)
    state.specify_phase(coolprop().iphase_gas)
    for tau, delta in ((0.8, 0.3), (0.6, 1.5), (1.1, 0.05)):
        T, rho = known.T_r / tau, delta * known.rho_r
        state.update(coolprop().DmassT_INPUTS, rho, T)
        z = potentials_kernel(fluid)(T, rho)[0] / (rho * known.R * T)
        assert z - 1.0 == pytest.approx(delta * state.dalphar_dDelta(), rel=1e-11, abs=1e-13)


def test_a_blend_of_almost_one_component_is_that_component():
    mixed = own_blend(("R134a", "R1234yf"), (1.0 - 1e-7, 1e-7), by_mole=True)
    found, pure = (state_kernel(fluid)(330.0, 20.0) for fluid in (mixed, "R134a"))
    # 1e-7 of the other, and 1e-6 between the gas constants of R134a's equation and of mixtures; c_v: CoolProp reduces
    # R134a's ideal part by 374.21 K in blends, by 374.18 K alone
    assert (found[0], found[3]) == pytest.approx((pure[0], pure[3]), rel=2e-6)
    assert found[2] == pytest.approx(pure[2], rel=1e-4)


@pytest.mark.parametrize("fluid", BLENDS)
def test_entropy_and_pressure_come_from_one_potential(fluid):
    """ρ² ∂s/∂ρ|T = −∂p/∂T|ρ; CoolProp's s misses it by 1e-6."""
    T, rho, step = 320.0, 20.0, 1e-3
    s = [entropy_kernel(fluid)(T, rho * (1.0 + k * step)) for k in (-2, -1, 1, 2)]
    slope = (s[0] - 8.0 * s[1] + 8.0 * s[2] - s[3]) / (12.0 * rho * step)
    assert -(rho**2) * slope == pytest.approx(state_kernel(fluid)(T, rho)[3] / T, rel=1e-9)
    assert 1e-8 < abs(off(describe(fluid))) < 2e-6


def test_mass_and_mole_fractions_name_one_blend():
    x = describe(OWN).fractions
    other = own_blend(("R32", "R1234yf"), x, by_mole=True)
    assert describe(other).fractions == pytest.approx(x, rel=1e-14)
    assert state_kernel(other)(300.0, 10.0) == pytest.approx(state_kernel(OWN)(300.0, 10.0), rel=1e-13)
    assert describe("R454B").fractions == pytest.approx(x, rel=1e-4)  # 68.9 and 31.1 % by mass, both


def test_a_blend_goes_by_its_short_name_where_no_pure_fluid_has_it():
    assert {"R454B", "R513A", "R407C.mix", "Air.mix"} <= set(predefined()) and "R407C" not in predefined()
    assert composition("R454B.mix") == composition("R454B") and composition("R407C") is None
    assert describe("R407C").pseudo_pure and describe("R407C.mix").blend


def test_a_blend_without_data_is_refused_with_its_pair():
    with pytest.raises(UsageError, match=r"^gas\.fluid: R401A: CoolProp has no data of the pair R124 and R22; choose"):
        describe("R401A")
    assert constants.limits("R401A") is None


# ---- phases ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fluid", ["R454B", "R455A"])
def test_phases_have_teqps_pressure_and_fugacities(fluid):
    model = teqp_model(fluid)
    for T in (240.0, 318.15):
        for side in (-1, 1):
            both = phases(fluid, T, side)
            p = [x.sum() * R * T * (1.0 + model.get_Ar01(T, x.sum(), x / x.sum())) for x in both]
            share = [np.array(model.get_fugacity_coefficients(T, x)) * x / x.sum() for x in both]
            assert p[0] == pytest.approx(p[1], rel=1e-9)  # the liquid's pressure amplifies its density's rounding
            assert share[0] * p[0] == pytest.approx(share[1] * p[1], rel=1e-9)
            of_tables = (constants.dew_pressure if side < 0 else constants.bubble_pressure)(fluid, T)
            assert of_tables == pytest.approx(p[1], rel=1e-9)


def test_dew_and_bubble_of_every_blend_are_teqps():
    """As tests/tools/blends_against_teqp.py found, of each that docs/reference lists."""
    found = json.loads((HERE / "blends_teqp.json").read_text(encoding="utf-8"))
    page = (HERE.parents[1] / "docs" / "reference" / "blends.md").read_text(encoding="utf-8")
    rows = [line for line in page.splitlines() if line.startswith("| ") and "gas from" not in line]  # no lines (M317)
    assert set(found) == {row.split(" | ")[0][2:] for row in rows} - {"blend"}
    for name, differences in found.items():
        assert max(differences.values()) < (1e-6 if name == "Ekofisk" else 1e-9), name  # cold natural gas: 2e-7


def test_teqp_finds_the_same_phases():
    model = teqp_model("R454B")
    for T in (240.0, 318.15):
        for side in (-1, 1):
            liquid, vapour = phases("R454B", T, side)
            found = model.mix_VLE_Tx(T, 1.005 * liquid, 0.99 * vapour, liquid / liquid.sum(), *[1e-14] * 4, 50)
            assert found[1] == pytest.approx(liquid, rel=1e-9)
            assert found[2] == pytest.approx(vapour, rel=1e-9)


@pytest.mark.parametrize("fluid", ["R513A", "R422D"])  # an azeotrope; one with other solutions of the equations
def test_dew_and_bubble_are_those_that_coolprop_finds(fluid):
    state, CP = reference(fluid), coolprop()
    for T in (240.0, 290.0, 320.0):
        for quality, pressure in ((1.0, constants.dew_pressure), (0.0, constants.bubble_pressure)):
            state.update(CP.QT_INPUTS, quality, T)
            assert pressure(fluid, T) == pytest.approx(state.p(), rel=1e-8)  # CoolProp's own iteration


def test_temperatures_of_both_lines_invert_the_pressures():
    for fluid in ("R454B", "R448A"):
        mixed = blend_border(fluid)
        for T in (230.0, 275.15, 318.15, 340.0):
            assert mixed.dew_temperature(mixed.dew_pressure(T)) == pytest.approx(T, rel=1e-12)
            assert mixed.bubble_temperature(mixed.bubble_pressure(T)) == pytest.approx(T, rel=1e-12)
            assert mixed.bubble_temperature(mixed.dew_pressure(T)) < T  # the glide
            assert RealGas(fluid).saturation_temperature(mixed.dew_pressure(T)) == pytest.approx(T, rel=1e-10)


def test_the_envelope_is_one_curve():
    """Around the highest temperature, over the critical point: no step between what is solved and interpolated."""
    found = saturation("R448A")
    theta = np.linspace(-0.3, 0.3, 601)
    for table in (found.log_rho, found.log_p_of_theta):
        second = np.diff(table(theta), 3)
        assert np.max(np.abs(second)) < 5e-5  # spacing 1e-3: the third derivative times 1e-9, rounding far below
    assert found.log_p_of_theta(np.array([0.0]))[0] == pytest.approx(math.log(found.p_c), rel=1e-6)


def test_fugacities_are_coolprops():
    for fluid in ("R448A", "R455A"):
        known, state = describe(fluid), reference(fluid)
        f = Fugacities(known)
        x = np.linspace(1.0, 2.0, f.n) / np.linspace(1.0, 2.0, f.n).sum()
        state.set_mole_fractions(list(x))
        state.specify_phase(coolprop().iphase_gas)
        state.update(coolprop().DmolarT_INPUTS, 800.0, 320.0)
        log_f, p = f(320.0, 800.0, x)
        assert p * R * 320.0 == pytest.approx(state.p(), rel=1e-12)
        assert np.exp(log_f) * R * 320.0 == pytest.approx([state.fugacity(i) for i in range(f.n)], rel=1e-12)
        (T_r, _), (v_r, _) = f.reducing(f.z)
        assert (T_r, 1.0 / v_r) == pytest.approx((known.T_r, known.rho_r / known.molar_mass), rel=1e-13)


# ---- the border --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fluid", ["R454B", "R448A"])
def test_enthalpies_at_the_border_are_coolprops(fluid):
    CP, state, known = coolprop(), reference(fluid), describe(fluid)
    for phase, enthalpy, p in (
        (CP.iphase_gas, constants.vapour_enthalpy, 4e5),
        (CP.iphase_liquid, constants.liquid_enthalpy, 26e5),
    ):
        state.specify_phase(phase)
        state.update(CP.PT_INPUTS, p, 300.0)
        assert abs(enthalpy(fluid, p, 300.0) - state.hmass()) < 1e-9 * known.R * 300.0
    state.specify_phase(CP.iphase_gas)
    state.update(CP.DmassT_INPUTS, 1e-6, 300.0)
    assert constants.ideal_heat_capacity(fluid, 300.0) == pytest.approx(state.cp0mass(), rel=1e-12)
    assert constants.gas_constant(fluid) == pytest.approx(state.gas_constant() / state.molar_mass(), rel=1e-14)


def test_a_blend_has_limits_as_a_pure_fluid():
    gas = RealGas("R454B")
    saturated = gas._kernels["saturated_vapour"](300.0)
    margin = margin_kernel(gas.fluid)
    assert margin(300.0, saturated * (1 - 1e-9)) > 0.0 > margin(300.0, saturated * (1 + 1e-9))
    assert gas.why_outside(300.0, 1.1 * saturated).limit is Limit.WET
    assert gas.why_outside(420.0, 5.0).limit is Limit.HOT  # 410 K: R1234yf's
    with pytest.raises(UsageError, match=r"R454B at 20 bar, 26\.85 degC is liquid, or wet: it condenses below 35\.5"):
        gas.density(20e5, 300.0)


def test_a_blends_liquid_is_one_of_its_own():
    h = constants.liquid_enthalpy("R454B", 25e5, 305.0)
    liquid = RealGas("R454B").liquid(25e5, h)
    assert (liquid.p, liquid.T, liquid.h) == pytest.approx((25e5, 305.0, h), rel=1e-9)
    with pytest.raises(UsageError, match="is not a liquid"):
        RealGas("R454B").liquid(25e5, h + 60e3)


def test_a_second_process_never_imports_coolprop():
    constants.vapour_enthalpy("R454B", 5e5, 300.0)
    code = (
        "import sys; from screwsim.fluid import constants; from screwsim.fluid.real_gas import RealGas;"
        "constants.condensed('R454B', 318.15); RealGas('R454B').isentropic_work(5e5, 15e5, 300.0);"
        "assert not any(m.startswith('CoolProp') for m in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_what_no_blend_has_is_refused():
    for what, call in (
        ("no viscosity of R13I1, a component of R466A", lambda: transport("R466A", 5e5, 300.0)),
        ("has no saturation at 126.85 degC", lambda: constants.dew_pressure("R454B", 400.0)),
        ("has no saturation at 90 bar", lambda: constants.saturation_temperature("R454B", 9e6)),
    ):
        with pytest.raises(UsageError, match=what):
            call()
