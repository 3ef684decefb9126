"""Closing the cycle: the periodic state of a chamber among neighbours that live the same life, a pitch apart.

What else may close one that did not: finer steps, no acceleration, damping and searches, another speed.

Two ways (docs/explanation/closing.md, `cycle.ways`): waveform relaxation (`histories`), and all chambers together
(`coupled`). `auto` takes the first as long as it has not cost as much as the second would.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from screwsim.cycle.continuation import Course
from screwsim.cycle.guess import begin, continued
from screwsim.cycle.mixing import FULL, MixingRule
from screwsim.cycle.problem import Problem
from screwsim.cycle.search import SEARCH, judged, possible, sought_on
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.solution import CycleSolution, Led, Start, Wanted
from screwsim.cycle.ways import by_ways, way_of
from screwsim.model.exchange import station
from screwsim.model.run import Machinery
from screwsim.model.slots import P_OMEGA

MOST_OF_A_TRY = 2_000_000  # evaluations of one chamber's rates in one further try
PITCHES_OF_A_TRY = 2000  # and pitches: what contracts slowly but surely is waited for
DAMPED_DEPTH = 5  # of Anderson's method where closing is damped
DAMPING = 0.3  # share of the way to the mixed image that damped closing goes
NEAR_DAMPED = 0.05  # change of a pitch below which damped closing goes all the way
NEAR_PLAIN = 1e-3  # change of a pitch below which closing without acceleration is accelerated
OF_STEPS = 5e-4  # change of a pitch above which it is not the tolerance of its steps that keeps a cycle from closing
FASTER = 4.0  # speed of the easier scene from which a cycle is continued, where leaks and stiffness weigh less


def close(problem: Problem, machinery: Machinery, wanted: Wanted, course: Course | None = None) -> CycleSolution:
    """Close the cycle: continued from a course's last ones where that closes it, else from the first guess."""
    guess = None if course is None else continued(problem, machinery, course)
    station()
    if guess is not None:
        cycle = close_from(problem, machinery, wanted, guess.start)
        if cycle.closed:
            return cycle
    return close_from(problem, machinery, wanted, Start(begin(problem, machinery)))


def close_from(problem: Problem, machinery: Machinery, wanted: Wanted, start: Start) -> CycleSolution:
    """Close the cycle from a start.

    With a check the chambers are closed together under it, from where our own method closes.
    """
    cycle = by_ways(problem, machinery, replace(wanted, check=None) if wanted.check else wanted, start)
    if wanted.check is None or cycle.failed:
        return cycle
    return close_together(problem, machinery, wanted, chambers_at_pitches(machinery))


def again(
    problem: Problem, machinery: Machinery, wanted: Wanted, cycle: CycleSolution, led: Led | None = None
) -> CycleSolution:
    """Close a closed cycle, on which the machinery stands, once more with what is wanted now.

    Or the machinery stands where finer lives of a cycle closed by histories have led.
    """
    found = way_of(cycle).again(problem, machinery, wanted, cycle, led)
    if not found.closed:
        return found
    return replace(
        found,
        needed=cycle.needed,
        growth=cycle.growth,
        first_gap=cycle.first_gap,
        lasting=found.lasting or cycle.lasting,
        left_at=cycle.left_at,
    )


def fallbacks(
    problem: Problem, machinery: Machinery, wanted: Wanted, left: float = 0.0
) -> Iterator[tuple[str, Callable[[], CycleSolution]]]:
    """Yield what else may close a cycle that did not close: (what it is, how to do it).

    `left` is what its last pitch changed: where that is much, finer steps are of no help. All begin from the first
    guess and close all chambers together, which conserves exactly. The machine's own course comes first: a cycle that
    it leads to is to be preferred to one that it leaves, which damped pitches and searches find as well. Of what they
    find `growth` is told, and `needed` where a search did.
    """

    def closed(
        rule: MixingRule = FULL, most: int = MOST_OF_A_TRY, wanted: Wanted = wanted, patient: bool = False
    ) -> CycleSolution:
        begin(problem, machinery)
        y = chambers_at_pitches(machinery)
        return close_together(problem, machinery, wanted, y, rule, most, PITCHES_OF_A_TRY, patient)

    def plain(patient: bool = False) -> CycleSolution:
        return closed(MixingRule(0, near=NEAR_PLAIN), 2 * MOST_OF_A_TRY, patient=patient)

    def damped(patient: bool = False) -> CycleSolution:
        rule = MixingRule(DAMPED_DEPTH, DAMPING, NEAR_DAMPED)
        if possible(problem) and not patient:
            return sought_from_guess(rule, MOST_OF_A_TRY, early=True)
        return judged(problem, machinery, wanted, closed(rule))

    def faster(patient: bool = False) -> CycleSolution:
        begin(problem, machinery)
        P, omega = machinery.composition.P, problem.parts.omega
        P[P_OMEGA] = FASTER * omega
        y = chambers_at_pitches(machinery)
        easier = close_together(problem, machinery, wanted, y, FULL, MOST_OF_A_TRY, PITCHES_OF_A_TRY, patient)
        P[P_OMEGA] = omega
        if easier.failed:
            return easier
        cycle = close_together(problem, machinery, wanted, easier.y, most=MOST_OF_A_TRY, patient=patient)
        return judged(problem, machinery, wanted, cycle)

    def sought_from_guess(rule: MixingRule, most: int, early: bool = False) -> CycleSolution:
        begin(problem, machinery)
        cycle = sought_on(problem, machinery, wanted, chambers_at_pitches(machinery), rule, most, early)
        return cycle if cycle.needed else judged(problem, machinery, wanted, cycle)

    if left < OF_STEPS:
        tighter = replace(wanted, rtol=max(0.03 * wanted.rtol, 1e-12))
        yield "a tighter tolerance of the steps", lambda: closed(wanted=tighter)
    tries = {"closing without acceleration": plain, "damped closing": damped}
    tries[f"continuation from {FASTER:g} times the speed"] = faster
    yield from tries.items()
    if possible(problem):
        yield SEARCH, lambda: sought_from_guess(MixingRule(DAMPED_DEPTH, DAMPING), 3 * MOST_OF_A_TRY)
    if problem.composition.chambers > 1:
        for name, attempt in tries.items():  # where all was in vain, each once more, to its end
            yield name, partial(attempt, patient=True)
