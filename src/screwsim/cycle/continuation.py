"""Start a cycle from closed ones nearby: neighbouring points of a sweep differ little, and smoothly.

The guess is a polynomial through the last cycles, `DEPTH` at most, over their parameters where these lie on a line;
otherwise the last cycle alone. The degree is the one that predicted the last cycles best: a higher one follows the
trend more closely but amplifies the cycles' errors. The guess changes what a closing costs, and its result by less than
the tolerances.
"""

from collections.abc import Sequence
from math import prod
from typing import NamedTuple

import numpy as np

from screwsim.cycle.solution import CycleSolution, Expectation, Start
from screwsim.model.composition import Composition
from screwsim.model.run import Machinery
from screwsim.model.slots import P_INJECTION, P_LIFE, P_PITCH
from screwsim.model.turn_scheduler import reach_station
from screwsim.numerics.feedback_unknowns import LEAST

Array = np.ndarray
DEPTH = 3  # most cycles in a guess
LINE_TOLERANCE = 0.1  # distance from the line of the steps before, as a share of a step, that still counts as on it
LARGEST_WEIGHT = 8.0  # largest weight of a polynomial; beyond it the cycles' errors prevail over their trend
WELL_CLOSED = 0.2  # share of the bound: a residual below it lets the next cycle start with coarser steps ...
COARSER = 2.0  # ... by this factor
LAST_ALONE = np.ones(1)  # weights for the last cycle alone
SLOPE = 2.0  # assumed ratio of a cycle's change to its parameters' largest relative change, before any guess was tested


class Guess(NamedTuple):
    """What closing starts with, and the values that the cycle determines."""

    start: Start
    unknowns_out: Array


class _ClosedCycle(NamedTuple):
    """A closed cycle as the course keeps it."""

    angles: tuple[float, ...]  # pitch, life, injection
    parameters: Array
    history: tuple[Array, Array, int]
    values: Array  # state at 0°, trapped mass, work, the cycle's unknowns


class Course:
    """The last closed cycles of one composition, from which the next is guessed."""

    def __init__(self) -> None:
        self._text = ""
        self._cycles: list[_ClosedCycle] = []
        self._gap: float | None = None  # error of the last guess; None where the last cycle was not guessed
        self._guessed = False
        self._told: dict[int, Array] = {}  # each polynomial's prediction of the next cycle, by its number of cycles
        self._missed: dict[int, float] = {}  # recent error of each
        self._share = 1.0  # factor on a step's tolerance, as the last cycle needed it
        self._last: CycleSolution | None = None
        self.tightness = 1.0  # factor of the tolerances that the last scenes needed for their accuracy

    def forget(self) -> None:
        """Forget all cycles and what was learnt from them."""
        self._cycles.clear()
        self._told, self._missed = {}, {}
        self._guessed, self._last = False, None
        self._share = self.tightness = 1.0

    def add(self, cycle: CycleSolution, parameters: Array, unknowns_out: Array, share: float, tightness: float) -> None:
        """Record a closed cycle with its parameters, its `unknowns_out` and the factor on its tolerances.

        `share` is the factor on the wanted tolerance of a step with which its balances closed (`cycle.ways`).
        """
        life, c = cycle.trajectory, cycle.trajectory.composition
        self.tightness = tightness
        if c.text != self._text:
            if self._text:
                self.forget()
            self._text = c.text
        self._last = cycle
        values = np.concatenate([cycle.y[: len(c.states)], cycle.seen, unknowns_out])
        self._gap = cycle.first_gap if self._guessed else None
        self._share = min(1.0, COARSER * share if cycle.residual < WELL_CLOSED else share)
        if self._told:
            off = _distances(np.array([*self._told.values()]), values)
            for cycles, missed in zip(self._told, off.tolist(), strict=True):
                self._missed[cycles] = 0.5 * (self._missed.get(cycles, missed) + missed)
        noted = _ClosedCycle(_angles(c), parameters, life.rows, values)
        self._cycles = [*self._cycles, noted][-DEPTH:]

    def guess(self, machinery: Machinery, parameters: Array) -> Guess | None:
        """Install a history for these parameters and return the guess that goes with it; None where no cycle is near.

        Near are cycles of the same composition with the same pitch, life and injection angle.
        """
        same, here = machinery.composition.text == self._text, _angles(machinery.composition)
        cycles = [cycle for cycle in self._cycles if same and cycle.angles == here]
        self._guessed, self._told = bool(cycles), {}
        if not cycles:
            return None
        known = np.array([cycle.values for cycle in cycles])
        ways = _weights([cycle.parameters for cycle in cycles], parameters)
        reach_station()
        self._told = {len(weights): weights @ known[-len(weights) :] for weights in ways}
        for weights in sorted(ways, key=lambda weights: self._missed.get(len(weights), 0.0)):
            used, values = cycles[-len(weights) :], self._told[len(weights)]
            machinery.blend([cycle.history for cycle in used], weights)
            signed, ends = machinery.composition.signed, machinery.last()[1][: machinery.last()[3], 1]
            if _are_physical(values[: machinery.n], signed) and _are_physical(ends[:, : machinery.n].T, signed):
                break
        else:
            return None
        n = machinery.n
        gap = self._gap
        if gap is None:
            gap = SLOPE * float(_distances(cycles[-1].parameters, parameters))
        contraction, tangents = (1.0, None) if self._last is None else (self._last.contraction, self._last.tangents)
        expected = Expectation((float(values[n]), float(values[n + 1])), gap, self._share, contraction)
        if tangents is not None:
            tangents = tangents._replace(elsewhere=True) if cycles[-1] is self._cycles[-1] else None
        return Guess(Start(values[:n], expected, tangents), values[n + 2 :])


def _angles(c: Composition) -> tuple[float, ...]:
    """Return pitch, life and injection angle [rad]."""
    return float(c.P[P_PITCH]), float(c.P[P_LIFE]), float(c.P[P_INJECTION])


def _are_physical(states: Array, signed: Sequence[int]) -> bool:
    """Return whether temperature and density are positive and no other state is negative; one row for each state.

    `signed` are the rows of states that may be negative.
    """
    least = np.minimum.reduce(states, axis=-1).tolist() if states.ndim > 1 else states.tolist()  # NaN fails too
    if not (least[0] > 0.0 and least[1] > 0.0):
        return False
    return all(least[row] >= 0.0 for row in range(2, len(least)) if row not in signed)


def _distances(a: Array, b: Array) -> Array:
    """Return the largest relative difference of each row of a from a vector."""
    sizes = np.maximum(np.maximum(np.abs(a), np.abs(b)), LEAST)
    return np.maximum.reduce(np.abs(a - b) / sizes, axis=-1)


def _weights(known: list[Array], wanted: Array) -> list[Array]:
    """Return weights of polynomials that extrapolate to the wanted parameters; the last is the last cycle alone."""
    last = LAST_ALONE
    if len(known) < 2:
        return [last]
    every = np.array([*known, wanted])
    moved = np.logical_or.reduce(every[:-1] != wanted)
    along, squares = [0.0] * len(every), [0.0] * len(every)
    for column in every[:, moved].T.tolist():  # a few numbers: faster without numpy
        scale, before, start = max(map(abs, column)), column[-3], column[-2]
        line = (start - before) / scale  # from the last but one to the last
        for i, x in enumerate(column):
            way = (x - start) / scale
            along[i] += way * line
            squares[i] += way * way
    length = squares[-3]
    if length == 0.0:
        return [last]
    places = []
    for product, square in zip(along, squares, strict=True):
        place = product / length
        places.append(place if square - place * place * length <= LINE_TOLERANCE**2 * square else None)
    if places[-1] is None:
        return [last]
    return [*_polynomials(places), last]


def _polynomials(places: list[float | None]) -> list[Array]:
    """Return Lagrange's weights at the last place, of each degree whose weights are at most `LARGEST_WEIGHT`."""
    *known, x = places
    assert x is not None
    tame = []
    for first in range(len(known) - 1):
        nodes = [place for place in known[first:] if place is not None]
        if len(nodes) < len(known) - first or len(set(nodes)) < len(nodes):
            continue
        weights = [prod([(x - b) / (a - b) for b in nodes if b != a]) for a in nodes]
        if max(map(abs, weights)) <= LARGEST_WEIGHT:
            tame.append(np.array(weights))
    return tame
