"""Closing the cycle: the periodic state of a chamber among neighbours that live the same life, a pitch apart.

Two ways (docs/explanation/numerics.md): waveform relaxation (`histories`), and all chambers together (`coupled`).
`auto` takes the first as long as it has not cost as much as the second would.
"""

from __future__ import annotations

from dataclasses import replace

from screwsim.cycle.continuation import Course
from screwsim.cycle.guess import begin, continued
from screwsim.cycle.linear_pitch import Tangents
from screwsim.cycle.problem import Problem
from screwsim.cycle.relaxation import relax
from screwsim.cycle.search import SEARCH, sought
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.solution import NO_HOPE, Array, CycleSolution, Hope, Led
from screwsim.cycle.wanted import Wanted
from screwsim.model.exchange import station
from screwsim.model.run import Machinery


def close(problem: Problem, machinery: Machinery, wanted: Wanted, course: Course | None = None) -> CycleSolution:
    """Close the cycle: continued from a course's last ones where that closes it, else from the first guess."""
    guess = None if course is None else continued(problem, machinery, course)
    station()
    if guess is not None:
        cycle = close_from(problem, machinery, wanted, guess.y, guess.hope, guess.tangents)
        if cycle.status == "ok":
            return cycle
    return close_from(problem, machinery, wanted, begin(problem, machinery))


def close_from(
    problem: Problem,
    machinery: Machinery,
    wanted: Wanted,
    y: Array,
    hope: Hope = NO_HOPE,
    lent: Tangents | None = None,
) -> CycleSolution:
    """Close the cycle from a state at 0° and a guess that is installed as the last history.

    With a check the chambers are closed together under it, from where our own method closes.
    """
    cycle = _close(problem, machinery, replace(wanted, check=None) if wanted.check else wanted, y, hope, lent)
    if wanted.check is None or cycle.status == "failed":
        return cycle
    return close_together(problem, machinery, wanted, chambers_at_pitches(machinery))


def again(
    problem: Problem, machinery: Machinery, wanted: Wanted, cycle: CycleSolution, led: Led | None = None
) -> CycleSolution:
    """Close a closed cycle, on which the machinery stands, once more with what is wanted now.

    Or the machinery stands where finer lives of a cycle closed by histories have led.
    """
    if cycle.how == "histories":
        y, seen = led or (cycle.y, cycle.seen)
        hope = Hope(seen, 0.0, 1.0, cycle.contraction, cycle.missed)
        found = _close(problem, machinery, wanted, y, hope, cycle.tangents)
    else:
        found = None
        if cycle.needed == SEARCH:
            found = sought(problem, machinery, wanted, cycle.y.copy(), judged=False)
        found = found or close_together(problem, machinery, wanted, cycle.y.copy())
    if found.status != "ok":
        return found
    return replace(found, needed=cycle.needed, growth=cycle.growth, first_gap=cycle.first_gap)


def _close(
    problem: Problem,
    machinery: Machinery,
    wanted: Wanted,
    y: Array,
    hope: Hope = NO_HOPE,
    lent: Tangents | None = None,
) -> CycleSolution:
    if wanted.closing in ("auto", "histories"):
        first = relax(problem, machinery, wanted, y.copy(), wanted.closing == "histories", hope, lent)
        if first is not None:
            return first
    return close_together(problem, machinery, wanted, chambers_at_pitches(machinery))
