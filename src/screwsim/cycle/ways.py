"""The ways to close a cycle, and what depends on the way that closed it.

`cycle.how` is the name of that way; whatever depends on it is asked of the `Way`, nowhere else. A further way is a
`Way` in `WAYS` and an entry of `numerics.settings`.

Source: docs/explanation/closing.md.
"""

from abc import ABC, abstractmethod
from dataclasses import replace

from screwsim.cycle.problem import ClosingTask
from screwsim.cycle.relaxation import relax
from screwsim.cycle.search import FALLBACK_NAME, search_and_close
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.solution import ClosingCriteria, CorrectedState, CycleSolution, Expectation, Start
from screwsim.model.slots import Q_WORK, R_TRAPPED
from screwsim.numerics.settings import CLOSINGS, TOGETHER, WAVEFORMS
from screwsim.outputs.variables import NOT_CLOSED


class Way(ABC):
    """A way to close a cycle.

    `whole`: a turn integrates all chambers, so that feedback through the others shows within it; otherwise one life
    among stored ones. `instead` is the setting to suggest where this way closes no cycle.
    """

    whole: bool
    instead: str = ""

    @abstractmethod
    def close(self, task: ClosingTask, start: Start, last: bool) -> CycleSolution | None:
        """Close the cycle from a start; None or an unclosed cycle hands over to the next way (never None if `last`)."""

    @abstractmethod
    def again(self, task: ClosingTask, cycle: CycleSolution, led: CorrectedState | None) -> CycleSolution:
        """Close a cycle that this way has closed once more, from where finer lives have moved it, if given."""

    @abstractmethod
    def finer(self, task: ClosingTask, cycle: CycleSolution, most: int) -> CycleSolution | None:
        """Close a cycle with finer steps, within `most` evaluations where the number is not bounded otherwise."""

    @abstractmethod
    def share(self, cycle: CycleSolution, criteria: ClosingCriteria) -> float:
        """Return the factor on the wanted tolerance of a step with which the balances closed."""


class WaveformRelaxation(Way):
    """Waveform relaxation: one chamber's life is integrated among stored earlier ones."""

    whole = False
    instead = "numerics.closing: coupled"

    def close(self, task: ClosingTask, start: Start, last: bool) -> CycleSolution | None:
        """Relax until that has cost as much as simultaneous closing would."""
        return relax(task, start, last)

    def again(self, task: ClosingTask, cycle: CycleSolution, led: CorrectedState | None) -> CycleSolution:
        """Relax from the cycle, or from where its finer lives have moved it, with steps no coarser than before."""
        y, seen = led or (cycle.y, cycle.seen)
        share = min(1.0, self.share(cycle, task.criteria))
        expected = Expectation(seen, 0.0, share, cycle.contraction, cycle.missed)
        return close_by_ways(task, Start(y, expected, cycle.tangents))

    def finer(self, task: ClosingTask, cycle: CycleSolution, most: int) -> CycleSolution | None:
        """Relax from the machinery's last life; relaxation bounds its own length."""
        seen = float(task.machinery.R[R_TRAPPED]), float(cycle.q[Q_WORK])  # the last life's mass
        return relax(task, Start(cycle.y, Expectation(seen, 0.0)), last=True)

    def share(self, cycle: CycleSolution, criteria: ClosingCriteria) -> float:
        """Return the factor relative to the tolerance that waveform relaxation starts with."""
        return cycle.rtol / (criteria.histories_factor * criteria.rtol)


class SimultaneousClosing(Way):
    """Simultaneous closing: all chambers are integrated together over a pitch."""

    whole = True

    def close(self, task: ClosingTask, start: Start, last: bool) -> CycleSolution | None:
        """Close from the states that the installed life has at the chambers' angles."""
        return close_together(task, chambers_at_pitches(task.machinery))

    def again(self, task: ClosingTask, cycle: CycleSolution, led: CorrectedState | None) -> CycleSolution:
        """Close from the states of the cycle, by a search where a search found it."""
        found = None
        if cycle.needed == FALLBACK_NAME:
            found = search_and_close(task, cycle.y.copy(), judged=False)
        return found or close_together(task, cycle.y.copy())

    def finer(self, task: ClosingTask, cycle: CycleSolution, most: int) -> CycleSolution | None:
        """Close from the states of the cycle."""
        return close_together(task, cycle.y.copy(), most=most)

    def share(self, cycle: CycleSolution, criteria: ClosingCriteria) -> float:
        """Return 1: what pitches needed says nothing about waveform relaxation."""
        return 1.0


WAYS: dict[str, Way] = {WAVEFORMS: WaveformRelaxation(), TOGETHER: SimultaneousClosing()}


def way_of(cycle: CycleSolution) -> Way:
    """Return the way that closed a cycle or failed to close it."""
    return WAYS[cycle.how]


def close_by_ways(task: ClosingTask, start: Start) -> CycleSolution:
    """Close the cycle by its setting's ways in turn; an unclosed attempt before the last is its `abandoned_cycle`."""
    *first, last = (WAYS[name] for name in CLOSINGS[task.criteria.closing].ways)
    left = None
    for way in first:
        found = way.close(task, start, last=False)
        if found is not None and found.status != NOT_CLOSED:
            return found
        left = found or left
    found = last.close(task, start, last=True)
    assert found is not None
    return found if left is None else replace(found, abandoned_cycle=left)
