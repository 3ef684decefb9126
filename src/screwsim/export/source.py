"""A map, or a run with its cycle, from a command's argument: a scene to simulate, or a file with the results."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from shlex import quote
from typing import Any

import numpy as np

from screwsim.export.inputs import Input, read_inputs, read_outputs
from screwsim.export.map_table import MapTable
from screwsim.export.table import table_of, tabulated_map
from screwsim.figures import Performance, known
from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.inputs.textfiles import HDF5
from screwsim.outputs import Result
from screwsim.results import Results, open_results
from screwsim.scene import Scene, load, loads, without_sweep
from screwsim.scene.file_kinds import is_stages
from screwsim.scene.units import Refused, parse_quantity
from screwsim.simulate import simulate
from screwsim.study.asked.figures import figure_named
from screwsim.study.asked.varied import Varied, accuracy_of
from screwsim.study.pool.progress import Progress
from screwsim.study.stages import read_stages

DEFAULT_ERROR = 0.005  # relative error of a map, if none is requested
MOST_CASES = 5000


def is_results(source: str) -> bool:
    """Tell whether a path is a results file, by its first bytes; False if it cannot be read."""
    try:
        with Path(source).open("rb") as stream:
            return stream.read(len(HDF5)) == HDF5
    except OSError:
        return False


def refuse_changes(source: str, given: Mapping[str, Any]) -> None:
    """Raise UsageError where an option is given that cannot change stored results."""
    stray = next((name for name, value in given.items() if value), None)
    if stray is not None:
        raise UsageError(f"{source}: holds results, which {stray} cannot change (name their scene instead)")


def load_varied(source: str, overrides: Sequence[str] | None, without: Sequence[str] | None) -> Varied:
    """Return the scene of a file, or the two stages that it joins; raise `SceneError` or `UsageError`."""
    if not is_stages(source):
        return load(source, overrides or (), without or ())
    if without:
        raise UsageError(f"{source}: stages have no --without (write EFFECT: off in the scene of a stage)")
    return read_stages(source, overrides or ())


def refuse_stages(source: str, why: str) -> None:
    """Raise UsageError where a scene's file describes two stages, with the reason and the remedy."""
    if not is_results(source) and is_stages(source):
        raise UsageError(f"{source}: describes two stages, and {why}")


def map_of(
    source: str,
    over: Sequence[str] | None = None,
    figures: Sequence[str] | None = None,
    wanted: float | None = None,
    most: int | None = None,
    overrides: Sequence[str] | None = None,
    without: Sequence[str] | None = None,
    jobs: int | None = None,
    progress: Callable[[], Progress] | None = None,
    told: Callable[[Varied, tuple[Input, ...]], None] | None = None,
) -> MapTable:
    """Return the map of a scene's file or of a results file; raise `SceneError` or `UsageError`.

    `told` is called with the scene and the inputs before anything is simulated.
    """
    if is_results(source):
        given = {"--over": over, "--error": wanted, "--most-cases": most, "--set": overrides, "--without": without}
        refuse_changes(source, given)
        return map_of_results(open_results(source), figures)
    scene = load_varied(source, overrides, without)
    return map_of_scene(scene, over or (), figures, wanted, most, jobs, progress, told)


def map_of_results(results: Results, figures: Sequence[str] | None) -> MapTable:
    """Return the map of a sweep's results; raise `UsageError` for a figure that they do not have."""
    names = [figure_named(text, results.figures, results.error) for text in figures or ()]
    absent = [name for name in names if name not in results.figures]
    if absent:
        raise UsageError(f"{results.path}: has no {absent[0]} (it has {', '.join(results.figures)})")
    return table_of(results, names or None)


def map_of_scene(
    scene: Varied,
    over: Sequence[str] | Mapping[str, tuple[float, float]],
    figures: Sequence[str] | None,
    wanted: float | None,
    most: int | None,
    jobs: int | None,
    progress: Callable[[], Progress] | None,
    told: Callable[[Varied, tuple[Input, ...]], None] | None = None,
    dashes: str = "--",
) -> MapTable:
    """Return the map of a scene, or of two stages, over paths.

    Raise `UsageError`, with `dashes` before the names of what was given.
    """
    asked = DEFAULT_ERROR if wanted is None else wanted
    if not accuracy_of(scene) < asked < 1.0:
        what = f"is not between the scene's numerics.accuracy {accuracy_of(scene):g} and 1"
        why = "a map cannot be more accurate than the solutions it is made from"
        raise UsageError(f"{dashes}error {asked:g}: {what} ({why})")
    inputs, outputs = read_inputs(scene, over, f"{dashes}over"), read_outputs(scene, figures or (), f"{dashes}figure")
    if told is not None:
        told(scene, inputs)
    most = MOST_CASES if most is None else most
    return tabulated_map(scene, inputs, outputs, asked, most=most, jobs=jobs, progress=progress)


def run_of(
    source: str,
    overrides: Sequence[str] = (),
    without: Sequence[str] = (),
    check: Callable[[Scene], None] = lambda scene: None,
) -> tuple[Scene, Result]:
    """Return a scene without its sweep, and its result with the cycle; raise `SceneError` or `UsageError`.

    `check` is called with the scene before anything is simulated.
    """
    if not is_results(source):
        alone = "screwsim run -o OUT.h5, then screwsim scene OUT.h5 --stage first, gives one to be named here"
        refuse_stages(source, f"loads are those of one machine ({alone})")
        scene = without_sweep(load(source, overrides, without))
        check(scene)
        return scene, simulate(scene)
    if overrides or without:
        raise UsageError(f"{source}: holds results, which --set and --without cannot change (name their scene instead)")
    results = open_results(source)
    if results.stages:
        file = "OUT.h5" if results.shape else source
        alone = f"screwsim scene {quote(file)} --stage {next(iter(results.stages))} gives its scene, to be named here"
        alone = f"for one point screwsim run -o OUT.h5, then {alone}" if results.shape else alone
        raise UsageError(f"{source}: holds two stages, and loads are those of one machine ({alone})")
    if results.shape or "angle" not in results.cycle:
        raise UsageError(f"{source}: holds no cycle of one run (write one with screwsim run -o, or name the scene)")
    try:
        scene = loads(results.scene_yaml, source, str(Path(source).resolve().parent))
    except SceneError as error:
        raise UsageError(f"{source}: its scene cannot be read from here (name its file): {error.lines[0]}") from None
    check(scene)
    cycle = {name: np.asarray(results.cycle[name]) for name in results.cycle}
    figures = {name: float(results.performance[name]) for name in results.figures}
    status, message = str(results.status), str(results.messages)
    return scene, Result(status, message, performance=Performance(figures, known()), cycle=cycle)


def spans_of(text: str | None, option: str = "--bearings") -> tuple[float, float] | None:
    """Return two lengths [m] from a text such as '40 mm,60 mm', or None for None; raise UsageError with `option`."""
    if text is None:
        return None
    parts = text.split(",")
    try:
        one, two = (parse_quantity(KINDS["length"], part) for part in parts)
    except (Refused, ValueError) as why:
        said = why if isinstance(why, Refused) else f"{len(parts)} lengths"
        raise UsageError(f"{option} {text}: {said} (write two with units, e.g. '40 mm,60 mm')") from None
    if min(one, two) < 0.0:
        why = "a bearing lies outside the rotor" if option == "--bearings" else "a diameter cannot be negative"
        raise UsageError(f"{option} {text}: {why} (write lengths of 0 and more)")
    return one, two
