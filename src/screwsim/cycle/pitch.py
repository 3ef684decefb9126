"""One pitch of all chambers of a closed cycle: pressure and slope of the volume by angle (docs/model.md M144).

The loads on shaft and bearings repeat every lobe pitch. Pressures come from the dense output of the last history,
slopes from the volume law itself; nothing is compiled for it. Curves are given at evenly spaced angles. Means and
harmonics are integrals between the ends of all steps, where ports open and pressures have corners: even angles counted
the gas at 0°, which expands within a degree, for half a degree, and gave a single male lobe too large a force.
"""

from collections.abc import Callable
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

from screwsim.cycle.between_ends import missed_pressure
from screwsim.machine.protocol import MachineGeometry
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.parabola import vertex

Array = np.ndarray
POINTS = 360  # angles of a pitch: 0.25° apart with four lobes
SIDE_STEP = 1e-6  # rad, distance from the end of a step
NEAR_BY = np.linspace(-1.0, 1.0, 17)  # points around an extreme, over the distance of those before ...
NEAREST, NEARER = 0.125, 2  # ... distance of these, and how often points nearer by are added
BESIDE = np.arange(-2.0, 3.0)  # points around the last, over their distance, for a parabola ...
SMOOTH = 3.0  # ... where the bend over the second to that over the first is above this: 4 of a parabola, 2 of a corner
NODES, WEIGHTS = np.polynomial.legendre.leggauss(3)  # of each part of a pitch between the ends of steps


class PitchQuadrature(NamedTuple):
    """Nodes of a quadrature over one pitch, in parts that contain no end of a step; columns as those of `Pitch`.

    phase (nodes,): share of the pitch that the youngest chamber has passed; weight (nodes,), whose sum is 1.
    """

    phase: Array
    weight: Array
    pressure: Array
    slope: Array
    male_slope: Array | None

    def mean(self, curve: Array) -> float:
        """Return the mean of a curve at the nodes."""
        return float(self.weight @ curve)

    def harmonics(self, curve: Array, count: int) -> list[float]:
        """Return the amplitudes of the first `count` harmonics of a curve at the nodes (M147)."""
        turned = np.exp(-2j * np.pi * np.arange(1, count + 1)[:, None] * self.phase)
        return (2.0 * np.abs(turned @ (self.weight * curve))).tolist()

    def smooth(self, curve: Array, mean: float, points: int) -> Array:
        """Return a curve at an odd number of even angles, with a stated mean and only the harmonics that these resolve.

        Sampling the curve at the angles would alias the higher harmonics of its corners.
        """
        turned, turn = points * self.weight * curve, np.exp(-2j * np.pi * self.phase)
        spectrum = np.zeros(points // 2 + 1, complex)
        for k in range(1, len(spectrum)):
            turned = turned * turn
            spectrum[k] = turned.sum()
        return mean + np.fft.irfft(spectrum, points)


class Pitch(NamedTuple):
    """One pitch at evenly spaced angles, its end excluded; columns of arrays are the chambers alive, youngest first.

    angle (points,) [rad] of the youngest chamber; pressure (points, chambers) [Pa]; slope dV/dφ and the male
    rotor's part of it, known for rotors only (points, chambers) [m³/rad]; low_pressure [Pa]: that of the lower
    line, around the rotors; torque_mean [N m]: indicated power over ω; high_pressure [Pa]: that of the higher line.
    """

    angle: Array
    pressure: Array
    slope: Array
    male_slope: Array | None
    low_pressure: float
    torque_mean: float
    high_pressure: float
    at: Callable[[Array], tuple[Array, Array]]
    missed: Callable[[Array], Array]
    steps: Array
    within: Callable[..., PitchQuadrature]

    def extremes(self, *curves: Callable[[Array, Array], Array]) -> list[tuple[float, float]]:
        """Return the lowest and highest value over a pitch of curves of all chambers' pressures and slopes.

        Extremes may be corners or lie between the points: each curve is also evaluated on both sides of the
        ends of steps, and ever nearer around its lowest and its highest value; where it is smooth, these lie at the
        tops of parabolas. To these two what the dense output misses of the pressures is added
        (`cycle.between_ends`); at the end of one chamber's step others are within theirs.
        """
        reach = float(self.angle[1])
        ends = np.sort(np.concatenate([self.steps - SIDE_STEP, self.steps + SIDE_STEP]) % (reach * len(self.angle)))
        angles, at_ends, found = np.append(self.angle, ends), self.at(ends), []
        for curve in curves:
            values, apart = np.append(curve(self.pressure, self.slope), curve(*at_ends)), reach
            best = angles[[values.argmin(), values.argmax()]]
            for _ in range(NEARER):
                values = self._beside(curve, best, apart * NEAR_BY)
                best, apart = best + apart * NEAR_BY[[values[0].argmin(), values[1].argmax()]], apart * NEAREST
            best = best + apart * _tops(self._beside(curve, best, apart * BESIDE))
            low, high = self._beside(curve, best, np.zeros(1), self.missed)[:, 0].tolist()
            found.append((low, high))
        return found

    def _beside(self, curve: Callable[[Array, Array], Array], at: Array, by: Array, missed: Any = None) -> Array:
        """Return a curve beside angles `at` [rad], by so much, a row for each; with what is `missed` of pressures."""
        angles = (at[:, None] + by).ravel() % (self.angle[1] * len(self.angle))
        order = np.argsort(angles)
        pressure, slope = self.at(angles[order])
        values = np.empty(len(angles))
        values[order] = curve(pressure if missed is None else pressure + missed(angles[order]), slope)
        return values.reshape(len(at), len(by))


def _tops(values: Array) -> Array:
    """Return where the tops of parabolas lie, in units of `BESIDE`; 0 at a corner, which bends half as much at 2."""
    far, near, top, after, beyond = values.T
    smooth = np.abs(far - 2.0 * top + beyond) > SMOOTH * np.abs(near - 2.0 * top + after)
    return np.clip(np.where(smooth, vertex(near, top, after), 0.0), -1.0, 1.0)


def pitch_of(
    life: Trajectory, geometry: MachineGeometry, low_pressure: float, torque_mean: float, high_pressure: float
) -> Pitch:
    """Return the pitch of a life; pressures in Pa, `torque_mean` in N m."""
    angle = np.arange(POINTS) * (geometry.pitch / POINTS)
    grid = angle[:, None] + geometry.pitch * np.arange(geometry.chambers)
    found = life.states_at(grid.T.ravel())
    pressure = np.ascontiguousarray(found[:, -1].reshape(geometry.chambers, POINTS).T)
    slope, male = _slopes(geometry)
    at, steps = partial(_at, life, geometry.pitch, geometry.chambers), life.times[: life.steps].copy()
    missed = partial(_missed, life, geometry.pitch, geometry.chambers)
    within = lru_cache(maxsize=2)(partial(_quadrature_of, geometry, at, steps))
    return Pitch(angle, pressure, slope, male, low_pressure, torque_mean, high_pressure, at, missed, steps, within)


def _quadrature_of(
    geometry: MachineGeometry, at: Callable[[Array], tuple[Array, Array]], steps: Array, parts: int | None = None
) -> PitchQuadrature:
    """Return nodes between the ends of all steps and of even parts; by default `POINTS` over all chambers."""
    even = np.linspace(0.0, geometry.pitch, (parts or POINTS // geometry.chambers) + 1)
    ends = np.unique(np.concatenate([even, np.mod(steps, geometry.pitch)]))
    half = 0.5 * np.diff(ends)[:, None]
    angle = (ends[:-1, None] + half * (1.0 + NODES)).ravel()
    male = geometry.male_slope(angle[:, None] + geometry.pitch * np.arange(geometry.chambers))
    return PitchQuadrature(angle / geometry.pitch, (half * WEIGHTS).ravel() / geometry.pitch, *at(angle), male)


def _at(life: Trajectory, pitch: float, chambers: int, angle: Array) -> tuple[Array, Array]:
    """Return pressure and slope of the volume of all chambers at increasing angles of the youngest."""
    grid = (angle + pitch * np.arange(chambers)[:, None]).ravel()
    pressure = life.states_at(grid)[:, -1]
    shape = chambers, len(angle)
    return pressure.reshape(shape).T, life.volume_slopes(grid).reshape(shape).T


def _missed(life: Trajectory, pitch: float, chambers: int, angle: Array) -> Array:
    """Return what the dense output misses of the pressures of all chambers at angles of the youngest."""
    grid = (angle + pitch * np.arange(chambers)[:, None]).ravel()
    return missed_pressure(life, grid).reshape(chambers, len(angle)).T


@lru_cache(maxsize=16)
def _slopes(geometry: MachineGeometry) -> tuple[Array, Array | None]:
    """Return dV/dφ of all chambers over a pitch [m³/rad], and the male rotor's part of it where rotors are known."""
    grid = np.arange(POINTS)[:, None] * (geometry.pitch / POINTS) + geometry.pitch * np.arange(geometry.chambers)
    return geometry.volume_law().along(grid)[1], geometry.male_slope(grid)
