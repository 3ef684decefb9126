"""Collocate a closed cycle: place the slices of its mesh, and close it on them, from the cycle that was integrated."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from screwsim.cycle.problem import Problem
from screwsim.derivatives import mesh, newton, radau
from screwsim.derivatives.chamber_newton import ChamberFactors, approach
from screwsim.derivatives.collocated_cycle import CollocatedCycle, NotClosed, Placed
from screwsim.derivatives.crossings import crossings
from screwsim.derivatives.events import Course, course_of
from screwsim.derivatives.line_flows import line_inflow
from screwsim.derivatives.linear import LinearisedPitch, Response
from screwsim.derivatives.peak import peak
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.rate_numbers import SMALL, RateNumbers
from screwsim.derivatives.unknowns import unknowns_of
from screwsim.model.parts import Parts
from screwsim.model.run import Machinery
from screwsim.model.slots import P_PITCH
from screwsim.model.trajectory import Trajectory

Array = np.ndarray
STEPS = (4.0, 2.0, 1.0)  # integrator's steps per slice at the start; fewer where more do not close
ERROR = 0.03  # of the wanted accuracy: error of a slice
OF_TURN = 0.03  # factor on that where there is a single chamber, whose slices cost little
FINE_TURN = 1e-6  # tolerance of a step in the turns after its closed one that tell the events of its valves ...
FINE_TURNS = 2  # ... which are so many, as a closed cycle is open by its tolerance
MOST_EVENTS = 300  # of a turn: each is an unknown
ROUNDS = 9  # of refinement ...
LAST_ROUNDS = 3  # ... in the last of which the cycle is closed whatever the errors of slices
CLOSED = 1e-7  # relative residual of a closed cycle ...
NEARLY_CLOSED = 1e-4  # ... and one that is enough to place slices, where `chamber_newton` finds no states
STATES_SHARE = 0.1  # of a slice's error: residual of the states with which that error is estimated ...
FIRST_ROUND_FACTOR = 100.0  # ... and in the first round, whose slices are much too long
VANISHED_WITHIN = 20.0  # layers around a crossing, within which it may be one of the round before
PLACED = 0.5  # of `Crossing.share`: layers between a crossing and its slice's end, within which it counts as placed


class Fineness(NamedTuple):
    """The wanted accuracy of derivatives, as factors on the constants above and on those of `slices`.

    They apply to the error of a slice, `divided`: the factor on it up to which a divided slice is not checked
    again; the residual of the cycle; the slices around a turning of a flow, the first and the ratio from each to
    the next; the longest slice; and how near to its turning a slice must end. If not `estimated`, the cycle is the
    first that the scene's tolerances close, whatever the error of its figures.
    """

    error: float = 1.0
    divided: float = 1.0
    closed: float = 1.0
    ring: float = 1.0
    wider: float = 1.0
    longest: float = 1.0
    near: float = 1.0
    estimated: bool = True


FINE = Fineness(error=0.1, ring=0.5, wider=0.7)  # errors of 1e-5 of a derivative, in 95 of 100
QUICK = Fineness(
    error=10.0, divided=20.0, closed=10.0, ring=2.0, wider=1.6, longest=1.5, near=50.0, estimated=False
)  # errors of 1e-3


def collocated(problem: Problem, machinery: Machinery, life: Trajectory, fineness: Fineness = FINE) -> CollocatedCycle:
    """Return the collocated cycle of a closed life; raise NotClosed where none is found."""
    c = machinery.composition
    machinery.composition = replace(c, TAB=c.TAB.copy())  # a writable copy
    life, why = fine_turn(machinery, life) if machinery.alone else life, NotClosed()
    for steps in STEPS:
        try:
            machinery.put(life)
            seams, course = _seams(machinery, problem.parts)
            edges = mesh.edges_of(machinery, seams, steps, fineness.longest * mesh.LONGEST)
            return _Collocation(problem, machinery, fineness, seams, course).closed(Placed(edges, []), good=False)
        except (NotClosed, np.linalg.LinAlgError) as error:
            why = NotClosed(str(error))
    raise why


def collocated_nearby(
    cycle: CollocatedCycle, problem: Problem, numbers: RateNumbers, moves: Response, fineness: Fineness
) -> CollocatedCycle:
    """Return the collocated cycle of a problem nearby, from the numbers and the response that lead there.

    Its slices are those of the first one, but for those around crossings. Raises NotClosed where none is found so.
    """
    pitch = cycle.pitch
    assert cycle.placed is not None  # it is known of a finished one
    if pitch.alone:
        raise NotClosed("the events of a turn may be others")
    pitch.put(numbers)
    pitch.install_shifted(cycle.start, cycle.nodes, 1.0, moves)
    seams, course = _seams(pitch.machinery, problem.parts)
    return _Collocation(problem, pitch.machinery, fineness, seams, course).closed(cycle.placed, good=True)


def fine_turn(machinery: Machinery, life: Trajectory) -> Trajectory:
    """Return a turn of a single chamber after a closed one, integrated finely: its events are those of the cycle."""
    machinery.put(life)
    y = life.dense[0, 0, : machinery.n].copy()
    for _ in range(FINE_TURNS):
        status, *_ = machinery.turn(y, FINE_TURN, float(life.times[1] - life.times[0]))
        if status:
            raise NotClosed("a finely integrated turn fails")
        machinery.lives.swap()
    return machinery.trajectory.copy()


def _seams(machinery: Machinery, parts: Parts) -> tuple[Array, Course]:
    """Return where slices of the last history must end [rad], and its events; raise NotClosed where these forbid it."""
    course = course_of(machinery.trajectory)
    if len(course.events) > MOST_EVENTS:
        raise NotClosed(f"valves meet seat and stop, or leave them, {len(course.events)} times in a turn")
    if not course.returns:
        raise NotClosed("a valve rests at one end of the turn and moves at the other")
    seams = np.sort(np.concatenate([mesh.fixed_edges(machinery, parts), course.angles]))
    if len(course.events) and np.diff(seams).min() <= mesh.LEAST:
        raise NotClosed("a valve meets its seat or stop, or leaves it, at the angle of another event")
    return seams, course


class _Collocation:
    """Rounds of placing slices and solving for the states on them, until both settle."""

    def __init__(
        self, problem: Problem, machinery: Machinery, fineness: Fineness, seams: Array, course: Course
    ) -> None:
        self.problem, self.machinery, self.fineness = problem, machinery, fineness
        self.seams, self.course = seams, course
        of_turn = OF_TURN if machinery.alone else 1.0
        self.tolerance = fineness.error * ERROR * problem.scene.numerics.accuracy * of_turn  # on the error of a slice
        self.factors = ChamberFactors()
        self.linear: LinearisedPitch | None = None  # the last one

    def closed(self, placed: Placed, *, good: bool) -> CollocatedCycle:
        """Return the closed cycle on slices that begin as `placed`; `good` ones are fine enough already."""
        plain, before = placed
        turns, closing = _with_vanished(crossings(self._pitch(plain)), before), good
        left = ROUNDS
        while True:
            pitch = self._pitch(self._with_rings(plain, turns))
            start, Y = self._solved(pitch, closing, FIRST_ROUND_FACTOR if left == ROUNDS else STATES_SHARE)
            plain = self._carried(pitch, plain)
            before, turns = turns, _with_vanished(crossings(pitch), turns)
            if closing and (left == 1 or (good and _slices_still_fit(turns, before, self.fineness.near * PLACED))):
                return self._cycle(pitch, Y, Placed(plain, turns))
            if not good:
                plain, good = self._refined(pitch, start, Y, plain)
            closing = good or left <= LAST_ROUNDS
            left -= 1

    def _cycle(self, pitch: CollocatedPitch, Y: Array, placed: Placed) -> CollocatedCycle:
        """Return the cycle that closed with states at the nodes; raise NotClosed where its events are not theirs."""
        if missed := pitch.events.missed(Y, pitch.mesh, pitch.numbers):
            raise NotClosed(missed)
        slopes = pitch.rates.slopes(Y)
        start, sums, into = pitch.period.start(Y), pitch.sums(slopes.g), line_inflow(pitch, slopes.g)
        own = pitch.numbers, unknowns_of(pitch)
        return CollocatedCycle(pitch, start, Y, slopes, sums, *own, into, placed)

    def _pitch(self, edges: Array) -> CollocatedPitch:
        """Return the pitch on slices between edges [rad], read from the last history."""
        return CollocatedPitch(self.problem, self.machinery, mesh.Mesh.between(edges), self.seams, self.course)

    def _with_rings(self, plain: Array, turns: Sequence[mesh.Crossing]) -> Array:
        """Return edges [rad] with those around crossings, and around the highest pressure of the last history."""
        pitch = float(self.machinery.composition.P[P_PITCH])
        highest = peak(self.machinery.trajectory, self.problem.parts.geometry)[1] % pitch
        return mesh.with_rings(plain, self.seams, turns, (self.fineness.ring, self.fineness.wider), highest)

    def _solved(self, pitch: CollocatedPitch, closing: bool, within: float) -> tuple[Array, Array]:
        """Return states at start and nodes, installed: of the closed cycle, or near it `within` shares of an error."""
        if not (closing or pitch.alone):
            found = approach(pitch, within * self.tolerance, self.factors)
            if found is not None:
                return found
        bound = self.fineness.closed * CLOSED if closing or pitch.alone else NEARLY_CLOSED
        kept = self.linear if self.linear is not None and self.linear.pitch.count == pitch.count else None
        Y, self.linear = newton.close(pitch, bound, None if pitch.alone else kept, self.factors)
        return pitch.period.start(Y), Y

    def _carried(self, pitch: CollocatedPitch, plain: Array) -> Array:
        """Return plain edges [rad] moved along with the events of a turn, which are where the pitch found them."""
        if not pitch.alone:
            return plain
        moved = pitch.events.carried(plain, self.seams, self.course)
        self.seams, self.course = pitch.events.seams, pitch.events.course
        return moved

    def _refined(self, pitch: CollocatedPitch, start: Array, Y: Array, plain: Array) -> tuple[Array, bool]:
        """Return plain edges [rad] with slices divided whose error is too large, and whether they are good now."""
        errors, of_plain = errors_of(pitch, start, Y), np.zeros(len(plain) - 1)
        np.maximum.at(of_plain, np.searchsorted(plain, pitch.mesh.middles) - 1, errors)
        good = bool(errors.max() <= self.fineness.divided * self.tolerance)
        return mesh.refined(plain, of_plain, self.tolerance), good


def _with_vanished(turns: list[mesh.Crossing], before: list[mesh.Crossing]) -> list[mesh.Crossing]:
    """Return crossings together with earlier ones that have disappeared, as where pressures barely touch.

    Each earlier one is matched with at most one that is present: of two close together, one may be lost.
    """
    pairs = sorted(
        (abs(one.angle - each.angle) / one.layer, i, j)
        for i, one in enumerate(before)
        for j, each in enumerate(turns)
        if abs(one.angle - each.angle) <= VANISHED_WITHIN * one.layer
    )
    met: set[int] = set()
    there: set[int] = set()
    for _, i, j in pairs:
        if i not in met and j not in there:
            met.add(i)
            there.add(j)
    return sorted([*turns, *(one for i, one in enumerate(before) if i not in met)])


def _slices_still_fit(turns: list[mesh.Crossing], before: list[mesh.Crossing], bound: float) -> bool:
    """Return whether all crossings are where slices were ended for them, within so many of their `share` of a layer."""
    if len(before) != len(turns):
        return False
    pairs = zip(turns, before, strict=True)
    return all(abs(one.angle - other.angle) < bound * one.share * one.layer for one, other in pairs)


def errors_of(pitch: CollocatedPitch, start: Array, Y: Array) -> Array:
    """Return the relative error of each slice: Radau's embedded estimate, of order 3, separately for each chamber."""
    before, widths = pitch.begins(start, Y), pitch.mesh.widths
    f, own = pitch.rates.at_one_angle(pitch.mesh.edges[:-1], before)
    defect = f + radau.EMBEDDED @ (Y - before[:, None]) / widths[:, None]
    own = own.swapaxes(0, 1)
    matrix = (radau.EIGENVALUE / widths)[:, None, None, None] * np.eye(pitch.n) - own
    found = np.abs(np.linalg.solve(matrix, defect.reshape(*own.shape[:-1], 1))).reshape(defect.shape)
    return (found / np.maximum(np.maximum(np.abs(before), np.abs(Y[:, -1])), SMALL)).max(axis=1)
