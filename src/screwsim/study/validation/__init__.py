"""Validation: published references beside computed values, with verdicts that can be `fails`.

A source is a folder `validation/<name>/` of the checkout: data with their source and uncertainty, scenes, and
`compare.py` with one function, `compare(here: Path) -> Comparison`. This package has everything that such a module
needs.
"""

import importlib.util
import sys
import time
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from shlex import quote
from traceback import extract_tb
from types import ModuleType
from typing import Any

import screwsim
from screwsim.inputs.faults import Interrupted, SceneError, UsageError, in_one_line
from screwsim.inputs.sheets import BadSheet, read_sheet
from screwsim.inputs.suggestions import nearest
from screwsim.inputs.textfiles import Unreadable, read_text
from screwsim.outputs import Result
from screwsim.scene import load, with_values
from screwsim.simulate import simulate
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.validation.discrepancy import compared, model_errors
from screwsim.study.validation.record import (
    VERDICTS,
    Comparison,
    NotRun,
    Panel,
    Row,
    Series,
    ValidationPoint,
    equal,
    trend,
    value_text,
)
from screwsim.version import version

FOLDER, MODULE = "validation", "compare.py"
PACKAGE_FOLDER = Path(screwsim.__file__).resolve().parent
# the longest; side by side they compile different models
LONGEST_SOURCES = ("plain", "exact", "bitzer", "paper", "cross_code")
INTERRUPTED = "interrupted"  # reason of a source that Ctrl-C left undone
WORKER_DIED = "its worker died (run this source alone)"


@dataclass(frozen=True)
class SourceOutcome:
    """Result of one source: the comparison, or why there is none; time [s]."""

    name: str
    comparison: Comparison | None
    reason: str
    seconds: float


def folder_of(wanted: str | Path | None = None) -> Path:
    """Return the folder of the sources: the wanted one, or `validation/` of the running checkout or package.

    The sources are programs, so none is searched for in the working directory. Raises UsageError where there is none.
    """
    if wanted is not None:
        folder = Path(wanted)
        if names_of(folder):
            return folder.resolve()
        raise UsageError(f"{folder}: holds no sources (--folder takes the folder validation/ of a checkout)")
    root = _checkout()
    if root is not None and names_of(root / FOLDER):
        return root / FOLDER
    inside = PACKAGE_FOLDER / "shipped" / FOLDER
    if names_of(inside):
        return inside
    raise UsageError(
        f"this screwsim ({PACKAGE_FOLDER}) has no folder {FOLDER}/: it comes with a checkout and with built packages "
        f"(name one whose programs {MODULE} you trust with --folder, or run screwsim from a checkout)"
    )


def _checkout() -> Path | None:
    """Return the checkout whose source is the running package; None for an installed one."""
    root = PACKAGE_FOLDER.parents[1]
    try:
        project = tomllib.loads(read_text(root / "pyproject.toml"))
    except (Unreadable, tomllib.TOMLDecodeError):
        return None
    ours = PACKAGE_FOLDER.parent.name == "src" and project.get("project", {}).get("name") == PACKAGE_FOLDER.name
    return root if ours else None


def names_of(folder: Path) -> list[str]:
    """Return the names of the sources in a folder, in alphabetical order."""
    return sorted(path.parent.name for path in folder.glob(f"*/{MODULE}"))


def run_sources(
    folder: Path, names: Sequence[str] = (), progress: Progress | None = None, jobs: int | None = 1
) -> list[SourceOutcome]:
    """Return the results of the named sources (default: all), run `jobs` at a time (None: as many as cores).

    Raises UsageError for an unknown name. Ctrl-C raises KeyboardInterrupt, or `Interrupted` once one is compared: with
    all of them, those that had not finished with the reason `INTERRUPTED`.
    """
    known = names_of(folder)
    for name in names:
        if name not in known and Path(name).suffix in (".yaml", ".yml"):
            told = f"screwsim run {quote(name)} simulates a scene, screwsim calibrate {quote(name)} fits one"
            what = "is a file, but a source is named, not a file"
            raise UsageError(f"{name}: {what} ({told}; known: {', '.join(known)})")
        if name not in known:
            near = nearest(name, known)
            hint = f"did you mean {near}?" if near else f"known: {', '.join(known)}"
            raise UsageError(f"{name}: no source of that name in {folder} ({hint})")
    wanted = list(dict.fromkeys(names)) or known
    long = [name for name in LONGEST_SOURCES if name in wanted]
    begun = [*long, *(name for name in wanted if name not in long)]
    finished: dict[int, SourceOutcome] = {}

    def ordered(outcomes: Iterable[SourceOutcome]) -> list[SourceOutcome]:
        return sorted(outcomes, key=lambda outcome: wanted.index(outcome.name))

    try:
        outcomes = parallel_map(
            partial(_run_source, tuple(folder / name for name in begun)),
            len(begun),
            died=lambda number: SourceOutcome(begun[number], None, WORKER_DIED, 0.0),
            jobs=jobs,
            failed=lambda outcome: outcome.comparison is None,
            progress=progress,
            kept=finished.update,
        )
    except KeyboardInterrupt as pressed:
        if not finished:
            raise
        left = {number: SourceOutcome(name, None, INTERRUPTED, 0.0) for number, name in enumerate(begun)}
        raise Interrupted(ordered((left | finished).values())) from pressed
    return ordered(outcomes)


def _run_source(folders: tuple[Path, ...], number: int) -> SourceOutcome:
    folder, began, comparison, reason = folders[number], time.perf_counter(), None, ""
    try:
        found = sibling(folder / MODULE).compare(folder)
        if not isinstance(found, Comparison):
            raise NotRun(f"{folder / MODULE}: compare returns a {type(found).__name__} (return a Comparison)")
        comparison = found
    except (NotRun, SceneError, UsageError) as error:
        reason = " ".join(str(error).split())
    except Exception as error:  # noqa: BLE001 - a source is a program of somebody's, which may raise anything
        # of the program in that folder, which raised the error or called what did
        lines = [f"{file}:{line}" for file, line, *_ in extract_tb(error.__traceback__) if Path(file).parent == folder]
        place = lines[-1] if lines else folder / MODULE
        reason = f"{place}: fails ({in_one_line(error)}); {_remedy(folder, error)}"
    return SourceOutcome(folder.name, comparison, reason, time.perf_counter() - began)


def _remedy(folder: Path, error: Exception) -> str:
    """Return what to do about an error of the program in a folder, which may come from screwsim itself."""
    frames = list(extract_tb(error.__traceback__))
    while len(frames) > 1 and frames[-1].name in ("__getattr__", "__getitem__", "__missing__"):
        frames.pop()  # a name that there is not is the fault of who asks for it
    place = Path(frames[-1].filename).resolve()
    if place.is_relative_to(folder.resolve().parent) or not place.is_relative_to(PACKAGE_FOLDER):
        return "fix that program"
    where = f"{place.relative_to(PACKAGE_FOLDER.parent).as_posix()}:{frames[-1].lineno}"
    return f"it is a fault of screwsim, raised at {where}: please report it with that program"


def document(outcomes: Sequence[SourceOutcome]) -> dict[str, Any]:
    """Return everything as one document; it has no times, so that equal results give equal documents."""
    sources: dict[str, Any] = {}
    counts: dict[str, int] = dict.fromkeys(VERDICTS, 0)
    for outcome in outcomes:
        if outcome.comparison is None:
            sources[outcome.name] = {"status": "not run", "reason": outcome.reason, "rows": [], "panels": []}
            continue
        told = asdict(outcome.comparison)
        del told["points"]  # `errors_of` reports these
        sources[outcome.name] = {"status": "ok", **told}
        for row in outcome.comparison.rows:
            counts[row.verdict] += 1
    return {"version": version(), "verdicts": counts, "sources": sources}


def errors_of(outcomes: Sequence[SourceOutcome]) -> dict[str, Any]:
    """Return the model errors by machine; nothing for sources that compare no figures."""
    found: dict[str, Any] = {}
    for outcome in outcomes:
        if outcome.comparison is not None:
            one = outcome.comparison
            found |= model_errors(one.points, outcome.name, one.citation)
    return found


def solved(
    scene_file: Path, overrides: Sequence[str] = (), values: Mapping[str, Any] | None = None, trace: bool = False
) -> Result:
    """Return the result of a scene that must close; `values` are in SI units. Raises NotRun where it does not."""
    scene = load(scene_file, overrides)
    result = simulate(with_values(scene, dict(values or {})), trace=trace)
    if result.status != "ok":
        raise NotRun(f"{scene_file.name} {' '.join(overrides)}: {result.told}")
    return result


def read_table(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV file whose lines starting with `#` state the source of its numbers. Raises NotRun."""
    try:
        return read_sheet(path).records()
    except (BadSheet, Unreadable) as fault:
        raise NotRun(f"{path}: {fault}") from None


def sibling(path: Path) -> ModuleType:
    """Return a Python file of the checkout as a module, loaded once."""
    name = f"screwsim_validation_{path.parent.name}_{path.stem}"
    if name in sys.modules and sys.modules[name].__file__ == str(path):
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise NotRun(f"{path}: is not a Python module")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
