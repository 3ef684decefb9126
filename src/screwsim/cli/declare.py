"""How a command declares its options and arguments."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import typer

# of options that need not be there
Text = str | None
Texts = list[str] | None
File = Path | None


def option(value: str, says: str, *names: str, **more: Any) -> Any:
    """Return an option with a value: what stands for the value, what the option is for, and its names."""
    return typer.Option(*names, metavar=value, help=says, **more)


def switch(name: str, says: str) -> Any:
    """Return an option without a value: its name, and what it does."""
    return typer.Option(name, help=says)


def argument(value: str, says: str) -> Any:
    """Return an argument: what stands for it, and what it is."""
    return typer.Argument(metavar=value, help=says, show_default=False)


def summary(command: Callable[..., Any] | None) -> str:
    """Return the first sentence about a command, which the list of commands shows whole: click would cut it."""
    return re.split(r"(?<=[.;])\s", " ".join((command.__doc__ or "").split()), maxsplit=1)[0].rstrip(".;")
