"""A check valve between a plenum and its line: shut against the flow, open while the plenum presses against it.

What: a disc without mass that its weight or a soft spring holds down lifts as far as holds the pressure difference at
the cracking pressure, and is an orifice where it is fully open (M220). What a plenum does behind it, over a pitch: what
the chambers give is stored, or leaves through the valve into an endless line (M221); and the pressure at which a
machine that delivers nothing stands against the valve (M222).
Source: textbook orifice; periodic solution by Fourier collocation (L. N. Trefethen, Spectral Methods in MATLAB, SIAM
2000, ch. 3) and Newton's method. Derivatives of trigonometric polynomials are skew, the valve's law is monotone: there
is one solution.
Flows and pressures here count along the valve: on the suction side both are those of M184 with the other sign.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from screwsim.inputs.declare import quantity
from screwsim.machine.drive.collocation import differentiation, resampled

Array = np.ndarray
POINTS = 65  # of a pitch; odd, so that no harmonic is its own alias
MOST_POINTS = 300  # of a pitch, above which no more are taken
RESOLVED = 1e-5  # of the mean flow: a change of the least flow below which its angles are enough
FINE = 8  # times the angles of a curve, among which its lowest value is looked for first
AROUND = np.linspace(-1.0, 1.0, 9)  # places about the lowest one at which a curve is read again ...
REFINED = 3  # ... so many times
MOST_STEPS = 60
CONVERGED = 1e-11  # residual over the largest flow
LEAST_SHARE = 1e-4  # of a step of Newton's method, before it is taken whatever it does
MOST_CHANGE = 0.4  # of what drives the leaks, by which a shut plenum's pressure changes in a turn
LEAST_ACROSS = 0.002  # of its pressure, that counts as driving them at least


@dataclass(frozen=True)
class Valve:
    """A check valve of a line."""

    area: float | None = quantity("area", "that is free when fully open (absent: wide)", None, gt=0.0)
    pressure: float = quantity("pressure_difference", "that opens it, and holds it open", 0.0, ge=0.0)

    def drop(self, flow: Array, rho: float) -> tuple[Array, Array]:
        """Return the pressure [Pa] that an open valve takes of flows [kg/s], and its slope by the flow (M220)."""
        if self.area is None:
            return np.full(flow.shape, self.pressure), np.zeros(flow.shape)
        orifice = flow**2 / (2.0 * rho * self.area**2)
        lifted = orifice > self.pressure
        return np.where(lifted, orifice, self.pressure), np.where(lifted, flow / (rho * self.area**2), 0.0)


class Behind(NamedTuple):
    """What a plenum works against: its capacity [kg/Pa], its line's impedance [Pa s/kg], lobe frequency, ρ."""

    capacity: float
    impedance: float
    frequency: float
    rho: float


class Passed(NamedTuple):
    """A pitch at `POINTS` even angles: flow through the valve [kg/s] and pressure of the plenum beyond its line's."""

    flow: Array
    pressure: Array


def through(valve: Valve, given: Array, behind: Behind, points: int = POINTS, start: Array | None = None) -> Passed:
    """Return what a valve lets pass of the flow `given` [kg/s] to its plenum over a pitch; its mean is positive (M221).

    capacity · dp/dt = given − u, p = drop of the valve + impedance · (u − mean), u ≥ 0. At so many even angles (odd);
    sought from a `start` of the flow.
    """
    w, mean = resampled(np.asarray(given), points), float(np.mean(given))
    D = behind.capacity * behind.frequency * differentiation(2.0 * np.pi, points)
    beyond = behind.impedance + 1.0 / (behind.capacity * behind.frequency)  # slope of the pressure where it is shut
    largest = float(np.max(np.abs(w)))

    def residual(z: Array) -> tuple[Array, Array, Array, float]:
        """Return what is left open, the pressure, the valve's slope, and how much is left at most."""
        u = np.maximum(z, 0.0)
        drop, slope = valve.drop(u, behind.rho)
        p = drop + behind.impedance * u + beyond * np.minimum(z, 0.0)
        left = D @ p + u - w
        return left, p, slope, float(max(left.max(), -left.min()))

    z = np.full(points, mean) if start is None else start
    left, p, slope, size = residual(z)
    for _ in range(MOST_STEPS):
        if size <= CONVERGED * largest:
            break
        shut = z <= 0.0
        slopes = D * np.where(shut, beyond, slope + behind.impedance)
        slopes.flat[:: points + 1] += ~shut
        change, share = np.linalg.solve(slopes, -left), 1.0
        while True:
            trial = residual(z + share * change)
            if trial[3] < size or share < LEAST_SHARE:
                break
            share *= 0.5
        z, (left, p, slope, size) = z + share * change, trial
    return Passed(np.maximum(z, 0.0), p - behind.impedance * mean)


def least_flow(valve: Valve, given: Array, behind: Behind, passed: Passed) -> float:
    """Return the least flow [kg/s] over a pitch of what `passed` is a first solution of (M221).

    The pressure follows the flow, which it holds back, so that its curve is known better than that of the flow: the
    least flow is that of its lowest value, between the angles, too. With all harmonics of the flow `given`, and with as
    many more as change it.
    """
    found, points, mean = float(passed.flow.min()), max(POINTS, len(given) | 1), float(np.mean(given))
    if found <= 0.0:
        return 0.0
    while True:
        passed = through(valve, given, behind, points, resampled(passed.flow, points))
        above = lowest(passed.pressure) + behind.impedance * mean
        before, found = found, _flow_at(valve, above, behind)
        straight = bool(np.all(valve.drop(passed.flow, behind.rho)[1] == 0.0))
        if straight or abs(found - before) <= RESOLVED * mean or points > MOST_POINTS:
            return max(found, 0.0)
        points = 2 * points - 1


def _flow_at(valve: Valve, above: float, behind: Behind) -> float:
    """Return the flow [kg/s] that an open valve and its line hold back by so much [Pa]."""
    held = (above - valve.pressure) / behind.impedance
    if valve.area is None or held**2 <= 2.0 * behind.rho * valve.area**2 * valve.pressure:
        return held
    orifice = 1.0 / (2.0 * behind.rho * valve.area**2)
    return (math.sqrt(behind.impedance**2 + 4.0 * orifice * above) - behind.impedance) / (2.0 * orifice)


def lowest(curve: Array) -> float:
    """Return the lowest value of a periodic curve of which these are values at even angles, between them, too."""
    spectrum, many = np.fft.rfft(curve) / len(curve), FINE * len(curve)
    at, apart = float(np.fft.irfft(spectrum, many).argmin()), 1.0
    spectrum[1:] *= 2.0
    k, least = np.arange(len(spectrum)), float(curve.min())
    for _ in range(REFINED):
        places = at + apart * AROUND
        values = np.real(np.exp(2j * np.pi / many * np.outer(places, k)) @ spectrum)
        at, apart = float(places[values.argmin()]), apart * float(AROUND[1] - AROUND[0])
        least = min(least, float(values.min()))
    return least


def closed(given: Array, behind: Behind, leaking: float = 0.0) -> Array:
    """Return the pressure of a plenum whose valve stays shut, beyond its mean [Pa], at `POINTS` angles.

    `leaking` [kg/(Pa s)] times that pressure is what leaks take of the flow `given`.
    """
    spectrum = np.fft.rfft(resampled(np.asarray(given), POINTS))
    k = np.arange(1, len(spectrum))
    spectrum[1:] /= 1j * k * behind.frequency * behind.capacity + leaking
    spectrum[0] = 0.0
    return np.fft.irfft(spectrum, POINTS)


def driving(held: float, across: float) -> float:
    """Return the pressure across the machine that counts as driving its leaks, over the line's."""
    return abs(across) + LEAST_ACROSS * (1.0 + held)


def standing(held: float, flow: Array, answering: float, across: float) -> float:
    """Return the mean pressure over the line's, less one, of a plenum whose valve stays shut, from that held (M222).

    It changes as long as the chambers' flow [kg/s] into it has a mean, by that over what moves, until nothing passes in
    the mean. `answering` is the flow with which what is open to the plenum answers a doubled pressure. Leaks grow with
    what drives them, the pressure `across` the machine (over the line's), so that a share of that is the right step.
    """
    moved = float(np.mean(np.abs(flow))) + answering
    share = float(np.mean(flow)) / moved if moved > 0.0 else 0.0
    step = driving(held, across)
    return max(held + step * float(np.clip(share, -MOST_CHANGE, MOST_CHANGE)), (1.0 - MOST_CHANGE) * (1.0 + held) - 1.0)
