"""A tabulated discharge port moved to a built-in volume ratio: its opening moves, its closing does not.

Discharge ends where the lobes leave the end face, however the port is cut; a larger ratio cuts its opening edge later.
So the rows up to the widest are shifted as a whole until the chamber has the volume of that ratio where they begin, and
the port is the smaller of these and of the rows after the widest (docs/model.md, M394). Units SI.
"""

import math
from collections.abc import Callable

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.protocol import VolumeKernels
from screwsim.numerics.roots import bisected
from screwsim.numerics.spline import negligible_areas, pack_curve, table_value

PATH = "machine.built_in_volume_ratio"
LAST = math.radians(10.0)  # a port opens at least this long before the end of discharge (see `Rotors.discharge_angle`)
FINE = 1e-13  # relative accuracy to which an angle is found
Array = np.ndarray


def opening_angle(volume: VolumeKernels, closes: float, end: float, ratio: float) -> float | None:
    """Return the angle [rad] of the volume at `closes` over a ratio; None where there is none before `end`."""
    rows = np.linspace(closes, end, 65)
    values = volume.along(rows)[0]
    wanted = float(values[0]) / ratio
    below = np.flatnonzero(values < wanted)
    if not len(below):
        return None
    low, high = rows[below[0] - 1 : below[0] + 1].tolist()
    return bisected(lambda angle: float(volume.along(np.array([angle]))[0][0]) >= wanted, low, high, FINE)[1]


def opening_row(angles: Array, areas: Array) -> float:
    """Return the angle [rad] at which a table of areas begins to open; its first where it is open from there."""
    shut = np.flatnonzero(negligible_areas(areas)[: int(np.argmax(areas))])
    return float(angles[shut[-1] if len(shut) else 0])


def moved_area(angles: Array, areas: Array, opens: float | None, ratio: float) -> tuple[Array, Array]:
    """Return a table of areas [m²] over angles [rad] with its opening shifted to `opens`, as the volume ratio requires.

    Raises UsageError, in one line with the remedy, where the table cannot be shifted so far.
    """
    widest = int(np.argmax(areas))
    before = np.flatnonzero(negligible_areas(areas)[:widest])
    if not len(before):
        what = "cannot be met: the table of machine.discharge_port is open from its first row, so that it does not show"
        raise UsageError(f"{PATH}: {what} where it opens (begin its file with a row of area 0, or remove this)")
    behind = np.flatnonzero(negligible_areas(areas)[widest:])
    end = float(angles[widest + behind[0]] if len(behind) else angles[-1])
    if opens is None or opens > end - LAST:
        what = f"{ratio:.4g} leaves the port less than 10 deg before the end of discharge"
        raise UsageError(f"{PATH}: {what} (choose a smaller ratio)")
    first = int(before[-1])
    edge = angles[first : widest + 1] + (opens - angles[first]), areas[first : widest + 1]
    rest = angles[widest:], areas[widest:]
    rows = np.unique(np.concatenate([edge[0], rest[0]]))
    rows = rows[rows <= end] if edge[0][-1] > end else rows
    by_edge, by_rest = _curve(*edge), _curve(*rest)
    above = np.array([by_edge(each) > by_rest(each) for each in rows])
    crossed = np.flatnonzero(above[1:] & ~above[:-1])  # once: one rises or stays, the other does not rise beyond it
    ends = (rows[i : i + 2].tolist() for i in crossed)
    meets = [bisected(lambda angle: by_edge(angle) <= by_rest(angle), low, high, FINE)[1] for low, high in ends]
    rows = np.unique([*rows, *meets])
    moved = np.array([min(by_edge(each), by_rest(each)) for each in rows])
    if angles[0] < rows[0]:  # shut up to its first row
        rows, moved = np.insert(rows, 0, angles[0]), np.insert(moved, 0, moved[0])
    return rows, moved


def _curve(angles: Array, areas: Array) -> Callable[[float], float]:
    """Return the spline of a table (M14), constant beyond its ends."""
    if len(angles) == 1:
        return lambda angle: float(areas[0])
    packed = pack_curve(angles, areas)
    return lambda angle: float(table_value(angle, packed, 0))
