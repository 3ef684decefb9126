"""Cost of accuracy in time: the work-precision study of one scene."""

import math
import statistics
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.codegen.modules import for_speed
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.machine.kinds import kind_of, twin_screw
from screwsim.machine.protocol import ROTORS
from screwsim.outputs import Result
from screwsim.scene import Scene, with_values
from screwsim.scene.checks import cross_check
from screwsim.simulate import simulate
from screwsim.study.accuracy.measure import (
    MeasuredCase,
    NoReference,
    Reference,
    RequestedAccuracy,
    measure,
    one_line,
    reference_of,
    solved_as_requested,
    time_of,
)
from screwsim.study.accuracy.solving import QUICK_SCOPE, Case, Scope, all_cases, omitted_methods
from screwsim.study.asked.varied import with_text
from screwsim.study.pool.progress import Progress
from screwsim.study.sweep import run_sweep

__all__ = ["QUICK_SCOPE", "Case", "MeasuredCase", "NoReference", "Reference", "Scope", "Study", "study"]
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


@dataclass(frozen=True)
class SizeCost:
    """A size, its wall time [s] and evaluations; `reason` says why there is no time."""

    size: int
    time: float = np.nan
    evaluations: int = 0
    reason: str = ""


@dataclass(frozen=True)
class Study:
    """All measurements of one scene."""

    title: str
    accuracy: float
    reference: Reference
    asked: list[RequestedAccuracy]
    measured: list[MeasuredCase]
    effects: list[EffectCost]
    points: list[SizeCost]
    lobes: list[SizeCost]
    left_out: list[tuple[str, str]] = field(default_factory=list)

    @property
    def comparable(self) -> list[MeasuredCase]:
        """The cases that answer the same question: every integrator on the scene's own gas."""
        return [each for each in self.measured if each.part == "integrators"]

    def front(self, cost: str = "time") -> list[MeasuredCase]:
        """Return the closed comparable cases that no other beats in both cost and error, from the cheapest on."""
        best, found = math.inf, []
        closed = (each for each in self.comparable if each.status == "ok")
        for each in sorted(closed, key=lambda each: (getattr(each, cost), each.error)):
            if each.error < best:
                best = each.error
                found.append(each)
        return found

    @property
    def limit_of_regularisation(self) -> float | None:
        """The error due to the regularisation at the scene's accuracy when all else is tight."""
        alone = (each for each in self.measured if each.part == "regularisation alone" and each.status == "ok")
        return next((each.error for each in alone if each.factor == 1.0), None)


@for_speed()  # times are measured
def study(scene: Scene, extent: Scope | None = None, progress: Progress | None = None) -> Study:
    """Return the study of a scene. Raises NoReference where no reference closes."""
    extent, progress = extent or Scope(), progress or Progress()
    cases, effects = all_cases(scene, extent), list(scene.effects)
    lobe_counts = extent.lobes if ROTORS in kind_of(scene.machine).offers else ()
    jobs = 1 + len(cases) + len(extent.asked) + len(effects) + len(extent.points) + len(lobe_counts)
    progress.start(jobs, 0)

    def counted(work: Callable, *arguments):
        found = work(*arguments)
        progress.advance(1, 0)
        return found

    try:
        own = counted(reference_of, scene, extent)
        references = _References(own, extent)
        asks = [accuracy for accuracy in extent.asked if not own.why_not(accuracy)]
        asked = [counted(solved_as_requested, scene, accuracy, own, extent) for accuracy in asks]
        measured = [counted(references.measured, case) for case in cases]
        costs = [counted(effect_costs, scene, name, extent) for name in effects]
        points = [counted(sweep_times, scene, count) for count in extent.points]
        lobes = [counted(lobe_times, scene, count, extent) for count in lobe_counts]
    finally:
        progress.stop()
    bad = [(f"{lobe.size} male lobes", lobe.reason) for lobe in lobes if lobe.reason]
    coarse = [(f"asking for {each:g}", why) for each in extent.asked if (why := own.why_not(each))]
    left_out = [*coarse, *_left_out(measured), *bad, *omitted_methods(scene)]
    return Study(scene.title, scene.numerics.accuracy, own, asked, measured, costs, points, lobes, left_out)


def _left_out(measured: list[MeasuredCase]) -> list[tuple[str, str]]:
    """Return the cases without a good result, those of one label and reason together."""
    found: dict[tuple[str, str], list[str]] = {}
    for each in measured:
        if each.status != "ok":
            text = each.reason if each.status != "failed" else f"failed: {each.reason}"
            found.setdefault((f"{each.part}: {each.label}", text), []).append(f"{each.asked:.0e}")
    return [(f"{name} ({', '.join(asks)})", reason) for (name, reason), asks in found.items()]


class _References:
    """References of a study, computed when they are first needed."""

    def __init__(self, own: Reference, extent: Scope) -> None:
        self.own, self.extent = own, extent
        self.others: dict[tuple[str, float | None], Reference | str] = {}

    def measured(self, case: Case) -> MeasuredCase:
        """Return a case measured against the reference of its own model."""
        if not case.own_reference:
            return measure(case, self.own, self.own, self.extent)
        key = (case.back_end if case.part == "back ends" else case.part, case.factor)
        if key not in self.others:
            self.others[key] = self._other(case.scene)
        reference = self.others[key]
        if isinstance(reference, str):
            head = (case.part, case.label, case.back_end, case.asked, case.factor)
            return MeasuredCase(*head, "left out", reference)
        return measure(case, reference, self.own, self.extent)

    def _other(self, scene: Scene) -> Reference | str:
        """Return the reference of another model, or why there is none."""
        try:
            faults = cross_check(scene)
            if faults:
                return one_line(str(faults[0]))
            first = simulate(scene, trace=False)
            if first.status != "ok":
                return one_line(first.told)
            return reference_of(scene, self.extent, checked=False)
        except (SceneError, UsageError, ValueError, NoReference) as error:
            return one_line(str(error))


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
    ratio = statistics.median(time_of(full) / time_of(less) for full, less in pairs) - 1.0
    evaluations = full.numerics.rhs_evaluations / less.numerics.rhs_evaluations - 1.0
    compared = ("shaft_power", "gas_mass_flow", "cooling_capacity")
    relative: dict[str, Any] = {each: _relative(full, less, each) for each in compared}
    one, other = _with_and_without(full, less, "discharge_temperature")
    costs = EffectCost(name, "ok", ratio, evaluations, _points(full, less), discharge_temperature=one - other)
    one, other = _with_and_without(full, less, "electrical_cop", "cop")  # on the power that the machine takes
    return replace(costs, **relative, cop=one / other - 1.0)


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


def sweep_times(scene: Scene, points: int) -> SizeCost:
    """Return the wall time of a whole sweep over the speed, worker processes and file included."""
    low, high = (1.0 - SPEED_RANGE, 1.0 + SPEED_RANGE) if points > 1 else (1.0, 1.0)
    speeds = tuple(float(each) for each in scene.operation.speed * np.linspace(low, high, points))
    swept = with_text(replace(scene, sweep={"operation.speed": speeds}))
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
    seconds = statistics.median(map(time_of, results))
    return SizeCost(lobes, seconds, int(last.numerics.rhs_evaluations))
