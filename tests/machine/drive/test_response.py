"""The periodic motion of two masses with a spring between them, under a torque that repeats every lobe pitch."""

import math
from dataclasses import replace

import numpy as np
import pytest
from each_row import each_row

from screwsim.machine.drive.collocation import POINTS, differentiation, resampled
from screwsim.machine.drive.response import NoMotion, extremes, peak_to_peak, respond
from screwsim.machine.drive.rubber_cord_coupling import RubberCordCoupling
from screwsim.machine.drive.run_up import run_up
from screwsim.machine.drive.train import LinearCoupling, Motor, Train

OMEGA = 100.0 * math.pi
LINE = Motor(law="line", slope=50.0)
TRAIN = Train(0.6, 0.15, LinearCoupling(spring=5000.0), 5.0, LINE, True, OMEGA, 4)
PHI = np.arange(360) * TRAIN.pitch / 360
ORDERS = {1: 50.0, 3: 10.0 * np.exp(0.4j)}  # complex amplitudes of the torque [N m] by lobe harmonic
PULSATION = sum((amplitude * np.exp(1j * 4 * k * PHI)).real for k, amplitude in ORDERS.items())
LOAD = 120.0 + PULSATION
MEAN = 120.0


def closed_form(train, order, amplitude, omega):
    """Return the complex amplitudes of rotor speed and coupling torque of the linear two-mass system in time."""
    i_w = 1j * order * train.lobes * omega
    spring = train.coupling.spring / i_w + train.damping
    inner = np.array(
        [
            [train.rotor_inertia * i_w + spring, -spring],
            [-spring, train.motor_inertia * i_w + (train.motor.slope or 0.0) + spring],
        ]
    )
    rotors, motor = np.linalg.solve(inner, [-amplitude, 0.0])
    return rotors, spring * (motor - rotors)


def harmonic(curve, order):
    return 2.0 / POINTS * np.fft.rfft(curve)[order]


@each_row("over", [0.3, 0.7, 1.0, 1.4, 3.0])
def test_a_linear_coupling_answers_as_the_closed_form_of_two_masses(over):
    """Below, in and above the first resonance; a pulsation of 1e-4 keeps the square of the ripple below 1e-7."""
    omega = over * TRAIN.resonance_speed(0.0)
    found = respond(TRAIN, MEAN + 1e-4 * PULSATION, omega)
    for order, amplitude in ORDERS.items():
        rotors, torque = closed_form(TRAIN, order, 1e-4 * amplitude, omega)
        assert abs(harmonic(found.speed, order) / rotors - 1.0) < 1e-4
        assert abs(harmonic(found.coupling_torque, order) / torque - 1.0) < 1e-4


def test_what_the_closed_form_leaves_out_is_of_the_second_order():
    """The first harmonic's deviation falls with the square of the pulsation."""
    _, torque = closed_form(TRAIN, 1, ORDERS[1], OMEGA / 5)
    off = [
        abs(harmonic(respond(TRAIN, MEAN + size * PULSATION, OMEGA / 5).coupling_torque, 1) / (size * torque) - 1.0)
        for size in (0.2, 0.1)
    ]
    assert 3.0 < off[0] / off[1] < 5.0


@pytest.mark.parametrize("coupling", [LinearCoupling(spring=5000.0), RubberCordCoupling(discs=1, cords=60)])
@pytest.mark.parametrize("over", [0.5, 1.0, 2.0])
def test_the_motion_returns_to_itself_when_it_is_integrated(coupling, over):
    """DOP853 over one pitch from the collocated state; the torque between its points is linear (3e-5 of it)."""
    train = replace(TRAIN, coupling=coupling)
    omega = over * train.resonance_speed(coupling.twist(MEAN))
    found = respond(train, LOAD, omega)
    load = np.append(LOAD, LOAD[0])
    start = np.array([found.speed[0] ** 2, found.motor_speed[0], found.twist[0], 0.0])
    motion = run_up(train, found.no_load_speed, start, load, 1.0)
    scale = np.ptp(found.twist)
    assert motion.speed[-1] == pytest.approx(found.speed[0], abs=3e-4 * np.ptp(found.speed))
    assert motion.twist[-1] == pytest.approx(found.twist[0], abs=3e-4 * scale)
    assert np.max(np.abs(motion.twist[:-1] - resampled(found.twist, 360))) < 3e-4 * scale
    assert motion.time[-1] == pytest.approx(train.pitch / omega, rel=1e-5)


def test_the_mean_speed_over_time_is_the_one_that_is_held():
    found = respond(TRAIN, LOAD, OMEGA / 5)
    assert found.ripple > 0.02
    assert found.mean_speed == pytest.approx(OMEGA / 5, rel=1e-12)


def test_motor_work_is_load_and_loss_of_the_coupling():
    found = respond(TRAIN, LOAD, OMEGA / 5)
    slip = found.motor_speed - found.speed
    motor = found.power(found.motor_torque, found.motor_speed)
    loss = found.power(TRAIN.damping * slip, slip)
    assert loss > 0.0
    assert motor == pytest.approx(loss + MEAN * found.mean_speed, rel=1e-9)


def test_speed_is_constant_as_inertia_grows():
    ripples = [
        respond(replace(TRAIN, rotor_inertia=0.15 * size, motor_inertia=0.6 * size), LOAD, OMEGA).ripple
        for size in (1e2, 1e4)
    ]
    assert ripples[0] / ripples[1] == pytest.approx(100.0, rel=1e-3)
    assert ripples[1] < 1e-6


def test_a_speed_that_is_not_held_lies_on_the_motors_line():
    train = replace(TRAIN, holds_mean=False, motor=Motor(law="induction", breakdown_torque=400.0, breakdown_slip=0.1))
    found = respond(train, LOAD, OMEGA)
    assert found.no_load_speed == pytest.approx(OMEGA, rel=1e-12)
    assert found.mean_speed == pytest.approx(train.motor.speed(OMEGA, MEAN), rel=1e-4)


def test_the_torsional_frequency_is_that_of_two_free_masses():
    expected = math.sqrt(5000.0 * (1.0 / 0.6 + 1.0 / 0.15)) / (2.0 * math.pi)
    assert TRAIN.frequency(0.0) == pytest.approx(expected, rel=1e-12)
    assert TRAIN.resonance_speed(0.0, 2) == pytest.approx(2.0 * math.pi * expected / 8.0, rel=1e-12)
    assert TRAIN.near_resonance(0.0, 1.05 * TRAIN.resonance_speed(0.0, 2)) == 2
    assert TRAIN.near_resonance(0.0, 1.5 * TRAIN.resonance_speed(0.0)) is None


def test_a_stiffening_coupling_has_a_frequency_that_rises_with_the_load():
    train = replace(TRAIN, coupling=RubberCordCoupling())
    twists = [train.coupling.twist(moment) for moment in (100.0, 11768.0)]
    frequencies = [train.frequency(twist) for twist in twists]
    stiffness = [train.coupling.stiffness(twist) for twist in twists]
    assert frequencies[1] / frequencies[0] == pytest.approx(math.sqrt(stiffness[1] / stiffness[0]), rel=1e-12)
    assert frequencies[1] > 1.2 * frequencies[0]


@pytest.mark.parametrize(
    ("change", "load", "words"),
    [
        ({"motor": Motor(law="line", slope=50.0, torque_limit=100.0)}, LOAD, "stalls: the rotors need 120 N m"),
        ({"holds_mean": False, "motor": Motor(law="line", slope=0.1)}, LOAD, "leaves a speed of"),
        ({"coupling": RubberCordCoupling(cords=1, breaking_strain=0.1)}, LOAD, "the coupling carries"),
        ({"damping": 0.0, "motor": Motor(law="line", slope=1e-3)}, MEAN + 3.0 * PULSATION, "no steady motion"),
    ],
)
def test_where_there_is_no_steady_motion_it_says_why(change, load, words):
    train = replace(TRAIN, **change)
    with pytest.raises(NoMotion, match=words):
        respond(train, load, TRAIN.resonance_speed(0.0))


def test_differentiation_is_exact_for_harmonics():
    x = np.arange(POINTS) * TRAIN.pitch / POINTS
    assert np.allclose(differentiation(TRAIN.pitch) @ np.sin(4 * 7 * x), 28.0 * np.cos(4 * 7 * x), atol=1e-9)


def test_resampling_keeps_harmonics():
    fine = resampled(np.cos(12 * PHI + 0.3))
    assert np.allclose(fine, np.cos(12 * np.arange(POINTS) * TRAIN.pitch / POINTS + 0.3), atol=1e-12)


@pytest.mark.parametrize("harmonic", [1, 3, 7])
def test_a_ripple_is_that_of_the_curve_not_of_its_points(harmonic):
    """Tops lie between the points: a swing of values every half degree was off by up to 1.4e-3 of itself."""
    curve = 5.0 + np.cos(harmonic * 2.0 * np.pi * np.arange(POINTS) / POINTS + 0.4)
    assert peak_to_peak(curve) == pytest.approx(2.0, rel=1e-5 * harmonic**2)
    assert extremes(curve) == pytest.approx((4.0, 6.0), rel=1e-5 * harmonic**2)
