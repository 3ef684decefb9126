"""What flows back into the suction line stays in it (M270–M274): conservation, limits, mixing, leaks to it."""

import math
from pathlib import Path

import pytest
from each_row import each_row
from scenes import OIL_VOLUME, SOLUBLE_RATE, balanced, closed, make, refusal, run
from test_capacity_control import SLIDE

from screwsim.cycle.balances import streams_of
from screwsim.cycle.feedback import suction_line_imbalance
from screwsim.cycle.problem import problem_of
from screwsim.cycle.suction_line import Stream, held_of, image, mixed, values
from screwsim.effects.base import OilSolution
from screwsim.fluid.solubility_laws import ESTER
from screwsim.inputs.faults import SceneError
from screwsim.model.slots import ENTHALPY, R_DISCHARGE, R_SUCTION, SUCTION_IN
from screwsim.outputs import ledger_entries
from screwsim.scene import load
from screwsim.simulate import simulate

LINE = {"oil.transport": "carried", "effects.suction_line": {}, "effects.slide_valve": {**SLIDE, "position": 0.6}}
REAL = {"gas.model": "real", "operation.suction.temperature": "290 K", "oil_supply.temperature": "325 K"}
LEAK = {"effects.shaft_leakage": {"area": "17 mm^2"}}
ANNULI = {"shaft_diameter": "70 mm", "clearance": "45 um"}
RULE = {"model": "oil_sealed", "mixture_viscosity": "mcadams", "passage": "10 mm"}
SEALED = {"effects.shaft_leakage": {**ANNULI, **RULE}}
MOTOR = {"effects.motor": {"rated_power": "40 kW", "efficiency": 0.9, "cooling": "suction_gas"}}
INTAKE = {"effects.suction_throttle": {"pressure_ratio": 0.7}, "effects.bypass": {"share": 0.2}}
BACKWARDS = {"operation.speed": "150 rpm", "effects.tip_leakage.gap": "400 um"}  # more flows back than is sucked
CASES = {
    "slide valve": LINE,
    "real gas": {**LINE, **REAL},
    "oil takes room": {**LINE, **OIL_VOLUME},
    "gas dissolved": {**SOLUBLE_RATE, **LINE, **REAL},
    "throttle and bypass": {**LINE, **INTAKE},
    "shaft leakage": {**LINE, **LEAK},
    "shaft leakage, oil takes room": {**LINE, **LEAK, **OIL_VOLUME, **INTAKE},
    "shaft leakage, gas dissolved": {**SOLUBLE_RATE, **LINE, **LEAK, **REAL},
    "shaft leakage, sealed": {**LINE, **SEALED},
    "shaft leakage, sealed, oil takes room": {**LINE, **SEALED, **OIL_VOLUME},
    "shaft leakage, sealed, gas dissolved": {**SOLUBLE_RATE, **LINE, **SEALED, **REAL},
    "plenums": {**LINE, **LEAK, "effects.plenums": {"suction_volume": "8 l", "suction_area": "40 cm^2"}},
    "backwards": {**LINE, **BACKWARDS},
    "backwards, shaft leakage": {**LINE, **BACKWARDS, **LEAK, **OIL_VOLUME},
    "cooled motor": {**LINE, **MOTOR, **LEAK, **REAL},
    "coupled chambers": {**LINE, **LEAK, "numerics": {"closing": "coupled"}},
}
FORWARDS = [case for case in CASES if not case.startswith("backwards")]


@pytest.mark.parametrize("case", CASES)
def test_mass_energy_oil_and_entropy_close(case):
    balanced(run(CASES[case]), "oil_mass")


@each_row("case", FORWARDS)
def test_mixing_in_the_line_and_leaks_to_it_generate_entropy(case):
    entries = ledger_entries(run(CASES[case]).ledger)
    assert entries["suction_line"]["exergy_destroyed"] > 0.0
    assert entries.get("shaft_leakage", {"exergy_destroyed": 1.0})["exergy_destroyed"] > 0.0


@pytest.mark.parametrize("case", ["slide valve", "oil takes room", "shaft leakage", "shaft leakage, oil takes room"])
def test_all_that_the_rotors_give_the_fluids_arrives_at_discharge(case):
    """First law of machine and suction line: P_ind = ṁ c_p (T_d − T_s) + ṁ_o c_o (T_o,d − T_inj), oil from p_d to p_d.

    Without the effect what leaves to suction is missed.
    """
    gas, oil = (getattr(problem_of(make(CASES[case])).parts, name) for name in ("gas", "oil"))

    def missing(p):
        warmed = p.gas_mass_flow * gas.c_p * (p.discharge_temperature - 283.0)
        warmed += p.oil_mass_flow * oil.heat_capacity * (p.oil_discharge_temperature - 293.0)
        return 1.0 - warmed / p.indicated_power

    assert abs(missing(run(CASES[case]).performance)) < 1e-3
    of_line = ("effects.suction_line", "effects.shaft_leakage")
    lost = {path: value for path, value in CASES[case].items() if path not in of_line}
    assert abs(missing(run(lost).performance)) > 0.01


PACKAGES = [case for case in FORWARDS if case != "coupled chambers"]
COMPACT = Path(__file__).parents[2] / "configs" / "r134a" / "compact.yaml"
AROUND = {  # the shipped machine, whose oil comes back uncooled, with what goes round in it
    "as it is": (),
    "bypass, throttle": ("effects.bypass={share: 0.1}", "effects.suction_throttle={pressure_ratio: 0.9}"),
    "oil takes room": ("effects.oil_volume={}",),
}


@pytest.mark.parametrize("case", PACKAGES)
def test_machine_suction_line_separator_and_cooler_close_as_one(case):
    """M285: what the shaft and the motor give leaves with gas and cooler, whatever goes round in between."""
    found = {"effects.separator": {}}
    if "effects.refrigerant_solubility" in CASES[case]:
        found |= {"effects.refrigerant_solubility": {"flash_time": "5 ms", "absorption_time": "50 ms"}}
    result = run({**CASES[case], **found})
    assert result.status == "ok", result.message
    assert result.performance.oil_circuit_residual <= result.balance.bound
    assert result.balance.entropy <= result.balance.bound


@pytest.mark.parametrize("case", AROUND)
def test_a_package_without_a_cooler_closes_at_one_temperature_of_gas_and_oil(case):
    result = simulate(load(COMPACT, AROUND[case]))
    assert result.status == "ok", result.message
    p = result.performance
    assert p.oil_circuit_residual <= result.balance.bound
    assert p.mixture_discharge_temperature == pytest.approx(p.oil_supply_temperature, abs=0.01)
    assert 0.0 == p.oil_cooler_duty


def test_where_nothing_flows_back_the_line_is_the_suction_line():
    shut = {"oil.transport": "carried", "effects.suction_port": {}, "machine.suction_port.area": "300 cm^2"}
    one, other = run({**shut, "effects.suction_line": {}}).performance, run(shut).performance
    assert one.returned_gas_flow < 5e-3 * one.gas_mass_flow
    for name in ("gas_mass_flow", "shaft_power", "discharge_temperature"):
        assert one[name] == pytest.approx(other[name], rel=3e-3), name
    assert one.intake_temperature == pytest.approx(283.0, abs=0.5)


def test_gas_that_comes_back_takes_capacity():
    """With the slide at 0.6 warm gas and oil come back: they warm what is sucked in, and thin it."""
    lost = {**LINE}
    del lost["effects.suction_line"]
    kept, gone = run(LINE).performance, run(lost).performance
    assert kept.intake_temperature > 285.0
    assert 0.8 < kept.gas_mass_flow / gone.gas_mass_flow < 0.99


def test_oil_that_comes_back_need_not_be_injected():
    """A pump brings the chamber to a ratio: what the line brings counts, and what is injected leaves by discharge."""
    p = run(LINE).performance
    assert p.returned_oil_flow > 0.05 * p.oil_mass_flow
    assert p.oil_mass_flow == pytest.approx(3.0 * p.gas_mass_flow, rel=0.05)  # of trapped gas, less what leaks later


# ---- the mixture ----


def problem(changes):
    return problem_of(make({**LINE, **changes}))


def test_gas_and_oil_of_the_line_come_to_the_temperature_of_their_energies():
    of = problem({})
    c_p, c_o = of.parts.gas.c_p, of.parts.oil.heat_capacity
    total = Stream(3.0, c_p * (2.0 * 283.0 + 320.0), 1.5, 1.5 * 310.0)
    T = (c_p * (2.0 * 283.0 + 320.0) + c_o * 1.5 * 310.0) / (3.0 * c_p + 1.5 * c_o)
    found = mixed(of, total, c_p * 283.0)
    assert found.enthalpy == pytest.approx(c_p * T, rel=1e-12)
    assert (found.oil, found.held) == (pytest.approx(0.5), 0.0)


def test_the_mixture_of_a_real_gas_keeps_the_energy():
    of = problem(REAL)
    gas, c_o = of.parts.gas, of.parts.oil.heat_capacity
    h = gas.enthalpy(1.5e5, 290.0)
    found = mixed(of, Stream(1.0, h, 2.0, 2.0 * 330.0), h)
    T = gas.temperature(1.5e5, found.enthalpy)
    assert found.enthalpy - h == pytest.approx(2.0 * c_o * (330.0 - T), rel=1e-9)
    assert 320.0 < T < 330.0


@each_row("oil", [2e-4, 9e-5, 1e-6, 1e-9])
def test_however_little_oil_comes_back_it_brings_its_heat(oil):
    of = problem(REAL)
    gas, c_o = of.parts.gas, of.parts.oil.heat_capacity
    h = gas.enthalpy(1.5e5, 290.0)
    found = mixed(of, Stream(1.0, h, oil, oil * 330.0), h)
    T = gas.temperature(1.5e5, found.enthalpy)
    assert found.enthalpy - h == pytest.approx(oil * c_o * (330.0 - T), rel=1e-6, abs=1e-7)  # rounding of h, 4e5 J/kg


def test_oil_of_the_line_holds_what_is_in_equilibrium_with_the_gas():
    """Oil that held 0.1 at discharge gives most of it off at 1.5 bar; mass and energy stay, and μ/T of both is one."""
    of = problem({**SOLUBLE_RATE, **REAL})
    solution, gas, c_o = of.parts.oil_content, of.parts.gas, of.parts.oil.heat_capacity
    assert isinstance(solution, OilSolution)
    h = gas.enthalpy(1.5e5, 290.0)
    total = Stream(1.0, h, 0.5, 0.5 * 335.0, 0.05)
    found = mixed(of, total, h)
    mass = total.fluid / (1.0 + found.held)  # gas that is left
    assert found.oil * mass == pytest.approx(0.5, rel=1e-12)
    w, T = found.held / found.oil, gas.temperature(1.5e5, found.enthalpy)
    energy = mass * (found.enthalpy + found.held * solution.enthalpy) + 0.5 * c_o * T
    assert energy == pytest.approx(h + 0.5 * c_o * 335.0 + 0.05 * solution.enthalpy, rel=1e-9)
    assert 0.001 < w < 0.09
    assert w == pytest.approx(held_of(solution, gas.entropy(1.5e5, T) - (found.enthalpy - solution.enthalpy) / T))


def test_equilibrium_in_the_line_is_that_of_the_solubility_at_the_temperature_of_the_supply():
    of = problem({**SOLUBLE_RATE, **REAL})
    solution, gas = of.parts.oil_content, of.parts.gas
    assert isinstance(solution, OilSolution)
    for p in (1.5e5, 4e5, 10e5):
        entropy = gas.entropy(p, 325.0) - (gas.enthalpy(p, 325.0) - solution.enthalpy) / 325.0
        assert held_of(solution, entropy) == pytest.approx(ESTER.content(p, 325.0), rel=2e-4)  # M195


def test_a_line_from_which_nothing_is_sucked_holds_what_comes_back():
    """It is the limit of next to nothing; what the line held before would be left by chance."""
    of, _, cycle = closed(make(LINE))
    streams, R = streams_of(of.composition, cycle.q).copy(), cycle.trajectory.R
    held = []
    for share in (1e-9, 0.0):
        streams[SUCTION_IN] *= share
        held.append(image(of, R, streams, float(R[R_DISCHARGE + ENTHALPY]), 0.0))
    assert held[1] == pytest.approx(held[0], rel=1e-12)
    assert held[1] != pytest.approx(values(of, R), rel=1e-3)


def test_a_line_that_does_not_have_what_comes_to_it_is_never_ok():
    """A mixture that is no state of the gas leaves the line as it is on the way: what closes so is told, not given."""
    of, _, cycle = closed(make({**LINE, **REAL}))
    life, q = cycle.trajectory, cycle.q
    assert suction_line_imbalance(of, life, q) == ""
    R = life.R.copy()
    R[R_SUCTION + ENTHALPY] *= 1.05
    assert "does not settle: the enthalpy of its gas is" in suction_line_imbalance(of, life._replace(R=R), q)
    streams = streams_of(of.composition, q).copy()
    streams[1, 1] += 1e6 * streams[0, 0]  # [J] that no vapour can lack
    q = q.copy()
    q[-streams.size :] = streams.ravel()
    assert "an impossible mixture in the suction line" in suction_line_imbalance(of, life, q)


# ---- leaks beside the chambers ----


def test_the_shaft_leak_is_that_of_a_choked_nozzle():
    """From 12 to 1.5 bar it chokes: ṁ = μ S √(k p ρ) (2/(k+1))^((k+1)/(2(k−1))), of the state of the discharge line."""
    annuli = {"shaft_diameter": "70 mm", "clearance": "45 um", "flow_coefficient": 0.6}
    changes = {**LINE, "effects.shaft_leakage": annuli}
    p, gas = run(changes).performance, problem(changes).parts.gas
    k, rho = gas.c_p / gas.c_v, 12e5 / (gas.R * p.discharge_temperature)
    area = 0.6 * 2 * math.pi * 70.045e-3 * 45e-6
    choked = area * math.sqrt(k * 12e5 * rho) * (2.0 / (k + 1.0)) ** ((k + 1.0) / (2.0 * (k - 1.0)))
    assert p.shaft_leakage_gas_flow == pytest.approx(choked, rel=1e-4)
    assert p.shaft_leakage_oil_flow > 0.0


@pytest.mark.parametrize("passage", [1e-6, 2.5e-3, 10e-3])
def test_a_shaft_leak_that_oil_seals_carries_it_and_rubs_at_the_walls(passage):
    """M300: σ of M192 by the line's oil per gas; (G_m/G_h)² + G_m/G_l = 1 for the mixture's flux G_m."""
    stated = {**ANNULI, **RULE, "passage": f"{passage} m", "flow_coefficient": 1.0, "gas_viscosity": "20e-6 Pa s"}
    changes = {**LINE, "oil.viscosity": "15 mPa s", "effects.shaft_leakage": stated}
    p, gas = run(changes).performance, problem(changes).parts.gas
    k, rho = gas.c_p / gas.c_v, 12e5 / (gas.R * p.discharge_temperature)
    nozzle = math.sqrt(k * 12e5 * rho) * (2.0 / (k + 1.0)) ** ((k + 1.0) / (2.0 * (k - 1.0)))  # 12 to 1.5 bar: choked
    x = p.shaft_leakage_oil_flow / p.shaft_leakage_gas_flow
    G_m = (1.0 + x) * p.shaft_leakage_gas_flow / (2 * math.pi * 70.045e-3 * 45e-6)
    G_h = nozzle * math.sqrt(1.0 + x)
    mu = (1.0 + x) / (1.0 / 20e-6 + x / 15e-3)
    drop = G_h**2 / (2.0 * rho * (1.0 + x))
    G_l = rho * (1.0 + x) * drop * 45e-6**2 / (12.0 * mu * passage)
    assert (G_m / G_h) ** 2 + G_m / G_l == pytest.approx(1.0, rel=1e-3)
    assert x > 0.5
    assert G_m / G_h == pytest.approx(1.0, rel=1e-3) or passage > 1e-4


def test_a_number_of_shafts_beside_their_area_is_refused():
    with pytest.raises(SceneError, match=r"shaft_leakage\.shafts: is stated as well as area"):
        make({**LINE, "effects.shaft_leakage": {"area": "17 mm^2", "shafts": 1}})
    make({**LINE, "effects.shaft_leakage": {**ANNULI, "shafts": 1}})


def test_more_oil_in_the_line_seals_the_shafts_more():
    def leaked(ratio, changes):
        return run({**LINE, **changes, "oil_supply.ratio": ratio}).performance.shaft_leakage_gas_flow

    assert leaked(4.0, SEALED) < 0.8 * leaked(1.0, SEALED)
    plain = {"effects.shaft_leakage": ANNULI}
    assert leaked(4.0, plain) == pytest.approx(leaked(1.0, plain), rel=0.1)


def test_a_shaft_leak_follows_the_discharge_pressure():
    """What it takes of the volumetric efficiency is in proportion to p_d, as no leak of a chamber's is."""

    def lost(p_d):
        at = {"operation.discharge.pressure": f"{p_d} bar", "effects.suction_line": {}, "oil.transport": "carried"}
        with_it, without = run({**at, **LEAK}).performance, run(at).performance
        return without.volumetric_efficiency - with_it.volumetric_efficiency

    assert lost(12) / lost(6) == pytest.approx(2.0, rel=0.1)
    assert lost(6) > 0.01


def test_oil_that_leaks_past_the_shaft_is_lifted_again():
    p = run({**LINE, **LEAK}).performance
    lift = p.oil_mass_flow * (12e5 - p.injection_pressure) + p.shaft_leakage_oil_flow * (12e5 - 1.5e5)
    assert p.oil_lift_power == pytest.approx(lift / 1000.0, rel=1e-9)


def test_the_motor_that_suction_gas_cools_warms_it_by_its_loss():
    """M275: M148's loss over ṁ c_p; capacity and λ are of the gas before the motor. Next to nothing comes back."""
    changes = {"oil.transport": "carried", "effects.suction_line": {}, **MOTOR}
    p, c_p = run(changes).performance, problem(changes).parts.gas.c_p
    own = run({**changes, "effects.motor.cooling": "ambient"}).performance
    share = p.shaft_power / 40e3
    loss = 40e3 * (1.0 / 0.9 - 1.0) * (0.4 + 0.6 * share**2)
    assert p.motor_loss == pytest.approx(loss, rel=1e-9)
    rise = p.intake_temperature - own.intake_temperature
    assert rise == pytest.approx(loss / (p.gas_mass_flow * c_p), rel=0.02)  # what flows back is warmer, too
    assert p.gas_mass_flow < own.gas_mass_flow
    entry = ledger_entries(run(changes).ledger)["motor"]
    assert entry["energy_moved"] == pytest.approx(loss, rel=1e-9)


@each_row(
    "changes, where",
    [
        ({**LINE, "oil.transport": "paper"}, "effects.suction_line"),
        ({"oil.transport": "carried", **LEAK}, "effects.shaft_leakage"),
        ({**LINE, "effects.shaft_leakage": {}}, "effects.shaft_leakage.area"),
        ({**LINE, "effects.shaft_leakage": {"clearance": "50 um"}}, "effects.shaft_leakage.shaft_diameter"),
        ({**LINE, "effects.shaft_leakage": {"area": "1 mm^2", "clearance": "1 um"}}, "effects.shaft_leakage.clearance"),
        (
            {**LINE, "effects.shaft_leakage": {"area": "9 mm^2", **RULE}},
            "effects.shaft_leakage.area",
        ),
        ({**LINE, "effects.shaft_leakage": {**ANNULI, "model": "oil_sealed"}}, "effects.shaft_leakage.passage"),
        ({**LINE, "effects.shaft_leakage": {**ANNULI, "passage": "9 mm"}}, "effects.shaft_leakage.passage"),
        ({**LINE, "effects.shaft_leakage": {**ANNULI, **RULE, "clearance": "0 um"}}, "effects.shaft_leakage.clearance"),
        ({**LINE, **SEALED, "oil.viscosity": None}, "oil.viscosity"),
        ({"oil.transport": "carried", **MOTOR}, "effects.motor.cooling"),
        ({**LINE, **LEAK, "operation.discharge.temperature": "330 K"}, "operation.discharge.temperature"),
    ],
)
def test_what_does_not_go_together_is_refused_at_its_place(changes, where):
    assert where in refusal(changes)
