"""Declarations of a command's options and arguments."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import typer

# types of optional options
Text = str | None
Texts = list[str] | None
File = Path | None


def option(value: str, says: str, *names: str, **more: Any) -> Any:
    """Return an option with a value: its placeholder, its help and its names."""
    return typer.Option(*names, metavar=value, help=says, **more)


def switch(name: str, says: str, *others: str) -> Any:
    """Return an option without a value: its name, its help and other names of it."""
    return typer.Option(name, *others, help=says)


def argument(value: str, says: str) -> Any:
    """Return an argument: its placeholder and its help."""
    return typer.Argument(metavar=value, help=says, show_default=False)


def summary(command: Callable[..., Any] | None) -> str:
    """Return the first sentence on a command, which the list of commands shows complete; click would cut it."""
    return re.split(r"(?<=[.;])\s", " ".join((command.__doc__ or "").split()), maxsplit=1)[0].rstrip(".;")
