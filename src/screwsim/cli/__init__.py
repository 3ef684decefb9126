"""The command `screwsim`: from arguments to calls, printed output and exit codes.

Heavy modules are imported inside the commands, so that `--help` answers at once.
"""

import copy
import errno
import io
import os
import re
import shlex
import sys
import traceback
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Annotated, Any

import typer

from screwsim.cli import files, points, process, seek, studies
from screwsim.cli.declare import Command, summary
from screwsim.cli.export import app as export_app
from screwsim.cli.machine import datasheet, startup
from screwsim.cli.new import new
from screwsim.cli.options import (
    BAD_SCENE,
    INTERNAL,
    INTERRUPTED,
    OK,
    USAGE,
    print_error,
    tell_with_interruption,
    told_with_interruption,
)
from screwsim.inputs.faults import SceneError, UsageError, in_one_line
from screwsim.inputs.suggestions import nearest
from screwsim.screen import say
from screwsim.version import version

PATH_ERRORS = (errno.ENAMETOOLONG, errno.EACCES, errno.EPERM, errno.EROFS, errno.ELOOP)
DISK_FULL_ERRORS = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)  # errors of a disk that is full

app = typer.Typer(
    name="screwsim",
    help="Simulate oil-flooded twin-screw compressors, chamber by chamber; expanders and cylinders, too.",
    epilog="Exit codes: 0 ok, 1 internal error, 2 usage, 3 bad scene, 4 some cases failed or did not close, "
    "130 interrupted. A pipe that closes early (| head) changes none of them.",
    add_completion=False,
    suggest_commands=False,  # _explain_mistake suggests commands that are safe to follow
    no_args_is_help=True,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
# options whose values may contain blanks
_OPTIONS_WITH_VALUES = ("--set", "--path", "--from", "--to", "--vary", "--for", "--subject-to", "--catalogue")


def _print_version(wanted: bool) -> None:
    if wanted:
        say(f"screwsim {version()}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None: ...


_POINTS = (points.run, points.sweep, points.explain, points.accuracy)
_STUDIES = (studies.optimum, studies.sensitivity, studies.performance_map, studies.compare, studies.calibrate)
_FILES = (files.explore, files.rotors, files.plot, files.scene, files.report, files.validate, files.schema)
_SEEK = (seek.find, seek.optimize)
_MEASURED = (seek.diagnose, seek.plan, studies.tolerance, startup)
for _command in (new, *_POINTS, datasheet, *_SEEK, *_STUDIES, *_MEASURED, *_FILES):
    app.command("map" if _command is studies.performance_map else None)(_command)
app.add_typer(export_app, name="export", short_help=str(export_app.info.help).rstrip("."))
for _registered in (*app.registered_commands, *export_app.registered_commands):
    _registered.short_help = summary(_registered.callback)
    _registered.cls = Command


@cache
def _parser(name: str) -> Any:
    """Return the parser of one command's arguments, or of all: building them all takes a tenth of a command's start."""
    alone = copy.copy(app)
    if name:
        alone.registered_commands = [command for command in app.registered_commands if _name(command) == name]
        alone.registered_groups = [each for each in app.registered_groups if each.name == name]
    return typer.main.get_command(alone)


def _name(command: Any) -> str:
    return command.name or typer.main.get_command_name(command.callback.__name__)


_NAMES = {*map(_name, app.registered_commands), *(group.name for group in app.registered_groups)}


def exit_code(arguments: Sequence[str]) -> int:
    """Run a command; print errors on stderr, and return the exit code."""
    tell_with_interruption("")
    try:
        # typer's own error handling would exit with other codes
        named = arguments[0] if arguments and arguments[0] in _NAMES else ""
        outcome = _parser(named).main(list(arguments), "screwsim", standalone_mode=False)
        sys.stdout.flush()  # errors of full disks are reported here, not when Python exits
    except KeyboardInterrupt:
        outcome = INTERRUPTED
    except Exception as error:  # noqa: BLE001 - whatever it is, the user gets one line
        outcome = INTERRUPTED if process.interrupted() else _print_fault(error, arguments)
    process.settle()
    if process.interrupted() or outcome == INTERRUPTED:  # other code may have swallowed the exception
        done = told_with_interruption()
        return print_error(f"interrupted; {done}" if done else f"interrupted{_how_to_resume(arguments)}", INTERRUPTED)
    return outcome if isinstance(outcome, int) else OK


def _how_to_resume(arguments: Sequence[str]) -> str:
    """Return that an interrupted command can be given again; '' where it would begin anew."""
    if "--restart" in arguments:
        return "; without --restart the same command goes on with what is stored"
    stated = _stated_output(arguments)
    if "sweep" in arguments[:1]:
        stems = [Path(each).stem for each in arguments[1:] if each.endswith((".yaml", ".yml"))]
        files = [stated] if stated else [f"results/{stem}{ending}" for stem in stems[:1] for ending in (".h5", ".csv")]
        kept = any(map(_is_kept, files)) or not files
        return f"; the same command {'resumes the sweep' if kept else 'begins anew, as no block was finished'}"
    if "optimize" in arguments[:1] and stated:
        kept = "continues where it stopped" if _is_kept(stated) else "begins anew, as no batch was finished"
        return f"; the same command {kept}"
    return ""


def _stated_output(arguments: Sequence[str]) -> str:
    """Return the file behind -o, or joined to it (`-oOUT.h5`); empty without one."""
    for number, each in enumerate(arguments):
        if each.startswith("-o"):
            return each[2:] or "".join(arguments[number + 1 : number + 2])
    return ""


def _is_kept(file: str) -> bool:
    """Return whether parts of a file of results are kept, beside what a link leads to, or the file itself is there."""
    place = os.path.realpath(file)
    return os.path.isdir(f"{place}.parts") or os.path.isfile(place)


def _print_fault(error: Exception, arguments: Sequence[str]) -> int:
    """Print an error, and return the exit code."""
    if isinstance(error, SceneError):
        return print_error(str(error), BAD_SCENE)
    if isinstance(error, UsageError):
        return print_error(" ".join(str(error).splitlines()), USAGE)
    if isinstance(error, typer.Abort):  # how typer reports an end of file where nothing was asked
        return _internal_error(error.__cause__ if isinstance(error.__cause__, Exception) else error)
    if isinstance(error, typer.TyperException):  # invalid arguments
        _explain_mistake(error, *_command_arguments(arguments))
        told = io.StringIO()
        getattr(error, "show", lambda file: None)(file=told)
        return print_error(told.getvalue().rstrip(), USAGE)
    if isinstance(error, OSError) and error.errno in DISK_FULL_ERRORS:
        where = error.filename or "a file"
        remedy = "make room, or write it elsewhere"
        return print_error(f"{where}: cannot be written: {os.strerror(error.errno)} ({remedy})", USAGE)
    if isinstance(error, OSError) and error.filename and error.errno in PATH_ERRORS:
        remedy = "name another place, or change its permissions"
        return print_error(f"{error.filename}: cannot be reached: {os.strerror(error.errno)} ({remedy})", USAGE)
    if isinstance(error, MemoryError) or (isinstance(error, OSError) and error.errno == errno.ENOMEM):
        _show_traceback()
        told = " ".join(str(error).split()) if isinstance(error, MemoryError) else ""  # of numpy: how much it is
        what = f"the system gives this process no more memory{told and ': '}{told}"
        remedy = "end other programs, raise the limit, as of ulimit -v or of a batch job, or use fewer --jobs"
        remedy += "; where it is more than the machine has, ask for less" if told else ""
        return print_error(f"{what} ({remedy})", USAGE)
    return _internal_error(error)


def _command_arguments(arguments: Sequence[str]) -> tuple[Sequence[str], Any]:
    """Return the arguments from the command's name on, and the existing commands; for a group, those inside it."""
    group = _parser("")
    inner = group.commands.get(arguments[0]) if arguments else None
    below = getattr(inner, "commands", None)
    return (arguments[1:], below) if below else (arguments, group.commands)


def _show_traceback() -> None:
    """Print the traceback of the error that is being handled, for those who debug."""
    if os.environ.get("SCREWSIM_DEBUG") == "1":
        traceback.print_exc()


def _internal_error(error: Exception) -> int:
    _show_traceback()
    remedy = "this is a bug in screwsim; please report it with the scene (SCREWSIM_DEBUG=1 prints the traceback)"
    return print_error(f"internal error: {in_one_line(error)}\n{remedy}", INTERNAL)


def main() -> None:
    """Run the command `screwsim`."""
    process.begin()
    try:
        code = exit_code(sys.argv[1:])
    except KeyboardInterrupt:  # pressed, or raised again, outside what `exit_code` catches
        process.settle()
        code = print_error("interrupted", INTERRUPTED)
    process.end(code)


def _explain_mistake(error: typer.TyperException, arguments: Sequence[str], commands: Iterable[str]) -> None:
    """Improve an error message on arguments: missing quotes, the nearest command, the nearest option."""
    text = str(getattr(error, "message", ""))
    offered = getattr(error, "possibilities", None)
    if offered:
        near = nearest(str(getattr(error, "option_name", "")), offered)
        error.possibilities = [near] if near else []  # type: ignore[attr-defined]
    elif text.startswith("No such command"):
        error.message = _unknown_command(arguments[0] if arguments else "", list(commands))  # type: ignore[attr-defined]
    elif "unexpected extra argument" in text and (remedy := _with_quotes(arguments) or _repeated_option(arguments)):
        error.message = f"{text}: {remedy}"  # type: ignore[attr-defined]


def _unknown_command(name: str, commands: list[str]) -> str:
    if name in ("help", "version"):
        return f"No such command '{name}' (write screwsim --{name})"
    near = nearest(name, commands)
    if near is not None:
        return f"No such command '{name}': did you mean '{near}'?"
    if re.search(r"\.(ya?ml|h5)$", name):
        usual = "report" if name.endswith("h5") else "run"
        verb = usual if usual in commands else f"export {commands[0]}"
        return f"No such command '{name}': the command must come first (write screwsim {verb} {shlex.quote(name)})"
    return f"No such command '{name}' (there are: {', '.join(commands)})"


def _with_quotes(arguments: Sequence[str]) -> str | None:
    """Return the first option whose value seems to continue in the next arguments, quoted for a shell."""
    for place, option in enumerate(arguments[:-1]):
        name, equals, value = option.partition("=")
        if name in _OPTIONS_WITH_VALUES:
            first = place + 1 if equals else place + 2
            words = [value if equals else arguments[place + 1]]
            while first < len(arguments) and not re.search(r"^--|^-o$|\.(ya?ml|h5)$", arguments[first]):
                words.append(arguments[first])
                first += 1
            if len(words) > 1:
                return f"a value with spaces needs quotes (write {name} {shlex.quote(' '.join(words))})"
    return None


def _repeated_option(arguments: Sequence[str]) -> str | None:
    """Return the remedy where --without is given several names."""
    if "--without" not in arguments[:-2]:
        return None
    place = list(arguments).index("--without") + 1
    return f"--without takes one name (write --without {arguments[place]} --without {arguments[place + 1]})"
