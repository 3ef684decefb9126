"""Finite volumes behind the ports: closed forms of their pressure, balances, the limit, an independent integration."""

import numpy as np
import pytest
from each_row import each_row
from scenes import CARRIED, change, closed, make, run
from scipy.integrate import solve_ivp

from screwsim.cycle.feedback import LINE_POINTS, at_angles, turn_of
from screwsim.effects.base import LineFlow, Turn
from screwsim.effects.plenums import Parameters, PlenumWithLine, offset, pulsation
from screwsim.evaluate.evaluation import evaluate
from screwsim.explain import explain
from screwsim.inputs.faults import SceneError
from screwsim.model.all_chambers import inject, moved_on, pitch_breakpoints
from screwsim.model.slots import DENSITY, DISCHARGE_IN, EXPONENT, P_OMEGA, P_PITCH, PORT_STATE, PRESSURE
from screwsim.scene import loads
from screwsim.simulate import simulate

ACCURACY = 3e-4
SIZE = {"suction_volume": "8 l", "discharge_volume": "3 l", "suction_area": "40 cm^2", "discharge_area": "15 cm^2"}
PLENUMS = {**CARRIED, "effects.plenums": SIZE}
BALANCES = ("mass", "energy", "entropy", "oil_mass")


def plenums(**changes):
    return {**PLENUMS, "effects.plenums": {**SIZE, **changes}}


# ---- closed forms --------------------------------------------------------------------------------------------------


def wave(k, size):
    """Return a line flow whose harmonic k is a cosine of that size."""
    theta = 2.0 * np.pi * np.arange(64) / 64
    return LineFlow(1.0 + size * np.cos(k * theta), 0.0, 10e5, 50.0, 1.1, 1.0)


@pytest.mark.parametrize("k", [1, 3])
def test_a_closed_volume_integrates_what_it_is_given(k):
    """p_k = w c²/(k Ω V), a quarter of a period behind the flow."""
    line, frequency, volume = wave(k, 0.2), 1200.0, 2e-3
    found = pulsation(line, np.zeros(8, complex), volume, None, frequency)
    expected = 0.2 * line.sound**2 / (k * frequency * volume) / line.p
    assert found[k - 1] == pytest.approx(-1j * expected, rel=1e-12)
    assert abs(np.delete(found, k - 1)).max() < 1e-12


def test_an_endless_pipe_alone_answers_with_its_impedance():
    """Next to no volume: p = w c/A, in phase."""
    line, area = wave(2, 0.2), 1e-3
    found = pulsation(line, np.zeros(8, complex), 1e-12, area, 1200.0)
    assert found[1] == pytest.approx(0.2 * line.sound / area / line.p, rel=1e-6)


def test_what_is_open_makes_a_better_guess_and_the_same_answer():
    line = wave(1, 0.2)
    there = pulsation(line, np.zeros(4, complex), 2e-3, 1e-3, 1200.0)
    assert pulsation(line._replace(open_volume=5e-3), there, 2e-3, 1e-3, 1200.0) == pytest.approx(there, rel=1e-12)


@pytest.mark.parametrize("jump", [0.3, 0.3 + 0.2 / LINE_POINTS, 0.3 + 0.4 / LINE_POINTS])
def test_a_flow_that_jumps_between_two_angles_has_its_harmonics(jump):
    """Its means around the angles tell where it jumps; values at the angles were off by up to a hundredth."""
    edges = (np.arange(LINE_POINTS + 1) - 0.5) / LINE_POINTS
    shares = np.diff(np.clip(edges, 0.0, jump)) * LINE_POINTS  # of each angle, that lie before the jump
    shares[0] = 0.5  # half of it lies at the pitch's end
    k = np.arange(1, 9)
    exact = (1.0 - np.exp(-2j * np.pi * k * jump)) / (2j * np.pi * k)
    found = np.fft.rfft(at_angles(shares))[1:9] / LINE_POINTS
    assert np.abs(found - exact) == pytest.approx(0.0, abs=1e-4)  # 2e-3 of the values at the angles


@pytest.mark.parametrize("opens", [620.0, 620.1, 620.3])
def test_what_is_open_to_a_line_counts_from_where_its_port_opens(opens):
    """Not from the next angle at which flows are asked for: of a pitch of 90° these are a third of a degree apart."""
    port = {"machine.discharge_port.opens": f"{opens} deg", "machine.discharge_port.phi_C": "650 deg"}
    problem, machinery, _ = closed(make({**PLENUMS, **port, "numerics.accuracy": 3e-3, "numerics.error": "none"}))
    life, pitch = machinery.trajectory, problem.parts.geometry.pitch
    angles = np.radians(np.linspace(opens, 720.0, 2001))
    volume = life.volumes(angles)
    mean = float(np.sum(0.5 * (volume[1:] + volume[:-1]) * np.diff(angles))) / pitch
    assert life.into_lines(LINE_POINTS)[1][1] == pytest.approx(mean, rel=1e-5)


def test_a_lifes_flow_into_its_lines_is_read_once_and_another_lifes_anew():
    """It costs as much as a turn; a workspace that goes on, with other states or other numbers, has another life."""
    _, machinery, _ = closed(make({**PLENUMS, "numerics.error": "none"}))
    view, kept = machinery.trajectory, machinery.trajectory.copy()
    first = view.into_lines(LINE_POINTS)
    assert kept.into_lines(LINE_POINTS) is first
    again = {**kept._asdict(), "line_flows": {}}
    np.testing.assert_array_equal(type(kept)(**again).into_lines(LINE_POINTS)[0], first[0])
    machinery.lives.histories[0][1][: view.steps, :, 1] *= 1.01  # denser gas
    denser = machinery.trajectory.into_lines(LINE_POINTS)[0]
    assert abs(denser / first[0] - 1.0).min() > 1e-4
    machinery.composition.P[P_OMEGA] *= 2.0
    assert abs(machinery.trajectory.into_lines(LINE_POINTS)[0] / denser - 1.0).max() > 1e-4
    np.testing.assert_array_equal(kept.into_lines(LINE_POINTS)[0], first[0])


def test_the_mean_drop_is_that_of_the_loss_coefficient():
    """2 · ½ ρ u² with u = 1/(50 · 10⁻³) = 20 m/s is 20 kPa, in the direction of the flow."""
    line = wave(1, 0.2)
    assert offset(line, 1e-3, 2.0) * line.p == pytest.approx(20e3)
    assert offset(line._replace(flow=-line.flow), 1e-3, 2.0) * line.p == pytest.approx(-20e3)


def test_a_plenum_tells_each_turn_its_own_while_another_is_read():
    """Two solutions of one series share its parts, and threads may read both: the other's turn comes in between."""

    class Shared(PlenumWithLine):
        others = ()

        def __setattr__(self, name, value):
            super().__setattr__(name, value)
            if name == "_last" and self.others:
                other, self.others = self.others, ()
                self.offset(other)

    def turn(k):
        line = wave(k, 0.2)
        held = dict.fromkeys(plenum.names, 0.0)
        return Turn(held, held, {}, {}, {}, 298.15, lambda to: line, 314.0, 1.2, True)

    plenum = Shared("discharge", Parameters(discharge_volume=2e-3, discharge_area=1e-3, discharge_loss=1.0))
    one, other = turn(1), turn(3)
    alone = plenum.coefficient(0, one), plenum.coefficient(0, other)
    assert alone[0] != alone[1]
    plenum.others = other
    assert plenum.coefficient(0, one) == alone[0]


# ---- with the cycle ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"operation.speed": "500 rpm"},
        {"numerics": {"closing": "coupled"}},
        {
            "effects.plenums": {
                **SIZE,
                "discharge_loss": 4,
                "suction_loss": 4,
                "discharge_valve": {"pressure": "0.3 bar"},
            }
        },
        {"effects.plenums": {**SIZE, "discharge_volume": "0.3 l", "suction_volume": "1 l"}},
    ],
    ids=["", "slow", "coupled", "losses", "small"],
)
def test_mass_energy_entropy_and_oil_are_kept(changes):
    result = run({**PLENUMS, **changes})
    assert result.status == "ok"
    assert max(result.balance[name] for name in BALANCES) <= ACCURACY
    assert abs(result.ledger.relative_residue) <= ACCURACY


def test_the_entropy_of_oil_that_takes_room_closes_finely():
    """Behind a loss and with a pulsation, which leaves the oil out (M186): nothing that finer steps do not close."""
    fine = {"effects.oil_volume": {}, "numerics": {"accuracy": 1e-5}}
    result = run({**plenums(discharge_loss=5), **fine})
    assert result.status == "ok"
    assert result.balance.entropy < 1e-5


def test_volumes_without_end_change_nothing():
    wide = run(plenums(suction_volume="1e4 m^3", discharge_volume="1e4 m^3"))
    assert change(wide, run(CARRIED)) < ACCURACY
    assert wide.performance.discharge_pulsation_peak_to_peak < 1.0


def test_both_closings_find_one_cycle():
    one, other = run(PLENUMS), run({**PLENUMS, "numerics": {"closing": "coupled"}})
    assert change(one, other) < ACCURACY
    names = [f"{line}_pulsation_harmonic_{k}" for line in ("suction", "discharge") for k in (1, 2)]
    for name in names:
        pressure = one.performance[f"{name.partition('_')[0]}_pressure"]
        assert abs(one.performance[name] - other.performance[name]) < ACCURACY * pressure, name


def test_the_first_harmonic_rules_and_half_the_volume_doubles_it():
    """A steady flow behind: p_1 = w_1 c²/(Ω V), and the flow hardly feels it."""
    steady = {"discharge_area": None, "suction_area": None}
    one, half = (run(plenums(**steady, discharge_volume=f"{v} l")).performance for v in (40, 20))
    assert one.discharge_pulsation_harmonic_1 > 2.0 * one.discharge_pulsation_harmonic_2
    ratio = half.discharge_pulsation_harmonic_1 / one.discharge_pulsation_harmonic_1
    assert ratio == pytest.approx(2.0, rel=0.02)


def test_the_trace_has_the_figures():
    result = run(PLENUMS)
    p, angle = result.performance, result.cycle["angle"]
    pressure = result.cycle["discharge_plenum_pressure"][angle < 90.0]
    assert np.ptp(pressure) == pytest.approx(p.discharge_pulsation_peak_to_peak, rel=0.01)
    assert 2.0 * abs(np.fft.rfft(pressure)[1]) / 90 == pytest.approx(p.discharge_pulsation_harmonic_1, rel=0.01)
    assert pressure.mean() == pytest.approx(p.discharge_plenum_pressure, rel=1e-4)


@pytest.mark.parametrize("transport", ["carried", "paper"])
def test_the_oil_is_lifted_to_the_plenum_and_loses_the_rest_to_the_line(transport):
    """M28, M187: of 3 kg oil per kg gas, from the pressure at 360° to the plenum's mean; the ledger has the way on."""
    scene = {**plenums(discharge_loss=20), "oil.transport": transport}
    result, lossless = run(scene), run({**PLENUMS, "oil.transport": transport})
    p = result.performance
    oil = p.oil_mass_flow / 1000.0
    lost = oil * (p.discharge_plenum_pressure - 12e5)
    # what the last turn still changes of the plenum's pressure is within a tenth of the accuracy
    assert p.oil_lift_power == pytest.approx(oil * (p.discharge_plenum_pressure - p.injection_pressure), rel=3e-5)
    assert lost > 0.001 * p.shaft_power  # three times the accuracy
    assert abs(result.ledger.residue) < 0.1 * lost
    both = (each.ledger.exergy_destroyed_plenums for each in (result, lossless))
    assert next(both) - next(both) > lost


def test_a_valve_that_takes_pressure_costs_power():
    """The machine that delivers to a line of that pressure."""
    steady = {"discharge_area": None, "suction_area": None, "discharge_volume": "1e4 m^3", "suction_volume": "1e4 m^3"}
    valve = run(plenums(**steady, discharge_valve={"pressure": "1 bar"}))
    line = run({**CARRIED, "operation.discharge.pressure": "13 bar"})
    seen = ("gas_mass_flow", "indicated_power", "trapped_mass", "oil_lift_power")
    assert change(valve, line, seen) < 2 * ACCURACY
    assert valve.performance.discharge_plenum_pressure == pytest.approx(13e5)
    assert valve.ledger.exergy_destroyed_plenums > 0.0


# ---- an independent integration ------------------------------------------------------------------------------------


def monolith(scene, pitches):
    """Return pressures of the discharge plenum over the last pitch: it and all chambers integrated as one by Radau.

    Plenum: dp/dt = c²(p)/V · (flow in − mean flow − A (p − p_d)/c); the mean flow is that of our solution.
    """
    problem, machinery, cycle = closed(scene)
    assert cycle.status == "ok"
    assert cycle.how == "coupled"
    of = evaluate(problem, cycle)
    ours = of.figures
    c, module, context = machinery.composition, machinery.together, machinery.coupled_context
    size, omega, pitch = scene.effects["plenums"].parameters, c.P[P_OMEGA], c.P[P_PITCH]
    flow = -of.streams[2:4, 0].sum() * omega / pitch
    lines, width = c.n_E_all - 3 * PORT_STATE + PORT_STATE, 4
    p_d, rho_d, inverse = (machinery.R[PORT_STATE + cell] for cell in (PRESSURE, DENSITY, EXPONENT))
    sound = np.sqrt(p_d / (inverse * rho_d))
    E, f, g = np.empty(c.n_E_all), np.empty(c.chambers * machinery.n), np.empty(machinery.nq + 1)
    held = machinery.coupled.port_states[-c.chambers :]
    at = c.stream(DISCHARGE_IN)

    def rates(phi, z):
        module.chambers__surroundings(phi, phi + 1e-9, context, E)
        p, rho = z[-1], rho_d * (z[-1] / p_d) ** inverse
        E[lines + PRESSURE], E[lines + DENSITY] = p, rho
        E[lines + 2] = machinery.R[PORT_STATE + 2] + (p / rho - p_d / rho_d) / (1.0 - inverse)
        held[:] = -1.0
        module.chambers__rates(np.ascontiguousarray(z[:-1]), E, context, f, g)
        into = -(g[at] + g[at + width]) * omega
        leaving = flow + size.discharge_area * (p - p_d) / sound
        return np.append(f, p / (inverse * rho) * (into - leaving) / (size.discharge_volume * omega))

    y, p = cycle.y.copy(), p_d
    grid = np.linspace(0.0, pitch, 361)
    for _ in range(pitches):
        inject(machinery, y)
        z, seen = np.append(y, p), []
        for a, b in zip(pitch_breakpoints(machinery), pitch_breakpoints(machinery)[1:], strict=False):
            angles = grid[(grid >= a) & (grid < b)]
            found = solve_ivp(rates, (a, b), z, "Radau", rtol=1e-6, atol=1e-12, t_eval=[*angles, b])
            z = found.y[:, -1]
            seen.append(found.y[-1, : len(angles)])
        y, p = moved_on(machinery, z[:-1]), z[-1]
    return ours, np.concatenate(seen)


@pytest.mark.slow
def test_one_integration_of_all_finds_the_same_pulsation():
    """The suction plenum is endless here; a starting error of the pressure is gone after V/(A c), a few pitches."""
    endless = {"suction_volume": "1e4 m^3", "suction_area": None}
    scene = make({**plenums(**endless), "numerics": {"closing": "coupled", "accuracy": 1e-4}})
    ours, pressure = monolith(scene, 12)
    spectrum = 2.0 * abs(np.fft.rfft(pressure[:360])) / 360
    for k in (1, 2, 3, 4):
        assert spectrum[k] == pytest.approx(ours[f"discharge_pulsation_harmonic_{k}"], rel=0.005), k
    assert np.ptp(pressure) == pytest.approx(ours.discharge_pulsation_peak_to_peak, rel=0.01)  # of eight harmonics
    assert np.mean(pressure) == pytest.approx(12e5, rel=1e-4)


# ---- what scenes say -----------------------------------------------------------------------------------------------


@each_row(
    ("changes", "words"),
    [
        ({"suction_volume": None, "discharge_volume": None, "suction_area": None, "discharge_area": None}, "no plenum"),
        ({"discharge_loss": 2, "discharge_area": None}, "discharge_area: is missing"),
        ({"suction_volume": None}, "suction_volume: is missing"),
        ({"discharge_volume": None, "discharge_area": None, "discharge_valve": {}}, "discharge_valve needs it"),
        ({"harmonics": 2}, "4"),
    ],
)
def test_contradictions_are_faults(changes, words):
    with pytest.raises(SceneError, match=words):
        make(plenums(**changes))


def test_a_line_that_takes_all_pressure_fails_with_a_remedy():
    result = run(plenums(suction_area="1 cm^2", suction_loss=50))
    assert result.status == "failed"
    assert "plenums.suction_area" in result.message


def test_explain_and_the_scenes_text_tell_of_it():
    scene = make(PLENUMS)
    text = " ".join(str(explain(scene)).split())
    assert "pressure of the discharge line over the angle" in text
    assert loads(scene.text).text == scene.text


def test_without_traces_the_figures_are_the_same():
    scene = make(PLENUMS)
    assert simulate(scene, trace=False).performance == run(PLENUMS).performance


def test_a_wave_that_turns_the_flow_round_is_told():
    quiet, loud = run(PLENUMS), run(plenums(discharge_volume="0.2 l", discharge_area="80 cm^2"))
    assert 0.0 < quiet.performance.discharge_line_least_flow < quiet.performance.gas_mass_flow
    assert not quiet.warnings
    assert loud.performance.discharge_line_least_flow < 0.0
    assert any("a check valve would shut" in warning for warning in loud.warnings)


def test_a_plenum_longer_than_half_a_wave_is_told():
    """It has no single pressure: over a quarter of a wave that changes its sign. Half a wave here is 0.4 m and more."""
    short, long = (run(plenums(suction_volume=volume)) for volume in ("8 l", "1 m^3"))
    assert not short.warnings
    (warning,) = long.warnings
    assert warning.startswith("the suction plenum is at least 1 m long, as a cube of its volume, and half a wave")
    line = turn_of_run(plenums(suction_volume="1 m^3"))
    assert PlenumWithLine("suction", Parameters(suction_volume=0.99 * half_wave(line) ** 3)).spread(line) == ""
    assert PlenumWithLine("suction", Parameters(suction_volume=1.01 * half_wave(line) ** 3)).spread(line) != ""


def turn_of_run(changes):
    problem, _, cycle = closed(make(changes))
    return evaluate(problem, cycle).complete.turn


def half_wave(turn):
    """Return half of the sound's way [m] in the time between two lobes."""
    return 0.5 * turn.line("suction").sound * turn.pitch / turn.omega


VALVE = {"discharge_valve": {"area": "12 cm^2", "pressure": "0.1 bar"}}


@pytest.mark.parametrize("valve", [{}, VALVE], ids=["open", "valve"])
def test_the_least_flow_into_the_line_goes_with_the_net_flow(valve):
    """What passes the port also has what gaps between chambers open to it leave open: the port makes that good."""
    problem, _, cycle = closed(make(plenums(**valve)))
    of = evaluate(problem, cycle)
    turn, part = (
        turn_of(problem, of.life, cycle.q),
        PlenumWithLine("discharge", problem.scene.effects["plenums"].parameters),
    )
    line, least = turn.line("discharge"), "discharge_line_least_flow"
    assert line.net == pytest.approx(of.figures.gas_mass_flow, rel=1e-12)
    assert abs(line.flow.mean() / line.net - 1.0) > 1e-6
    assert part.figures(turn)[least] == of.figures[least]
    other = part.figures(turn._replace(line=lambda to: line._replace(net=0.99 * line.net)))[least]
    assert of.figures[least] - other == pytest.approx(0.01 * line.net, rel=0.05 if valve else 1e-9)
