"""Ports of effects: vapour and liquid from plenums of their own, oil through a bore; balances, limits, Radau."""

import math

import numpy as np
import pytest
from each_row import each_row
from known_figures import known_solution
from scenes import DROP, ECONOMIZER, OIL_PORT, OIL_VOLUME, PUMPED_PORT, RADAU, TOGETHER, balanced, change, make, run

from screwsim import load
from screwsim.fluid import constants
from screwsim.fluid.orifice import discharge_coefficient
from screwsim.inputs.faults import SceneError
from screwsim.scene import loads
from screwsim.simulate import simulate

CONFIG = "tests/plain/r134a.yaml"
LIQUID = ["gas.two_phase=equilibrium", "effects.liquid_injection={opens: 500 deg, closes: 600 deg, area: 4 mm^2}"]
ACCURACY = 3e-4
CARRIED = {"oil.transport": "carried"}
AT_PRESSURE = {**ECONOMIZER, "effects.economizer.temperature": DROP, "effects.economizer.pressure": "4 bar"}
CASES = {"economizer": ECONOMIZER, "oil port": OIL_PORT, "oil volume": OIL_VOLUME, "together": TOGETHER}


@pytest.fixture(scope="module")
def liquid(pytestconfig):
    return simulate(load(pytestconfig.rootpath / CONFIG, LIQUID))


@pytest.mark.parametrize("case", CASES)
def test_mass_energy_entropy_and_oil_are_kept(case):
    result = run(CASES[case])
    assert result.status == "ok"
    assert max(result.balance[name] for name in ("mass", "energy", "entropy", "oil_mass")) <= ACCURACY
    assert abs(result.ledger.relative_residue) <= ACCURACY


def test_mass_energy_and_entropy_are_kept_with_liquid(liquid):
    assert liquid.status == "ok"
    assert max(liquid.balance[name] for name in ("mass", "energy", "entropy")) <= ACCURACY


@pytest.mark.parametrize("case", ["economizer", "together"])
def test_both_closings_find_one_cycle(case):
    assert (
        change(run(CASES[case]), run({**CASES[case], "numerics": {"closing": "coupled", "error": "none"}})) < ACCURACY
    )


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_radau_finds_the_same(case):
    assert change(run(CASES[case]), known_solution(make({**CASES[case], "numerics": RADAU}))) < ACCURACY


# ---- economizer ----------------------------------------------------------------------------------------------------


def test_a_port_of_no_area_is_none():
    tiny = run({**ECONOMIZER, "effects.economizer.area": "1e-6 mm^2"})
    assert change(tiny, run(CARRIED)) < ACCURACY
    assert abs(tiny.performance.economizer_flow_ratio) < 1e-6


def test_what_the_discharge_line_takes_is_what_both_give():
    result = run(ECONOMIZER)
    angle, flows = result.cycle["angle"], result.cycle["mass_flow_economizer"]
    window = (angle > 380.0) & (angle < 480.0)
    assert (flows[~window] == 0.0).all()
    lives = 4 * 3000 / 60
    drawn = np.trapezoid(flows, np.radians(angle)) / (2 * math.pi * 3000 / 60) * lives
    assert drawn == pytest.approx(result.performance.economizer_mass_flow, rel=1e-3)  # trapezium of one degree
    assert result.ledger.gas_moved_economizer == pytest.approx(result.performance.economizer_mass_flow, rel=1e-4)


def test_economizer_gas_costs_power_and_hardly_any_suction():
    with_port, without = run(ECONOMIZER).performance, run(CARRIED).performance
    assert with_port.shaft_power > without.shaft_power
    assert 0.95 < with_port.gas_mass_flow / without.gas_mass_flow < 1.0


def test_a_port_before_suction_closes_robs_the_suction_line():
    early = run({**ECONOMIZER, "effects.economizer.opens": "250 deg", "effects.economizer.closes": "350 deg"})
    assert early.status == "ok"
    assert early.performance.gas_mass_flow < 0.95 * run(ECONOMIZER).performance.gas_mass_flow
    told = "effects.economizer: its port opens at 250 deg, before suction ends at 360 deg"
    assert any(warning.startswith(told) and " bar displaces suction gas of " in warning for warning in early.warnings)
    assert not any("before suction ends" in warning for warning in run(ECONOMIZER).warnings)


def test_a_port_that_meets_the_slot_of_a_slide_is_told():
    slide = {"position": 0.5, "slot_area": "10 cm^2", "closes": "560 deg"}
    told = "effects.economizer: its port opens at {} deg, before the passage of effects.slide_valve to suction ends at"
    for opens, met in ((420, True), (470, False)):
        window = {"effects.economizer.opens": f"{opens} deg", "effects.economizer.closes": "520 deg"}
        result = run({**ECONOMIZER, "effects.slide_valve": slide, **window})
        assert any(warning.startswith(told.format(opens)) for warning in result.warnings) is met


def test_the_plenum_of_an_ideal_gas_has_the_real_saturation_pressure():
    """Gas flows in below that pressure and out above it."""
    p = constants.dew_pressure("R134a", 278.0)
    result = run(ECONOMIZER)
    pressure = result.cycle["pressure"][(result.cycle["angle"] > 390.0) & (result.cycle["angle"] < 470.0)]
    flow = result.cycle["mass_flow_economizer"][(result.cycle["angle"] > 390.0) & (result.cycle["angle"] < 470.0)]
    assert np.array_equal(np.sign(flow), np.sign(p - pressure))


def test_an_economizer_of_a_pressure_is_that_of_its_saturation_temperature():
    pressure = constants.dew_pressure("R134a", 278.0)
    found = run({**AT_PRESSURE, "effects.economizer.pressure": f"{pressure!r} Pa"})
    stated = run(ECONOMIZER)
    assert found.status == "ok"
    for name in ("gas_mass_flow", "shaft_power", "economizer_mass_flow", "economizer_flow_ratio"):
        assert found.performance[name] == pytest.approx(stated.performance[name], rel=1e-6), name


# ---- liquid --------------------------------------------------------------------------------------------------------


def test_liquid_follows_bernoulli(liquid):
    """0.61 A √(2 ρ Δp) at every angle of the window, the bore as wide as it is there."""
    fluid, angle = "R134a", liquid.cycle["angle"]
    inside = (angle >= 511.0) & (angle <= 589.0)
    flow, p = liquid.cycle["mass_flow_liquid_injection"][inside], liquid.cycle["pressure"][inside]
    p_d = constants.bubble_pressure(fluid, 318.15)
    density = 1125.2  # saturated liquid at 45 °C: NIST webbook, 1125.3
    # Δp/(ρ w²) is 4e-3: so much the liquid's stiffness takes
    assert flow == pytest.approx(0.61 * 4e-6 * np.sqrt(2.0 * density * (p_d - p)), rel=6e-3)


def test_liquid_cools_and_takes_no_cooling_capacity(liquid, pytestconfig):
    without = simulate(load(pytestconfig.rootpath / CONFIG)).performance
    assert liquid.performance.discharge_temperature < without.discharge_temperature - 3.0
    assert liquid.performance.gas_mass_flow == pytest.approx(without.gas_mass_flow, rel=0.01)


# ---- oil -----------------------------------------------------------------------------------------------------------


def test_oil_that_comes_through_the_bore_is_what_the_orifice_lets_in():
    performance = run(OIL_PORT).performance
    lift = performance.oil_mass_flow / 1000.0 * (performance.discharge_pressure - performance.injection_pressure)
    assert performance.oil_lift_power == pytest.approx(lift, rel=1e-9)
    assert performance.suction_pressure < performance.injection_pressure < performance.discharge_pressure
    dp = performance.discharge_pressure - performance.injection_pressure
    velocity = math.sqrt(2.0 * dp / 1000.0)
    coefficient = discharge_coefficient(1000.0 * velocity * 0.006 / 0.02, 2.0)
    steady = coefficient * math.pi / 4 * 0.006**2 * 1000.0 * velocity
    # a window of 90° with ramps of 10°, a pitch of 90°: as if the bore faced one chamber for 80/90 of the time
    assert performance.oil_mass_flow == pytest.approx(80.0 / 90.0 * steady, rel=0.02)


def test_a_bore_of_no_width_lets_no_oil_in():
    dry = run({**OIL_PORT, "oil_supply.orifice_diameter": "1 um"})
    none = run({**CARRIED, "oil_supply.ratio": 0})
    assert change(dry, none, ("gas_mass_flow", "indicated_power", "discharge_temperature", "trapped_mass")) < ACCURACY


def test_nothing_flows_into_the_bore_when_the_chamber_is_above_it():
    late = run({**OIL_PORT, "effects.oil_injection": {"opens": "600 deg", "closes": "715 deg"}})
    assert late.status == "ok"
    assert 0.0 <= late.performance.oil_mass_flow < 0.5 * run(OIL_PORT).performance.oil_mass_flow


@pytest.mark.slow
def test_oil_at_a_stated_pressure_is_that_of_the_line_that_leaves_it():
    """12 bar less 2.5 bar of the line are 9.5 bar before the bore; a lower pressure drives less oil."""
    lost, stated = (
        run({**OIL_PORT, f"effects.oil_injection.{name}": value})
        for name, value in (("pressure_loss", "2.5 bar"), ("pressure", "9.5 bar"))
    )
    low = run({**OIL_PORT, "effects.oil_injection.pressure": "5 bar"})
    for name in ("oil_mass_flow", "shaft_power", "injection_pressure"):
        assert stated.performance[name] == pytest.approx(lost.performance[name], rel=1e-9), name
    assert stated.ledger.exergy_destroyed_oil_supply == pytest.approx(lost.ledger.exergy_destroyed_oil_supply, rel=1e-9)
    assert low.performance.oil_mass_flow < stated.performance.oil_mass_flow < run(OIL_PORT).performance.oil_mass_flow
    for result in (stated, low):
        balanced(result)


# ---- faults --------------------------------------------------------------------------------------------------------


@each_row(
    ("changes", "path", "words"),
    [
        ({**OIL_PORT, "oil.transport": "paper"}, "effects.oil_injection", "oil.transport: carried"),
        (
            {**PUMPED_PORT, "effects.oil_injection.pressure_loss": "1 bar"},
            "effects.oil_injection.pressure_loss",
            "effects.oil_pump",
        ),
        ({**OIL_VOLUME, "oil.transport": "paper"}, "effects.oil_volume", "oil.transport: carried"),
        ({**ECONOMIZER, "effects.economizer.closes": "390 deg"}, "effects.economizer.closes", "20 deg"),
        ({**ECONOMIZER, "effects.economizer.closes": "800 deg"}, "effects.economizer.closes", "720 deg"),
        ({**ECONOMIZER, "effects.economizer.temperature": "400 K"}, "effects.economizer.temperature", "101.06"),
        ({**ECONOMIZER, "effects.economizer.temperature": "330 K"}, "effects.economizer.temperature", "between"),
        (
            {**ECONOMIZER, "effects.economizer.pressure": "4 bar"},
            "effects.economizer.temperature",
            "as well as pressure",
        ),
        ({**AT_PRESSURE, "effects.economizer.pressure": DROP}, "effects.economizer.temperature", "is missing"),
        ({**AT_PRESSURE, "effects.economizer.pressure": "50 bar"}, "effects.economizer.pressure", "40.59 bar"),
        ({**AT_PRESSURE, "effects.economizer.pressure": "13 bar"}, "effects.economizer.pressure", "between"),
        ({**OIL_PORT, "effects.oil_injection.pressure": "13 bar"}, "effects.oil_injection.pressure", "the separator"),
        (
            {**OIL_PORT, "effects.oil_injection.pressure": "9 bar", "effects.oil_injection.pressure_loss": "1 bar"},
            "effects.oil_injection.pressure",
            "as well as pressure_loss",
        ),
        ({**PUMPED_PORT, "effects.oil_injection.pressure": "9 bar"}, "effects.oil_injection.pressure", "displaced oil"),
        ({**ECONOMIZER, "gas.fluid": "nothing"}, "gas.fluid", "not a fluid"),
        (
            {"effects.liquid_injection": {"opens": "380 deg", "closes": "480 deg", "area": "4 mm^2"}},
            "effects.liquid_injection",
            "gas.model: real",
        ),
        ({**OIL_VOLUME, "oil": DROP, "oil_supply": DROP, "effects.oil_heat": DROP}, "effects", "needs oil"),
    ],
)
def test_contradictions_are_faults_at_their_place(changes, path, words):
    with pytest.raises(SceneError) as raised:
        make(changes)
    assert path in str(raised.value)
    assert words in str(raised.value)


def test_an_economizer_must_find_liquid_to_cool(pytestconfig):
    own = "effects.economizer={temperature: 43 degC, opens: 400 deg, closes: 500 deg, area: 1 cm^2}"
    with pytest.raises(SceneError, match=r"is not warmer than the 48 degC"):
        load(pytestconfig.rootpath / CONFIG, [own])


def test_scene_texts_survive_a_round():
    text = make(TOGETHER).text
    assert loads(text).text == text


def test_chambers_that_give_the_economizer_vapour_are_told():
    """A port that opens when the chambers are beyond its pressure lets their gas out, which no economizer takes."""
    late = {**ECONOMIZER["effects.economizer"], "temperature": "258 K", "opens": "560 deg", "closes": "598 deg"}
    result = run({**ECONOMIZER, "effects.economizer": late})
    assert result.status == "ok"
    assert result.performance.economizer_mass_flow < 0.0
    assert any("back into the economizer" in warning for warning in result.warnings)
    assert not any("back into the economizer" in warning for warning in run(ECONOMIZER).warnings)
