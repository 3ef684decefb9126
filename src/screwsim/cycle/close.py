"""Closing the cycle: the periodic state of a chamber among neighbours that live the same life, a pitch apart.

Two ways (docs/explanation/numerics.md, `cycle.ways`): waveform relaxation (`histories`), and all chambers together
(`coupled`). `auto` takes the first as long as it has not cost as much as the second would.
"""

from dataclasses import replace

from screwsim.cycle.continuation import Course
from screwsim.cycle.guess import begin, continued
from screwsim.cycle.problem import Problem
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.solution import CycleSolution, Led, Start
from screwsim.cycle.wanted import Wanted
from screwsim.cycle.ways import by_ways, way_of
from screwsim.model.exchange import station
from screwsim.model.run import Machinery


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
    return replace(found, needed=cycle.needed, growth=cycle.growth, first_gap=cycle.first_gap)
