"""What a user gets who asks for an accuracy: `simulate` as it is, with its estimate, against the reference."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass, replace

from screwsim.errors import relative_errors, worst
from screwsim.numerics.integrators import DEFAULT
from screwsim.scene import Scene
from screwsim.simulate import simulate
from screwsim.study.accuracy.cases import Extent
from screwsim.study.accuracy.measure import Truth


@dataclass(frozen=True)
class Asked:
    """An accuracy asked for: what it costs [s], what the solver estimates, what is true."""

    asked: float
    status: str
    closing: str
    time: float
    estimating_time: float
    evaluations: int
    estimated: float
    error: float
    figure: str


def as_asked(scene: Scene, accuracy: float, reference: Truth, extent: Extent) -> Asked:
    """Return what asking for this accuracy gives."""
    numerics = replace(scene.numerics, accuracy=accuracy, integrator=DEFAULT, rtol=None, error="estimate")
    wanted = replace(scene, numerics=numerics)
    results = [simulate(wanted, trace=False)]
    spent = 0.0
    while len(results) <= extent.runs and spent < extent.seconds:
        results.append(simulate(wanted, trace=False))
        spent += results[-1].numerics.wall_time + results[-1].numerics.estimating_time
    timed = results[1:] or results
    last = results[-1]
    name, error = "", math.nan
    if last.performance:
        name, error = worst(relative_errors(last.performance, reference.figures))
    return Asked(
        accuracy,
        last.status,
        last.numerics.closing,
        statistics.median(each.numerics.wall_time for each in timed),
        statistics.median(each.numerics.estimating_time for each in timed),
        int(last.numerics.rhs_evaluations),
        worst(last.error)[1] if any(size is not None for size in last.error.values()) else math.nan,
        error,
        name,
    )
