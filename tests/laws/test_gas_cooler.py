"""A gas cooler in place of a condenser: capacity and COP by plain states of CoolProp, and the limits of both ways."""

from pathlib import Path

import numpy as np
import pytest
from CoolProp.CoolProp import PT_INPUTS, AbstractState, PropsSI, iphase_supercritical
from each_row import each_row

from screwsim.fluid import constants
from screwsim.inputs.faults import SceneError
from screwsim.scene import case, case_count, load, loads
from screwsim.scene.lines import lines, refrigerating_effect
from screwsim.scene.plausible import scene_warnings
from screwsim.simulate import simulate, simulate_many

CONFIG = Path(__file__).parents[2] / "configs" / "co2" / "transcritical.yaml"
T_S, P_GC, T_GC = 273.15, 90e5, 308.15  # -10 degC with 10 K of superheat; 90 bar, 35 degC


def scene(*overrides):
    return load(CONFIG, overrides=overrides)


@pytest.fixture(scope="module")
def result():
    found = simulate(scene())
    assert found.status == "ok"
    return found


def test_capacity_and_cop_are_those_of_coolprops_states(result):
    p_s = PropsSI("P", "T", 263.15, "Q", 1, "CO2")
    q_0 = PropsSI("H", "P", p_s, "T", T_S, "CO2") - PropsSI("H", "P", P_GC, "T", T_GC, "CO2")
    p = result.performance
    assert (p.suction_pressure, p.discharge_pressure) == (pytest.approx(p_s, rel=1e-9), P_GC)
    assert p.cooling_capacity == pytest.approx(p.gas_mass_flow * q_0, rel=1e-9)
    assert p.cop == pytest.approx(p.cooling_capacity / p.shaft_power, rel=1e-12)


def test_the_isentropic_efficiency_is_over_coolprops_isentrope(result):
    p_s = PropsSI("P", "T", 263.15, "Q", 1, "CO2")
    h_s, s = (PropsSI(what, "P", p_s, "T", T_S, "CO2") for what in "HS")
    ideal = PropsSI("H", "P", P_GC, "S", s, "CO2") - h_s
    p = result.performance
    assert p.isentropic_efficiency == pytest.approx(p.gas_mass_flow * ideal / p.shaft_power, rel=1e-7)


def test_balances_and_ledger_close_above_the_critical_point(result):
    assert max(abs(result.balance[name]) for name in ("mass", "energy", "entropy")) < result.balance.bound
    assert abs(result.ledger.relative_residue) < 1e-3


def test_there_is_a_best_pressure_of_the_gas_cooler():
    """Above the critical point it is free, and COP has a maximum, at some 90 bar (Liao, Zhao and Jakobsen 2000)."""
    bar = [78, 82, 86, 90, 94, 110]
    swept = loads(f"base: {CONFIG}\nsweep: {{operation.gas_cooler.pressure: [{', '.join(f'{p} bar' for p in bar)}]}}\n")
    found = list(simulate_many((case(swept, index) for index in range(case_count(swept))), trace=False))
    cop = [each.performance.cop for each in found]
    assert 86 <= bar[cop.index(max(cop))] <= 94
    assert cop[0] < 0.9 * max(cop) and cop[-1] < 0.95 * max(cop)


def test_below_the_critical_pressure_it_is_a_condenser_that_subcools():
    p = PropsSI("P", "T", 293.15, "Q", 0, "CO2")
    states = ["operation.gas_cooler=null", "operation.condensing_temperature=293.15 K", "operation.subcooling=5 K"]
    condenser = scene(*states)
    cooler = scene(f"operation.gas_cooler={{pressure: {p!r} Pa, outlet_temperature: 288.15 K}}")
    assert lines(cooler).p_d == pytest.approx(lines(condenser).p_d, rel=1e-12)
    assert refrigerating_effect(cooler) == pytest.approx(refrigerating_effect(condenser), rel=1e-9)


def test_a_blend_is_cooled_above_its_critical_pressure_too():
    """Of R454B, critical at 351 K, on both sides of that temperature; CoolProp's states of the same composition."""
    state = AbstractState("HEOS", "R454B.mix")
    state.specify_phase(iphase_supercritical)
    own, theirs = [], []
    for T in (345.0, 355.0, 365.0):
        state.update(PT_INPUTS, 60e5, T)
        theirs.append(state.hmass())
        own.append(constants.enthalpy("R454B", 60e5, T))
    assert np.diff(own) == pytest.approx(np.diff(theirs), rel=1e-7)


@each_row(
    ("overrides", "told"),
    [
        (["operation.condensing_temperature=25 degC"], "is given as well as operation.gas_cooler"),
        (["operation.subcooling=5 K"], "is given as well as operation.gas_cooler"),
        (["operation.discharge.pressure=90 bar"], "is given as well as operation.evaporating_temperature"),
        (["operation.gas_cooler.pressure=20 bar"], "is not above the evaporating pressure, 26.48676671 bar"),
        (["operation.gas_cooler.outlet_temperature=-20 degC"], "is colder than the evaporator of -10 degC"),
        (["operation.gas_cooler.outlet_temperature=80 degC"], "leaves no cooling: after it CO2 has 32.51 kJ/kg more"),
        (
            [
                "gas.fluid=R407C.mix",
                "effects.cylinder_heat=off",
                "operation.gas_cooler={pressure: 20 bar, outlet_temperature: 47 degC}",
            ],
            "R407C.mix at 20 bar, 47 degC is wet: it lies between bubble and dew point",
        ),
        (["operation.gas_cooler.outlet_temperature=2000 degC"], "the equation of state of CO2 ends at 1726.85 degC"),
        (["sweep={operation.condensing_temperature: [20 degC]}"], "has no meaning with operation.gas_cooler"),
        (["operation.gas_cooler=null"], "condensing_temperature: is missing"),
        (
            ["operation.gas_cooler=null", "operation.condensing_temperature=35 degC"],
            "(lower it, or write operation.gas_cooler: {pressure: …, outlet_temperature: …} instead)",
        ),
    ],
)
def test_what_contradicts_a_gas_cooler_is_told_in_a_line(overrides, told):
    with pytest.raises(SceneError) as caught:
        scene(*overrides)
    (line,) = str(caught.value).splitlines()
    assert told in line


def test_a_gas_that_leaves_uncondensed_is_warned_of():
    (line,) = scene_warnings(scene("operation.gas_cooler={pressure: 60 bar, outlet_temperature: 30 degC}"))
    assert "leaves it as a gas" in line and line.startswith("operation.gas_cooler.outlet_temperature")


def test_an_economizer_lies_between_evaporator_and_gas_cooler():
    screw = CONFIG.parents[1] / "r454b" / "point.yaml"
    plant = [
        "gas.fluid=CO2",
        "operation={condensing_temperature: null, evaporating_temperature: -10 degC}",
        "operation.gas_cooler={pressure: 90 bar, outlet_temperature: 35 degC}",
    ]
    for T, told in (("-20 degC", "not between"), ("30.9 degC", "cooled")):
        port = f"effects.economizer={{area: 2 cm^2, opens: 1 rad, closes: 2 rad, temperature: {T}}}"
        with pytest.raises(SceneError, match=told):
            load(screw, overrides=[*plant, port])
