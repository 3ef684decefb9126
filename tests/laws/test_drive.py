"""A drive: speed, motor and twist close with the chambers; the shaft's torques and powers; starts; what goes wrong."""

import math
from functools import cache

import numpy as np
import pytest
from monolith import Monolith, start_of
from scenes import PUMPED_PORT, SOLUBLE_RATE, balanced, closed, make, refusal, run

from screwsim.build import build_parts
from screwsim.cycle.balances import streams_of
from screwsim.cycle.close import close
from screwsim.cycle.guess import lease_for
from screwsim.cycle.pitch import POINTS
from screwsim.cycle.problem import ClosingTask, problem_of
from screwsim.evaluate.evaluation import evaluate
from screwsim.inputs.faults import UsageError
from screwsim.model.compose import compose
from screwsim.model.slots import OF_OIL, P_OMEGA, PORT_OIL, R_TRAPPED
from screwsim.solve import drive
from screwsim.solve.start_up import StartUpRun, start_up, steady_problem
from screwsim.solve.start_up_reading import peak_of

DRIVE = {
    "motor_inertia": "0.8 kg m^2",
    "rotor_inertia": "0.12 kg m^2",
    "coupling": {"linear": {"spring": "5000 N m/rad"}, "damping": "6 N m s/rad"},
    "motor": {"law": "line", "slope": "30 N m s/rad", "torque_limit": "800 N m"},
}
DRIVEN = {"effects.drive": DRIVE}
SLOW = {**DRIVEN, "operation.speed": "700 rpm"}  # above the first resonance: a ripple of some per cent
CORDS = {"linear": None, "rubber_cord": {"inner_radius": "60 mm", "outer_radius": "84 mm", "cords": 283, "discs": 1}}
FINE = {"numerics": {"accuracy": 1e-6}}
KLOSS = {"law": "induction", "breakdown_torque": "600 N m", "breakdown_slip": 0.1}
CYCLE = ("shaft_power", "gas_mass_flow", "isothermal_efficiency", "peak_pressure", "discharge_temperature")


@cache
def closed_with_drive(accuracy):
    problem, machinery, cycle = closed(make({**SLOW, "numerics": {"accuracy": accuracy}}))
    cycle = drive.close_with_drive(ClosingTask(problem, machinery, problem.criteria), cycle)
    of = evaluate(problem, cycle)
    return of, machinery, cycle, problem.parts.shaft.respond(of.complete)


def beside(of, motion, changes):
    """Return the monolith of a cycle: the same scene at a constant speed, with its plenums and widths."""
    constant = lease_for(problem_of(make({path: value for path, value in changes.items() if "drive" not in path})))
    constant.R[:] = of.life.R
    here, there = constant.composition, of.life.composition
    here.P[here.widths] = there.P[there.widths]
    return Monolith(constant, motion.train, motion.no_load_speed, of.pitch.low_pressure, 0.0)


# ---- not named, not there ----


def test_a_scene_without_drive_has_nothing_of_it():
    driven, constant = (compose(build_parts(make(changes))) for changes in (DRIVEN, {}))
    assert "speed__slowness" in driven.text
    assert "slow" not in constant.text and constant.speed_curve is None
    p = run().performance
    assert not {"mean_speed", "speed_ripple", "coupling_torque_peak", "motor_power"} & {*p}
    assert run().balance.drive is None


def test_what_a_drive_is_made_of_is_not_compiled():
    other = {**DRIVEN, "effects.drive.coupling": CORDS, "effects.drive.motor": KLOSS}
    assert compose(build_parts(make(other))).text == compose(build_parts(make(DRIVEN))).text


# ---- the speed ----


def test_constant_speed_is_recovered_as_inertia_grows():
    heavy = {f"effects.drive.{name}_inertia": "1e5 kg m^2" for name in ("motor", "rotor")}
    with_it, without = run({**DRIVEN, **FINE, **heavy}), run(FINE)
    assert with_it.status == "ok"
    assert with_it.performance.speed_ripple < 1e-6
    for name in CYCLE:
        assert with_it.performance[name] == pytest.approx(without.performance[name], rel=2e-6), name


def test_the_ripple_falls_with_the_inertia():
    p, heavier = (
        run({**DRIVEN, "effects.drive.rotor_inertia": inertia}).performance for inertia in ("0.12 kg m^2", "1.2 kg m^2")
    )
    assert p.speed_ripple / heavier.speed_ripple == pytest.approx(10.0, rel=0.05)


def test_chambers_and_drive_in_one_system_repeat_the_motion_that_was_closed_by_turns():
    """Radau on all states together, from the closed state: it comes back to it, with the same speed on the way."""
    of, machinery, cycle, motion = closed_with_drive(1e-6)
    assert cycle.status == "ok" and motion.ripple > 0.05
    together = beside(of, motion, {**SLOW, **FINE})
    complete = of.complete
    assert complete.shaft_power == of.figures.shaft_power
    together.loss = (complete.shaft_power - complete.indicated_power) / complete.omega
    start = start_of(machinery, motion)
    angles, states, end = together.pitch(start)
    n = together.n
    assert np.max(np.abs(end[:n] / start[:n] - 1.0)) < 1e-4
    assert end[n] == pytest.approx(start[n], abs=1e-4 * np.ptp(motion.speed))
    assert end[n + 2] == pytest.approx(start[n + 2], abs=1e-4 * np.ptp(motion.twist))
    assert end[n + 3] == pytest.approx(motion.train.pitch / motion.mean_speed, rel=1e-6)
    grid = np.linspace(0.0, motion.train.pitch, 361)
    from screwsim.machine.drive.collocation import resampled

    ours = np.interp(angles, grid, np.append(resampled(motion.speed, 360), motion.speed[0]))
    assert np.max(np.abs(states[:, n] - ours)) < 1e-3 * np.ptp(motion.speed)


def test_the_chambers_feel_the_mean_speed_of_the_drive_over_time():
    of, machinery, _, motion = closed_with_drive(1e-6)
    assert motion.mean_speed == pytest.approx(of.life.composition.P[P_OMEGA], rel=1e-9)
    tolerance = of.problem.criteria.tolerance
    assert drive.set_speed_curve(of.problem, machinery, motion, tolerance)[0] <= tolerance


def test_the_balances_close_under_a_speed_that_changes():
    result = balanced(run(SLOW))
    assert abs(result.ledger.relative_residue) < 1e-3


def test_the_traces_flows_are_those_of_the_time():
    """dm/dt = ω dm/dφ where one port alone is open: in the suction phase, at the speed of that angle."""
    result = run(SLOW)
    cycle = result.cycle
    angle, mass, speed = (cycle[name] for name in ("angle", "gas_mass", "speed"))
    flows = sum(cycle[name] for name in cycle if name.startswith("mass_flow_"))
    rate = np.gradient(mass, np.radians(angle)) * speed
    quiet = (angle > 100.0) & (angle < 300.0)
    off = np.abs(flows[quiet] / rate[quiet] - 1.0)
    assert np.quantile(off, 0.97) < 2e-4  # differences over a degree; the rest stand at breakpoints of the laws
    assert np.ptp(speed) > 0.03 * speed.mean()


# ---- torques and powers ----


def test_the_motor_gives_gas_work_losses_and_what_the_coupling_takes():
    result = run(SLOW)
    p = result.performance
    assert p.motor_power == pytest.approx(p.shaft_power + p.coupling_loss, rel=1e-9)
    assert p.coupling_loss > 0.0
    assert result.balance.drive < 1e-9
    assert p.coupling_torque_mean == pytest.approx(p.shaft_power / p.mean_speed, rel=1e-9)


def test_the_loss_of_a_coupling_errs_by_twice_what_its_swing_does():
    """It goes with the square of it."""
    error = run(SLOW).error
    swing = min(error.coupling_torque_amplitude, error.twist_amplitude)
    assert error.coupling_loss >= (1.0 - 1e-9) * 2.0 * swing > 0.0


def test_the_electrical_power_pays_for_the_coupling_too():
    p = run({**SLOW, "effects.motor": {"rated_power": "11 kW"}}).performance
    assert p.coupling_loss > 5e-4 * p.shaft_power
    assert p.electrical_power == pytest.approx(p.motor_power + p.motor_loss, rel=1e-12)
    assert p.motor_efficiency == pytest.approx(p.shaft_power / p.electrical_power, rel=1e-12)


def test_the_motors_speed_follows_from_its_line():
    p = run({**DRIVEN, "effects.drive.motor": KLOSS, "effects.drive.speed": "no_load"}).performance
    assert p.no_load_speed == pytest.approx(100.0 * math.pi, rel=1e-9)
    slip = 1.0 - p.mean_speed / p.no_load_speed
    expected = 2.0 * 600.0 / (slip / 0.1 + 0.1 / slip)
    assert p.coupling_torque_mean == pytest.approx(expected, rel=1e-3)  # of the mean speed; the ripple is 2e-3
    at_that_speed = run({"operation.speed": f"{float(p.mean_speed)!r} rad/s"}).performance
    assert p.gas_mass_flow == pytest.approx(at_that_speed.gas_mass_flow, rel=3e-4)


def test_rubber_cords_carry_the_mean_torque_at_their_twist():
    from screwsim.machine.drive.rubber_cord_coupling import RubberCordCoupling

    p = run({**DRIVEN, "effects.drive.coupling": CORDS}).performance
    cords = RubberCordCoupling(inner_radius=0.06, outer_radius=0.084, cords=283, discs=1)
    assert p.twist_mean == pytest.approx(cords.twist(p.coupling_torque_mean), rel=1e-3)  # ripple of the twist squared
    inertia = 1.0 / (1.0 / 0.8 + 1.0 / 0.12)
    expected = math.sqrt(cords.stiffness(p.twist_mean) / inertia) / (2.0 * math.pi)
    assert p.torsional_frequency == pytest.approx(expected, rel=1e-12)
    assert p.resonance_speed == pytest.approx(2.0 * math.pi * expected / 4.0, rel=1e-12)


# ---- what goes wrong ----


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"motor.torque_limit": "90 N m"}, "the motor stalls: the rotors need"),
        ({"coupling.linear.largest_twist": "1 deg"}, "under the steady ripple the coupling fails: twisted by"),
        ({"coupling": {"rubber_cord": {"cords": 1, "breaking_strain": 0.05}}}, "the coupling carries"),
    ],
)
def test_what_cannot_run_fails_and_says_why(changes, words):
    result = run({**DRIVEN, **{f"effects.drive.{path}": value for path, value in changes.items()}})
    assert result.status == "failed"
    assert words in result.message
    assert all(value is None or math.isfinite(value) for value in result.performance.values())
    assert result.performance.shaft_power > 0.0  # the chambers' part is there


def test_resonance_and_a_torque_that_changes_its_sign_are_said():
    result = run({**DRIVEN, "operation.speed": "520 rpm", "effects.drive.coupling.damping": "1.5 N m s/rad"})
    assert result.status == "ok"
    assert any("resonance: lobe harmonic 1 meets the torsional frequency at 522.58 rpm" in w for w in result.warnings)
    assert any("the coupling torque changes its sign" in w for w in result.warnings)


def test_cords_that_the_ripple_breaks_are_said():
    sound = {**CORDS, "rubber_cord": {**CORDS["rubber_cord"], "layers": 2, "discs": 2, "breaking_strain": 0.02}}
    calm, shaken = (
        run({**DRIVEN, "effects.drive.coupling": sound, "operation.speed": speed}) for speed in ("3000 rpm", "830 rpm")
    )
    assert calm.status == "ok"
    assert shaken.status == "failed"
    assert "under the steady ripple the cords break: strain" in shaken.message


def test_a_drive_that_stops_within_a_pitch_has_no_steady_motion():
    weak = {"effects.drive.rotor_inertia": "0.001 kg m^2", "effects.drive.coupling.linear.spring": "20 N m/rad"}
    result = run({**DRIVEN, **weak, "operation.speed": "250 rpm", "effects.drive.coupling.damping": "0 N m s/rad"})
    assert result.status == "failed"
    assert "the drive has no steady motion" in result.message


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"coupling": {}}, "effects.drive.coupling: needs one of linear and rubber_cord"),
        ({"motor": {"law": "line"}}, "effects.drive.motor.slope: is missing (line needs it)"),
        (
            {"coupling": {"rubber_cord": {"inner_radius": "0.3 m"}}},
            "rubber_cord.outer_radius: is not above inner_radius",
        ),
        ({"rotor_inertia": "0.1 kg"}, "'0.1 kg' is not an inertia (write e.g. '0.5 kg m^2')"),
    ],
)
def test_a_fault_is_found_with_its_remedy(changes, words):
    assert words in refusal({**DRIVEN, **{f"effects.drive.{path}": value for path, value in changes.items()}})


# ---- start-up ----

CREEP = 200.0 * math.pi / 30.0


@cache
def started(slope="100 N m s/rad"):
    return start_up(make({**DRIVEN, "effects.drive.motor.slope": slope, "operation.speed": "900 rpm"}), CREEP)


def test_a_start_ends_at_the_steady_motion():
    found = started()
    steady = run({**DRIVEN, "effects.drive.motor.slope": "100 N m s/rad", "operation.speed": "900 rpm"}).performance
    assert found.status == "ok"
    assert found.figures.steady_speed == pytest.approx(30.0 * math.pi, rel=1e-9)
    last = found.traces["angle"] > found.traces["angle"][-1] - math.pi / 2.0
    torque = found.traces["coupling_torque"][last]
    assert torque.mean() == pytest.approx(steady.coupling_torque_mean, rel=0.02)
    assert 0.5 * np.ptp(torque) == pytest.approx(steady.coupling_torque_amplitude, rel=0.05)


@pytest.mark.parametrize("offset", [-0.49, -0.3, 0.0, 0.2, 0.49])
def test_a_peak_between_points_is_found_with_its_time(offset):
    """Of a cosine the parabola is h⁴ off, h the step in radians, the highest point up to h²/8."""
    angle = 0.05 * (np.arange(-20, 21) + offset)
    height, place = peak_of(np.cos(angle), 2.0 * angle)
    assert height == pytest.approx(1.0, abs=0.05**4) and place == pytest.approx(0.0, abs=0.05**3)


def test_a_plateau_and_an_end_are_no_summits():
    time = np.arange(4.0)
    assert peak_of(np.array([1.0, 5.0, 5.0, 2.0]), time) == (5.0, 1.0)
    assert peak_of(np.array([1.0, 2.0, 3.0, 5.0]), time) == (5.0, 3.0)


def test_the_peaks_of_a_start_hardly_depend_on_the_points_between_which_they_are_read():
    traces, figures = started().traces, started().figures
    for name, figure in (("coupling_torque", "coupling_torque_peak"), ("twist", "twist_peak")):
        for first in (0, 1):
            other, _ = peak_of(np.abs(traces[name][first::2]), traces["time"][first::2])
            assert other == pytest.approx(figures[figure], rel=2e-5)
        assert figures[figure] >= np.max(np.abs(traces[name]))


def test_a_start_takes_along_what_an_effect_adds_to_the_states():
    changes = {**SOLUBLE_RATE, "effects.drive.motor.slope": "100 N m s/rad", "operation.speed": "900 rpm"}
    found = start_up(make({**DRIVEN, **changes}), CREEP)
    assert found.status == "ok"
    assert found.figures.residue < 1e-5
    assert found.figures.coupling_torque_steady > started().figures.coupling_torque_steady  # flashed gas is compressed


def test_a_start_takes_in_oil_that_the_suction_gas_brings():
    """The chambers hold next to no oil at rest; an infinite rate of its temperature ended such starts at 0 s."""
    found = start_up(make({**DRIVEN, "oil.transport": "carried", "effects.suction_line": {}}), CREEP, longest=0.05)
    assert found.message.startswith("after ")
    assert found.figures.end_speed > 2.0 * CREEP


def test_a_start_says_that_it_does_not_follow_plenums():
    plenums = {"effects.plenums": {"discharge_volume": "3 l", "discharge_area": "15 cm^2"}}
    with_plenums, without = (start_up(make({**DRIVEN, **more}), CREEP, longest=0.05) for more in (plenums, {}))
    told = [any("a start does not follow plenums" in each for each in one.warnings) for one in (with_plenums, without)]
    assert told == [True, False]


def test_a_pumps_oil_goes_with_the_speed_in_a_start():
    """Through a bore, too, the ratio to the gas is the stated one at any speed: it was in proportion to 1/speed."""
    problem = steady_problem(make({**DRIVEN, **PUMPED_PORT}), CREEP)
    machinery = lease_for(problem)
    task = ClosingTask(problem, machinery, problem.criteria)
    of = evaluate(problem, drive.close_with_drive(task, close(task)))
    start = StartUpRun(of, machinery, problem.parts.shaft.respond(of.complete), CREEP, 10.0)
    integrate, ratios = machinery.pitch, []

    def watched(*arguments):
        found = integrate(*arguments)
        oil = streams_of(machinery.composition, found[-1])[PORT_OIL, OF_OIL]
        ratios.append(float(oil) / float(machinery.R[R_TRAPPED]))
        return found

    machinery.pitch = watched
    for _ in range(6):
        start.go_on(start.advance())
    assert start.drive[1] < 0.4 * start.steady.mean_speed
    assert ratios == pytest.approx([3.0] * len(ratios), rel=0.1)  # the pump's gas is that of the chamber before


def test_a_pitch_of_a_start_is_that_of_chambers_and_drive_in_one_system():
    """The fifth pitch, at about 88 rad/s: Radau from the same state, under the same constant torque of the losses."""
    changes = {**DRIVEN, "numerics": {"accuracy": 1e-5}, "operation.speed": "900 rpm"}
    problem = steady_problem(make(changes), CREEP)
    machinery = lease_for(problem)
    cycle = drive.close_with_drive(
        ClosingTask(problem, machinery, problem.criteria), close(ClosingTask(problem, machinery, problem.criteria))
    )
    of = evaluate(problem, cycle)
    steady = problem.parts.shaft.respond(of.complete)
    start = StartUpRun(of, machinery, steady, CREEP, 10.0)
    for _ in range(4):
        start.go_on(start.advance())
    omega_2, motor_speed, twist, _ = start.drive
    begins = np.concatenate([start.chambers, [math.sqrt(omega_2), motor_speed, twist, 0.0]])
    step = start.advance()
    together = beside(of, steady, changes)
    together.loss = step.loss_torque
    end = together.pitch(begins)[2]
    n, m = together.n, step.motion
    assert step.settled
    assert m.speed[-1] == pytest.approx(end[n], rel=2e-5)
    assert m.motor_speed[-1] == pytest.approx(end[n + 1], rel=2e-5)
    assert m.twist[-1] == pytest.approx(end[n + 2], abs=1e-4 * np.max(np.abs(m.twist)))
    assert m.time[-1] - m.time[0] == pytest.approx(end[n + 3], rel=2e-5)
    assert np.max(np.abs(step.states / end[:n] - 1.0)) < 1e-4


def test_the_energy_of_a_start_closes():
    f = started().figures
    assert f.stored > 0.3 * f.motor_work > 0.0
    assert f.motor_work == pytest.approx(f.gas_work + f.loss_work + f.coupling_work + f.stored, rel=1e-5)
    assert f.residue < 1e-5


def test_the_gas_torque_of_a_start_does_not_jump_where_a_pitch_ends():
    """It begins at 0, as all chambers are at the suction line's pressure, and passes from pitch to pitch.

    The first point of each pitch had the torque of that pitch's end: 53 N m at rest, and 14 N m too much a pitch later.
    """
    torque = started().traces["gas_torque"]
    assert abs(torque[0]) < 1e-3 * torque.max()
    first = np.arange(POINTS, len(torque) - 1, POINTS)
    bend = torque[first] - 0.5 * (torque[first - 1] + torque[first + 1])
    assert np.max(np.abs(bend)) < 2e-3 * torque.max()  # a trace's own curvature


def test_the_traces_of_a_start_are_those_of_one_time():
    t = started().traces
    assert np.all(np.diff(t["time"]) > 0.0)
    assert all(np.isfinite(values).all() for values in t.values())
    assert np.allclose(np.gradient(t["angle"], t["time"])[2:-2], t["speed"][2:-2], rtol=0.01)
    f = started().figures
    assert f.coupling_torque_peak >= t["coupling_torque"].max() > 1.5 * f.coupling_torque_steady


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"motor": {**KLOSS, "breakdown_slip": 0.01}}, "the motor cannot start the machine: the rotors stop"),
        ({"coupling.linear.largest_twist": "2.5 deg"}, "of the start the coupling fails"),
        ({"motor.torque_limit": "90 N m"}, "there is no steady speed to start to: the motor stalls"),
    ],
)
def test_a_start_that_fails_says_why(changes, words):
    scene = make({**DRIVEN, **{f"effects.drive.{path}": value for path, value in changes.items()}})
    found = start_up(scene, 20.0 * math.pi / 30.0)
    assert found.status == "failed"
    assert words in found.message
    assert all(np.isfinite(values).all() for values in found.traces.values())


def test_a_start_that_displaced_oil_prevents_names_it_and_the_line_of_the_scene():
    """Displaced oil comes whatever the speed, so that lifting it loads a creeping machine most."""
    oil = {"kind": "displacement", "orifice_diameter": "8 mm", "temperature": "20 degC"}
    oil = {"oil_supply": oil, "effects.oil_pump": False}
    weak = {**DRIVEN, "effects.drive.motor": {**KLOSS, "breakdown_slip": 0.01}}
    with_oil, without = (start_up(make({**weak, **each}), CREEP).message for each in (oil, {}))
    assert "N m of which lift its oil" in with_oil and "or with less oil)" in with_oil
    assert "oil" not in without and "at a lower operation.discharge.pressure)" in without


def test_a_start_that_stops_within_its_first_pitch_tells_no_energies():
    """What is told is of whole pitches: where there is none, no work was done is not the answer."""
    f = start_up(make({**DRIVEN, "effects.drive.motor": {**KLOSS, "breakdown_slip": 0.01}}), CREEP).figures
    assert f.turns < 0.25 and f.time > 0.0
    assert all(
        f[name] is None for name in ("motor_work", "gas_work", "loss_work", "coupling_work", "stored", "residue")
    )


def test_a_start_that_takes_too_long_says_how_far_it_came():
    found = start_up(make(DRIVEN), CREEP, longest=0.05)
    assert found.status == "failed"
    assert "not yet the steady" in found.message


@pytest.mark.parametrize(
    ("changes", "creep", "words"),
    [
        ({}, 1.0, "the scene has no drive"),
        ({**DRIVEN, "effects.drive.motor": {"law": "line", "slope": "30 N m s/rad"}}, 1.0, "needs the motor's limit"),
        (DRIVEN, 400.0, "slower creep"),
        (DRIVEN, 0.0, "creeping speed above 0"),
    ],
)
def test_a_start_that_makes_no_sense_is_refused(changes, creep, words):
    with pytest.raises(UsageError, match=words):
        start_up(make(changes), creep)
