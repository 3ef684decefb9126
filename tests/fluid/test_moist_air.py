"""Moist air: water against CoolProp, saturation, dew point, heat and density against HAPropsSI, its dry limit."""

import sys
from pathlib import Path

import CoolProp.CoolProp as coolprop
import pytest
from each_row import each_row

from screwsim.fluid import constants, water
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.moist_air import DRIEST, MoistAir, moist_air, saturated_ratio
from screwsim.fluid.real_gas import RealGas
from screwsim.inputs.faults import UsageError

P_S, T_S, HUMIDITY = 1e5, 298.15, 0.6
IDEAL = IdealGas(constants.gas_constant("Air"), constants.isentropic_exponent("Air", T_S))
GASES = {"ideal": moist_air(IDEAL, P_S, T_S, HUMIDITY), "real": moist_air(RealGas("Air"), P_S, T_S, HUMIDITY)}
PRESSURES = (1e5, 4e5, 8e5, 14e5)  # those of a machine
TEMPERATURES = (278.15, 298.15, 323.15, 353.15, 368.15)
PER_BAR = 1e-3  # Poynting's factor of 5 degC, and third virial coefficients
by_pressure = pytest.mark.parametrize("p", PRESSURES)


def reference(output, **given):
    """Return what CoolProp says of humid air."""
    return coolprop.HAPropsSI(output, *(each for name, value in given.items() for each in (name, value)))


@each_row("T", TEMPERATURES)
def test_water_is_coolprops(T):
    state = coolprop.AbstractState("HEOS", "Water")
    state.update(coolprop.DmassT_INPUTS, 1e-7, T)
    p_s, slope, bend = water.saturation(T)
    assert p_s == pytest.approx(coolprop.PropsSI("P", "T", T, "Q", 1, "Water"), rel=1e-4)  # of one auxiliary equation
    near = [water.saturation(T * (1.0 + d))[0] for d in (-1e-4, 1e-4)]
    assert slope == pytest.approx((near[1] - near[0]) / 2e-4, rel=1e-5)
    assert bend == pytest.approx((near[1] - 2.0 * p_s + near[0]) / 1e-8, rel=1e-5)
    assert water.energy(T)[0] + water.R_WATER == pytest.approx(state.cp0mass(), rel=2e-5)  # R of the equation is older
    own = water.virials(T)[3] * water.M_WATER
    assert own == pytest.approx(state.Bvirial(), rel=0.06)  # the whole equation misses it when cold


@by_pressure
@pytest.mark.parametrize("T", TEMPERATURES)
def test_saturated_air_holds_what_HAPropsSI_says(p, T):
    bound = {"real": PER_BAR * p / 1e5, "ideal": 0.012 + 4e-3 * p / 1e5}  # without enhancement factor
    for name, gas in GASES.items():
        off = saturated_ratio(gas, p, T) / reference("W", T=T, P=p, R=1.0) - 1.0
        assert -bound[name] < off < 0.0  # the dew point comes out too high: the safe side


@by_pressure
def test_the_dew_point_is_that_of_HAPropsSI(p):
    for name, most in (("real", 0.25), ("ideal", 0.85)):
        gas = GASES[name]
        off = gas.dew_point(p) - reference("D", T=450.0, P=p, W=gas.humidity_ratio)
        assert 0.0 <= off < most * max(p / 14e5, 0.1)
        assert gas.condensed(p, gas.dew_point(p) + 0.01) == 0.0 < gas.condensed(p, gas.dew_point(p) - 0.01)


@by_pressure
@pytest.mark.parametrize("T", [343.15, 373.15, 413.15])
def test_heat_and_density_of_real_moist_air_are_those_of_HAPropsSI(p, T):
    gas, W = GASES["real"], GASES["real"].humidity_ratio
    heat = (gas.enthalpy(p, T) - gas.enthalpy(P_S, T_S)) * (1.0 + W)
    assert heat == pytest.approx(reference("H", T=T, P=p, W=W) - reference("H", T=T_S, P=P_S, W=W), rel=2e-4)
    assert gas.density(p, T) / (1.0 + W) == pytest.approx(1.0 / reference("V", T=T, P=p, W=W), rel=5e-5)
    rise = (gas.entropy(p, T) - gas.entropy(P_S, T_S)) * (1.0 + W)
    theirs = reference("S", T=T, P=p, W=W) - reference("S", T=T_S, P=P_S, W=W)
    assert rise == pytest.approx(theirs, abs=0.2)  # of 760 at 14 bar: theirs misses T ds = dh − v dp by 5e-4


def test_a_relative_humidity_is_that_of_HAPropsSI():
    for humidity in (0.05, 0.6, 1.0):
        made = moist_air(RealGas("Air"), 0.9e5, 308.15, humidity)
        assert made.humidity_ratio == pytest.approx(reference("W", T=308.15, P=0.9e5, R=humidity), rel=2e-3)


def test_latent_heat_is_that_of_water():
    for T in (283.15, 323.15, 363.15):
        wet = MoistAir(RealGas("Air"), 0.9)
        _rho, h, _s, heat = wet._kernels["liquid"](T)
        liquid = h + wet.values["u_water"]
        assert liquid == pytest.approx(coolprop.PropsSI("H", "T", T, "Q", 0, "Water"), abs=2500.0)  # 1e-3 of 2.4 MJ/kg
        assert heat == pytest.approx(4190.0, rel=0.02)


def test_air_without_humidity_is_dry_air_itself():
    assert moist_air(IDEAL, P_S, T_S, 0.0) is IDEAL


def test_next_to_no_water_changes_next_to_nothing():
    for dry in (IDEAL, RealGas("Air")):
        least = MoistAir(dry, 1e-12, water.energy(T_S)[0] if dry is IDEAL else None)
        for p, T in ((1e5, 290.0), (8e5, 370.0)):
            assert least.enthalpy(p, T) - least.enthalpy(1e5, 300.0) == pytest.approx(
                dry.enthalpy(p, T) - dry.enthalpy(1e5, 300.0), rel=1e-10
            )
            port_state, its = least.port_state(p, T), dry.port_state(p, T)
            assert (port_state[1], *port_state[3:]) == pytest.approx((its[1], *its[3:]), rel=1e-10)


def test_states_about_the_bend_where_water_begins_to_condense_are_found():
    for gas in (MoistAir(IDEAL, 0.06, 1400.0), MoistAir(RealGas("Air"), 0.06)):
        p, dew = 12e5, MoistAir(gas.dry, 0.06, gas.c_water).dew_point(12e5)
        for T in (dew - 60.0, dew - 1e-3, dew, dew + 1e-3, dew + 60.0):
            assert gas.temperature(p, gas.enthalpy(p, T)) == pytest.approx(T, rel=1e-10)
            assert gas.isentropic_work_of_enthalpy(p, p, gas.enthalpy(p, T)) == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("name", GASES)
def test_air_as_good_as_dry_has_no_dew_point(name):
    dry = GASES[name].dry
    ratios = [moist_air(dry, 1e5, 298.15, humidity).dew_point(9e5) for humidity in (1e-3, 1e-6, 1e-9, 1e-12, 1e-300)]
    assert ratios[0] > ratios[1] > ratios[2] > DRIEST and ratios[3:] == [None, None]


def test_where_water_boils_there_is_no_relative_humidity():
    with pytest.raises(UsageError, match="water boils at"):
        moist_air(IDEAL, 1e5, 380.0, 0.5)


def test_the_page_that_compares_it_is_what_its_script_makes(monkeypatch):
    root = Path(__file__).parents[2]
    monkeypatch.syspath_prepend(str(root / "benchmarks"))
    import moist_air as script

    assert script.page() == (root / "docs" / "reference" / "moist-air.md").read_text(encoding="utf-8")
    sys.modules.pop("moist_air")
