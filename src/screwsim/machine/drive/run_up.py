"""One lobe pitch of a start-up: motion of the drive from a given state under a torque given by the angle.

What: M210 with the rotor angle as the independent variable. The square of the rotors' speed is a state, so that only
the time is singular at standstill (M218). Rotors that come to rest are held (they do not turn backwards) while the
motor winds up the coupling, until its torque exceeds the load. Energies are integrated alongside. How: scipy's DOP853,
with output at the given angles.
"""

from typing import Any, NamedTuple

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.drive.train import Train

Array = np.ndarray
RTOL = 1e-8
STANDSTILL = 0.05  # share of the creeping speed below which the rotors count as at rest
AWAY = 2.0  # speed of rotors that break away, over that speed
EXCESS = 0.02  # relative excess of the coupling's torque over the load at which they do
MOST_STOPS = 40  # most standstills in one pitch
LONGEST_HOLD = 20.0  # [s] longest standstill
MOST_RATES = 300_000  # most evaluations over a pitch; more means that inertias and coupling do not match
TOO_FAST = (
    "the drive moves too fast for its coupling to be followed over a pitch (choose a larger motor_inertia or "
    "rotor_inertia, or a softer, less damped coupling)"
)


class Motion(NamedTuple):
    """Motion of the drive over angles: squared speed and its slope, motor speed, twist, time, torques; and energies.

    Speeds [rad/s], twist [rad], time [s], torques [N m]; motor_work, damped [J]; held: time at rest [s]. `stalled`: the
    rotors stopped for good after the last angle.
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
    held: float
    stalled: bool

    @property
    def speed(self) -> Array:
        """Speed of the rotors [rad/s]."""
        return np.sqrt(self.squares)


def run_up(train: Train, no_load: float, state: Array, load: Array, creep: float) -> Motion:
    """Return the motion from a state (ω², ω_m, Θ, t) under a torque `load` at even angles of a pitch and its end."""
    grid, least = np.linspace(0.0, train.pitch, len(load)), (STANDSTILL * creep) ** 2
    rates, standstill = _over_angle(train, no_load, load, grid, least)
    y, phi, rows, held, stalled = np.array([*state, 0.0, 0.0]), 0.0, [], 0.0, False
    for _ in range(MOST_STOPS):
        left = grid[sum(len(part) for part in rows) :]
        found = _integrated(rates, (phi, train.pitch), y, left, no_load, standstill)
        rows.append(np.reshape(found.y, (len(y), -1)).T)  # scipy's empty list where no angle was passed
        if found.status == 0:
            break
        phi, y = float(found.t_events[0][0]), found.y_events[0][0].copy()
        away = _held(train, no_load, y, float(np.interp(phi, grid, load)))
        if away is None:
            stalled = True
            break
        held += away[3] - y[3]
        y = away
        y[0] = (AWAY * STANDSTILL * creep) ** 2
    else:
        stalled = True
    w, motor_speed, twist, time, work, damped = np.concatenate(rows).T if sum(map(len, rows)) else y[:, None]
    omega = np.sqrt(np.maximum(w, least))
    spring = np.array([train.coupling.torque(each) for each in twist]) + train.damping * (motor_speed - omega)
    drive = np.array([train.motor.limited_torque(each, no_load) for each in motor_speed])
    slopes = 2.0 * (spring - load[: len(w)]) / train.rotor_inertia
    work, damped = float(work[-1]), float(damped[-1])
    return Motion(omega**2, slopes, motor_speed, twist, time, spring, drive, work, damped, held, stalled)


def _over_angle(train: Train, no_load: float, load: Array, grid: Array, least: float) -> tuple[Any, Any]:
    """Return the derivatives by the angle of (ω², ω_m, Θ, t, motor's work, loss), and the event of a standstill."""
    coupling, motor, c = train.coupling, train.motor, train.damping

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
    standstill.direction = -1.0  # type: ignore[attr-defined]
    return rates, standstill


def _held(train: Train, no_load: float, y: Array, load: float) -> Array | None:
    """Return the state in which the rotors break away from rest under a load [N m]; None where they never do."""
    coupling, motor, c = train.coupling, train.motor, train.damping

    def rates(_t: float, x: Array) -> list[float]:
        spring = coupling.torque(x[1]) + c * x[0]
        drive = motor.limited_torque(x[0], no_load)
        return [(drive - spring) / train.motor_inertia, x[0], drive * x[0], c * x[0] * x[0]]

    def away(_t: float, x: Array) -> float:
        return coupling.torque(x[1]) + c * x[0] - (load + EXCESS * abs(load))

    def turned(_t: float, x: Array) -> float:
        return x[0]

    start = [max(y[1], 0.0), y[2], y[4], y[5]]
    if away(0.0, np.array(start)) >= 0.0:
        return y
    away.terminal = True  # type: ignore[attr-defined]
    turned.terminal, turned.direction = True, -1.0  # type: ignore[attr-defined]
    found = _integrated(rates, (0.0, LONGEST_HOLD), np.array(start), None, no_load, (away, turned))
    if found.status != 1 or len(found.t_events[0]) == 0:
        return None
    motor_speed, twist, work, damped = found.y[:, -1]
    return np.array([y[0], motor_speed, twist, y[3] + float(found.t[-1]), work, damped])


def _integrated(rates: Any, span: tuple[float, float], y: Array, at: Array | None, no_load: float, events: Any) -> Any:
    from scipy.integrate import solve_ivp

    size = np.array([no_load**2, no_load, 0.1, 1.0, 1e3, 1e3] if len(y) == 6 else [no_load, 0.1, 1e3, 1e3])
    longest = max((span[1] - span[0]) / 16.0, 1e-9) if len(y) == 6 else 0.01
    left = MOST_RATES

    def counted(x: float, state: Array) -> list[float]:
        nonlocal left
        left -= 1
        if left < 0:
            raise UsageError(TOO_FAST)
        return rates(x, state)

    return solve_ivp(counted, span, y, "DOP853", at, events=events, rtol=RTOL, atol=RTOL * size, max_step=longest)
