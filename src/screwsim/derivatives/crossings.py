"""Where flows turn round: a chamber's pressure passes that of what it is open to, its oil's gas is in equilibrium."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from screwsim.derivatives.pitch import Pitch
from screwsim.derivatives.slices import SHARES, Crossing
from screwsim.effects.base import FlowPath
from screwsim.model.slots import FIRST_OWN, P_GAP_WIDTH, P_PITCH, P_PORT_WIDTH, PLACE, PRESSURE
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.roots import brentq

Array = np.ndarray
PLACED = 1e-10  # of the distance between two of these, and of the angle: how well a crossing is placed
SLOPE = 1e-3  # of that distance, for the slope of the pressure there
LOOKED = np.array((0.08, SHARES[0], 0.4, SHARES[1], 0.85, 0.97))  # shares of a slice where pressures are read
CORNERED = 1e-2  # rad: what a corner of a rate counts as, whose slope jumps; the slice before it ends 1e-6 rad from it
STEEP = 1.0  # of a slice: layers of gaps that are wider are resolved anyway


class Side(NamedTuple):
    """A chamber, at an angle [rad] of its life when the pitch begins, or a line, at none, by its number."""

    start: float | None
    line: int = 0


def crossings(pitch: Pitch) -> list[Crossing]:
    """Return where flows turn round in the last history, by their angles: through ports, steep ones of gaps, from oil.

    What a gap carries is little, but near its turn as steep in the pressures as that of a port.
    """
    life, slices = pitch.machinery.trajectory, pitch.slices
    angles = (slices.edges[:-1, None] + slices.widths[:, None] * LOOKED).ravel()
    wide, found = np.repeat(slices.widths, len(LOOKED)), []
    for own, beyond, width, turns in _turning(pitch, angles):
        for k in np.flatnonzero(turns).tolist():
            ends = float(angles[k]), float(angles[k + 1])
            crossing = _crossing(life, own, beyond, ends, float(width[k]))
            if crossing is not None and (beyond.start is None or crossing.layer < STEEP * wide[k]):
                found.append(crossing)
    return sorted({*found, *_equilibria(pitch, angles)})


def _equilibria(pitch: Pitch, angles: Array) -> Iterator[Crossing]:
    """Yield where oil that gives gas off begins to take it up, or the other way round, by another rate (M231)."""
    c, life = pitch.machinery.composition, pitch.machinery.trajectory
    if not c.dissolves:
        return

    def given_off(angle: float) -> float:
        return float(life.given_off(np.array([angle]))[0])

    for start in (float(c.P[P_PITCH]) * np.arange(c.chambers)).tolist():
        at = start + angles
        gas = life.given_off(at)
        for k in np.flatnonzero(gas[:-1] * gas[1:] < 0.0).tolist():
            low, high = at[k : k + 2].tolist()
            yield Crossing(brentq(given_off, low, high, PLACED * (high - low), PLACED) - start, CORNERED)


def _turning(pitch: Pitch, angles: Array) -> Iterator[tuple[Side, Side, Array, Array]]:
    """Yield the sides of each open path, the width [Pa] of its regularisation, and behind which angles it turns."""
    c, parts = pitch.machinery.composition, pitch.problem.parts
    life, gaps, ports = pitch.machinery.trajectory, 0, 0
    starts = float(c.P[P_PITCH]) * np.arange(c.chambers)
    whole = (starts[:, None] + angles).ravel()
    p = life.states_at(whole)[:, -1].reshape(c.chambers, -1)
    for path in (path for _, path in parts.all(FlowPath)):
        of_port, areas = path.to != "neighbour", np.empty(len(whole))
        life.module.trace__areas_along(whole, ports if of_port else gaps, of_port, c.P, c.TAB, areas)
        ports, gaps = ports + of_port, gaps + (not of_port)
        is_open = areas.reshape(c.chambers, -1) > 0.0
        if of_port:
            number = parts.number(path.to)
            beyond = _line_pressures(life, number, angles)
            sides = [(j, Side(None, number), beyond) for j in range(c.chambers)]
            widths = np.full(p.shape, float(c.P[P_PORT_WIDTH + number]))
        else:  # those ahead of the last one are the discharge, whose port tells
            ahead = range(path.offset, c.chambers)
            sides = [(j, Side(float(starts[to])), p[to]) for j, to in enumerate(ahead)]
            widths = float(c.P[P_GAP_WIDTH]) * p
        for j, beyond, there in sides:
            drop = p[j] - there
            turns = (drop[:-1] * drop[1:] < 0.0) & is_open[j, :-1] & is_open[j, 1:]
            yield Side(float(starts[j])), beyond, widths[j], turns


def _line_pressures(life: Trajectory, number: int, angles: Array) -> Array:
    """Return that of `_line_pressure` at angles [rad]: one where the line does not pulsate."""
    if not life.composition.pulsating or number >= FIRST_OWN:
        return np.full(len(angles), float(life.R[number * PLACE + PRESSURE]))
    return np.array([_line_pressure(life, number, angle) for angle in angles.tolist()])


def _line_pressure(life: Trajectory, number: int, angle: float) -> float:
    """Return the pressure [Pa] that a port meets at an angle [rad], of a line that pulsates with the lobes (M185)."""
    c, pressure = life.composition, float(life.R[number * PLACE + PRESSURE])
    if not c.pulsating or number >= FIRST_OWN:
        return pressure
    return pressure * (1.0 + sum(life.module.line_pulse(number, angle, c.P)))


def _crossing(life: Trajectory, own: Side, beyond: Side, ends: tuple[float, float], width: float) -> Crossing | None:
    """Return where the pressures of both sides are equal between two angles, by the states themselves.

    Of two chambers it is None where these tell of none.

    The pressure that a history stores is held between its ends near a line, which is good for flows and not for this.
    """

    def pressure(of: Side, angle: float) -> float:
        if of.start is None:
            return _line_pressure(life, of.line, angle)
        return float(life.pressures_at(np.array([of.start + angle]))[0])

    def drop(angle: float) -> float:
        return pressure(own, angle) - pressure(beyond, angle)

    low, high = ends
    below, above = drop(low), drop(high)
    angle = low - below * (high - low) / (above - below) if below * above < 0.0 else 0.5 * (low + high)
    if below * above < 0.0:
        angle = brentq(drop, low, high, PLACED * (high - low), PLACED)
        step = SLOPE * (high - low)
        slope = (drop(angle + step) - drop(angle - step)) / (2.0 * step)
    elif beyond.start is not None:
        return None
    else:
        slope = (above - below) / (high - low)
    return Crossing(angle, width / max(abs(slope), 1e-300))
