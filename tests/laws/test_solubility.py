"""Oil from a pump through a port, and the refrigerant that flashes out of it: balances, both closings, and limits."""

import numpy as np
import pytest
from scenes import DROP, PUMPED_PORT, SOLUBLE, balanced, make, refusal, run

from screwsim.explain import explain
from screwsim.fluid.solubility_laws import ESTER

FIGURES = ("gas_mass_flow", "shaft_power", "discharge_temperature", "trapped_mass", "oil_mass_flow")
ACCURACY = 3e-4
# so cold and lean that it could take up more gas where it enters
UNSATURATED = {
    "oil_supply.temperature": "280 K",
    "effects.refrigerant_solubility.separator_temperature": "370 K",
}
LIVES = 4 * 50.0  # per second


@pytest.mark.parametrize("changes", [PUMPED_PORT, SOLUBLE], ids=["pump", "flash"])
def test_mass_energy_and_entropy_close(changes):
    balanced(run(changes), "oil_mass")


def test_the_pump_delivers_its_ratio_of_the_trapped_gas():
    found = run(PUMPED_PORT).performance
    assert found.oil_mass_flow == pytest.approx(3.0 * found.trapped_mass * LIVES, rel=ACCURACY)


def test_a_pump_injects_against_any_pressure():
    late = run({**PUMPED_PORT, "effects.oil_injection": {"opens": "600 deg", "closes": "690 deg"}}).performance
    assert late.oil_mass_flow == pytest.approx(3.0 * late.trapped_mass * LIVES, rel=ACCURACY)
    assert late.injection_pressure > 2.0 * run(PUMPED_PORT).performance.injection_pressure


def test_coupled_chambers_agree_with_histories():
    together = run({**SOLUBLE, "numerics": {"closing": "coupled", "error": "none"}}).performance
    for name in (*FIGURES, "flash_mass_flow"):
        assert together[name] == pytest.approx(run(SOLUBLE).performance[name], rel=ACCURACY), name


def test_the_flash_is_what_the_supplied_oil_cannot_hold():
    found = run(SOLUBLE).performance
    assert found.dissolved_gas_ratio == pytest.approx(ESTER.content(found.discharge_pressure, 345.0), rel=1e-6)
    per_oil = found.flash_mass_flow / found.oil_mass_flow
    assert 0.5 * found.dissolved_gas_ratio < per_oil < found.dissolved_gas_ratio
    assert found.flash_flow_ratio == pytest.approx(found.flash_mass_flow / found.gas_mass_flow, rel=1e-9)


def test_gas_that_flashes_while_the_port_is_open_is_none_of_the_port():
    result = run({**SOLUBLE, "effects.oil_injection": {"opens": "250 deg", "closes": "340 deg"}})
    cycle, found = result.cycle, result.performance
    time = np.radians(cycle["angle"]) / (2.0 * np.pi * 50.0)
    drawn = LIVES * float(np.trapezoid(cycle["mass_flow_suction_port"], time))
    assert found.flash_mass_flow > 0.1 * found.gas_mass_flow
    assert drawn == pytest.approx(found.gas_mass_flow, rel=ACCURACY)
    assert result.balance.entropy < 1e-5


def test_flashing_gas_costs_power_and_volumetric_efficiency():
    with_gas = run(SOLUBLE).performance
    without = run({**SOLUBLE, "effects.refrigerant_solubility": DROP}).performance
    assert with_gas.volumetric_efficiency < without.volumetric_efficiency
    assert with_gas.isentropic_efficiency < 0.97 * without.isentropic_efficiency


def test_oil_that_could_hold_more_brings_nothing():
    lean = run({**SOLUBLE, **UNSATURATED}).performance
    without = run({**SOLUBLE, "oil_supply.temperature": "280 K", "effects.refrigerant_solubility": DROP}).performance
    assert lean.flash_mass_flow == 0.0
    for name in FIGURES:
        assert lean[name] == pytest.approx(without[name], rel=ACCURACY), name


def test_explain_names_plenum_and_equations():
    text = " ".join(str(explain(make(SOLUBLE))).split())
    assert "M195, M196, M197" in text
    assert "plenum oil_gas" in text


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({**SOLUBLE, "effects.oil_injection": DROP}, "needs effects.oil_injection"),
        ({**SOLUBLE, "gas.fluid": "R1234yf"}, "covers R134a in POE oil only"),
        (
            {**SOLUBLE, "oil": {"name": "mineral_46", "transport": "carried"}},
            "oil.name: is mineral_46, and effects.refrigerant_solubility knows what polyol esters dissolve",
        ),
        (
            {**SOLUBLE, "effects.refrigerant_solubility.separator_temperature": "310 K"},
            "at 36.85 degC the gas condenses in the separator, at 12 bar",
        ),
        (
            {**SOLUBLE, "effects.refrigerant_solubility.separator_temperature": "400 K"},
            "lies outside -18.15 degC to 96",
        ),
    ],
)
def test_what_does_not_go_together_is_said(changes, words):
    assert words in refusal(changes)
