"""The command `screwsim`: arguments to calls, and what they give to print and exit codes.

Heavy modules are imported inside the commands, so that `--help` answers at once.
"""

from __future__ import annotations

import contextlib
import errno
import io
import os
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from screwsim import __version__
from screwsim.cli import mistakes, process, startup, studies
from screwsim.cli.options import (
    BAD_SCENE,
    INTERNAL,
    INTERRUPTED,
    NOT_ALL_OK,
    OK,
    USAGE,
    AsJson,
    Jobs,
    Overrides,
    SceneFile,
    Without,
    check_drawer,
    check_page,
    check_place,
    check_results,
    say_left_aside,
)
from screwsim.cli.options import base_point as _base_point
from screwsim.cli.options import loaded as _loaded
from screwsim.faults import SceneError, UsageError
from screwsim.screen import say

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)  # what a disk says that takes no more

app = typer.Typer(
    name="screwsim",
    help="Simulate oil-flooded twin-screw compressors, chamber by chamber.",
    epilog="Exit codes: 0 ok, 1 internal error, 2 usage, 3 bad scene, 4 some cases failed or did not close, "
    "130 interrupted. A reader of the output that leaves early (| head) changes none of them.",
    add_completion=False,
    suggest_commands=False,  # mistakes.explain does, where following it does nothing else
    no_args_is_help=True,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        say(f"screwsim {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None: ...


@app.command()
def run(
    scene_file: SceneFile,
    output: Annotated[Path | None, typer.Option("-o", metavar="OUT.h5", help="Write the result, with traces.")] = None,
    overrides: Overrides = None,
    without: Without = None,
    knock_out: Annotated[
        bool, typer.Option("--knock-out", help="Leave each effect out in turn, and say what that changes.")
    ] = False,
    as_json: AsJson = False,
) -> int:
    """Simulate one operating point, or two stages in a row (a file with stages: [first.yaml, second.yaml])."""
    from screwsim.study.stages import is_stages

    if is_stages(scene_file):
        return _run_stages(scene_file, output, overrides, without, knock_out, as_json)
    scene = _base_point(_loaded(scene_file, overrides, without), scene_file)
    if output is not None:
        check_place(output)
    from screwsim.printing import print_json, print_result
    from screwsim.simulate import simulate

    result = simulate(scene)
    if knock_out and result.performance:
        from screwsim.study.knock_out import knock_out as knocked_out
        from screwsim.study.progress import for_terminal

        names = [f"without {name}" for name in scene.effects]
        result = knocked_out(scene, result, for_terminal("knock-out", names))
    if output is not None:
        from screwsim.results import save

        check_place(output)  # again: what came there meanwhile stays
        save(output, scene, result)
    if as_json:
        print_json(result.as_json())
    else:
        print_result(scene.title, result)
    return OK if result.status == "ok" else NOT_ALL_OK


def _run_stages(
    file: str, output: Path | None, overrides: Overrides, without: Without, knock_out: bool, as_json: bool
) -> int:
    if knock_out or without:
        raise UsageError(f"{file}: stages have no --knock-out and no --without (run one of the two scenes instead)")
    from screwsim.printing import print_json
    from screwsim.printing.stages import print_stages
    from screwsim.study.stages import read_stages, run_stages

    chain = read_stages(file, overrides or ())
    places = [] if output is None else [output.with_stem(f"{output.stem}_{name}") for name in ("first", "second")]
    for place in places:
        check_place(place)
    for name, scene in (("first", chain.first), ("second", chain.second)):
        say_left_aside(scene, f"{file}: the {name} scene's", "stages are not swept: run them once a value, with --set")
    found = run_stages(chain)
    if places and found.scenes:
        from screwsim.results import save

        for place, scene, result in zip(places, found.scenes, found.stages, strict=True):
            save(place, scene, result)
    if as_json:
        print_json(found.as_json())
    else:
        print_stages(chain.title, found)
    return OK if found.status == "ok" else NOT_ALL_OK


@app.command()
def sweep(
    scene_file: SceneFile,
    output: Annotated[
        Path | None, typer.Option("-o", metavar="OUT.h5", help="Where the results go (default: results/SCENE.h5).")
    ] = None,
    overrides: Overrides = None,
    without: Without = None,
    jobs: Jobs = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS|FILE", help="Compute on a dask scheduler's workers instead.")
    ] = None,
    case_limit: Annotated[
        float | None,
        typer.Option(
            min=0.001, metavar="SECONDS", help="Give up a case after that time (default: 300; with --jobs 1: never)."
        ),
    ] = None,
    restart: Annotated[bool, typer.Option("--restart", help="Compute again what is there.")] = False,
    as_json: AsJson = False,
) -> int:
    """Simulate the grid of a scene, or resume it."""
    if scheduler is not None and jobs is not None:
        raise UsageError("--jobs belongs to this machine; a --scheduler has workers of its own (remove one of the two)")
    scene = _loaded(scene_file, overrides, without)
    if not scene.sweep:
        raise UsageError(
            f"{scene_file}: has no sweep (write a block sweep:, or --set 'sweep.operation.speed=[1000 rpm, 3000 rpm]'; "
            "one point is simulated by screwsim run)"
        )
    from screwsim.printing import print_json, print_sweep, sweep_document
    from screwsim.study.progress import for_terminal
    from screwsim.study.sweep import run_sweep

    if output is not None:
        check_results(output)
    file = output or Path("results") / f"{Path(scene_file).stem}.h5"
    where = {"jobs": jobs, "scheduler": scheduler, "case_limit": case_limit}
    summary = run_sweep(scene, file, **where, restart=restart, progress=for_terminal())
    document = sweep_document(scene, summary)
    (print_json if as_json else print_sweep)(document)
    return OK if summary.ok == summary.cases else NOT_ALL_OK


@app.command()
def explain(
    scene_file: SceneFile,
    overrides: Overrides = None,
    without: Without = None,
    code: Annotated[bool, typer.Option("--code", help="Print the text that is compiled for the scene.")] = False,
) -> None:
    """Say what is simulated, and what is left out: of a scene, or of two stages in a row."""
    from screwsim.study.stages import explain_stages, is_stages, read_stages

    if is_stages(scene_file):
        if without or code:
            option = "--without" if without else "--code"
            raise UsageError(f"{scene_file}: stages have no {option} (explain one of the two scenes instead)")
        say(explain_stages(read_stages(scene_file, overrides or ())))
        return
    scene = _loaded(scene_file, overrides, without)
    import screwsim.explain as explained

    say(explained.code(scene) if code else str(explained.explain(scene)))


@app.command()
def accuracy(
    scene_file: SceneFile,
    folder: Annotated[
        Path | None, typer.Option("-o", metavar="DIR", help="Where table, data and figure go (default: nowhere).")
    ] = None,
    overrides: Overrides = None,
    without: Without = None,
    quick: Annotated[bool, typer.Option("--quick", help="Try less: seconds instead of minutes.")] = False,
) -> int:
    """Say what accuracy costs in time: integrators, gases, numerical choices, effects, size."""
    from screwsim.study.stages import is_stages

    if is_stages(scene_file):
        raise UsageError(f"{scene_file}: describes two stages, and accuracy is of one scene (name that of a stage)")
    scene = _base_point(_loaded(scene_file, overrides, without), scene_file)
    check_drawer(folder)
    from screwsim.printing import accuracy_drawing
    from screwsim.report.accuracy import draw
    from screwsim.results.atomic import make_folder
    from screwsim.study.accuracy import QUICK, Extent, NoReference, files, study, words
    from screwsim.study.progress import for_terminal

    if folder is not None:
        make_folder(folder)
    try:
        found = study(scene, QUICK if quick else Extent(), for_terminal("accuracy"))
    except NoReference as error:
        return _complain(f"{scene_file}: {error}", NOT_ALL_OK)
    say(words.report(found))
    if folder is not None:
        for path in (*files.write(found, folder), *draw(accuracy_drawing(found), folder)):
            say(path)
    return OK


@app.command()
def rotors(
    scene_file: SceneFile,
    folder: Annotated[
        Path | None, typer.Option("-o", metavar="DIR", help="Where figures, page, profiles and tables go.")
    ] = None,
    overrides: Overrides = None,
    as_json: AsJson = False,
) -> None:
    """Say what the rotor profile of a scene gives, and draw it."""
    check_drawer(folder)
    scene = _base_point(_loaded(scene_file, overrides, None), scene_file)
    from screwsim.printing import print_json
    from screwsim.report.rotors_scene import document, table_text, write
    from screwsim.scene.plausible import scene_warnings

    text = table_text(scene)
    for warning in (each for each in scene_warnings(scene) if each.startswith("machine.")):
        typer.echo(f"warning: {warning}", err=True)
    files = write(scene, folder) if folder is not None else []
    if as_json:
        print_json(document(scene, files))
    else:
        say("\n".join([text, *files]))


@app.command()
def plot(
    results_file: Annotated[str, typer.Argument(metavar="OUT.h5", help="Results of run or sweep.", show_default=False)],
    folder: Annotated[str | None, typer.Option("-o", metavar="DIR", help="Where the figures go.")] = None,
) -> None:
    """Draw the figures of a results file."""
    check_drawer(Path(folder) if folder is not None else None)
    from screwsim.report import plot as drawn

    for path in drawn(results_file, folder):
        say(path)


studies.add_to(app)
startup.add_to(app)


@app.command()
def report(
    results_file: Annotated[str, typer.Argument(metavar="OUT.h5", help="Results of run or sweep.", show_default=False)],
    output: Annotated[
        str | None, typer.Option("-o", metavar="OUT.html", help="Where the page goes (default: beside the file).")
    ] = None,
    other: Annotated[
        str | None, typer.Option("--with", metavar="OTHER.h5", help="The paper's other sweep: claims need both.")
    ] = None,
) -> None:
    """Make one page of a results file: figures, cycles, checks, scene; it opens in any browser, offline."""
    if output is not None:
        check_page(Path(output))
    from screwsim.report.page import report as made
    from screwsim.study.claims import claims_of

    target = output or str(Path(results_file).with_suffix(".html"))
    say(made(results_file, target, claims_of(results_file, other)))


@app.command()
def validate(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME]...", help="Sources (default: all).", show_default=False)
    ] = None,
    folder: Annotated[
        Path | None,
        typer.Option(
            "--folder",
            metavar="DIR",
            help="Where the sources lie, programs that are run (default: validation/ of the checkout that is running).",
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", metavar="DIR", help="Write validation.json and a figure a source.")
    ] = None,
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> int:
    """Hold what is computed against each published reference. A verdict that fails is a finding: exit code 0."""
    check_drawer(output)
    from screwsim.printing import print_json, write_json
    from screwsim.report.validation import draw
    from screwsim.results.atomic import make_folder
    from screwsim.study.progress import for_terminal
    from screwsim.study.validation import document, folder_of, run_sources
    from screwsim.study.validation.words import report

    outcomes = run_sources(folder_of(folder), names or (), for_terminal("validate"), jobs)
    found = document(outcomes)
    if as_json:
        print_json({**found, "seconds": {each.name: each.seconds for each in outcomes}})
    else:
        say(report(found))
    if output is not None:
        make_folder(output)
        for path in (write_json(found, output / "validation.json"), *draw(found, output)):
            say(path, err=as_json)
    return OK if all(each.comparison is not None for each in outcomes) else NOT_ALL_OK


@app.command()
def schema(
    fit: Annotated[bool, typer.Option("--fit", help="That of a fit (screwsim calibrate) instead.")] = False,
    stages: Annotated[bool, typer.Option("--stages", help="That of two stages in a row instead.")] = False,
) -> None:
    """Print the JSON Schema of a scene."""
    from screwsim.printing import print_json

    if fit and stages:
        raise UsageError("--fit and --stages are schemas of different files (ask for one of the two)")
    if stages:
        from screwsim.study.stages import stages_schema

        print_json(stages_schema())
        return
    if fit:
        from screwsim.study.calibration.schema import fit_schema

        print_json(fit_schema())
        return
    from screwsim.scene import schema as scene_schema

    print_json(scene_schema())


def exit_code(arguments: Sequence[str]) -> int:
    """Run a command; print on stderr what went wrong, and return the exit code."""
    try:
        # typer's own handling of errors would end with other exit codes
        outcome = typer.main.get_command(app).main(list(arguments), "screwsim", standalone_mode=False)
        sys.stdout.flush()  # what finds no room is told here, and not at Python's end
    except KeyboardInterrupt:
        outcome = INTERRUPTED
    except Exception as error:  # noqa: BLE001 - whatever it is, the user gets one line
        outcome = INTERRUPTED if process.interrupted() else _fault(error, arguments)
    if process.interrupted() or outcome == INTERRUPTED:  # some code in between may have swallowed it
        resumes = "; the sweep resumes when it is started again" if "sweep" in arguments[:1] else ""
        return _complain(f"interrupted{resumes}", INTERRUPTED)
    return outcome if isinstance(outcome, int) else OK


def _fault(error: Exception, arguments: Sequence[str]) -> int:
    """Print what went wrong, and return the exit code."""
    if isinstance(error, SceneError):
        return _complain("\n".join(error.lines), BAD_SCENE)
    if isinstance(error, UsageError):
        return _complain(" ".join(str(error).splitlines()), USAGE)
    if isinstance(error, typer.Abort):  # how typer tells the end of a file where nothing was asked
        return _internal(error.__cause__ if isinstance(error.__cause__, Exception) else error)
    if isinstance(error, typer.TyperException):  # the arguments make no sense
        mistakes.explain(error, arguments, typer.main.get_group(app).commands)
        return _complain(_shown(error), USAGE)
    if isinstance(error, OSError) and error.errno in FULL:
        where = error.filename or "a file"
        remedy = "make room, or send it elsewhere"
        return _complain(f"{where}: cannot be written: {os.strerror(error.errno)} ({remedy})", USAGE)
    return _internal(error)


def _shown(error: typer.TyperException) -> str:
    """Return usage and error as typer shows them."""
    told = io.StringIO()
    getattr(error, "show", lambda file: None)(file=told)
    return told.getvalue().rstrip()


def _internal(error: Exception) -> int:
    if os.environ.get("SCREWSIM_DEBUG") == "1":
        traceback.print_exc()
    text = " ".join(f"{type(error).__name__}: {error}".split())
    remedy = "this is a fault of screwsim, please report it with the scene (SCREWSIM_DEBUG=1 prints the traceback)"
    return _complain(f"internal error: {text}\n{remedy}", INTERNAL)


def _complain(text: str, code: int) -> int:
    with contextlib.suppress(OSError):
        sys.stdout.flush()
    say(text, err=True)
    return code


def main() -> None:
    """Be the command `screwsim`."""
    process.begin()
    try:
        code = exit_code(sys.argv[1:])
    except KeyboardInterrupt:  # pressed between two lines above
        code = _complain("interrupted", INTERRUPTED)
    process.end(code)
