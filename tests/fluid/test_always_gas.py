"""Blends that are known as a gas only: from which temperature on (M317), and how their states are limited."""

import CoolProp.CoolProp as coolprop
import numpy as np
import pytest

from screwsim.fluid import constants
from screwsim.fluid.always_gas import P_MOST, gas_from, has_two_phases
from screwsim.fluid.description import describe
from screwsim.fluid.fugacity import Fugacities
from screwsim.fluid.limits import Limit
from screwsim.fluid.phase_envelope import Untraced, envelope
from screwsim.fluid.real_gas import RealGas
from screwsim.fluid.saturation import saturation
from screwsim.inputs.faults import QuantityNotFound, UsageError

SOUR = "Methane/Ethane/CO2 (mole 0.93/0.05/0.02)"  # its two phases lie below the triple point of CO2
OPEN = "Hydrogen/Methane (mole 0.8/0.2)"  # its envelope is not closed
FLOOR = 216.592  # [K] triple point of CO2


@pytest.mark.parametrize("fluid", ["Methane/CO2 (mole 0.6/0.4)", "R454B", "R513A"])
def test_two_phases_are_found_below_the_highest_temperature_of_an_envelope_and_not_above(fluid):
    known = describe(fluid)
    f, T_m = Fugacities(known), envelope(known).T_m
    assert has_two_phases(f, 0.995 * T_m)
    assert has_two_phases(f, 0.8 * T_m)
    assert not has_two_phases(f, 1.02 * T_m)


def test_a_drop_of_water_is_found_in_methane():
    f = Fugacities(describe("Methane/Water (mole 0.97/0.03)"))
    assert all(has_two_phases(f, T) for T in (280.0, 300.0, 340.0, 400.0))


def test_an_open_envelope_ends_below_the_temperature_from_which_the_blend_is_a_gas():
    with pytest.raises(Untraced) as untraced:
        envelope(describe(OPEN))
    hottest = untraced.value.hottest
    assert 140.0 < hottest < 155.0  # the dew line's highest temperature
    assert gas_from(describe(OPEN), hottest) == pytest.approx(1.02 * hottest, rel=1e-12)


def test_a_blend_whose_envelope_lies_below_its_equations_is_a_gas_from_their_end_on():
    found = saturation(SOUR)
    assert found.always_gas and pytest.approx(FLOOR, abs=1e-3) == found.T_low == found.T_c


def test_states_of_such_a_gas_are_those_of_coolprop():
    state, gas = coolprop.AbstractState("HEOS", "Methane&Ethane&CO2"), RealGas(SOUR)
    state.set_mole_fractions([0.93, 0.05, 0.02])
    state.specify_phase(coolprop.iphase_gas)
    for p, T in ((1e5, 300.0), (12e5, 370.0), (60e5, 250.0)):
        state.update(coolprop.PT_INPUTS, p, T)
        rho = gas.density(p, T)
        assert rho == pytest.approx(state.rhomass(), rel=1e-9)
        assert gas.state(T, rho)[2] == pytest.approx(state.cvmass(), rel=1e-9)


def test_an_isentrope_of_such_a_gas_returns_to_its_beginning():
    gas = RealGas(SOUR)
    T, rho, _ = gas.isentrope(12e5, gas.entropy(1e5, 300.0))
    back, _, _ = gas.isentrope(1e5, float(gas._kernels["specific_entropy"](T, rho)))
    assert back == pytest.approx(300.0, abs=1e-9)


def test_such_a_gas_does_not_saturate():
    gas = RealGas(SOUR)
    assert gas.saturation_temperature(12e5) is None
    assert gas.saturation_pressure(300.0) == np.inf
    assert gas.isothermal_obstacle(1e5, 100e5, 300.0) is None
    assert gas.nearest_vapour(1e5, 150.0) == 150.0
    with pytest.raises(UsageError, match=r"no known saturation at 12 bar \(.* gas only, from -56.558 degC on"):
        constants.saturation_temperature(SOUR, 12e5)


def test_such_a_gas_is_refused_below_its_lowest_temperature_and_above_the_highest_pressure():
    gas = RealGas(SOUR)
    cold, pressed = gas.why_outside(200.0, 1.0), gas.why_outside(300.0, 500.0)
    assert cold is not None and cold.limit is Limit.COLD and "known as a gas only, from -56.558 degC on" in cold.what
    assert pressed is not None and pressed.limit is Limit.PRESSED and f"{P_MOST / 1e5:.0f} bar" in pressed.what
    assert gas.first_outside(np.array([300.0, 200.0]), np.array([1.0, 1.0])) == 1
    with pytest.raises(QuantityNotFound, match="known as a gas only"):
        gas.density(1e5, 200.0)


def test_its_two_phases_are_not_followed():
    with pytest.raises(UsageError, match=r"gas.two_phase: Methane.*its phase envelope is not known \(write refuse"):
        _ = RealGas(SOUR, "equilibrium").state
