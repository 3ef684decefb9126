"""How accurate the figures of a closed cycle are, and closing it again more tightly until they are accurate enough.

The estimate is one more life from the closed cycle with a finer tolerance and a narrower regularisation: what that
changes in the figures, and in those that go with the net gas flow what the unclosed mass balance leaves open in it
(docs/model.md M41).
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

from screwsim import shaft
from screwsim.errors import flow_errors, relative_errors
from screwsim.model import close as closing
from screwsim.model import tries
from screwsim.numerics.integrators import check_of
from screwsim.outputs import Figures

FINER = 0.25  # tolerance of a step in the turn that estimates the error
NARROWER = 0.25  # regularisation in that turn
WHOLE = 1.0 / (1.0 - NARROWER)  # the error over what that turn shows of it, where it is linear in the regularisation
TIGHTER = 0.25  # least factor of tolerances and regularisation in the next try, where the estimate exceeds the accuracy
AIM = 0.6  # of the wanted accuracy, at which the next try aims
EASY = 0.4  # of the wanted accuracy: an estimate below it lets the next scene of a course begin less tight
LOOSER = 1.5  # by this factor, AIM over EASY: none of them is estimated above AIM then
TIGHTEST = 0.05  # factor of the tolerances with which a scene of a course may begin
TRIES = 7
MUCH = 1e-4  # wanted accuracy from which on two turns estimate
TIGHT = 0.75  # volumetric efficiency below which leaks rule, and two turns estimate
LEAKY = 0.5  # volumetric efficiency below which an error of histories lives on for so many turns
HIDDEN = 2.0  # that it is as many times what two of them show
EMPTY = 3.0  # the same of a machine that delivers nothing: what leaks is all there is
ROOT = 1.5  # the same of coupled chambers, whose error falls as the root of the regularisation there
QUICK = 0.7  # share of a life's change that the next one makes, below which two lives tell what all would
SLOWEST = 0.9  # the largest such share that is believed
SMALL = 0.05  # of the wanted accuracy: a change of the second life below which no more is asked


Read = tuple[Figures, dict[str, str]]  # figures, and why some are None


class Accurate(NamedTuple):
    """A closed cycle, the estimated error of its figures ({} where nothing is estimated), what both took.

    `counts` and times [s] are those of closing and of estimating, apart; `figures` what the estimate read of the cycle.
    """

    closed: closing.Closed
    errors: Figures
    counts: list[int]
    closing_time: float
    estimating_time: float
    figures: Read | None = None


def close_accurately(solution: Any) -> Accurate:
    """Close the cycle, and again more tightly while the estimated error exceeds the wanted accuracy.

    Nothing is estimated of a cycle that did not close, that a check closed, or where the scene says
    `numerics.error: none`.
    """
    numerics, machinery, course = solution.scene.numerics, solution.machinery, solution.course
    watch = Watch(machinery)
    solution.tighten(course.tightness)
    closed, errors = shaft.settled(solution, _close_somehow(solution)), Figures()
    figures, largest = None, 0.0
    watch.lap("closing")
    for attempt in range(TRIES):
        if closed.status != "ok" or check_of(numerics.integrator) or numerics.error == "none":
            break
        errors, figures = estimated_errors(solution, closed)
        largest = worst(errors)[1]
        watch.lap("estimating")
        if largest <= numerics.accuracy or numerics.rtol is not None or attempt == TRIES - 1:
            break
        before = Snapshot(machinery)
        factor = max(TIGHTER, AIM * numerics.accuracy / largest)
        course.tightness *= factor
        solution.tighten(factor)
        tighter = shaft.settled(solution, closing.again(solution, closed))
        watch.lap("closing")
        if tighter.status != "ok":
            before.put_back()
            break
        closed = replace(tighter, needed=closed.needed, first_gap=closed.first_gap)
    course.tightness = _next_tightness(course.tightness, largest / numerics.accuracy)
    times, counts = watch.times, watch.counts["closing"]
    return Accurate(closed, errors, counts, times["closing"], times["estimating"], figures)


def _next_tightness(used: float, estimated: float) -> float:
    """Return the factor of the tolerances with which the next scene of a course begins; error over accuracy."""
    if estimated < EASY:
        used = min(1.0, LOOSER * used)
    return max(used, TIGHTEST)


def close_tighter(solution: Any, accurate: Accurate) -> Accurate:
    """Close a closed cycle once more, with finer tolerances; the old one stays where that fails."""
    watch, before = Watch(solution.machinery), Snapshot(solution.machinery)
    wanted = solution.wanted
    solution.tighten(TIGHTER)
    closed = shaft.settled(solution, closing.again(solution, accurate.closed))
    watch.lap("closing")
    counts = [before + more for before, more in zip(accurate.counts, watch.counts["closing"], strict=True)]
    spent = accurate.closing_time + watch.times["closing"]
    if closed.status != "ok":
        before.put_back()
        solution.wanted, closed = wanted, accurate.closed
    closed = replace(closed, needed=accurate.closed.needed, first_gap=accurate.closed.first_gap)
    return accurate._replace(closed=closed, counts=counts, closing_time=spent, figures=None)


def _close_somehow(solution: Any) -> closing.Closed:
    """Close the cycle; by further tries where the first does not and the scene leaves the way to us.

    A gas outside its equation stays there, whatever is tried. What no try closes is left as the first left it.
    """
    closed, numerics = solution.close(), solution.scene.numerics
    if closed.status == "ok" or check_of(numerics.integrator) or numerics.closing == "histories":
        return closed
    if solution.outside(closed):
        return closed
    before = Snapshot(solution.machinery)
    for name, attempt in tries.further_tries(solution, solution.start):
        better = attempt()
        if better.status == "ok":
            return replace(better, needed=name)
    before.put_back()
    return closed


class Watch:
    """Time and counts of one machinery by what they were spent on; compilation does not count."""

    def __init__(self, machinery: Any) -> None:
        self.machinery = machinery
        self.times = {"closing": 0.0, "estimating": 0.0}
        self.started = self._now()
        self.counts = {name: [0] * len(self.started[1]) for name in self.times}

    def _now(self) -> tuple[float, list[int]]:
        return time.perf_counter() - self.machinery.compile_time, self.machinery.counts.tolist()

    def lap(self, name: str) -> None:
        """Add what was spent since the last lap."""
        (then, before), now = self.started, self._now()
        self.times[name] += now[0] - then
        spent = zip(self.counts[name], now[1], before, strict=True)
        self.counts[name] = [count + new - old for count, new, old in spent]
        self.started = now


def worst(errors: Figures) -> tuple[str, float]:
    """Return the figure of the largest estimated error, and that error."""
    found, largest = "", 0.0
    for name, error in errors.items():
        if error is not None and (error > largest or not found):
            found, largest = name, error
    return found, largest


def estimated_errors(solution: Any, closed: closing.Closed) -> tuple[Figures, Read]:
    """Return the estimated relative error of every figure of a closed cycle, left as it was, and what was read."""
    found, notes = solution.figures(closed.q)
    machinery = solution.machinery
    with machinery.set_aside():
        machinery.composition.P[machinery.composition.widths] *= NARROWER
        finer = _finer(solution, closed, found)
        if not finer:
            return Figures(dict.fromkeys(found)), (found, notes)
    errors = _shown(found, finer, solution.least(closed.q))
    hidden = (HIDDEN if _filling(found) > 0.0 else EMPTY) if closed.how == "histories" else ROOT
    whole = WHOLE * (hidden if _among_leaks(solution, found) else 1.0)
    for name, size in errors.items():
        errors[name] = whole * size if size is not None else None
    flow = found["gas_mass_flow"]
    lost = abs(solution.balances.mass_in(closed.q) * solution.lives_per_second / flow) if flow else 0.0
    for name, size in flow_errors(found, lost).items():
        errors[name] = (errors[name] or 0.0) + (size or 0.0)
    return errors, (found, notes)


def _shown(found: Figures, finer: Sequence[Figures], least: tuple[float, float]) -> Figures:
    """Return what finer lives show of the error of each figure: the most they change, and what later ones yet would.

    Two lives may agree with the closed one by chance where each goes another way. The last life's change is followed by
    others, each as much smaller as that one was than the life's before it.
    """
    errors = relative_errors(found, finer[-1], *least)
    for each in finer[:-1]:
        for name, size in relative_errors(found, each, *least).items():
            if size is not None and errors[name] is not None:
                errors[name] = max(errors[name], size)
    if len(finer) > 1:
        steps = [relative_errors(old, new, *least) for old, new in pairwise([found, *finer])]
        again = min(_repeated(steps), SLOWEST)
        for name, size in steps[-1].items():
            if size is not None and errors[name] is not None:
                errors[name] += size * again / (1.0 - again)
    return errors


def _repeated(steps: Sequence[Figures]) -> float:
    """Return the share of a life's change that the last life made once more."""
    before, last = (worst(step)[1] for step in steps[-2:])
    return last / before if before > 0.0 else 0.0


def _fed_back(solution: Any, found: Figures) -> bool:
    """Tell whether one finer life is not enough for an estimate: errors come back through what it still meets.

    That is the coarser life of its neighbours; what the cycle makes beside the discharge line; the state at its own
    beginning, where much of it is kept: of one chamber alone, of reeds, of oil whose amount nothing but the flows tell.
    """
    parts, numerics = solution.parts, solution.scene.numerics
    if numerics.accuracy <= MUCH or _filling(found) < TIGHT or parts.made:
        return True
    composition, oil = solution.machinery.composition, parts.oil
    displaced = composition.carried and oil is not None and "ratio" not in oil.supply
    kept = composition.chambers == 1 or bool(composition.own_states)
    return kept or displaced or composition.ported or composition.dissolves


def _among_leaks(solution: Any, found: Figures) -> bool:
    """Tell whether chambers live on what leaks from the others."""
    return solution.machinery.composition.chambers > 1 and _filling(found) < LEAKY


def _filling(found: Figures) -> float:
    """Return the volumetric efficiency, 1 where it is not defined."""
    filling = found.get("volumetric_efficiency")
    return 1.0 if filling is None else filling


def _finer(solution: Any, closed: closing.Closed, found: Figures) -> list[Figures]:
    """Return the figures of finer solutions beside a closed cycle: lives, or another cycle; of none where all stop.

    One life more shows the error of a cycle closed by histories, two where errors come back. Where the second life
    changes nearly as much as the first, and with coupled chambers, what shows it is the cycle closed again, finer.
    """
    finer = [] if closed.needed or closed.how == "coupled" else _finer_lives(solution, closed, found)
    if len(finer) == 1:
        return finer
    if len(finer) > 1:
        steps = [relative_errors(old, new, *solution.least(closed.q)) for old, new in pairwise([found, *finer])]
        if _repeated(steps) < QUICK or worst(steps[-1])[1] < SMALL * solution.scene.numerics.accuracy:
            return finer
    return _finer_cycle(solution, closed) or finer


def _finer_lives(solution: Any, closed: closing.Closed, found: Figures) -> list[Figures]:
    """Install one life more, or two, finer than the closed one's; return their figures, of none where one stopped."""
    machinery, rtol, y, finer = solution.machinery, FINER * closed.rtol, closed.y.copy(), []
    for left in (1, 0) if _fed_back(solution, found) else (0,):
        status, _, _, q = machinery.turn(y, rtol, 1e-3)
        if status != 0:
            return []
        machinery.swap()
        finer.append(solution.figures(q)[0])
        if left:
            solution.set_made(solution.entries.possible(solution.image(q)))
    return finer


def _finer_cycle(solution: Any, closed: closing.Closed) -> list[Figures]:
    """Return the figures of the cycle that closes with finer steps from the closed one; of none where none does.

    A cycle that only a further try closed draws its neighbourhood in slowly, or not at all: what the steps of one life
    are off by is far less than what the cycle is off by.
    """
    wanted = solution.wanted
    solution.wanted = replace(wanted, rtol=FINER * closed.rtol, tolerance=FINER * wanted.tolerance)
    try:
        finer = _again(solution, closed)
    finally:
        solution.wanted = wanted
    return [solution.figures(finer.q)[0]] if finer is not None and finer.status == "ok" else []


def _again(solution: Any, closed: closing.Closed) -> closing.Closed | None:
    """Close a closed cycle once more, the way that closed it; an estimate may cost as much as a further try."""
    if closed.needed:
        return closing.again(solution, closed)
    if closed.how == "coupled":
        return closing.by_coupling(solution, closed.y.copy(), most=tries.MOST_OF_A_TRY)
    hope = closing.Hope(closing.seen_of(solution.machinery, closed), 0.0)
    return closing.by_histories(solution, closed.y.copy(), last=True, hope=hope)


class Snapshot:
    """Parameters, run-time cells and the last history of a machinery, to be put back."""

    def __init__(self, machinery: Any) -> None:
        self.machinery = machinery
        self.P, self.R, self.stamp = machinery.composition.P.copy(), machinery.R.copy(), machinery.stamp
        times, dense, quads, steps = machinery.last()
        self.history = times[: steps + 1].copy(), dense[:steps].copy(), quads[:steps].copy()

    def put_back(self) -> None:
        """Leave the machinery as it was."""
        self.machinery.composition.P[:], self.machinery.R[:] = self.P, self.R
        self.machinery.restore(*self.history)
        self.machinery.stamp = self.stamp  # it is the same history again
