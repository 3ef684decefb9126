"""A check valve between a plenum and its line: shut against the flow, open while the plenum's pressure is the higher.

What: a massless disc, held down by its weight or a soft spring, lifts just so far that the pressure difference stays at
the cracking pressure; fully open it is an orifice (M220). Response of the plenum over a pitch: the flow from the
chambers is stored, or leaves through the valve into an infinite line (M221). Also the pressure at which a machine that
delivers nothing stalls against the valve (M222).
Source: textbook orifice; periodic solution by Fourier collocation (L. N. Trefethen, Spectral Methods in MATLAB, SIAM
2000, ch. 3) and Newton's method. Differentiation of trigonometric polynomials is skew-symmetric and the valve's law is
monotone, so there is exactly one solution.

Flows and pressures here count along the valve: on the suction side both have the opposite sign of those of M184.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from screwsim.inputs.declare import optional, quantity
from screwsim.machine.drive.collocation import differentiation, resampled

Array = np.ndarray
POINTS = 65  # angles of a pitch; odd, so that no harmonic is its own alias
MOST_POINTS = 300  # angles of a pitch above which they are not doubled again
RESOLVED = 1e-5  # change of the least flow, over the mean flow, below which the angles are fine enough
FINE = 8  # factor by which a curve's angles are refined for the first search of its lowest value
AROUND = np.linspace(-1.0, 1.0, 9)  # places around the lowest one at which the curve is evaluated again ...
REFINED = 3  # ... this many times
MOST_STEPS = 60
WHOLE_STEPS = 30  # Newton steps taken whole, 14 in most cases: damped ones passed each angle's corner alone
LARGER = 2.0 ** np.arange(14.0, -0.5, -0.5)  # capacities, over that of a plenum for which these steps do not converge
CONVERGED = 1e-11  # residual over the largest flow
LEAST_SHARE = 1e-4  # smallest damping factor of a Newton step; below it the step is taken regardless
MOST_CHANGE = 0.4  # largest change of a shut plenum's pressure in a turn, over the pressure that drives the leaks
LEAST_ACROSS = 0.002  # least pressure that counts as driving them, over the plenum's pressure
UNFOUND = (
    "the flow through the check valve of the {to} line was not found: the plenum holds next to nothing of what passes "
    "in a lobe's time (choose a larger effects.plenums.{to}_volume, or leave the valve out)"
)


@dataclass(frozen=True)
class Valve:
    """A check valve of a line."""

    area: float | None = optional("area", "free area of the fully open valve (absent: it does not restrict)")
    pressure: float = quantity(
        "pressure_difference", "pressure difference that opens it and holds it open", 0.0, ge=0.0
    )

    def drop(self, flow: Array, rho: float) -> tuple[Array, Array]:
        """Return the pressure drop [Pa] of an open valve at flows [kg/s], and its derivative by the flow (M220)."""
        if self.area is None:
            return np.full(flow.shape, self.pressure), np.zeros(flow.shape)
        orifice = flow**2 / (2.0 * rho * self.area**2)
        lifted = orifice > self.pressure
        return np.where(lifted, orifice, self.pressure), np.where(lifted, flow / (rho * self.area**2), 0.0)


class ValveSurroundings(NamedTuple):
    """What a valve connects: capacity of the plenum [kg/Pa], impedance of the line [Pa s/kg], lobe frequency, ρ."""

    capacity: float
    impedance: float
    frequency: float
    rho: float

    @property
    def when_shut(self) -> float:
        """Slope of the pressure by how far a valve is shut [Pa s/kg], as that of an open one by its flow."""
        return self.impedance + 1.0 / (self.capacity * self.frequency)


class ValveFlow(NamedTuple):
    """A pitch at evenly spaced angles: flow through the valve [kg/s], the plenum's pressure less its line's [Pa].

    `converged` tells whether both were found.
    """

    flow: Array
    pressure: Array
    converged: bool


def valve_flow(
    valve: Valve, given: Array, behind: ValveSurroundings, points: int = POINTS, start: Array | None = None
) -> ValveFlow:
    """Return the flow through a valve over a pitch for a flow `given` [kg/s] to its plenum, of positive mean (M221).

    capacity · dp/dt = given − u, p = drop of the valve + impedance · (u − mean), u ≥ 0, at `points` (odd) evenly spaced
    angles. `start` is the first guess of the flow. A small plenum whose flow is not found from it is approached from
    larger ones.
    """
    w, mean = resampled(np.asarray(given), points), float(np.mean(given))
    z, p, converged = _newton(valve, w, behind, np.full(points, mean) if start is None else start)
    if not converged:
        larger = [behind._replace(capacity=capacity) for capacity in behind.capacity * LARGER]
        z = np.full(points, mean)
        for before, each in zip([larger[0], *larger[:-1]], larger, strict=True):
            z = np.where(z > 0.0, z, z * before.when_shut / each.when_shut)  # the same pressure
            z, p, converged = _newton(valve, w, each, z)
    return ValveFlow(np.maximum(z, 0.0), p - behind.impedance * mean, converged)


def _newton(valve: Valve, w: Array, behind: ValveSurroundings, z: Array) -> tuple[Array, Array, bool]:
    """Return flows (below zero: how far shut), pressures [Pa] of the plenum, and whether Newton's method converged."""
    points, largest = len(w), float(np.max(np.abs(w)))
    D = behind.capacity * behind.frequency * differentiation(2.0 * np.pi, points)
    beyond = behind.when_shut

    def residual(z: Array) -> tuple[Array, Array, Array, float]:
        """Return the residual, the pressure, the slope of the valve's drop, and the residual's largest magnitude."""
        u = np.maximum(z, 0.0)
        drop, slope = valve.drop(u, behind.rho)
        p = drop + behind.impedance * u + beyond * np.minimum(z, 0.0)
        left = D @ p + u - w
        return left, p, slope, float(max(left.max(), -left.min()))

    left, p, slope, size = residual(z)
    for step in range(MOST_STEPS):
        if size <= CONVERGED * largest:
            break
        shut = z <= 0.0
        slopes = D * np.where(shut, beyond, slope + behind.impedance)
        slopes.flat[:: points + 1] += ~shut
        change, share = np.linalg.solve(slopes, -left), 1.0
        while True:
            trial = residual(z + share * change)
            if step < WHOLE_STEPS or trial[3] < size or share < LEAST_SHARE:
                break
            share *= 0.5
        z, (left, p, slope, size) = z + share * change, trial
    return z, p, size <= CONVERGED * largest


def least_flow(valve: Valve, given: Array, behind: ValveSurroundings, passed: ValveFlow, net: float) -> float:
    """Return the least flow [kg/s] over a pitch, `passed` being a first solution, for a mean flow `net` [kg/s] (M221).

    The pressure is smoother than the flow, so that its curve is better resolved: the least flow is that of the
    pressure's lowest value, also between the angles. All harmonics of the flow `given` are resolved, and the number of
    angles is doubled until the result no longer changes.
    """
    given = given + (net - float(np.mean(given)))
    found, points, mean = float(passed.flow.min()), max(POINTS, len(given) | 1), float(np.mean(given))
    if found <= 0.0 or net <= 0.0:
        return 0.0
    while True:
        passed = valve_flow(valve, given, behind, points, resampled(passed.flow, points))
        above = lowest(passed.pressure) + behind.impedance * mean
        before, found = found, _flow_at(valve, above, behind)
        straight = bool(np.all(valve.drop(passed.flow, behind.rho)[1] == 0.0))
        if straight or abs(found - before) <= RESOLVED * mean or points > MOST_POINTS:
            return max(found, 0.0)
        points = 2 * points - 1


def _flow_at(valve: Valve, above: float, behind: ValveSurroundings) -> float:
    """Return the flow [kg/s] at which an open valve and its line together lose `above` [Pa]."""
    held = (above - valve.pressure) / behind.impedance
    if valve.area is None or held**2 <= 2.0 * behind.rho * valve.area**2 * valve.pressure:
        return held
    orifice = 1.0 / (2.0 * behind.rho * valve.area**2)
    return (math.sqrt(behind.impedance**2 + 4.0 * orifice * above) - behind.impedance) / (2.0 * orifice)


def lowest(curve: Array) -> float:
    """Return the lowest value of a periodic curve given at evenly spaced angles, also between them."""
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


def closed(given: Array, behind: ValveSurroundings, leaking: float = 0.0) -> Array:
    """Return the pressure of a plenum whose valve stays shut, relative to its mean [Pa], at `POINTS` angles.

    `leaking` [kg/(Pa s)] times that pressure is the flow that leaks take from `given`.
    """
    spectrum = np.fft.rfft(resampled(np.asarray(given), POINTS))
    k = np.arange(1, len(spectrum))
    spectrum[1:] /= 1j * k * behind.frequency * behind.capacity + leaking
    spectrum[0] = 0.0
    return np.fft.irfft(spectrum, POINTS)


def driving(held: float, across: float) -> float:
    """Return the pressure that counts as driving the machine's leaks, over the line's."""
    return abs(across) + LEAST_ACROSS * (1.0 + held)


def standing(held: float, flow: Array, answering: float, across: float) -> float:
    """Return the next mean relative offset of a plenum whose valve stays shut, from the present one `held` (M222).

    It changes until the chambers' flow [kg/s] into the plenum has no mean; the step is that mean over the flow in
    motion. `answering` is the flow by which the open chambers respond to a doubled pressure. Leaks grow with the
    pressure `across` the machine (over the line's), so the step is proportional to that.
    """
    moved = float(np.mean(np.abs(flow))) + answering
    share = float(np.mean(flow)) / moved if moved > 0.0 else 0.0
    step = driving(held, across)
    return max(held + step * float(np.clip(share, -MOST_CHANGE, MOST_CHANGE)), (1.0 - MOST_CHANGE) * (1.0 + held) - 1.0)
