"""Close the collocated cycle, starting from the one that the integrator closed."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from screwsim.cycle.feedback import LineInflow
from screwsim.cycle.problem import Problem
from screwsim.derivatives import chamber_newton, mesh, radau
from screwsim.derivatives.argument_changes import ArgumentChange
from screwsim.derivatives.chamber_newton import SMALL, ChamberFactors, approach, damped, limited_step, residual_of
from screwsim.derivatives.crossings import crossings
from screwsim.derivatives.events import Course, course_of
from screwsim.derivatives.line_flows import line_inflow
from screwsim.derivatives.linear import DirectEffects, LinearisedPitch, RateEffects, Response
from screwsim.derivatives.peak import peak
from screwsim.derivatives.phases import borders
from screwsim.derivatives.pitch import CollocatedPitch, Slopes
from screwsim.derivatives.rate_numbers import RateNumbers
from screwsim.derivatives.shifted_life import ShiftedLife
from screwsim.derivatives.turn import CollocatedTurn
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
ROUNDS = 9  # of refinement
MOST_ITERATIONS = 20  # Newton iterations ...
STALLED = 6  # ... of which this many may pass without progress
CLOSED = 1e-7  # relative residual of a closed cycle ...
STATES_WITHIN = 1e-5  # ... that is accepted where no iteration reduces it further ...
NEARLY_CLOSED = 1e-4  # ... and that is enough to place slices, where `chamber_newton` finds no states
STATES_SHARE = 0.1  # of a slice's error: residual of the states with which that error is estimated ...
FIRST_ROUND_FACTOR = 100.0  # ... and in the first round, whose slices are much too long
SHIFT = 1e-6  # of coordinates, for differences of the image
KEEP_SLOPES_BELOW = 0.2  # ratio of residuals up to which the derivatives of the iteration before are kept
VANISHED_WITHIN = 20.0  # layers around a crossing, within which it may be one of the round before
PLACED = 0.5  # of `Crossing.share`: layers between a crossing and its slice's end, within which it counts as placed
IDENTITY_WITHIN = 1e-6  # departure of an image's derivatives from identity, up to which the scene states the unknown


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


FINE = Fineness(0.1, 1.0, 1.0, 0.5, 0.7)  # errors of 1e-5 of a derivative, in 95 of 100
QUICK = Fineness(10.0, 20.0, 10.0, 2.0, 1.6, 1.5, 50.0, False)  # errors of 1e-3


class Placed(NamedTuple):
    """Edges of slices [rad] without those around crossings, and the crossings."""

    edges: Array
    crossings: list[mesh.Crossing]


class CollocatedCycle(NamedTuple):
    """A collocated cycle: states at the start and the nodes, rates there, quadratures, numbers, unknowns, line flows.

    The flows `into` pulsating lines are None where these are read from a life; `placed` is where its
    slices end.
    """

    pitch: CollocatedPitch
    start: Array
    nodes: Array
    slopes: Slopes
    sums: Array
    at: RateNumbers
    unknowns_in: Array
    into: LineInflow | None
    placed: Placed


class LinearisedCycle(NamedTuple):
    """The response of a collocated cycle to changes, a column each, at fixed unknowns, and to each unknown.

    `back` (u, u) is the response of the unknowns to themselves, in coordinates; `given` marks those that the scene
    states; `own` are the effects of the unknowns.
    """

    by_changes: Response
    by_unknowns: Response
    back: Array
    given: Array
    own: RateEffects


class NotClosed(Exception):
    """The collocated cycle does not close."""


def collocated(problem: Problem, machinery: Machinery, life: Trajectory, fineness: Fineness = FINE) -> CollocatedCycle:
    """Return the collocated cycle of a closed life; raise NotClosed where none is found."""
    c = machinery.composition
    machinery.composition = replace(c, TAB=c.TAB.copy())  # a writable copy
    life, why = fine_turn(machinery, life) if machinery.alone else life, NotClosed()
    for steps in STEPS:
        try:
            return _collocated(problem, machinery, life, steps, fineness)
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
    if pitch.alone:
        raise NotClosed("the events of a turn may be others")
    pitch.put(numbers)
    pitch.install_shifted(cycle.start, cycle.nodes, 1.0, moves)
    return _collocated(problem, pitch.machinery, pitch.machinery.trajectory.copy(), cycle.placed, fineness)


def fine_turn(machinery: Machinery, life: Trajectory) -> Trajectory:
    """Return a turn of a single chamber after a closed one, integrated finely: its events are those of the cycle."""
    machinery.put(life)
    y = life.dense[0, 0, : machinery.n].copy()
    for _ in range(FINE_TURNS):
        status, *_ = machinery.turn(y, FINE_TURN, float(life.times[1] - life.times[0]))
        if status:
            raise NotClosed("a finely integrated turn fails")
        machinery.swap()
    return machinery.trajectory.copy()


def _collocated(
    problem: Problem, machinery: Machinery, life: Trajectory, begin: float | Placed, fineness: Fineness
) -> CollocatedCycle:
    """Collocate with slices of so many steps first; refine and place them at turning flows until both settle.

    Or begin with those of a cycle nearby, which need no refinement.
    """
    machinery.put(life)
    seams, course = mesh.fixed_edges(machinery, problem.parts), course_of(machinery.trajectory)
    if len(course.events) > MOST_EVENTS:
        raise NotClosed(f"valves meet seat and stop, or leave them, {len(course.events)} times in a turn")
    if not course.returns:
        raise NotClosed("a valve rests at one end of the turn and moves at the other")
    seams = np.sort(np.concatenate([seams, course.angles]))
    if len(course.events) and np.diff(seams).min() <= mesh.LEAST:
        raise NotClosed("a valve meets its seat or stop, or leaves it, at the angle of another event")
    tolerance = fineness.error * ERROR * problem.scene.numerics.accuracy
    tolerance *= OF_TURN if machinery.alone else 1.0
    if good := isinstance(begin, Placed):
        plain, before = begin
    else:
        plain, before = mesh.edges_of(machinery, seams, begin, fineness.longest * mesh.LONGEST), []
    pitch = pitch_of(problem, machinery, mesh.Mesh.between(plain), seams, course)
    Y, linear, closing, own = np.empty(0), None, good, ChamberFactors()
    turns = _with_vanished(crossings(pitch), before)
    for left in range(ROUNDS, 0, -1):
        highest = peak(machinery.trajectory, problem.parts.geometry)[1] % float(machinery.composition.P[P_PITCH])
        edges = mesh.with_rings(plain, seams, turns, (fineness.ring, fineness.wider), highest)
        pitch = pitch_of(problem, machinery, mesh.Mesh.between(edges), seams, course)
        kept = linear if linear is not None and linear.pitch.count == pitch.count and not pitch.alone else None
        within = FIRST_ROUND_FACTOR if left == ROUNDS else STATES_SHARE
        placed = None if closing or pitch.alone else approach(pitch, within * tolerance, own)
        if placed is None:
            exact = closing or pitch.alone
            Y, linear = _closed(pitch, fineness.closed * CLOSED if exact else NEARLY_CLOSED, kept, own)
            plain, seams, course = pitch.with_events_moved(plain, seams, course)
        start, Y = placed or (pitch.begin(Y), Y)
        before, turns = turns, _with_vanished(crossings(pitch), turns)
        if closing and (left == 1 or (good and _slices_still_fit(turns, before, fineness.near * PLACED))):
            break
        if not good:
            errors = errors_of(pitch, start, Y)
            good, of_plain = bool(errors.max() <= fineness.divided * tolerance), np.zeros(len(plain) - 1)
            np.maximum.at(of_plain, np.searchsorted(plain, pitch.mesh.middles) - 1, errors)
            plain = mesh.refined(plain, of_plain, tolerance)
        closing = good or left <= 3
    if missed := pitch.missed(Y):
        raise NotClosed(missed)
    slopes = pitch.slopes(Y)
    start, into = pitch.begin(Y), line_inflow(pitch, slopes.g)
    sums, numbers = pitch.sums(slopes.g), pitch.numbers
    return CollocatedCycle(pitch, start, Y, slopes, sums, numbers, pitch.unknowns_in, into, Placed(plain, turns))


def pitch_of(problem: Problem, machinery: Machinery, of: mesh.Mesh, seams: Array, course: Course) -> CollocatedPitch:
    """Return the pitch of all chambers on slices, or the turn of a single one with its events."""
    if machinery.alone:
        return CollocatedTurn(problem, machinery, of, seams, course)
    return CollocatedPitch(problem, machinery, of)


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
    f, own = pitch.slopes_at(pitch.mesh.edges[:-1], before)
    defect = f + radau.EMBEDDED @ (Y - before[:, None]) / widths[:, None]
    own = own.swapaxes(0, 1)
    matrix = (radau.EIGENVALUE / widths)[:, None, None, None] * np.eye(pitch.n) - own
    found = np.abs(np.linalg.solve(matrix, defect.reshape(*own.shape[:-1], 1))).reshape(defect.shape)
    return (found / np.maximum(np.maximum(np.abs(before), np.abs(Y[:, -1])), SMALL)).max(axis=1)


def _closed(
    pitch: CollocatedPitch, nearly: float, linear: LinearisedPitch | None, own: ChamberFactors
) -> tuple[Array, LinearisedPitch | None]:
    """Close the cycle to a relative residual; return the states at the nodes, installed, and the last linearisation.

    It starts from the linearisation of the slices before, if their number is the same.
    """
    Y, entries, size, before = pitch.read(), pitch.problem.entries, np.inf, np.inf
    found = None if pitch.alone else chamber_newton.closed(pitch, Y, nearly, own)
    if found is not None:
        return found, linear
    last, least, stalled = np.zeros_like(Y), np.inf, 0
    for left in range(MOST_ITERATIONS, 0, -1):
        off, residual, size, read = residual_of(pitch, Y)
        conditions = pitch.open_events(Y)
        size = max(size, float(np.abs(conditions).max(initial=0.0)))
        stalled = 0 if size < least else stalled + 1
        least = min(size, least)
        ends = left == 1 or stalled == STALLED
        if size < nearly or (size < STATES_WITHIN and ends):
            pitch.install(read[0], Y)
            return Y, linear
        if ends or not np.isfinite(size):
            break
        at, unknowns_in = pitch.numbers, pitch.unknowns_in
        stages = -residual[..., None]
        if linear is None or size > KEEP_SLOPES_BELOW * before:
            changes = [_moved(pitch, at, unknowns_in, j) for j in range(len(unknowns_in))]
            linear = LinearisedPitch(pitch, Y, pitch.slopes(Y), changes)
        response, of_unknowns = linear.respond(stages, conditions), linear.first
        before = size
        cycle = CollocatedCycle(
            pitch, read[0], Y, linear.slopes, read[1], at, unknowns_in, read[2], Placed(pitch.mesh.edges, [])
        )
        back = unknowns_response(cycle, of_unknowns, 0)
        change = solve_unknowns(back, off + unknowns_response(cycle, response, 1)[:, 0], _stated_unknowns(back))
        direct, through = response.of(0), of_unknowns.weighted(change)
        events = direct.events + through.events
        share = pitch.share_of_move(events)
        last = damped(share * (direct.nodes + through.nodes), last)
        Y = limited_step(pitch, Y, last)
        pitch.move_events(share * events)
        pitch.meet(entries.coordinates(unknowns_in) + change, unknowns_in)
    raise NotClosed(f"the collocated cycle leaves a residual of {size:.1g} open")


def linearised(
    cycle: CollocatedCycle, changes: Sequence[ArgumentChange], injected: DirectEffects, last: LinearisedCycle | None
) -> LinearisedCycle:
    """Return the cycle's responses to changes and to its unknowns; from the `last`, what depends on it alone.

    `injected`: those of states and cells by the injection, a column each. All at once, side by side, cost less.
    """
    pitch, count, own = cycle.pitch, len(cycle.unknowns_in), None if last is None else last.own
    pitch.put(cycle.at)
    every = [*(_moved(pitch, cycle.at, cycle.unknowns_in, j) for j in range(count)), *changes]
    crossed = borders(pitch, cycle.nodes)
    linear = LinearisedPitch(pitch, cycle.nodes, cycle.slopes, every, injected, crossed, count, own)
    by_unknowns, by_changes = linear.first.of(slice(count)), linear.first.of(slice(count, None))
    back = unknowns_response(cycle, by_unknowns, 0) if last is None else last.back
    return LinearisedCycle(by_changes, by_unknowns, back, _stated_unknowns(back), linear.own)


def _stated_unknowns(back: Array) -> Array:
    """Return which unknowns the scene states: these map to themselves."""
    return np.abs(np.eye(len(back)) - back).max(axis=1, initial=0.0) < IDENTITY_WITHIN


def _moved(pitch: CollocatedPitch, at: RateNumbers, unknowns_in: Array, j: int) -> ArgumentChange:
    """Return the change of the numbers with a coordinate of an unknown."""
    coordinates = pitch.problem.entries.coordinates(unknowns_in)
    found = []
    for sign in (1.0, -1.0):
        pitch.put(at)
        there = coordinates.copy()
        there[j] += sign * SHIFT
        pitch.meet(there, unknowns_in)
        found.append(pitch.numbers)
    pitch.put(at)
    return ArgumentChange(RateNumbers(*((above - below) / (2.0 * SHIFT) for above, below in zip(*found, strict=True))))


def unknowns_response(cycle: CollocatedCycle, response: Response, first: int) -> Array:
    """Return the response of the unknowns' next values to columns of a response.

    The columns from `first` on each include a unit change of one unknown.
    """
    pitch, unknowns_in = cycle.pitch, cycle.unknowns_in
    found, read = np.empty((len(unknowns_in), response.sums.shape[1])), False
    coordinates = pitch.problem.entries.coordinates(unknowns_in)

    def fill(by: float, j: int) -> None:
        nonlocal read
        read = True
        one = response.of(j)
        pitch.install_shifted(cycle.start, cycle.nodes, by, one)

    for j in range(found.shape[1]):
        images = []
        for by in (SHIFT, -SHIFT):
            pitch.put_with_cells(cycle.at, by, response.cells[:, j])
            there = coordinates.copy()
            if j >= first:
                there[j - first] += by
            pitch.meet(there, unknowns_in)
            life = ShiftedLife.of(pitch, partial(fill, by, j))
            into = None if cycle.into is None else cycle.into.moved(by * response.lines[..., j])
            images.append(pitch.image(cycle.sums + by * response.sums[:, j], life, into))
        found[:, j] = (images[0] - images[1]) / (2.0 * SHIFT)
    pitch.put(cycle.at)
    if read:
        pitch.install(cycle.start, cycle.nodes)
    return found


def solve_unknowns(back: Array, off: Array, given: Array) -> Array:
    """Return the change of the unknowns that makes them equal their image; stated ones change by `off` itself."""
    if not len(off):
        return np.zeros_like(off)
    matrix, right = np.eye(len(back)) - back, off.copy()
    matrix[given] = np.eye(len(back))[given]
    return np.linalg.solve(matrix, right)
