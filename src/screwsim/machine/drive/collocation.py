"""The equations of the drive's steady motion, collocated by trigonometric polynomials over a lobe pitch (M210, M214).

Unknowns are the rotors' speed and the twist at `POINTS` evenly spaced angles, then the motor's no-load speed, in one
vector. The motor's speed is eliminated: ω_m = ω (1 + dΘ/dφ). The last equation prescribes the mean or no-load speed.
Source: docs/model.md M210–M214; collocation: L. N. Trefethen, Spectral Methods in MATLAB, SIAM 2000, ch. 3.
"""

import math
from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.machine.drive.train import Train

Array = np.ndarray
POINTS = 181  # angles of a pitch; odd, so that no harmonic is its own alias


@lru_cache(maxsize=4)
def differentiation(pitch: float, n: int = POINTS) -> Array:
    """Return the matrix that maps values at n (odd) evenly spaced angles of a period to their derivatives."""
    i = np.arange(n)
    gap = i[:, None] - i[None, :]
    with np.errstate(divide="ignore"):
        matrix = 0.5 * (-1.0) ** gap / np.sin(math.pi * gap / n)
    matrix[i, i] = 0.0
    return matrix * (2.0 * math.pi / pitch)


def resampled(values: Array, n: int = POINTS) -> Array:
    """Return a periodic curve at n points, with the harmonics that they cannot resolve left out."""
    if POINTS in (len(values), n):  # a prime number, for which a fast transform is slow
        return _resampling(len(values), n) @ values
    return np.fft.irfft(np.fft.rfft(values)[: n // 2 + 1], n) * (n / len(values))


@lru_cache(maxsize=8)
def _resampling(old: int, n: int) -> Array:
    """Return the matrix that maps values at `old` even points of a period to those at n."""
    spectra = np.fft.rfft(np.eye(old))[:, : n // 2 + 1]
    return np.ascontiguousarray(np.fft.irfft(spectra, n).T) * (n / old)


@lru_cache(maxsize=4)
def _waves(n: int) -> tuple[Array, Array]:
    """Return cosine and sine of the mean and of each harmonic, a column each, at n (odd) points."""
    phases = 2.0 * math.pi / n * (np.outer(np.arange(n), np.arange(n // 2 + 1)) % n)
    return np.cos(phases), np.sin(phases)


def spectra_of(curves: Array) -> Any:
    """Return the same as numpy's rfft of rows; a product with a matrix is faster for a prime number of points."""
    cosine, sine = _waves(curves.shape[-1])
    return curves @ cosine - 1j * (curves @ sine)


def curves_of(spectra: Any, n: int = POINTS) -> Array:
    """Return the curves at n (odd) points whose `spectra_of` (rows of mean and harmonics) are given."""
    cosine, sine = _waves(n)
    weights = np.full(spectra.shape[-1], 2.0 / n)
    weights[0] = 1.0 / n
    return (spectra.real * weights) @ cosine.T - (spectra.imag * weights) @ sine.T


def linearised(train: Train, x: Array) -> tuple[Array, Array]:
    """Return the matrices of the equations linearised about the means of speed, twist and no-load speed.

    Those of the means themselves (3, 3) come first, then those of each harmonic of speed and twist (harmonics, 2, 2).
    """
    u, twist, no_load = float(np.mean(x[:POINTS])), float(np.mean(x[POINTS:-1])), float(x[-1])
    K = float(train.coupling.stiffness(twist))
    by_motor, by_no_load = (float(slope) for slope in train.motor.slopes(u, no_load))
    last = [-1.0 / u, 0.0, 0.0] if train.holds_mean else [0.0, 0.0, 1.0 / train.speed]
    means = np.array([[0.0, -K, 0.0], [-by_motor, K, -by_no_load], last])
    i_k = 1j * np.arange(1, POINTS // 2 + 1) * 2.0 * math.pi / train.pitch
    spring = K + train.damping * u * i_k
    rows = [
        [train.rotor_inertia * u * i_k, -spring],
        [train.motor_inertia * u * i_k - by_motor, train.motor_inertia * (u * i_k) ** 2 - by_motor * u * i_k + spring],
    ]
    return means, np.moveaxis(np.array(rows), 2, 0)


def solved(linear: Array, spectra: Array) -> Array:
    """Return the curves (2, points) of both unknowns without their means, from spectra (2, harmonics) of residuals."""
    (a, b), (c, d) = linear.transpose(1, 2, 0)
    (first, second), determinant = spectra[:, 1:], a * d - b * c
    found = np.zeros_like(spectra)
    found[0, 1:] = (d * first - b * second) / determinant
    found[1, 1:] = (a * second - c * first) / determinant
    return curves_of(found)


def sizes(x: Array, omega: float) -> Array:
    """Return the scale of each unknown to which changes are relative: mean speed, largest twist, no-load speed."""
    sizes = np.array([omega, float(np.max(np.abs(x[POINTS:-1]))) + 1e-300, abs(float(x[-1]))])
    return np.repeat(sizes, [POINTS, POINTS, 1])


def motion(train: Train, x: Array) -> tuple[Array, Array, Array]:
    """Return the speeds [rad/s] of the rotors and of the motor, and the torque [N m] of the coupling."""
    u, twist = x[:POINTS], x[POINTS:-1]
    rate = differentiation(train.pitch) @ (twist - twist.mean())  # it maps a constant to zero, but for rounding
    return u, u * (1.0 + rate), train.spring(twist)[0] + train.damping * u * rate


def residual(train: Train, x: Array, torque: Array, omega: float) -> Array:
    """Return the residuals of M210 at all points, and that of the prescribed mean or no-load speed."""
    D, no_load = differentiation(train.pitch), float(x[-1])
    u, motor, coupling = motion(train, x)
    rotors = train.rotor_inertia * u * (D @ (u - u.mean())) - coupling + torque
    at_motor = train.motor_inertia * u * (D @ (motor - motor.mean())) - train.motor.torque(motor, no_load) + coupling
    last = omega * np.mean(1.0 / u) - 1.0 if train.holds_mean else (no_load - train.speed) / train.speed
    return np.concatenate([rotors, at_motor, np.array([last])])


def jacobian(train: Train, x: Array, omega: float) -> Array:
    """Return the Jacobian of `residual`."""
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
