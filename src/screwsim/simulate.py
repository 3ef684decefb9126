"""One scene → one result: close the cycle, take the figures, judge the balances."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Iterator
from typing import Any

from screwsim import own, plausible, settling, shaft, verdict
from screwsim.build import blamed, faults_of_own, prepare
from screwsim.estimate import TRIES, Accurate, close_accurately, close_tighter
from screwsim.faults import Impossible, UsageError
from screwsim.figures import Performance
from screwsim.ledger.total import Ledger
from screwsim.model import compiled
from screwsim.numerics import sources
from screwsim.numerics.trial import how_it_died
from screwsim.outputs import Figures, Result
from screwsim.prepared import Series
from screwsim.scene.plausible import scene_warnings
from screwsim.scene.types import Scene
from screwsim.solution import Solution


def _numerics(solution: Solution, accurate: Accurate) -> Figures:
    counts, closed = accurate.counts, accurate.closed
    return Figures(
        integrator=solution.scene.numerics.integrator,
        closing=closed.how,
        rtol=closed.rtol,
        turns=closed.turns,
        steps=int(counts[0]),
        rhs_evaluations=solution.machinery.evaluations_of(counts),
        jacobians=int(counts[3]),
        wall_time=accurate.closing_time,
        estimating_time=accurate.estimating_time,
    )


def _finite(table: Figures) -> bool:
    return all(map(math.isfinite, [value for value in table.values() if value is not None]))


def _judged(
    solution: Solution, accurate: Accurate, trace: bool
) -> tuple[Figures, dict[str, str], Figures, Ledger | None]:
    """Return figures, why some are None, the balances and the ledger of a closed cycle, None where none is wanted."""
    closed = accurate.closed
    found, notes = accurate.figures or solution.figures(closed.q)
    balance = solution.balance(closed.q)
    wanted = trace or solution.scene.numerics.error == "estimate"
    book = solution.ledger(closed.q, found.shaft_power) if wanted else None
    balance["entropy"] = None if book is None else book.entropy_residue(solution.least(closed.q)[0])
    return found, notes, balance, book


def simulate(scene: Scene, trace: bool = True) -> Result:
    """Return the result of one scene; bad physics gives a status and what there is, never an exception.

    `trace` keeps the cycle over the angle; the ledger is left out without it where the scene says `numerics.error:
    none`. Raises UsageError when the scene asks for a fluid that is not there.
    """
    return _told(scene, trace, Series())


def simulate_many(scenes: Iterable[Scene], trace: bool = True) -> Iterator[Result]:
    """Yield the result of each scene, every cycle begun from the ones before where these are near.

    That costs a fraction of `simulate` along a sweep, and changes results by less than the tolerances: they depend on
    the scenes before. A scene that is not ok ends the course; the next begins afresh.
    """
    series = Series()
    for scene in scenes:
        yield _told(scene, trace, series)


def _told(scene: Scene, trace: bool, series: Series) -> Result:
    """Return the result of a scene; what goes wrong inside an effect of the user's own is told as a fault of that."""
    own = scene.own
    if not own:
        return _simulate(scene, trace, series)
    _survived(scene)
    try:
        return _simulate(scene, trace, series)
    except UsageError:
        raise
    except (Exception, SystemExit) as error:
        name = blamed(error, own)
        if name is None:
            raise
        series.course.forget()
        text = " ".join(f"{type(error).__name__}: {error}".split())
        what = "ends the program" if isinstance(error, SystemExit) else "fails"
        return Result("failed", f"{own[name]}: {what} ({text}); mend that module", effects=tuple(scene.effects))


_tried: dict[tuple[str, ...], list[Any]] = {}  # machines and effects that were tried, the user's own as imported


def _survived(scene: Scene) -> None:
    """Raise UsageError where a process dies over modules of the user's own: a child is the first to try them."""
    names, modules = (scene.machine.kind, *scene.effects), [sources.made_of(name) for name in scene.own]
    known = _tried.get(names, [])
    if len(known) == len(modules) and all(map(operator.is_, known, modules)):
        return
    how = how_it_died(lambda: _simulate(scene, False, Series()))
    if how:
        what = f"a process that built, compiled and ran them died {how}"
        which = "the effects" if scene.machine.kind not in scene.own else "what is"
        where = ", ".join(scene.own.values())
        raise UsageError(f"{where}: {what}; mend the module (they are {which} of your own here)")
    _tried[names] = modules


def _simulate(scene: Scene, trace: bool, series: Series) -> Result:
    try:
        with faults_of_own(scene):
            with compiled.equation_announced(scene.gas.fluid):
                solution = Solution(scene, series)
            solution.machinery.warm_up(solution.rehearse)
        solution = shaft.at_its_speed(solution)
        result = _solved(solution, trace)
        solution.release()
    except Impossible as wrong:
        result = Result("failed", str(wrong), scene_warnings(scene), tuple(scene.effects))
    if result.status != "ok":
        series.course.forget()
    return result


def _solved(solution: Solution, trace: bool) -> Result:
    scene, machinery = solution.scene, solution.machinery
    accurate = close_accurately(solution)
    closed = accurate.closed
    numerics = _numerics(solution, accurate)
    effects, states = tuple(scene.effects), machinery.composition.states
    refused = own.impossible(solution, closed)
    if not refused and closed.status == "failed":
        refused = verdict.failure(solution, closed)
    refused = refused or verdict.refused(solution) or solution.beyond()
    if refused:
        shut = "".join(f"; {words}" for words in plausible.shut_ways(scene, solution.parts))
        none = Performance({}, solution.called)
        return Result("failed", refused + shut, scene_warnings(scene), effects, states, none, numerics=numerics)
    found, notes, balance, book = _judged(solution, accurate, trace)
    for _ in range(TRIES):
        if closed.status != "ok" or (balance.entropy or 0.0) <= balance.bound or scene.numerics.rtol is not None:
            break
        # mass and energy are judged while closing, entropy only here: it needs the ledger
        accurate = close_tighter(solution, accurate)
        closed, numerics = accurate.closed, _numerics(solution, accurate)
        found, notes, balance, book = _judged(solution, accurate, trace)
    solution.note(closed)
    sound = book is None or book.finite
    if not _finite(found) or (closed.status == "ok" and not sound):
        message = "a figure is not finite; ask for a tighter numerics.accuracy"
        none = Performance({}, solution.called)
        return Result("failed", message, (), effects, states, none, numerics=numerics)
    if not sound:  # of a cycle that is none, states between steps may be none of the gas
        book, balance["entropy"] = None, None
    forbidden, of_drive, balance["drive"] = shaft.judged(solution, closed)
    overloaded, of_loads = solution.judged(closed.q)
    forbidden = forbidden or overloaded
    status, message = closed.status, ""
    residues = {name: balance[name] for name in ("mass", "energy", "entropy", "drive") if balance[name] is not None}
    shown = ", ".join(f"{name} {size:.2g}" for name, size in residues.items())
    if status == "not_closed" or max(residues.values()) > balance.bound:
        status = "not_closed"
        message = (
            f"{shown} against the bound {balance.bound:.2g}, last change {closed.change:.2g}; "
            f"{verdict.unclosed(solution, closed)}"
        )
    unknown = solution.open_question(closed.q, status == "ok")
    if unknown:
        unsettled = f"; their cycle does not close: {shown}, bound {balance.bound:.2g}" if status != "ok" else ""
        status, message = "failed", unknown + unsettled
    swings = "" if status == "ok" or unknown else verdict.beyond_its_mean(solution)
    if swings:
        status, message = "failed", f"{swings}; its cycle does not close: {shown}, bound {balance.bound:.2g}"
    if forbidden:
        status, message = "failed", f"{forbidden}; the chambers' figures are those of the closed cycle"
    cycle, kept = solution.cycle(closed.q) if trace else {}, book.figures() if trace and book else Figures()
    tried = (f"the cycle closed only with {closed.needed}",) if closed.needed else ()
    of_turns = settling.warnings(solution, closed)
    warnings = (
        *verdict.doubts(solution, found if status == "ok" else Figures(), accurate.errors),
        *of_loads,
        *tried,
        *of_drive,
        *of_turns,
        *verdict.warnings(solution, found),
        *verdict.inaccurate(scene.numerics.accuracy, accurate.errors),
    )
    errors = accurate.errors
    return Result(status, message, warnings, effects, states, found, balance, errors, numerics, notes, cycle, kept)


def warm_up(scene: Scene) -> None:
    """Compile or load what the scene needs, so that workers find it ready."""
    simulate(scene, trace=scene.output.keep == "cycle")
    prepare(scene)
