"""Saturated suction gas, 0 K of superheat: what is meant by it, and an ammonia screw on a flooded evaporator."""

from pathlib import Path

import pytest
from CoolProp.CoolProp import PropsSI
from each_row import each_row

from screwsim.fluid.real_gas import RealGas
from screwsim.scene import load
from screwsim.scene.lines import lines
from screwsim.simulate import simulate

CONFIG = Path(__file__).parents[2] / "configs" / "ammonia" / "flooded.yaml"
WET = ["operation.superheat=null"]


@pytest.fixture(scope="module")
def found():
    return simulate(load(CONFIG))


def test_the_flooded_machine_has_the_capacity_of_coolprops_states(found):
    assert found.status == "ok" and not found.warnings
    q_0 = PropsSI("H", "T", 263.15, "Q", 1, "Ammonia") - PropsSI("H", "T", 308.15, "Q", 0, "Ammonia")
    p = found.performance
    assert p.cooling_capacity == pytest.approx(p.gas_mass_flow * q_0, rel=1e-7)
    rho = PropsSI("D", "T", 263.15, "Q", 1, "Ammonia")
    swept = p.gas_mass_flow / (rho * p.volumetric_efficiency)
    assert swept == pytest.approx(p.displacement_flow, rel=1e-6)


def test_no_superheat_is_saturated_vapour(found):
    """1e-6 K keeps round-off from making a liquid of it; beside quality 1 that is a share of 1e-8 of the flow."""
    vapour = simulate(load(CONFIG, overrides=[*WET, "operation.suction.quality=1"]), trace=False)
    for name in ("gas_mass_flow", "shaft_power", "cop"):
        assert found.performance[name] == pytest.approx(vapour.performance[name], rel=1e-6)


def test_droplets_from_the_evaporator_go_on_from_there(found):
    """A mass fraction of 1e-4 is evaporated by the oil; it adds itself to the flow and changes little else."""
    damp = simulate(load(CONFIG, overrides=[*WET, "operation.suction.quality=0.9999"]), trace=False)
    assert damp.status == "ok"
    assert damp.performance.gas_mass_flow == pytest.approx(found.performance.gas_mass_flow, rel=5e-4)
    assert damp.performance.gas_mass_flow > found.performance.gas_mass_flow


@each_row("two_phase", ["refuse", "equilibrium"])
@each_row("fluid", ["Ammonia", "R134a", "CO2"])
@each_row("T", [230.0, 263.15, 300.0])
def test_saturated_vapour_is_never_taken_for_a_liquid(fluid, T, two_phase):
    overrides = [f"gas.fluid={fluid}", f"gas.two_phase={two_phase}", f"operation.evaporating_temperature={T} K"]
    overrides += ["operation.condensing_temperature=303 K"]
    at = lines(load(CONFIG, overrides=overrides))
    port_state = RealGas(fluid, two_phase).port_state(at.p_s, at.T_s)
    assert port_state[1] == pytest.approx(PropsSI("D", "T", T, "Q", 1, fluid), rel=1e-6)


def test_superheat_over_a_stated_pressure_may_be_none_too():
    states = ["operation={evaporating_temperature: null, condensing_temperature: null, superheat: null}"]
    states += ["operation.suction={pressure: 2.9 bar, superheat: 0 K}", "operation.discharge.pressure=13.5 bar"]
    at = lines(load(CONFIG, overrides=states))
    assert at.T_s == pytest.approx(PropsSI("T", "P", 2.9e5, "Q", 1, "Ammonia"), abs=1e-5)
