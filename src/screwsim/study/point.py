"""One operating point for programs: simulated, with derivatives on demand or where the scene keeps them."""

import os
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from screwsim.inputs.arguments import checked_arguments, one_of
from screwsim.outputs import Result
from screwsim.outputs.derivatives import Derivatives
from screwsim.scene.load import scene_of
from screwsim.scene.types import Scene
from screwsim.simulate import Trace
from screwsim.simulate import simulate as simulated
from screwsim.study.local import Sensitivities, sensitivities


@checked_arguments(trace=one_of(True, False, "ledger"))
def simulate(scene: Scene | str | os.PathLike[str] | Mapping[str, Any], trace: Trace = True) -> Result:
    """Return the result of one scene; impossible physics gives a status and a partial result, never an exception.

    The scene is what `load` returns, the path of a file, YAML text, or a dict laid out as the file is. With `trace` the
    result has the cycle over the angle and the ledger, with 'ledger' the ledger alone; without it the ledger is left
    out where the scene says `numerics.error: none`. `result.derivatives` are computed on first use. Raises UsageError
    when the scene asks for a fluid that is not available.
    """
    scene = scene_of(scene)
    result = simulated(scene, trace)
    return replace(
        result, derivatives=Derivatives(partial(sensitivities, scene, result=result), result.performance, scene)
    )


def kept_slopes(scene: Scene, result: Result) -> Sensitivities | None:
    """Return the derivatives of a result that its scene keeps (`output.derivatives`); None for none."""
    if not scene.output.keeps_slopes or result.status != "ok":
        return None
    found = sensitivities(scene, result=result)
    return found if found.derivatives else None


def save_point(file: Path, scene: Scene, result: Result) -> None:
    """Write a result to a file, with the derivatives that its scene keeps."""
    from screwsim.results import save

    save(file, scene, result, derivatives=kept_slopes(scene, result))


def with_slopes(scene: Scene, result: Result) -> Result:
    """Return a result together with the derivatives that its scene keeps."""
    found = kept_slopes(scene, result)
    return result if found is None else replace(result, derivatives=Derivatives.of(found, result.performance))
