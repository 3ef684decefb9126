"""Start a cycle from closed ones nearby: neighbouring points of a sweep differ little, and smoothly.

The guess is a polynomial through the last cycles, `DEPTH` at most, over their parameters where these lie on a line;
otherwise the last cycle alone. The degree is the one that predicted the last cycles best: a higher one follows the
trend more closely but amplifies the cycles' errors. The guess changes what a closing costs, and its result by less than
the tolerances.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from screwsim.cycle.linear_pitch import Tangents
from screwsim.cycle.solution import CycleSolution, Expectation, Start
from screwsim.cycle.trend import DEPTH, DegreeRecord, extrapolation_weights
from screwsim.model.composition import Composition
from screwsim.model.run import Machinery
from screwsim.model.slots import P_INJECTION, P_LIFE, P_PITCH
from screwsim.model.turn_scheduler import reach_station
from screwsim.numerics.feedback_unknowns import LEAST

Array = np.ndarray
WELL_CLOSED = 0.2  # share of the bound: a residual below it lets the next cycle start with coarser steps ...
COARSER = 2.0  # ... by this factor
SLOPE = 2.0  # assumed ratio of a cycle's change to its parameters' largest relative change, before any guess was tested


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
        self._degrees = DegreeRecord()
        self._share = 1.0  # factor on a step's tolerance, as the last cycle needed it
        self._last: CycleSolution | None = None
        self._finer: Tangents | None = None  # the linearisation of the last finer life, where one was made ...
        self._finer_of: tuple[str, tuple[float, ...]] | None = None  # ... and of what: text and angles
        self.tightness = 1.0  # factor of the tolerances that the last scenes needed for their accuracy

    def forget(self) -> None:
        """Forget all cycles and what was learnt from them."""
        self._cycles.clear()
        self._degrees = DegreeRecord()
        self._guessed, self._last, self._finer = False, None, None
        self._share = self.tightness = 1.0

    def keep_finer(self, tangents: Tangents | None, c: Composition) -> None:
        """Keep the linearisation of a life that estimated errors for the next estimates; None changes nothing."""
        if tangents is not None:
            self._finer, self._finer_of = tangents._replace(elsewhere=True), (c.text, _angles(c))

    def finer_for(self, c: Composition) -> Tangents | None:
        """Return that linearisation for a composition of the same text and angles; None without one."""
        return self._finer if self._finer_of == (c.text, _angles(c)) else None

    def adopt(self, other: "Course") -> None:
        """Take over what another course has learnt beside its cycles."""
        self.tightness, self._finer, self._finer_of = other.tightness, other._finer, other._finer_of

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
        told = self._degrees.told
        if told:
            self._degrees.compare(_distances(np.array([*told.values()]), values).tolist())
        noted = _ClosedCycle(_angles(c), parameters, life.rows, values)
        self._cycles = [*self._cycles, noted][-DEPTH:]

    def guess(self, machinery: Machinery, parameters: Array) -> tuple[Start, Array] | None:
        """Install a history for these parameters; return the start and the unknowns' next values that go with it.

        None where no cycle is near: one of the same composition with the same pitch, life and injection angle.
        """
        same, here = machinery.composition.text == self._text, _angles(machinery.composition)
        cycles = [cycle for cycle in self._cycles if same and cycle.angles == here]
        self._guessed, self._degrees.told = bool(cycles), {}
        if not cycles:
            return None
        known = np.array([cycle.values for cycle in cycles])
        ways = extrapolation_weights([cycle.parameters for cycle in cycles], parameters)
        reach_station()
        for weights, values in self._degrees.tell(ways, known):
            used = cycles[-len(weights) :]
            machinery.lives.blend([cycle.history for cycle in used], weights)
            signed, ends = machinery.composition.signed, machinery.lives.last()[1][: machinery.lives.last()[3], 1]
            if _are_physical(values[: machinery.n], signed) and _are_physical(ends[:, : machinery.n].T, signed):
                break
        else:
            return None
        n, gap = machinery.n, self._gap
        if gap is None:
            gap = SLOPE * float(_distances(cycles[-1].parameters, parameters))
        contraction, tangents = (1.0, None) if self._last is None else (self._last.contraction, self._last.tangents)
        expected = Expectation((float(values[n]), float(values[n + 1])), gap, self._share, contraction)
        if tangents is not None:
            tangents = tangents._replace(elsewhere=True) if cycles[-1] is self._cycles[-1] else None
        return Start(values[:n], expected, tangents), values[n + 2 :]


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
