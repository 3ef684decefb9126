"""The contract of an error estimate: how finer solutions are asked for and returned.

An estimate receives a closed cycle, which the machinery holds, and returns the figures of one or more solutions with
finer steps and a narrower regularisation; `solve.estimate` turns their changes into errors. `numerics.error` of a scene
says which estimates are tried in turn (`numerics.settings`).
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from screwsim.cycle.linear_pitch import Tangents
from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import ClosingCriteria, CorrectedState, CycleSolution
from screwsim.cycle.ways import way_of
from screwsim.evaluate.evaluation import Evaluation
from screwsim.model.run import Machinery
from screwsim.outputs import Figures
from screwsim.solve.swings import Solution

Array = np.ndarray
FINER = 0.25  # factor on the tolerance of a step in a life that estimates errors
NARROWER = 0.25  # factor on the regularisation in such a life
BARELY_DELIVERS = 0.03  # volumetric efficiency below which only simultaneous closing shows errors that leaks hide


class EstimateRequest(NamedTuple):
    """A closed cycle whose errors are to be estimated: evaluation, machinery that holds it, criteria, the cycle.

    `lent` is the linearisation of a nearby cycle's finer life.
    """

    of: Evaluation
    machinery: Machinery
    criteria: ClosingCriteria
    cycle: CycleSolution
    lent: Tangents | None = None

    @property
    def problem(self) -> Problem:
        """The problem that the cycle solves."""
        return self.of.problem

    @property
    def filling(self) -> float:
        """The volumetric efficiency, 1 where it is not defined.

        Of an expander its filling factor, or the inverse: more than fills the chambers leaks past them.
        """
        found = self.of.figures.get("volumetric_efficiency")
        if found is not None:
            return found
        filled = self.of.figures.get("filling_factor") or 0.0
        return min(filled, 1.0 / filled) if filled > 0.0 else 1.0

    @property
    def hidden(self) -> bool:
        """Whether further lives among the closed cycle's would only repeat its error.

        That is so where next to nothing is delivered and turns had to be corrected: a chamber then holds what
        it got from the others, whose errors a correction leaves.
        """
        if way_of(self.cycle).whole or self.problem.parts.geometry.expands:
            return False
        return self.cycle.tangents is not None and self.filling < BARELY_DELIVERS


class FinerSolutions(NamedTuple):
    """Consecutive finer solutions; `enough`: they determine the limit of all later ones.

    `changes` are the relative changes of the figures to each of them from the one before, first the closed cycle
    (empty: not known yet).

    `left` is the share of the first one's change that Newton's correction left to the second. The last entry may be
    read from a correction instead of a life: `flow` is then its change of the net flow, `corrected_state` where the
    machinery stands. `to_come` is by how much a further correction of the last life would move gas, work and unknowns,
    `flow` then the net flow. `cycle` is the finer cycle that a search closed, which the machinery then holds. `q` are
    the quadratures of one that all chambers together closed, `tangents` the linearisation that corrected a life.
    """

    solutions: Sequence[Solution]
    enough: bool = True
    left: float | None = None
    flow: float = 0.0
    corrected_state: CorrectedState | None = None
    cycle: CycleSolution | None = None
    q: Array | None = None
    changes: Sequence[Figures] = ()
    tangents: Tangents | None = None
    to_come: float = 0.0


NO_SOLUTIONS = FinerSolutions((), enough=False)

# returns finer solutions near a closed cycle, NO_SOLUTIONS where it does not apply or found none; the next estimate
# starts from where the machinery then stands
Estimate = Callable[[EstimateRequest], FinerSolutions]
