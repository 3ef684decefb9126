"""A machine on moist air: its water, its heat, its dry limit; a condensing chamber against one written with scipy."""

from math import radians

import CoolProp.CoolProp as coolprop
import numpy as np
import pytest
from scenes import DROP, balanced, make, run
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from screwsim.build import build_gas
from screwsim.figures.errors import relative_errors, worst
from screwsim.scene.lines import lines
from screwsim.study.accuracy.coolprop_back_end import machinery_with_coolprop
from screwsim.study.accuracy.solving import QUICK_SCOPE, back_ends

AIR = {
    "gas": {"fluid": "air", "model": "ideal", "relative_humidity": 0.6},
    "operation.suction": {"pressure": "1 bar", "temperature": "25 degC"},
    "operation.discharge.pressure": "9 bar",
    "oil.transport": "carried",
    "oil_supply.ratio": 6,
    "effects.oil_heat": {"droplet_radius": "25 um", "heat_transfer_coefficient": "1 kW/(m^2 K)"},
}
TIGHT = {"accuracy": 1e-4}


def machine(kept=None, **changes):
    """Return the result of a machine whose thermostat keeps a temperature at discharge [degC]; None: oil of 293 K."""
    cooler = {} if kept is None else {"cooler": {"discharge_temperature": f"{kept} degC"}}
    parted = {"effects.separator": cooler} | ({} if kept is None else {"oil_supply.temperature": DROP})
    return run({**AIR, **parted, "numerics": TIGHT, **changes})


@pytest.fixture(scope="module")
def cold():
    """A machine whose oil is so cold that water condenses in chambers and separator, and its scene's changes."""
    return machine(45, **{"operation.aftercooler_temperature": "30 degC"})


@pytest.fixture(scope="module")
def warm():
    return machine(85, **{"operation.aftercooler_temperature": "30 degC"})


def test_water_that_comes_goes_as_vapour_and_condensate(cold, warm):
    for result in (cold, warm):
        p = result.performance
        gone = p.condensate_flow + p.vapour_flow
        assert p.water_flow == pytest.approx(gone, rel=1e-4) and abs(p.water_residual) < 1e-4
        assert p.water_flow == pytest.approx(p.gas_mass_flow * p.humidity_ratio / (1.0 + p.humidity_ratio), rel=1e-12)
    assert warm.performance.condensate_flow == 0.0 < cold.performance.condensate_flow
    left = [each.performance.vapour_flow - each.performance.aftercooler_condensate_flow for each in (cold, warm)]
    flows = [each.performance.gas_mass_flow for each in (cold, warm)]
    assert left[0] / left[1] == pytest.approx(flows[0] / flows[1], rel=1e-4)  # both leave at 30 degC, saturated


def test_condensate_is_what_HAPropsSI_lets_fall_out():
    changes = {"gas.model": "real", "operation.aftercooler_temperature": "30 degC"}
    p = machine(45, **changes).performance
    dry = p.gas_mass_flow / (1.0 + p.humidity_ratio)
    before = p.humidity_ratio
    for name, T in (("condensate_flow", 318.15), ("aftercooler_condensate_flow", 303.15)):
        after = coolprop.HAPropsSI("W", "T", T, "P", 9e5, "R", 1.0)
        assert p[name] == pytest.approx(dry * (before - after), rel=0.01)
        before = after
    dew = coolprop.HAPropsSI("D", "T", 400.0, "P", 9e5, "W", p.humidity_ratio)
    assert p.pressure_dew_point == pytest.approx(dew, abs=0.2)
    assert p.lowest_safe_oil_temperature == p.pressure_dew_point + 5.0


def test_the_condensing_machine_closes_its_balances(cold):
    balanced(cold, "oil_mass")
    assert 0.01 < cold.performance.chamber_condensate_share < 0.5


def test_its_cooler_takes_the_heat_of_what_condenses(cold):
    """From the figures alone: with the latent heat of the condensate, by CoolProp, the circuit closes."""
    scene, p = make(AIR), cold.performance
    gas, at = build_gas(scene), lines(scene)
    vapour = gas.enthalpy(1e5, p.separator_temperature) - gas.enthalpy(1e5, at.T_s)  # an ideal gas: of no pressure
    latent = coolprop.PropsSI("H", "T", 318.15, "Q", 1, "Water") - coolprop.PropsSI("H", "T", 318.15, "Q", 0, "Water")
    taken = p.gas_mass_flow * vapour - p.condensate_flow * latent + p.oil_cooler_duty
    assert taken == pytest.approx(p.shaft_power, rel=1e-3)
    assert p.condensate_flow * latent > 0.02 * p.shaft_power  # it counts


def test_warnings_tell_of_water(cold, warm):
    told = " / ".join(cold.warnings)
    assert "gas and oil separate at 45.0 degC, below the pressure dew point of 56.7 degC" in told
    assert "keep them at 61.7 degC or above with warmer oil" in told and "of the water in a chamber is liquid" in told
    assert not [each for each in warm.warnings if "water" in each or "dew" in each]
    near = machine(59)
    assert any("only 2.3 K above the pressure dew point" in each for each in near.warnings)
    assert not any("59.0 degC" in each for each in machine(59, **{"gas.dew_point_margin": "2 K"}).warnings)


def test_a_humidity_of_nothing_is_dry_air_to_the_bit():
    dry, none = machine(85, **{"gas.relative_humidity": DROP}), machine(85, **{"gas.relative_humidity": 0.0})
    assert {name: none.performance[name] for name in dry.performance} == dict(dry.performance)
    assert none.numerics.rhs_evaluations == dry.numerics.rhs_evaluations
    assert none.performance.humidity_ratio == none.performance.water_flow == none.performance.condensate_flow == 0.0
    assert none.performance.pressure_dew_point is None and none.notes["pressure_dew_point"]
    least = machine(85, **{"gas.relative_humidity": 1e-9})  # by the equations of moist air
    assert worst(relative_errors(dry.performance, least.performance))[1] < 1e-6
    hardly = machine(85, **{"gas.relative_humidity": 1e-13})
    assert worst(relative_errors(dry.performance, hardly.performance))[1] < 1e-6
    assert hardly.performance.pressure_dew_point is None and "-123.15 degC" in hardly.notes["pressure_dew_point"]


def test_without_the_key_there_is_no_figure_of_it(warm):
    about = {name for name, each in warm.performance.about.items() if each.needs == ("gas.relative_humidity",)}
    dry = machine(85, **{"gas.relative_humidity": DROP})
    assert len(about) == 8 and not about & set(dry.performance)


def test_coolprop_is_not_asked_for_its_states():
    scene = make({**AIR, "gas.model": "real"})
    with pytest.raises(ValueError, match="no moist air"):
        machinery_with_coolprop(scene)
    assert not any(case.back_end == "coolprop" for case in back_ends(scene, QUICK_SCOPE))


# ---- a closed chamber, written anew ------------------------------------------------------------------------------

HEAT = {"droplet_radius": "50 um", "heat_transfer_coefficient": "4 kW/(m^2 K)"}
SHUT = {**AIR, "gas.relative_humidity": 0.9, "oil_supply.temperature": "283 K", "numerics": {"accuracy": 1e-6}}
SHUT["effects"] = {"suction_port": {}, "discharge_port": {}, "oil_heat": HEAT}  # nothing leaks: shut from 360° to 600°
R_A, R_W = 8.314462618 / 0.02896546, 8.314462618 / 0.018015268


class Chamber:
    """Moist air of constant heat capacities and its oil in a chamber; energy and the oil's temperature are its states.

    Vapour pressure is CoolProp's, the latent heat Clausius and Clapeyron's of an ideal vapour; temperature and what is
    liquid are searched for anew at every angle.
    """

    def __init__(self, m, y, c_a, c_w, d, alpha_over_r, rho_oil, c_oil, omega):
        self.m_a, self.m_w, self.c_a, self.c_w = m * (1.0 - y), m * y, c_a, c_w
        self.oil, self.c_oil, self.omega = d * m, c_oil, omega
        self.exchange = 3.0 * alpha_over_r / rho_oil * self.oil
        T = np.linspace(273.16, 420.0, 300)
        logs = np.log([coolprop.PropsSI("P", "T", each, "Q", 1, "Water") for each in T])
        self.log_p = np.polynomial.Chebyshev.fit(1.0 / T, logs, 9)
        self.slope = self.log_p.deriv()

    def vapour(self, T, V):
        """Return the mass of vapour [kg]."""
        return min(self.m_w, np.exp(self.log_p(1.0 / T)) * V / (R_W * T))

    def energy(self, T, V):
        """Return the inner energy [J], that of liquid from u_v + R T less the latent heat −R d(ln p)/d(1/T)."""
        liquid = self.m_w - self.vapour(T, V)
        return (self.m_a * self.c_a + self.m_w * self.c_w) * T + liquid * R_W * (T + self.slope(1.0 / T))

    def temperature(self, U, V):
        return brentq(lambda T: self.energy(T, V) - U, 274.0, 419.0, xtol=1e-11)

    def pressure(self, T, V):
        return (self.m_a * R_A + self.vapour(T, V) * R_W) * T / V

    def course(self, law, start, end, T, T_oil, angles):
        """Return temperature of gas and oil, pressure and liquid [kg] at angles."""

        def rates(phi, state):
            V, slope = law(phi)
            T = self.temperature(state[0], V)
            heat = self.exchange * (state[1] - T) / self.omega
            return [heat - self.pressure(T, V) * slope, -heat / (self.oil * self.c_oil)]

        given = [self.energy(T, law(start)[0]), T_oil]
        found = solve_ivp(rates, (start, end), given, "LSODA", angles, rtol=1e-9, atol=1e-9, max_step=0.02)
        volumes = [law(phi)[0] for phi in angles]
        T = np.array([self.temperature(U, V) for U, V in zip(found.y[0], volumes, strict=True)])
        p = np.array([self.pressure(*at) for at in zip(T, volumes, strict=True)])
        liquid = np.array([self.m_w - self.vapour(*at) for at in zip(T, volumes, strict=True)])
        return T, found.y[1], p, liquid


def test_a_condensing_chamber_is_that_of_an_independent_writing():
    scene = make(SHUT)
    result, gas = run(SHUT), build_gas(scene)
    cycle, geometry = result.cycle, scene.machine
    first, last = 361, 598
    V_max, V_min, c = geometry.volume.max, geometry.volume.min or 1e-4 * geometry.volume.max, geometry.volume.phi_A
    c = c / radians(360.0)

    def law(phi):
        """Return V and dV/dφ of paper (16)."""
        x = phi / radians(360.0)
        B, slope = (
            (x * x / c, 2.0 * x / c)
            if x < c
            else (1.0 + (x - 1.0) ** 2 / (c - 1.0), 2.0 * (x - 1.0) / (c - 1.0))
            if x < 2.0 - c
            else ((x - 2.0) ** 2 / c, 2.0 * (x - 2.0) / c)
        )
        return V_min + V_max * B, V_max * slope / radians(360.0)

    own = Chamber(
        cycle["gas_mass"][first],
        gas.share,
        gas.dry.c_v,
        gas.c_water,
        cycle["oil_mass"][first] / cycle["gas_mass"][first],
        4000.0 / 50e-6,
        1000.0,
        2000.0,
        2.0 * np.pi * 50.0,
    )
    angles = np.radians(cycle["angle"][first : last + 1])
    T, T_oil, p, liquid = own.course(
        law, angles[0], angles[-1], cycle["gas_temperature"][first], cycle["oil_temperature"][first], angles
    )
    where = slice(first, last + 1)
    assert liquid[-1] > 0.3 * own.m_w and liquid[0] == 0.0  # it begins dry, and condenses on its way
    assert cycle["volume"][where] == pytest.approx([law(phi)[0] for phi in angles], rel=1e-9)
    assert cycle["gas_temperature"][where] == pytest.approx(T, rel=1e-5)  # p_s: 6e-5 of another equation
    assert cycle["oil_temperature"][where] == pytest.approx(T_oil, rel=1e-5)
    assert cycle["pressure"][where] == pytest.approx(p, rel=3e-5)
    rho = cycle["gas_mass"] / cycle["volume"]
    ours = [gas.liquid_share(*at) for at in zip(cycle["gas_temperature"][where], rho[where], strict=True)]
    assert np.array(ours) * cycle["gas_mass"][where] == pytest.approx(liquid, abs=2e-4 * own.m_w)
