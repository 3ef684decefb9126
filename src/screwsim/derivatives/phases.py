"""Where the gas of a chamber passes the border of its phases, and what that makes of a small change.

Heat capacity and exponent of a gas jump there (docs/explanation/integrator.md, borders of phases), and with them the
rates of all that meets it. A change delays the angle at which the border is passed by δφ, over which the rates of the
one side act in place of those of the other: δy jumps by (f − f₊) δφ, a quadrature by (g − g₊) δφ. The border is a
temperature over density, T_b(ρ): δφ = (δT_b + T_b' δρ − δT)/(dT/dφ − T_b' dρ/dφ).

Source: M. di Bernardo et al., Piecewise-smooth Dynamical Systems, Springer 2008, 2.5 (saltation matrix).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from screwsim.derivatives.pitch import Numbers, Pitch
from screwsim.derivatives.slices import BEFORE, CORNERED, Crossing
from screwsim.model.slots import P_PITCH, S_RHO, S_T

Array = np.ndarray
PLACED = 1e-10  # rad: how well a border is placed
ENDS = 1e-7, 1e-5  # rad: how near before a border a slice may end, and how far, to stay where it is
JUMP = 3e-5  # rad: the slice behind a border, in which a change of the states jumps
SHIFT = 1e-7  # of numbers ...
BESIDE = 1e-5  # ... and of the density, for differences of what they make of a border
NEAREST, FARTHEST = 1e-8, 1e-2  # of a temperature: how near to it a border is looked for, and how far
NARROW = 1e-14  # of a temperature: how well a border is placed


class Border(NamedTuple):
    """Where a chamber passes the border of its phases, at the end of a slice, and what that makes of a change.

    A change of the states `by_states` (N,) delays it [rad], one of the numbers as `at` tells; by that times `states`
    (N,) the states change there, by that times `sums` the quadratures.
    """

    slice: int
    at: At
    by_states: Array
    states: Array
    sums: Array

    def by_numbers(self, changes: Sequence[Numbers]) -> Array:
        """Return by how much changes of the numbers delay the border [rad]."""
        return np.array([self.at.changed(each) / self.at.steepness for each in changes])


class At(NamedTuple):
    """A state T [K], ρ [kg/m³] at a border, as a pitch has it.

    `steepness` [K/rad] is the rate at which the temperature passes that of the border.
    """

    pitch: Pitch
    T: float
    rho: float
    steepness: float

    def changed(self, numbers: Numbers) -> float:
        """Return by how much the temperature of the border changes with the numbers [K]."""
        if not (numbers.P.any() or numbers.TAB.any()):
            return 0.0
        sides = [self.pitch.numbers.plus(by, numbers) for by in (SHIFT, -SHIFT)]
        above, below = (border_temperature(self.pitch, self.T, self.rho, each) for each in sides)
        return (above - below) / (2.0 * SHIFT)


def border_crossings(pitch: Pitch, angles: Array, states: Array) -> Iterator[Crossing]:
    """Yield where a chamber of the last history passes the border of its phases, between angles [rad] of the pitch.

    `states` are those of all chambers there (chambers, angles, …).
    """
    c, life = pitch.machinery.composition, pitch.machinery.trajectory
    if not pitch.has_phases:
        return
    every = pitch.phases_of(states.reshape(-1, states.shape[-1])).reshape(states.shape[:2])
    for chamber, phases in enumerate(every):
        start = float(c.P[P_PITCH]) * chamber
        for k in np.flatnonzero(np.diff(phases)).tolist():
            low, high = float(angles[k]), float(angles[k + 1])
            while high - low > PLACED:
                middle = 0.5 * (low + high)
                there = pitch.phases_of(life.states_at(np.array([start + middle])))[0]
                low, high = (middle, high) if there == phases[k] else (low, middle)
            yield Crossing(_as_it_stands(pitch, chamber, high), CORNERED, JUMP)


def _as_it_stands(pitch: Pitch, chamber: int, angle: float) -> float:
    """Return the angle [rad] of a border, or that by which slices end before it already, where they end near enough.

    Behind that end the gas is held in its other phase, by whose rates it is found: it would go to and fro.
    """
    end = int(np.searchsorted(pitch.slices.edges, angle)) - 1
    at = float(pitch.slices.edges[end])
    passes = end > 0 and pitch.phases[end - 1, chamber] != pitch.phases[end, chamber]
    return at + BEFORE * CORNERED if passes and ENDS[0] < angle - at < ENDS[1] else angle


def borders(pitch: Pitch, Y: Array) -> list[Border]:
    """Return the borders that chambers pass, each at the end of a slice."""
    passed = np.argwhere(np.diff(pitch.phases, axis=0)).tolist()
    found = (_border(pitch, Y, k, chamber, pitch.phases[k : k + 2]) for k, chamber in passed)
    return [each for each in found if each is not None]


def _border(pitch: Pitch, Y: Array, k: int, chamber: int, phases: Array) -> Border | None:
    """Return the border that a chamber passes at the end of slice k, with the phases of all before and behind it.

    None where it is only touched: there is no derivative.
    """
    y, own = Y[k, -1], [chamber * pitch.n + S_T, chamber * pitch.n + S_RHO]
    before, behind = phases[0], phases[0].copy()
    behind[chamber] = phases[1, chamber]
    (f, g), (f_behind, g_behind) = (pitch.rates_in(each, k + 1, y) for each in (before, behind))
    T, rho = y[own].tolist()
    sides = [border_temperature(pitch, T, rho * (1.0 + by), pitch.numbers) for by in (BESIDE, -BESIDE)]
    passes = np.array([1.0, (sides[1] - sides[0]) / (2.0 * BESIDE * rho)])
    steepness = float(passes @ f[own])
    if not steepness * float(passes @ f_behind[own]) > 0.0:
        return None
    by_states = np.zeros(pitch.N)
    by_states[own] = -passes / steepness
    return Border(k, At(pitch, T, rho, steepness), by_states, f - f_behind, (g - g_behind)[:-1])


def border_temperature(pitch: Pitch, T: float, rho: float, numbers: Numbers) -> float:
    """Return the temperature [K] at which a gas of ρ [kg/m³] changes its phase, next to T; NaN where none is near."""
    P, TAB, phase = numbers.P, numbers.TAB, pitch.machinery.module.gas_phase
    own, apart = phase(T, rho, P, TAB), NEAREST
    while apart < FARTHEST:
        for low, high in ((T, T * (1.0 + apart)), (T, T * (1.0 - apart))):
            if phase(high, rho, P, TAB) != own:
                while abs(high - low) > NARROW * T:
                    middle = 0.5 * (low + high)
                    low, high = (middle, high) if phase(middle, rho, P, TAB) == own else (low, middle)
                return 0.5 * (low + high)
        apart *= 2.0
    return float("nan")
