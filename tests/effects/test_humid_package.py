"""Humid air through an air package: free air at the inlet's humidity, its water and its heat from inlet to outlet."""

from pathlib import Path

import pytest

import screwsim
from screwsim.study.datasheet import SheetOptions, sheet_of

AIR = Path(__file__).parents[2] / "configs" / "air"
SCENE = AIR / "humid_package.yaml"
R_A, R_W = 8.314462618 / 0.02896546, 8.314462618 / 0.018015268
P_1, T_1, P_2 = 1e5, 303.15, 8.5e5
ACCURACY = 3e-4
PACKAGE, KEPT = "effects.air_package", "effects.separator.cooler.discharge_temperature"
COLD = (f"{KEPT}=45 degC", "numerics.error=none")
HEATS = "oil_cooler_duty", "aftercooler_duty", "motor_loss", "fan_power"


def solved(*changes, scene=SCENE):
    result = screwsim.simulate(screwsim.load(scene, changes))
    assert result.status == "ok", result.message
    return result


@pytest.fixture(scope="module")
def shipped():
    return solved()


@pytest.fixture(scope="module")
def cold():
    """With so cold an oil that water condenses in separator and aftercooler, behind filter, valve and throttle."""
    return solved(*COLD, "effects.suction_throttle={pressure_ratio: 0.9}")


def coolprop():
    """Return CoolProp, whose import takes seconds: where a test asks it, not where all tests are read."""
    return pytest.importorskip("CoolProp.CoolProp")


def saturated(T):
    return coolprop().PropsSI("P", "T", T, "Q", 1, "Water")


def latent(T):
    """Return the latent heat [J/kg] of ideal vapour, by Clausius and Clapeyron."""
    return R_W * T**2 * (saturated(T + 0.01) - saturated(T - 0.01)) / (0.02 * saturated(T))


def ratio(p, p_v):
    return R_A / R_W * p_v / (p - p_v)


@pytest.mark.parametrize("which", ["shipped", "cold"])
def test_free_air_has_the_humidity_of_the_inlet_whatever_the_filter_takes(which, request):
    found = request.getfixturevalue(which).performance
    w = ratio(P_1, 0.6 * saturated(T_1))
    assert found.humidity_ratio == pytest.approx(w, rel=1e-4)
    assert found.intake_pressure < 0.97 * P_1
    R = (R_A + w * R_W) / (1.0 + w)
    flow = found.gas_mass_flow * R * T_1 / P_1  # all that was sucked, and the package kept or drained of it
    assert found.free_air_delivered == pytest.approx(flow, rel=1e-5)
    ideal = 3.5 * P_1 * flow * ((P_2 / P_1) ** (1.0 / 3.5) - 1.0)
    assert found.package_isentropic_efficiency == pytest.approx(ideal / found.package_input_power, rel=1e-5)


@pytest.mark.parametrize("which", ["shipped", "cold"])
def test_water_of_the_inlet_leaves_as_condensate_and_saturated_air(which, request):
    found = request.getfixturevalue(which).performance
    dry = found.gas_mass_flow / (1.0 + found.humidity_ratio)
    T_2 = found.package_discharge_temperature
    assert T_2 == pytest.approx(T_1 + 10.0)
    left = dry * ratio(P_2, saturated(T_2))  # at the package's outlet pressure, below that of the separator
    drained = found.condensate_flow + found.aftercooler_condensate_flow
    assert found.water_flow == pytest.approx(drained + left, rel=1e-4)
    assert found.package_vapour_flow == pytest.approx(left, rel=2e-4)
    assert found.package_dew_point == pytest.approx(T_2, abs=1e-6)
    behind = min(found.humidity_ratio, ratio(found.discharge_pressure, saturated(found.separator_temperature)))
    assert found.vapour_flow == pytest.approx(dry * behind, rel=2e-4)
    assert (found.condensate_flow > 0.0) == (which == "cold")


@pytest.mark.parametrize("which", ["shipped", "cold"])
def test_electrical_power_is_heat_and_enthalpy_of_air_vapour_and_condensate(which, request):
    found = request.getfixturevalue(which).performance
    c_p = 3.5 * R_A, coolprop().PropsSI("CP0MASS", "T", T_1, "P", 1e3, "Water")
    T, T_2 = found.separator_temperature, found.package_discharge_temperature
    dry = found.gas_mass_flow / (1.0 + found.humidity_ratio)
    air = dry * c_p[0] * (T_2 - T_1)
    vapour = found.package_vapour_flow * c_p[1] * (T_2 - T_1)
    condensate = found.condensate_flow * (c_p[1] * (T - T_1) - latent(T))
    condensate += found.aftercooler_condensate_flow * (c_p[1] * (T_2 - T_1) - latent(T_2))
    heat = sum(found[name] for name in HEATS)
    assert -condensate > 0.05 * found.package_input_power  # it counts
    assert found.package_input_power == pytest.approx(heat + air + vapour + condensate, rel=ACCURACY)
    assert found.package_heat == pytest.approx(heat, rel=ACCURACY)


@pytest.mark.parametrize("changes", [("gas.model=real", *COLD), (f"{PACKAGE}.state=unloaded", f"{KEPT}=35 degC")])
def test_heat_is_in_balance_with_a_real_gas_and_unloaded(changes):
    result = solved(*changes)
    found = result.performance
    assert found.package_heat == pytest.approx(sum(found[name] for name in HEATS), rel=ACCURACY)
    assert found.condensate_flow > 0.0
    assert any("below the pressure dew point" in each for each in result.warnings)
    if "gas.model=real" in changes:
        left = coolprop().HAPropsSI("W", "T", T_1 + 10.0, "P", P_2, "R", 1.0)
        dry = found.gas_mass_flow / (1.0 + found.humidity_ratio)
        assert found.package_vapour_flow == pytest.approx(dry * left, rel=0.01)
    else:
        blown = found.condensate_flow + found.vapour_flow
        assert found.water_flow == pytest.approx(blown, rel=1e-4)
        assert found.package_vapour_flow == found.aftercooler_condensate_flow == found.free_air_delivered == 0.0
        assert found.package_dew_point is None and "blows off" in result.notes["package_dew_point"]


def test_another_aftercooler_drains_at_the_outlet_of_the_package():
    found = solved(f"{PACKAGE}.aftercooler=null", "operation.aftercooler_temperature=40 degC", COLD[1]).performance
    assert found.package_discharge_temperature == found.separator_temperature
    dry = found.gas_mass_flow / (1.0 + found.humidity_ratio)
    left = found.vapour_flow - found.aftercooler_condensate_flow
    assert left == pytest.approx(dry * ratio(P_2, saturated(313.15)), rel=2e-4)


def test_ice_in_the_aftercooler_is_warned_of():
    result = solved("operation.suction.temperature=-15 degC", "gas.relative_humidity=1", COLD[1])
    assert any("-5.0 degC, and is modelled as liquid, not ice" in each for each in result.warnings)


def test_two_aftercoolers_are_one_too_many():
    with pytest.raises(screwsim.SceneError) as caught:
        screwsim.load(SCENE, ["operation.aftercooler_temperature=35 degC"])
    (line,) = caught.value.lines
    assert "operation.aftercooler_temperature:" in line and "remove one of the two" in line


def test_a_sheet_tells_of_the_water_of_humid_air_alone():
    humid = sheet_of(screwsim.load(SCENE, [f"{PACKAGE}.unloaded=null"]), SheetOptions())
    told, point = dict(humid.lines), humid.document["points"][0]
    assert humid.ok and "relative humidity 60 %" in told["inlet"]
    assert f"{3600.0 * point['aftercooler_condensate_flow']:.1f} in the aftercooler" in told["water"]
    assert f"{point['package_dew_point'] - 273.15:.1f} °C at the outlet" in told["water"]
    assert any("humid air" in note for note in humid.notes)
    none = sheet_of(screwsim.load(SCENE, [f"{PACKAGE}.unloaded=null", "gas.relative_humidity=0"]), SheetOptions())
    dry = sheet_of(screwsim.load(SCENE, [f"{PACKAGE}.unloaded=null", "gas.relative_humidity=null"]), SheetOptions())
    assert dry.lines == none.lines and dry.tables == none.tables and dry.notes == none.notes
    assert "water" not in dict(dry.lines) and not any("humid" in key for key in dry.document)
