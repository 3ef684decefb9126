"""Cost of each effect in time and evaluations and its influence on the results; cost of size."""

import statistics
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from screwsim.inputs.faults import SceneError, UsageError
from screwsim.machine.kinds import twin_screw
from screwsim.outputs import Result
from screwsim.scene import Scene, scene_text, with_values
from screwsim.scene.checks import cross_check
from screwsim.simulate import simulate
from screwsim.study.accuracy.solving import Scope
from screwsim.study.sweep import run_sweep

SPEED_RANGE = 0.2  # of the speed, up and down: range of a sweep's points
NEGLIGIBLE = 1e-6  # of a figure with the effect: a smaller rest without it is rounding


@dataclass(frozen=True)
class EffectCost:
    """One effect, simulated over left out: relative cost, and the change of results; NaN for missing values."""

    effect: str
    status: str
    time: float = np.nan  # with over without the effect, less one
    evaluations: float = np.nan
    efficiency: float = np.nan  # percentage points of the isothermal, or else of the isentropic efficiency
    shaft_power: float = np.nan  # relative
    gas_mass_flow: float = np.nan  # relative
    discharge_temperature: float = np.nan  # [K]
    cooling_capacity: float = np.nan  # relative
    cop: float = np.nan  # relative; on the electrical power where either scene has a motor
    reason: str = ""


def effect_costs(scene: Scene, name: str, extent: Scope) -> EffectCost:
    """Return cost and influence of one effect: medians over alternating runs with it and without it.

    The first two runs compile missing code and count only where no more are wanted; if one of them does not close,
    there are no more.
    """
    rest = {key: active for key, active in scene.effects.items() if key != name}
    without = replace(scene, effects=rest, text="")
    faults = cross_check(without)
    if faults:
        return EffectCost(name, "needed", reason=str(faults[0]))
    try:
        full, less = simulate(scene, trace=False), simulate(without, trace=False)
    except (SceneError, UsageError) as error:
        return EffectCost(name, "needed", reason=" ".join(str(error).split()))
    if less.status != "ok" or full.status != "ok":
        bad = less if less.status != "ok" else full
        return EffectCost(name, bad.status, reason=f"without it: {bad.message}")
    pairs = [(simulate(scene, trace=False), simulate(without, trace=False)) for _ in range(extent.pairs)]
    pairs = pairs or [(full, less)]
    full, less = pairs[-1]
    ratio = statistics.median(_time(full) / _time(less) for full, less in pairs) - 1.0
    evaluations = full.numerics.rhs_evaluations / less.numerics.rhs_evaluations - 1.0
    relative = {each: _relative(full, less, each) for each in ("shaft_power", "gas_mass_flow", "cooling_capacity")}
    one, other = _with_and_without(full, less, "discharge_temperature")
    costs = EffectCost(name, "ok", ratio, evaluations, _points(full, less), discharge_temperature=one - other)
    one, other = _with_and_without(full, less, "electrical_cop", "cop")  # on the power that the machine takes
    return replace(costs, **relative, cop=one / other - 1.0)


def _time(result: Result) -> float:
    return result.numerics.wall_time + result.numerics.estimating_time


def _with_and_without(full: Result, less: Result, name: str, instead: str = "") -> tuple[float, float]:
    """Return a figure, or another in its place, with and without the effect; NaN where either lacks it."""
    one, other = (each.performance.get(name) or each.performance.get(instead or name) for each in (full, less))
    return (np.nan, np.nan) if one is None or other is None else (one, other)


def _points(full: Result, less: Result) -> float:
    pairs = (_with_and_without(full, less, name) for name in ("isothermal_efficiency", "isentropic_efficiency"))
    return next((100.0 * (one - other) for one, other in pairs if not np.isnan(one)), np.nan)


def _relative(full: Result, less: Result, name: str) -> float:
    """Return a figure over that without the effect, less one; NaN where next to nothing is left without it."""
    one, other = _with_and_without(full, less, name)
    return one / other - 1.0 if abs(other) > NEGLIGIBLE * abs(one) else np.nan


@dataclass(frozen=True)
class SizeCost:
    """A size, its wall time [s] and evaluations; `reason` says why there is no time."""

    size: int
    time: float = np.nan
    evaluations: int = 0
    reason: str = ""


def sweep_times(scene: Scene, points: int) -> SizeCost:
    """Return the wall time of a whole sweep over the speed, worker processes and file included."""
    low, high = (1.0 - SPEED_RANGE, 1.0 + SPEED_RANGE) if points > 1 else (1.0, 1.0)
    speeds = tuple(float(each) for each in scene.operation.speed * np.linspace(low, high, points))
    swept = replace(scene, sweep={"operation.speed": speeds})
    swept = replace(swept, text=scene_text(swept))
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        run_sweep(swept, Path(folder) / "sweep.h5")
        return SizeCost(points, time.perf_counter() - started)


def lobe_times(scene: Scene, lobes: int, extent: Scope) -> SizeCost:
    """Return the median time of one point with another number of male lobes, and the female lobes changed equally."""
    machine = twin_screw(scene.machine)
    female = lobes + machine.female_lobes - machine.male_lobes
    other = with_values(scene, {"machine.male_lobes": lobes, "machine.female_lobes": female})
    faults = cross_check(other)
    if faults:
        return SizeCost(lobes, reason=str(faults[0]))
    results = [simulate(other, trace=False) for _ in range(min(extent.runs, 5) + 1)][1:]
    last = results[-1]
    if last.status != "ok":
        return SizeCost(lobes, reason=last.told)
    seconds = statistics.median(each.numerics.wall_time + each.numerics.estimating_time for each in results)
    return SizeCost(lobes, seconds, int(last.numerics.rhs_evaluations))
