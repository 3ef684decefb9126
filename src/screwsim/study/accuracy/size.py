"""Time over size: points of a sweep, and male lobes."""

import statistics
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from screwsim.machine.kinds import twin_screw
from screwsim.scene import Scene, scene_text, with_values
from screwsim.scene.checks import cross_check
from screwsim.simulate import simulate
from screwsim.study.accuracy.cases import Extent
from screwsim.study.sweep import run_sweep

SPREAD = 0.2  # of the speed, up and down, over which a sweep's points lie


@dataclass(frozen=True)
class Size:
    """A size, its wall time [s] and evaluations; `reason` says why there is no time."""

    size: int
    time: float = np.nan
    evaluations: int = 0
    reason: str = ""


def sweep_times(scene: Scene, points: int) -> Size:
    """Return the wall time of a whole sweep over the speed, worker processes and file included."""
    low, high = (1.0 - SPREAD, 1.0 + SPREAD) if points > 1 else (1.0, 1.0)
    speeds = tuple(float(each) for each in scene.operation.speed * np.linspace(low, high, points))
    swept = replace(scene, sweep={"operation.speed": speeds})
    swept = replace(swept, text=scene_text(swept))
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        run_sweep(swept, Path(folder) / "sweep.h5")
        return Size(points, time.perf_counter() - started)


def lobe_times(scene: Scene, lobes: int, extent: Extent) -> Size:
    """Return the median time of one point with another number of male lobes, as many of the female rotor more."""
    machine = twin_screw(scene.machine)
    female = lobes + machine.female_lobes - machine.male_lobes
    other = with_values(scene, {"machine.male_lobes": lobes, "machine.female_lobes": female})
    faults = cross_check(other)
    if faults:
        return Size(lobes, reason=str(faults[0]))
    results = [simulate(other, trace=False) for _ in range(min(extent.runs, 5) + 1)][1:]
    last = results[-1]
    if last.status != "ok":
        return Size(lobes, reason=last.told)
    seconds = statistics.median(each.numerics.wall_time + each.numerics.estimating_time for each in results)
    return Size(lobes, seconds, int(last.numerics.rhs_evaluations))
