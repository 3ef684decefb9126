"""Solving one scene in a stated way: integrator, closing, tolerances, regularisation and breakpoints, each by itself.

`simulate` derives all of these from the wanted accuracy. A study of that accuracy has to set them one by one.
"""

import math
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from screwsim.build import WIDTH
from screwsim.cycle.close import close
from screwsim.cycle.guess import rehearse
from screwsim.cycle.problem import Series, problem_of
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.solution import CycleSolution, Wanted
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.model import leases
from screwsim.model.composition import Composition
from screwsim.model.run import Machinery
from screwsim.model.slots import P_INJECTION, P_LIFE, P_PITCH
from screwsim.numerics.compiling import seconds_again
from screwsim.numerics.integrators import DEFAULT, check_of
from screwsim.numerics.rodas import TAKEN
from screwsim.scene import Scene
from screwsim.solve.accurately import Watch
from screwsim.solve.circuit import steady
from screwsim.solve.drive import settled

START = 1e-2  # accuracy of the cycle from which scipy's integrators start
NARROWEST = 1e-12  # of a pressure: stands for a regularisation of zero, of which the model would divide 0 by 0


class WorkLimit(Exception):
    """The time allowed is used up."""


@dataclass(frozen=True)
class Way:
    """How a scene is solved. `regularised` times the pressure of a line is the width ε of the regularisation there."""

    integrator: str = DEFAULT
    closing: str = "histories"
    rtol: float = 1e-4
    tolerance: float = 1e-4
    bound: float = 1e-3
    regularised: float = 1.5e-4
    landing: bool = True  # do steps end on the breakpoints of the laws?


def way(accuracy: float, integrator: str = DEFAULT, closing: str = "coupled", **others: Any) -> Way:
    """Return the way that follows from a wanted accuracy (docs/explanation/numerics.md), but for what `others` say."""
    known: dict[str, Any] = {
        "rtol": 0.3 * accuracy,
        "tolerance": 0.2 * accuracy,
        "bound": accuracy,
        "regularised": WIDTH * accuracy,
    }
    return Way(integrator, closing, **(known | others))


@dataclass(frozen=True)
class Solved:
    """A solution with its cost: wall time [s] of the closing and evaluations of one chamber's right-hand side."""

    cycle: CycleSolution
    evaluation: Evaluation
    time: float
    evaluations: int
    steps: int


@contextmanager
def limited(machinery: Machinery, seconds: float) -> Iterator[None]:
    """Raise WorkLimit inside this block when the processor time [s] is used up; compilation does not count."""
    end = time.process_time() + seconds - machinery.compile_time - seconds_again()

    def watch() -> None:
        if time.process_time() > end + machinery.compile_time + seconds_again():
            raise WorkLimit(f"not closed within its limit of {seconds:g} s of processor time")

    machinery.watch = watch
    try:
        yield
    finally:
        machinery.watch = lambda: None


def solve(scene: Scene, how: Way, limit: float = math.inf, machinery: Machinery | None = None) -> Solved:
    """Return the scene solved that way. Raises WorkLimit after `limit` seconds.

    scipy's integrators start from a loose cycle (`START`) of our own, whose cost is counted; so does ours when it is
    `closing: coupled`, for which that is the rule. `machinery` is one of the scene's, or it is lent one.
    """
    series = Series()
    scene = replace(scene, numerics=replace(scene.numerics, integrator=how.integrator))
    problem, _ = steady(problem_of(scene, series), series)
    composition = replace(problem.composition, breakpoints=_breakpoints(problem.composition, how.landing))
    at, check = problem.lines, check_of(how.integrator)
    own = max(at.p_s, at.p_d)  # of ports to plenums of effects; that of gaps goes with the pressures at their ends
    pressures = np.array([at.p_s, at.p_d, 1.0, *(own for _ in range(composition.n_widths - 3))])
    widths = tuple((max(how.regularised, NARROWEST) * pressures).tolist())
    wanted = Wanted(how.rtol, how.tolerance, how.bound, how.closing, widths, check=check)
    loose = Wanted(0.3 * START, 0.2 * START, START, "auto", tuple((START * pressures).tolist()))
    problem = replace(problem, composition=composition, wanted=wanted)
    lent = machinery is None
    machinery = machinery or leases.lease(composition)
    machinery.begin(composition)
    machinery.warm_up(lambda: rehearse(problem, machinery))
    watch = Watch(machinery)
    with limited(machinery, limit), warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # explicit methods overflow on their way to a shorter step
        first = wanted if check is None else loose
        cycle = settled(problem, machinery, first, close(problem, machinery, first))
        if check is not None and not cycle.failed:
            cycle = close_together(problem, machinery, wanted, chambers_at_pitches(machinery))
            cycle = settled(problem, machinery, wanted, cycle)
    watch.lap("closing")
    counts, evaluations = watch.counts["closing"], machinery.evaluations_of(watch.counts["closing"])
    if lent:
        leases.give_back(machinery)
    return Solved(cycle, evaluate(problem, cycle), watch.times["closing"], evaluations, int(counts[TAKEN]))


def _breakpoints(composition: Composition, landing: bool) -> np.ndarray:
    """Return the angles to land on: all, or only those where chambers are born, end, and oil comes in."""
    if landing:
        return composition.breakpoints
    P = composition.P
    jumps = np.append(np.arange(0.0, P[P_LIFE], P[P_PITCH]), (P[P_INJECTION], P[P_LIFE]))
    near = np.abs(composition.breakpoints[:, None] - jumps[None, :]).min(axis=1) < 1e-6
    return composition.breakpoints[near]
