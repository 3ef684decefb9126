"""Close the cycle: find the periodic state of a chamber whose neighbours live the same life a pitch apart.

There are two ways (docs/explanation/closing.md, `cycle.ways`): waveform relaxation (`histories`) and simultaneous
closing of all chambers (`coupled`). `auto` starts with the first and changes once that has cost as much as the second
would. Fallbacks follow where neither closes: finer steps, no acceleration, damping and searches, continuation in speed.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from screwsim.cycle.continuation import Course
from screwsim.cycle.guess import install_continued_guess, install_first_guess
from screwsim.cycle.mixing import FULL_RULE, MixingRule
from screwsim.cycle.problem import ClosingTask
from screwsim.cycle.search import FALLBACK_NAME, search_after_pitches, search_applies, with_growth
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.solution import Array, CorrectedState, CycleSolution, Start
from screwsim.cycle.ways import close_by_ways, way_of
from screwsim.model.slots import P_OMEGA
from screwsim.model.turn_scheduler import reach_station

MOST_OF_A_TRY = 2_000_000  # evaluations of one chamber's rates in one fallback
PITCHES_OF_A_TRY = 2000  # pitches in one fallback: enough for slow but steady contraction
DAMPED_DEPTH = 5  # depth of Anderson's method in damped closing
DAMPING = 0.3  # share of the way to the mixed image that damped closing goes
NEAR_DAMPED = 0.05  # change of a pitch below which damped closing takes full steps
NEAR_PLAIN = 1e-3  # change of a pitch below which plain closing is accelerated
STEPS_HELP_BELOW = 5e-4  # change of a pitch above which finer steps will not close the cycle
SPEED_RATIO = 4.0  # speed ratio from which a cycle is continued: leaks and stiffness weigh less there


def close(task: ClosingTask, course: Course | None = None) -> CycleSolution:
    """Close the cycle, continued from the last ones of a course; from the first guess where that does not close."""
    start = None if course is None else install_continued_guess(task.problem, task.machinery, course)
    reach_station()
    if start is not None:
        cycle = close_from(task, start)
        if cycle.closed:
            return cycle
    return close_from(task, Start(install_first_guess(task.problem, task.machinery)))


def close_from(task: ClosingTask, start: Start) -> CycleSolution:
    """Close the cycle from a start.

    With a check, the chambers are then closed together by the check's method, starting from our own solution.
    """
    if task.criteria.check is None:
        return close_by_ways(task, start)
    cycle = close_by_ways(task._replace(criteria=replace(task.criteria, check=None)), start)
    return cycle if cycle.failed else close_together(task, chambers_at_pitches(task.machinery))


def close_again(task: ClosingTask, cycle: CycleSolution, led: CorrectedState | None = None) -> CycleSolution:
    """Close a closed cycle once more, by the criteria given.

    The machinery must hold that cycle as its last history, or, with `led`, the history to which finer lives have
    moved it.
    """
    found = way_of(cycle).again(task, cycle, led)
    if not found.closed:
        return found
    return replace(
        found,
        needed=cycle.needed,
        growth=cycle.growth,
        first_gap=cycle.first_gap,
        lasting=found.lasting or cycle.lasting,
        abandoned_cycle=cycle.abandoned_cycle,
    )


def fallbacks(task: ClosingTask, left: float = 0.0) -> Iterator[tuple[str, Callable[[], CycleSolution]]]:
    """Yield further attempts at a cycle that did not close, as (name, function that makes the attempt).

    `left` is the change over its last pitch: where that is large, finer steps do not help. All attempts start from
    the first guess and close all chambers together, which conserves exactly. The machine's own course comes first:
    a stable cycle is preferred to an unstable one, which damped pitches and searches find as well. Solutions of the
    latter carry `growth`, and `needed` where a search found them.
    """

    problem, machinery, criteria = task

    def first_states() -> Array:
        install_first_guess(problem, machinery)
        return chambers_at_pitches(machinery)

    def tighter() -> CycleSolution:
        by = replace(criteria, rtol=max(0.03 * criteria.rtol, 1e-12))
        return close_together(task._replace(criteria=by), first_states(), FULL_RULE, MOST_OF_A_TRY, PITCHES_OF_A_TRY)

    def plain(patient: bool = False) -> CycleSolution:
        rule = MixingRule(0, near=NEAR_PLAIN)
        return close_together(task, first_states(), rule, 2 * MOST_OF_A_TRY, PITCHES_OF_A_TRY, patient)

    def damped(patient: bool = False) -> CycleSolution:
        rule = MixingRule(DAMPED_DEPTH, DAMPING, NEAR_DAMPED)
        if search_applies(problem) and not patient:
            return sought_from_guess(rule, MOST_OF_A_TRY, early=True)
        return with_growth(task, close_together(task, first_states(), rule, MOST_OF_A_TRY, PITCHES_OF_A_TRY))

    def faster(patient: bool = False) -> CycleSolution:
        y, P, omega = first_states(), machinery.composition.P, problem.parts.omega
        P[P_OMEGA] = SPEED_RATIO * omega
        easier = close_together(task, y, FULL_RULE, MOST_OF_A_TRY, PITCHES_OF_A_TRY, patient)
        P[P_OMEGA] = omega
        if easier.failed:
            return easier
        cycle = close_together(task, easier.y, most=MOST_OF_A_TRY, patient=patient)
        return with_growth(task, cycle)

    def sought_from_guess(rule: MixingRule, most: int, early: bool = False) -> CycleSolution:
        cycle = search_after_pitches(task, first_states(), rule, most, early)
        return cycle if cycle.needed else with_growth(task, cycle)

    if left < STEPS_HELP_BELOW:
        yield "a tighter tolerance of the steps", tighter
    tries = {"closing without acceleration": plain, "damped closing": damped}
    tries[f"continuation from {SPEED_RATIO:g} times the speed"] = faster
    yield from tries.items()
    if search_applies(problem):
        yield FALLBACK_NAME, lambda: sought_from_guess(MixingRule(DAMPED_DEPTH, DAMPING), 3 * MOST_OF_A_TRY)
    if problem.composition.chambers > 1:
        for name, attempt in tries.items():  # if all failed: each once more, without giving up early
            yield name, partial(attempt, patient=True)
