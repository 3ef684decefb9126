"""What each effect costs in time and evaluations, and what it changes in the answer."""

import statistics
from dataclasses import dataclass, replace

import numpy as np

from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.scene.checks import cross_check
from screwsim.simulate import simulate
from screwsim.study.accuracy.cases import Extent

NOTHING = 1e-6  # of a figure with the effect: what is left without it is rounding


@dataclass(frozen=True)
class EffectCost:
    """One effect, simulated over left out: relative cost, and the change that it makes; NaN where there is none."""

    effect: str
    status: str
    time: float = np.nan  # with over without, less one
    evaluations: float = np.nan
    efficiency: float = np.nan  # points of the isothermal, or else of the isentropic efficiency
    shaft_power: float = np.nan  # relative
    gas_mass_flow: float = np.nan  # relative
    discharge_temperature: float = np.nan  # [K]
    cooling_capacity: float = np.nan  # relative
    cop: float = np.nan  # relative; where a motor is simulated in one of both, on the electrical power
    reason: str = ""


def effect_costs(scene: Scene, name: str, extent: Extent) -> EffectCost:
    """Return what one effect costs and changes: runs with it and without it in turn, medians of both.

    The first two compile what is missing and count only where no more are wanted; where one of them does not close,
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
    one, other = _both(full, less, "discharge_temperature")
    costs = EffectCost(name, "ok", ratio, evaluations, _points(full, less), discharge_temperature=one - other)
    one, other = _both(full, less, "electrical_cop", "cop")  # on the power that the machine takes
    return replace(costs, **relative, cop=one / other - 1.0)


def _time(result: Result) -> float:
    return result.numerics.wall_time + result.numerics.estimating_time


def _both(full: Result, less: Result, name: str, instead: str = "") -> tuple[float, float]:
    """Return a figure, or another in its place, with and without the effect; NaN where one of both lacks it."""
    one, other = (each.performance.get(name) or each.performance.get(instead or name) for each in (full, less))
    return (np.nan, np.nan) if one is None or other is None else (one, other)


def _points(full: Result, less: Result) -> float:
    pairs = (_both(full, less, name) for name in ("isothermal_efficiency", "isentropic_efficiency"))
    return next((100.0 * (one - other) for one, other in pairs if not np.isnan(one)), np.nan)


def _relative(full: Result, less: Result, name: str) -> float:
    """Return a figure over that without the effect, less one; NaN where next to nothing is left without it."""
    one, other = _both(full, less, name)
    return one / other - 1.0 if abs(other) > NOTHING * abs(one) else np.nan
