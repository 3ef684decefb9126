"""The solution of what a study varies, a scene or two in series, without traces; a failed result where it has none."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from screwsim.figures.errors import error_in_unit
from screwsim.inputs.faults import UsageError, in_one_line
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.study.asked.varied import Varied, accuracy_of, faults_of, with_values
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import WORKER_DIED

Simulate = Callable[[Any], Result]  # of a scene, or of two in series


def solved(of: Varied) -> Result:
    """Return the result of a scene, or the figures of two in series together."""
    from screwsim.simulate import simulate

    return simulate(of, trace=False) if isinstance(of, Scene) else of.solved()


def simulator(warm: Varied | None = None) -> Simulate:
    """Return `solved`; the scene `warm` is compiled before the fork for workers to inherit."""
    from screwsim.simulate import warm_up

    if isinstance(warm, Scene):
        warm_up(warm)
    return solved


def simulated_if_valid(scene: Varied, simulate: Simulate) -> Result:
    """Return the result of a scene; one whose values do not fit together has failed."""
    faults = faults_of(scene)
    if faults:
        return Result("failed", message="; ".join(map(str, faults)))
    try:
        return simulate(scene)
    except (UsageError, ArithmeticError, ValueError) as error:
        return Result("failed", message=in_one_line(error))


def results_at(
    of: Varied, points: Sequence[Mapping[str, Any]], *, jobs: int | None = None, progress: Progress | None = None
) -> list[Result]:
    """Return the results, without traces, of a scene or two stages with the values [SI] of each point, by workers."""
    call, dead = partial(_result_at, of, points), Result("failed", WORKER_DIED)
    return parallel_map(call, len(points), died=lambda number: dead, jobs=jobs, progress=progress)


def _result_at(of: Varied, points: Sequence[Mapping[str, Any]], number: int) -> Result:
    return simulated_if_valid(with_values(of, points[number]), solved)


def absolute_error(result: Result, name: str, scene: Varied) -> float:
    """Return the estimated error of a figure in its own unit; from the wanted accuracy where nothing is estimated."""
    return error_in_unit(name, result.performance, result.error, accuracy_of(scene)) or 0.0
