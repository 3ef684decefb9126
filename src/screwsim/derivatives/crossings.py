"""Find where flows turn round or rates jump.

This is where a chamber's pressure passes that of what it is open to, where its oil's gas is in equilibrium, and where
its gas crosses a phase border.
"""

from collections.abc import Callable, Iterator
from functools import cache
from typing import NamedTuple

import numpy as np

from screwsim.derivatives.mesh import CORNER_LAYER, Crossing, share_before
from screwsim.derivatives.phases import border_crossings
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.radau import SHARES
from screwsim.effects.base import FlowPath
from screwsim.model.slots import FREE, P_GAP_WIDTH, P_PITCH, P_PORT_WIDTH, PORT_STATE, PRESSURE
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.roots import bracketed, brentq

Array = np.ndarray
SignChanges = tuple[Array, ...]  # rows and columns: chambers, and angles after which pressure differences change sign
PLACE_TOLERANCE = 1e-10  # tolerance on a crossing, over the distance of its two angles and over the angle
OF_LAYER = 1e-6  # of its regularisation: pressure difference at which a crossing is placed well enough
SLOPE = 1e-3  # of that distance, for the slope of the pressure there
SAMPLED_SHARES = np.array((0.08, SHARES[0], 0.4, SHARES[1], 0.85, 0.97))  # shares of a slice where pressures are read
STEEP = 1.0  # widths of a slice: wider layers of gaps are resolved anyway


class PathSide(NamedTuple):
    """One side of a path: a chamber, by its angle [rad] when the pitch starts, or a line (no angle), by its number."""

    start: float | None
    line: int = 0


class FlowReversal(NamedTuple):
    """A path whose flow turns round: its sides, the angles [rad] between which it does, its regularisation [Pa].

    `wide` [rad] is the width of the slice.
    """

    own: PathSide
    beyond: PathSide
    ends: tuple[float, float]
    width: float
    wide: float


def crossings(pitch: CollocatedPitch) -> list[Crossing]:
    """Return where flows turn round in the last history, by angle: through ports, steep ones through gaps, from oil.

    Crossings of phase borders are included. A gap carries little, but near its turning its flow is as steep in the
    pressures as that of a port.
    """
    mesh = pitch.mesh
    angles = (mesh.edges[:-1, None] + mesh.widths[:, None] * SAMPLED_SHARES).ravel()
    wide = np.repeat(mesh.widths, len(SAMPLED_SHARES))
    if pitch.alone:  # at the dead centre, where a turn begins, the gas that is left begins to expand
        angles, wide = np.append(mesh.edges[0], angles), np.append(wide[0], wide)
    c, life = pitch.machinery.composition, pitch.machinery.trajectory
    starts = float(c.P[P_PITCH]) * np.arange(c.chambers)
    states = life.states_at((starts[:, None] + angles).ravel()).reshape(c.chambers, len(angles), -1)
    turns = list(_reversals(pitch, angles, wide, states[..., -1]))
    others = (*_equilibria(pitch, angles), *border_crossings(pitch, angles, states))
    return sorted({*_located(life, turns), *others})


def _equilibria(pitch: CollocatedPitch, angles: Array) -> Iterator[Crossing]:
    """Yield where oil changes between releasing and absorbing gas, which have different rates (M231)."""
    c, life = pitch.machinery.composition, pitch.machinery.trajectory
    if not c.dissolves:
        return

    def given_off(angle: float) -> float:
        """Return the rate at which oil gives off gas at an angle [rad]."""
        return float(life.given_off(np.array([angle]))[0])

    for start in (float(c.P[P_PITCH]) * np.arange(c.chambers)).tolist():
        at = start + angles
        gas = life.given_off(at)
        for k in np.flatnonzero(gas[:-1] * gas[1:] < 0.0).tolist():
            low, high = at[k : k + 2].tolist()
            yield Crossing(
                brentq(given_off, low, high, PLACE_TOLERANCE * (high - low), PLACE_TOLERANCE) - start, CORNER_LAYER
            )


def _reversals(pitch: CollocatedPitch, angles: Array, wide: Array, p: Array) -> Iterator[FlowReversal]:
    """Yield where, between angles [rad], flows turn round in open paths; `wide` are the widths of their slices [rad].

    `p` [Pa] are the pressures of all chambers there. Areas are evaluated only where pressures pass each other,
    which is the same for all gaps between the same chambers, and for all ports to the same line.
    """
    c, parts, life = pitch.machinery.composition, pitch.problem.parts, pitch.machinery.trajectory
    starts = float(c.P[P_PITCH]) * np.arange(c.chambers)

    @cache
    def to_line(number: int) -> SignChanges:
        return _sign_changes(p - _line_pressures(life, number, angles))

    @cache
    def ahead(offset: int) -> SignChanges:  # the last chambers have the discharge ahead of them, treated as a port
        return _sign_changes(p[: c.chambers - offset] - p[offset:])

    def reversal(j: int, k: int, beyond: PathSide, width: float) -> FlowReversal:
        ends = float(angles[k]), float(angles[k + 1])
        return FlowReversal(PathSide(float(starts[j])), beyond, ends, width, float(wide[k]))

    for index, (_, path) in enumerate(parts.ports):
        number = parts.number(path.to)
        for j, k in _in_open(pitch, path, index, angles, to_line(number)):
            yield reversal(j, k, PathSide(None, number), float(c.P[P_PORT_WIDTH + number]))
    for index, (_, path) in enumerate(parts.gaps, len(c.ports)):
        for j, k in _in_open(pitch, path, index, angles, ahead(path.offset)):
            yield reversal(j, k, PathSide(float(starts[j + path.offset])), float(c.P[P_GAP_WIDTH] * p[j, k]))


def _in_open(
    pitch: CollocatedPitch, path: FlowPath, index: int, angles: Array, changes: SignChanges
) -> Iterator[tuple[int, int]]:
    """Yield those sign changes, chamber and angle, between whose angles [rad] the path `index` is open."""
    if not len(changes[0]):
        return
    c = pitch.machinery.composition
    starts = float(c.P[P_PITCH]) * np.arange(c.chambers)
    ends = (starts[changes[0], None] + angles[changes[1][:, None] + (0, 1)]).ravel()
    areas = np.zeros(ends.size)
    pitch.machinery.module.trace__areas_along(ends, index, c.P, c.TAB, areas)
    is_open = (areas.reshape(-1, 2) > 0.0).all(axis=1)
    if path.opening is not None and not path.one_way:
        is_open &= _opened(pitch, index, ends).reshape(-1, 2).all(axis=1)
    yield from zip(*(each[is_open].tolist() for each in changes), strict=True)


def _opened(pitch: CollocatedPitch, index: int, angles: Array) -> Array:
    """Return whether the valve of a port is open at angles [rad] of a single chamber's turn."""
    c, life = pitch.machinery.composition, pitch.machinery.trajectory
    order = np.argsort(angles, kind="stable")
    found = np.zeros(len(angles), bool)
    for at, y in zip(order.tolist(), life.states_at(angles[order]), strict=True):
        found[at] = life.module.path_opening(index, 0.0, 1.0, FREE, y, 0, c.P) > 0.0
    return found


def _sign_changes(drops: Array) -> SignChanges:
    """Return after which angles, and for which chambers, pressure differences change sign: rows, columns."""
    return np.nonzero(drops[:, :-1] * drops[:, 1:] < 0.0)


def _line_pressures(life: Trajectory, number: int, angles: Array) -> Array:
    """Return the pressures [Pa] at a port to a line at angles [rad], which may pulsate with the lobes (M185)."""
    return float(life.R[number * PORT_STATE + PRESSURE]) * (1.0 + life.line_pulses(number, angles).sum(axis=1))


def _located(life: Trajectory, turns: list[FlowReversal]) -> list[Crossing]:
    """Return where the pressures on both sides of paths are equal, computed from the states themselves.

    Between two chambers a crossing is left out where the states show none, or one in a wide layer. The pressure
    stored in a history is held at its ends near a line, which is good for flows but not for this.
    """
    if not turns:
        return []
    low, high = np.array([turn.ends for turn in turns]).T
    widths = np.array([turn.width for turn in turns])
    drop = _pressure_differences(life, turns)
    at, step = bracketed(drop, low, high, PLACE_TOLERANCE, OF_LAYER * widths), SLOPE * (high - low)
    real = np.isfinite(at)
    at, step = np.where(real, at, 0.5 * (low + high)), np.where(real, step, 0.5 * (high - low))
    slopes = (drop(at + step) - drop(at - step)) / (2.0 * step)
    layers = widths / np.maximum(np.abs(slopes), 1e-300)
    share = share_before(float(life.composition.P[P_GAP_WIDTH]))
    return [
        Crossing(angle, layer, share=share)
        for turn, is_real, angle, layer in zip(turns, real.tolist(), at.tolist(), layers.tolist(), strict=True)
        if turn.beyond.start is None or (is_real and layer < STEEP * turn.wide)
    ]


def _pressure_differences(life: Trajectory, turns: list[FlowReversal]) -> Callable[[Array], Array]:
    """Return a function of angles [rad], one for each path, giving the pressure difference [Pa] between its sides."""
    sides = [turn.own for turn in turns] + [turn.beyond for turn in turns]
    starts = np.array([np.nan if side.start is None else side.start for side in sides])
    chambers, found = np.flatnonzero(np.isfinite(starts)), np.empty(len(sides))
    to_line = np.array([-1 if side.start is not None else side.line for side in sides])
    lines = [(number, np.flatnonzero(to_line == number)) for number in np.unique(to_line[to_line >= 0]).tolist()]

    def drop(angles: Array) -> Array:
        at = (starts + np.append(angles, angles))[chambers]
        order = np.argsort(at, kind="stable")
        found[chambers[order]] = life.pressures_at(at[order])
        for number, rows in lines:
            found[rows] = _line_pressures(life, number, angles[rows - len(angles)])
        return found[: len(angles)] - found[len(angles) :]

    return drop
