"""Part load by each control that a scene allows, at equal loads: cooling capacity over that of the scene as it stands.

Each control leads from the scene's own setting to its end. A few settings show how the capacity falls; those that give
the wanted loads are interpolated, solved, and once corrected.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from screwsim.numerics.pchip import Pchip
from screwsim.outputs import Result
from screwsim.scene import Scene, cross_check, with_values
from screwsim.scene.fields import value_at
from screwsim.simulate import simulate_many

SPEED, CAPACITY = "operation.speed", "cooling_capacity"
LOADS = (1.0, 0.75, 0.5, 0.25)
SETTINGS = 7  # from the scene's own to the control's end, where the scene sweeps none
SLOWEST = 0.2  # of the scene's speed
NEAR, TRIES = 2e-3, 3  # of full load, within which a load is met, and how often it is tried
Solve = Callable[[float], Result]
ENDS = {  # path -> (name, the setting at which its capacity is least)
    SPEED: ("speed", None),
    "effects.slide_valve.position": ("slide valve", 1.0),
    "effects.suction_throttle.pressure_ratio": ("suction throttle", 0.2),
    "effects.bypass.share": ("bypass", 0.8),
}


class Control(NamedTuple):
    """A way to a smaller capacity: its name, the path that it moves, its settings [SI] from full load on."""

    name: str
    path: str
    settings: tuple[float, ...]


class Step(NamedTuple):
    """A setting [SI] of a control with its load (share of the full capacity) and its result."""

    setting: float
    load: float
    result: Result


@dataclass(frozen=True)
class PartLoad:
    """What a control does: `curve` over its settings while they are ok, `steps` at the wanted loads that it reaches.

    `why` says why the curve ends before the control does.
    """

    control: Control
    curve: Sequence[Step]
    steps: Sequence[Step]
    why: str = ""

    @property
    def least(self) -> float:
        """The least load of the curve."""
        return min((step.load for step in self.curve), default=1.0)


def controls(scene: Scene) -> list[Control]:
    """Return the controls that a scene allows: its speed, and those whose effects it names.

    The values of a sweep over one of them are its settings.
    """
    base, found = replace(scene, sweep={}, joints=()), []
    for path, (name, end) in ENDS.items():
        own = value_at(base, path) if path == SPEED or path.split(".")[1] in base.effects else None
        if own is None:
            continue
        last = SLOWEST * own if end is None else end
        swept = scene.sweep.get(path, np.linspace(own, last, SETTINGS))
        moved = sorted({float(value) - own for value in swept if (value - own) * (last - own) > 0.0}, key=abs)
        if moved:
            found.append(Control(name, path, (own, *(own + way for way in moved))))
    return found


def part_load(scene: Scene, control: Control, full: float | None = None, loads: Sequence[float] = LOADS) -> PartLoad:
    """Return what a control does to a scene without a sweep; `full` is the capacity [W] of load 1 (its first's)."""
    curve, why, solve = [], "", _solver(scene, control)
    for setting in control.settings:
        result = solve(setting)
        capacity = result.performance.get(CAPACITY) if result.status == "ok" else None
        if capacity is None or capacity <= 0.0:
            why = result.message or "there is no cooling capacity"
            break
        full = full or capacity
        curve.append(Step(setting, capacity / full, result))
    falling = _falling(curve)
    steps = list(_at_loads(solve, falling, full or 0.0, loads)) if len(falling) > 1 else falling[:1]
    return PartLoad(control, curve, steps, why)


def _solver(scene: Scene, control: Control) -> Solve:
    """Return what solves the scene at a setting, every cycle begun from the one before."""
    cases: deque[Scene] = deque()
    results = simulate_many(iter(cases.popleft, None), trace=False)

    def solve(setting: float) -> Result:
        case = with_values(scene, {control.path: setting})
        faults = cross_check(case)
        if faults:
            return Result("failed", message=str(faults[0]))
        cases.append(case)
        return next(results)

    return solve


def _falling(curve: Sequence[Step]) -> list[Step]:
    """Return the steps of a curve whose load is below that of all before them."""
    kept: list[Step] = []
    for step in curve:
        if not kept or step.load < kept[-1].load:
            kept.append(step)
    return kept


def _at_loads(solve: Solve, known: list[Step], full: float, loads: Sequence[float]) -> Iterator[Step]:
    """Yield a step at each load that the curve reaches: interpolated, solved, corrected where it misses."""
    yield known[0]
    for load in loads:
        if not known[-1].load - NEAR <= load < 1.0 - NEAR:
            continue
        step, seen = None, known
        for _ in range(TRIES):
            step = _at(solve, seen, full, load)
            if step is None or abs(step.load - load) <= NEAR:
                break
            seen = _falling(sorted([*seen, step], key=lambda each: abs(each.setting - known[0].setting)))
        if step is not None:
            yield step


def _at(solve: Solve, known: Sequence[Step], full: float, load: float) -> Step | None:
    """Return the step at the setting that is interpolated for a load; None where it is not ok."""
    rising = sorted(known, key=lambda step: step.load)
    x, y = (np.array([getattr(step, name) for step in rising]) for name in ("load", "setting"))
    setting = float(Pchip(x, y)(min(max(load, x[0]), x[-1])))
    result = solve(setting)
    capacity = result.performance.get(CAPACITY)
    return Step(setting, capacity / full, result) if result.status == "ok" and capacity else None
