"""The ways to close a cycle, and what depends on the way that closed it.

`cycle.how` is the name of that way; whatever depends on it is asked of the `Way`, nowhere else. A further way is a
`Way` in `WAYS` and an entry of `numerics.settings`.

Source: docs/explanation/closing.md.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from screwsim.cycle.problem import ClosingTask
from screwsim.cycle.relaxation import relax
from screwsim.cycle.search import FALLBACK_NAME, search_and_close
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.solution import ClosingCriteria, CorrectedState, CycleSolution, Expectation, Start
from screwsim.model.slots import Q_WORK, R_TRAPPED
from screwsim.numerics.settings import CLOSINGS, TOGETHER, WAVEFORMS
from screwsim.outputs.variables import NOT_CLOSED


class Way(NamedTuple):
    """A way to close a cycle, and what is asked of it.

    `close` closes a cycle from a start; None or an unclosed cycle hands over to the next way (never None from the last
    one, as which it is called). `again` closes a cycle that this way has closed once more, from where finer lives have
    moved it, if given. `finer` closes a cycle with finer steps, within so many evaluations where the number is not
    bounded otherwise. `share` returns the factor on the wanted tolerance of a step with which the balances closed.
    `whole`: a turn integrates all chambers, so that feedback through the others shows within it; otherwise one life
    among stored ones. `instead` is the setting to suggest where this way closes no cycle.
    """

    close: Callable[[ClosingTask, Start, bool], CycleSolution | None]
    again: Callable[[ClosingTask, CycleSolution, CorrectedState | None], CycleSolution]
    finer: Callable[[ClosingTask, CycleSolution, int], CycleSolution | None]
    share: Callable[[CycleSolution, ClosingCriteria], float]
    whole: bool
    instead: str = ""


def _relax_again(task: ClosingTask, cycle: CycleSolution, led: CorrectedState | None) -> CycleSolution:
    """Relax from a cycle, or from where its finer lives have moved it, with steps no coarser than before."""
    y, seen = (cycle.y, cycle.seen) if led is None else led
    share = min(1.0, _relaxed_share(cycle, task.criteria))
    expected = Expectation(seen, 0.0, share, cycle.contraction, cycle.missed)
    return close_by_ways(task, Start(y, expected, cycle.tangents))


def _relax_finer(task: ClosingTask, cycle: CycleSolution, most: int) -> CycleSolution | None:
    """Relax from the machinery's last life; relaxation bounds its own length."""
    seen = float(task.machinery.R[R_TRAPPED]), float(cycle.q[Q_WORK])  # the last life's mass
    return relax(task, Start(cycle.y, Expectation(seen, 0.0)), last=True)


def _relaxed_share(cycle: CycleSolution, criteria: ClosingCriteria) -> float:
    """Return the factor relative to the tolerance that waveform relaxation starts with."""
    return cycle.rtol / (criteria.histories_factor * criteria.rtol)


def _together(task: ClosingTask, start: Start, last: bool) -> CycleSolution | None:
    """Close from the states that the installed life has at the chambers' angles."""
    return close_together(task, chambers_at_pitches(task.machinery))


def _together_again(task: ClosingTask, cycle: CycleSolution, led: CorrectedState | None) -> CycleSolution:
    """Close from the states of a cycle, by a search where a search found it."""
    searched = cycle.needed == FALLBACK_NAME
    found = search_and_close(task, cycle.y.copy(), judged=False) if searched else None
    return found or close_together(task, cycle.y.copy())


def _together_finer(task: ClosingTask, cycle: CycleSolution, most: int) -> CycleSolution | None:
    """Close from the states of a cycle."""
    return close_together(task, cycle.y.copy(), most=most)


WAYS = {
    WAVEFORMS: Way(relax, _relax_again, _relax_finer, _relaxed_share, whole=False, instead="numerics.closing: coupled"),
    # what pitches needed says nothing about waveform relaxation
    TOGETHER: Way(_together, _together_again, _together_finer, lambda cycle, criteria: 1.0, whole=True),
}


def way_of(cycle: CycleSolution) -> Way:
    """Return the way that closed a cycle or failed to close it."""
    return WAYS[cycle.how]


def close_by_ways(task: ClosingTask, start: Start) -> CycleSolution:
    """Close the cycle by its setting's ways in turn; an unclosed attempt before the last is its `abandoned_cycle`."""
    *first, last = (WAYS[name] for name in CLOSINGS[task.criteria.closing].ways)
    left = None
    for way in first:
        found = way.close(task, start, False)
        if found is not None and found.status != NOT_CLOSED:
            return found
        left = found or left
    found = last.close(task, start, True)
    assert found is not None
    return found if left is None else replace(found, abandoned_cycle=left)
