"""One operating point for programs: its result, derivatives and uncertainties, of one machine or two stages."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from screwsim.inputs.arguments import FLAG, TEXTS, as_list, checked_arguments, instance, one_of
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import Result
from screwsim.outputs.derivatives import Derivatives
from screwsim.scene import Scene, SceneLike, cross_check, scene_of
from screwsim.simulate import Trace
from screwsim.simulate import simulate as simulated
from screwsim.study.asked.varied import Varied
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.solving import solved
from screwsim.study.uncertainty.model_error import model_error, outside_warning
from screwsim.study.uncertainty.slopes import Sensitivities, numeric_paths, scene_sensitivities
from screwsim.study.uncertainty.spreads import (
    NO_TOLERANCE,
    FigureUncertainty,
    Uncertainty,
    groups_of,
    not_included,
    spreads_of,
    tolerances_of,
)

NOT_STATED = "it is not stated here"


@checked_arguments(paths=TEXTS, result=instance(Result, "what simulate returned"), fine=FLAG)
def sensitivities(
    scene: SceneLike | Varied,
    paths: Sequence[str] | None = None,
    figures: Sequence[str] | None = None,
    *,
    jobs: int | None = 1,
    progress: Progress | bool | None = None,
    result: Result | None = None,
    fine: bool = True,
) -> Sensitivities:
    """Return the derivatives of figures (default: all) by the numbers at paths (default: all of the scene).

    Two stages are given by the path of their file: the figures are those of both together, found in one process
    (`jobs`, `progress` are for one machine). Pass the `result` if it is known already. With fine=False
    derivatives are good to 1e-3 instead of 1e-5 and cost less (docs/explanation/derivatives.md). Raises UsageError
    for a path or a figure that does not exist, and for a result of another scene.
    """
    from screwsim.study.stages import scene_or_stages, solution_of

    given = scene_or_stages(scene)
    if not isinstance(given, Scene):
        from screwsim.study.uncertainty.stages import chain_sensitivities

        known = None if result is None else solution_of(result, given)
        return chain_sensitivities(given, as_list(paths), as_list(figures), fine, known)
    return scene_sensitivities(
        given, as_list(paths), as_list(figures), jobs=jobs, progress=progress, result=result, fine=fine
    )


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
        from screwsim.study.uncertainty.stages import chain_uncertainty

        solution = run_stages(given) if result is None else solution_of(result, given)
        if solution.status != "ok":
            return Uncertainty({}, Sensitivities(solution.as_result()))
        return chain_uncertainty(given, solution)[0]
    if not given.uncertain:
        raise UsageError(NO_TOLERANCE)
    found = slopes_by_inputs(given, list(given.uncertain), jobs=jobs, progress=progress, result=result)
    spreads = spreads_of(given, found.values, found.derivatives)
    return Uncertainty(spreads, found, groups_of(given), found.left_out if found.result.status == "ok" else {})


def slopes_by_inputs(
    of: Varied,
    paths: Sequence[str],
    figures: Sequence[str] = (),
    *,
    result: Result | None,
    jobs: int | None = 1,
    progress: Progress | bool | None = False,
) -> Sensitivities:
    """Return the derivatives of figures (none: all) by inputs with a tolerance, of a scene or two stages.

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


def with_uncertainty(scene: Scene, result: Result) -> Result:
    """Return a result with the uncertainties by its scene's tolerances, and the model error that the scene names.

    The result is unchanged where it has no figures, or the scene asks for neither. An input without a derivative is in
    none of the uncertainties, and a warning says so; another, where the scene lies outside the validated range.
    """
    if result.status != "ok" or not (scene.uncertain or scene.model_error):
        return result
    model = model_error(scene, result.performance)
    told = {"model": model} if model else {}
    outside = [outside_warning(model)] if model and model["outside"] else []
    warnings = (*result.warnings, *outside)
    if not scene.uncertain:
        return replace(result, uncertainty=told, warnings=warnings)
    found = uncertainty(scene, result=result, progress=False)
    warnings = (*warnings, *not_included(found.left_out))
    return replace(result, uncertainty={**found.as_json(), **told}, warnings=warnings)


@checked_arguments(trace=one_of(True, False, "ledger"))
def simulate(scene: SceneLike, trace: Trace = True) -> Result:
    """Return the result of one scene; impossible physics gives a status and a partial result, never an exception.

    The scene is what `load` returns, the path of a file, YAML text, or a dict laid out as the file is. With `trace` the
    result has the cycle over the angle and the ledger, with 'ledger' the ledger alone; without it the ledger is left
    out where the scene says `numerics.error: none`. `result.derivatives` are computed on first use. Raises `SceneError`
    for faults of the scene, also of values that a program has put into it, `UsageError` for a fluid that is not
    available.
    """
    scene = scene_of(scene)
    try:
        result = simulated(scene, trace)
    except UsageError:
        faults = cross_check(scene)  # of values that were not read from a file
        if not faults:
            raise
        raise SceneError(list(map(str, faults))) from None
    found = Derivatives(partial(sensitivities, scene, result=result), result.performance, scene)
    return replace(result, derivatives=found)


def kept_slopes(scene: Scene, result: Result) -> Sensitivities | None:
    """Return the derivatives of a result that its scene keeps (`output.derivatives`); None for none."""
    if not scene.output.keeps_slopes or result.status != "ok":
        return None
    found = scene_sensitivities(scene, result=result)
    return found if found.derivatives else None


def save_point(file: Path, scene: Scene, result: Result) -> None:
    """Write a result to a file, with the derivatives that its scene keeps."""
    from screwsim.results import save

    save(file, scene, result, derivatives=kept_slopes(scene, result))


def with_slopes(scene: Scene, result: Result) -> Result:
    """Return a result together with the derivatives that its scene keeps."""
    found = kept_slopes(scene, result)
    return result if found is None else replace(result, derivatives=Derivatives.of(found, result.performance))
