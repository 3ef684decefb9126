"""The collocated cycle of a shipped point, as tests of derivatives look at it."""

from pathlib import Path

import screwsim
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import Series, problem_of
from screwsim.derivatives.collocated_cycle import CollocatedCycle
from screwsim.derivatives.collocation import FINE, Fineness, collocated
from screwsim.scene import Scene
from screwsim.solve.circuit import solve_with_surroundings, steady_state

CONFIGS = Path(__file__).parents[2] / "configs"


def closed_point(machine: str, fineness: Fineness = FINE) -> CollocatedCycle:
    """Return the collocated cycle of the point of a machine in `configs`."""
    return closed_scene(screwsim.load(CONFIGS / machine / "point.yaml"), fineness)


def closed_scene(scene: Scene, fineness: Fineness) -> CollocatedCycle:
    """Return the collocated cycle of a scene."""
    series = Series()
    problem, search = steady_state(problem_of(scene, series), series)
    machinery = lease_for(problem)
    of = solve_with_surroundings(problem, machinery, None, search).evaluation
    return collocated(of.problem, machinery, of.life, fineness)
