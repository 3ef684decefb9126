"""A run with its cycle, of a scene that is simulated or of a file that keeps one; and lengths of an option."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from screwsim.export.source import is_results
from screwsim.figures import Performance, known
from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import Result
from screwsim.results import open_results
from screwsim.scene import Scene, load, loads
from screwsim.scene.units import Refused, parse_quantity
from screwsim.simulate import simulate


def run_of(source: str, overrides: Sequence[str] = (), without: Sequence[str] = ()) -> tuple[Scene, Result]:
    """Return a scene without its sweep and its result with the cycle; raise `SceneError` or `UsageError`."""
    if not is_results(source):
        scene = load(source, overrides, without)
        scene = replace(scene, sweep={}, joints=())
        return scene, simulate(scene)
    if overrides or without:
        raise UsageError(f"{source}: holds results, which --set and --without cannot change (name their scene instead)")
    results = open_results(source)
    if results.shape or "angle" not in results.cycle:
        raise UsageError(f"{source}: holds no cycle of one run (write it with screwsim run -o, or name the scene)")
    try:
        scene = loads(results.scene_yaml, source, str(Path(source).resolve().parent))
    except SceneError as error:
        raise UsageError(f"{source}: its scene cannot be read from here (name its file): {error.lines[0]}") from None
    cycle = {name: np.asarray(results.cycle[name]) for name in results.cycle}
    figures = {name: float(results.performance[name]) for name in results.figures}
    status, message = str(results.status), str(results.messages)
    return scene, Result(status, message, performance=Performance(figures, known()), cycle=cycle)


def spans_of(text: str | None, option: str = "--bearings") -> tuple[float, float]:
    """Return two lengths [m] of a text '40 mm,60 mm'; (0, 0) without one. Raise UsageError, which names the option."""
    if text is None:
        return 0.0, 0.0
    parts = text.split(",")
    try:
        one, two = (parse_quantity(KINDS["length"], part) for part in parts)
    except (Refused, ValueError) as why:
        said = why if isinstance(why, Refused) else f"{len(parts)} lengths"
        raise UsageError(f"{option} {text}: {said} (write two with units, e.g. '40 mm,60 mm')") from None
    if min(one, two) < 0.0:
        why = "a bearing lies outside of the rotor" if option == "--bearings" else "a diameter is not negative"
        raise UsageError(f"{option} {text}: {why} (write lengths of 0 and more)")
    return one, two
