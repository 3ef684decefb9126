"""The drive over one pitch from a given state."""

import math
from dataclasses import replace

import numpy as np
import pytest

from screwsim.machine.drive.run_up import run_up
from screwsim.machine.drive.train import LinearCoupling, Motor, Train

MOTOR = Motor(law="line", slope=1e3, torque_limit=300.0)
TRAIN = Train(0.6, 0.2, LinearCoupling(spring=1e5), 20.0, MOTOR, True, 300.0, 4)
LOAD = np.full(361, 60.0)


def moving(creep, twist):
    return np.array([creep**2, creep, twist, 0.0])


def test_a_stiff_drive_gains_speed_as_one_mass():
    """ω² = ω_0² + 2 (M − M_L) φ/(J_m + J_r); the twist that carries this is there from the start."""
    twist = (60.0 + 0.2 * (300.0 - 60.0) / 0.8) / 1e5
    motion = run_up(TRAIN, 1e3, moving(5.0, twist), LOAD, 5.0)
    expected = 25.0 + 2.0 * 240.0 / 0.8 * np.linspace(0.0, TRAIN.pitch, 361)
    assert np.allclose(motion.squares, expected, rtol=2e-3)


def test_motor_work_is_load_loss_and_what_is_stored():
    motion = run_up(TRAIN, 1e3, moving(3.0, 0.0), LOAD, 3.0)
    stored = TRAIN.stored(motion.speed[-1], motion.motor_speed[-1], motion.twist[-1]) - TRAIN.stored(3.0, 3.0, 0.0)
    assert motion.damped > 0.0
    assert motion.motor_work == pytest.approx(motion.damped + 60.0 * TRAIN.pitch + stored, rel=1e-6)


def test_slopes_are_those_of_the_square_of_the_speed():
    """At 100 rad/s a row is 0.04 ms, a period of the free motion 51 of them: differences err by its square, 0.3 %."""
    motion = run_up(TRAIN, 1e3, moving(100.0, 0.0), LOAD, 3.0)
    across = np.gradient(motion.squares, TRAIN.pitch / 360)
    assert np.allclose(motion.slopes[1:-1], across[1:-1], atol=5e-3 * np.max(np.abs(across)))


def test_a_load_above_the_motors_limit_stops_the_rotors():
    motion = run_up(TRAIN, 1e3, moving(3.0, 0.0), np.full(361, 5e3), 3.0)
    assert motion.stalled
    assert np.isfinite(motion.time).all()
    assert len(motion.time) < 361


def test_rotors_that_stop_twice_between_two_angles_have_stopped():
    """A coupling wound up breaks them away under 400 N m, a motor of 300 N m does not keep them turning."""
    motion = run_up(TRAIN, 1e3, moving(3.0, 0.0), np.full(3, 400.0), 3.0)
    assert motion.stalled
    assert motion.held > 0.0
    assert motion.time.tolist() == [0.0]  # no angle but the first is reached


def test_rotors_that_come_to_rest_break_away_when_the_coupling_carries_the_load():
    """A slack coupling, 250 N m of load at once, a motor of 300 N m: held until Θ = 250 N m (1 + 2 %)/K, then on."""
    soft = replace(TRAIN, coupling=LinearCoupling(spring=2e3), damping=0.0)
    motion = run_up(soft, 1e3, moving(3.0, 0.0), np.full(361, 250.0), 3.0)
    assert not motion.stalled
    assert motion.held > 0.0
    stored = soft.stored(motion.speed[-1], motion.motor_speed[-1], motion.twist[-1]) - soft.stored(3.0, 3.0, 0.0)
    assert motion.motor_work == pytest.approx(motion.damped + 250.0 * soft.pitch + stored, rel=1e-4)
    i = int(np.argmax(np.diff(motion.time)))  # the row across the rest
    assert motion.twist[i] < 1.02 * 250.0 / 2e3 < motion.twist[i + 1] + 0.01


def test_without_coupling_damping_the_torque_peak_is_that_of_a_step():
    """A step of motor torque on two resting masses: the spring's peak is twice its mean share M J_r/(J_m + J_r)."""
    free = replace(TRAIN, damping=0.0, coupling=LinearCoupling(spring=1e6))
    state, peak, share = moving(2.0, 0.0), 0.0, 0.2 / 0.8
    motion = run_up(free, 1e4, state, np.zeros(361), 2.0)
    peak = float(motion.coupling_torque.max())
    assert peak == pytest.approx(2.0 * 300.0 * share, rel=0.01)
    assert math.isfinite(motion.time[-1])
