"""The motor's torque over its speed."""

import numpy as np
import pytest
from each_row import each_row

from screwsim.machine.drive.train import Motor, check_motor

INDUCTION = Motor(law="induction", breakdown_torque=400.0, breakdown_slip=0.1)
LINE = Motor(law="line", slope=30.0, torque_limit=500.0)
NO_LOAD = 314.0


def test_kloss_has_its_breakdown_torque_at_the_breakdown_slip_and_nowhere_more():
    assert INDUCTION.torque(0.9 * NO_LOAD, NO_LOAD) == pytest.approx(400.0, rel=1e-12)
    speeds = np.linspace(0.0, NO_LOAD, 1001)
    assert INDUCTION.torque(speeds, NO_LOAD).max() <= 400.0 * (1.0 + 1e-12)


def test_kloss_starts_with_the_torque_of_slip_one():
    assert INDUCTION.torque(0.0, NO_LOAD) == pytest.approx(2.0 * 400.0 / (0.1 + 10.0), rel=1e-12)


@pytest.mark.parametrize("motor", [INDUCTION, LINE], ids=["induction", "line"])
def test_without_load_the_motor_gives_nothing_and_above_it_brakes(motor):
    assert motor.torque(NO_LOAD, NO_LOAD) == 0.0
    assert motor.torque(1.01 * NO_LOAD, NO_LOAD) < 0.0


@each_row("motor", [INDUCTION, LINE], ids=["induction", "line"])
@each_row("moment", [-150.0, 0.0, 10.0, 390.0])
def test_speed_and_no_load_speed_are_inverses_of_the_torque(motor, moment):
    omega = motor.speed(NO_LOAD, moment)
    assert motor.torque(omega, NO_LOAD) == pytest.approx(moment, abs=1e-9)
    assert motor.no_load_speed(omega, moment) == pytest.approx(NO_LOAD, rel=1e-12)


@pytest.mark.parametrize("motor", [INDUCTION, LINE], ids=["induction", "line"])
def test_slopes_are_derivatives(motor):
    omega, step = np.array([20.0, 250.0, 300.0]), 1e-4
    by_speed, by_no_load = motor.slopes(omega, NO_LOAD)
    across = (motor.torque(omega + step, NO_LOAD) - motor.torque(omega - step, NO_LOAD)) / (2.0 * step)
    other = (motor.torque(omega, NO_LOAD + step) - motor.torque(omega, NO_LOAD - step)) / (2.0 * step)
    assert np.allclose(by_speed, across, rtol=1e-6)
    assert np.allclose(by_no_load, other, rtol=1e-6)


def test_a_start_has_the_limit_of_a_line():
    assert LINE.limited_torque(0.0, NO_LOAD) == 500.0
    assert LINE.limited_torque(2.0 * NO_LOAD, NO_LOAD) == -500.0


@pytest.mark.parametrize(
    ("motor", "path"),
    [
        (Motor(law="line"), "motor.slope"),
        (Motor(law="induction", breakdown_torque=1.0), "motor.breakdown_slip"),
        (Motor(law="line", slope=1.0, breakdown_slip=0.1), "motor.breakdown_slip"),
        (Motor(law="induction", breakdown_torque=1.0, breakdown_slip=0.1, slope=2.0), "motor.slope"),
    ],
)
def test_what_is_missing_or_foreign_is_a_fault(motor, path):
    assert [fault.path for fault in check_motor(motor, "motor")] == [path]
