"""How each figure of one machine changes with each number of its scene, at one operating point.

Derivatives are exact where the cycle can be linearised (`derivatives`), and differences of closed cycles elsewhere; the
result names the method used for each number.
"""

import math
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field, replace

from screwsim.derivatives.collocation import FINE, QUICK
from screwsim.derivatives.solving import scene_derivatives
from screwsim.figures import declared
from screwsim.figures.errors import error_in_unit, error_scale, zeros_for_none
from screwsim.inputs.declare import is_derived
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.outputs.derivatives import DIFFERENCES, EXACT, ROUGH
from screwsim.outputs.display import About, Brief
from screwsim.scene import Scene
from screwsim.scene.fields import FIXED, Leaf, leaves_of, value_at
from screwsim.scene.types import FoundWithCycle
from screwsim.simulate import simulate
from screwsim.study.asked import varied
from screwsim.study.asked.figures import figure_of
from screwsim.study.asked.inputs import DISCRETE_KINDS, check_continuous, shown_value
from screwsim.study.asked.varied import Varied
from screwsim.study.pool.progress import Progress, progress_of
from screwsim.study.pool.solving import results_at

WHOLE = "shaft_power", "gas_mass_flow"
DIFFERENCE_STEP = 5e-3  # relative step of a number for differences of closed cycles ...
# ... at most, for an angle: half a percent of a port's opening angle is three degrees ...
LARGEST_ANGLE_STEP = math.radians(0.5)
# ... [K] that of a temperature, half a percent of which is 1.5 K, and of a difference of two, which may be small ...
TEMPERATURE_STEP = 0.25
DIFFERENCE_ACCURACY = 1e-6  # ... accuracy of these cycles, unless the scene's is finer
NOTHING = 2.0  # of its estimated errors: a figure below is nothing, as the heat of insulated walls
# of the scale of its error, by the whole number: changes of such a figure below are digits of rounding; of exact
# derivatives (those of insulated walls reach 4e-8), or as a share of the change of power or flow; and of differences
ROUNDING, ROUNDING_SHARE, ROUGHNESS = 1e-7, 1e-6, DIFFERENCE_ACCURACY / DIFFERENCE_STEP
# [SI], by its kind, 1 for others: size that the step of a number that is zero is relative to
ZERO_SIZES = {"length": 0.02, "area": 2e-4, "volume": 2e-4, "pressure_difference": 2e4, "power": 200.0}
EXCLUDED_SECTIONS = ("numerics.", "output.")  # sections whose numbers do not describe the machine
GAUGE_REMEDY = "gauge pressures were read relative to it"
KINDS_WITHOUT_DERIVATIVE = {**DISCRETE_KINDS, "numbers": "a list of numbers", "file": "a file"}


@dataclass(frozen=True, repr=False)
class Sensitivities(Brief):
    """Derivatives of figures by numbers of a scene, at the point that it states.

    `derivatives` holds for each figure the derivative by the number at each path, in SI units of the figure over those
    of the number; `values` the numbers [SI] and `units` their SI units; `method` how the derivatives by each number
    were found: 'exact', 'quick' (exact, with fewer slices: good to 1e-3 mostly) or 'differences' (`why` gives the
    reason); `left_out` the paths without derivatives, and why. `result` is the point itself.
    """

    result: Result
    values: Mapping[str, float] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    derivatives: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    method: Mapping[str, str] = field(default_factory=dict)
    why: Mapping[str, str] = field(default_factory=dict)
    left_out: Mapping[str, str] = field(default_factory=dict)

    def relative(self, figure: str, path: str) -> float | None:
        """Return the change of a figure in percent per percent of a number; None where either is zero or missing."""
        value, slope = self.result.performance.get(figure), self.derivatives.get(figure, {}).get(path)
        if slope is None or not value or not self.values[path]:
            return None
        return slope * self.values[path] / value

    def _about(self) -> About:
        figures = list(self.derivatives)
        heading = f"Sensitivities: {len(figures)} figures by {len(self.values)} numbers of the scene"
        if not self.values:
            return About(heading, [self.result.told])
        slopes = {path: [self.relative(name, path) for name in figures] for path in self.values}
        largest = {path: max((abs(each) for each in by if each is not None), default=0) for path, by in slopes.items()}
        paths = sorted(slopes, key=lambda path: -largest[path])
        rows = [[path, *("–" if each is None else f"{each:.3g}" for each in slopes[path])] for path in paths]
        notes = ["percent per percent; derivatives [SI] are in .derivatives"]
        return About(heading, notes, ["number", *figures], rows)


def numeric_paths(scene: Scene) -> tuple[dict[str, float], dict[str, str]]:
    """Return the numbers [SI] of a scene by path, and why its other inputs cannot be varied by a small step."""
    leaves = leaves_of(scene)
    values: dict[str, float] = {}
    left_out: dict[str, str] = {}
    for path, leaf in leaves.items():
        value = value_at(scene, path)
        if value is None or path.startswith(EXCLUDED_SECTIONS) or leaf.kind == "word":
            continue
        if leaf.kind in KINDS_WITHOUT_DERIVATIVE:
            left_out[path] = KINDS_WITHOUT_DERIVATIVE[leaf.kind]
        elif isinstance(value, FoundWithCycle):
            left_out[path] = "follows from the cycle"
        elif is_derived(value):
            left_out[path] = "follows from what the scene states"
        else:
            values[path] = float(value)
    return values, left_out


def scene_sensitivities(
    scene: Scene,
    paths: Sequence[str] = (),
    figures: Sequence[str] = (),
    *,
    jobs: int | None = 1,
    progress: Progress | bool | None = None,
    result: Result | None = None,
    fine: bool = True,
) -> Sensitivities:
    """Return the derivatives of figures of one machine (default: all) by the numbers at paths (default: all).

    The arguments are those of `point.sensitivities`.
    """
    if result is not None and (other := _other_scene(scene, result)):
        raise UsageError(f"result: belongs to another scene: {other} (pass that of this scene, or none)")
    numbers, left_out = numeric_paths(scene)
    left_out |= dict.fromkeys(FIXED & numbers.keys(), GAUGE_REMEDY)
    numbers = {path: value for path, value in numbers.items() if path not in FIXED}
    names = tuple(dict.fromkeys(figure_of(scene, name) for name in figures))
    values = requested_numbers(scene, paths, numbers)
    result = simulate(scene, trace=False) if result is None else result
    if result.status != "ok":
        return Sensitivities(result)
    exact = scene_derivatives(scene, values, FINE if fine else QUICK)
    why = {path: exact.why or exact.refused[path] for path in values if path not in exact.derivatives}
    differences, failed = _differences(scene, {path: values[path] for path in why}, jobs, progress)
    by_path, leaves = {**exact.derivatives, **differences}, leaves_of(scene)
    by_path = _without_rounding(result, {path: size_of(leaves[path], values[path]) for path in by_path}, by_path, why)
    found = [path for path in values if path in by_path]
    figures_with_scale = _differentiable(result, names)
    return Sensitivities(
        result,
        values={path: values[path] for path in found},
        units={path: getattr(leaves[path].dimension, "si", "1") for path in found},
        derivatives={
            name: {path: by_path[path][name] for path in found if name in by_path[path]} for name in figures_with_scale
        },
        method={path: DIFFERENCES if path in why else EXACT if fine else ROUGH for path in found},
        why={path: why[path] for path in found if path in why},
        left_out=({} if paths else left_out) | failed,
    )


def _without_rounding(
    result: Result,
    sizes: Mapping[str, float],
    slopes: Mapping[str, Mapping[str, float]],
    differences: Container[str],
) -> dict[str, dict[str, float]]:
    """Return derivatives by path with zeros for those of figures that are nothing but rounding; `sizes` of the numbers.

    `differences` are the paths whose derivatives are differences of cycles.
    """
    figures = result.performance
    known = zeros_for_none(figures)
    scales = {name: error_scale(name, declared(name, figures).scale, known) for name in _differentiable(result, ())}
    errors = {name: error_in_unit(name, figures, result.error) for name in scales}
    near = [name for name, error in errors.items() if error is not None and abs(figures[name]) <= NOTHING * error]
    cleaned = {path: dict(by) for path, by in slopes.items()}
    for path, by in cleaned.items():
        change = {
            name: abs(by[name]) * sizes[path] / scales[name]
            for name in (*near, *WHOLE)
            if scales.get(name) and name in by
        }
        share = ROUNDING_SHARE * max((change[name] for name in WHOLE if name in change), default=0.0)
        least = ROUGHNESS if path in differences else max(ROUNDING, share)
        by.update({name: 0.0 for name in near if change.get(name, math.inf) < least})
    return cleaned


def _differentiable(result: Result, names: Sequence[str]) -> list[str]:
    """Return the named figures of a result, by default all, that are numbers; residuals are none to differentiate."""
    figures = result.performance
    there = [name for name, value in figures.items() if isinstance(value, int | float) and (name in names or not names)]
    return [name for name in there if not declared(name, figures).scale.unasked]


def _other_scene(scene: Scene, result: Result) -> str:
    """Return in which effect or input the scene of a result differs; '' where no difference can be seen."""
    apart = set(result.effects) ^ set(scene.effects) if result.effects else ()
    if apart:
        name = min(apart)
        return f"effects.{name} is simulated {'there' if name in result.effects else 'here'} only"
    known = result.derivatives.scene
    if known is None or known is scene:
        return ""
    if known.machine.kind != scene.machine.kind:
        return f"machine.kind is {known.machine.kind} there, {scene.machine.kind} here"
    for path in leaves_of(scene):
        there, here = value_at(known, path), value_at(scene, path)
        if there != here and not path.startswith(EXCLUDED_SECTIONS):
            pairs = ((known, there), (scene, here))
            shown = ("not stated" if value is None else shown_value(one, path, value) for one, value in pairs)
            return f"{path} is {next(shown)} there, {next(shown)} here"
    return ""


def requested_numbers(of: Varied, paths: Sequence[str], every: Mapping[str, float]) -> dict[str, float]:
    """Return the numbers at the requested paths, by default all; raise UsageError for a path without a number."""
    for path in paths:
        check_continuous(of, path)
        if path not in every:
            value = varied.value_at(of, path)
            what = "follows from others" if isinstance(value, FoundWithCycle) or is_derived(value) else "is not stated"
            where = "this scene" if isinstance(of, Scene) else f"the {path.partition('.')[0]} scene"
            raise UsageError(f"{path}: {what} in {where} (state it, or leave it out)")
    return {path: every[path] for path in dict.fromkeys(paths or every)}


def _differences(
    scene: Scene, values: Mapping[str, float], jobs: int | None, progress: Progress | bool | None
) -> tuple[dict[str, dict[str, float]], dict[str, str]]:
    """Return the derivatives of figures by path as differences of closed cycles, and why some paths have none."""
    if not values:
        return {}, {}
    numerics = scene.numerics
    finer = min(DIFFERENCE_ACCURACY, numerics.accuracy) if numerics.rtol is None else numerics.accuracy
    scene = replace(scene, numerics=replace(numerics, accuracy=finer, error="none"))
    leaves = leaves_of(scene)
    points = [(path, by) for path, value in values.items() for by in _shifts(leaves[path], value)]
    shifted = [{path: values[path] + by} for path, by in points]
    results = results_at(scene, shifted, jobs=jobs, progress=progress_of("sensitivities", progress))
    slopes: dict[str, dict[str, float]] = {}
    failed: dict[str, str] = {}
    for i in range(0, len(points), 2):
        (path, above), (_, below) = points[i], points[i + 1]
        one, other = results[i], results[i + 1]
        if wrong := next((each for each in (one, other) if each.status != "ok"), None):
            failed[path] = wrong.told
            continue
        pairs = ((name, one.performance[name], other.performance.get(name)) for name in one.performance)
        slopes[path] = {name: (a - b) / (above - below) for name, a, b in pairs if a is not None and b is not None}
    return slopes, failed


def size_of(leaf: Leaf, value: float) -> float:
    """Return the size [SI] that the step of a number is relative to: its magnitude; for zero that of its kind."""
    return abs(value) or ZERO_SIZES.get(leaf.kind, 1.0)


def _shifts(leaf: Leaf, value: float) -> tuple[float, float]:
    """Return the steps by which a number is shifted up and down, within the limits of its leaf."""
    step = DIFFERENCE_STEP * size_of(leaf, value)
    step = TEMPERATURE_STEP if leaf.kind in ("temperature", "temperature_difference") else step
    step = min(step, LARGEST_ANGLE_STEP) if leaf.kind == "angle" else step
    return within_limits(leaf, value, step)


def within_limits(leaf: Leaf, value: float, step: float) -> tuple[float, float]:
    """Return a step up and one down (negative), 0 where it would leave the limits of the leaf."""
    most = leaf.limits.get("le", leaf.limits.get("lt"))
    least = leaf.limits.get("ge", leaf.limits.get("gt"))
    up = step if most is None or value + step <= most else 0.0
    down = step if least is None or value - step >= least else 0.0
    return up, -down
