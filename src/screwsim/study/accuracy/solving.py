"""Solving one scene in a stated way: integrator, closing, tolerances, regularisation and knots, each by itself.

`simulate` derives all of these from the wanted accuracy. A study of that accuracy has to set them one by one.
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from screwsim import shaft
from screwsim.build import WIDTH
from screwsim.estimate import Watch
from screwsim.model import close as closing
from screwsim.model.slots import P_INJECTION, P_LIFE, P_PITCH
from screwsim.numerics.integrators import DEFAULT, check_of
from screwsim.outputs import Figures
from screwsim.scene import Scene
from screwsim.solution import Solution

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
    landing: bool = True  # do steps end on the knots of the laws?


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

    solution: Solution
    closed: closing.Closed
    time: float
    evaluations: int
    steps: int

    def figures(self) -> Figures:
        """Return the performance figures."""
        return self.solution.figures(self.closed.q)[0]

    def traces(self) -> dict[str, np.ndarray]:
        """Return the cycle over the angle."""
        return self.solution.cycle(self.closed.q)


@contextmanager
def limited(machinery: Any, seconds: float) -> Iterator[None]:
    """Raise WorkLimit inside this block when the processor time [s] is used up; compilation does not count."""
    end = time.process_time() + seconds - machinery.compile_time

    def watch() -> None:
        if time.process_time() > end + machinery.compile_time:
            raise WorkLimit(f"not closed within its limit of {seconds:g} s of processor time")

    machinery.watch = watch
    try:
        yield
    finally:
        machinery.watch = lambda: None
        machinery.integrator = DEFAULT


def solve(scene: Scene, how: Way, limit: float = math.inf, solution: Solution | None = None) -> Solved:
    """Return the scene solved that way. Raises WorkLimit after `limit` seconds.

    scipy's integrators start from a loose cycle (`START`) of our own, whose cost is counted; so does ours when it is
    `closing: coupled`, for which that is the rule.
    """
    scene = replace(scene, numerics=replace(scene.numerics, integrator=how.integrator))
    solution = solution or shaft.at_its_speed(Solution(scene))
    machinery = solution.machinery
    machinery.warm_up(solution.rehearse)
    composition = machinery.composition
    machinery.composition = replace(composition, P=composition.P.copy(), knots=_knots(composition, how.landing))
    at = solution.lines
    gaps = max(at.p_s, at.p_d)  # of gaps and of ports to plenums of effects
    pressures = np.array([at.p_s, at.p_d, *(gaps for _ in range(composition.n_widths - 2))])
    widths = max(how.regularised, NARROWEST) * pressures
    wanted = closing.Wanted(how.rtol, how.tolerance, how.bound, how.closing)
    scipys = check_of(how.integrator) is not None
    solution.wanted = closing.Wanted(0.3 * START, 0.2 * START, START, "auto") if scipys else wanted
    machinery.composition.P[composition.widths] = START * pressures if scipys else widths
    watch = Watch(machinery)
    with limited(machinery, limit), warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # explicit methods overflow on their way to a shorter step
        try:
            closed = shaft.settled(solution, closing.close(solution, solution.start()))
            if scipys and closed.status != "failed":
                solution.wanted = wanted
                machinery.composition.P[composition.widths] = widths
                machinery.integrator = how.integrator
                closed = closing.by_coupling(solution, closing.chambers_at_pitches(machinery))
                closed = shaft.settled(solution, closed)
        finally:
            watch.lap("closing")
    counts = watch.counts["closing"]
    evaluations = machinery.evaluations_of(counts)
    return Solved(solution, closed, watch.times["closing"], evaluations, int(counts[0]))


def _knots(composition: Any, landing: bool) -> np.ndarray:
    """Return the angles to land on: all, or only those where chambers are born, end, and oil comes in."""
    if landing:
        return composition.knots
    P = composition.P
    jumps = np.append(np.arange(0.0, P[P_LIFE], P[P_PITCH]), (P[P_INJECTION], P[P_LIFE]))
    near = np.abs(composition.knots[:, None] - jumps[None, :]).min(axis=1) < 1e-6
    return composition.knots[near]
