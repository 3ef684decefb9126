"""Cost of accuracy in time: the work-precision study of one scene."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from screwsim.codegen.modules import for_speed
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.machine.kinds import kind_of
from screwsim.machine.protocol import ROTORS
from screwsim.scene import Scene
from screwsim.scene.checks import cross_check
from screwsim.simulate import simulate
from screwsim.study.accuracy.effects import EffectCost, SizeCost, effect_costs, lobe_times, sweep_times
from screwsim.study.accuracy.measure import (
    MeasuredCase,
    NoReference,
    Reference,
    RequestedAccuracy,
    measure,
    one_line,
    reference_of,
    solved_as_requested,
)
from screwsim.study.accuracy.solving import QUICK_SCOPE, Case, Scope, all_cases, omitted_methods
from screwsim.study.progress import Progress

__all__ = ["QUICK_SCOPE", "Case", "MeasuredCase", "NoReference", "Reference", "Scope", "Study", "study"]


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
    bad = [(f"{each.size} male lobes", each.reason) for each in lobes if each.reason]
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
