"""The periodic motion of the drive train under a torque that repeats every lobe pitch.

What: rotor speed ω(φ), motor speed and twist that solve M210 and repeat after a pitch (M214). How: Fourier collocation
at an odd number of angles. Corrections by the drive linearised about its mean, solved harmonic by harmonic and
accelerated by Anderson's method, are iterated while they converge; else Newton's method takes over, with the torque's
pulsation raised in steps where it does not converge at once. The motor's speed is eliminated: ω_m = ω (1 + dΘ/dφ).
Source: docs/model.md M210–M214; acceleration: Walker & Ni 2011.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.drive import collocation
from screwsim.machine.drive.collocation import POINTS, motion, residual, sizes
from screwsim.machine.drive.train import Train
from screwsim.numerics.anderson import Anderson
from screwsim.numerics.parabola import top

Array = np.ndarray
MOST_STEPS = 10  # most Newton steps at one level of pulsation
MOST_SOLVES = 30  # most Newton steps in all
ROUNDING = 1e-8  # change at which corrections that have stopped falling count as converged
MOST_CORRECTIONS = 60
DEPTH = 12  # depth of the Anderson acceleration
DIVERGED = 30.0  # a change over the smallest so far at which Newton's method takes over
CONVERGED = 1e-10  # largest last change, relative to `sizes`
LEFT = 1e-12  # next change, extrapolated from the last ones, below which corrections end
FINE = 5 * POINTS  # angles of a pitch at which a curve's extremes are searched
LEAST_SPEED = 0.05  # lowest speed over the mean that a step may reach
FINEST = 1.0 / 32.0  # smallest increment of the pulsation


class NoMotion(Exception):
    """Say why the drive has no steady motion."""


@dataclass(frozen=True, eq=False)
class Response:
    """One pitch of the drive at `POINTS` evenly spaced angles; speeds [rad/s], twist [rad], torques [N m]."""

    train: Train
    speed: Array
    motor_speed: Array
    twist: Array
    coupling_torque: Array
    motor_torque: Array
    load: Array  # torque on the rotors
    no_load_speed: float

    @cached_property
    def mean_speed(self) -> float:
        """Mean over time of the rotors' speed [rad/s]: the pitch over the time that it takes."""
        return float(1.0 / np.mean(1.0 / self.speed))

    @property
    def ripple(self) -> float:
        """Largest less smallest speed of the rotors, over the mean."""
        return peak_to_peak(self.speed) / self.mean_speed

    def power(self, torque: Array, speed: Array) -> float:
        """Return the mean over time of torque × speed [W]."""
        return float(np.mean(torque * speed / self.speed)) * self.mean_speed


def extremes(curve: Array) -> tuple[float, float]:
    """Return the lowest and the highest value of a curve over a pitch, also between its points."""
    fine = collocation.resampled(curve, FINE)
    return -_top(-fine), _top(fine)


def _top(fine: Array) -> float:
    """Return the top of the parabola through the highest of a period's evenly spaced values and its neighbours."""
    i = int(fine.argmax())
    before, most, after = fine[np.array([i - 1, i, i + 1]) % len(fine)]
    return top(before, most, after)


def peak_to_peak(curve: Array) -> float:
    """Return the peak-to-peak value of a curve."""
    low, high = extremes(curve)
    return high - low


def respond(train: Train, load: Array, omega: float) -> Response:
    """Return the periodic motion under the torque `load` [N m] on the rotors, evenly spaced over a pitch (M214).

    omega: the prescribed mean speed [rad/s], or a first guess of it. Raises `NoMotion`.
    """
    torque = collocation.resampled(load)
    mean = float(torque.mean())
    if abs(mean) >= train.motor.most:
        raise NoMotion(
            f"the motor stalls: the rotors need {mean:.4g} N m on average, and it gives {train.motor.most:.4g} N m "
            "at most (choose a larger motor)"
        )
    try:
        twist = train.coupling.twist(mean)
    except UsageError as error:
        raise NoMotion(str(error)) from None
    start = omega if train.holds_mean else train.motor.speed(train.speed, mean)
    if not start > 0.0:
        raise NoMotion(
            f"the motor stalls: with a torque of {mean:.4g} N m its line leaves a speed of {start:.4g} rad/s (choose a "
            "steeper line)"
        )
    no_load = train.motor.no_load_speed(start, mean) if train.holds_mean else train.speed
    n = POINTS
    x = np.concatenate([np.full(n, start), np.full(n, twist), [no_load]])
    x = _solution_by_continuation(train, x, torque, omega)
    (u, motor, coupling), no_load = motion(train, x), float(x[-1])
    return Response(train, u, motor, x[n:-1], coupling, train.motor.torque(motor, no_load), torque, no_load)


def _solution_by_continuation(train: Train, x: Array, torque: Array, omega: float) -> Array:
    """Return the solution, starting from the steady state and raising the torque's pulsation; raise `NoMotion`."""
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
                f"{lowest:.0%} of the mean, and at a larger share no motion was found that repeats every lobe pitch "
                "(choose more inertia, more damping, or a speed farther from resonance)"
            )
    return x


def _newton(train: Train, x: Array, torque: Array, omega: float, left: list[int]) -> Array | None:
    """Return Newton's solution from a guess, None where it fails. left[0]: linear systems it may still solve."""
    n, x = POINTS, x.copy()
    for _ in range(min(MOST_STEPS, left[0])):
        left[0] -= 1
        try:
            change = np.linalg.solve(collocation.jacobian(train, x, omega), -residual(train, x, torque, omega))
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(change).all():
            return None
        u, by = x[:n], change[:n]  # the least share of the change at which a speed reaches its bound, more than 1: none
        reached = (u - LEAST_SPEED * omega) / np.where(by < 0.0, -by, 1.0)
        room = float(np.min(np.where(by < 0.0, reached, 2.0)))
        if room <= 0.0:
            return None
        room = 1.0 if room >= 1.0 else 0.9 * room
        x += room * change
        if room == 1.0 and np.max(np.abs(change) / sizes(x, omega)) <= CONVERGED:
            return x
    return None


def _by_harmonics(train: Train, x: Array, torque: Array, omega: float) -> Array | None:
    """Return the solution by accelerated corrections of the drive linearised about its mean; None where they fail."""
    n, x, accelerate, best, kept = POINTS, x.copy(), Anderson(DEPTH), np.inf, None
    (means, linear), scale, before = collocation.linearised(train, x), sizes(x, omega), 0.0
    for _ in range(MOST_CORRECTIONS):
        left = residual(train, x, torque, omega)
        spectra = collocation.spectra_of(left[:-1].reshape(2, n))
        mean = np.linalg.solve(means, [*(spectra[:, 0].real / n), left[-1]])
        change = -np.append(collocation.solved(linear, spectra) + mean[:2, None], mean[2])
        size = float((np.abs(change) / scale).max())
        if not size < DIVERGED * best:
            break
        if size <= CONVERGED or size * size < LEFT * before:
            return x + change
        before = size
        if size < best:
            best, kept = size, x
        x = accelerate.mix(x / scale, (x + change) / scale)[1] * scale
        if not x[:n].min() > LEAST_SPEED * omega:
            return None
    return kept if best <= ROUNDING else None
