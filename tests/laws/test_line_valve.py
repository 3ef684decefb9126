"""Check valves of lines: no flow against them, the limits of wide and shut ones, what a plenum does behind them."""

import numpy as np
import pytest
from each_row import each_row
from scenes import make, run
from scipy.integrate import solve_ivp

from screwsim.effects.base import Made
from screwsim.effects.parts import line_valve
from screwsim.effects.parts.line_valve import (
    POINTS,
    Valve,
    ValveSurroundings,
    closed,
    least_flow,
    lowest,
    standing,
    valve_flow,
)
from screwsim.effects.plenums import Parameters
from screwsim.effects.plenums import build as plenum_parts
from screwsim.explain import explain
from screwsim.numerics.feedback_unknowns import FeedbackUnknowns
from screwsim.simulate import simulate

ACCURACY = 3e-4
BALANCES = ("mass", "energy", "entropy", "oil_mass")
SIZE = {"suction_volume": "8 l", "discharge_volume": "3 l", "suction_area": "40 cm^2", "discharge_area": "15 cm^2"}
BEHIND = ValveSurroundings(capacity=8e-8, impedance=1.3e5, frequency=1200.0, rho=45.0)
OF_LOW_SPEED = ValveSurroundings(capacity=6e-8, impedance=1.5e4, frequency=130.0, rho=3.8)
PHASE = 2.0 * np.pi * np.arange(64) / 64
WIDE = 2.0 * np.pi * np.arange(128) / 128


def plenums(**changes):
    return {"oil.transport": "carried", "effects.plenums": {**SIZE, **changes}}


# ---- the law and the plenum behind it ------------------------------------------------------------------------------


def test_an_open_valve_is_held_up_by_its_pressure_and_an_orifice_beyond():
    """½ ρ u² of 1 kg/s through 10 cm² at 45 kg/m³ is 11.1 kPa."""
    drop, _ = Valve(area=1e-3, pressure=2e3).drop(np.array([0.01, 1.0]), 45.0)
    assert drop == pytest.approx([2e3, 1.0 / (2.0 * 45.0 * 1e-6)])


@each_row("swing", [0.3, 1.5, 6.0, 40.0])
@each_row("valve", [Valve(), Valve(area=5e-4), Valve(area=5e-4, pressure=3e3)])
@each_row("behind", [BEHIND, OF_LOW_SPEED])
def test_nothing_flows_back_and_the_mean_passes(swing, valve, behind):
    """Turning slowly, up to 40 % of the mean were missing: of the search's damped steps 60 were too few."""
    given = 0.2 * (1.0 + swing * np.cos(PHASE) + 0.3 * swing * np.sin(3.0 * PHASE))
    flow = valve_flow(valve, given, behind).flow
    assert flow.min() >= 0.0
    assert flow.mean() == pytest.approx(given.mean(), rel=1e-9)


@each_row("capacity", [3e-9, 1.5e-9, 8e-10])
@each_row("swing", [1.5, 6.0])
def test_a_plenum_that_holds_next_to_nothing_is_approached_from_larger_ones(capacity, swing, monkeypatch):
    given = 0.2 * (1.0 + swing * np.cos(PHASE) + 0.3 * swing * np.sin(3.0 * PHASE))
    small = BEHIND._replace(capacity=capacity, frequency=20.0, impedance=3e4)
    flow, _, converged = valve_flow(Valve(), given, small)
    assert converged and flow.min() >= 0.0
    assert flow.mean() == pytest.approx(given.mean(), rel=1e-9)
    with monkeypatch.context() as alone:
        alone.setattr(line_valve, "LARGER", np.array([1.0]))
        assert not valve_flow(Valve(), given, small).converged


def test_a_valve_whose_flow_is_not_found_is_told(monkeypatch):
    found = line_valve.valve_flow
    monkeypatch.setattr(line_valve, "valve_flow", lambda *asked: found(*asked)._replace(converged=False))
    result = simulate(make(plenums(discharge_valve={})))
    assert result.status == "failed"
    assert result.message.startswith("the flow through the check valve of the discharge line was not found")


@pytest.mark.parametrize("lag", [0.013, 0.05, 0.081])
def test_the_least_flow_lies_between_the_angles_and_has_all_harmonics(lag):
    """u_k = w_k/(1 + i k Ω C Z), while neither the orifice nor the seat is met; the 45th is none of 65 angles."""
    given = 0.2 * (
        1.0 + 0.3 * np.cos(WIDE - lag) + 0.1 * np.cos(8.0 * (WIDE - lag)) + 0.1 * np.cos(45.0 * (WIDE - lag))
    )
    quick = BEHIND._replace(capacity=1e-10)
    delay = 1j * quick.frequency * quick.capacity * quick.impedance
    phase = np.linspace(0.0, 2.0 * np.pi, 200_001)
    waves = ((k, 0.2 * size / (1.0 + delay * k)) for k, size in ((1, 0.3), (8, 0.1), (45, 0.1)))
    true = 0.2 + sum(np.real(np.exp(1j * k * (phase - lag)) * wave) for k, wave in waves)
    valve = Valve(area=5e-3, pressure=3e3)
    found = least_flow(valve, given, quick, valve_flow(valve, given, quick), float(np.mean(given)))
    assert found == pytest.approx(true.min(), rel=1e-6)


def test_the_least_flow_of_an_orifice_is_that_of_as_many_angles_as_it_takes():
    given = 0.2 * (1.0 + 0.4 * np.cos(PHASE) + 0.2 * np.sin(5.0 * PHASE))
    valve = Valve(area=1e-4, pressure=3e3)
    many = valve_flow(valve, given, BEHIND, 401)
    assert least_flow(valve, given, BEHIND, valve_flow(valve, given, BEHIND), float(np.mean(given))) == pytest.approx(
        many.flow.min(), rel=1e-4
    )
    assert lowest(many.pressure) <= many.pressure.min()


def test_a_wide_valve_that_never_shuts_is_none():
    """p_k = w_k/(i k Ω C + 1/Z)."""
    given = 0.2 * (1.0 + 0.3 * np.cos(PHASE) + 0.1 * np.sin(2.0 * PHASE))
    flow, pressure, _ = valve_flow(Valve(), given, BEHIND)
    found = np.fft.rfft(pressure)[1:3] * 2.0 / POINTS
    k = np.array([1, 2])
    expected = 0.2 * np.array([0.3, -0.1j]) / (1j * k * BEHIND.frequency * BEHIND.capacity + 1.0 / BEHIND.impedance)
    assert found == pytest.approx(expected, rel=1e-9)
    assert pressure.mean() == pytest.approx(0.0, abs=1e-6 * abs(expected[0]))
    assert flow.min() > 0.0


@pytest.mark.parametrize("valve", [Valve(), Valve(area=5e-4, pressure=3e3)])
def test_an_integration_in_time_ends_on_the_same_pitch(valve):
    """Stepped on until nothing changes: dp/dt = (given − u(p))/C, the valve's law read backwards from a table."""
    given = 0.2 * (1.0 + 2.0 * np.cos(PHASE))
    flows = np.linspace(0.0, 10.0, 1_000_001)  # [kg/s]; read between two of them to 1e-9
    needed = valve.drop(flows, BEHIND.rho)[0] + BEHIND.impedance * (flows - 0.2)

    def rate(t, p):
        passed = np.interp(p[0], needed, flows)  # none below the first
        return [(0.2 * (1.0 + 2.0 * np.cos(BEHIND.frequency * t)) - passed) / BEHIND.capacity]

    period, p = 2.0 * np.pi / BEHIND.frequency, 0.0
    grid = period * np.arange(POINTS) / POINTS
    for _ in range(12):
        found = solve_ivp(rate, (0.0, period), [p], rtol=1e-6, atol=1.0, max_step=period / 40, t_eval=[*grid, period])
        p = found.y[0, -1]
    ours = valve_flow(valve, given, BEHIND).pressure
    assert np.max(np.abs(ours - found.y[0, :-1])) < 0.01 * np.ptp(ours)


def test_a_shut_plenum_stores_all_it_is_given():
    """C dp/dt = w − mean, so p_1 = w_1/(i Ω C)."""
    pressure = closed(-0.1 + 0.2 * np.cos(PHASE), BEHIND)
    assert np.fft.rfft(pressure)[1] * 2.0 / POINTS == pytest.approx(0.2 / (1j * BEHIND.frequency * BEHIND.capacity))


def test_what_leaks_answer_of_a_shut_plenum_s_pressure_leaves_where_it_stands():
    """They answer what the plenum has: the pressure that it makes of the flow is the same with them and without."""
    given = 0.3 * np.sin(PHASE) - 0.1 * np.cos(3.0 * PHASE)
    alone = closed(given, BEHIND)
    leaking = 2e-5
    at_phases = np.interp(PHASE, 2.0 * np.pi * np.arange(POINTS + 1) / POINTS, np.append(alone, alone[0]))
    assert closed(given + leaking * at_phases, BEHIND, leaking) == pytest.approx(alone, abs=2e-3 * np.ptp(alone))
    assert np.ptp(closed(given, BEHIND, leaking)) < np.ptp(alone)


def test_a_plenum_falls_while_the_machine_draws_from_it():
    assert standing(-0.1, -0.1 + np.cos(PHASE), 0.1, 0.8) < -0.1
    assert standing(-0.1, np.cos(PHASE), 0.1, 0.8) == pytest.approx(-0.1)


def test_a_plenum_goes_a_share_of_what_lies_across_the_machine():
    """What the leaks of the whole flow drive back is not driven beyond the pressure at the other port."""
    held, across = -0.5, 0.1
    assert held - 0.5 * across < standing(held, np.full(64, -0.2), 0.0, across) < held
    assert standing(held, np.full(64, -0.2), 0.0, 100.0) == pytest.approx(0.6 * (1.0 + held) - 1.0)


def test_a_shut_plenum_that_is_all_but_empty_counts_by_its_own_pressure():
    """From 2 to 3 thousandths of the line's pressure is half of it more; without a valve it is a thousandth."""
    for valve, expected in ((Valve(), 0.5), (None, 1e-3)):
        parts = plenum_parts(Parameters(discharge_volume=3e-3, discharge_valve=valve), None)
        entries = FeedbackUnknowns([part.entry for part in parts if isinstance(part, Made)])
        old, new = np.zeros(len(entries)), np.zeros(len(entries))
        old[0], new[0] = -0.998, -0.997
        assert entries.change(new, old) == pytest.approx(expected)
        assert entries.values(entries.coordinates(new), new) == pytest.approx(new)


# ---- with the cycle ------------------------------------------------------------------------------------------------


def test_a_wide_valve_changes_nothing_where_the_flow_never_turns():
    without, wide = run(plenums()), run(plenums(discharge_valve={}, suction_valve={}))
    assert without.performance.discharge_line_least_flow > 0.0
    for name, value in without.performance.items():
        if value is not None and "harmonic" not in name:  # the least flow: of all harmonics, not of eight
            near = 0.01 if name == "discharge_line_least_flow" else ACCURACY  # closings are two
            assert wide.performance[name] == pytest.approx(value, rel=near), name
    assert max(wide.balance[name] for name in BALANCES) <= ACCURACY


def test_a_wave_that_would_turn_the_flow_round_shuts_it_for_a_while():
    small = {"discharge_volume": "0.2 l", "discharge_area": "80 cm^2"}
    without, valve = (run(plenums(**small, **more)) for more in ({}, {"discharge_valve": {"area": "12 cm^2"}}))
    assert without.performance.discharge_line_least_flow < 0.0
    assert valve.status == "ok"
    assert valve.performance.discharge_line_least_flow == pytest.approx(0.0, abs=1e-12)
    assert not any("a check valve would shut" in warning for warning in valve.warnings)
    assert max(valve.balance[name] for name in BALANCES) <= ACCURACY
    assert valve.performance.gas_mass_flow > 0.0


def test_a_machine_that_delivers_nothing_stands_against_a_shut_valve():
    """Without it gas runs back through the machine; with it the plenum falls to where the leaks take all that comes."""
    changes = {**plenums(), "oil_supply.ratio": 0, "effects.tip_leakage.gap": "0.2 mm", "operation.speed": "300 rpm"}
    back = run(changes)
    shut = run({**changes, "effects.plenums": {**SIZE, "discharge_valve": {"pressure": "0.1 bar"}}})
    assert back.performance.gas_mass_flow < 0.0
    assert shut.status == "ok"
    assert shut.performance.gas_mass_flow == 0.0
    assert shut.performance.discharge_line_least_flow == 0.0
    assert shut.performance.suction_pressure < shut.performance.discharge_plenum_pressure < 12e5
    assert shut.balance.mass <= ACCURACY
    assert shut.balance.energy <= ACCURACY
    assert any("stays shut" in warning for warning in shut.warnings)


PLAIN = {"numerics.error": "none"}  # of what closes slowly: where its balances alone are asked
SLOW = {**plenums(), **PLAIN, "operation.speed": "50 rpm"}  # leaks more than it takes in
DISCHARGE = {"discharge_valve": {"area": "12 cm^2", "pressure": "0.1 bar"}}
SUCTION = {"suction_valve": {"area": "40 cm^2"}}


def slow(**valves):
    return run({**SLOW, "effects.plenums": {**SIZE, **valves}})


@pytest.mark.parametrize("transport", ["paper", "carried"])
def test_what_stands_against_a_shut_discharge_valve_is_not_below_suction(transport):
    result = run({**SLOW, "oil.transport": transport, "effects.plenums": {**SIZE, **DISCHARGE}})
    assert result.status == "ok"
    assert result.performance.gas_mass_flow == 0.0
    assert 1.5e5 < result.performance.discharge_plenum_pressure < 2e5
    assert max(result.balance[name] or 0.0 for name in BALANCES) <= ACCURACY


def test_leaks_that_take_all_that_is_moved_ask_for_pressure_with_the_square_of_the_speed():
    """Of a nozzle Δp ∝ ṁ²: a plenum of 25 rpm stands (5/4)² times as far above suction as one of 20 rpm."""
    excess = []
    for speed in ("20 rpm", "25 rpm"):
        result = run({**SLOW, "operation.speed": speed, "effects.plenums": {**SIZE, **DISCHARGE}})
        assert result.status == "ok"
        assert max(result.balance[name] or 0.0 for name in BALANCES) <= ACCURACY
        excess.append(result.performance.discharge_plenum_pressure - 1.5e5)
    assert excess[1] / excess[0] == pytest.approx(1.25**2, rel=0.002)


def test_what_stands_against_a_shut_suction_valve_is_not_above_discharge():
    result = slow(**SUCTION)
    assert result.status == "ok"
    assert result.performance.gas_mass_flow == 0.0
    assert 10e5 < result.performance.suction_plenum_pressure < 12e5
    assert max(result.balance[name] or 0.0 for name in BALANCES) <= ACCURACY


def test_two_valves_that_stay_shut_lock_in_what_the_scene_does_not_tell():
    """The figures are those without the suction valve, as the message says."""
    both, one = slow(**DISCHARGE, **SUCTION), slow(**DISCHARGE)
    assert both.status == "failed"
    assert "both check valves of effects.plenums stay shut" in both.message
    assert "leave it out" in both.message
    for name in ("discharge_plenum_pressure", "suction_plenum_pressure", "trapped_mass"):
        assert both.performance[name] == pytest.approx(one.performance[name], rel=ACCURACY), name


def test_two_valves_of_a_machine_that_delivers_lock_in_nothing():
    result = run(plenums(**DISCHARGE, **SUCTION))
    assert result.status == "ok"
    assert result.performance.gas_mass_flow > 0.0


@pytest.mark.slow
def test_gas_of_a_third_line_leaves_by_the_suction_line_where_the_discharge_valve_stays_shut():
    economizer = {"temperature": "20 degC", "opens": "385 deg", "closes": "485 deg", "area": "1 cm^2"}
    result = run(
        {
            **SLOW,
            "operation.speed": "100 rpm",
            "effects.economizer": economizer,
            "effects.plenums": {**SIZE, "discharge_valve": {}},
        }
    )
    figures = result.performance
    assert result.status == "ok"
    assert figures.discharge_plenum_pressure < 12e5
    assert figures.economizer_mass_flow > 0.0
    assert figures.gas_mass_flow == pytest.approx(-figures.economizer_mass_flow, rel=ACCURACY)


def test_explain_tells_of_the_valve():
    text = str(explain(make(plenums(discharge_valve={"area": "12 cm^2"}))))
    assert "discharge_valve" in text
