"""What an estimate of the errors brings: the contract between one that finds finer solutions and what reads them.

An estimate is asked of a closed cycle, on which the machinery stands, and returns the figures of one or more solutions
with finer steps and a narrower regularisation; `solve.estimate` makes errors of what these change. Which are asked, one
after the other, a scene's `numerics.error` says (`numerics.estimates`).
"""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution, Led, Wanted
from screwsim.cycle.ways import way_of
from screwsim.evaluate.evaluation import Evaluation
from screwsim.model.run import Machinery
from screwsim.outputs import Figures

FINER = 0.25  # tolerance of a step in the turn that estimates the error
NARROWER = 0.25  # regularisation in that turn
BARELY = 0.03  # volumetric efficiency below which what leaks hide of an error is told by chambers closed together alone


class Asked(NamedTuple):
    """A closed cycle whose errors are asked for, its evaluation, the machinery that stands on it, what is `wanted`."""

    of: Evaluation
    machinery: Machinery
    wanted: Wanted
    cycle: CycleSolution

    @property
    def problem(self) -> Problem:
        """What the cycle solves."""
        return self.of.problem

    @property
    def filling(self) -> float:
        """The volumetric efficiency, 1 where it is not defined."""
        found = self.of.figures.get("volumetric_efficiency")
        return 1.0 if found is None else found

    @property
    def hidden(self) -> bool:
        """Would lives among the closed cycle's repeat its error, as turns that had to be corrected close it?

        Where nothing is delivered all that a chamber holds comes from the others, whose errors a correction leaves.
        """
        return not way_of(self.cycle).whole and self.cycle.tangents is not None and self.filling < BARELY


class Finer(NamedTuple):
    """Figures of finer solutions, one made from the other; `enough`: they tell what all later ones would make.

    `left`: of the first one's change, what Newton's correction left to the second. The last may be no life but what a
    correction makes of the one before: `flow` is what it changes of the net flow, `led` where the machinery stands
    then. `cycle` is the finer one that a search closed, on which it stands.
    """

    figures: Sequence[Figures]
    enough: bool = True
    left: float | None = None
    flow: float = 0.0
    led: Led | None = None
    cycle: CycleSolution | None = None


NOTHING = Finer((), enough=False)


class Estimate(Protocol):
    """One way to find finer solutions."""

    def __call__(self, asked: Asked) -> Finer:
        """Return finer solutions beside a closed cycle; NOTHING where it is not for this cycle, or found none.

        The estimate that is asked next begins where the machinery stands then.
        """
        ...
