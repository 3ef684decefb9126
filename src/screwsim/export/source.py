"""A map of what a command names: a scene, which is simulated for it, or a file of a sweep, which holds it."""

from collections.abc import Callable, Sequence
from pathlib import Path

from screwsim.export.inputs import Input, read_inputs, read_outputs
from screwsim.export.table import Table, table_of, tabulate
from screwsim.inputs.faults import UsageError
from screwsim.results import open_results
from screwsim.scene import Scene, load
from screwsim.study.figures import figure_named
from screwsim.study.progress import Progress

WANTED = 0.005  # relative error of a map, where none is asked for
MOST_CASES = 5000
_HDF5 = b"\x89HDF"


def is_results(source: str) -> bool:
    """Tell whether a name is that of a file of results, by its first bytes; False of one that cannot be read."""
    try:
        with Path(source).open("rb") as stream:
            return stream.read(len(_HDF5)) == _HDF5
    except OSError:
        return False


def map_of(
    source: str,
    over: Sequence[str] = (),
    figures: Sequence[str] = (),
    wanted: float | None = None,
    most: int | None = None,
    overrides: Sequence[str] = (),
    without: Sequence[str] = (),
    jobs: int | None = None,
    progress: Callable[[], Progress] | None = None,
    told: Callable[[Scene, tuple[Input, ...]], None] | None = None,
) -> Table:
    """Return the map of a scene's file or of a file of results; raise `SceneError` or `UsageError`.

    `told` is called with what will be mapped before anything is simulated.
    """
    if is_results(source):
        given = {"--over": over, "--error": wanted, "--most-cases": most, "--set": overrides, "--without": without}
        stray = [name for name, value in given.items() if value]
        if stray:
            raise UsageError(f"{source}: holds results, which {stray[0]} cannot change (name their scene instead)")
        results = open_results(source)
        names = [figure_named(text, results.figures, results.error) for text in figures]
        absent = [name for name in names if name not in results.figures]
        if absent:
            raise UsageError(f"{source}: has no {absent[0]} (it has {', '.join(results.figures)})")
        return table_of(results, names or None)
    scene = load(source, overrides, without)
    asked = WANTED if wanted is None else wanted
    if not scene.numerics.accuracy < asked < 1.0:
        what = f"is not between the scene's numerics.accuracy {scene.numerics.accuracy:g} and 1"
        raise UsageError(f"--error {asked:g}: {what} (a map cannot be better than what it is made from)")
    inputs, outputs = read_inputs(scene, over), read_outputs(scene, figures)
    if told is not None:
        told(scene, inputs)
    most = MOST_CASES if most is None else most
    return tabulate(scene, inputs, outputs, asked, most=most, jobs=jobs, progress=progress)
