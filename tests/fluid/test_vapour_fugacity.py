"""Fugacity of vapour over that at saturation: CoolProp's between the nodes, its limits, its inverse."""

import math

import numpy as np
import pytest
from CoolProp.CoolProp import PT_INPUTS, QT_INPUTS, AbstractState, iphase_gas
from each_row import each_row

from screwsim.fluid.vapour_fugacity import fugacity_table

FLUID, LOW, HIGH = "R134a", 255.0, 370.0
TEMPERATURES = [255.0, 271.3, 300.0, 327.7, 345.0, 362.5, 368.8, 370.0]  # the last is 4 K below the critical one
TABLE = fugacity_table(FLUID, LOW, HIGH)


def coolprops(T, shares):
    """Return (g − g_sat)/(R T) of vapour at T, which is ln(f/f_sat), by enthalpy and entropy."""
    state = AbstractState("HEOS", FLUID)
    state.update(QT_INPUTS, 1.0, T)
    p_sat, saturated = state.p(), state.hmass() - T * state.smass()
    R, found = state.gas_constant() / state.molar_mass(), []
    state.specify_phase(iphase_gas)
    for share in shares:
        state.update(PT_INPUTS, share * p_sat, T)
        found.append((state.hmass() - T * state.smass() - saturated) / (R * T))
    return found


@each_row("T", TEMPERATURES)
def test_the_ratio_of_fugacities_is_the_difference_of_chemical_potentials(T):
    """Also close to saturation near the critical temperature, where the vapour's spinodal is near."""
    shares = [1e-6, 1e-3, 0.02, 0.11, 0.28, 0.53, 0.77, 0.9, 0.97, 0.995, 0.9999]
    found = [math.log(TABLE.at(T).ratio(share)) for share in shares]
    assert found == pytest.approx(coolprops(T, shares), rel=0.0, abs=2e-6)


@each_row("T", TEMPERATURES)
def test_thin_vapour_is_an_ideal_gas(T):
    """ln φ falls by B p/(R T), which at a millionth of the saturation pressure is below 1e-6."""
    assert -1e-6 < TABLE.at(T).logarithm(1e-6)[0] < 0.0
    assert TABLE.at(T).ratio(0.0) == TABLE.at(T).ratio(-1.0) == 0.0


@each_row("T", TEMPERATURES)
def test_at_saturation_the_ratio_is_one(T):
    assert TABLE.at(T).ratio(1.0) == TABLE.at(T).ratio(1.5) == 1.0
    assert TABLE.at(T).ratio(1.0 - 1e-9) == pytest.approx(1.0, abs=1.1e-9)
    assert TABLE.at(T).share(0.0) == 1.0


@each_row("T", TEMPERATURES)
def test_the_share_is_the_inverse_of_the_ratio(T):
    for share in (1e-9, 1e-3, 0.2, 0.6, 0.95, 1.0 - 1e-9):
        assert TABLE.at(T).share(math.log(TABLE.at(T).ratio(share))) == pytest.approx(share, rel=1e-12)


@each_row("T", TEMPERATURES)
def test_the_slope_is_that_of_the_logarithm(T):
    for share in (0.05, 0.5, 0.95):
        below, above = (TABLE.at(T).logarithm(share + step)[0] for step in (-1e-5, 1e-5))
        assert TABLE.at(T).logarithm(share)[1] == pytest.approx((above - below) / 2e-5, rel=1e-6)


@each_row("T", TEMPERATURES)
def test_the_share_grows_smoothly_through_saturation(T):
    shares = [TABLE.at(T).share(each) for each in np.linspace(-1e-4, 1e-4, 21)]
    steps = np.diff(shares)
    assert (steps > 0.0).all() and steps.max() / steps.min() < 1.001 + 0.01 * (T > 360.0)
