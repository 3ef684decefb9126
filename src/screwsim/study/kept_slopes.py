"""Derivatives that a results file keeps: those of a run and of each point of a sweep, where the scene asks for them."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from itertools import tee

from screwsim.outputs import Result
from screwsim.outputs.derivatives import Derivatives
from screwsim.scene.types import Scene
from screwsim.study.local import Sensitivities, sensitivities


def kept_slopes(scene: Scene, result: Result) -> Sensitivities | None:
    """Return the derivatives of a result that its scene keeps (`output.derivatives`), None for none."""
    if not scene.output.keeps_slopes or result.status != "ok":
        return None
    found = sensitivities(scene, result=result)
    return found if found.derivatives else None


def with_slopes(scene: Scene, result: Result) -> Result:
    """Return a result with the derivatives that its scene keeps."""
    found = kept_slopes(scene, result)
    return result if found is None else replace(result, derivatives=Derivatives.of(found, result.performance))


def simulate_with_slopes(
    many: Callable[[Iterable[Scene]], Iterator[Result]], scenes: Iterable[Scene]
) -> Iterator[Result]:
    """Yield the results of consecutive scenes by what simulates them, each with its derivatives."""
    first, second = tee(scenes)
    for result in many(first):
        yield with_slopes(next(second), result)
