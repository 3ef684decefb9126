"""The collocated cycle of a shipped point, as tests of derivatives look at it."""

from pathlib import Path

import screwsim
from screwsim.cycle.guess import leased
from screwsim.cycle.problem import Series, problem_of
from screwsim.derivatives.closed import FINE, Closed, Fineness, collocated
from screwsim.scene import Scene
from screwsim.solve.circuit import solved, steady

CONFIGS = Path(__file__).parents[2] / "configs"


def closed_point(machine: str, fineness: Fineness = FINE) -> Closed:
    """Return the collocated cycle of the point of a machine in `configs`."""
    return closed_scene(screwsim.load(CONFIGS / machine / "point.yaml"), fineness)


def closed_scene(scene: Scene, fineness: Fineness) -> Closed:
    """Return the collocated cycle of a scene."""
    series = Series()
    problem, search = steady(problem_of(scene, series), series)
    machinery = leased(problem)
    of = solved(problem, machinery, None, search).evaluation
    return collocated(of.problem, machinery, of.life, fineness)
