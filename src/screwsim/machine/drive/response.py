"""The periodic motion of the drive train under a torque that repeats every lobe pitch.

What: rotor speed ω(φ), motor speed and twist that solve M210 and return to themselves after a pitch (M214).
How: Fourier collocation at an odd number of angles. The linearised drive, solved harmonic by harmonic, corrects the
motion, accelerated by Anderson's method, while that converges; else Newton's method does, the pulsation of the torque
raised in steps where it does not converge at once. The motor's speed is eliminated: ω_m = ω (1 + dΘ/dφ).
Source: the equations are M210–M213; collocation by trigonometric polynomials, L. N. Trefethen, Spectral Methods in
MATLAB, SIAM 2000, ch. 3.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from screwsim.faults import UsageError
from screwsim.machine.drive.train import Train
from screwsim.numerics.periodic import Anderson

Array = np.ndarray
POINTS = 181  # of a pitch; odd, so that no harmonic is its own alias
MOST_STEPS = 10  # of Newton's method for one pulsation
MOST_SOLVES = 30  # of it in all
ROUNDING = 1e-8  # change at which corrections that go no further are taken as converged
MOST_CORRECTIONS = 60
DEPTH = 12  # of Anderson's acceleration of the corrections
DIVERGED = 30.0  # growth of a change over the smallest at which Newton's method takes over
CONVERGED = 1e-10  # last change, of speeds over the mean and of twists over their size
LEAST_SPEED = 0.05  # of the mean: a step of Newton's method never goes below it
FINEST = 1.0 / 32.0  # least share by which the pulsation is raised


class NoMotion(Exception):
    """Say why the drive has no steady motion."""


class Response(NamedTuple):
    """One pitch of the drive at `POINTS` evenly spaced angles; speeds [rad/s], twist [rad], torques [N m]."""

    train: Train
    speed: Array
    motor_speed: Array
    twist: Array
    coupling_torque: Array
    motor_torque: Array
    load: Array  # torque on the rotors
    no_load_speed: float

    @property
    def mean_speed(self) -> float:
        """Return the mean over time of the rotors' speed [rad/s]: the pitch over the time that it takes."""
        return float(1.0 / np.mean(1.0 / self.speed))

    @property
    def ripple(self) -> float:
        """Return the largest less the smallest speed of the rotors over the mean."""
        return float(np.ptp(self.speed)) / self.mean_speed

    def power(self, torque: Array, speed: Array) -> float:
        """Return the mean over time of torque × speed [W]."""
        return float(np.mean(torque * speed / self.speed)) * self.mean_speed

    @property
    def worst_twist(self) -> float:
        """Return the twist of largest magnitude [rad]."""
        return float(self.twist[np.argmax(np.abs(self.twist))])


@lru_cache(maxsize=4)
def differentiation(pitch: float, n: int = POINTS) -> Array:
    """Return the matrix that takes values at n (odd) evenly spaced angles of a period to their derivatives."""
    i = np.arange(n)
    gap = i[:, None] - i[None, :]
    with np.errstate(divide="ignore"):
        matrix = 0.5 * (-1.0) ** gap / np.sin(math.pi * gap / n)
    matrix[i, i] = 0.0
    return matrix * (2.0 * math.pi / pitch)


def resampled(values: Array, n: int = POINTS) -> Array:
    """Return a periodic curve at n points, its higher harmonics left out."""
    return np.fft.irfft(np.fft.rfft(values)[: n // 2 + 1], n) * (n / len(values))


def respond(train: Train, load: Array, omega: float) -> Response:
    """Return the periodic motion under the torque `load` on the rotors, evenly spaced over a pitch (M214).

    omega: mean speed [rad/s] that is held, or a first guess of it. Raises `NoMotion`.
    """
    torque = resampled(load)
    mean = float(torque.mean())
    if abs(mean) >= train.motor.most:
        raise NoMotion(
            f"the motor stalls: the rotors ask for {mean:.4g} N m in the mean, and it gives {train.motor.most:.4g} N m "
            "at most (choose a larger motor)"
        )
    try:
        twist = train.coupling.twist(mean)
    except UsageError as error:
        raise NoMotion(str(error)) from None
    start = omega if train.holds_mean else train.motor.speed(train.speed, mean)
    if not start > 0.0:
        raise NoMotion(
            f"the motor stalls: a torque of {mean:.4g} N m on its line leaves a speed of {start:.4g} rad/s (choose a "
            "steeper line)"
        )
    no_load = train.motor.no_load_speed(start, mean) if train.holds_mean else train.speed
    n = POINTS
    x = np.concatenate([np.full(n, start), np.full(n, twist), [no_load]])
    return _response(train, _raised(train, x, torque, omega), torque)


def _raised(train: Train, x: Array, torque: Array, omega: float) -> Array:
    """Return the solution, from the steady state on by raising the torque's pulsation; raise `NoMotion`."""
    mean, share, step, solves = float(torque.mean()), 0.0, 1.0, [MOST_SOLVES]
    while share < 1.0:
        trial = min(1.0, share + step)
        pulsating = mean + trial * (torque - mean)
        found = _by_harmonics(train, x, pulsating, omega)
        if found is None:
            found = _newton(train, x, pulsating, omega, solves)
        if found is not None:
            x, share, step = found, trial, 2.0 * step
            continue
        step *= 0.5
        if step < FINEST or solves[0] <= 0:
            lowest = float(x[:POINTS].min() / x[:POINTS].mean())
            raise NoMotion(
                f"the drive has no steady motion: at {share:.0%} of the torque's pulsation its speed falls to "
                f"{lowest:.0%} of the mean, and with more no motion that repeats every lobe pitch was found (more "
                "inertia, more damping, or a speed farther from resonance)"
            )
    return x


def _response(train: Train, x: Array, torque: Array) -> Response:
    n, D = POINTS, differentiation(train.pitch)
    u, twist, no_load = x[:n], x[n : 2 * n], float(x[-1])
    rate = D @ (twist - twist.mean())
    motor_speed = u * (1.0 + rate)
    coupling = train.spring(twist)[0] + train.damping * u * rate
    return Response(train, u, motor_speed, twist, coupling, train.motor.torque(motor_speed, no_load), torque, no_load)


def _newton(train: Train, x: Array, torque: Array, omega: float, left: list[int]) -> Array | None:
    """Return the solution from a guess; None where Newton's method finds none. left[0]: linear systems it may solve."""
    n, x = POINTS, x.copy()
    for _ in range(min(MOST_STEPS, left[0])):
        left[0] -= 1
        try:
            change = np.linalg.solve(_jacobian(train, x, omega), -_residue(train, x, torque, omega))
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(change).all():
            return None
        u = x[:n]
        room = float(np.min(_room(u, change[:n], LEAST_SPEED * omega)))
        if room <= 0.0:
            return None
        room = 1.0 if room >= 1.0 else 0.9 * room
        x += room * change
        if room == 1.0 and np.max(np.abs(change) / _sizes(x, omega)) <= CONVERGED:
            return x
    return None


def _room(u: Array, change: Array, least: float) -> Array:
    """Return the share of a change at which each speed reaches the least; more than 1 where it does not."""
    return np.where(change < 0.0, (u - least) / np.where(change < 0.0, -change, 1.0), 2.0)


def _by_harmonics(train: Train, x: Array, torque: Array, omega: float) -> Array | None:
    """Return the solution by accelerated corrections of the drive linearised about its mean; None where they fail."""
    n, x, accelerate, best, kept = POINTS, x.copy(), Anderson(DEPTH), np.inf, None
    linear, means, scale = _linearised(train, x), _linearised_mean(train, x), _sizes(x, omega)
    for _ in range(MOST_CORRECTIONS):
        residue = _residue(train, x, torque, omega)
        spectrum = np.stack([np.fft.rfft(residue[:n]), np.fft.rfft(residue[n:-1])], axis=1)
        mean = np.linalg.solve(means, [*(spectrum[0].real / n), residue[-1]])
        change = -np.concatenate([*(_solved(linear, spectrum, k) + mean[k] for k in (0, 1)), mean[2:]])
        sizes = _sizes(x, omega)
        size = float(np.max(np.abs(change) / sizes))
        if not size < DIVERGED * best:
            break
        if size <= CONVERGED:
            return x + change
        if size < best:
            best, kept = size, x
        x = accelerate.mix(x / scale, (x + change) / scale)[1] * scale
        if not x[:n].min() > LEAST_SPEED * omega:
            return None
    return kept if best <= ROUNDING else None


def _linearised(train: Train, x: Array) -> Array:
    """Return the matrices of the linearised equations of each harmonic from the first on, (harmonics, 2, 2)."""
    u, twist, no_load = float(np.mean(x[:POINTS])), float(np.mean(x[POINTS:-1])), float(x[-1])
    K = float(train.coupling.stiffness(twist))
    by_motor = float(train.motor.slopes(u, no_load)[0])
    i_k = 1j * np.arange(1, POINTS // 2 + 1) * 2.0 * math.pi / train.pitch
    spring = K + train.damping * u * i_k
    rows = [
        [train.rotor_inertia * u * i_k, -spring],
        [train.motor_inertia * u * i_k - by_motor, train.motor_inertia * (u * i_k) ** 2 - by_motor * u * i_k + spring],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _solved(linear: Array, spectrum: Array, column: int) -> Array:
    """Return one of the two unknowns of all harmonics but the mean as a curve."""
    (a, b), (c, d) = np.moveaxis(linear, 0, 2)
    first, second = spectrum[1:].T
    found = (d * first - b * second if column == 0 else a * second - c * first) / (a * d - b * c)
    return np.fft.irfft(np.concatenate([[0.0], found]), POINTS)


def _linearised_mean(train: Train, x: Array) -> Array:
    """Return the matrix of the means of speed, twist and no-load speed."""
    u, twist, no_load = float(np.mean(x[:POINTS])), float(np.mean(x[POINTS:-1])), float(x[-1])
    K = float(train.coupling.stiffness(twist))
    by_motor, by_no_load = (float(slope) for slope in train.motor.slopes(u, no_load))
    last = [-1.0 / u, 0.0, 0.0] if train.holds_mean else [0.0, 0.0, 1.0 / train.speed]
    return np.array([[0.0, -K, 0.0], [-by_motor, K, -by_no_load], last])


def _sizes(x: Array, omega: float) -> Array:
    """Return what changes are relative to: the mean speed, the largest twist."""
    sizes = np.array([omega, float(np.max(np.abs(x[POINTS:-1]))) + 1e-300, abs(float(x[-1]))])
    return np.repeat(sizes, [POINTS, POINTS, 1])


def _residue(train: Train, x: Array, torque: Array, omega: float) -> Array:
    """Return the residues of M210 at all points, and of the mean speed or of the given no-load speed."""
    n, D = POINTS, differentiation(train.pitch)
    u, twist, no_load = x[:n], x[n : 2 * n], float(x[-1])
    rate = D @ (twist - twist.mean())  # D takes a constant to none but for rounding
    motor = u * (1.0 + rate)
    coupling = train.spring(twist)[0] + train.damping * u * rate
    rotors = train.rotor_inertia * u * (D @ (u - u.mean())) - coupling + torque
    at_motor = train.motor_inertia * u * (D @ (motor - motor.mean())) - train.motor.torque(motor, no_load) + coupling
    last = omega * np.mean(1.0 / u) - 1.0 if train.holds_mean else (no_load - train.speed) / train.speed
    return np.append(np.concatenate([rotors, at_motor]), last)


def _jacobian(train: Train, x: Array, omega: float) -> Array:
    """Return the derivatives of `_residue`."""
    n, D = POINTS, differentiation(train.pitch)
    J_m, J_r, c = train.motor_inertia, train.rotor_inertia, train.damping
    u, twist, no_load = x[:n], x[n : 2 * n], float(x[-1])
    rate = D @ twist
    motor = u * (1.0 + rate)
    stiffness = train.spring(twist)[1]
    by_motor, by_no_load = train.motor.slopes(motor, no_load)
    A, uD = np.zeros((2 * n + 1, 2 * n + 1)), u[:, None] * D
    A[:n, :n] = J_r * (np.diag(D @ u) + uD) - np.diag(c * rate)
    A[:n, n:-1] = -np.diag(stiffness) - c * uD
    A[n:-1, :n] = J_m * (np.diag(D @ motor) + uD * (1.0 + rate)) + np.diag(c * rate - by_motor * (1.0 + rate))
    A[n:-1, n:-1] = J_m * (uD @ uD) - by_motor[:, None] * uD + np.diag(stiffness) + c * uD
    A[n:-1, -1] = -by_no_load
    if train.holds_mean:
        A[-1, :n] = -omega / (n * u * u)
    else:
        A[-1, -1] = 1.0 / train.speed
    return A
