"""A point as a program asks for it: simulated, and the derivatives of its figures when they are asked for."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from screwsim.inputs.arguments import one_of, takes
from screwsim.outputs import Result
from screwsim.outputs.derivatives import Derivatives
from screwsim.scene.given import scene_of
from screwsim.scene.types import Scene
from screwsim.simulate import Trace
from screwsim.simulate import simulate as simulated


@takes(trace=one_of(True, False, "ledger"))
def simulate(scene: Scene | str | os.PathLike[str] | Mapping[str, Any], trace: Trace = True) -> Result:
    """Return the result of one scene; impossible physics gives a status and a partial result, never an exception.

    The scene is one of `load`, the path of its file, its YAML text, or a dict as in the file.
    `trace` keeps the cycle over the angle and the ledger, 'ledger' that alone; the ledger is left out without it where
    the scene says `numerics.error: none`. `result.derivatives` are found when they are asked for. Raises UsageError
    when the scene asks for a fluid that is not there.
    """
    scene = scene_of(scene)
    result = simulated(scene, trace)
    return replace(result, derivatives=Derivatives(partial(_found, scene, result), result.performance, scene))


def _found(scene: Scene, result: Result) -> Any:
    from screwsim.study.local import sensitivities

    return sensitivities(scene, result=result)
