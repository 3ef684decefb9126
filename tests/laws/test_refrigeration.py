"""Laws of the figures of refrigeration: capacity and COP against CoolProp, and the same cycle for both ways."""

import math

import pytest
from scenes import DROP, RATED, make, run

from screwsim.build import build_gas
from screwsim.evaluate.performance import parted, refrigeration
from screwsim.figures.errors import relative_errors
from screwsim.outputs import Figures
from screwsim.scene import lines, refrigerating_effect, suction_enthalpy

ALGEBRA = 1e-12
COOLING = ("cooling_capacity", "cop", "volumetric_cooling_capacity", "heating_capacity", "heating_cop")


def coolprop():
    return pytest.importorskip("CoolProp.CoolProp")


def effect(subcooling: float) -> float:
    """Return h1 − h4 [J/kg] of R134a at 2/45 °C, superheat 10 K, by CoolProp's high-level interface."""
    PropsSI = coolprop().PropsSI
    p_s, p_d = PropsSI("P", "T", 275.15, "Q", 1, "R134a"), PropsSI("P", "T", 318.15, "Q", 0, "R134a")
    h_1 = PropsSI("H", "P", p_s, "T", 285.15, "R134a")
    liquid = ("T", 318.15, "Q", 0) if subcooling == 0.0 else ("P", p_d, "T", 318.15 - subcooling)
    return h_1 - PropsSI("H", *liquid, "R134a")


@pytest.mark.parametrize("subcooling", [0.0, 5.0])
def test_refrigerating_effect_is_coolprops(subcooling):
    scene = make({**RATED, "operation.subcooling": f"{subcooling} K"})
    assert refrigerating_effect(scene) == pytest.approx(effect(subcooling), rel=1e-10)


def test_refrigerating_effect_of_r134a_is_of_the_known_size():
    # 144.8 kJ/kg at 2/45 °C with 10 K of superheat
    assert refrigerating_effect(make(RATED)) == pytest.approx(144.8e3, rel=5e-4)


def test_no_subcooling_is_that_of_zero_kelvin_and_a_little_more_goes_on_smoothly():
    absent, zero, little = (
        refrigerating_effect(make({**RATED, "operation.subcooling": value})) for value in (DROP, "0 K", "1e-6 K")
    )
    assert absent == zero
    # 1.5 kJ/(kg K) times 1 µK, and CoolProp's saturation within 1e-7 of its pressure
    assert little == pytest.approx(zero, abs=0.02)


def test_wet_suction_has_the_enthalpy_of_the_mixture():
    PropsSI = coolprop().PropsSI
    real = {"gas.model": "real", "gas.two_phase": "equilibrium", "operation.suction": {"quality": 0.9}}
    scene = make({**RATED, **real, "operation.superheat": DROP})
    expected = [PropsSI("H", "T", 275.15, "Q", x, "R134a") for x in (0, 1)]
    assert suction_enthalpy(scene) == pytest.approx(0.1 * expected[0] + 0.9 * expected[1], rel=1e-10)


WET = {
    **RATED,
    "gas.model": "real",
    "gas.two_phase": "equilibrium",
    "operation.superheat": DROP,
    "oil.transport": "carried",
    "oil_supply.temperature": "325 K",
}


def test_wet_suction_closes_and_starts_from_its_mixture():
    result = run({**WET, "operation.suction": {"quality": 0.9}})
    assert result.status == "ok"
    assert result.performance.suction_temperature == pytest.approx(275.15, abs=1e-6)
    assert result.notes["isothermal_efficiency"] == "the intake is wet"


def test_drier_suction_tends_to_saturated_vapour():
    """As the quality goes to one the cycle goes to that of a superheat of zero, smoothly."""
    dry = run({**WET, "operation.suction": {"quality": 1.0}}).performance
    found = [
        run({**WET, "operation.suction": {"quality": x}}).performance.isentropic_efficiency - dry.isentropic_efficiency
        for x in (0.98, 0.99)
    ]
    assert found[0] == pytest.approx(2 * found[1], rel=0.2)  # second order of 2 % wetness, and 3e-4 of each figure


@pytest.fixture(scope="module")
def result():
    return run(RATED)


def test_capacity_is_flow_times_effect(result):
    p = result.performance
    assert p.cooling_capacity == pytest.approx(p.gas_mass_flow * effect(0.0), rel=1e-10)


def test_cop_is_capacity_over_shaft_power(result):
    p = result.performance
    assert p.cop == pytest.approx(p.cooling_capacity / p.shaft_power, rel=ALGEBRA)


def test_cop_is_isentropic_efficiency_of_that_of_the_ideal_compressor(result):
    p, gas, at = result.performance, build_gas(make(RATED)), lines(make(RATED))
    best = effect(0.0) / gas.isentropic_work(at.p_s, at.p_d, at.T_s)
    assert p.cop == pytest.approx(p.isentropic_efficiency * best, rel=1e-10)
    # below the reversed Carnot cycle between the two temperatures, above one
    assert 1.0 < p.cop < 275.15 / (318.15 - 275.15)


def test_figures_per_volume_belong_together(result):
    p, gas, at = result.performance, build_gas(make(RATED)), lines(make(RATED))
    volume_flow = p.gas_mass_flow / gas.density(at.p_s, at.T_s)
    assert p.specific_power == pytest.approx(p.shaft_power / volume_flow, rel=ALGEBRA)
    assert p.volumetric_cooling_capacity / p.specific_power == pytest.approx(p.cop, rel=ALGEBRA)
    swept = 6e-4 * 4 * 3000 / 60
    assert p.volumetric_cooling_capacity * p.volumetric_efficiency * swept == pytest.approx(
        p.cooling_capacity, rel=ALGEBRA
    )


def test_both_ways_give_the_same_result_bit_for_bit(result):
    at = lines(make(RATED))
    other = run(
        {
            "operation": {
                "speed": "3000 rpm",
                "suction": {"pressure": f"{at.p_s!r} Pa", "temperature": f"{at.T_s!r} K"},
                "discharge": {"pressure": f"{at.p_d!r} Pa"},
            },
            "oil_supply.temperature": "330 K",
        }
    )
    same = {name: value for name, value in result.performance.items() if name not in COOLING}
    assert {name: value for name, value in other.performance.items() if name not in COOLING} == same
    assert result.balance == other.balance
    for name, trace in result.cycle.items():
        assert (trace == other.cycle[name]).all() or math.isnan(trace[0]), name


def test_pressures_alone_call_for_no_capacity():
    found = run()
    assert not {*COOLING} & {*found.performance, *found.notes}
    with pytest.raises(AttributeError, match=r"^no figure 'cop' here: it needs operation\.condensing_temp"):
        _ = found.performance.cop
    assert found.performance.specific_power is not None


def test_lines_are_reported_whichever_way_they_are_stated(result):
    p, at = result.performance, lines(make(RATED))
    assert (p.suction_pressure, p.suction_temperature, p.discharge_pressure) == (at.p_s, at.T_s, at.p_d)


def test_a_machine_that_delivers_nothing_cools_nothing():
    figures, notes = parted(refrigeration({"gas_mass_flow": -0.01, "shaft_power": 5e3}, 13.0, 145e3))
    assert set(figures.values()) == {None}
    assert set(notes) == set(figures)


def test_no_positive_power_has_no_cop():
    figures, notes = parted(refrigeration({"gas_mass_flow": 0.4, "shaft_power": -5e3}, 13.0, 145e3))
    assert figures["cop"] is None and figures["cooling_capacity"] == pytest.approx(0.4 * 145e3)
    assert notes == {"cop": "the shaft power is not positive"}


def test_an_expander_cools_nothing():
    operation = {"speed": "3000 rpm", "superheat": "10 K"}
    operation |= {"evaporating_temperature": "80 degC", "condensing_temperature": "30 degC"}
    changes = {"operation": operation, "machine.mode": "expander", "oil": DROP, "oil_supply": DROP, "effects": {}}
    assert refrigerating_effect(make(changes)) is None


def test_the_error_of_specific_power_is_over_itself():
    found, better = (
        Figures(ideal_isothermal_efficiency=0.6, specific_power=value, shaft_power=2e4) for value in (1.01e6, 1e6)
    )
    assert relative_errors(found, better).specific_power == pytest.approx(0.01)
