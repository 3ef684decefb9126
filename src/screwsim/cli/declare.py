"""Declarations of a command's options and arguments."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperCommand, TyperOption

from screwsim.inputs.faults import UsageError

# types of optional options
Text = str | None
Texts = list[str] | None
File = Path | None


CHANGES = "--set"  # each one of a scene: PATH=VALUE


class Command(TyperCommand):
    """A command that refuses an option with one value that is given twice, of which click would take the last.

    Likewise a path that two options change. It also refuses an empty `-o`, which would stand for the present folder.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Return what is left of the arguments; raise UsageError."""
        values, _, given = self.make_parser(ctx).parse_args(list(args))
        for each in given:
            if "-o" in each.opts and values.get(each.name or "") == "":
                raise UsageError(f"{each.opts[0]}: is empty (name a file or folder, or leave it out)")
            single = isinstance(each, TyperOption) and not (each.multiple or each.is_flag)
            if single and given.count(each) > 1:
                raise UsageError(f"{each.opts[0]}: is given twice, and takes one value (remove one)")
            if CHANGES in each.opts:
                _refuse_twice(values[each.name or ""])
        return super().parse_args(ctx, args)


def _refuse_twice(changes: list[str]) -> None:
    """Raise UsageError where two of the changes PATH=VALUE have one path."""
    paths = [change.partition("=")[0].strip() for change in changes]
    if twice := [path for path in paths if paths.count(path) > 1]:
        raise UsageError(f"{CHANGES} {twice[0]}: is given twice (remove one)")


def option(value: str, says: str, *names: str, default: Any = None, **more: Any) -> Any:
    """Return an option with a value: its placeholder, its help and its names; a default of `...` for a required one."""
    return typer.Option(default, *names, metavar=value, help=says, **more)


def switch(name: str, says: str, *others: str, default: bool = False) -> Any:
    """Return an option without a value: its name, its help and other names of it."""
    return typer.Option(default, name, *others, help=says)


def argument(value: str, says: str, default: Any = ...) -> Any:
    """Return an argument: its placeholder and its help; without a default it is required."""
    return typer.Argument(default, metavar=value, help=says, show_default=False)


def summary(command: Callable[..., Any] | None) -> str:
    """Return the first sentence on a command, which the list of commands shows complete; click would cut it."""
    return re.split(r"(?<=[.;])\s", " ".join((command.__doc__ or "").split()), maxsplit=1)[0].rstrip(".;")
