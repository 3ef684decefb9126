"""Turn one scene into one result: close the cycle, compute the figures, judge the balances."""

import math
import operator
from collections.abc import Iterable, Iterator, Mapping
from contextlib import nullcontext
from typing import Any, Literal

from screwsim.build import faults_of_own, module_to_blame, prepare
from screwsim.cycle import feedback
from screwsim.cycle.continuation import Course
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import Problem, Series, problem_of, release_series, series_of_one
from screwsim.cycle.surroundings import KnownSurroundings
from screwsim.evaluate import cautions, own_effects, performance, plausible, verdict
from screwsim.evaluate.evaluation import balance as balance_of
from screwsim.evaluate.ledger.total import Ledger, ledger
from screwsim.evaluate.traces import traces
from screwsim.figures import Performance
from screwsim.inputs.faults import ImpossibleValue, UsageError, in_one_line
from screwsim.model import compiled, leases
from screwsim.model.run import Machinery
from screwsim.model.turn_scheduler import reach_station
from screwsim.numerics import compiling, sources
from screwsim.numerics.rodas import JACOBIANS, TAKEN
from screwsim.numerics.trial import how_it_died
from screwsim.outputs import Figures, Result
from screwsim.outputs.variables import FAILED, NOT_CLOSED, OK
from screwsim.scene import SceneLike
from screwsim.scene.grid import first_by_fluid
from screwsim.scene.load import scene_of
from screwsim.scene.plausible import scene_warnings
from screwsim.scene.types import Scene
from screwsim.solve import circuit, drive, second_cycle, stability
from screwsim.solve.accurately import TRIES, Accurate, record_in_course, solve_tighter
from screwsim.solve.circuit import SurroundingsSearch, solve_with_surroundings
from screwsim.solve.surroundings import open_values_residual

Trace = bool | Literal["ledger"]  # what a result keeps over the angle


def _numerics(machinery: Machinery, accurate: Accurate) -> Figures:
    """Return the numerical figures of a result: counts, tolerance and times of closing and of estimating."""
    cost, cycle = accurate.cost, accurate.cycle
    return Figures(
        integrator=accurate.evaluation.problem.scene.numerics.integrator,
        closing=cycle.how,
        rtol=cycle.rtol,
        turns=cycle.turns,
        steps=int(cost.counts[TAKEN]),
        rhs_evaluations=machinery.evaluations_of(cost.counts),
        jacobians=int(cost.counts[JACOBIANS]),
        wall_time=cost.closing,
        estimating_time=cost.estimating,
    )


def _balances_and_ledger(accurate: Accurate, trace: Trace) -> tuple[Figures, Ledger | None]:
    """Return the balances and the ledger of a closed cycle; the ledger is None where it is not wanted."""
    of = accurate.evaluation
    balance = balance_of(of)
    book = ledger(of) if trace or of.problem.scene.numerics.estimates else None
    balance["entropy"] = None if book is None else book.entropy_residual(of.least[0])
    return balance, book


def simulate(scene: SceneLike, trace: Trace = True) -> Result:
    """Return the result of one scene; impossible physics gives a status and a partial result, never an exception.

    The scene is one of `load`, the path of its file, its YAML text, or a dict as in the file. With `trace` True the
    result keeps the cycle over the angle and the ledger; with 'ledger' the ledger alone; with False neither.
    Without a trace the ledger is not even computed where the scene says `numerics.error: none`. Raises UsageError
    for a fluid that is not available.
    """
    return simulate_next(None, scene_of(scene), trace)


def simulate_many(scenes: Iterable[Scene], trace: bool = True) -> Iterator[Result]:
    """Yield the result of each scene; each cycle starts from the preceding ones where these are close enough.

    Along a sweep that costs a fraction of `simulate`. Results differ from those of `simulate` by less than the
    tolerances, and depend on the preceding scenes. A scene that is not ok ends the course; the next one starts
    afresh.
    """
    series = Series()
    for scene in scenes:
        yield simulate_next(series, scene, trace)


def simulate_next(series: Series | None, scene: Scene, trace: Trace) -> Result:
    """Return the result of a scene: one more of a series, as `simulate_many` does, or a single one.

    An exception inside a user's own effect becomes a failed result that names the effect.
    """
    own = scene.own
    if not own:
        return _simulate(scene, trace, series)
    _tried_in_child(scene)
    try:
        return _simulate(scene, trace, series)
    except UsageError:
        raise
    except (Exception, SystemExit) as error:
        name = module_to_blame(error, own)
        if name is None:
            raise
        if series is not None:
            series.course.forget()
        what = "ends the program" if isinstance(error, SystemExit) else "fails"
        message = f"{own[name]}: {what} ({in_one_line(error)}); fix that module"
        return Result(FAILED, message, effects=tuple(scene.effects))


_tried: dict[tuple[str, ...], list[Any]] = {}  # machines and effects already tried; their own modules


def _tried_in_child(scene: Scene) -> None:
    """Raise UsageError where a user's own modules crash the process: a child process tries them first."""
    names, modules = (scene.machine.kind, *scene.effects), [sources.recorded[name].made for name in scene.own]
    known = _tried.get(names, [])
    if len(known) == len(modules) and all(map(operator.is_, known, modules)):
        return
    how = how_it_died(lambda: _simulate(scene, False, None))
    if how:
        what = f"a process that built, compiled and ran them died {how}"
        which = "the effects" if scene.machine.kind not in scene.own else "what is"
        where = ", ".join(scene.own.values())
        raise UsageError(f"{where}: {what}; fix the module (they are {which} of your own here)")
    _tried[names] = modules


def _simulate(scene: Scene, trace: Trace, series: Series | None) -> Result:
    """Return the result of a scene, alone or as the next of a series.

    The speed and the oil's temperatures are found first where the scene leaves them open.
    """
    course = None if series is None else series.course
    alone, series = series is None, series or series_of_one()
    reach_station()
    try:
        with faults_of_own(scene) if scene.own else nullcontext():
            with compiled.equation_announced(scene.gas.name):
                problem = problem_of(scene, series)
            machinery = lease_for(problem)
        at_speed, search = circuit.steady_state(problem, series)
        if at_speed is not problem:
            leases.give_back(machinery)
            problem, machinery = at_speed, lease_for(at_speed)
        reach_station()
        result = _solved(problem, machinery, trace, course, search)
        leases.give_back(machinery)
        if alone:
            release_series(series)
    except ImpossibleValue as wrong:
        result = Result(FAILED, str(wrong), scene_warnings(scene), tuple(scene.effects))
    if course is not None and result.status != OK:
        course.forget()
        series.surroundings = KnownSurroundings()
    return result


def _solved(
    problem: Problem, machinery: Machinery, trace: Trace, course: Course | None, search: SurroundingsSearch | None
) -> Result:
    """Solve a problem, judge the cycle and collect its figures, warnings and traces in a result."""
    accurate = solve_with_surroundings(problem, machinery, course, search)
    problem = accurate.evaluation.problem
    scene = problem.scene
    effects, states = tuple(scene.effects), problem.composition.states
    reach_station()
    refused = _why_no_figures(accurate)
    if refused:
        numerics, none = _numerics(machinery, accurate), Performance({}, problem.called)
        return Result(FAILED, refused, scene_warnings(scene), effects, states, none, numerics=numerics)
    reach_station()
    accurate, balance, book = _closed_in_entropy(machinery, accurate, trace)
    reach_station()
    if course is not None:
        record_in_course(course, accurate.evaluation, accurate.cycle, accurate.criteria, accurate.tightness)
        course.keep_finer(accurate.tangents, problem.composition)
    cycle, of, errors, numerics = accurate.cycle, accurate.evaluation, accurate.errors, _numerics(machinery, accurate)
    reach_station()
    found, notes = of.read
    sound = book is None or book.finite
    finite = all(map(math.isfinite, [value for value in found.values() if value is not None]))
    if not finite or (cycle.closed and not sound):
        message = "a figure is not finite; ask for a tighter numerics.accuracy"
        none = Performance({}, found.about)
        return Result(FAILED, message, (), effects, states, none, numerics=numerics)
    if not sound:  # an unclosed cycle may pass through states, between steps, that the gas does not have
        book, balance["entropy"] = None, None
    forbidden, of_drive, balance["drive"] = drive.judge_drive(of)
    overloaded, of_loads = performance.judge_readings(problem.parts, of.known, found)
    status, message = _status_of(accurate, balance, forbidden or overloaded, "" if search is None else search.why)
    reach_station()
    over_angle, kept = traces(of) if trace is True else {}, book.figures() if trace and book else Figures()
    doubts, impossible = cautions.doubts(problem, found if status == OK else Figures(), errors)
    reach_station()
    warnings = (
        *doubts,
        *of_loads,
        *((f"the cycle closed only with {cycle.needed}",) if cycle.needed else ()),
        *of_drive,
        *stability.warnings(problem, machinery, cycle, accurate.criteria.rtol),
        *cautions.warnings(of),
        *cautions.inaccurate(scene.numerics.accuracy, errors),
        *(second_cycle.warnings(machinery, accurate) if status == OK else ()),
    )
    reach_station()
    figures = (found, balance, errors, numerics, notes, over_angle, kept)
    return Result(status, message, warnings, effects, states, *figures, impossible=impossible)


def _why_no_figures(accurate: Accurate) -> str:
    """Return why a cycle has no figures; empty where it has."""
    cycle, problem, life = accurate.cycle, accurate.evaluation.problem, accurate.evaluation.life
    found = own_effects.impossible(problem, cycle)
    if not found and cycle.failed:
        found = verdict.failure(problem, cycle)
    found = found or verdict.outside_gas_range(problem, life) or feedback.unknown_at_limit(problem, life)
    if not found and cycle.closed:
        found = feedback.suction_line_imbalance(problem, life, cycle.q)
    blocked = plausible.blocked_paths(problem.scene, problem.parts) if found else ()
    return "; ".join([found, *blocked])


def _closed_in_entropy(
    machinery: Machinery, accurate: Accurate, trace: Trace
) -> tuple[Accurate, Figures, Ledger | None]:
    """Solve more tightly where the entropy balance is open; it is checked only here because it needs the ledger."""
    balance, book = _balances_and_ledger(accurate, trace)
    for _ in range(TRIES):
        closed = (balance["entropy"] or 0.0) <= balance["bound"]
        if not accurate.cycle.closed or closed or accurate.evaluation.problem.scene.numerics.rtol is not None:
            break
        before, accurate = accurate, solve_tighter(machinery, accurate)
        if accurate.cycle is before.cycle:  # no tighter cycle closed, nor would it at a further try
            break
        balance, book = _balances_and_ledger(accurate, trace)
    return accurate, balance, book


def _status_of(accurate: Accurate, balance: Figures, forbidden: str, why: str) -> tuple[str, str]:
    """Return the status of a cycle that has figures, and its message: the first reason that applies.

    `forbidden` is an effect's reason to reject the cycle (empty: none), `why` the reason why the oil's temperatures
    or a package's losses were not found (empty where they were).
    """
    of, bound = accurate.evaluation, balance["bound"]
    none, circuit_open = verdict.circuit_verdict(of)
    package_open = 0.0 if of.package is None else of.package.open
    not_found = why if max(circuit_open, package_open) > bound else ""
    rejected = none or not_found or forbidden  # what a cycle of other surroundings forbids says nothing of the scene
    if rejected:
        return FAILED, f"{rejected}; the chambers' figures are those of the closed cycle"
    residuals = {name: balance[name] for name in ("mass", "energy", "entropy", "drive") if balance[name] is not None}
    left = _left_open(accurate, residuals, (bound, circuit_open, package_open), why)
    besides = f"; {{}} cycle does not close: {_shown(residuals)}, bound {bound:.2g}" if left else ""
    unknown = verdict.unanswered_question(of, not left)
    if unknown:
        return FAILED, unknown + besides.format("their")
    if left and (swings := verdict.beyond_its_mean(of.problem, of.life)):
        return FAILED, swings + besides.format("its")
    return (NOT_CLOSED, left) if left else (OK, "")


def _left_open(accurate: Accurate, residuals: Mapping[str, float], limits: tuple[float, float, float], why: str) -> str:
    """Return why a cycle does not count as closed: what is open, against which bound, and a remedy; empty if it does.

    `limits` are the bound and what the oil's circuit and the package leave open.
    """
    cycle, of = accurate.cycle, accurate.evaluation
    bound, circuit_open, package_open = limits
    if not cycle.closed or max(residuals.values()) > bound:
        left = f"{_shown(residuals)} against the bound {bound:.2g}"
        return f"{left}, last change {cycle.change:.2g}; {verdict.unclosed(of, cycle)}"
    tighter, found_open = "try a tighter numerics.accuracy", open_values_residual(of)
    state = "state oil_supply.temperature or the temperature after its cooler"
    for size, left, remedy in (
        (circuit_open, "the oil's circuit leaves {:.2g} of the shaft power open", f"{state} instead, or {tighter}"),
        (found_open, "what is found with the cycle leaves {:.2g} of a flow open", why or f"state it, or {tighter}"),
        (package_open, "the package's losses leave {:.2g} of a pressure open", tighter),
    ):
        if size > bound:
            return f"{left.format(size)}, against the bound {bound:.2g}; {remedy}"
    return ""


def _shown(residuals: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {size:.2g}" for name, size in residuals.items())


def warm_up(scene: Scene) -> None:
    """Compile or load what the scene needs, once for each fluid, so that workers find it ready."""
    trace = scene.output.keeps_cycle
    fluids = first_by_fluid(scene)
    for number, (fluid, one) in enumerate(fluids, 1):
        with compiling.one_of("fluid", number, len(fluids), fluid):
            simulate(one, trace=trace)
    if not fluids:
        simulate(scene, trace=trace)
    prepare(scene)
