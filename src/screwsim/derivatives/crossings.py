"""Where flows turn round: the pressure in a chamber passes that of what it is open to."""

from __future__ import annotations

import numpy as np

from screwsim.derivatives.pitch import Pitch
from screwsim.derivatives.slices import SHARES, Crossing
from screwsim.effects.base import FlowPath
from screwsim.model.slots import P_PITCH, P_PORT_WIDTH, PLACE, PRESSURE
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.roots import brentq

Array = np.ndarray
PLACED = 1e-10  # of the distance between two of these, and of the angle: how well a crossing is placed
SLOPE = 1e-3  # of that distance, for the slope of the pressure there
LOOKED = np.array((0.08, SHARES[0], 0.4, SHARES[1], 0.85, 0.97))  # shares of a slice where pressures are read


def crossings(pitch: Pitch) -> list[Crossing]:
    """Return where flows through ports turn round in the last history, by their angles.

    Those through gaps are left out: what they carry is little, and the same slices would be needed for each.
    """
    c, R, parts = pitch.machinery.composition, pitch.machinery.R, pitch.problem.parts
    life, slices = pitch.machinery.trajectory, pitch.slices
    angles = (slices.edges[:-1, None] + slices.widths[:, None] * LOOKED).ravel()
    starts = float(c.P[P_PITCH]) * np.arange(c.chambers)
    whole = (starts[:, None] + angles).ravel()
    p = life.states_at(whole)[:, -1].reshape(c.chambers, -1)
    found: list[Crossing] = []
    for i, path in enumerate(path for _, path in parts.all(FlowPath) if path.to != "neighbour"):
        areas = np.empty(len(whole))
        life.module.trace__areas_along(whole, i, True, c.P, c.TAB, areas)
        number, is_open = parts.number(path.to), areas.reshape(c.chambers, -1) > 0.0
        line, width = float(R[number * PLACE + PRESSURE]), float(c.P[P_PORT_WIDTH + number])
        for j, start in enumerate(starts.tolist()):
            turns = ((p[j, :-1] - line) * (p[j, 1:] - line) < 0.0) & is_open[j, :-1] & is_open[j, 1:]
            for k in np.flatnonzero(turns).tolist():
                found.append(_crossing(life, start, (float(angles[k]), float(angles[k + 1])), line, width))
    return sorted(found)


def _crossing(life: Trajectory, start: float, ends: tuple[float, float], line: float, width: float) -> Crossing:
    """Return where the pressure passes a line's [Pa] between two angles, by the states themselves.

    The pressure that a history stores is held between its ends near a line, which is good for flows and not for this.
    """

    def drop(angle: float) -> float:
        return float(life.pressures_at(np.array([start + angle]))[0]) - line

    low, high = ends
    below, above = drop(low), drop(high)
    angle = low - below * (high - low) / (above - below) if below * above < 0.0 else 0.5 * (low + high)
    if below * above < 0.0:
        angle = brentq(drop, low, high, PLACED * (high - low), PLACED)
        step = SLOPE * (high - low)
        slope = (drop(angle + step) - drop(angle - step)) / (2.0 * step)
    else:
        slope = (above - below) / (high - low)
    return Crossing(angle, width / max(abs(slope), 1e-300))
