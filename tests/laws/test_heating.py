"""Laws of heating: what the condenser takes against CoolProp's states, and the heat balance of the whole machine."""

import pytest
from CoolProp.CoolProp import PropsSI
from folders import CONFIGS
from scenes import RATED, make, run

from screwsim.build import build_gas, build_site
from screwsim.effects.base import Drawn
from screwsim.effects.economizer import economizer_figures
from screwsim.evaluate.performance import NO_POWER, NONE_DELIVERED, heating, parted
from screwsim.scene import lines, load, refrigerating_effect
from screwsim.simulate import simulate, simulate_many
from screwsim.solve.circuit import OPEN

LEFT = OPEN * 3e-4  # of the shaft power: what the search of the oil's temperature leaves open


@pytest.fixture(scope="module", params=["point", "separator"])
def machine(request):
    """A semi-hermetic machine without and with an oil cooler at work."""
    found = simulate(load(CONFIGS / "r134a" / f"{request.param}.yaml"), trace=False)
    assert found.status == "ok"
    return found.performance


def assert_heat_balance(p, lost=0.0):
    """Check that evaporator, shaft and motor bring what condenser and oil cooler take, less what is lost [W]."""
    brought = p.cooling_capacity + p.shaft_power + p.motor_loss - lost
    assert p.heating_capacity + p.oil_cooler_duty == pytest.approx(brought, abs=LEFT * p.shaft_power)


def test_the_condenser_cools_what_leaves_the_separator(machine):
    p = machine
    h_2 = PropsSI("H", "P", p.discharge_pressure, "T", p.separator_temperature, "R134a")
    h_3 = PropsSI("H", "T", 318.15, "Q", 0, "R134a")
    assert p.heating_capacity == pytest.approx(p.gas_mass_flow * (h_2 - h_3), rel=1e-7)
    assert p.heating_cop == pytest.approx(p.heating_capacity / p.shaft_power, rel=1e-12)
    assert p.electrical_heating_cop == pytest.approx(p.heating_capacity / p.electrical_power, rel=1e-12)


def test_evaporator_shaft_and_motor_bring_what_condenser_and_oil_cooler_take(machine):
    """The motor hangs in the suction gas; the oil's circuit is closed within 3e-4 of the shaft's power."""
    p = machine
    brought = p.cooling_capacity + p.shaft_power + p.motor_loss
    assert p.heating_capacity + p.oil_cooler_duty == pytest.approx(brought, abs=3e-4 * p.shaft_power)


def test_gas_that_condenses_in_the_separator_has_no_heat_left_to_count():
    """Its enthalpy there is not that of vapour, with which the heat balance would not close."""
    cold = ["oil_supply.temperature=60 degC", "effects.separator.ambient_loss=90 kW", "numerics.error=none"]
    found = simulate(load(CONFIGS / "r134a" / "point.yaml", cold), trace=False)
    assert found.status == "failed" and found.message.startswith("gas condenses in the separator")
    p = found.performance
    assert p.cooling_capacity > 0.0 and p.heating_capacity is p.heating_cop is p.electrical_heating_cop is None
    assert found.notes["heating_capacity"].startswith("gas condenses in the separator")


def test_heat_that_is_pushed_back_into_an_economizer_leaves_or_evaporates_liquid():
    """What leaves is told, warned of, and missing from the balance; what stays takes its cooling capacity."""
    port = "effects.economizer={temperature: 18 degC, opens: 420 deg, closes: 520 deg, area: 2 cm^2, backflow: %s}"
    machine = CONFIGS / "r134a" / "separator.yaml"
    away, kept = (
        simulate(load(machine, [port % word, "numerics.error=none"]), trace=False)
        for word in ("given_away", "evaporates")
    )
    heat = away.performance.economizer_heat_loss
    for p in (away.performance, kept.performance):
        assert_heat_balance(p, p.economizer_heat_loss)
    assert heat > 0.01 * away.performance.shaft_power and kept.performance.economizer_heat_loss == 0.0
    assert away.performance.cooling_capacity - kept.performance.cooling_capacity == pytest.approx(heat, rel=1e-9)
    assert [f"loses {heat:.3g} W" in " ".join(one.warnings) for one in (away, kept)] == [True, False]


@pytest.mark.parametrize("kind", ["heat_exchanger", "flash_tank"])
def test_the_balance_closes_with_an_economizer_of_an_ideal_gas(kind):
    """Its vapour has the real fluid's enthalpy above the liquid, as the suction gas has, and not the ideal gas's."""
    port = "effects.economizer={temperature: 18 degC, opens: 420 deg, closes: 520 deg, area: 1 cm^2, %s, kind: %s}"
    changes = ["gas.model=ideal", port % ("backflow: evaporates", kind), "numerics.error=none"]
    p = simulate(load(CONFIGS / "r134a" / "separator.yaml", changes), trace=False).performance
    assert p.economizer_mass_flow > 0.02 * p.gas_mass_flow and 0.0 < p.economizer_draw_ratio < 1.0
    assert_heat_balance(p)


@pytest.mark.parametrize("fluid", ["R134a", "R404A"])
def test_the_liquid_of_a_flash_tank_boils_at_the_pressure_of_its_vapour(fluid):
    """A pseudo-pure fluid boils half a kelvin below the dew point that is stated: its liquid has that temperature."""
    tank = {"temperature": "15 degC", "opens": "420 deg", "closes": "520 deg", "area": "1 cm^2", "kind": "flash_tank"}
    scene = make({**RATED, "gas.model": "real", "gas.fluid": fluid, "effects.economizer": tank})
    site, flash = build_site(scene, build_gas(scene)), scene.effects["economizer"].parameters
    p = PropsSI("P", "T", 288.15, "Q", 1, fluid)
    given = economizer_figures(flash, Drawn(1.0, 1.0, site.gas.vapour(p, 288.15), site, 0.0))  # more than there is
    h_s = PropsSI("H", "P", PropsSI("P", "T", 275.15, "Q", 1, fluid), "T", 285.15, fluid)
    h_c, h_x = PropsSI("H", "T", 318.15, "Q", 0, fluid), PropsSI("H", "P", p, "Q", 0, fluid)
    assert given["economizer_capacity_gain"] == pytest.approx((h_c - h_x) / (h_s - h_c), rel=1e-9)


def test_heat_that_is_pushed_back_beyond_what_the_vapour_takes_leaves_and_is_told():
    """A port that draws next to nothing: its liquid cannot take all of that heat, and the balance says what is left."""
    port = "effects.economizer={temperature: 18.7 degC, opens: 470 deg, closes: 560 deg, area: 2 cm^2}"
    kept = "effects.economizer.backflow=evaporates", "numerics.error=none"
    found = simulate(load(CONFIGS / "r134a" / "separator.yaml", [port, *kept]), trace=False)
    p = found.performance
    assert p.economizer_mass_flow > 0.0 > p.economizer_draw_ratio and p.economizer_capacity_gain == 0.0
    assert_heat_balance(p, p.economizer_heat_loss)
    assert p.economizer_heat_loss > 0.005 * p.shaft_power
    assert any(warning.endswith("(close the port earlier)") for warning in found.warnings)


@pytest.mark.parametrize("backflow", ["given_away", "evaporates"])
def test_the_balance_closes_where_an_economizer_gets_more_gas_than_it_gives(backflow):
    """What the chambers leave there reaches the evaporator as liquid: it costs the heat of its condensing."""
    port = "effects.economizer={temperature: 5 degC, opens: 470 deg, closes: 560 deg, area: 2 cm^2}"
    changes = [port, f"effects.economizer.backflow={backflow}", "numerics.error=none"]
    found = simulate(load(CONFIGS / "r134a" / "separator.yaml", changes), trace=False)
    p = found.performance
    assert p.economizer_mass_flow < -0.01 * p.gas_mass_flow and p.economizer_capacity_gain < 0.0
    # that its heat evaporates liquid would change nothing, as none is drawn
    assert any(warning.endswith("of the shaft power (close the port earlier)") for warning in found.warnings)
    assert_heat_balance(p, p.economizer_heat_loss)


def test_the_balance_closes_where_a_port_draws_more_vapour_than_the_liquid_gives_off():
    """Nothing else evaporates the rest than the condenser: with vapour from nothing the heating COP was too good."""
    port = "effects.economizer={temperature: 30 degC, opens: 400 deg, closes: 480 deg, area: 2 cm^2}"
    p = simulate(load(CONFIGS / "r134a" / "separator.yaml", [port, "numerics.error=none"]), trace=False).performance
    assert p.economizer_draw_ratio > 1.5 and p.economizer_heat_lacking > 0.1 * p.shaft_power
    assert_heat_balance(p, p.economizer_heat_loss)


@pytest.mark.parametrize("closes", [600, 640])
def test_the_balance_closes_where_gas_is_pushed_back_into_the_liquid_line(closes):
    """Chambers above the condenser's pressure: what they push back condenses in the line, and its heat is told."""
    port = f"effects.liquid_injection={{opens: {closes - 80} deg, closes: {closes} deg, area: 20 mm^2}}"
    changes = [port, "operation.condensing_temperature=20 degC", "numerics.error=none"]
    found = simulate(load(CONFIGS / "r134a" / "separator.yaml", changes), trace=False)
    p = found.performance
    assert p.liquid_injection_heat_loss > 0.01 * p.shaft_power
    text = "gas that chambers push back into the liquid line loses"
    told = [warning for warning in found.warnings if text in warning]
    assert len(told) == 1 and told[0].endswith("of the shaft power (close the port earlier)")
    assert_heat_balance(p, p.liquid_injection_heat_loss)


def test_an_ideal_gas_without_a_separator_gives_off_what_it_left_the_chambers_with():
    p, scene = run(RATED).performance, make(RATED)
    warmed = build_gas(scene).c_p * (p.discharge_temperature - lines(scene).T_s)
    rejected = refrigerating_effect(scene) + warmed
    assert p.heating_capacity == pytest.approx(p.gas_mass_flow * rejected, rel=1e-9)


def test_a_gas_cooler_gives_heat_as_a_condenser_does():
    p = simulate(load(CONFIGS / "co2" / "transcritical.yaml"), trace=False).performance
    ends = [PropsSI("H", "P", 90e5, "T", T, "CO2") for T in (p.discharge_temperature, 308.15)]
    assert p.heating_capacity == pytest.approx(p.gas_mass_flow * (ends[0] - ends[1]), rel=1e-6)


def test_oil_so_cold_that_what_leaves_the_separator_is_liquid_fails_its_case_alone():
    scenes = [load(CONFIGS / "r134a" / "point.yaml", [f"oil_supply.temperature={T}"]) for T in ("-50 degC", "57 degC")]
    cold, warm = simulate_many(scenes, trace=False)
    assert (cold.status, warm.status) == ("failed", "ok")
    assert "R134a condenses at" in cold.message and "use warmer oil" in cold.message


def test_its_error_is_told_and_small():
    scene = load(CONFIGS / "r134a" / "point.yaml")
    error = simulate(scene, trace=False).error
    assert 0.0 < error.heating_capacity < 3e-4 and 0.0 < error.heating_cop < 3e-4


def test_pressures_alone_and_an_expander_call_for_no_heating():
    names = {"heating_capacity", "heating_cop"}
    assert not names & {*run().performance}
    expander = simulate(load(CONFIGS / "expander" / "point.yaml"), trace=False)
    assert expander.status == "ok" and not names & {*expander.performance}


@pytest.mark.parametrize(
    ("flow", "power", "rejected", "capacity", "reasons"),
    [
        (-0.01, 5e3, 180e3, None, dict.fromkeys(("heating_capacity", "heating_cop"), NONE_DELIVERED)),
        (0.4, 5e3, "gas condenses", None, dict.fromkeys(("heating_capacity", "heating_cop"), "gas condenses")),
        (0.4, -5e3, 180e3, 72e3, {"heating_cop": NO_POWER}),
    ],
)
def test_what_cannot_heat_says_why(flow, power, rejected, capacity, reasons):
    found, notes = parted(heating({"shaft_power": power}, flow, rejected))
    assert found["heating_capacity"] == (None if capacity is None else pytest.approx(capacity))
    assert found["heating_cop"] is None and notes == reasons
