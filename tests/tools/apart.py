"""A separate process at the cost of a fork, from one that has imported the package but nothing of the tests."""

import multiprocessing
import os
import sys
import tempfile
from collections.abc import Callable, Mapping
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import NamedTuple


class Ended(NamedTuple):
    """How a process ended (−N: by signal N), and its output."""

    code: int
    out: str
    err: str


def _begin(call: Callable[..., object], arguments: tuple, place: str, variables: Mapping[str, str], into: str) -> None:
    for name, stream in (("out", 1), ("err", 2)):
        os.dup2(os.open(f"{into}/{name}", os.O_WRONLY), stream)
    os.chdir(place)
    os.environ.clear()
    os.environ.update(variables)
    returned = call(*arguments)
    sys.stdout.flush()
    sys.exit(returned if isinstance(returned, int) else 0)


def command(*arguments: str) -> int:
    """Run `screwsim ARGUMENTS…`."""
    from screwsim.cli import exit_code

    return exit_code(arguments)


def command_for_speed(*arguments: str) -> int:
    """Run `screwsim ARGUMENTS…` with code compiled for speed."""
    from screwsim.codegen.modules import for_speed

    with for_speed():
        return command(*arguments)


def begun(call: Callable[..., object], *arguments: object, folder: Path, **variables: str) -> BaseProcess:
    """Start a call in a separate process with the same working directory; its output goes to files in a folder."""
    for name in ("out", "err"):
        (folder / name).touch()
    told = call, arguments, os.getcwd(), os.environ | variables, str(folder)
    process = multiprocessing.get_context("forkserver").Process(target=_begin, args=told)
    process.start()
    return process


def ended(call: Callable[..., object], *arguments: object, timeout: float = 120.0, **variables: str) -> Ended:
    """Run a call in a separate process and wait for its end; one that takes too long is killed, and fails."""
    with tempfile.TemporaryDirectory() as name:
        process = begun(call, *arguments, folder=Path(name), **variables)
        process.join(timeout)
        if process.exitcode is None:
            process.kill()
            process.join()
            raise TimeoutError(f"{call.__name__}{arguments} has not ended in {timeout:g} s")
        return Ended(process.exitcode, *((Path(name) / each).read_text(encoding="utf-8") for each in ("out", "err")))
