"""Uncertainty of a scene's figures due to the tolerances of its inputs, and the inputs that contribute most.

Linear: standard uncertainties times exact derivatives, added within a group of correlated inputs, as the root of the
sum of squares between groups (GUM, law of propagation). The numerical error and the model error, which the validation
that the scene names states (study.validation.discrepancy), are separate, and added to neither.

Source: JCGM 100:2008, Evaluation of measurement data (GUM), section 5; ASME V&V 20-2009.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from screwsim.figures.engineering import figure_text
from screwsim.inputs.arguments import checked_arguments, instance
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.outputs.display import About, Brief
from screwsim.scene import Scene, SceneLike
from screwsim.scene.model_errors import CONDITION_WORDS, RATIO, SPEED, shown_condition, stored_model_errors
from screwsim.scene.types import COVERAGE, Tolerance
from screwsim.study.local import Sensitivities, numeric_paths, sensitivities
from screwsim.study.progress import Progress
from screwsim.study.solving import solved
from screwsim.study.varied import Varied

RANGE_MARGIN = 0.01  # of a value: margin by which it may lie outside the validated range


class Tolerances(NamedTuple):
    """Tolerances of inputs by their paths, and the inputs that err together; a scene has both as well."""

    uncertain: Mapping[str, Tolerance]
    correlated: tuple[tuple[str, ...], ...]


def tolerances_of(of: Varied, without: Sequence[str] = ()) -> Tolerances:
    """Return the tolerances of the inputs of a scene, or of two stages, `without` those of some paths."""
    if isinstance(of, Scene):
        uncertain, correlated = of.uncertain, of.correlated
    else:
        from screwsim.study.stages.tolerances import stage_tolerances

        uncertain, correlated = stage_tolerances(of)
    groups = (tuple(path for path in group if path not in without) for group in correlated)
    kept = {path: tolerance for path, tolerance in uncertain.items() if path not in without}
    return Tolerances(kept, tuple(group for group in groups if len(group) > 1))


class Contributor(NamedTuple):
    """One input or several correlated ones: their share of the variance, and the change [SI] of the figure.

    `change` is that for the whole tolerance, half of a 95 % interval.
    """

    paths: tuple[str, ...]
    share: float
    change: float


NOT_STATED = "it is not stated here"
NO_TOLERANCE = "no input has a tolerance (write one after its value, e.g. gap: 27 um ± 5 um)"


@dataclass(frozen=True)
class FigureUncertainty:
    """Uncertainty of one figure [SI]: its standard uncertainty, and the contributing inputs, the largest first."""

    standard: float
    contributors: tuple[Contributor, ...]

    @property
    def expanded(self) -> float:
        """Half of the 95 % interval [SI]."""
        return COVERAGE * self.standard

    def as_json(self, most: int | None = None) -> dict[str, Any]:
        """Return it as documents have it, with all or the `most` largest contributors."""
        contributors = [one._asdict() | {"paths": list(one.paths)} for one in self.contributors[:most]]
        return {"standard": self.standard, "expanded": self.expanded, "contributors": contributors}


class FigureSample(NamedTuple):
    """A sample of one figure: mean, standard deviation; what is wrong with the linear estimate, '' for nothing."""

    mean: float
    standard: float
    wrong: str


@dataclass(frozen=True, repr=False)
class Uncertainty(Brief):
    """Uncertainties of a scene's figures. `left_out` are inputs without a derivative, and why."""

    spreads: Mapping[str, FigureUncertainty]
    slopes: Sensitivities
    groups: tuple[tuple[str, ...], ...] = ()  # correlated inputs, one or more per group
    left_out: Mapping[str, str] = field(default_factory=dict)
    sampled: Mapping[str, FigureSample] = field(default_factory=dict)
    samples: int = 0
    message: str = ""  # why there is no sample, or only a part of it

    def _about(self) -> About:
        rows, here = [], self.slopes.result.performance
        for name, spread in self.spreads.items():
            value = here.get(name)
            told = "–" if not value else f"{100.0 * spread.expanded / abs(value):.2g} %"
            most = ", ".join(spread.contributors[0].paths) if spread.contributors else ""
            rows.append((name, "none" if value is None else figure_text(name, value), told, most))
        heading = f"Uncertainty of {len(rows)} figures by {len(self.groups)} inputs"
        notes = [self.message] if self.message else []
        return About(heading, notes, ("figure", "value", "± (95 %)", "most by"), rows)

    def as_json(self, most: int | None = None) -> dict[str, Any]:
        """Return what `run --json` prints under `uncertainty`, with all or the `most` largest contributors."""
        figures = {name: spread.as_json(most) for name, spread in self.spreads.items()}
        return {
            "coverage_factor": COVERAGE,
            "groups": [list(group) for group in self.groups],
            "figures": figures,
            "method": dict(self.slopes.method),
            "left_out": dict(self.left_out),
        }


@checked_arguments(result=instance(Result, "what simulate returned"))
def uncertainty(
    scene: SceneLike | Varied,
    *,
    result: Result | None = None,
    jobs: int | None = 1,
    progress: Progress | bool | None = None,
) -> Uncertainty:
    """Return the uncertainty of each figure that follows from the tolerances of a scene's inputs.

    Two stages are given by the path of their file: the figures are those of both together, found in one process
    (`jobs`, `progress` are for one machine). Raises UsageError if no tolerance is stated.
    """
    from screwsim.study.stages import run_stages, scene_or_stages, solution_of

    given = scene_or_stages(scene)
    if not isinstance(given, Scene):
        from screwsim.study.stages.uncertain import chain_uncertainty

        solution = run_stages(given) if result is None else solution_of(result)
        if solution.status != "ok":
            return Uncertainty({}, Sensitivities(solution.as_result()))
        return chain_uncertainty(given, solution)[0]
    scene = given
    if not scene.uncertain:
        raise UsageError(NO_TOLERANCE)
    found = slopes_by_inputs(scene, list(scene.uncertain), jobs=jobs, progress=progress, result=result)
    spreads = spreads_of(scene, found.values, found.derivatives)
    return Uncertainty(spreads, found, groups_of(scene), found.left_out if found.result.status == "ok" else {})


def slopes_by_inputs(
    of: Varied,
    paths: Sequence[str],
    figures: Sequence[str] = (),
    *,
    result: Result | None = None,
    jobs: int | None = 1,
    progress: Progress | bool | None = False,
) -> Sensitivities:
    """Return the derivatives of figures (default: all) by inputs with a tolerance, of a scene or two stages.

    `left_out` names every input that has no derivative of one of the `figures` there, and why: it has no part in an
    uncertainty, and `not_included` says so.
    """
    numbers, why = numeric_paths(of) if isinstance(of, Scene) else (paths, {})
    there = [path for path in paths if path in numbers]
    if there or not isinstance(of, Scene):
        found = sensitivities(of, there, figures, jobs=jobs, progress=progress, result=result, fine=False)
    else:  # no path would mean all
        found = Sensitivities(solved(of) if result is None else result)
    why, otherwise = {**why, **found.left_out}, found.result.told if found.result.status != "ok" else NOT_STATED
    lost = {path: why.get(path, otherwise) for path in paths if path not in found.values}
    for path in found.values:
        if lacking := [name for name in figures if path not in found.derivatives.get(name, (path,))]:
            lost[path] = f"{lacking[0]} has no derivative by it"
    return replace(found, values={path: by for path, by in found.values.items() if path not in lost}, left_out=lost)


def figures_by_inputs(
    of: Varied, result: Result, figures: Sequence[str], without: Sequence[str]
) -> tuple[dict[str, FigureUncertainty], str]:
    """Return the uncertainties of figures of a result by all inputs `without` some; what has no part, or why none is.

    Both are empty where no such input has a tolerance.
    """
    tolerances = tolerances_of(of, without)
    if not tolerances.uncertain:
        return {}, ""
    try:
        found = slopes_by_inputs(of, list(tolerances.uncertain), figures, result=result)
    except UsageError as error:
        return {}, f"no uncertainty from the inputs: {error}"
    spreads = spreads_of(tolerances, found.values, found.derivatives)
    return spreads, "; ".join(not_included(found.left_out))


def not_included(left_out: Mapping[str, str]) -> Iterator[str]:
    """Yield that the tolerance of each input without a derivative has no part in the uncertainties, and why."""
    for path, why in left_out.items():
        yield f"the tolerance of {path} is not included in the uncertainties: {why}"


def spreads_of(
    scene: Scene | Tolerances, values: Mapping[str, float], derivatives: Mapping[str, Mapping[str, float]]
) -> dict[str, FigureUncertainty]:
    """Return the uncertainties of figures from their derivatives [SI] by the uncertain inputs at `values` [SI].

    A figure that lacks the derivative by one of these has none.
    """
    there, groups = scene.uncertain.keys() & values.keys(), groups_of(scene)
    complete = {name: slopes for name, slopes in derivatives.items() if there and there <= slopes.keys()}
    return {name: _figure_uncertainty(scene, values, slopes, groups) for name, slopes in complete.items()}


def groups_of(scene: Scene | Tolerances) -> tuple[tuple[str, ...], ...]:
    """Return the groups of inputs with a tolerance, correlated ones together, in the order of the scene."""
    group_of = {path: group for group in scene.correlated for path in group}
    return tuple(dict.fromkeys(group_of.get(path, (path,)) for path in scene.uncertain))


def with_uncertainty(scene: Scene, result: Result) -> Result:
    """Return a result with the uncertainties by its scene's tolerances, and the model error that the scene names.

    The result is unchanged where it has no figures, or the scene asks for neither. An input without a derivative is in
    none of the uncertainties, and a warning says so.
    """
    if result.status != "ok" or not (scene.uncertain or scene.model_error):
        return result
    told = {"model": model_error(scene, result.performance)} if scene.model_error else {}
    if not scene.uncertain:
        return replace(result, uncertainty=told)
    found = uncertainty(scene, result=result, progress=False)
    warnings = (*result.warnings, *not_included(found.left_out))
    return replace(result, uncertainty={**found.as_json(), **told}, warnings=warnings)


def conditions_of(scene: Scene, performance: Mapping[str, Any]) -> dict[str, Any]:
    """Return the conditions by which points are compared: kind of machine, fluid, speed [rad/s], pressure ratio."""
    found = {"machine.kind": scene.machine.kind, "gas.fluid": scene.gas.name, SPEED: float(scene.operation.speed)}
    ratio = performance.get(RATIO)
    return found if ratio is None else {**found, RATIO: float(ratio)}


def model_error(scene: Scene, performance: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the validation that a scene names says of its figures [SI]; empty where it names none.

    `low` and `high` are the ends between which the model error lies at the held-out points, scaled to the figure's
    size; `outside` lists the respects in which the scene lies outside the validated conditions.
    """
    if not scene.model_error:
        return {}
    told = stored_model_errors()[scene.model_error]
    figures = {}
    for name, each in told["figures"].items():
        value, held = performance.get(name), each["held_out"]
        if value is None or held is None:
            continue
        size = abs(value) if each["relative"] else 1.0
        ends = {end: size * held[end] for end in ("mean", "low", "high")}
        figures[name] = ends | {"points": held["points"], "not_stated": each["not_stated"]}
    outside = list(_outside(told["range"], conditions_of(scene, performance)))
    return {"of": scene.model_error, "citation": told["citation"], "figures": figures, "outside": outside}


def _outside(known: Mapping[str, Any], here: Mapping[str, Any]) -> Iterator[str]:
    """Yield the conditions that differ from the validated ones, and by how much."""
    for name, value in here.items():
        ends = known.get(name)
        if ends is None:
            continue
        if isinstance(value, str):
            if value not in ends:
                yield f"{CONDITION_WORDS[name]} {value} ({', '.join(ends)})"
        elif not ends[0] - RANGE_MARGIN * abs(ends[0]) <= value <= ends[1] + RANGE_MARGIN * abs(ends[1]):
            shown, low, high = (shown_condition(name, each) for each in (value, *ends))
            yield f"{CONDITION_WORDS[name]} {shown} ({low if low == high else f'{low} to {high}'})"


def _figure_uncertainty(
    scene: Scene | Tolerances,
    values: Mapping[str, float],
    slopes: Mapping[str, float],
    groups: Sequence[tuple[str, ...]],
) -> FigureUncertainty:
    """Return the uncertainty of a figure with these derivatives by path."""
    changes = {}
    for group in groups:
        there = tuple(path for path in group if path in values)
        if there:
            changes[there] = sum(slopes[path] * scene.uncertain[path].standard_at(values[path]) for path in there)
    variance = sum(change * change for change in changes.values())
    ranked = sorted(changes.items(), key=lambda item: -abs(item[1]))
    shares = (Contributor(paths, by * by / variance if variance else 0.0, COVERAGE * by) for paths, by in ranked if by)
    return FigureUncertainty(float(variance**0.5), tuple(shares))
