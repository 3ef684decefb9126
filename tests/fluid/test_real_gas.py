"""Real gases: the compiled equation against CoolProp's own evaluation of it, and the laws that tie its results."""

import math
import subprocess
import sys

import numpy as np
import pytest
from differences import difference
from each_row import each_row

from screwsim.fluid import description, terms
from screwsim.fluid.dome import margin_kernel
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.limits import Limit
from screwsim.fluid.real_gas import RealGas
from screwsim.fluid.saturation import saturation
from screwsim.inputs.faults import QuantityNotFound, UsageError
from screwsim.numerics.kernel import Kernel

FLUIDS = ("R134a", "R1234yf", "R1234ze(E)", "R32", "Ammonia", "CarbonDioxide", "n-Propane", "Nitrogen", "Air")
MORE = ("Hydrogen", "Helium", "R22", "R410A", "Water", "R125", "Methanol", "n-Heptane", "IsoButane", "Oxygen")
BAR = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 40.0)
HOTTEST = 423.15
ROUNDING = 1e-12  # some tens of terms of either sign are summed


def coolprop():
    return pytest.importorskip("CoolProp.CoolProp")


def grid(fluid):
    """Return (T, ρ) over 0.5–40 bar from saturation (0.1 K above) or 1.02 T_c to 150 °C, densities from CoolProp."""
    CP = coolprop()
    state, known, sat = CP.AbstractState("HEOS", fluid), description.describe(fluid), saturation(fluid)
    found = []
    for p in (1e5 * bar for bar in BAR):
        first = 1.02 * sat.T_c
        if p < 0.9 * sat.p_c and p > float(np.exp(sat.log_p(np.array([sat.T_low]))[0])):
            state.update(CP.PQ_INPUTS, p, 1.0)
            first = state.T() + 0.1
        for T in np.linspace(first, max(min(HOTTEST, known.T_max), 1.1 * first), 6):
            state.update(CP.PT_INPUTS, p, T)
            found.append((float(T), state.rhomass()))
    return state, found


@pytest.mark.parametrize("fluid", FLUIDS + MORE)
def test_the_state_is_coolprops(fluid):
    """p, c_v, T ∂p/∂T, w relative, h over R T, s over R, at the same T and ρ: no iteration of the reference enters."""
    CP = coolprop()
    gas = RealGas(fluid)
    reference, points = grid(fluid)
    for T, rho in points:
        reference.update(CP.DmassT_INPUTS, rho, T)
        p, h, c_v, tpt, a, _, _ = gas.state(T, rho)
        assert p == pytest.approx(reference.p(), rel=1e-11)
        assert c_v == pytest.approx(reference.cvmass(), rel=1e-11)
        assert tpt == pytest.approx(T * reference.first_partial_deriv(CP.iP, CP.iT, CP.iDmass), rel=1e-11)
        assert math.sqrt(p / (rho * a)) == pytest.approx(reference.speed_sound(), rel=1e-11)
        # 1e-10: CoolProp's own offsets of h and s are that coarse for carbon dioxide and water
        assert abs(h - reference.hmass()) < 1e-10 * gas.R * T
        assert abs(gas.specific_entropy(T, rho) - reference.smass()) < 1e-10 * gas.R


@pytest.mark.parametrize("fluid", ["R134a", "CarbonDioxide"])
def test_density_at_a_pressure_is_coolprops(fluid):
    CP = coolprop()
    gas = RealGas(fluid)
    reference, points = grid(fluid)
    for T, rho in points:
        reference.update(CP.DmassT_INPUTS, rho, T)
        # 1e-9: CoolProp found ρ(p, T) by an iteration of its own
        assert gas.density(reference.p(), T) == pytest.approx(rho, rel=1e-9)


def test_every_pure_fluid_of_coolprop_is_understood():
    names = coolprop().get_global_param_string("FluidsList").split(",")
    for name in names:
        known = description.describe(name)
        assert terms.residual_terms(known) and terms.ideal_terms(known)


# ---- laws -------------------------------------------------------------------------------------------------------

STATES = [(0.8, 0.02), (0.95, 0.1), (1.05, 0.4), (1.05, 1.5), (1.2, 0.8)]  # T/T_c, ρ/ρ_c


def reduced(fluid, T_r, rho_r):
    known = description.describe(fluid)
    return T_r * known.T_c, rho_r * known.rho_c


SOME = ("R134a", "Ammonia", "CarbonDioxide", "Nitrogen", "Air", "R125")  # every kind of term
DIFFERENCE = 1e-8  # fourth-order differences with steps of 1e-3: (1e-3)⁴ times a factor of the equation's curvature


@each_row("fluid", SOME)
@each_row(("T_r", "rho_r"), STATES)
def test_cv_is_the_slope_of_inner_energy(fluid, T_r, rho_r):
    gas, (T, rho) = RealGas(fluid), reduced(fluid, T_r, rho_r)
    slope = difference(lambda x: gas.state(x, rho)[1] - gas.state(x, rho)[0] / rho, T, 1e-3 * T)
    assert gas.state(T, rho)[2] == pytest.approx(slope, rel=30 * DIFFERENCE)  # non-analytic terms vary within 1e-2


@each_row("fluid", SOME)
@each_row(("T_r", "rho_r"), STATES)
def test_T_dp_dT_is_the_slope_of_pressure(fluid, T_r, rho_r):
    gas, (T, rho) = RealGas(fluid), reduced(fluid, T_r, rho_r)
    slope = difference(lambda x: gas.state(x, rho)[0], T, 1e-3 * T)
    assert gas.state(T, rho)[3] == pytest.approx(T * slope, rel=30 * DIFFERENCE)


@each_row("fluid", SOME)
@each_row(("T_r", "rho_r"), STATES)
def test_inner_energy_and_pressure_come_from_one_potential(fluid, T_r, rho_r):
    """(∂u/∂ρ)_T = (p − T p_T)/ρ²."""
    gas, (T, rho) = RealGas(fluid), reduced(fluid, T_r, rho_r)
    slope = difference(lambda x: gas.state(T, x)[1] - gas.state(T, x)[0] / x, rho, 1e-3 * rho)
    p, _, _, tpt, *_ = gas.state(T, rho)
    assert slope == pytest.approx((p - tpt) / rho**2, rel=30 * DIFFERENCE, abs=1e-11 * gas.R * T / (1e-3 * rho))


@each_row("fluid", SOME)
@each_row(("T_r", "rho_r"), STATES)
def test_entropy_has_the_slopes_of_the_second_law(fluid, T_r, rho_r):
    """T (∂s/∂T)_ρ = c_v and ρ² (∂s/∂ρ)_T = −p_T."""
    gas, (T, rho) = RealGas(fluid), reduced(fluid, T_r, rho_r)
    _, _, c_v, tpt, *_ = gas.state(T, rho)
    by_T = difference(lambda x: gas.specific_entropy(x, rho), T, 1e-3 * T)
    by_rho = difference(lambda x: gas.specific_entropy(T, x), rho, 1e-3 * rho)
    assert T * by_T == pytest.approx(c_v, rel=30 * DIFFERENCE)
    assert -(rho**2) * by_rho == pytest.approx(tpt / T, rel=30 * DIFFERENCE)


@each_row("fluid", SOME)
@each_row(("T_r", "rho_r"), STATES)
def test_sound_is_the_isentropes_slope(fluid, T_r, rho_r):
    """1/k = p/(ρ w²), w² = (∂p/∂ρ)_s = p_ρ + T p_T²/(ρ² c_v), with p_ρ by differences."""
    gas, (T, rho) = RealGas(fluid), reduced(fluid, T_r, rho_r)
    p, _, c_v, tpt, a, *_ = gas.state(T, rho)
    slope = difference(lambda x: gas.state(T, x)[0], rho, 1e-3 * rho)
    assert p / (a * rho) == pytest.approx(slope + tpt**2 / (T * rho**2 * c_v), rel=30 * DIFFERENCE)


@pytest.mark.parametrize("fluid", ["R134a", "Ammonia", "Nitrogen"])
def test_cp_minus_cv_is_T_pT_squared_over_rho_squared_p_rho(fluid):
    gas, (T, rho) = RealGas(fluid), reduced(fluid, 1.1, 0.3)
    p, _, c_v, tpt, a, *_ = gas.state(T, rho)
    p_rho = p / (a * rho) - tpt**2 / (T * rho**2 * c_v)
    c_p = difference(lambda x: gas.enthalpy(p, x), T, 1e-3 * T)
    assert c_p - c_v == pytest.approx(tpt**2 / (T * rho**2 * p_rho), rel=1e-7)  # difference of two found densities


@each_row("fluid", FLUIDS)
def test_a_dilute_gas_is_ideal_to_first_order_in_density(fluid):
    """Z − 1, h − h⁰, c_v − c_v⁰ and k − c_p⁰/c_v⁰ vanish with ρ: ten times less gas, ten times less deviation."""
    gas, (T, rho_c) = RealGas(fluid), reduced(fluid, 0.9, 1.0)

    def at(rho):
        p, h, c_v, tpt, a, *_ = gas.state(T, rho)
        return np.array([p / (rho * gas.R * T), tpt / p, h / (gas.R * T), c_v / gas.R, 1.0 / a])

    ideal = at(1e-12 * rho_c)
    assert ideal[:2] == pytest.approx([1.0, 1.0], abs=1e-11)
    assert ideal[4] == pytest.approx((ideal[3] + 1.0) / ideal[3], abs=1e-11)
    near, far = at(1e-5 * rho_c) - ideal, at(1e-4 * rho_c) - ideal
    assert far / near == pytest.approx(np.full(5, 10.0), rel=2e-3)  # the next order is of size 1e-4 times a few


def test_the_order_of_approach_to_the_ideal_gas_is_one():
    gas, (T, rho_c) = RealGas("R134a"), reduced("R134a", 0.9, 1.0)
    x = np.geomspace(1e-6, 1e-3, 7)
    deviation = [abs(gas.state(T, rho_c * xi)[0] / (rho_c * xi * gas.R * T) - 1.0) for xi in x]
    order = np.polyfit(np.log(x), np.log(deviation), 1)[0]
    assert order == pytest.approx(1.0, abs=1e-3)


# ---- the border -------------------------------------------------------------------------------------------------

R134A, MARGIN = RealGas("R134a"), margin_kernel("R134a")


def test_the_kernels_take_temperature_and_density_alone():
    assert R134A.state.arguments == R134A.specific_entropy.arguments == MARGIN.arguments == ("T", "rho")
    assert R134A.values == {}


def test_kernels_of_one_fluid_are_one_whatever_its_alias():
    assert RealGas("R290").state is RealGas("n-Propane").state
    assert RealGas("R717").state.flat_name == RealGas("Ammonia").state.flat_name


def test_every_gas_has_its_own_kernel_names():
    names = {RealGas(fluid).state.flat_name for fluid in FLUIDS}
    assert len(names) == len(FLUIDS)


def test_both_gases_have_one_interface():
    missing = {name for name in dir(R134A) if not name.startswith("_")} - set(dir(IdealGas(81.49, 1.12)))
    allowed = {"fluid", "two_phase", "known", "follows", "why_outside", "isentrope"}
    boils = {"liquid", "equilibrium", "saturation_pressure", "saturation_temperature", "at_critical_point"}
    assert missing <= allowed | boils  # what only a gas that can boil has


@pytest.mark.parametrize(("p", "T"), [(2e5, 275.0), (12e5, 330.0), (39e5, 380.0), (45e5, 400.0)])
def test_a_plenum_and_a_chamber_of_one_state_are_one_port_state(p, T):
    port_state = R134A.port_state(p, T)
    found = R134A.state(T, port_state[1])
    assert (found[0], found[1], *found[4:]) == pytest.approx((p, *port_state[2:]), rel=1e-12)


@pytest.mark.parametrize(("p", "T"), [(2e5, 275.0), (12e5, 330.0), (39e5, 380.0), (45e5, 400.0)])
def test_temperature_inverts_the_enthalpy(p, T):
    assert R134A.temperature(p, R134A.enthalpy(p, T)) == pytest.approx(T, rel=1e-12)
    assert R134A.port_state_of_enthalpy(p, R134A.enthalpy(p, T)) == pytest.approx(R134A.port_state(p, T), rel=1e-10)


@pytest.mark.parametrize("fluid", ["R134a", "CarbonDioxide"])
def test_isentropic_work_is_coolprops(fluid):
    CP = coolprop()
    gas, p_1 = RealGas(fluid), {"R134a": 2e5, "CarbonDioxide": 25e5}[fluid]
    T_1 = gas.saturation_temperature(p_1) + 10.0
    state = CP.AbstractState("HEOS", fluid)
    state.update(CP.PT_INPUTS, p_1, T_1)
    h_1, s = state.hmass(), state.smass()
    for ratio in (1.5, 3.0, 4.5):
        state.update(CP.PSmass_INPUTS, ratio * p_1, s)
        # 1e-8: CoolProp's own iterations
        assert gas.isentropic_work(p_1, ratio * p_1, T_1) == pytest.approx(state.hmass() - h_1, rel=1e-8)


def test_isentropic_work_into_the_dome_is_that_of_equilibrium():
    """An expansion of saturated vapour ends wet."""
    CP = coolprop()
    state = CP.AbstractState("HEOS", "Ammonia")
    gas, p_1, p_2 = RealGas("Ammonia"), 12e5, 3e5
    T_1 = gas.saturation_temperature(p_1) + 2.0
    state.update(CP.PT_INPUTS, p_1, T_1)
    h_1 = state.hmass()
    state.update(CP.PSmass_INPUTS, p_2, state.smass())
    assert 0.0 < state.Q() < 1.0
    assert gas.isentropic_work(p_1, p_2, T_1) == pytest.approx(state.hmass() - h_1, rel=1e-8)


def test_isothermal_work_is_the_integral_of_dp_over_rho():
    p, T = np.polynomial.legendre.leggauss(20), 300.0
    x = 0.5 * math.log(2.0) * (p[0] + 1.0)
    dp_over_rho = [1e5 * math.exp(xi) / R134A.density(1e5 * math.exp(xi), T) for xi in x]
    integral = 0.5 * math.log(2.0) * float(np.dot(p[1], dp_over_rho))
    assert R134A.isothermal_work(1e5, 2e5, T) == pytest.approx(integral, rel=1e-11)  # 20 points of a smooth function


def test_isothermal_work_tends_to_the_ideal_gas():
    found, ideal = R134A.isothermal_work(10.0, 80.0, 300.0), R134A.ideal_isothermal_work(10.0, 80.0, 300.0)
    assert found == pytest.approx(ideal, rel=1e-4)  # B p/(R T): 1e-5 here


def test_an_isotherm_through_saturation_has_no_work_and_says_why():
    assert R134A.isothermal_work(3.15e5, 11.6e5, 285.0) is None
    assert "R134a at 11.85 °C condenses at 4.40" in R134A.isothermal_obstacle(3.15e5, 11.6e5, 285.0)
    assert R134A.isothermal_obstacle(3.15e5, 11.6e5, 375.0) is None  # above the critical temperature


def test_a_second_process_never_imports_coolprop():
    RealGas("R134a", "equilibrium").isentropic_work(2e5, 8e5, 285.0)
    code = (
        "import sys; from screwsim.fluid.real_gas import RealGas; g = RealGas('R134a', 'equilibrium');"
        "g.isentropic_work(2e5, 8e5, 285.0); assert not any(m.startswith('CoolProp') for m in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


# ---- limits and refusals ----------------------------------------------------------------------------------------


def test_the_margin_falls_through_zero_where_vapour_saturates():
    T = 300.0
    saturated = RealGas("R134a")._kernels["saturated_vapour"](T)
    assert MARGIN(T, 0.9 * saturated) == pytest.approx(-math.log(0.9), rel=1e-9)
    assert MARGIN(T, saturated * (1 - 1e-9)) > 0.0 > MARGIN(T, saturated * (1 + 1e-9))
    assert R134A.why_outside(T, 0.9 * saturated) is None
    wet = R134A.why_outside(T, 1.1 * saturated)
    assert wet.limit is Limit.WET and "condenses" in wet.what


def test_the_margin_falls_through_zero_at_the_equations_limits():
    known = R134A.known
    ends = (known.T_min - 0.1, Limit.COLD, "lowest temperature"), (known.T_max + 0.1, Limit.HOT, "highest temperature")
    for T, limit, words in ends:
        assert MARGIN(T, 1e-3) < 0.0
        found = R134A.why_outside(T, 1e-3)
        assert found.limit is limit and words in found.what
    assert MARGIN(400.0, 1400.0) < 0.0
    pressed = R134A.why_outside(400.0, 1400.0)
    assert pressed.limit is Limit.PRESSED and "highest pressure" in pressed.what


def test_a_liquid_is_refused_with_its_boiling_point():
    with pytest.raises(UsageError, match=r"R134a at 5 bar, 6\.85 degC is liquid: it boils at 15\.73"):
        R134A.port_state(5e5, 280.0)


def test_what_no_state_has_fails_a_case_and_ends_no_sweep():
    """Carbon dioxide above its critical pressure, colder than at the critical temperature; a liquid in a line."""
    with pytest.raises(QuantityNotFound, match="below the range of the equation; use warmer gas or oil"):
        RealGas("CarbonDioxide").temperature(1.2e7, 261e3)
    with pytest.raises(QuantityNotFound, match="is liquid"):
        R134A.enthalpy(5e5, 280.0)


def test_the_nearest_vapour_is_the_state_itself_or_one_kelvin_above_saturation():
    assert R134A.nearest_vapour(5e5, 300.0) == 300.0
    assert R134A.nearest_vapour(5e5, 280.0) == R134A.saturation_temperature(5e5) + 1.0
    assert R134A.nearest_vapour(50e5, 300.0) == saturation("R134a").T_c + 1.0
    assert R134A.density(50e5, R134A.nearest_vapour(50e5, 300.0)) > 0.0


@pytest.mark.parametrize("lower", [60e3, 180e3])  # two phases, liquid
def test_a_plenum_of_less_enthalpy_than_vapour_has_what_was_asked(lower):
    h = R134A.enthalpy(12e5, 330.0) - lower
    p, _rho, found, *_ = R134A.port_state_of_enthalpy(12e5, h)
    assert (p, found) == pytest.approx((12e5, h), rel=1e-12)


@pytest.mark.parametrize(("T", "p"), [(290.0, 11.5e5), (310.0, 30e5), (250.0, 20e5)])
def test_a_liquid_is_that_of_coolprop(T, p):
    import CoolProp.CoolProp as coolprop

    state = coolprop.AbstractState("HEOS", "R134a")
    state.update(coolprop.PT_INPUTS, p, T)
    _p, rho, *_ = R134A.port_state_of_enthalpy(p, state.hmass())
    assert rho == pytest.approx(state.rhomass(), rel=1e-9)  # the reference's own iteration on p


def test_two_phases_are_outside_only_where_they_are_refused():
    rho = 1.5 * R134A.density(5e5, 290.0)
    assert "condenses at 16.85 degC" in R134A.why_outside(290.0, rho).what
    assert RealGas("R134a", "equilibrium").why_outside(290.0, rho) is None


@each_row(("T_r", "rho_r", "beside"), [(1.0, 1.01, True), (1.0, 0.99, True), (1.001, 1.0, False), (1.0, 1.2, False)])
def test_a_state_beside_the_critical_point_is_told_where_two_phases_are_followed(T_r, rho_r, beside):
    found = saturation("R245fa")
    state = T_r * found.T_c * (1.0 - 1e-7), rho_r * found.rho_c
    told = RealGas("R245fa", "equilibrium").at_critical_point(*state)
    assert told == ("the critical point of R245fa (153.86 degC, 519 kg/m3)" if beside else "")
    assert RealGas("R245fa").at_critical_point(*state) == ""


def test_the_first_state_outside_is_found():
    T, rho = np.array([300.0, 290.0, 280.0]), np.array([5.0, 5.0, 60.0])
    assert R134A.first_outside(T, rho) == 2
    assert R134A.first_outside(T[:2], rho[:2]) is None


def test_an_unknown_fluid_is_refused():
    with pytest.raises(UsageError, match="no pure fluid 'R134z'"):
        RealGas("R134z").known  # noqa: B018


def test_a_mixture_without_composition_is_refused_by_name():
    with pytest.raises(UsageError, match=r"R134a&R32 is a mixture; write fluid: \[NAME, NAME\] with mass_fractions"):
        RealGas("R134a&R32").known  # noqa: B018


def test_two_phases_of_a_pseudo_pure_fluid_are_refused():
    with pytest.raises(UsageError, match=r"gas.two_phase: R410A is a mixture"):
        RealGas("R410A", "equilibrium")


def test_an_unknown_term_is_refused_by_name(monkeypatch):
    monkeypatch.delitem(terms.RESIDUAL, "ResidualHelmholtzGaoB")
    with pytest.raises(UsageError, match="Ammonia: its equation has the term ResidualHelmholtzGaoB"):
        terms.residual_terms(description.describe("Ammonia"))


def test_the_kernels_are_written_anew_for_another_equation():
    one, other = RealGas("R134a").state, RealGas("R22").state
    assert isinstance(one, Kernel) and one.flat_name != other.flat_name and one.flat_name.startswith("r134a_")


def test_a_reservoir_of_saturated_liquid_or_vapour_flows_as_one_phase():
    """k = ρ w²/p of either phase: R134a at 45 °C, CoolProp's speeds of sound at saturation."""
    import CoolProp.CoolProp as coolprop

    gas, T = RealGas("R134a"), 318.15
    p = gas.saturation_pressure(T)
    for quality, reservoir in (
        (1, gas.vapour(p, T)),
        (0, gas.liquid(p, coolprop.PropsSI("H", "T", T, "Q", 0, "R134a"))),
    ):
        known = {name: coolprop.PropsSI(name, "T", T, "Q", quality, "R134a") for name in ("D", "H", "A", "S")}
        assert reservoir.rho == pytest.approx(known["D"], rel=1e-6)
        assert reservoir.h == pytest.approx(known["H"], rel=1e-8)
        assert reservoir.s == pytest.approx(known["S"], rel=1e-7)
        assert 1.0 / reservoir.exponent == pytest.approx(known["D"] * known["A"] ** 2 / p, rel=1e-4)


def test_a_reservoir_of_liquid_refuses_what_is_wet():
    gas = RealGas("R134a")
    with pytest.raises(UsageError, match="not a liquid"):
        gas.liquid(5e5, 300e3)


def test_a_pseudo_pure_fluids_liquid_is_not_taken_for_wet_vapour():
    gas = RealGas("R410A")
    liquid = gas.liquid(27e5, gas.enthalpy(5e5, 300.0) - 210e3)
    assert liquid.rho > 900.0
    assert gas.isentropic_work_of_enthalpy(27e5, 27e5, liquid.h) == pytest.approx(0.0, abs=1e-6 * liquid.h)
