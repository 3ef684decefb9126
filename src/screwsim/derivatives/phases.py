"""Where a chamber's gas crosses a phase border, and the response to a small change there.

Heat capacity and exponent of the gas jump at the border (docs/explanation/integrator.md, borders of phases), and with
them all rates that depend on these. A change delays the crossing by an angle δφ, over which the rates of one side act
in place of those of the other: δy jumps by (f − f₊) δφ, a quadrature by (g − g₊) δφ. The border is a temperature over
density, T_b(ρ): δφ = (δT_b + T_b' δρ − δT)/(dT/dφ − T_b' dρ/dφ).

Source: M. di Bernardo et al., Piecewise-smooth Dynamical Systems, Springer 2008, 2.5 (saltation matrix).
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from screwsim.derivatives.held import has_phases
from screwsim.derivatives.mesh import CORNER_LAYER, SHARE_BEFORE, Crossing
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.rate_numbers import RateNumbers
from screwsim.model.slots import P_PITCH, S_RHO, S_T
from screwsim.numerics.roots import bisected

Array = np.ndarray
PLACE_TOLERANCE = 1e-10  # rad: tolerance on the angle of a border
ENDS = 1e-7, 1e-5  # rad: least and largest distance of a slice's end before a border, for the end to stay there
JUMP_WIDTH = 3e-5  # rad: the slice after a border, in which the response of the states jumps
SHIFT = 1e-7  # of numbers ...
DENSITY_STEP = 1e-5  # ... and of the density, for differences of a border's temperature
NEAREST, FARTHEST = 1e-8, 1e-2  # relative distances from a temperature between which a border is sought
NARROW = 1e-14  # relative tolerance on the temperature of a border


class BorderCrossing(NamedTuple):
    """A chamber's crossing of a phase border at the end of a slice of a pitch, at T [K], ρ [kg/m³].

    `steepness` [K/rad] is the rate at which the temperature passes that of the border. The delay [rad] by a change is
    `by_states` (N,) times that of the states, plus that by the numbers; times `states` (N,) it is the jump of the
    states, times `sums` that of the quadratures.
    """

    pitch: CollocatedPitch
    slice: int
    T: float
    rho: float
    steepness: float
    by_states: Array
    states: Array
    sums: Array

    def by_numbers(self, numbers: RateNumbers) -> float:
        """Return the delay of the border [rad] by a change of the numbers."""
        if not (numbers.P.any() or numbers.TAB.any()):
            return 0.0
        sides = [self.pitch.numbers.plus(by, numbers) for by in (SHIFT, -SHIFT)]
        above, below = (border_temperature(self.pitch, self.T, self.rho, each) for each in sides)
        return (above - below) / (2.0 * SHIFT) / self.steepness


def border_crossings(pitch: CollocatedPitch, angles: Array, states: Array) -> Iterator[Crossing]:
    """Yield where chambers of the last history cross a phase border between angles [rad] of the pitch.

    `states` are those of all chambers there (chambers, angles, …).
    """
    c, life = pitch.machinery.composition, pitch.machinery.trajectory
    if not has_phases(pitch.problem.parts):
        return
    every = life.phases(states.reshape(-1, states.shape[-1])).reshape(states.shape[:2])
    for chamber, phases in enumerate(every):
        start = float(c.P[P_PITCH]) * chamber
        for k in np.flatnonzero(np.diff(phases)).tolist():

            def before(angle: float, start: float = start, phase: int = phases[k]) -> bool:
                return life.phases(life.states_at(np.array([start + angle])))[0] == phase

            _, end = bisected(before, float(angles[k]), float(angles[k + 1]), xtol=PLACE_TOLERANCE)
            yield Crossing(_existing_edge(pitch, chamber, end), CORNER_LAYER, JUMP_WIDTH)


def _existing_edge(pitch: CollocatedPitch, chamber: int, angle: float) -> float:
    """Return the angle [rad] of a border, or the one for which a slice already ends close before it.

    After that end the gas is held in its other phase, whose rates determine the border: it would alternate
    otherwise.
    """
    end = int(np.searchsorted(pitch.mesh.edges, angle)) - 1
    at = float(pitch.mesh.edges[end])
    phases = pitch.rates.held.phases[:, chamber]
    passes = end > 0 and phases[end - 1] != phases[end]
    return at + SHARE_BEFORE * CORNER_LAYER if passes and ENDS[0] < angle - at < ENDS[1] else angle


def borders(pitch: CollocatedPitch, Y: Array) -> list[BorderCrossing]:
    """Return the phase borders that chambers cross, each at the end of a slice."""
    phases = pitch.rates.held.phases
    passed = np.argwhere(np.diff(phases, axis=0)).tolist()
    found = (_border(pitch, Y, k, chamber, phases[k : k + 2]) for k, chamber in passed)
    return [each for each in found if each is not None]


def _border(pitch: CollocatedPitch, Y: Array, k: int, chamber: int, phases: Array) -> BorderCrossing | None:
    """Return the border that a chamber crosses at the end of slice k, with all chambers' phases before and after it.

    None where the border is only touched: there is no derivative.
    """
    y, own = Y[k, -1], [chamber * pitch.n + S_T, chamber * pitch.n + S_RHO]
    before, behind = phases[0], phases[0].copy()
    behind[chamber] = phases[1, chamber]
    (f, g), (f_behind, g_behind) = (pitch.rates.at_start(k + 1, y, each) for each in (before, behind))
    T, rho = y[own].tolist()
    sides = [border_temperature(pitch, T, rho * (1.0 + by), pitch.numbers) for by in (DENSITY_STEP, -DENSITY_STEP)]
    passes = np.array([1.0, (sides[1] - sides[0]) / (2.0 * DENSITY_STEP * rho)])
    steepness = float(passes @ f[own])
    if not steepness * float(passes @ f_behind[own]) > 0.0:
        return None
    by_states = np.zeros(pitch.N)
    by_states[own] = -passes / steepness
    return BorderCrossing(pitch, k, T, rho, steepness, by_states, f - f_behind, (g - g_behind)[: pitch.machinery.nq])


def border_temperature(pitch: CollocatedPitch, T: float, rho: float, numbers: RateNumbers) -> float:
    """Return the temperature [K] of the phase border at ρ [kg/m³], next to T; NaN where none is near."""
    P, TAB, phase = numbers.P, numbers.TAB, pitch.machinery.module.gas_phase
    own, apart = phase(T, rho, P, TAB), NEAREST
    while apart < FARTHEST:
        for end in (T * (1.0 + apart), T * (1.0 - apart)):
            if phase(end, rho, P, TAB) != own:
                return 0.5 * sum(bisected(lambda at: phase(at, rho, P, TAB) == own, T, end, xtol=NARROW * T))
        apart *= 2.0
    return float("nan")
