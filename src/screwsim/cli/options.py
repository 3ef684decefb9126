"""Shared by several commands: exit codes, arguments and options, and loading of the scene."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Any, TypeVar

from screwsim.cli.declare import CHANGES, argument, option, switch
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import counted
from screwsim.inputs.workbooks import TABLES
from screwsim.screen import say

if TYPE_CHECKING:
    from screwsim.scene import Scene
    from screwsim.scene.grid import Swept
    from screwsim.study.pool.progress import Progress
    from screwsim.study.stages.chain import StageChain

AnyScene = TypeVar("AnyScene", bound="Scene | StageChain")
OK, INTERNAL, USAGE, BAD_SCENE, NOT_ALL_OK, INTERRUPTED = 0, 1, 2, 3, 4, 130

RESULTS = (".h5", ".hdf5", ".hdf", ".nc", ".nc4")  # HDF5, and netCDF-4, which is HDF5
PAGES = (".html", ".htm")
FILES = {*RESULTS, *PAGES, *TABLES, ".json", ".yaml", ".yml", ".png", ".pdf", ".svg", ".txt", ".md", ".dxf"}

_done = ""  # what the interrupted command had done


SCENE_FILE = argument("SCENE", "The scene, a YAML file.")
RESULTS_FILE = argument("OUT.h5", "Results of run or sweep.")
OVERRIDES = option("PATH=VALUE", "Change one path, e.g. operation.speed='1000 rpm'.", CHANGES)
WITHOUT = option("EFFECT", "Leave an effect out.")
AS_JSON = switch("--json", "Print one JSON document on stdout, nothing else.")
JOBS = option("N", "Worker processes (default: all cores).", min=1)


def loaded_scene(scene_file: str, overrides: Sequence[str] | None, without: Sequence[str] | None) -> Scene:
    """Return the scene of a command."""
    from screwsim.scene import load

    return load(scene_file, overrides or (), without or ())


def loaded_scene_or_stages(
    scene_file: str, verb: str, overrides: Sequence[str] | None, without: Sequence[str] | None
) -> Scene | StageChain:
    """Return the scene of a command, or the two stages that its file joins; effects stay in both of these."""
    from screwsim.scene.file_kinds import is_stages

    if not is_stages(scene_file):
        return loaded_scene(scene_file, overrides, without)
    from screwsim.study.stages import read_stages

    refuse_for_stages(scene_file, verb, {"--without": without})
    chain = read_stages(scene_file, overrides or ())
    report_sweeps_of_stages(chain, scene_file)
    return chain


def loaded_point(scene_file: str, overrides: Sequence[str] | None, without: Sequence[str] | None) -> Scene:
    """Return the scene of a command that simulates one point; a sweep is left out, which is reported on stderr."""
    return base_point(loaded_scene(scene_file, overrides, without), scene_file)


def first_given(options: Mapping[str, Any]) -> str:
    """Return the name of the first option that was given; '' where none was."""
    return next((name for name, value in options.items() if value), "")


def refuse_for_stages(file: str, verb: str, options: Mapping[str, Any]) -> None:
    """Raise UsageError if an option was given that a command does not have for two stages."""
    if name := first_given(options):
        raise UsageError(f"{file}: stages have no {name} ({verb} one of the two scenes instead)")


def progress_bar(title: str = "sweep", names: Sequence[str] = ()) -> Progress:
    """Return a progress display on stderr for a study."""
    from screwsim.study.pool.progress import for_terminal

    return for_terminal(title, names)


def tell_with_interruption(done: str) -> None:
    """State what the command has done, for the one line that ends it where it is interrupted."""
    global _done
    _done = done


def told_with_interruption() -> str:
    """Return what the command has done; empty where it stated nothing."""
    return _done


@contextlib.contextmanager
def counted_progress(title: str, what: str) -> Iterator[Progress]:
    """Give a progress display; the line after Ctrl-C has how many were done, in a word for the points (`machines`)."""
    from screwsim.study.pool.progress import CountingProgress

    shown = progress_bar(title)
    counted = shown if isinstance(shown, CountingProgress) else CountingProgress()
    try:
        yield counted
    except KeyboardInterrupt:
        done, there_are = counted.counts
        if done:
            kept = "none is kept, and the same command begins anew"
            tell_with_interruption(f"{title}: {done} of {there_are} {what} were done; {kept}")
        raise


def changes(overrides: Sequence[str] | None, without: Sequence[str] | None) -> list[str]:
    """Return in words what a command line changes in its scene, which its title does not tell."""
    return [*(f"with {each}" for each in overrides or ()), *(f"without {each}" for each in without or ())]


def titled(found: Any, changed: Sequence[str]) -> Any:
    """Return what is exported with what the command line changes behind its title, which does not tell it."""
    return replace(found, title=title_with(found.title, changed))


def title_with(title: str, changed: Sequence[str]) -> str:
    """Return a title with what the command line changes in its scene, on one line."""
    return " ".join(", ".join(filter(None, (title, *changed))).split()) if changed else title


def print_document_or_text(
    as_json: bool, document: Callable[..., Any], printed: Callable[..., None], *found: Any
) -> None:
    """Print a result as its JSON document, or as text."""
    from screwsim.printing import print_json

    if as_json:
        print_json(document(*found))
    else:
        printed(*found)


def check_results(output: Path) -> None:
    """Raise UsageError where a name for results has another ending than HDF5, is a folder's, or cannot be written."""
    if output.suffix and output.suffix.lower() not in RESULTS:
        good = output.with_suffix(RESULTS[0])
        also = "; screwsim report makes a page of it" if output.suffix.lower() in PAGES else ""
        also = "; screwsim export cases makes a table of it" if output.suffix.lower() in TABLES else also
        what = f"results are HDF5, so the name must end in {', '.join(RESULTS)}"
        raise UsageError(f"-o {output}: {what} (write -o {good}{also})")
    if output.is_dir():
        raise UsageError(f"-o {output}: is a folder (name a file in it, e.g. -o {output / 'out.h5'})")
    _check_writable(output)


def _check_writable(output: Path) -> None:
    from screwsim.results.atomic import check_target_kind, check_writable

    check_target_kind(output)
    check_writable(output)


def check_new(output: Path) -> None:
    """Raise UsageError where a file exists already: a scene is never overwritten."""
    if output.exists():
        raise UsageError(f"-o {output}: already exists and is not overwritten (choose another name, or remove it)")


def check_target(output: Path | None, *endings: str) -> None:
    """Raise UsageError unless the file name has one of the endings, and can be written."""
    if output is None:
        return
    if output.suffix.lower() not in endings:
        raise UsageError(f"-o {output}: needs an ending that states its format (one of {', '.join(endings)})")
    from screwsim.results.tables import check_workbook

    check_workbook(output)
    _check_writable(output)


def check_columns(output: Path | None, title: str, *names: str) -> None:
    """Raise UsageError unless the file name has an ending of columns, and any file there holds such columns."""
    from screwsim.study.columns import protect_other_columns

    check_target(output, *TABLES, ".h5")
    if output is not None:
        protect_other_columns(output, title, *names)


def check_page(output: Path) -> None:
    """Raise UsageError where a page's file name has another ending, is not a page's, or cannot be written."""
    from screwsim.results.protection import PAGE, protect_unmarked

    protect_unmarked(output, PAGE)
    if output.suffix.lower() not in PAGES:
        good = output.with_suffix(PAGES[0])
        what = f"a page is written, so the name must end in {' or '.join(PAGES)}"
        raise UsageError(f"-o {output}: {what} (write -o {good})")
    _check_writable(output)


def check_folder(folder: Path | None) -> None:
    """Raise UsageError where a folder's name is that of a file, by its ending or on disk, or cannot be written to."""
    if folder is None:
        return
    if folder.suffix.lower() in FILES or folder.is_file():
        good = folder.with_suffix("") if folder.suffix else folder.with_name(f"{folder.name}_files")
        raise UsageError(f"-o {folder}: several files are written, so name a folder (e.g. -o {good})")
    from screwsim.results.atomic import check_writable_folder

    check_writable_folder(folder)


def check_place(output: Path) -> None:
    """Raise UsageError where a run's results would replace anything but results of a run."""
    from screwsim.results import open_results
    from screwsim.results.atomic import HDF5_SIGNATURE, has_content, protect_others

    protect_others(output, HDF5_SIGNATURE)
    check_results(output)
    if has_content(output) and open_results(output).shape:
        raise UsageError(f"{output}: holds results of a sweep (choose another -o, or remove it)")


def print_files(files: Iterable[Path | str], as_json: bool = False) -> None:
    """Print the names of the files that a command wrote, below all else; on stderr beside a JSON document."""
    for file in files:
        say(str(file), err=as_json)


def tell_left(folder: Path, files: Iterable[Path | str], *patterns: str) -> None:
    """Say on stderr which files of the patterns an earlier command left in a folder, beside those just written."""
    written = {Path(file).resolve() for file in files}
    left = sorted(str(file) for each in patterns for file in folder.glob(each) if file.resolve() not in written)
    if left:
        what = "from an earlier command, not of these results (remove it, or name another folder)"
        say(f"warning: {', '.join(left)}: {what}", err=True)


def base_point(scene: AnyScene, file: str) -> AnyScene:
    """Return the scene without its sweep, as stored with the result; if it has one, report that on stderr."""
    if not scene.sweep:
        return scene
    from screwsim.scene import without_sweep
    from screwsim.study.asked.varied import with_text

    report_ignored_sweep(scene, f"{file}: its", f"screwsim sweep {quote(file)} simulates the sweep")
    return with_text(without_sweep(scene))


def report_sweeps_of_stages(chain: StageChain, file: str) -> None:
    """Report on stderr that the sweeps of the scenes of a two-stage file are ignored, if there are some."""
    for name, scene in chain.by_stage.items():
        report_ignored_sweep(scene, f"{file}: the {name} scene's", "a sweep of two stages stands in the two-stage file")


def report_ignored_sweep(scene: Swept, whose: str, remedy: str) -> None:
    """Report on stderr that a command ignores the sweep of a scene, if there is one."""
    from screwsim.scene import case_count

    if scene.sweep:
        cases = counted(case_count(scene), "case")
        say(f"{whose} sweep of {cases} is ignored, and the scene's own point is used ({remedy})", err=True)


def print_error(text: str, code: int) -> int:
    """Print an error on stderr, after all other output; return the exit code."""
    with contextlib.suppress(OSError):
        sys.stdout.flush()
    say(text, err=True)
    return code
