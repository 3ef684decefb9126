"""All chambers over one pitch, linearised along a history: what small changes make of themselves.

A change δ of the states' coordinates, of all chambers alive (chamber by chamber), follows δ' = A δ + B r + F u: A are
the derivatives of the rates by the states, B its part by the chambers ahead, r a change of these alone, u a change of
the feedback unknowns. A, B, F are taken in the middles of a few slices and held there; over a slice z = h A goes by
(1 − z + z²/2)⁻¹, of order 2 and damped where stiff, with the sums that belong to it. That is nearly right, as Newton's
matrix has to be; the equations themselves stay those of the integrator. Derivatives by the states are those that it
steps with, those by the unknowns differences of the rates.

Source: docs/explanation/numerics.md, Newton's correction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from screwsim.cycle.coordinates import logarithms
from screwsim.cycle.feedback import set_unknowns
from screwsim.cycle.linear_pitch import Tangents, shifted
from screwsim.cycle.problem import LEAST_OIL, Problem
from screwsim.model import compiled
from screwsim.model.composition import Composition
from screwsim.model.run import Machinery
from screwsim.model.slots import P_INJECTION, P_PITCH

Array = np.ndarray
SLICES = 12  # of a pitch
EVEN = 0.2  # share of an even division in theirs; the rest is as dense as the integrator's steps
LEAST = 1e-6  # of a pitch: steps that end so near to its ends are not counted
INSIDE = 1e-6  # rad within the segment of the laws that an angle belongs to, as the middle of its segment
RELAXED = 3  # steps that lead the states in the middle of a slice to where they change as the history does ...
STRAYED = 0.02  # ... while T or ρ would change by so much more, or less, of itself over the slice ...
AT_MOST = 0.1  # ... of at most so much each
SHIFT = 1e-5  # of a coordinate, for differences
ANGLE_STEP = 1e-7  # rad, for derivatives by the angle, which nothing here uses


def edges_of(machinery: Machinery) -> Array:
    """Return the edges [rad] of the slices of a pitch: as dense as the steps of the last history, of all chambers."""
    c, (times, _, _, steps) = machinery.composition, machinery.last()
    pitch = float(c.P[P_PITCH])
    ends = np.sort(np.mod(times[1:steps], pitch))
    ends = np.concatenate([[0.0], ends[(ends > LEAST * pitch) & (ends < (1.0 - LEAST) * pitch)], [pitch]])
    places = np.linspace(0.0, len(ends) - 1.0, SLICES + 1)
    even = np.linspace(0.0, pitch, SLICES + 1)
    return (1.0 - EVEN) * np.interp(places, np.arange(len(ends)), ends) + EVEN * even


def angles_of(angles: Array, c: Composition) -> Array:
    """Return angles of a pitch [rad] in all chambers' lives, chamber by chamber."""
    return (float(c.P[P_PITCH]) * np.arange(c.chambers)[:, None] + angles).ravel()


def linearised(problem: Problem, machinery: Machinery, met: Array) -> Tangents:
    """Return the pitch linearised along the last history, with unknowns as they are met."""
    c, n = machinery.composition, machinery.n
    edges = edges_of(machinery)
    middles, h = 0.5 * (edges[:-1] + edges[1:]), np.diff(edges)[:, None, None]
    N = n * c.chambers
    y = machinery.states_at(angles_of(middles, c)).reshape(c.chambers, SLICES, n).transpose(1, 0, 2)
    slices = _Slices(middles, h[:, 0, 0], y.reshape(SLICES, N), _changes(machinery, edges))
    A, F, sums, sums_by_unknowns = _slopes(problem, machinery, met, slices)
    z, one = h * A, np.eye(N)
    step = np.linalg.inv(one - z + 0.5 * z @ z)
    gain, twice = (one - 0.5 * z) @ step, 0.5 * (one - z) @ step
    chamber = np.arange(N) // n
    ahead = np.where(chamber > chamber[:, None], z, 0.0)
    through = enter = _injected(machinery)
    for each in step:
        through = each @ through
    around = np.linalg.inv(one - shifted(through, c.chambers))
    of_sums = h * sums @ gain, h * sums @ twice, h * sums_by_unknowns
    return Tangents(edges, enter, step, gain, ahead, h * F, *of_sums, around)


class _Slices(NamedTuple):
    """Middles and widths [rad] of slices, the states there, and by how much their coordinates change over each."""

    middles: Array
    widths: Array
    states: Array
    changes: Array


def _changes(machinery: Machinery, edges: Array) -> Array:
    """Return by how much the coordinates of all chambers change over each slice (slices, N) along the last history."""
    c, n = machinery.composition, machinery.n
    ends = np.concatenate([edges[:-1] + INSIDE, edges[1:] - INSIDE])
    at = logarithms(machinery.states_at(angles_of(ends, c)), c).reshape(c.chambers, 2, SLICES, n)
    return (at[:, 1] - at[:, 0]).transpose(1, 0, 2).reshape(SLICES, -1)


def _slopes(problem: Problem, machinery: Machinery, met: Array, slices: _Slices) -> tuple[Array, Array, Array, Array]:
    """Return derivatives of the coordinates' rates by them and by the unknowns, then those of the quadratures' rates.

    One entry a slice each, in its middle.
    """
    c, nq, N = machinery.composition, machinery.nq, slices.states.shape[1]
    A, F = np.empty((SLICES, N, N)), np.empty((SLICES, N, len(met)))
    sums, sums_by_unknowns = np.empty((SLICES, nq, N)), np.empty((SLICES, nq, len(met)))
    moved, R, P = _moved(problem, machinery, met), machinery.R, c.P
    R_met, P_met = R.copy(), P.copy()
    rates = _Rates(machinery, float(slices.middles[0]), slices.states[0])
    for k, (phi, h, y, change) in enumerate(zip(*slices, strict=True)):
        y, f, A[k], Jq, scale = _led(rates, c, (phi, h), y, change)
        sums[k] = Jq[:nq] * scale
        for j, (R_moved, P_moved) in enumerate(moved):
            R[:], P[:] = R_moved, P_moved
            shifted_rates = (rates.rates(phi, y) - f) / SHIFT
            F[k, :, j], sums_by_unknowns[k, :, j] = shifted_rates[:N] / scale, shifted_rates[N : N + nq]
        R[:], P[:] = R_met, P_met
    machinery.counts[2:] += c.chambers * SLICES * len(met), c.chambers * rates.asked
    return A, F, sums, sums_by_unknowns


def _led(
    rates: _Rates, c: Composition, slice_of: tuple[float, float], y: Array, change: Array
) -> tuple[Array, Array, Array, Array, Array]:
    """Return states of all chambers in the middle of a slice (angle, width [rad]); rates, derivatives and scales there.

    A chamber that is open to a line follows its pressure within a few pascals, by which gas flows in or out, and the
    history between the ends of steps is off by as many. So the states are led from there to where they change as the
    history does over the slice.
    """
    (phi, h), N, n = slice_of, len(y), len(c.states)
    logarithmic = np.tile(~np.isin(np.arange(n), c.signed), c.chambers)
    left = RELAXED
    while True:
        f, J, Jq = rates.with_derivatives(phi, y)
        scale = np.where(logarithmic, np.maximum(np.abs(y), 1e-300), 1.0)
        slope, little = f[:N] / scale, _little(y, c)
        A = J * (scale / scale[:, None])
        A.flat[:: N + 1] -= np.where(logarithmic, slope, 0.0)
        A[little] = 0.0
        off = h * slope - change
        if left == 0 or not np.abs(off.reshape(-1, n)[:, :2]).max() > STRAYED:
            return y, f, A, Jq, scale
        off[little] = 0.0
        move = np.clip(np.linalg.solve(np.eye(N) - h * A, off), -AT_MOST, AT_MOST)
        y = np.where(logarithmic, y * np.exp(move), y + move)
        left -= 1


def _little(y: Array, c: Composition) -> Array:
    """Tell which coordinates are those of oil of no account, which does not change."""
    rows = np.zeros((c.chambers, len(y) // c.chambers), bool)
    if c.carried:
        rows[:, 2:4] = y.reshape(rows.shape)[:, 3:4] <= LEAST_OIL
    return rows.ravel()


def _moved(problem: Problem, machinery: Machinery, met: Array) -> list[tuple[Array, Array]]:
    """Return (R, P) with each unknown shifted; the machinery is left with them as they are met."""
    entries, found = problem.entries, []
    here = entries.coordinates(met)
    for j in range(len(met)):
        there = here.copy()
        there[j] += SHIFT
        set_unknowns(problem, machinery, entries.values(there, met))
        found.append((machinery.R.copy(), machinery.composition.P.copy()))
    set_unknowns(problem, machinery, met)
    return found


class _Rates:
    """Rates of states and quadratures of all chambers, and their derivatives, at one angle after the other."""

    def __init__(self, machinery: Machinery, phi: float, y: Array) -> None:
        c = machinery.composition
        N, nq = c.chambers * machinery.n, machinery.nq + 1
        self.module, self.context, self.asked = machinery.together, machinery.coupled_context, 0
        self.E, self.E_next = np.zeros(c.n_E_all), np.zeros(c.n_E_all)
        self.f, self.g, self.J, self.Jq = np.empty(N), np.empty(nq), np.empty((N, N)), np.empty((nq, N))
        self.f_phi, self.g_phi = np.empty(N), np.empty(nq)
        if "tangents" not in compiled.warm(self.module):
            with machinery.compiling("tangents"):
                self.with_derivatives(phi, y)
                self.rates(phi, y)
            self.asked = 0

    def with_derivatives(self, phi: float, y: Array) -> tuple[Array, Array, Array]:
        """Return rates (states, then quadratures) and the derivatives of both by the states; the last are not kept."""
        around, self.asked = self.module.surroundings__around_chambers, self.asked + 1
        around(phi, phi - INSIDE, self.context, self.E)
        around(phi + ANGLE_STEP, phi - INSIDE, self.context, self.E_next)
        self.module.chambers__jacobian(
            *(y, self.E, self.E_next, ANGLE_STEP, self.context),
            *(self.f, self.g, self.J, self.Jq, self.f_phi, self.g_phi),
        )
        return np.concatenate([self.f, self.g]), self.J, self.Jq

    def rates(self, phi: float, y: Array) -> Array:
        """Return rates of states, then quadratures."""
        self.module.surroundings__around_chambers(phi, phi - INSIDE, self.context, self.E)
        self.module.chambers__rates(y, self.E, self.context, self.f, self.g)
        return np.concatenate([self.f, self.g])


def _injected(machinery: Machinery) -> Array:
    """Return the derivatives of the coordinates after the injection of oil by those before it, of all chambers."""
    c, n = machinery.composition, machinery.n
    found = np.eye(c.chambers * n)
    index = round(c.P[P_INJECTION] / c.P[P_PITCH])
    if not 0 < index < c.chambers:
        return found
    at, R = slice(index * n, index * n + n), machinery.R.copy()
    before = machinery.states_at(np.array([index * float(c.P[P_PITCH]) - INSIDE]))[0]
    y, signed = np.ones(c.chambers * n), list(c.signed)

    def after(coordinates: Array) -> Array:
        y[at] = np.exp(coordinates)
        y[at][signed] = coordinates[signed]
        machinery.inject(y)
        machinery.R[:] = R
        return logarithms(y[at].copy(), c)

    here = np.log(np.maximum(before, LEAST_OIL * LEAST_OIL))
    here[signed] = before[signed]
    base = after(here)
    for i in range(n):
        there = here.copy()
        there[i] += SHIFT
        found[at, index * n + i] = (after(there) - base) / SHIFT
    return found
