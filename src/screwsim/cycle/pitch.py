"""One pitch of all chambers of a closed cycle: pressure and slope of the volume by angle (docs/model.md M144).

What the shaft and the bearings feel repeats every lobe pitch. Pressures come from the dense output of the last
history, slopes from the volume law itself; nothing is compiled for it.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from screwsim.machine.protocol import MachineGeometry
from screwsim.model.trajectory import Trajectory

Array = np.ndarray
POINTS = 360  # of a pitch: 0.25° with four lobes


class Pitch(NamedTuple):
    """One pitch at evenly spaced angles, its end left out; columns of arrays are the chambers alive, youngest first.

    angle (points,) [rad] of the youngest chamber; pressure (points, chambers) [Pa]; slope dV/dφ and its part that the
    male rotor displaces, known of rotors only (points, chambers) [m³/rad]; low_pressure [Pa]: that of the lower line,
    around the rotors; torque_mean [N m]: indicated power over ω; high_pressure [Pa]: that of the higher line.
    """

    angle: Array
    pressure: Array
    slope: Array
    male_slope: Array | None
    low_pressure: float
    torque_mean: float
    high_pressure: float


def pitch_of(
    life: Trajectory, geometry: MachineGeometry, low_pressure: float, torque_mean: float, high_pressure: float
) -> Pitch:
    """Return the pitch of a life."""
    angle = np.arange(POINTS) * (geometry.pitch / POINTS)
    grid = angle[:, None] + geometry.pitch * np.arange(geometry.chambers)
    found = life.states_at(grid.T.ravel())
    pressure = np.ascontiguousarray(found[:, -1].reshape(geometry.chambers, POINTS).T)
    slope, male = _slopes(geometry)
    return Pitch(angle, pressure, slope, male, low_pressure, torque_mean, high_pressure)


@lru_cache(maxsize=16)
def _slopes(geometry: MachineGeometry) -> tuple[Array, Array | None]:
    """Return dV/dφ of all chambers over a pitch [m³/rad], and the male rotor's part of it where rotors are known."""
    grid = np.arange(POINTS)[:, None] * (geometry.pitch / POINTS) + geometry.pitch * np.arange(geometry.chambers)
    return geometry.volume_law().along(grid)[1], geometry.male_slope(grid)
