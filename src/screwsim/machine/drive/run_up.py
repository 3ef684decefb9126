"""The drive over one lobe pitch from a given state, under a torque that is given by the angle: a start-up's step.

What: M210 with the angle of the rotors as the independent variable; the square of their speed is a state, so that nothing
is singular but the time (M218). Energies are integrated beside.
How: DOP853 of scipy, which lands on the angles asked for.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from screwsim.machine.drive.train import Train

Array = np.ndarray
RTOL = 1e-8
STALLED = 0.05  # of the creeping speed: below it the rotors stand still


class Motion(NamedTuple):
    """The drive along angles: squares of the speed and their slopes, motor speed, twist, time, torques; energies at the end.

    Speeds [rad/s], twist [rad], time [s], torques [N m]; motor_work, damped [J]. `stalled`: the rotors stopped at the last
    angle.
    """

    squares: Array
    slopes: Array
    motor_speed: Array
    twist: Array
    time: Array
    coupling_torque: Array
    motor_torque: Array
    motor_work: float
    damped: float
    stalled: bool

    @property
    def speed(self) -> Array:
        """Return the speed of the rotors [rad/s]."""
        return np.sqrt(self.squares)


def run_up(train: Train, no_load: float, state: Array, load: Array, creep: float) -> Motion:
    """Return the motion from (ω², ω_m, Θ, t) under the torque `load`, given at even angles of a pitch, ends included."""
    from scipy.integrate import solve_ivp

    grid = np.linspace(0.0, train.pitch, len(load))
    coupling, motor, c = train.coupling, train.motor, train.damping
    least = (STALLED * creep) ** 2

    def rates(phi: float, y: Array) -> list[float]:
        omega = max(y[0], least) ** 0.5
        slip = y[1] - omega
        spring = coupling.torque(y[2]) + c * slip
        drive = motor.limited_torque(y[1], no_load)
        asked = float(np.interp(phi, grid, load))
        return [
            2.0 * (spring - asked) / train.rotor_inertia,
            (drive - spring) / (train.motor_inertia * omega),
            slip / omega,
            1.0 / omega,
            drive * y[1] / omega,
            c * slip * slip / omega,
        ]

    def standstill(_phi: float, y: Array) -> float:
        return y[0] - least

    standstill.terminal = True  # type: ignore[attr-defined]
    size = [no_load**2, no_load, 0.1, 1.0, 1e3, 1e3]
    found = solve_ivp(
        rates,
        (0.0, train.pitch),
        [*state, 0.0, 0.0],
        "DOP853",
        grid,
        events=standstill,
        rtol=RTOL,
        atol=RTOL * np.array(size),
        max_step=train.pitch / 16.0,
    )
    w, motor_speed, twist, time, work, damped = found.y
    omega = np.sqrt(np.maximum(w, least))
    spring = np.array([coupling.torque(each) for each in twist]) + c * (motor_speed - omega)
    drive = np.array([motor.limited_torque(each, no_load) for each in motor_speed])
    slopes = 2.0 * (spring - load[: len(w)]) / train.rotor_inertia
    ended = found.status == 0 and len(w) == len(grid)
    return Motion(
        omega**2, slopes, motor_speed, twist, time, spring, drive, float(work[-1]), float(damped[-1]), not ended
    )
