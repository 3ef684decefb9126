"""Part load by each control that a scene allows, at equal loads relative to the capacity of the scene as stated.

Each control runs from the scene's own setting to its end. A few settings show how the capacity falls; the settings for
the wanted loads are interpolated, solved, and corrected where they miss. Where the built-in volume ratio is adjustable,
each wanted load is met again at the ratio with the best COP there.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from screwsim.numerics.pchip import Pchip
from screwsim.outputs import Result
from screwsim.scene import Scene, cross_check, with_values, without_sweep
from screwsim.scene.fields import value_at
from screwsim.scene.operation import SPEED
from screwsim.study.pool.parallel import WarmSimulation

LOADS = (1.0, 0.75, 0.5, 0.25)
SETTING_COUNT = 7  # settings from the scene's own to the control's end, where the scene sweeps none
SLOWEST_SPEED = 0.2  # of the scene's speed
NEAR, TRIES = 2e-3, 3  # of full load, tolerance within which a load is met, and number of tries
RATIO_PATH = "machine.built_in_volume_ratio"
LEAST_RATIO, LEAST = 0.5, 1.05  # of the axial port's ratio, the lower end of a slide stop; and a lower limit
RATIO_COUNT = 5  # ratios tried between both ends
Solve = Callable[[float], Result]
_NONE: Mapping[str, float] = {}
_NO_RATIO: Mapping[float, str] = {}
CONTROL_ENDS = {  # path -> (name, setting of least capacity)
    SPEED: ("speed", None),
    "machine.slide_valve.position": ("slide valve", 1.0),
    "effects.slide_valve.position": ("slide valve", 1.0),
    "effects.suction_throttle.pressure_ratio": ("suction throttle", 0.2),
    "effects.bypass.share": ("bypass", 0.8),
}


class Control(NamedTuple):
    """A control of capacity: its name, the path that it changes, its settings [SI] from full load on."""

    name: str
    path: str
    settings: tuple[float, ...]


class LoadFigures(NamedTuple):
    """Figure that defines the load, figure that the best built-in volume ratio maximises, message without a load."""

    load: str
    best: str
    none: str


REFRIGERATION = LoadFigures("cooling_capacity", "cop", "there is no cooling capacity")
HEATING = LoadFigures("heating_capacity", "heating_cop", "there is no heating capacity")
GAS = LoadFigures("gas_mass_flow", "isentropic_efficiency", "nothing is delivered")


class LoadStep(NamedTuple):
    """A setting [SI] of a control with its load (share of the full capacity) and its result.

    `ratio` and `best`: built-in volume ratio of the best COP at that load, and the result there (`ratios`). `missed`:
    ratios at which there was no COP, and why.
    """

    setting: float
    load: float
    result: Result
    ratio: float | None = None
    best: Result | None = None
    missed: Mapping[float, str] = _NO_RATIO


@dataclass(frozen=True)
class PartLoad:
    """Results of a control: `curve` over its settings while they are ok, `steps` at the wanted loads within reach.

    `why` says why the curve ends before the control does.
    """

    control: Control
    curve: Sequence[LoadStep]
    steps: Sequence[LoadStep]
    why: str = ""

    @property
    def least(self) -> float:
        """The least load of the curve."""
        return min((step.load for step in self.curve), default=1.0)


def controls(scene: Scene) -> list[Control]:
    """Return the controls that a scene allows: its speed, and those whose effects it names.

    The values of a sweep over one of them are its settings.
    """
    base, found = without_sweep(scene), []
    for path, (name, end) in CONTROL_ENDS.items():
        own = value_at(base, path) if _has(base, path) else None
        if own is None:
            continue
        last = SLOWEST_SPEED * own if end is None else end
        swept = scene.sweep.get(path, np.linspace(own, last, SETTING_COUNT))
        moved = sorted({float(value) - own for value in swept if (value - own) * (last - own) > 0.0}, key=abs)
        if moved:
            found.append(Control(name, path, (own, *(own + way for way in moved))))
    return found


def _has(scene: Scene, path: str) -> bool:
    """Return whether a scene has the section of a control."""
    first, second, *_ = path.split(".")
    if first == "effects":
        return second in scene.effects
    return first == "operation" or getattr(getattr(scene, first), second, None) is not None


def ratios(scene: Scene) -> tuple[float, ...]:
    """Return the built-in volume ratios to be compared; none where the ratio cannot be adjusted.

    They are those of a sweep or, for a machine whose axial port has a ratio of its own, from half of that, or from the
    machine's own where that is less, up to it.
    """
    if RATIO_PATH in scene.sweep:
        return tuple(sorted(map(float, scene.sweep[RATIO_PATH])))
    axial = getattr(scene.machine, "axial_volume_ratio", None)
    if axial is None:
        return ()
    least = max(LEAST_RATIO * axial, LEAST)
    return tuple(np.linspace(min(least, value_at(scene, RATIO_PATH) or least), axial, RATIO_COUNT).tolist())


def part_load(
    scene: Scene,
    control: Control,
    full: float | None = None,
    loads: Sequence[float] = LOADS,
    among: Sequence[float] = (),
    aim: LoadFigures = REFRIGERATION,
) -> PartLoad:
    """Return the results of a control on a scene without a sweep; `full` is the capacity [SI] of load 1.

    By default that is the capacity at the first setting. `among` are the built-in volume ratios from which the best is
    found at each load; `aim` defines load and best.
    """
    found = curve_and_steps(_solver(scene, control), control, full, loads, aim)
    falling = _falling_steps(found.curve)
    if not among or len(falling) < 2:
        return found
    full = full or float(falling[0].result.performance[aim.load]) / falling[0].load
    steps = [_step_at_best_ratio(scene, control, falling, step, full, among, aim) for step in found.steps]
    return replace(found, steps=steps)


def curve_and_steps(
    solve: Solve, control: Control, full: float | None, loads: Sequence[float], aim: LoadFigures
) -> PartLoad:
    """Return the results of a control that `solve` returns at its settings; `full` as in `part_load`."""
    curve, why = [], ""
    for setting in control.settings:
        result = solve(setting)
        capacity = result.performance.get(aim.load) if result.status == "ok" else None
        if capacity is None or capacity <= 0.0:
            why = result.message or aim.none
            break
        full = full or capacity
        curve.append(LoadStep(setting, capacity / full, result))
    falling = _falling_steps(curve)
    steps = list(_steps_at_loads(solve, falling, full or 0.0, loads, aim)) if len(falling) > 1 else falling[:1]
    return PartLoad(control, curve, steps, why)


def _step_at_best_ratio(
    scene: Scene,
    control: Control,
    known: Sequence[LoadStep],
    step: LoadStep,
    full: float,
    among: Sequence[float],
    aim: LoadFigures,
) -> LoadStep:
    """Return a step with the ratio of its best COP, from a parabola through those tried, at the same load."""
    solve, cop, missed = _solver(scene, Control("", RATIO_PATH, ()), {control.path: step.setting}), {}, {}
    for ratio in among:
        result = solve(ratio)
        value = result.performance.get(aim.best)
        if value is None:
            missed[ratio] = result.notes.get(aim.best) or result.told
        else:
            cop[ratio] = float(value)
    step = step._replace(missed=missed)
    own, value = value_at(scene, RATIO_PATH), step.result.performance.get(aim.best)
    if own is not None and value is not None and among[0] <= own <= among[-1]:
        cop.setdefault(float(own), float(value))
    if not cop:
        return step
    ratio = _parabola_top(cop)
    again = _solver(scene, control, {RATIO_PATH: ratio})
    setting, wanted, best = step.setting, step.load, None
    one, two = sorted(known, key=lambda each: abs(each.load - step.load))[:2]
    slope = (one.setting - two.setting) / (one.load - two.load)
    for _ in range(TRIES):
        result = again(setting)
        capacity = result.performance.get(aim.load)
        if result.status != "ok" or not capacity:
            return step
        best, off = result, capacity / full - wanted
        if abs(off) <= NEAR or step is known[0]:  # at full load the control stays at its first setting
            break
        setting -= off * slope
    return step._replace(ratio=ratio, best=best)


def _parabola_top(cop: dict[float, float]) -> float:
    """Return where the parabola through the largest COP and its neighbours is highest, within these three ratios."""
    tried = sorted(cop)
    i = tried.index(max(tried, key=lambda ratio: cop[ratio]))
    if len(tried) < 3:
        return tried[i]
    first = min(max(i - 1, 0), len(tried) - 3)  # at an end: the next two ratios
    near = tried[first : first + 3]
    a, b, _ = np.polyfit(np.array(near) - tried[i], [cop[ratio] for ratio in near], 2)
    return tried[i] if a >= 0.0 else float(np.clip(tried[i] - 0.5 * b / a, near[0], near[2]))


def _solver(scene: Scene, control: Control, others: Mapping[str, float] = _NONE) -> Solve:
    """Return a solver of the scene at a setting, with other values set; each cycle starts from the one before."""
    simulate = WarmSimulation()

    def solve(setting: float) -> Result:
        case = with_values(scene, {**others, control.path: setting})
        faults = cross_check(case)
        return Result("failed", message=str(faults[0])) if faults else simulate(case)

    return solve


def _falling_steps(curve: Sequence[LoadStep]) -> list[LoadStep]:
    """Return the steps of a curve whose load is below that of all before them."""
    kept: list[LoadStep] = []
    for step in curve:
        if not kept or step.load < kept[-1].load:
            kept.append(step)
    return kept


def _steps_at_loads(
    solve: Solve, known: list[LoadStep], full: float, loads: Sequence[float], aim: LoadFigures
) -> Iterator[LoadStep]:
    """Yield a step at each load that the curve reaches: interpolated, solved, and corrected where it misses."""
    yield known[0]
    for load in loads:
        if not known[-1].load - NEAR <= load < 1.0 - NEAR:
            continue
        step, seen = None, known
        for _ in range(TRIES):
            step = _step_at_load(solve, seen, full, load, aim)
            if step is None or abs(step.load - load) <= NEAR:
                break
            seen = _falling_steps(sorted([*seen, step], key=lambda each: abs(each.setting - known[0].setting)))
        if step is not None:
            yield step


def _step_at_load(
    solve: Solve, known: Sequence[LoadStep], full: float, load: float, aim: LoadFigures
) -> LoadStep | None:
    """Return the step at the setting interpolated for a load; None where it is not ok."""
    rising = sorted(known, key=lambda step: step.load)
    x, y = (np.array([getattr(step, name) for step in rising]) for name in ("load", "setting"))
    setting = float(Pchip(x, y)(min(max(load, x[0]), x[-1])))
    result = solve(setting)
    capacity = result.performance.get(aim.load)
    return LoadStep(setting, capacity / full, result) if result.status == "ok" and capacity else None
