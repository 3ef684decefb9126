"""Newton's method from afar: seek a cycle where iterating pitches diverges or hardly converges.

A steady cycle that is unstable under the machine's own course (docs/explanation/closing.md, cycles that are not there
to be found) is still a zero of the change over a pitch, F(x) = Φ(x) − x, in the coordinates of closing. Derivatives are
those of the linearised pitch (`tangents`), renewed at every step. A step is shortened until the simplified Newton step
after it, by the same derivatives, is shorter than it.

Source: P. Deuflhard, Newton Methods for Nonlinear Problems, Springer 2004, section 3.3 (natural monotonicity test).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from screwsim.cycle.coordinates import logarithms, states_of
from screwsim.cycle.feedback import next_pitch, set_unknowns, unknowns
from screwsim.cycle.linear_pitch import shifted
from screwsim.cycle.mixing import MixingRule
from screwsim.cycle.problem import ClosingTask, Problem
from screwsim.cycle.simultaneous import close_together
from screwsim.cycle.solution import CycleSolution
from screwsim.cycle.tangents import linearised, slopes_of_image
from screwsim.numerics.rodas import EVALUATED
from screwsim.outputs.variables import NOT_CLOSED

Array = np.ndarray
FALLBACK_NAME = "Newton's method from afar"
LARGEST_RTOL = 1e-5  # largest tolerance of an integration step
SLICES = 48  # of a linearised pitch: far from the cycle a coarse linearisation misleads
FOUND_WITHIN = 0.1  # tolerances: change over a pitch at which the cycle counts as found
LONGEST_STEP = 1.0  # step, in coordinates
LEAST_SHARE = 0.01  # smallest share of a Newton step; where even that is too long the search has failed
SINGULAR = 1e-12  # singular value over the largest, below which its direction is left out
MOST_OF_A_SEARCH = 2_000_000  # evaluations of one chamber's rates in one search ...
MOST_OF_AN_EARLY_ONE = 700_000  # ... while other fallbacks are still to come ...
MOST_STEPS = 60  # ... and steps: successful searches took 42 at most
MOST_TO_VERIFY = 1_000_000  # evaluations for closing by pitches what was found
MOST_BETWEEN = 300_000  # evaluations of damped pitches between two searches
PITCHES_BETWEEN = 400  # and pitches at most


def search_applies(problem: Problem) -> bool:
    """Return whether a search may find a cycle: not with one chamber, nor, as far as tried, with pulsating lines."""
    return problem.composition.chambers > 1 and not problem.composition.pulsating


def search_after_pitches(
    task: ClosingTask, y: Array, rule: MixingRule, most: int, early: bool = False
) -> CycleSolution:
    """Return the cycle found from the states y by alternating damped pitches and searches.

    `most` bounds all evaluations together; `early` searches have a smaller bound each. `needed` is set where a
    search found the cycle and empty where damped pitches closed it. Where neither did, the cycle is the last one
    that damped pitches left, with its unknowns.
    """
    problem, machinery, _ = task
    budget = int(machinery.counts[EVALUATED]) + most
    while True:
        cycle = close_together(task, y, rule, MOST_BETWEEN, PITCHES_BETWEEN)
        if cycle.status != NOT_CLOSED or machinery.counts[EVALUATED] > budget:
            return cycle
        y, unknowns_in = cycle.y, unknowns(problem, machinery)
        found = search_and_close(task, y.copy(), MOST_OF_AN_EARLY_ONE if early else MOST_OF_A_SEARCH)
        if found is not None:
            return found
        set_unknowns(problem, machinery, unknowns_in)


def search_and_close(
    task: ClosingTask, y: Array, most: int = MOST_OF_A_SEARCH, judged: bool = True
) -> CycleSolution | None:
    """Return the cycle that a search from the states y finds, then closed by pitches like any other; None if none.

    With `judged`, its `growth` says whether pitches converge to it.
    """
    zero = newton_search(task, y, most, judged)
    if zero is None:
        return None
    y, growth = zero
    fine = replace(task.criteria, rtol=min(task.criteria.rtol, LARGEST_RTOL))
    cycle = close_together(task._replace(criteria=fine), y, most=MOST_TO_VERIFY)
    return replace(cycle, needed=FALLBACK_NAME, growth=growth) if cycle.closed else None


def with_growth(task: ClosingTask, cycle: CycleSolution) -> CycleSolution:
    """Return a cycle with its `growth`, if it closed and searches are possible; it is the last history again."""
    if not cycle.closed or not search_applies(task.problem):
        return cycle
    pitch = _PitchMap(task)
    here = pitch.first(cycle.y.copy())
    growth = 0.0 if here is None else pitch.growth(here)
    task.machinery.put(cycle.trajectory)
    return replace(cycle, growth=growth)


def newton_search(
    task: ClosingTask, y: Array, most: int = MOST_OF_A_SEARCH, judged: bool = False
) -> tuple[Array, float] | None:
    """Return the zero that Newton's method finds from the states y, with its unknowns set; None if it finds none.

    It is the states of all chambers that a pitch hardly changes, and the growth of a small change over a pitch: the
    largest absolute eigenvalue of the linearised pitch, in the coordinates of closing. Above 1 pitches diverge from the
    cycle. It is 0 where it is not `judged`.
    """
    pitch, (problem, machinery, criteria) = _PitchMap(task), task
    budget = int(machinery.counts[EVALUATED]) + most
    here, share = pitch.first(y), 1.0
    before: tuple[Array, Array] | None = None  # the last step, and the simplified step after it
    for _ in range(MOST_STEPS + 1):
        if here is None or machinery.counts[EVALUATED] >= budget:
            return None
        if float(np.abs(here.changed).max()) <= FOUND_WITHIN * criteria.tolerance:
            growth = pitch.growth(here) if judged else 0.0
            found, unknowns_in = pitch.values(here.x, here.raw)
            set_unknowns(problem, machinery, unknowns_in)
            return found, growth
        inverse = pitch.inverse(here)
        if inverse is None:
            return None
        step = -inverse @ here.changed
        if before is not None:
            share *= _length(before[0]) * _length(before[1]) / max(_length(before[1] - step) * _length(step), 1e-300)
        share = min(max(share, LEAST_SHARE), LONGEST_STEP / max(float(np.abs(step).max()), LONGEST_STEP))
        here, share, rest = _shortened_step(pitch, here, step, inverse, share, budget)
        before = step, rest
    return None


def _shortened_step(
    pitch: _PitchMap, here: SearchPoint, step: Array, inverse: Array, share: float, budget: int
) -> tuple[SearchPoint | None, float, Array]:
    """Return the point after a shortened step, its share and the simplified step there; the point may be None.

    The share is reduced until the simplified step is shorter than the step; None where that would take too small a
    share.
    """
    rest, length, least = step, _length(step), min(LEAST_SHARE, share)
    while share >= least and pitch.machinery.counts[EVALUATED] < budget:
        there = pitch.at(here.x + share * step, here.raw)
        if there is None:
            share *= 0.5
            continue
        rest = -inverse @ there.changed
        if _length(rest) < length:
            return there, share, rest
        share = min(0.5 * share, 0.5 * length * share * share / max(_length(rest - (1.0 - share) * step), 1e-300))
    return None, share, rest


def _length(step: Array) -> float:
    """Return the Euclidean length of a step."""
    return float(np.linalg.norm(step))


@dataclass(frozen=True, eq=False)
class SearchPoint:
    """A point in coordinates, the change of a pitch there, the states and unknowns after it, and its quadratures q."""

    x: Array
    changed: Array
    raw: tuple[Array, Array]
    q: Array


class _PitchMap:
    """The map of a pitch in coordinates of states and unknowns, and its derivatives."""

    def __init__(self, task: ClosingTask) -> None:
        self.problem, self.machinery, criteria = task
        self.rtol, self.check = min(criteria.rtol, LARGEST_RTOL), criteria.check
        self.c = self.machinery.composition
        self.machinery.set_widths(criteria.widths)

    def first(self, y: Array) -> SearchPoint | None:
        """Return the point of the states y and the unknowns as they are set."""
        raw = y, unknowns(self.problem, self.machinery)
        return self.at(self._coordinates(*raw), raw)

    def _coordinates(self, y: Array, unknowns_in: Array) -> Array:
        """Return the coordinates of states and unknowns."""
        return np.concatenate([logarithms(y, self.c), self.problem.entries.coordinates(unknowns_in)])

    def values(self, x: Array, raw: tuple[Array, Array]) -> tuple[Array, Array]:
        """Return states and unknowns at x; amounts too small to count keep their raw values."""
        n = len(raw[0])
        return states_of(x[:n], raw[0], self.c), self.problem.entries.values(x[n:], raw[1])

    def at(self, x: Array, raw: tuple[Array, Array]) -> SearchPoint | None:
        """Integrate a pitch from x and return its point, None where it stops; the pitch becomes the last history."""
        found = next_pitch(self.problem, self.machinery, *self.values(x, raw), self.rtol, self.check)
        if found is None:
            return None
        y, unknowns_out, q = found
        changed = self._coordinates(y, unknowns_out) - x
        return SearchPoint(x, changed, (y, unknowns_out), q) if np.isfinite(changed).all() else None

    def inverse(self, here: SearchPoint) -> Array | None:
        """Return the pseudo-inverse of the change's derivatives at the last pitch's start; None if not finite."""
        try:
            J = self._derivatives(here)
            return np.linalg.pinv(J, rcond=SINGULAR) if np.isfinite(J).all() else None
        except np.linalg.LinAlgError:
            return None

    def growth(self, here: SearchPoint) -> float:
        """Return the largest absolute eigenvalue of the pitch's map at the start of the last pitch."""
        J = self._derivatives(here)
        return float(np.abs(np.linalg.eigvals(J + np.eye(len(J)))).max()) if np.isfinite(J).all() else math.inf

    def _derivatives(self, here: SearchPoint) -> Array:
        """Return the derivatives of the change over a pitch by the coordinates of states and unknowns."""
        problem, machinery = self.problem, self.machinery
        y, unknowns_in = self.values(here.x, here.raw)
        tangents = linearised(problem, machinery, unknowns_in, SLICES)
        N, size = len(y), len(here.x)
        start, sources = np.eye(N, size), np.zeros((SLICES, N, size))
        sources[:, :, N:] = tangents.by_unknowns
        along = tangents.along(start, sources)
        given = tangents.sums_along(along, sources)
        given[:, :, N:] += tangents.sums_by_unknowns
        J = np.empty((size, size))
        J[:N] = shifted(along[-1], self.c.chambers)
        J[N:] = slopes_of_image(problem, machinery, tangents, given, here.q, unknowns_in, here.raw[1])
        return J - np.eye(size)
