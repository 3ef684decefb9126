"""The air package: ISO 1217's figures, losses that follow from the flow, heat and power in balance, what is refused."""

from pathlib import Path
from types import SimpleNamespace

import pytest
from each_row import each_row

import screwsim
from screwsim.effects.air_package import (
    Aftercooler,
    Fan,
    MinimumPressureValve,
    Parameters,
    PressureLoss,
    Unloaded,
    read,
)
from screwsim.effects.base import PressureLosses
from screwsim.effects.parts.coolant import FLOW, NO_HEAT, RISE, Coolant
from screwsim.inputs.faults import QuantityNotFound
from screwsim.simulate import simulate_many

SCENE = Path(__file__).parents[2] / "configs" / "air" / "fixed_speed_7.yaml"
R, K = 8.31446261815324 / 28.96546e-3, 1.4  # of air
CLOSED = 3e-5  # of a pressure: what the losses may leave open, a tenth of the wanted accuracy
ACCURACY = 3e-4
PACKAGE = "effects.air_package"
TIGHT = f"{PACKAGE}.rated_flow=6 m^3/min"  # filter and valve take nine times as much
PLAIN = "numerics.error=none"


def solved(*changes):
    result = screwsim.simulate(screwsim.load(SCENE, changes))
    assert result.status == "ok", result.message
    return result


@pytest.fixture(scope="module")
def shipped():
    return solved()


@pytest.fixture(scope="module")
def unloaded():
    return solved(f"{PACKAGE}.state=unloaded")


def test_figures_are_those_of_iso_1217(shipped):
    found = shipped.performance
    p_1, T_1, p_2 = 1e5, 293.15, 8.5e5
    flow = found.gas_mass_flow * R * T_1 / p_1
    assert found.free_air_delivered == pytest.approx(flow, rel=1e-5)  # R as CoolProp has it
    loss = (1.0 / 0.963 - 1.0) * 110e3 * (0.4 + 0.6 * (found.shaft_power / 110e3) ** 2)
    assert found.package_input_power == pytest.approx(found.shaft_power + loss + 4400.0, rel=1e-12)
    assert found.package_specific_power == pytest.approx(found.package_input_power / flow, rel=1e-5)
    ideal = 3.5 * p_1 * flow * ((p_2 / p_1) ** (1.0 / 3.5) - 1.0)
    assert found.package_isentropic_efficiency == pytest.approx(ideal / found.package_input_power, rel=1e-5)


@pytest.mark.parametrize("changes", [(), (TIGHT, PLAIN)])
def test_losses_go_with_the_square_of_the_flow_that_they_leave(shipped, changes):
    found = solved(*changes).performance if changes else shipped.performance
    share = (found.free_air_delivered / (6.0 / 60.0 if changes else 18.4 / 60.0)) ** 2
    assert found.intake_pressure == pytest.approx(1e5 - share * 35e2, abs=CLOSED * 1e5)
    assert found.discharge_pressure == pytest.approx(8.5e5 + share * 360e2, abs=CLOSED * 8.5e5)
    assert found.intake_pressure_loss == pytest.approx(1e5 - found.intake_pressure, abs=1e-6)
    assert found.package_pressure_loss == pytest.approx(found.discharge_pressure - 8.5e5, abs=1e-6)
    assert found.package_discharge_pressure == pytest.approx(8.5e5, rel=1e-12)


@pytest.mark.parametrize("changes", [(), (TIGHT, PLAIN)])
def test_the_machine_is_one_between_throttle_and_higher_discharge(shipped, changes):
    found = solved(*changes).performance if changes else shipped.performance
    throttle = f"effects.suction_throttle={{pressure_ratio: {found.intake_pressure / 1e5!r}}}"
    alone = solved(
        f"{PACKAGE}=off", throttle, f"operation.discharge.pressure={float(found.discharge_pressure)!r} Pa", *changes[1:]
    )
    for name in ("gas_mass_flow", "shaft_power", "oil_mass_flow", "oil_cooler_duty", "isentropic_efficiency"):
        assert found[name] == pytest.approx(alone.performance[name], rel=2.0 * ACCURACY), name


@pytest.mark.parametrize("changes", [(), (f"{PACKAGE}.fan.control=flow", "effects.separator.ambient_loss=2 kW", PLAIN)])
def test_electrical_power_is_heat_and_the_enthalpy_of_the_air(shipped, changes):
    found = solved(*changes).performance if changes else shipped.performance
    c_p, lost = K / (K - 1.0) * R, 2000.0 if changes else 0.0
    rise = found.gas_mass_flow * c_p * (found.package_discharge_temperature - 293.15)
    heats = found.oil_cooler_duty + found.aftercooler_duty + found.motor_loss + found.fan_power + lost
    assert found.package_input_power == pytest.approx(heats + rise, rel=ACCURACY)
    assert found.package_heat == pytest.approx(heats, rel=ACCURACY)
    assert found.package_discharge_temperature == pytest.approx(303.15)


def test_a_minimum_pressure_valve_keeps_the_separator_up():
    found = solved("operation.discharge.pressure=3 bar", PLAIN).performance
    share = (found.free_air_delivered / (18.4 / 60.0)) ** 2
    assert found.discharge_pressure == pytest.approx(5e5 + share * 172e2, abs=CLOSED * 5e5)
    assert found.package_discharge_pressure == pytest.approx(3e5)


def test_an_unloaded_package_takes_power_and_delivers_nothing(unloaded):
    found = unloaded.performance
    assert found.free_air_delivered == 0.0
    assert (found.intake_pressure, found.discharge_pressure) == pytest.approx((0.12e5, 2.5e5))
    assert found.gas_mass_flow > 0.0  # which is blown off
    for name in ("package_specific_power", "package_isentropic_efficiency", "package_discharge_temperature"):
        assert found[name] is None
        assert "unloaded" in unloaded.notes[name]
    for name in ("isothermal_efficiency", "electrical_isentropic_efficiency", "specific_power"):
        assert found[name] is None  # of gas that nobody gets
        assert "blown off" in unloaded.notes[name]
    assert 0.0 < found.volumetric_efficiency < 0.2  # of the chambers, as any flow
    blown = found.gas_mass_flow * K / (K - 1.0) * R * (found.separator_temperature - 293.15)
    heats = found.oil_cooler_duty + found.motor_loss + found.fan_power
    assert found.package_input_power == pytest.approx(heats + blown, rel=ACCURACY)


def test_a_course_of_speeds_finds_what_each_finds_alone(shipped):
    before = [f"operation.speed={speed} rpm" for speed in (1500, 2200)]
    scenes = [
        screwsim.load(SCENE, [each]) for each in (*before, f"{PACKAGE}.state=unloaded", "operation.speed=2950 rpm")
    ]
    last = list(simulate_many(scenes, trace=False))[-1].performance
    for name in ("free_air_delivered", "package_input_power", "discharge_pressure", "intake_pressure"):
        assert last[name] == pytest.approx(shipped.performance[name], rel=2.0 * ACCURACY), name


def test_throttle_and_package_share_one_entry_of_the_ledger_each():
    both = solved("effects.suction_throttle={pressure_ratio: 0.9}")
    one, other = (both.ledger[f"exergy_destroyed_{name}"] for name in ("air_package", "suction_throttle"))
    assert 0.0 < one < other
    assert both.balance.entropy <= both.balance.bound
    assert both.performance.intake_pressure == pytest.approx(0.9 * (1e5 - both.performance.intake_pressure_loss))


def test_parts_add_up_in_the_order_of_the_flow():
    parts = Parameters(
        rated_flow=0.3,
        inlet_filter=PressureLoss(pressure_loss=20e2),
        separator_element=PressureLoss(pressure_loss=170e2),
        minimum_pressure_valve=MinimumPressureValve(pressure_loss=50e2, pressure=5e5),
        unloaded=Unloaded(intake_pressure=0.1e5, separator_pressure=2e5),
    )
    assert parts.losses(0.6, 1e5, 8e5) == pytest.approx((80e2, 880e2))
    assert parts.losses(0.15, 1e5, 4e5) == pytest.approx((5e2, 1e5 + 42.5e2))
    assert Parameters(rated_flow=0.3).losses(0.6, 1e5, 8e5) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("fluid", "flow", "power", "words"),
    [("R134a", 0.3, 1e5, "power for air"), ("Air", -0.1, 1e5, "no net gas"), ("Air", 0.3, -1e5, "not positive")],
)
def test_figures_that_mean_nothing_say_why(fluid, flow, power, words):
    found = {"gas_mass_flow": flow, "suction_pressure": 1e5, "discharge_pressure": 8e5, "suction_temperature": 293.15}
    losses = PressureLosses(0.0, 0.0)
    known = SimpleNamespace(found=found | {"electrical_power": power}, package=losses, fluid=fluid, suction_density=1.2)
    given = read(Parameters(rated_flow=0.3, fan=Fan(power=1e3)), known)
    assert words in given["package_isentropic_efficiency"]


@pytest.mark.parametrize(("coolant", "leaves"), [(None, 30.0), ("8 degC", 18.0), ("90 degC", 80.0)])
def test_the_approach_of_an_aftercooler_is_to_its_coolant_or_to_the_air_at_the_inlet(coolant, leaves):
    """Inlet 20 °C, separator 80 °C, approach 10 K; a warm coolant heats nothing."""
    stated = [] if coolant is None else [f"{PACKAGE}.aftercooler.coolant_temperature={coolant}"]
    found = solved(*stated, PLAIN).performance
    assert found.package_discharge_temperature == pytest.approx(leaves + 273.15, abs=0.01)
    assert found.aftercooler_duty == pytest.approx(found.gas_mass_flow * 1006.0 * (80.0 - leaves), rel=0.01, abs=1.0)


def test_a_gas_that_condenses_behind_the_aftercooler_has_no_temperature_there_and_says_why():
    def liquid(p, T):
        raise QuantityNotFound(f"R134a at {p:g} Pa, {T:g} K is liquid")

    lines = {"suction_pressure": 3e5, "suction_temperature": 285.0, "discharge_pressure": 12e5}
    found = lines | {"separator_temperature": 340.0, "gas_mass_flow": 0.2, "electrical_power": 20e3}
    cold = SimpleNamespace(enthalpy=liquid)
    known = SimpleNamespace(
        found=found, package=PressureLosses(0.0, 0.0), fluid="R134a", suction_density=12.0,
        enthalpy=lambda p, T: 1e3 * T, drained=lambda p, T: (1.0, cold),
    )  # fmt: skip
    given = read(Parameters(rated_flow=0.3, aftercooler=Aftercooler(approach=10.0, pressure_loss=0.0)), known)
    assert given["package_discharge_temperature"] == "behind the aftercooler R134a at 1.2e+06 Pa, 340 K is liquid"
    assert given["package_input_power"] == 20e3


@each_row(
    ("changes", "path", "words"),
    [
        (["effects.motor=off"], PACKAGE, "needs effects.motor"),
        (["machine.mode=expander"], PACKAGE, "compressor"),
        (["effects.separator=off", "oil_supply.temperature=325 K"], f"{PACKAGE}.aftercooler", "effects.separator"),
        ([f"{PACKAGE}.rated_flow=0 m^3/min"], f"{PACKAGE}.rated_flow", "greater than 0"),
        ([f"{PACKAGE}.rated_flow=18"], f"{PACKAGE}.rated_flow", "20 m^3/min"),
        ([f"{PACKAGE}.inlet_filter.pressure_loss=0.6 bar"], f"{PACKAGE}.inlet_filter.pressure_loss", "less than half"),
        ([f"{PACKAGE}.state=unloaded", f"{PACKAGE}.unloaded=null"], f"{PACKAGE}.unloaded", "intake_pressure: 0.12 bar"),
        ([f"{PACKAGE}.unloaded.intake_pressure=1.2 bar"], f"{PACKAGE}.unloaded.intake_pressure", "only lower"),
        ([f"{PACKAGE}.unloaded.separator_pressure=0.1 bar"], f"{PACKAGE}.unloaded.separator_pressure", "above"),
        (
            [f"{PACKAGE}.seperator_element={{pressure_loss: 1 bar}}"],
            f"{PACKAGE}.seperator_element",
            "separator_element",
        ),
    ],
)
def test_what_cannot_be_is_refused_at_its_line(changes, path, words):
    with pytest.raises(screwsim.SceneError) as caught:
        screwsim.load(SCENE, changes)
    lines = [line for line in caught.value.lines if f"{path}:" in line]
    assert len(lines) == 1, caught.value.lines
    assert words in lines[0]


C_P = K / (K - 1.0) * R


def test_cooling_air_takes_all_heat_and_flow_and_rise_follow_from_one_another():
    by_rise = solved(PLAIN, f"{PACKAGE}.coolant={{temperature_rise: 12 K}}").performance
    flow = by_rise.package_heat / (1e5 / (R * 293.15) * C_P * 12.0)
    assert by_rise.coolant_flow == pytest.approx(flow, rel=2e-3)  # c_p of air is 0.1 % more than that of k = 1.4
    assert by_rise.coolant_temperature_rise == 12.0
    by_flow = solved(PLAIN, f"{PACKAGE}.coolant={{flow: {float(by_rise.coolant_flow)!r} m^3/s}}").performance
    assert by_flow.coolant_temperature_rise == pytest.approx(12.0, rel=1e-9)


def test_cooling_water_takes_the_heat_of_both_coolers():
    found = solved(PLAIN, f"{PACKAGE}.coolant={{medium: water, flow: 6 m^3/h}}", f"{PACKAGE}.fan=null").performance
    heat = found.oil_cooler_duty + found.aftercooler_duty
    assert heat < found.package_heat
    assert found.coolant_temperature_rise == pytest.approx(heat / (997.0 * 4182.0 * 6.0 / 3600.0), rel=1e-12)


def test_the_sheet_tells_what_carries_the_heat_away():
    scene = screwsim.load(SCENE, [PLAIN, f"{PACKAGE}.coolant={{temperature_rise: 15 K}}"])
    metric, us = (screwsim.datasheet(scene, units=units) for units in ("metric", "us"))
    flow = metric.document["points"][0]["coolant_flow"]
    assert dict(metric.lines)["coolant"] == f"{3600.0 * flow:.0f} m³/h of air, warmed by 15 K, at full flow"
    assert dict(us.lines)["coolant"].endswith(" cfm of air, warmed by 27 °F, at full flow")


@pytest.mark.parametrize(
    ("stated", "what"),
    [
        ("{}", "needs one of temperature_rise and flow"),
        ("{flow: 1 m^3/s, temperature_rise: 5 K}", "needs one of temperature_rise and flow"),
        ("{medium: oil, flow: 1 m^3/s}", "is not an option"),
    ],
)
def test_a_coolant_states_one_of_flow_and_rise(stated, what):
    with pytest.raises(screwsim.SceneError, match=what):
        screwsim.load(SCENE, [f"{PACKAGE}.coolant={stated}"])


def test_a_later_stage_is_not_cooled_by_air_of_its_inlet():
    """Its density is not that of a room."""
    inlet, warmed = "operation.suction.pressure=3 bar", f"{PACKAGE}.coolant.temperature_rise=15 K"
    told = r"coolant\.medium: is air of the inlet's state, and no room has 3 bar"
    with pytest.raises(screwsim.SceneError, match=told):
        screwsim.load(SCENE, [inlet, warmed])
    screwsim.load(SCENE, [inlet, f"{PACKAGE}.coolant.medium=water", warmed])


@pytest.mark.parametrize(
    ("stated", "least"), [("flow: 0.8 m^3/h", True), ("flow: 6 m^3/h", False), ("flow: 1.6 m^3/h", False)]
)
def test_a_coolant_that_would_leave_hotter_than_the_separator_is_warned_of(stated, least):
    """Inlet 20 °C, separator 80 °C: it can become warmer by 60 K."""
    found = solved(PLAIN, f"{PACKAGE}.coolant={{medium: water, {stated}}}")
    told = [each for each in found.warnings if "would leave hotter than the separator is, 60 K above" in each]
    assert bool(told) == (found.performance.coolant_temperature_rise > 60.0) == least


def test_no_heat_has_no_flow_and_says_why():
    assert Coolant(temperature_rise=5.0).figures(-1.0, 1200.0) == dict.fromkeys((FLOW, RISE), NO_HEAT)
    assert Coolant(temperature_rise=5.0).figures("unknown", 1200.0) == dict.fromkeys((FLOW, RISE), "unknown")


@pytest.mark.parametrize(
    ("cooler", "fan", "warns"),
    [
        ("outlet_temperature: 15 degC", "{power: 2 kW}", True),
        ("outlet_temperature: 45 degC", "{power: 2 kW}", False),
        ("outlet_temperature: 15 degC", "null", False),  # of water, whose temperature is not stated
        ("discharge_temperature: 60 degC, conductance: 60 kW/K, coolant_temperature: 5 degC", "{power: 2 kW}", False),
    ],
)
def test_oil_colder_than_the_air_that_cools_it_is_warned_of(cooler, fan, warns):
    """Inlet 20 °C."""
    kept = "outlet_temperature: null, discharge_temperature: null, conductance: null, coolant_temperature: null"
    stated = {
        **dict(each.split(": ") for each in kept.split(", ")),
        **dict(each.split(": ") for each in cooler.split(", ")),
    }
    values = ", ".join(f"{name}: {value}" for name, value in stated.items())
    sets = PLAIN, f"effects.separator.cooler={{{values}}}", f"{PACKAGE}.fan={fan}"

    def told(*sets):
        return any(
            "below the 20.0 degC of the air with which the fan cools it" in each for each in solved(*sets).warnings
        )

    assert told(*sets) == warns
    assert not told(*sets, f"{PACKAGE}.coolant={{medium: water, temperature_rise: 10 K}}")
